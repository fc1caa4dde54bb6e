!> Tractions on the sides of three-node triangles with which every element is in equilibrium (Ladeveze and Leguillon,
!> SIAM J. Numer. Anal. 20, 1983), from a finite element solution that is in equilibrium with the loads.
!>
!> The moment of a traction at a corner is its integral times the corner's linear shape function. Around a node the
!> moments of one side follow from those of the side before and the element between them, so that one vector is free at
!> an inner node; the moments come as close as possible to those of the mean stress on both sides, by what their
!> difference weighs in the energy: its square times the area of the elements over that of the side's length.
module amontons_equilibrated_sides
   use amontons_coloring, only: worth_threads
   use amontons_constraints, only: constraints_t
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_incidence, only: incidence_t, new_incidence
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_traction_t, known_tractions_t
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: element_forces_t, find_element_forces, find_side_moments, next, outward

   !> The corner after each corner of a triangle.
   integer, parameter :: next(3) = [2, 3, 1]

   !> The forces inside an element: what its sides must balance.
   type :: element_forces_t
      real(dp) :: depth = 1.0_dp !! its depth [L]
      real(dp) :: stress(3) = 0.0_dp !! mean stress xx, yy, xy times the depth [F/L]
      real(dp) :: load(2) = 0.0_dp !! load in the element, shared by its corners alike [F]
      real(dp) :: solved(3) = 0.0_dp !! mean stress xx, yy, xy of the displacements to be judged [F/L^2]
   end type element_forces_t

