!> Elasticity of one element: stiffness, stress, nodal forces.
!>
!> The four-node quadrilateral of a plane body has procedures of its own that work on its four quadrature points side by
!> side, in a quarter of the time: fine meshes have hundreds of thousands of them.
module amontons_elasticity
   use amontons_dilatation, only: condense_inner, max_modes, mode_values, new_modes, projection_t
   use amontons_element, only: bubble_function, has_bubble, max_nodes, max_points, n_element_nodes, n_element_points, &
      quad4, quadrature_point, shape_functions, tri3, tri6
   use amontons_kinds, only: dp
   use amontons_material, only: isotropic_law, material_t, max_components, n_strains
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: element_geometry_t, element_stiffness, find_elastic_strains, find_nodal_forces, &
      is_plain_quadrilateral, new_element_geometry, plane_quadrilateral_t, set_element_load

   !> Shape functions and their gradients at the quadrature points of one element.
   type :: element_geometry_t
      ! What belongs to the reference element alone serves the next element of its kind too.
      integer, private :: kind = 0 !! kind of element
      integer :: n_points = 0 !! number of quadrature points
      real(dp) :: values(max_nodes, max_points)
         !! shape functions (node, point), that of the bubble behind those of the nodes, then 0 [-]
      real(dp), private :: derivatives(2, max_nodes, max_points) !! derivatives by the reference coordinates [-]
      real(dp), private :: weight(max_points) !! weights of the quadrature [-]
      real(dp) :: thermal_strain(max_points) = 0.0_dp
         !! strain of free thermal expansion at the points, from `set_element_load`; the next element keeps it [-]
      real(dp) :: loaded_bubble(2) = 0.0_dp
         !! displacement of the bubble by heat and body forces where the nodes are at rest, from there, too [L]
      ! No defaults here: setting them would take as long as all the rest, once for each element.
      integer :: n_nodes !! number of nodes
      integer :: n_functions !! number of shape functions: one more than nodes in an element with a bubble
      integer :: node(max_nodes) !! numbers of the nodes in the mesh
      real(dp) :: gradient(2, max_nodes, max_points)
         !! gradients of the functions (x and y, node, point) [1/L]
      real(dp) :: hoop(max_nodes, max_points) !! in a body of revolution the functions over the radius [1/L]
      real(dp) :: position(2, max_points) !! coordinates of the points [L]
      real(dp) :: volume(max_points) !! quadrature weight, Jacobian and depth of each point, 0 past the last [L^3]
      integer :: n_modes
         !! number of polynomials that the dilatation is projected to: 1 (the mean), 3 (1, x, y), or 0 for all of it
      real(dp), private :: mode(max_modes, max_points) !! their values at the points [L^-3/2]
      type(projection_t) :: projection !! then the projection, and the bubble
   end type element_geometry_t

   ! Shares that the points, in the order of the corners, have of values at the first side and at the last one.
   real(dp), parameter :: near = 0.5_dp + 0.5_dp/sqrt(3.0_dp), far = 1.0_dp - near
   real(dp), parameter :: first(4) = [near, near, far, far], last(4) = [near, far, far, near]
   !> Shape functions (point, corner) [-].
   real(dp), parameter, public :: quadrilateral_shapes(4, 4) = reshape([last*first, (1.0_dp - last)*first, &
      (1.0_dp - last)*(1.0_dp - first), last*(1.0_dp - first)], [4, 4])

   !> The quadrilateral.
   type :: plane_quadrilateral_t
      integer :: node(4) = 0 !! numbers of its corners in the mesh
      real(dp) :: corner(4, 2) = 0.0_dp !! their coordinates (corner, x and y) [L]
      real(dp) :: area(4) = 0.0_dp !! area of the part of the element that each point stands for [L^2]
      real(dp) :: strain(4, 3) = 0.0_dp !! strain at the points: xx, yy, engineering shear 2 xy (point, component) [-]
      real(dp) :: stress(4, 4) = 0.0_dp !! stress there: xx, yy, zz, xy (point, component) [F/L^2]
      real(dp), private :: by_xi(4, 2) = 0.0_dp !! derivatives of x and y by the first reference coordinate [L]
      real(dp), private :: by_eta(4, 2) = 0.0_dp !! by the second one [L]
   contains
      procedure :: compute_stresses => plane_quadrilateral_compute_stresses
      procedure :: energy_density => plane_quadrilateral_energy_density
      procedure :: forces => plane_quadrilateral_forces
      procedure :: set_element => plane_quadrilateral_set_element
   end type plane_quadrilateral_t

