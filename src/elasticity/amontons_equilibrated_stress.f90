!> A stress field that is in equilibrium at every point of a mesh of three-node triangles, and how far it is from that
!> of displacements.
!>
!> In each of the three parts that the center of a triangle makes of it, the stress is linear, with continuous tractions
!> (Johnson and Mercier, Numer. Math. 30, 1978). Tractions on the sides that are in equilibrium with a uniform load
!> determine it: at a corner by the tractions on both sides, in the center by the equilibrium of the parts.
module amontons_equilibrated_stress
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_equilibrated_sides, only: element_forces_t, next
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: stress_distance

   !> Products of two of three numbers.
   integer, parameter :: n_products = 6

contains

   !> The norm of the stresses of displacements less those in equilibrium [sqrt(F L)].
   real(dp) function stress_distance(mesh, materials, moment, body_force, forces, displacement, thermal_strain) &
      result(distance)
      type(mesh_t), intent(in) :: mesh !! a checked mesh of three-node triangles
      type(materials_t), intent(in) :: materials !! its materials, of a plane body
      real(dp), intent(in) :: moment(:, :, :, :)
         !! moments of the tractions in equilibrium, from `find_side_moments` (2, 2, 3, n_elements) [F]
      real(dp), intent(in) :: body_force(:, :) !! force per volume of each element, x and y (2, n_elements) [F/L^3]
      type(element_forces_t), intent(in) :: forces(:) !! have the stresses of the displacements (n_elements)
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      type(element_geometry_t) :: geometry
      real(dp) :: form(3, size(materials%list)), stress(3, 3), x(2, 3)
      real(dp), allocatable :: squared(:)
      integer :: i, k

      form = squared_norms(materials)
      allocate (squared(mesh%n_elements))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(stress, x, k) &
      !$omp shared(mesh, materials, moment, body_force, forces, displacement, thermal_strain, form, squared)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)), first => mesh%node_start(i))
            if (present(thermal_strain)) then
               call new_element_geometry(geometry, mesh, i, material, 1)
               call find_corner_stresses(stress, geometry, material, displacement, thermal_strain(first:first + 2))
            else
               do k = 1, 3
                  stress(:, k) = forces(i)%solved
               end do
            end if
            do k = 1, 3
               x(:, k) = mesh%coordinates(:, mesh%node(first - 1 + k))
            end do
            squared(i) = material%thickness*element_distance(form(:, materials%of_element(i)), x, &
               moment(:, :, :, i)/material%thickness, body_force(:, i), stress)
         end associate
      end do
      !$omp end parallel do
      distance = sqrt(sum(squared))
   end function stress_distance

   !> What the squared norm of plane stresses is made of in each material: a (xx^2 + yy^2) + b xx yy + c xy^2 (a, b, c)
   !> [L^2/F].
   pure function squared_norms(materials) result(form)
      type(materials_t), intent(in) :: materials !! the materials, of a plane body
      real(dp) :: form(3, size(materials%list))
      integer :: i

      do i = 1, size(materials%list)
         associate (material => materials%list(i))
            form(1, i) = material%squared_norm([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp])
            form(2, i) = material%squared_norm([1.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]) - 2.0_dp*form(1, i)
            form(3, i) = material%squared_norm([0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp])
         end associate
      end do
   end function squared_norms

   !> Evaluates the stresses of displacements at the corners of an element. The strain of the displacements is that of
   !> the whole element, the thermal one is linear.
   pure subroutine find_corner_stresses(stress, geometry, material, displacement, thermal_strain)
      real(dp), intent(out) :: stress(3, 3) !! xx, yy, xy at each corner [F/L^2]
      type(element_geometry_t), intent(inout) :: geometry !! the element's shape functions at its center
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp), intent(in) :: thermal_strain(3) !! strain of free thermal expansion at the corners [-]
      real(dp) :: here(4)
      integer :: k

      do k = 1, 3
         call set_thermal_strain(geometry, spread(thermal_strain(k), 1, 3))
         here = element_stress(geometry, material, displacement, 1)
         stress(:, k) = here(:3)
      end do
   end subroutine find_corner_stresses

   !> The square of the norm of an element's stresses less those in equilibrium, for a depth of 1 [F].
   !>
   !> Stresses are sums s_k t_k t_k^T of the vectors t_k along the sides. A stress puts the force
   !> 2 A (s_(k-1) t_(k-1) - s_(k+1) t_(k+1)) on side k, so that tractions and equilibrium are relations of the numbers
   !> s_k alone, the same in all triangles; only their squares know the shape.
   pure real(dp) function element_distance(form, x, moment, body_force, stress) result(distance)
      real(dp), intent(in) :: form(3) !! its material's, from `squared_norms` [L^2/F]
      real(dp), intent(in) :: x(2, 3) !! its corners [L]
      real(dp), intent(in) :: moment(2, 2, 3)
         !! moments of the tractions at the first and second corner of each side, over the depth [F/L]
      real(dp), intent(in) :: body_force(2) !! force per volume, x and y [F/L^3]
      real(dp), intent(in) :: stress(3, 3) !! its stresses at the corners, linear between them [F/L^2]
      real(dp), dimension(3, 3) :: at_first, at_second, of_stress
      real(dp) :: along(2, 3), at_center(3), products(n_products), area
      integer :: k

      along(:, 1) = x(:, 2) - x(:, 1)
      along(:, 2) = x(:, 3) - x(:, 2)
      along(:, 3) = x(:, 1) - x(:, 3)
      area = 0.5_dp*cross(along(:, 1), along(:, 2))
      call find_stress(at_first, at_second, at_center, along, area, moment, body_force)
      do k = 1, 3
         of_stress(:, k) = along_sides(stress(:, k), along, area)
      end do
      at_center = at_center - (of_stress(:, 1) + of_stress(:, 2) + of_stress(:, 3))/3.0_dp
      at_first = at_first - of_stress
      do k = 1, 3
         at_second(:, k) = at_second(:, k) - of_stress(:, next(k))
      end do
      products = 0.0_dp
      do k = 1, 3
         ! The middles of the sides of a part integrate squares of what is linear there.
         call add_products(products, at_first(:, k) + at_second(:, k))
         call add_products(products, at_second(:, k) + at_center)
         call add_products(products, at_center + at_first(:, k))
      end do
      distance = products(1)*side_product(form, along(:, 1), along(:, 1)) &
         + products(2)*side_product(form, along(:, 2), along(:, 2)) &
         + products(3)*side_product(form, along(:, 3), along(:, 3)) &
         + 2.0_dp*(products(4)*side_product(form, along(:, 1), along(:, 2)) &
         + products(5)*side_product(form, along(:, 2), along(:, 3)) &
         + products(6)*side_product(form, along(:, 3), along(:, 1)))
      distance = area/36.0_dp*distance
   end function element_distance

   !> Adds the products of three numbers: squares, and those of first and second, second and third, third and first.
   pure subroutine add_products(products, s)
      real(dp), intent(inout) :: products(n_products) !! the products
      real(dp), intent(in) :: s(3) !! the numbers

      products(:3) = products(:3) + s**2
      products(4) = products(4) + s(1)*s(2)
      products(5) = products(5) + s(2)*s(3)
      products(6) = products(6) + s(3)*s(1)
   end subroutine add_products

   !> Finds the stress in equilibrium with the tractions and the load of an element. Written out for each side: loops
   !> over them take five times as long.
   pure subroutine find_stress(a, b, center, along, area, moment, body_force)
      real(dp), intent(out) :: a(3, 3)
         !! s_1, s_2, s_3 at the first corner of the side of each part; the parts are those of the sides [F/L^4]
      real(dp), intent(out) :: b(3, 3) !! s_1, s_2, s_3 at its second corner [F/L^4]
      real(dp), intent(out) :: center(3) !! s_1, s_2, s_3 in the center, of all parts [F/L^4]
      real(dp), intent(in) :: along(2, 3) !! the sides [L]
      real(dp), intent(in) :: area !! the area [L^2]
      real(dp), intent(in) :: moment(2, 2, 3) !! as in `element_distance` [F/L]
      real(dp), intent(in) :: body_force(2) !! force per volume, x and y [F/L^3]
      real(dp) :: by_load(3, 3), inverse, jump(3), rise(3)
      logical :: is_loaded

      inverse = 0.5_dp/area**2
      is_loaded = abs(body_force(1)) + abs(body_force(2)) > 0.0_dp
      call find_ends(a(3, 1), b(3, 1), along(:, 2), moment(:, :, 1), inverse)
      call find_ends(a(2, 1), b(2, 1), along(:, 3), moment(:, :, 1), inverse)
      call find_ends(a(1, 2), b(1, 2), along(:, 3), moment(:, :, 2), inverse)
      call find_ends(a(3, 2), b(3, 2), along(:, 1), moment(:, :, 2), inverse)
      call find_ends(a(2, 3), b(2, 3), along(:, 1), moment(:, :, 3), inverse)
      call find_ends(a(1, 3), b(1, 3), along(:, 2), moment(:, :, 3), inverse)
      if (is_loaded) then
         call find_load_stress(by_load, along, area, body_force)
         call remove_load(a, b, by_load)
      end if
      ! Two parts that meet at a corner have one traction along the line to the center.
      jump = 2.0_dp*[b(3, 1) - a(3, 2), b(1, 2) - a(1, 3), b(2, 3) - a(2, 1)]
      b(1, 1) = a(1, 2) - jump(1)
      a(2, 2) = b(2, 1) + jump(1)
      b(2, 2) = a(2, 3) - jump(2)
      a(3, 3) = b(3, 2) + jump(2)
      b(3, 3) = a(3, 1) - jump(3)
      a(1, 1) = b(1, 3) + jump(3)
      ! Each part is in equilibrium for two of the three numbers in the center; the mean of what two parts say.
      rise = [b(1, 1) - a(1, 1), b(2, 2) - a(2, 2), b(3, 3) - a(3, 3)]
      center(1) = 2.0_dp*(a(1, 2) + b(1, 3)) + b(1, 2) + a(1, 3) + rise(3) - rise(2)
      center(2) = 2.0_dp*(a(2, 3) + b(2, 1)) + b(2, 3) + a(2, 1) + rise(1) - rise(3)
      center(3) = 2.0_dp*(a(3, 1) + b(3, 2)) + b(3, 1) + a(3, 2) + rise(2) - rise(1)
      center = center/6.0_dp
      if (.not. is_loaded) return
      a = a + by_load
      b = b + by_load(:, next)
   end subroutine find_stress

   !> Takes the stress that balances the load from the numbers that the tractions determine.
   pure subroutine remove_load(a, b, by_load)
      real(dp), intent(inout) :: a(3, 3) !! as in `find_stress` [F/L^4]
      real(dp), intent(inout) :: b(3, 3) !! as in `find_stress` [F/L^4]
      real(dp), intent(in) :: by_load(3, 3) !! s_1, s_2, s_3 at each corner [F/L^4]
      integer :: k, l

      do k = 1, 3
         do l = 1, 3
            if (l == k) cycle
            a(l, k) = a(l, k) - by_load(l, k)
            b(l, k) = b(l, k) - by_load(l, next(k))
         end do
      end do
   end subroutine remove_load

   !> The number s of one neighbor of a side at both its ends, by the traction there: its force is twice its moment
   !> there less that at the other end.
   pure subroutine find_ends(first, second, other, moment, inverse)
      real(dp), intent(out) :: first !! s at the first corner of the side [F/L^4]
      real(dp), intent(out) :: second !! s at its second corner [F/L^4]
      real(dp), intent(in) :: other(2) !! the other neighbor [L]
      real(dp), intent(in) :: moment(2, 2) !! moments of the traction at both corners, over the depth [F/L]
      real(dp), intent(in) :: inverse !! half of the inverse square of the area [1/L^4]
      real(dp) :: at(2)

      at(1) = inverse*cross(other, moment(:, 1))
      at(2) = inverse*cross(other, moment(:, 2))
      first = 2.0_dp*at(1) - at(2)
      second = 2.0_dp*at(2) - at(1)
   end subroutine find_ends

   !> A stress that balances a uniform load and vanishes in the center, linear between its values at the corners
   !> (component, corner) [F/L^4].
   pure subroutine find_load_stress(by_load, along, area, body_force)
      real(dp), intent(out) :: by_load(3, 3) !! s_1, s_2, s_3 at each corner [F/L^4]
      real(dp), intent(in) :: along(2, 3) !! the sides [L]
      real(dp), intent(in) :: area !! the area [L^2]
      real(dp), intent(in) :: body_force(2) !! force per volume, x and y [F/L^3]
      real(dp) :: half(2)

      by_load = 0.0_dp
      ! The force is a sum of t_1 and t_2; s_1 falls along t_1, s_2 along t_2.
      half = [-cross(along(:, 2), body_force), cross(along(:, 1), body_force)]/(4.0_dp*area)
      by_load(1, :2) = [half(1), -half(1)]
      by_load(2, 2:) = [half(2), -half(2)]
   end subroutine find_load_stress

   !> The numbers s_1, s_2, s_3 of a stress [F/L^4].
   pure function along_sides(stress, along, area) result(s)
      real(dp), intent(in) :: stress(3) !! xx, yy, xy [F/L^2]
      real(dp), intent(in) :: along(2, 3) !! the sides [L]
      real(dp), intent(in) :: area !! the area of the triangle [L^2]
      real(dp) :: s(3)

      s(1) = across(stress, along(:, 2), along(:, 3))
      s(2) = across(stress, along(:, 3), along(:, 1))
      s(3) = across(stress, along(:, 1), along(:, 2))
      s = 0.25_dp/area**2*s
   end function along_sides

   !> What a stress makes of two sides turned by a right angle, negative [F].
   pure real(dp) function across(stress, a, b)
      real(dp), intent(in) :: stress(3) !! xx, yy, xy [F/L^2]
      real(dp), intent(in) :: a(2) !! one side [L]
      real(dp), intent(in) :: b(2) !! the other side [L]

      across = stress(3)*(a(1)*b(2) + a(2)*b(1)) - stress(1)*a(2)*b(2) - stress(2)*a(1)*b(1)
   end function across

   !> The product of two stresses a a^T and b b^T whose squares are those of `squared_norms` [L^6/F].
   pure real(dp) function side_product(form, a, b) result(product)
      real(dp), intent(in) :: form(3) !! the material's, from `squared_norms` [L^2/F]
      real(dp), intent(in) :: a(2) !! a vector [L]
      real(dp), intent(in) :: b(2) !! another one [L]

      product = form(1)*((a(1)*b(1))**2 + (a(2)*b(2))**2) + 0.5_dp*form(2)*((a(1)*b(2))**2 + (a(2)*b(1))**2) &
         + form(3)*a(1)*b(1)*a(2)*b(2)
   end function side_product

   !> The vector product of two vectors.
   pure real(dp) function cross(a, b)
      real(dp), intent(in) :: a(2) !! one
      real(dp), intent(in) :: b(2) !! the other

      cross = a(1)*b(2) - a(2)*b(1)
   end function cross

end module amontons_equilibrated_stress
