!> Elasticity of one element: stiffness, stress, nodal forces.
!>
!> The four-node quadrilateral of a plane body has procedures of its own that work on its four quadrature points side by
!> side, in a quarter of the time: fine meshes have hundreds of thousands of them.
module amontons_elasticity
   use amontons_dilatation, only: condense_inner, mode_values, new_modes, new_projection, projection_t
   use amontons_element, only: bubble_function, has_bubble, is_solid, max_nodes, max_points, n_element_nodes, &
      n_element_points, quad4, quadrature_point, shape_functions, tet10, tri6
   use amontons_kinds, only: dp
   use amontons_material, only: isotropic_law, material_t, max_components, n_strains
   use amontons_mesh, only: is_straight, mesh_t
   implicit none (type, external)
   private

   public :: element_geometry_t, element_stiffness, find_elastic_strains, find_nodal_forces, &
      is_plain_quadrilateral, new_element_geometry, plane_quadrilateral_t, set_element_load

   !> Shape functions and their gradients at the quadrature points of one element.
   type :: element_geometry_t
      ! What belongs to the reference element alone serves the next element of its kind too.
      integer, private :: kind = 0 !! kind of element
      integer :: n_dim = 2 !! number of dimensions
      integer :: n_points = 0 !! number of quadrature points
      integer :: n_nodes = 0 !! number of nodes
      integer :: n_functions = 0 !! number of shape functions: one more than nodes in an element with a bubble
      integer :: n_modes = 0
         !! number of polynomials that the dilatation is projected to: 1 (the mean), 3 or 4 (1, x, y, z), or 0 for all
      integer :: node(max_nodes) = 0 !! numbers of the nodes in the mesh
      real(dp), allocatable :: values(:, :) !! shape functions, that of a bubble last (function, point) [-]
      real(dp), allocatable, private :: derivatives(:, :, :)
         !! derivatives by the reference coordinates (function, n_dim, point) [-]
      real(dp), allocatable, private :: weight(:) !! weights of the quadrature (points) [-]
      real(dp), allocatable :: thermal_strain(:)
         !! strain of free thermal expansion at the points, from `set_element_load`; the next element keeps it [-]
      real(dp) :: loaded_bubble(3) = 0.0_dp
         !! displacement of the bubble by heat and body forces where the nodes are at rest, from there, too [L]
      real(dp), allocatable :: gradient(:, :, :)
         !! gradients of the functions; in a body of revolution the functions over the radius stand in the third place
         !! (function, 3, point) [1/L]
      real(dp), allocatable :: position(:, :) !! coordinates of the points (n_dim, points) [L]
      real(dp), allocatable :: volume(:) !! quadrature weight, Jacobian and depth of each point (points) [L^3]
      real(dp), allocatable, private :: mode(:, :) !! values of the polynomials (mode, point) [L^-3/2]
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
      ! Not of the size they need: room that is found at run time comes from the heap, once for each element.
      real(dp) :: x(2, max_nodes), in_space(3, max_nodes)
      integer :: i, first, n, point

      associate (kind => mesh%element_kind(element))
         n = n_stiffness_points(mesh, element, material)
         if (present(n_points)) n = n_points
         if (geometry%kind /= kind .or. geometry%n_points /= n) call choose_reference(geometry, kind, n)
      end associate
      geometry%n_modes = 0
      if (material%is_b_bar) geometry%n_modes = n_projected(geometry%kind)
      geometry%n_functions = geometry%n_nodes
      if (geometry%n_modes > 0 .and. has_bubble(geometry%kind)) geometry%n_functions = geometry%n_nodes + 1
      first = mesh%node_start(element)
      do i = 1, geometry%n_nodes
         geometry%node(i) = mesh%node(first + i - 1)
         if (geometry%n_dim == 2) x(:, i) = mesh%coordinates(:2, geometry%node(i))
         if (geometry%n_dim == 3) in_space(:, i) = mesh%coordinates(:3, geometry%node(i))
      end do
      associate (n => size(geometry%values, 1), n_points => geometry%n_points)
         if (geometry%n_dim == 3) then
            call place_solid(geometry, in_space(:, :geometry%n_nodes))
         else
            call place_plane(geometry%gradient, geometry%position, geometry%volume, geometry%derivatives, &
               geometry%values, geometry%weight, x, geometry%n_nodes, material%is_axisymmetric, n, n_points)
         end if
         do point = 1, n_points
            geometry%volume(point) = geometry%volume(point)*material%depth(geometry%position(1, point))
         end do
      end associate
      if (geometry%n_modes > 0) call project_dilatation(geometry, mesh, element, material)
   end subroutine new_element_geometry

   ! The arrays of a geometry have explicit shapes in the procedures that all elements pass through: their descriptors
   ! would be read again at each access.

   !> Sets places, gradients and areas at the points of a plane element.
   ! allow(S902): arrays of explicit shape, whose descriptors nothing reads again
   pure subroutine place_plane(gradient, position, area, derivatives, values, weight, x, n_nodes, is_round, n, n_points)
      integer, intent(in) :: n !! number of functions that there is room for
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(inout) :: gradient(n, 3, n_points) !! gradients, as of `element_geometry_t` [1/L]
      real(dp), intent(out) :: position(2, n_points) !! coordinates of the points [L]
      real(dp), intent(out) :: area(n_points) !! their shares of the area [L^2]
      real(dp), intent(in) :: derivatives(n, 2, n_points) !! derivatives by the reference coordinates [-]
      real(dp), intent(in) :: values(n, n_points) !! shape functions [-]
      real(dp), intent(in) :: weight(n_points) !! weights of the quadrature [-]
      real(dp), intent(in) :: x(2, max_nodes) !! coordinates of the nodes [L]
      integer, intent(in) :: n_nodes !! number of nodes
      logical, intent(in) :: is_round !! whether the body is one of revolution
      real(dp) :: dx(2), dy(2), determinant
      integer :: i, point

      do point = 1, n_points
         position(:, point) = 0.0_dp
         ! The derivatives of x and of y by the reference coordinates are the rows of the Jacobian.
         dx = 0.0_dp
         dy = 0.0_dp
         do i = 1, n_nodes
            position(:, point) = position(:, point) + values(i, point)*x(:, i)
            dx = dx + x(1, i)*derivatives(i, :, point)
            dy = dy + x(2, i)*derivatives(i, :, point)
         end do
         determinant = dx(1)*dy(2) - dx(2)*dy(1)
         dx = dx/determinant
         dy = dy/determinant
         !$omp simd
         do i = 1, n
            gradient(i, 1, point) = dy(2)*derivatives(i, 1, point) - dy(1)*derivatives(i, 2, point)
            gradient(i, 2, point) = dx(1)*derivatives(i, 2, point) - dx(2)*derivatives(i, 1, point)
         end do
         if (is_round) gradient(:, 3, point) = values(:, point)/position(1, point)
         area(point) = weight(point)*determinant
      end do
   end subroutine place_plane

   !> Sets places, gradients and volumes at the points of a solid element: the rows of the inverse Jacobian are the
   !> vector products of its columns, over the determinant.
   pure subroutine place_solid(geometry, x)
      type(element_geometry_t), intent(inout) :: geometry !! the element; gains these
      real(dp), intent(in) :: x(:, :) !! coordinates of the nodes (3, nodes) [L]
      real(dp) :: jacobian(3, 3), inverse(3, 3), determinant
      integer :: k, point

      do point = 1, geometry%n_points
         geometry%position(:, point) = matmul(x, geometry%values(:size(x, 2), point))
         jacobian = matmul(x, geometry%derivatives(:size(x, 2), :, point))
         do k = 1, 3
            associate (a => jacobian(:, mod(k, 3) + 1), b => jacobian(:, mod(k + 1, 3) + 1))
               inverse(:, k) = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
            end associate
         end do
         determinant = dot_product(jacobian(:, 1), inverse(:, 1))
         inverse = inverse/determinant
         do k = 1, 3
            geometry%gradient(:, k, point) = inverse(k, 1)*geometry%derivatives(:, 1, point) &
               + inverse(k, 2)*geometry%derivatives(:, 2, point) + inverse(k, 3)*geometry%derivatives(:, 3, point)
         end do
         geometry%volume(point) = geometry%weight(point)*determinant
      end do
   end subroutine place_solid

   !> Number of polynomials that the dilatation of a kind of element can be projected to: the mean in linear
   !> quadrilaterals and hexahedra, 1, x, y, z in quadratic elements, none in linear triangles and tetrahedra.
   elemental integer function n_projected(kind) result(n_modes)
      integer, intent(in) :: kind !! kind of element
      integer, parameter :: of_kind(*) = [0, 1, 3, 3, 3, 0, 4, 1, 4]

      n_modes = of_kind(kind)
   end function n_projected

   !> Number of quadrature points of the stiffness: those of degree 4 in a triangle with a bubble, whose gradient is
   !> quadratic, of degree 5 in a tetrahedron with a bubble, or a curved one.
   pure integer function n_stiffness_points(mesh, element, material) result(n_points)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      type(material_t), intent(in) :: material !! its material
      logical :: is_raised

      associate (kind => mesh%element_kind(element))
         is_raised = material%is_axisymmetric .or. (material%is_b_bar .and. any(kind == [tri6, tet10]))
         if (kind == tet10 .and. .not. is_raised) is_raised = .not. is_straight(mesh, element)
         n_points = n_element_points(kind, is_raised)
      end associate
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
      real(dp) :: inner(geometry%n_dim, geometry%n_dim*geometry%n_functions), block(3, 3), share
      integer :: i, m, point

      associate (n => geometry%n_functions, n_points => geometry%n_points, modes => geometry%n_modes, &
         d => geometry%n_dim, projection => geometry%projection)
         if (n_points /= n_stiffness_points(mesh, element, material)) then
            allocate (standard)
            call new_element_geometry(standard, mesh, element, material)
            geometry%projection = standard%projection
         else
            call new_projection(projection, d, n, modes)
            call new_modes(projection%center, projection%factor, geometry%position, geometry%volume)
         end if
         do point = 1, n_points
            geometry%mode(:modes, point) = mode_values(projection%center, projection%factor, &
               geometry%position(:, point))
         end do
         if (allocated(standard)) return
         projection%dilatation = 0.0_dp
         projection%share = 0.0_dp
         do m = 1, modes
            do point = 1, n_points
               share = geometry%volume(point)*geometry%mode(m, point)
               do i = 1, n
                  projection%dilatation(:, i, m) = projection%dilatation(:, i, m) &
                     + share*geometry%gradient(i, :d, point)
                  projection%share(i, m) = projection%share(i, m) + share*geometry%values(i, point)
                  if (material%is_axisymmetric) projection%dilatation(1, i, m) = projection%dilatation(1, i, m) &
                     + share*geometry%gradient(i, 3, point)
               end do
            end do
         end do
         if (n == geometry%n_nodes) return
         do i = 1, n
            call find_block(block, geometry, material, law_of_slopes(geometry, material), n, i)
            inner(:, d*(i - 1) + 1:d*i) = block(:d, :d)
         end do
         projection%stiffness = inner(:, d*(n - 1) + 1:)
         call condense_inner(projection%bubble, projection%compliance, inner)
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
      real(dp) :: of_mode(geometry%n_modes)
      integer :: first

      associate (n => geometry%n_points, m => geometry%n_modes, k => geometry%n_functions, &
         at_nodes => load(mesh%node_start(element):mesh%node_start(element + 1) - 1))
         if (m == 0) then
            geometry%thermal_strain = matmul(at_nodes, geometry%values(:geometry%n_nodes, :n))
            return
         end if
         of_mode = matmul(at_nodes, geometry%projection%share(:geometry%n_nodes, :m))
         geometry%thermal_strain = matmul(of_mode, geometry%mode(:m, :n))
         if (k == geometry%n_nodes) return
         first = size(mesh%node) + geometry%n_dim*(element - 1)
         geometry%loaded_bubble(:geometry%n_dim) = load(first + 1:first + geometry%n_dim) + 3.0_dp*material%bulk() &
            *matmul(geometry%projection%compliance, matmul(geometry%projection%dilatation(:, k, :m), of_mode))
      end associate
   end subroutine set_element_load

   !> Evaluates the shape functions of a kind of element at its quadrature points, unless the last element was of this
   !> kind.
   pure subroutine choose_reference(geometry, kind, n_points)
      type(element_geometry_t), intent(inout) :: geometry !! what belongs to the reference element is set
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: n_points !! number of quadrature points
      real(dp) :: xi(merge(3, 2, is_solid(kind))), values(max_nodes), derivatives(size(xi), max_nodes)
      integer :: n, point

      if (allocated(geometry%values)) deallocate (geometry%values, geometry%derivatives, geometry%weight, &
         geometry%gradient, geometry%position, geometry%volume, geometry%mode, geometry%thermal_strain)
      geometry%kind = kind
      geometry%n_dim = size(xi)
      geometry%n_nodes = n_element_nodes(kind)
      geometry%n_points = n_points
      n = geometry%n_nodes
      if (has_bubble(kind)) n = n + 1
      allocate (geometry%values(n, n_points), geometry%derivatives(n, size(xi), n_points), geometry%weight(n_points), &
         geometry%gradient(n, 3, n_points), geometry%position(size(xi), n_points), geometry%volume(n_points), &
         geometry%mode(n_projected(kind), n_points))
      allocate (geometry%thermal_strain(n_points), source=0.0_dp)
      do point = 1, n_points
         call quadrature_point(kind, n_points, point, xi, geometry%weight(point))
         call shape_functions(kind, xi, values, derivatives)
         if (has_bubble(kind)) call bubble_function(kind, xi, values(n), derivatives(:, n))
         geometry%values(:, point) = values(:n)
         geometry%derivatives(:, :, point) = transpose(derivatives(:, :n))
      end do
   end subroutine choose_reference

   !> Stiffness of an element. The bubble takes from that of the nodes what its own displacement relieves.
   pure subroutine element_stiffness(geometry, material, stiffness)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(out) :: stiffness(max_components*max_nodes, max_components*max_nodes)
         !! in the first rows and columns, the components of a node beside each other [F/L]
      real(dp) :: block(3, 3), law(3, 3, 3, 3)
      integer :: column, i, j, row

      law = law_of_slopes(geometry, material)
      associate (n => material%n_components, d => geometry%n_dim, bubble => geometry%projection%bubble)
         do j = 1, geometry%n_nodes
            column = n*(j - 1)
            do i = j, geometry%n_nodes
               row = n*(i - 1)
               call find_block(block, geometry, material, law, i, j)
               if (geometry%n_functions > geometry%n_nodes) block(:d, :d) = block(:d, :d) - matmul(transpose( &
                  bubble(:, d*(i - 1) + 1:d*i)), matmul(geometry%projection%stiffness, bubble(:, d*(j - 1) + 1:d*j)))
               stiffness(row + 1:row + n, column + 1:column + n) = block(:n, :n)
               stiffness(column + 1:column + n, row + 1:row + n) = transpose(block(:n, :n))
            end do
         end do
      end associate
   end subroutine element_stiffness

   !> Stiffness between two shape functions: sum over the points of volume times B_i^T D B_j, D the law and B the
   !> strains of unit displacements. Each mode b of a projected dilatation adds the bulk modulus times b_i b_j^T.
   pure subroutine find_block(block, geometry, material, law, i, j)
      real(dp), intent(out) :: block(3, 3) !! the stiffness, in the first rows and columns [F/L]
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: law(3, 3, 3, 3) !! its law, from `law_of_slopes` [F/L^2]
      integer, intent(in) :: i !! function of the rows
      integer, intent(in) :: j !! function of the columns
      integer :: k, m

      call sum_products(block, law, geometry%gradient, geometry%volume, i, j, n_slopes(geometry, material), &
         material%n_components, size(geometry%values, 1), geometry%n_points)
      do m = 1, geometry%n_modes
         associate (a => geometry%projection%dilatation(:, i, m), b => geometry%projection%dilatation(:, j, m))
            do k = 1, geometry%n_dim
               block(:geometry%n_dim, k) = block(:geometry%n_dim, k) + material%bulk()*(a*b(k))
            end do
         end associate
      end do
   end subroutine find_block

   !> Sums the products of the slopes of two functions over the points, and contracts them with the law. The numbers of
   !> slopes are written out, so that the loops over them are unrolled.
   ! allow(S902): as above
   pure subroutine sum_products(block, law, gradient, volume, i, j, n_slopes, n_components, room, n_points)
      real(dp), intent(out) :: block(3, 3) !! as of `find_block` [F/L]
      real(dp), intent(in) :: law(3, 3, 3, 3) !! as there [F/L^2]
      integer, intent(in) :: room !! number of functions that there is room for
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(in) :: gradient(room, 3, n_points) !! slopes of the functions [1/L]
      real(dp), intent(in) :: volume(n_points) !! volumes of the points [L^3]
      integer, intent(in) :: i !! the first function
      integer, intent(in) :: j !! the second one
      integer, intent(in) :: n_slopes !! number of slopes, 2 or 3
      integer, intent(in) :: n_components !! number of components of a displacement
      real(dp) :: products(3, 3), own(3), xx, yx, xy, yy
      integer :: k, l, point

      if (n_slopes == 2) then
         xx = 0.0_dp
         yx = 0.0_dp
         xy = 0.0_dp
         yy = 0.0_dp
         do point = 1, n_points
            xx = xx + volume(point)*gradient(i, 1, point)*gradient(j, 1, point)
            yx = yx + volume(point)*gradient(i, 2, point)*gradient(j, 1, point)
            xy = xy + volume(point)*gradient(i, 1, point)*gradient(j, 2, point)
            yy = yy + volume(point)*gradient(i, 2, point)*gradient(j, 2, point)
         end do
         do l = 1, 2
            do k = 1, 2
               block(k, l) = law(1, 1, k, l)*xx + law(2, 1, k, l)*yx + law(1, 2, k, l)*xy + law(2, 2, k, l)*yy
            end do
         end do
         return
      end if
      products = 0.0_dp
      do point = 1, n_points
         own = volume(point)*gradient(i, :, point)
         do l = 1, 3
            products(:, l) = products(:, l) + own*gradient(j, l, point)
         end do
      end do
      do l = 1, n_components
         do k = 1, n_components
            associate (c => law(:, :, k, l))
               block(k, l) = dot_product(c(:, 1), products(:, 1)) + dot_product(c(:, 2), products(:, 2)) &
                  + dot_product(c(:, 3), products(:, 3))
            end associate
         end do
      end do
   end subroutine sum_products

   !> Number of slopes of a function that strains are made of: its gradient, and in a body of revolution the function
   !> over the radius.
   pure integer function n_slopes(geometry, material)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material

      n_slopes = merge(3, geometry%n_dim, material%is_axisymmetric)
   end function n_slopes

   !> The law of the slopes: what slope a of component k bears where component l has slope b (a, b, k, l) [F/L^2]. With
   !> a projected dilatation it is that of the deviator, whose lambda is -2/3 mu.
   pure function law_of_slopes(geometry, material) result(law)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp) :: law(3, 3, 3, 3)
      ! The strain that each slope of a component makes, 0 for none (slope, component): around the axis those of w are
      ! w,y and w,x - w/x.
      integer, parameter :: in_space(3, 3) = reshape([1, 4, 6, 4, 2, 5, 6, 5, 3], [3, 3]), &
         around(3, 3) = reshape([1, 4, 3, 4, 2, 0, 6, 5, -6], [3, 3])
      real(dp) :: of_strains(n_strains, n_strains)
      integer :: a, b, k, l, strain(3, 3)

      of_strains = material%law
      if (geometry%n_modes > 0) of_strains = isotropic_law(-2.0_dp*material%mu/3.0_dp, material%mu)
      strain = around
      if (geometry%n_dim == 3) strain = in_space
      do l = 1, material%n_components
         do k = 1, material%n_components
            do b = 1, n_slopes(geometry, material)
               do a = 1, n_slopes(geometry, material)
                  law(a, b, k, l) = 0.0_dp
                  if (strain(a, k)*strain(b, l) /= 0) law(a, b, k, l) = sign(1, strain(a, k)*strain(b, l)) &
                     *of_strains(abs(strain(a, k)), abs(strain(b, l)))
               end do
            end do
         end do
      end do
   end function law_of_slopes

   !> Computes the elastic strains at all quadrature points.
   pure subroutine find_elastic_strains(geometry, material, displacement, strain)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (components, n_nodes) [L]
      real(dp), intent(inout) :: strain(n_strains, max_points) !! the strains; unchanged past the last point [-]
      real(dp) :: u(max_components*max_nodes)
      integer :: i, point

      call find_nodal_values(u, geometry%n_dim, geometry%n_functions, geometry, material, displacement)
      do point = 1, geometry%n_points
         strain(:, point) = strain_at(geometry, material, u, geometry%n_dim, geometry%n_functions, point)
         if (.not. material%is_twisted) cycle
         do i = 1, geometry%n_nodes
            associate (gradient => geometry%gradient(i, :, point))
               strain(5:, point) = strain(5:, point) + [gradient(2), gradient(1) - gradient(3)] &
                  *displacement(3, geometry%node(i))
            end associate
         end do
      end do
   end subroutine find_elastic_strains

   !> Finds the displacements of the nodes of an element and of its bubble; less those of the first node where these
   !> are a rigid motion: differences are exact where they are small.
   pure subroutine find_nodal_values(u, n_dim, n_functions, geometry, material, displacement)
      integer, intent(in) :: n_dim !! number of dimensions
      integer, intent(in) :: n_functions !! number of functions of the element
      real(dp), intent(out) :: u(n_dim, n_functions) !! the displacements [L]
      type(element_geometry_t), intent(in) :: geometry !! the element's nodes
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (components, n_nodes) [L]
      real(dp) :: rigid(max_components)
      integer :: i

      associate (n => geometry%n_nodes)
         rigid(:n_dim) = displacement(:n_dim, geometry%node(1))
         if (material%is_axisymmetric) rigid(1) = 0.0_dp
         do i = 1, n
            u(:, i) = displacement(:n_dim, geometry%node(i)) - rigid(:n_dim)
         end do
         if (n_functions > n) u(:, n + 1) = geometry%loaded_bubble(:n_dim) &
            + matmul(geometry%projection%bubble, reshape(u(:, :n), [n_dim*n]))
      end associate
   end subroutine find_nodal_values

   !> Elastic strain at a quadrature point, the total strain less the thermal one, of displacements in the dimensions
   !> of the mesh. Without thermal strain zz is 0 in the plane, except with a projected dilatation, which is the trace
   !> then. In plane stress zz is set to 0 [-].
   pure function strain_at(geometry, material, u, n_dim, n_functions, point) result(strain)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      integer, intent(in) :: n_dim !! number of dimensions
      integer, intent(in) :: n_functions !! number of functions of the element
      real(dp), intent(in) :: u(n_dim, n_functions) !! displacements, from `find_nodal_values` [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: strain(n_strains)
      real(dp) :: excess
      integer :: i, m

      strain = 0.0_dp
      call add_strains(strain, geometry%gradient(1, 1, point), u, n_dim, n_functions, material%is_axisymmetric, &
         size(geometry%values, 1))
      if (geometry%n_modes > 0) then
         excess = strain(1) + strain(2) + strain(3)
         do m = 1, geometry%n_modes
            do i = 1, n_functions
               excess = excess - geometry%mode(m, point)*dot_product(geometry%projection%dilatation(:, i, m), u(:, i))
            end do
         end do
         strain(:3) = strain(:3) - excess/3.0_dp
      end if
      if (abs(geometry%thermal_strain(point)) > 0.0_dp) strain = strain &
         - geometry%thermal_strain(point)*material%expansion_form()
   end function strain_at

   !> Adds the strains of displacements in the dimensions of the mesh.
   pure subroutine add_strains(strain, gradient, u, n_dim, n, is_round, room)
      integer, intent(in) :: n_dim !! number of dimensions
      integer, intent(in) :: n !! number of functions
      real(dp), intent(inout) :: strain(n_strains) !! the strain; gains these [-]
      logical, intent(in) :: is_round !! whether the body is one of revolution
      integer, intent(in) :: room !! number of functions that there is room for
      real(dp), intent(in) :: gradient(room, 3) !! gradients of the functions, as of `element_geometry_t` [1/L]
      real(dp), intent(in) :: u(n_dim, n) !! the displacements [L]
      integer :: i

      do i = 1, n
         strain(1) = strain(1) + gradient(i, 1)*u(1, i)
         strain(2) = strain(2) + gradient(i, 2)*u(2, i)
         strain(4) = strain(4) + (gradient(i, 2)*u(1, i) + gradient(i, 1)*u(2, i))
         if (is_round) strain(3) = strain(3) + gradient(i, 3)*u(1, i)
         if (n_dim == 2) cycle
         strain(3) = strain(3) + gradient(i, 3)*u(3, i)
         strain(5) = strain(5) + (gradient(i, 3)*u(2, i) + gradient(i, 2)*u(3, i))
         strain(6) = strain(6) + (gradient(i, 3)*u(1, i) + gradient(i, 1)*u(3, i))
      end do
   end subroutine add_strains

   !> Adds the nodal forces of a stress at a point in the dimensions of the mesh.
   pure subroutine add_forces(forces, s, gradient, n_dim, n, is_round, room)
      integer, intent(in) :: n_dim !! number of dimensions
      integer, intent(in) :: n !! number of functions
      real(dp), intent(inout) :: forces(max_components, n) !! the forces; gain these [F]
      real(dp), intent(in) :: s(n_strains) !! stress times volume [F L]
      logical, intent(in) :: is_round !! whether the body is one of revolution
      integer, intent(in) :: room !! number of functions that there is room for
      real(dp), intent(in) :: gradient(room, 3) !! gradients of the functions, as of `element_geometry_t` [1/L]
      integer :: i

      do i = 1, n
         if (n_dim == 2) then
            forces(1, i) = forces(1, i) + (s(1)*gradient(i, 1) + s(4)*gradient(i, 2))
            forces(2, i) = forces(2, i) + (s(4)*gradient(i, 1) + s(2)*gradient(i, 2))
            if (is_round) forces(1, i) = forces(1, i) + s(3)*gradient(i, 3)
         else
            forces(1, i) = forces(1, i) + (s(1)*gradient(i, 1) + s(4)*gradient(i, 2) + s(6)*gradient(i, 3))
            forces(2, i) = forces(2, i) + (s(4)*gradient(i, 1) + s(2)*gradient(i, 2) + s(5)*gradient(i, 3))
            forces(3, i) = forces(3, i) + (s(6)*gradient(i, 1) + s(5)*gradient(i, 2) + s(3)*gradient(i, 3))
         end if
      end do
   end subroutine add_forces

   !> Nodal forces of the stresses of an element: sum over the points of volume times B^T stress. A node moves the
   !> bubble, and so bears its share of the force on that.
   pure subroutine find_nodal_forces(forces, geometry, material, stress)
      real(dp), intent(out) :: forces(max_components, max_nodes)
         !! nodal forces of the element, and the force on its bubble; not set past these [F]
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: stress(:, :) !! stresses at the points (n_strains, points) [F/L^2]
      real(dp) :: s(n_strains)
      integer :: i, point

      forces(:, :geometry%n_functions) = 0.0_dp
      do point = 1, geometry%n_points
         s = stress(:, point)*geometry%volume(point)
         call add_forces(forces, s, geometry%gradient(1, 1, point), geometry%n_dim, geometry%n_functions, &
            material%is_axisymmetric, size(geometry%values, 1))
         if (.not. material%is_twisted) cycle
         do i = 1, geometry%n_nodes
            associate (gradient => geometry%gradient(i, :, point))
               forces(3, i) = forces(3, i) + dot_product(s(5:), [gradient(2), gradient(1) - gradient(3)])
            end associate
         end do
      end do
      associate (n => geometry%n_nodes, d => geometry%n_dim)
         if (geometry%n_functions > n) forces(:d, :n) = forces(:d, :n) &
            + reshape(matmul(forces(:d, n + 1), geometry%projection%bubble), [d, n])
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