contains

   !> Evaluates the shape functions of an element.
   pure recursive subroutine new_element_geometry(geometry, mesh, element, material, n_points)
      type(element_geometry_t), intent(inout) :: geometry
         !! the shape functions at the quadrature points; on entry anything, best those of an element of the same kind
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      integer, intent(in) :: element !! number of the element
      type(material_t), intent(in) :: material !! its material, for depth and dilatation
      integer, intent(in), optional :: n_points !! number of quadrature points; default: those of its stiffness
      real(dp) :: x(2, max_nodes), dx(2), dy(2), determinant
      integer :: i, first, point

      associate (kind => mesh%element_kind(element))
         if (present(n_points)) then
            call choose_reference(geometry, kind, n_points)
         else
            call choose_reference(geometry, kind, n_stiffness_points(kind, material))
         end if
      end associate
      geometry%n_modes = 0
      if (material%is_b_bar .and. geometry%kind /= tri3) geometry%n_modes = merge(1, max_modes, geometry%kind == quad4)
      geometry%n_functions = geometry%n_nodes
      if (geometry%n_modes > 0 .and. has_bubble(geometry%kind)) geometry%n_functions = geometry%n_nodes + 1
      first = mesh%node_start(element)
      do i = 1, geometry%n_nodes
         geometry%node(i) = mesh%node(first + i - 1)
         x(:, i) = mesh%coordinates(:, geometry%node(i))
      end do
      do point = 1, geometry%n_points
         geometry%position(:, point) = 0.0_dp
         do i = 1, geometry%n_nodes
            geometry%position(:, point) = geometry%position(:, point) + geometry%values(i, point)*x(:, i)
         end do
         if (geometry%kind /= tri3) then
            ! The derivatives of x and of y by the reference coordinates are the rows of the Jacobian.
            dx = 0.0_dp
            dy = 0.0_dp
            do i = 1, geometry%n_nodes
               dx = dx + x(1, i)*geometry%derivatives(:, i, point)
               dy = dy + x(2, i)*geometry%derivatives(:, i, point)
            end do
            determinant = dx(1)*dy(2) - dx(2)*dy(1)
            dx = dx/determinant
            dy = dy/determinant
            do i = 1, geometry%n_functions
               associate (derivative => geometry%derivatives(:, i, point))
                  geometry%gradient(1, i, point) = dy(2)*derivative(1) - dy(1)*derivative(2)
                  geometry%gradient(2, i, point) = dx(1)*derivative(2) - dx(2)*derivative(1)
               end associate
            end do
         else if (point == 1) then
            dx = x(1, 2:3) - x(1, 1)
            dy = x(2, 2:3) - x(2, 1)
            determinant = dx(1)*dy(2) - dy(1)*dx(2)
            geometry%gradient(:, 2, 1) = [dy(2), -dx(2)]/determinant
            geometry%gradient(:, 3, 1) = [-dy(1), dx(1)]/determinant
            geometry%gradient(:, 1, 1) = -geometry%gradient(:, 2, 1) - geometry%gradient(:, 3, 1)
         else
            ! The Jacobian of a straight triangle is the same at every point.
            geometry%gradient(:, :3, point) = geometry%gradient(:, :3, 1)
         end if
         geometry%volume(point) = geometry%weight(point)*determinant*material%depth(geometry%position(1, point))
         if (.not. material%is_axisymmetric) cycle
         !$omp simd
         do i = 1, geometry%n_functions
            geometry%hoop(i, point) = geometry%values(i, point)/geometry%position(1, point)
         end do
      end do
      if (geometry%n_modes > 0) call project_dilatation(geometry, mesh, element, material)
   end subroutine new_element_geometry

   !> Number of quadrature points of the stiffness: those of degree 4 in a triangle with a bubble, whose gradient is
   !> quadratic.
   elemental integer function n_stiffness_points(kind, material) result(n_points)
      integer, intent(in) :: kind !! kind of element
      type(material_t), intent(in) :: material !! its material

      n_points = n_element_points(kind, material%is_axisymmetric .or. (material%is_b_bar .and. kind == tri6))
   end function n_stiffness_points

   !> Projects the dilatation of each unit displacement to the modes, and condenses the bubble. The integrals are those
   !> of the quadrature points of the stiffness: other points give other ones, and near a Poisson's ratio of 0.5 a wrong
   !> pressure.
   pure recursive subroutine project_dilatation(geometry, mesh, element, material)
      type(element_geometry_t), intent(inout) :: geometry !! the element's shape functions; gains modes and bubble
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      type(material_t), intent(in) :: material !! its material
      type(element_geometry_t), allocatable :: standard
      real(dp) :: inner(2, 2*max_nodes), law(n_strains, n_strains), share
      integer :: i, m, point

      associate (n => geometry%n_functions, n_points => geometry%n_points, modes => geometry%n_modes, &
         projection => geometry%projection)
         if (n_points /= n_stiffness_points(geometry%kind, material)) then
            allocate (standard)
            call new_element_geometry(standard, mesh, element, material)
            geometry%projection = standard%projection
         else
            call new_modes(projection%center, projection%factor(:modes, :modes), geometry%position(:, :n_points), &
               geometry%volume(:n_points))
         end if
         do point = 1, n_points
            geometry%mode(:modes, point) = mode_values(projection%center, projection%factor(:modes, :modes), &
               geometry%position(:, point))
         end do
         if (allocated(standard)) return
         projection%dilatation(:, :n, :modes) = 0.0_dp
         projection%share(:n, :modes) = 0.0_dp
         do m = 1, modes
            do point = 1, n_points
               share = geometry%volume(point)*geometry%mode(m, point)
               do i = 1, n
                  projection%dilatation(:, i, m) = projection%dilatation(:, i, m) + share*geometry%gradient(:, i, point)
                  projection%share(i, m) = projection%share(i, m) + share*geometry%values(i, point)
                  if (material%is_axisymmetric) projection%dilatation(1, i, m) = projection%dilatation(1, i, m) &
                     + share*geometry%hoop(i, point)
               end do
            end do
         end do
         if (n == geometry%n_nodes) return
         law = element_law(geometry, material)
         do i = 1, n
            call find_block(inner(:, 2*i - 1:2*i), geometry, material, law, n, i)
         end do
         projection%stiffness = inner(:, 2*n - 1:2*n)
         call condense_inner(projection%bubble(:, :2*n - 2), projection%compliance, inner(:, :2*n))
      end associate
   end subroutine project_dilatation

   !> Sets what acts inside an element: its thermal strain at the quadrature points, from that at the nodes and
   !> projected as the dilatation is, and the displacement of its bubble. The forces of heat on the bubble are those of
   !> the pressure that keeps the volume, three times bulk modulus and strain.
   pure subroutine set_element_load(geometry, material, mesh, element, load)
      type(element_geometry_t), intent(inout) :: geometry !! the element's shape functions; gains these
      type(material_t), intent(in) :: material !! its material
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      real(dp), intent(in) :: load(:) !! what acts inside all elements, from `sum_element_loads` [-], [L]
      real(dp) :: of_mode(max_modes)
      integer :: first

      associate (n => geometry%n_points, m => geometry%n_modes, k => geometry%n_functions, &
         at_nodes => load(mesh%node_start(element):mesh%node_start(element + 1) - 1))
         if (m == 0) then
            geometry%thermal_strain(:n) = matmul(at_nodes, geometry%values(:geometry%n_nodes, :n))
            return
         end if
         of_mode(:m) = matmul(at_nodes, geometry%projection%share(:geometry%n_nodes, :m))
         geometry%thermal_strain(:n) = matmul(of_mode(:m), geometry%mode(:m, :n))
         if (k == geometry%n_nodes) return
         first = size(mesh%node) + 2*element - 1
         geometry%loaded_bubble = load(first:first + 1) + 3.0_dp*material%bulk()*matmul( &
            geometry%projection%compliance, matmul(geometry%projection%dilatation(:, k, :m), of_mode(:m)))
      end associate
   end subroutine set_element_load

   !> Evaluates the shape functions of a kind of element at its quadrature points, unless the last element was of this
   !> kind.
   pure subroutine choose_reference(geometry, kind, n_points)
      type(element_geometry_t), intent(inout) :: geometry !! what belongs to the reference element is set
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: n_points !! number of quadrature points
      real(dp) :: xi(2)
      integer :: point

      if (geometry%kind == kind .and. geometry%n_points == n_points) return
      geometry%kind = kind
      geometry%n_nodes = n_element_nodes(kind)
      geometry%n_points = n_points
      geometry%volume = 0.0_dp
      geometry%values = 0.0_dp
      do point = 1, n_points
         call quadrature_point(kind, n_points, point, xi, geometry%weight(point))
         call shape_functions(kind, xi, geometry%values(:, point), geometry%derivatives(:, :, point))
         if (has_bubble(kind)) call bubble_function(kind, xi, geometry%values(geometry%n_nodes + 1, point), &
            geometry%derivatives(:, geometry%n_nodes + 1, point))
      end do
   end subroutine choose_reference

   !> Stiffness of an element. The bubble takes from that of the nodes what its own displacement relieves.
   pure subroutine element_stiffness(geometry, material, stiffness)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(out) :: stiffness(max_components*max_nodes, max_components*max_nodes)
         !! in the first rows and columns, the components of a node beside each other [F/L]
      real(dp) :: block(2, 2), law(n_strains, n_strains)
      integer :: first, i, j, other

      law = element_law(geometry, material)
      if (material%n_components > 2) stiffness = 0.0_dp
      do j = 1, geometry%n_nodes
         do i = j, geometry%n_nodes
            call find_block(block, geometry, material, law, i, j)
            associate (bubble => geometry%projection%bubble)
               if (geometry%n_functions > geometry%n_nodes) block = block - matmul(transpose( &
                  bubble(:, 2*i - 1:2*i)), matmul(geometry%projection%stiffness, bubble(:, 2*j - 1:2*j)))
            end associate
            first = material%n_components*(i - 1) + 1
            other = material%n_components*(j - 1) + 1
            stiffness(first:first + 1, other:other + 1) = block
            stiffness(other:other + 1, first:first + 1) = transpose(block)
            if (material%n_components == 2) cycle
            stiffness(first + 2, other + 2) = twist_stiffness(geometry, law, i, j)
            stiffness(other + 2, first + 2) = stiffness(first + 2, other + 2)
         end do
      end do
   end subroutine element_stiffness

   !> Stiffness between two nodes that move around the axis: their shears, w,y of y and w,x - w/x of x with this
   !> direction, change no volume and meet no others [F/L].
   pure real(dp) function twist_stiffness(geometry, law, i, j) result(stiffness)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      real(dp), intent(in) :: law(n_strains, n_strains) !! its law [F/L^2]
      integer, intent(in) :: i !! node of the row
      integer, intent(in) :: j !! node of the column
      real(dp) :: a(2), b(2)
      integer :: point

      stiffness = 0.0_dp
      do point = 1, geometry%n_points
         a = twist_shears(geometry, i, point)
         b = twist_shears(geometry, j, point)
         stiffness = stiffness + geometry%volume(point)*(law(5, 5)*a(1)*b(1) + law(6, 6)*a(2)*b(2))
      end do
   end function twist_stiffness

   !> The shears yz and xz that a unit displacement of a node around the axis makes [1/L].
   pure function twist_shears(geometry, node, point) result(shears)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      integer, intent(in) :: node !! the node
      integer, intent(in) :: point !! the quadrature point
      real(dp) :: shears(2)

      shears(1) = geometry%gradient(2, node, point)
      shears(2) = geometry%gradient(1, node, point) - geometry%hoop(node, point)
   end function twist_shears

   !> The law of the strains at a point: with a projected dilatation that of their deviator, whose lambda is -2/3 mu
   !> [F/L^2].
   pure function element_law(geometry, material) result(law)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp) :: law(n_strains, n_strains)

      law = material%law
      if (geometry%n_modes > 0) law = isotropic_law(-2.0_dp*material%mu/3.0_dp, material%mu)
   end function element_law

   !> Stiffness between two shape functions: sum over the points of volume times B_i^T D B_j, D the law and B the
   !> strains of unit displacements. Each mode b of a projected dilatation adds the bulk modulus times b_i b_j^T.
   pure subroutine find_block(block, geometry, material, law, i, j)
      real(dp), intent(out) :: block(2, 2) !! the stiffness [F/L]
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: law(n_strains, n_strains) !! its law, from `element_law` [F/L^2]
      integer, intent(in) :: i !! function of the rows
      integer, intent(in) :: j !! function of the columns
      real(dp) :: xx, xy, yx, yy
      integer :: m, point

      xx = 0.0_dp
      xy = 0.0_dp
      yx = 0.0_dp
      yy = 0.0_dp
      do point = 1, geometry%n_points
         associate (a => geometry%gradient(:, i, point), b => geometry%gradient(:, j, point), &
            volume => geometry%volume(point))
            xx = xx + volume*a(1)*b(1)
            xy = xy + volume*a(1)*b(2)
            yx = yx + volume*a(2)*b(1)
            yy = yy + volume*a(2)*b(2)
         end associate
      end do
      block(1, 1) = law(1, 1)*xx + law(4, 4)*yy + law(4, 1)*(xy + yx)
      block(2, 1) = law(2, 1)*yx + law(4, 4)*xy + law(4, 2)*yy + law(4, 1)*xx
      block(1, 2) = law(2, 1)*xy + law(4, 4)*yx + law(4, 2)*yy + law(4, 1)*xx
      block(2, 2) = law(2, 2)*yy + law(4, 4)*xx + law(4, 2)*(xy + yx)
      if (material%is_axisymmetric) call add_hoop_stiffness(geometry, law(:4, 3), i, j, block)
      do m = 1, geometry%n_modes
         associate (a => geometry%projection%dilatation(:, i, m), b => geometry%projection%dilatation(:, j, m))
            block(:, 1) = block(:, 1) + material%bulk()*(a*b(1))
            block(:, 2) = block(:, 2) + material%bulk()*(a*b(2))
         end associate
      end do
   end subroutine find_block

   !> Adds the contribution of the hoop strain u_r / r to the stiffness between two nodes.
   pure subroutine add_hoop_stiffness(geometry, law, i, j, block)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      real(dp), intent(in) :: law(4) !! stresses of a unit hoop strain [F/L^2]
      integer, intent(in) :: i !! node of the rows
      integer, intent(in) :: j !! node of the columns
      real(dp), intent(inout) :: block(2, 2) !! stiffness between the nodes [F/L]
      real(dp) :: a_by_hoop(2), hoop_by_b(2), hoop_by_hoop, hoop(2)
      integer :: point

      a_by_hoop = 0.0_dp
      hoop_by_b = 0.0_dp
      hoop_by_hoop = 0.0_dp
      do point = 1, geometry%n_points
         hoop = [geometry%hoop(i, point), geometry%hoop(j, point)]
         a_by_hoop = a_by_hoop + geometry%volume(point)*hoop(2)*geometry%gradient(:, i, point)
         hoop_by_b = hoop_by_b + geometry%volume(point)*hoop(1)*geometry%gradient(:, j, point)
         hoop_by_hoop = hoop_by_hoop + geometry%volume(point)*hoop(1)*hoop(2)
      end do
      block(1, 1) = block(1, 1) + law(1)*(a_by_hoop(1) + hoop_by_b(1)) + law(4)*(a_by_hoop(2) + hoop_by_b(2)) &
         + law(3)*hoop_by_hoop
      block(2, 1) = block(2, 1) + law(2)*a_by_hoop(2) + law(4)*a_by_hoop(1)
      block(1, 2) = block(1, 2) + law(2)*hoop_by_b(2) + law(4)*hoop_by_b(1)
   end subroutine add_hoop_stiffness

   !> Computes the elastic strains at all quadrature points.
   pure subroutine find_elastic_strains(geometry, material, displacement, strain)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (components, n_nodes) [L]
      real(dp), intent(inout) :: strain(n_strains, max_points) !! the strains; unchanged past the last point [-]
      real(dp) :: u(2, max_nodes)
      integer :: i, point

      u = nodal_values(geometry, material, displacement)
      do point = 1, geometry%n_points
         strain(:, point) = strain_at(geometry, material, u, point)
         if (material%n_components == 2) cycle
         do i = 1, geometry%n_nodes
            strain(5:, point) = strain(5:, point) + twist_shears(geometry, i, point)*displacement(3, geometry%node(i))
         end do
      end do
   end subroutine find_elastic_strains

   !> The displacements of the nodes of an element and of its bubble; less those of the first node where these are a
   !> rigid motion: differences are exact where they are small [L].
   pure function nodal_values(geometry, material, displacement) result(u)
      type(element_geometry_t), intent(in) :: geometry !! the element's nodes
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp) :: u(2, max_nodes), rigid(2)
      integer :: i

      rigid = displacement(:2, geometry%node(1))
      if (material%is_axisymmetric) rigid(1) = 0.0_dp
      do i = 1, geometry%n_nodes
         u(:, i) = displacement(:2, geometry%node(i)) - rigid
      end do
      associate (n => geometry%n_nodes)
         if (geometry%n_functions > n) u(:, n + 1) = geometry%loaded_bubble &
            + matmul(geometry%projection%bubble(:, :2*n), reshape(u(:, :n), [2*n]))
      end associate
   end function nodal_values

   !> Elastic strain at a quadrature point, the total strain less the thermal one, of displacements along x and y.
   !> Without thermal strain zz is 0 in the plane, except with a projected dilatation, which is the trace then. In
   !> plane stress zz is set to 0 [-].
   pure function strain_at(geometry, material, u, point) result(strain)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: u(2, max_nodes) !! displacements, from `nodal_values` [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: strain(n_strains)
      real(dp) :: excess
      integer :: i, m

      strain = 0.0_dp
      do i = 1, geometry%n_functions
         associate (g => geometry%gradient(:, i, point))
            strain(1) = strain(1) + g(1)*u(1, i)
            strain(2) = strain(2) + g(2)*u(2, i)
            strain(4) = strain(4) + (g(2)*u(1, i) + g(1)*u(2, i))
         end associate
      end do
      if (material%is_axisymmetric) then
         do i = 1, geometry%n_functions
            strain(3) = strain(3) + geometry%hoop(i, point)*u(1, i)
         end do
      end if
      if (geometry%n_modes > 0) then
         excess = strain(1) + strain(2) + strain(3)
         do m = 1, geometry%n_modes
            do i = 1, geometry%n_functions
               excess = excess - geometry%mode(m, point)*dot_product(geometry%projection%dilatation(:, i, m), u(:, i))
            end do
         end do
         strain(:3) = strain(:3) - excess/3.0_dp
      end if
      if (abs(geometry%thermal_strain(point)) > 0.0_dp) strain = strain &
         - geometry%thermal_strain(point)*material%expansion_form()
   end function strain_at

   !> Nodal forces of the stresses of an element: sum over the points of volume times B^T stress. A node moves the
   !> bubble, and so bears its share of the force on that.
   pure subroutine find_nodal_forces(forces, geometry, material, stress)
      real(dp), intent(out) :: forces(max_components, max_nodes)
         !! nodal forces of the element, and the force on its bubble [F]
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: stress(:, :) !! stresses at the points (n_strains, points) [F/L^2]
      real(dp) :: s(n_strains)
      integer :: i, point

      forces = 0.0_dp
      do point = 1, geometry%n_points
         s = stress(:, point)*geometry%volume(point)
         do i = 1, geometry%n_functions
            associate (g => geometry%gradient(:, i, point))
               forces(1, i) = forces(1, i) + (s(1)*g(1) + s(4)*g(2))
               forces(2, i) = forces(2, i) + (s(4)*g(1) + s(2)*g(2))
            end associate
         end do
         if (.not. material%is_axisymmetric) cycle
         do i = 1, geometry%n_functions
            forces(1, i) = forces(1, i) + s(3)*geometry%hoop(i, point)
         end do
         if (material%n_components == 2) cycle
         do i = 1, geometry%n_nodes
            forces(3, i) = forces(3, i) + dot_product(s(5:), twist_shears(geometry, i, point))
         end do
      end do
      associate (n => geometry%n_nodes)
         if (geometry%n_functions > n) forces(:2, :n) = forces(:2, :n) &
            + reshape(matmul(forces(:2, n + 1), geometry%projection%bubble(:, :2*n)), [2, n])
      end associate
   end subroutine find_nodal_forces

   !> Whether an element is a four-node quadrilateral of a plane body in the standard formulation, see
   !> `plane_quadrilateral_t`.
   pure logical function is_plain_quadrilateral(kind, material)
      integer, intent(in) :: kind !! kind of element
      type(material_t), intent(in) :: material !! its material

      is_plain_quadrilateral = kind == quad4 .and. .not. (material%is_axisymmetric .or. material%is_b_bar)
   end function is_plain_quadrilateral

   !> Sets coordinates, gradients and volumes to those of an element.
   pure subroutine plane_quadrilateral_set_element(self, mesh, element)
      class(plane_quadrilateral_t), intent(inout) :: self !! the quadrilateral; its strains are those of before
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      integer :: i

      self%node = mesh%node(mesh%node_start(element):mesh%node_start(element) + 3)
      do i = 1, 4
         self%corner(i, 1) = mesh%coordinates(1, self%node(i))
         self%corner(i, 2) = mesh%coordinates(2, self%node(i))
      end do
      call differentiate(self%corner(:, 1), self%by_xi(:, 1), self%by_eta(:, 1))
      call differentiate(self%corner(:, 2), self%by_xi(:, 2), self%by_eta(:, 2))
      !$omp simd
      do i = 1, 4
         self%area(i) = self%by_xi(i, 1)*self%by_eta(i, 2) - self%by_eta(i, 1)*self%by_xi(i, 2)
      end do
   end subroutine plane_quadrilateral_set_element

   !> Computes strains and stresses under a displacement field.
   pure subroutine plane_quadrilateral_compute_stresses(self, material, displacement)
      class(plane_quadrilateral_t), intent(inout) :: self !! the quadrilateral; gains strains and stresses
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp), dimension(4) :: u, v, u_xi, u_eta, v_xi, v_eta
      integer :: i, k

      do i = 1, 4
         u(i) = displacement(1, self%node(i))
         v(i) = displacement(2, self%node(i))
      end do
      call differentiate(u, u_xi, u_eta)
      call differentiate(v, v_xi, v_eta)
      !$omp simd
      do i = 1, 4
         self%strain(i, 1) = (u_xi(i)*self%by_eta(i, 2) - u_eta(i)*self%by_xi(i, 2))/self%area(i)
         self%strain(i, 2) = (v_eta(i)*self%by_xi(i, 1) - v_xi(i)*self%by_eta(i, 1))/self%area(i)
         self%strain(i, 3) = (u_eta(i)*self%by_xi(i, 1) - u_xi(i)*self%by_eta(i, 1) + v_xi(i)*self%by_eta(i, 2) &
            - v_eta(i)*self%by_xi(i, 2))/self%area(i)
      end do
      do k = 1, 4
         !$omp simd
         do i = 1, 4
            self%stress(i, k) = material%law(k, 1)*self%strain(i, 1) + material%law(k, 2)*self%strain(i, 2) &
               + material%law(k, 4)*self%strain(i, 3)
         end do
      end do
   end subroutine plane_quadrilateral_compute_stresses

   !> Strain energy densities at the four points [F/L^2].
   pure function plane_quadrilateral_energy_density(self) result(density)
      class(plane_quadrilateral_t), intent(in) :: self !! the quadrilateral, deformed
      real(dp) :: density(4)
      integer :: i

      !$omp simd
      do i = 1, 4
         density(i) = 0.5_dp*(self%strain(i, 1)*self%stress(i, 1) + self%strain(i, 2)*self%stress(i, 2) &
            + self%strain(i, 3)*self%stress(i, 4))
      end do
   end function plane_quadrilateral_energy_density

   !> Nodal forces of the stresses: the work of the stresses on each derivative of the displacements, distributed to the
   !> corners whose differences form it (x and y, corner) [F].
   pure function plane_quadrilateral_forces(self, thickness) result(forces)
      class(plane_quadrilateral_t), intent(in) :: self !! the quadrilateral, deformed
      real(dp), intent(in) :: thickness !! its thickness [L]
      real(dp) :: forces(2, 4)
      ! What derivatives along the first and the third side, and along the last and the second one have to do.
      real(dp), dimension(4, 2) :: along, across
      real(dp) :: side(4), half
      integer :: i

      !$omp simd
      do i = 1, 4
         along(i, 1) = self%stress(i, 1)*self%by_eta(i, 2) - self%stress(i, 4)*self%by_eta(i, 1)
         along(i, 2) = self%stress(i, 4)*self%by_eta(i, 2) - self%stress(i, 2)*self%by_eta(i, 1)
         across(i, 1) = self%stress(i, 4)*self%by_xi(i, 1) - self%stress(i, 1)*self%by_xi(i, 2)
         across(i, 2) = self%stress(i, 2)*self%by_xi(i, 1) - self%stress(i, 4)*self%by_xi(i, 2)
      end do
      half = 0.5_dp*thickness
      do i = 1, 2
         ! The weights `first` and `last`, summed where they are alike.
         side(1:2) = half*([near, far]*(along(1, i) + along(2, i)) + [far, near]*(along(3, i) + along(4, i)))
         side(3:4) = half*([near, far]*(across(1, i) + across(4, i)) + [far, near]*(across(2, i) + across(3, i)))
         forces(i, :) = [-side(1) - side(3), side(1) - side(4), side(2) + side(4), side(3) - side(2)]
      end do
   end function plane_quadrilateral_forces

   !> Derivatives by the reference coordinates at the points, from the changes along the sides.
   pure subroutine differentiate(values, by_xi, by_eta)
      real(dp), intent(in) :: values(4) !! values at the corners
      real(dp), intent(out) :: by_xi(4) !! derivatives by the first coordinate at the points
      real(dp), intent(out) :: by_eta(4) !! by the second one
      real(dp) :: side(4)
      integer :: i

      side = 0.5_dp*[values(2) - values(1), values(3) - values(4), values(4) - values(1), values(3) - values(2)]
      !$omp simd
      do i = 1, 4
         by_xi(i) = first(i)*side(1) + (1.0_dp - first(i))*side(2)
         by_eta(i) = last(i)*side(3) + (1.0_dp - last(i))*side(4)
      end do
   end subroutine differentiate

end module amontons_elasticity