contains

   !> Finds the forces inside the elements of a finite element solution.
   subroutine find_element_forces(forces, mesh, materials, body_force, displacement, judged, thermal_strain)
      type(element_forces_t), allocatable, intent(out) :: forces(:) !! the forces (n_elements)
      type(mesh_t), intent(in) :: mesh !! a checked mesh of three-node triangles
      type(materials_t), intent(in) :: materials !! its materials, of a plane body
      real(dp), intent(in) :: body_force(:, :) !! force per volume of each element, x and y (2, n_elements) [F/L^3]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: judged(:, :) !! displacement of the nodes whose stresses are to be judged (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      type(element_geometry_t) :: geometry
      real(dp) :: stress(4)
      integer :: i

      allocate (forces(mesh%n_elements))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(stress) &
      !$omp shared(forces, mesh, materials, body_force, displacement, judged, thermal_strain)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)))
            call new_element_geometry(geometry, mesh, i, material, 1)
            if (present(thermal_strain)) call set_thermal_strain(geometry, &
               thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
            stress = element_stress(geometry, material, displacement, 1)
            forces(i)%depth = material%thickness
            forces(i)%stress = material%thickness*stress(:3)
            stress = element_stress(geometry, material, judged, 1)
            forces(i)%solved = stress(:3)
            forces(i)%load = geometry%volume(1)*body_force(:, i)
         end associate
      end do
      !$omp end parallel do
   end subroutine find_element_forces

   !> Finds the moments of the tractions that act on each element along its sides.
   subroutine find_side_moments(moment, imbalance, mesh, constraints, tractions, forces)
      real(dp), allocatable, intent(out) :: moment(:, :, :, :)
         !! x and y at the first and second corner of each side (2, 2, 3, n_elements) [F]
      real(dp), intent(out) :: imbalance
         !! by how much the solution misses equilibrium with the loads, over the norm of the moments [-]
      type(mesh_t), intent(in) :: mesh !! a checked mesh of three-node triangles
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_tractions_t), intent(in) :: tractions !! the tractions on the boundary
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements, from `find_element_forces`
      type(incidence_t) :: incidence
      real(dp) :: missing
      integer :: node

      call new_incidence(incidence, mesh)
      allocate (moment(2, 2, 3, mesh%n_elements))
      missing = 0.0_dp
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp shared(moment, mesh, constraints, tractions, forces, incidence) reduction(+: missing)
      do node = 1, mesh%n_nodes
         call balance_node(moment, missing, mesh, constraints, tractions, forces, &
            incidence%element(incidence%start(node):incidence%start(node + 1) - 1), node)
      end do
      !$omp end parallel do
      imbalance = sqrt(missing/max(sum(moment**2), tiny(1.0_dp)))
   end subroutine find_side_moments

   !> Finds the moments at a node: of one fan of elements after the other, where several meet there.
   pure subroutine balance_node(moment, missing, mesh, constraints, tractions, forces, elements, node)
      real(dp), intent(inout) :: moment(:, :, :, :) !! as in `find_side_moments` [F]
      real(dp), intent(inout) :: missing !! gains the square of what is missing to equilibrium [F^2]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_tractions_t), intent(in) :: tractions !! the tractions on the boundary
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements
      integer, intent(in) :: elements(:) !! the elements at the node
      integer, intent(in) :: node !! the node
      integer :: after(size(elements)), before(size(elements)), fan(size(elements))
      logical :: is_left(size(elements))
      integer :: i, n

      do i = 1, size(elements)
         associate (nodes => mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i)) + 2))
            n = findloc(nodes, node, dim=1)
            after(i) = nodes(next(n))
            before(i) = nodes(next(next(n)))
         end associate
      end do
      is_left = .true.
      do while (any(is_left))
         ! A fan at the boundary begins where no element precedes; one around an inner node anywhere.
         do i = 1, size(elements)
            if (is_left(i) .and. all(before /= after(i))) exit
         end do
         if (i > size(elements)) i = findloc(is_left, .true., dim=1)
         n = 0
         do while (i > 0)
            n = n + 1
            fan(n) = i
            is_left(i) = .false.
            i = findloc(after == before(i) .and. is_left, .true., dim=1)
         end do
         call balance_fan(moment, missing, mesh, constraints, tractions, forces, elements(fan(:n)), node)
      end do
   end subroutine balance_node

   !> Finds the moments at the node of a fan of elements, which follow each other counter-clockwise.
   pure subroutine balance_fan(moment, missing, mesh, constraints, tractions, forces, elements, node)
      real(dp), intent(inout) :: moment(:, :, :, :) !! as in `find_side_moments` [F]
      real(dp), intent(inout) :: missing !! gains the square of what is missing to equilibrium [F^2]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_tractions_t), intent(in) :: tractions !! the tractions on the boundary
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements
      integer, intent(in) :: elements(:) !! the elements
      integer, intent(in) :: node !! the node
      real(dp) :: sum_to(2, 0:size(elements)), wanted(2, 0:size(elements)), weight(0:size(elements))
      real(dp) :: x(2, 3), first(2), area
      integer :: corner(size(elements)), nodes(3, size(elements)), i, n
      logical :: is_closed

      n = size(elements)
      sum_to(:, 0) = 0.0_dp
      weight = 0.0_dp
      do i = 1, n
         nodes(:, i) = mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i)) + 2)
         corner(i) = findloc(nodes(:, i), node, dim=1)
         x = mesh%coordinates(:, nodes(:, i))
         associate (element => elements(i), a => next(corner(i)), b => next(next(corner(i))))
            sum_to(:, i) = sum_to(:, i - 1) + 0.5_dp*stress_times(forces(element)%stress, outward(x(:, a) - x(:, b))) &
               - forces(element)%load/3.0_dp
            ! What the element's own stress makes of the side behind it and of the one before it.
            wanted(:, i) = 0.5_dp*stress_times(forces(element)%stress, outward(x(:, corner(i)) - x(:, b)))
            first = -0.5_dp*stress_times(forces(element)%stress, outward(x(:, a) - x(:, corner(i))))
            area = dot_product(x(:, a) - x(:, corner(i)), outward(x(:, b) - x(:, corner(i))))
            weight(i - 1) = weight(i - 1) + area/sum((x(:, a) - x(:, corner(i)))**2)
            weight(i) = area/sum((x(:, b) - x(:, corner(i)))**2)
         end associate
         if (i == 1) then
            wanted(:, 0) = first
         else
            wanted(:, i - 1) = 0.5_dp*(wanted(:, i - 1) + first)
         end if
      end do
      is_closed = nodes(next(next(corner(n))), n) == nodes(next(corner(1)), 1)
      if (is_closed) then
         wanted(:, n) = 0.5_dp*(wanted(:, n) + wanted(:, 0))
         weight(n) = weight(n) + weight(0)
         weight(0) = 0.0_dp
      end if
      first = matmul(wanted - sum_to, weight)/sum(weight)
      if (is_closed) then
         missing = missing + sum(sum_to(:, n)**2)
      else
         call keep_boundary(first, missing, constraints, forces, sum_to(:, n), node, &
            tractions%at(elements(1), corner(1)), tractions%at(elements(n), next(next(corner(n)))))
      end if
      do i = 1, n
         moment(:, 1, corner(i), elements(i)) = -first - sum_to(:, i - 1)
         moment(:, 2, next(next(corner(i))), elements(i)) = first + sum_to(:, i)
      end do
   end subroutine balance_fan

   !> Moves the moments of a fan at the boundary to those that its first and last side are known to have.
   pure subroutine keep_boundary(first, missing, constraints, forces, total, node, begin, end)
      real(dp), intent(inout) :: first(2) !! moment of the first side, on what is before it [F]
      real(dp), intent(inout) :: missing !! gains the square of what is missing to equilibrium [F^2]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements
      real(dp), intent(in) :: total(2) !! what is added to this moment up to the last side [F]
      integer, intent(in) :: node !! the node
      type(known_traction_t), intent(in) :: begin !! the first side
      type(known_traction_t), intent(in) :: end !! the last side
      ! Directions that differ by less than this angle are one.
      real(dp), parameter :: parallel = 1.0e-6_dp
      real(dp) :: axes(2, 2), direction(2), value, across, kept(2)
      logical :: is_known(2)
      integer :: i, k, n_kept

      n_kept = 0
      kept = 0.0_dp
      do k = 1, 2
         if (k == 1) call find_axes(axes, is_known, constraints, begin)
         if (k == 2) call find_axes(axes, is_known, constraints, end)
         do i = 1, 2
            if (.not. is_known(i)) cycle
            direction = axes(:, i)
            if (k == 1) value = -dot_product(direction, applied_moment(begin, forces(begin%element)%depth, node))
            if (k == 2) value = dot_product(direction, applied_moment(end, forces(end%element)%depth, node) - total)
            value = value - dot_product(direction, first)
            across = dot_product(direction, outward(kept))
            if (n_kept == 0) then
               kept = direction
               first = first + value*direction
               n_kept = 1
            else if (n_kept == 1 .and. abs(across) > parallel) then
               first = first + value/across*outward(kept)
               n_kept = 2
            else
               missing = missing + value**2
            end if
         end do
      end do
   end subroutine keep_boundary

   !> Two directions, and along which of them the traction of a side is that applied to it: no support holds both of its
   !> corners along it.
   pure subroutine find_axes(axes, is_known, constraints, side)
      real(dp), intent(out) :: axes(2, 2) !! the directions, unit vectors as columns [-]
      logical, intent(out) :: is_known(2) !! whether the traction along each is that applied
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_traction_t), intent(in) :: side !! the side
      integer :: i

      ! A corner that supports hold completely says nothing about directions.
      i = merge(2, 1, all(.not. constraints%is_free(:, side%corner(1))))
      axes = constraints%frame(side%corner(i))
      do i = 1, 2
         is_known(i) = constraints%leaves_free(side%corner(1), axes(:, i)) .or. &
            constraints%leaves_free(side%corner(2), axes(:, i))
      end do
   end subroutine find_axes

   !> The moment at a corner of the traction that is applied to a side [F].
   pure function applied_moment(side, depth, node) result(moment)
      type(known_traction_t), intent(in) :: side !! the side
      real(dp), intent(in) :: depth !! its depth [L]
      integer, intent(in) :: node !! the corner
      real(dp) :: moment(2)
      integer :: here, there

      here = merge(1, 3, side%corner(1) == node)
      there = 4 - here
      moment = depth*norm2(side%position(:, 3) - side%position(:, 1))/6.0_dp* &
         (2.0_dp*side%traction(:, here) + side%traction(:, there))
   end function applied_moment

   !> A stress times a vector.
   pure function stress_times(stress, vector)
      real(dp), intent(in) :: stress(3) !! xx, yy, xy
      real(dp), intent(in) :: vector(2) !! the vector
      real(dp) :: stress_times(2)

      stress_times = [stress(1)*vector(1) + stress(3)*vector(2), stress(3)*vector(1) + stress(2)*vector(2)]
   end function stress_times

   !> The outward normal of a side, times its length.
   pure function outward(along)
      real(dp), intent(in) :: along(2) !! the way along the side, the body on the left [L]
      real(dp) :: outward(2)

      outward = [along(2), -along(1)]
   end function outward

end module amontons_equilibrated_sides
