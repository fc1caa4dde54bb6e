!> Supports and loads in one line each, and the plain displacement method, for bodies without contact.
module sample_bodies
   use amontons_assembly, only: assemble_stiffness, from_unknowns, to_unknowns
   use amontons_condenser, only: cholesky_t
   use amontons_constraints, only: constraints_t, dof_map_t, new_constraints, new_dof_map, new_foundation, &
      spring_side_t, support_t
   use amontons_elasticity, only: element_geometry_t, find_elastic_strains, find_nodal_forces
   use amontons_element, only: max_nodes, max_points
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_region, load_t, load_vector
   use amontons_material, only: material_t, materials_t, max_components, n_strains, new_material, new_materials
   use amontons_mesh, only: coloring_t, mesh_t, new_coloring
   use amontons_new_cholesky, only: new_cholesky
   use amontons_sparse_matrix, only: sparse_matrix_t
   use amontons_stress_field, only: internal_forces
   implicit none (type, external)
   private

   public :: along_normal, along_tangent, along_x, along_y, along_z, element_forces, element_stress, make_springs, &
      no_bonds, no_jumps, no_springs, nodal_reactions, sample_material, sample_materials, solve_body, &
      solve_materials, springs_on_set, support_at_point, support_on_set, traction_on_set, uniform, weight_of

   !> Components of a support: x, y, outward normal, tangent.
   integer, parameter :: along_x = 1, along_y = 2, along_z = 3, along_normal = 4, along_tangent = 5
   !> The springs of a body without foundation.
   ! allow(incorrect-space-between-brackets): the other rule wants a blank behind ::
   type(spring_side_t), parameter :: no_springs(0) = [spring_side_t :: ]
   !> The bonds of a body of one piece.
   integer, parameter :: no_bonds(3, 0) = 0
   !> The jumps of a body without preloads.
   real(dp), parameter :: no_jumps(2, 0) = 0.0_dp

contains

   !> A support of a boundary set.
   pure function support_on_set(set, components, displacement) result(support)
      character(*), intent(in) :: set !! name of the set
      integer, intent(in) :: components(:) !! which components are prescribed
      real(dp), intent(in) :: displacement(:) !! their values [L]
      type(support_t) :: support

      support%set = set
      support%is_held(components) = .true.
      support%displacement(components) = displacement
      support%origin = 'deck.nml:7: '
   end function support_on_set

   !> A support of the node at a point.
   pure function support_at_point(point, components, displacement) result(support)
      real(dp), intent(in) :: point(2) !! coordinates of the node [L]
      integer, intent(in) :: components(:) !! which components are prescribed
      real(dp), intent(in) :: displacement(:) !! their values [L]
      type(support_t) :: support

      support = support_on_set('', components, displacement)
      support%point(:2) = point
   end function support_at_point

   !> An elastic foundation under a boundary set.
   pure function springs_on_set(set, moduli) result(support)
      character(*), intent(in) :: set !! name of the set
      real(dp), intent(in) :: moduli(2) !! stress per displacement along normal and tangent [F/L^3]
      type(support_t) :: support

      support%set = set
      support%spring = moduli
      support%origin = 'deck.nml:7: '
   end function springs_on_set

   !> A load by a traction on a boundary set.
   pure function traction_on_set(set, traction) result(load)
      character(*), intent(in) :: set !! name of the set
      real(dp), intent(in) :: traction(2) !! the traction [F/L^2]
      type(load_t) :: load

      load%set = set
      load%region = ''
      load%traction(:2) = traction
      load%origin = 'deck.nml:9: '
   end function traction_on_set

   !> A body force.
   pure function weight_of(body_force) result(load)
      real(dp), intent(in) :: body_force(2) !! force per volume [F/L^3]
      type(load_t) :: load

      load = traction_on_set('', [0.0_dp, 0.0_dp])
      load%target = load_on_region
      load%body_force(:2) = body_force
   end function weight_of

   !> A material with Young's modulus 1000, Poisson's ratio 0.3 and thickness 2.
   function sample_material(hypothesis) result(material)
      character(*), intent(in) :: hypothesis !! one of the hypotheses, or 'solid'
      type(material_t) :: material
      type(error_t), allocatable :: error

      call new_material(material, 1000.0_dp, 0.3_dp, trim(hypothesis), merge(1.0_dp, 2.0_dp, hypothesis == 'solid'), &
         error)
   end function sample_material

   !> One material for all elements of a mesh.
   pure function uniform(material, mesh) result(materials)
      type(material_t), intent(in) :: material !! the material
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t) :: materials
      type(error_t), allocatable :: error

      call new_materials(materials, [material], mesh, error)
   end function uniform

   !> The sample material in all elements of a mesh.
   function sample_materials(hypothesis, mesh) result(materials)
      character(*), intent(in) :: hypothesis !! one of the hypotheses
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t) :: materials

      materials = uniform(sample_material(hypothesis), mesh)
   end function sample_materials

   !> The springs of supports whose sets are known to be there.
   pure function make_springs(mesh, materials, supports) result(springs)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of its elements
      type(support_t), intent(in) :: supports(:) !! the supports
      type(spring_side_t), allocatable :: springs(:)
      type(error_t), allocatable :: error

      call new_foundation(springs, mesh, materials, supports, error)
   end function make_springs

   !> Displacement of a body of one material.
   subroutine solve_body(displacement, mesh, material, supports, loads, error)
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(material_t), intent(in) :: material !! its material
      type(support_t), intent(in) :: supports(:) !! its supports
      type(load_t), intent(in) :: loads(:) !! its loads
      type(error_t), allocatable, intent(out) :: error !! whatever failed

      call solve_materials(displacement, mesh, uniform(material, mesh), supports, loads, error)
   end subroutine solve_body

   !> Displacement of a body that its supports hold: K u = f - K times the prescribed displacement, on the unknowns.
   subroutine solve_materials(displacement, mesh, materials, supports, loads, error)
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials of its elements
      type(support_t), intent(in) :: supports(:) !! its supports
      type(load_t), intent(in) :: loads(:) !! its loads
      type(error_t), allocatable, intent(out) :: error !! whatever failed
      type(coloring_t) :: coloring
      type(constraints_t) :: constraints
      type(dof_map_t) :: dof_map
      type(sparse_matrix_t) :: stiffness
      class(cholesky_t), allocatable :: cholesky
      type(spring_side_t), allocatable :: springs(:)
      real(dp), allocatable :: forces(:, :), held(:, :), prescribed(:, :), unknowns(:)
      integer :: no_nodes(0)

      call new_coloring(coloring, mesh)
      call new_constraints(constraints, prescribed, mesh, supports, error)
      if (allocated(error)) return
      call new_foundation(springs, mesh, materials, supports, error)
      if (allocated(error)) return
      call new_dof_map(dof_map, constraints, no_nodes)
      call assemble_stiffness(stiffness, mesh, materials, springs, coloring, constraints, dof_map, error)
      if (allocated(error)) return
      call load_vector(forces, mesh, materials, loads, error)
      if (allocated(error)) return
      call internal_forces(held, mesh, materials, springs, coloring, prescribed)
      call new_cholesky(cholesky, 'band', stiffness, 0, error)
      if (.not. allocated(error)) call cholesky%complete(error)
      if (allocated(error)) return
      allocate (unknowns(dof_map%n_dofs))
      call cholesky%solve(to_unknowns(forces - held, constraints, dof_map), unknowns)
      displacement = from_unknowns(unknowns, prescribed, constraints, dof_map)
   end subroutine solve_materials

   !> What the supports of a body without loads exert on its nodes (2, n_nodes) [F].
   function nodal_reactions(mesh, material, displacement) result(forces)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), allocatable :: forces(:, :)
      type(coloring_t) :: coloring

      call new_coloring(coloring, mesh)
      call internal_forces(forces, mesh, uniform(material, mesh), no_springs, coloring, displacement)
   end function nodal_reactions

   !> Stress at a quadrature point [F/L^2].
   pure function element_stress(geometry, material, displacement, point) result(stress)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: stress(n_strains), strain(n_strains, max_points)

      call find_elastic_strains(geometry, material, displacement, strain)
      stress = material%stress(strain(:, point))
   end function element_stress

   !> Nodal forces that the stress of an element amounts to: integral of B^T stress. The pressure of a projected
   !> dilatation is one of the modes, so that B does as well as B-bar (components, nodes) [F].
   pure function element_forces(geometry, material, displacement) result(forces)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp) :: forces(max_components, max_nodes), stress(n_strains, geometry%n_points)
      integer :: point

      do point = 1, geometry%n_points
         stress(:, point) = element_stress(geometry, material, displacement, point)
      end do
      call find_nodal_forces(forces, geometry, material, stress)
   end function element_forces

end module sample_bodies
