!> A stress field that is in equilibrium at every point of a mesh of three-node triangles, and how far it is from that
!> of displacements.
!>
!> In each of the three parts that the center of a triangle makes of it, the stress is linear, with continuous tractions
!> (Johnson and Mercier, Numer. Math. 30, 1978). Tractions on the sides that are in equilibrium with a uniform load
!> determine it: at a corner by the tractions on both sides, in the center by the equilibrium of the parts.
module amontons_equilibrated_stress
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_equilibrated_sides, only: element_forces_t, next, outward
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: stress_distance

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
      real(dp) :: form(3, size(materials%list)), stress(3, 3)
      real(dp), allocatable :: squared(:)
      integer :: i

      form = squared_norms(materials)
      allocate (squared(mesh%n_elements))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(stress) &
      !$omp shared(mesh, materials, moment, body_force, forces, displacement, thermal_strain, form, squared)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)), first => mesh%node_start(i))
            if (present(thermal_strain)) then
               call new_element_geometry(geometry, mesh, i, material, 1)
               call find_corner_stresses(stress, geometry, material, displacement, thermal_strain(first:first + 2))
            else
               stress = spread(forces(i)%solved, 2, 3)
            end if
            squared(i) = material%thickness*element_distance(form(:, materials%of_element(i)), &
               mesh%coordinates(:, mesh%node(first:first + 2)), moment(:, :, :, i)/material%thickness, &
               body_force(:, i), stress)
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
   pure real(dp) function element_distance(form, x, moment, body_force, stress) result(distance)
      real(dp), intent(in) :: form(3) !! its material's, from `squared_norms` [L^2/F]
      real(dp), intent(in) :: x(2, 3) !! its corners [L]
      real(dp), intent(in) :: moment(2, 2, 3)
         !! moments of the tractions at the first and second corner of each side, over the depth [F/L]
      real(dp), intent(in) :: body_force(2) !! force per volume, x and y [F/L^3]
      real(dp), intent(in) :: stress(3, 3) !! its stresses at the corners, linear between them [F/L^2]
      real(dp) :: at_corner(3, 2, 3), at_center(3), area, missing(3, 3), middle(3)
      integer :: part, i

      area = 0.5_dp*dot_product(x(:, 2) - x(:, 1), outward(x(:, 3) - x(:, 1)))
      call find_stress(at_corner, at_center, x, area, moment, body_force)
      distance = 0.0_dp
      missing(:, 3) = at_center - (stress(:, 1) + stress(:, 2) + stress(:, 3))/3.0_dp
      do part = 1, 3
         missing(:, 1) = at_corner(:, 1, part) - stress(:, part)
         missing(:, 2) = at_corner(:, 2, part) - stress(:, next(part))
         ! The middles of the sides of a part integrate squares of what is linear there.
         do i = 1, 3
            middle = missing(:, i) + missing(:, next(i))
            distance = distance + form(1)*(middle(1)**2 + middle(2)**2) + form(2)*middle(1)*middle(2) &
               + form(3)*middle(3)**2
         end do
      end do
      distance = area/36.0_dp*distance
   end function element_distance

   !> Finds the stress in equilibrium with the tractions and the load of an element.
   pure subroutine find_stress(at_corner, at_center, x, area, moment, body_force)
      real(dp), intent(out) :: at_corner(3, 2, 3)
         !! xx, yy, xy at the two corners of the side of each part; the parts are those of the sides [F/L^2]
      real(dp), intent(out) :: at_center(3) !! xx, yy, xy in the center, of all parts [F/L^2]
      real(dp), intent(in) :: x(2, 3) !! the corners [L]
      real(dp), intent(in) :: area !! the area [L^2]
      real(dp), intent(in) :: moment(2, 2, 3) !! as in `element_distance` [F/L]
      real(dp), intent(in) :: body_force(2) !! force per volume, x and y [F/L^3]
      real(dp) :: center(2), to_center(2, 3), along(2, 3), force(2, 2, 3), by_load(2, 3), inverse
      integer :: k

      center = (x(:, 1) + x(:, 2) + x(:, 3))/3.0_dp
      do k = 1, 3
         along(:, k) = x(:, next(k)) - x(:, k)
         to_center(:, k) = center - x(:, k)
         ! A stress that balances the load: xx is -f_x (x - x_c), yy is -f_y (y - y_c).
         by_load(:, k) = body_force*to_center(:, k)
      end do
      do k = 1, 3
         associate (normal => [along(2, k), -along(1, k)])
            force(:, 1, k) = 2.0_dp*(2.0_dp*moment(:, 1, k) - moment(:, 2, k)) - by_load(:, k)*normal
            force(:, 2, k) = 2.0_dp*(2.0_dp*moment(:, 2, k) - moment(:, 1, k)) - by_load(:, next(k))*normal
         end associate
         inverse = 1.0_dp/(along(1, k)**2 + along(2, k)**2)
         at_corner(:, 1, k) = with_force(force(:, 1, k), along(:, k), inverse)
         at_corner(:, 2, k) = with_force(force(:, 2, k), along(:, k), inverse)
      end do
      inverse = 0.75_dp/area**2
      do k = 1, 3
         call join_corner(at_corner(:, 2, k), at_corner(:, 1, next(k)), along(:, k), along(:, next(k)), &
            to_center(:, next(k)), inverse)
      end do
      call balance_parts(at_center, at_corner, along, to_center, area, force)
      do k = 1, 3
         at_corner(:2, 1, k) = at_corner(:2, 1, k) + by_load(:, k)
         at_corner(:2, 2, k) = at_corner(:2, 2, k) + by_load(:, next(k))
      end do
   end subroutine find_stress

   !> Gives the stresses of the two parts that meet at a corner one traction along the line to the center; each keeps
   !> that of its side. All parts have the same area, a third of the triangle's.
   pure subroutine join_corner(stress_a, stress_b, along_a, along_b, to_center, inverse)
      real(dp), intent(inout) :: stress_a(3) !! stress of the part whose side ends there: xx, yy, xy [F/L^2]
      real(dp), intent(inout) :: stress_b(3) !! stress of the part whose side begins there: xx, yy, xy [F/L^2]
      real(dp), intent(in) :: along_a(2) !! the side that ends there [L]
      real(dp), intent(in) :: along_b(2) !! the side that begins there [L]
      real(dp), intent(in) :: to_center(2) !! the way to the center [L]
      real(dp), intent(in) :: inverse !! three quarters of the inverse square of the triangle's area [1/L^4]
      real(dp) :: difference(3), jump(2)

      difference = stress_b - stress_a
      jump = [difference(1)*to_center(2) - difference(3)*to_center(1), &
         difference(3)*to_center(2) - difference(2)*to_center(1)]
      stress_a = stress_a + inverse*cross(jump, along_b)*square(along_a)
      stress_b = stress_b + inverse*cross(jump, along_a)*square(along_b)
   end subroutine join_corner

   !> Finds the stress in the center, with which each part is in equilibrium.
   pure subroutine balance_parts(at_center, at_corner, along, to_center, area, force)
      real(dp), intent(out) :: at_center(3) !! xx, yy, xy [F/L^2]
      real(dp), intent(in) :: at_corner(3, 2, 3) !! as in `find_stress` [F/L^2]
      real(dp), intent(in) :: along(2, 3) !! the sides [L]
      real(dp), intent(in) :: to_center(2, 3) !! the ways from the corners to the center [L]
      real(dp), intent(in) :: area !! the area [L^2]
      real(dp), intent(in) :: force(2, 2, 3)
         !! tractions at the first and second corner of each side, times its length [F/L]
      real(dp) :: inner(2), arm(2)
      integer :: k

      at_center = 0.0_dp
      do k = 1, 3
         ! Twice the force that the stress in the center has to put on the sides of the part within the triangle.
         associate (a => to_center(:, next(k)), b => to_center(:, k), s => at_corner(:, 2, k), r => at_corner(:, 1, k))
            inner(1) = force(1, 1, k) + force(1, 2, k) + s(1)*a(2) - s(3)*a(1) - r(1)*b(2) + r(3)*b(1)
            inner(2) = force(2, 1, k) + force(2, 2, k) + s(3)*a(2) - s(2)*a(1) - r(3)*b(2) + r(2)*b(1)
         end associate
         ! A stress is the sum of the moments of the forces that it puts on the sides, over the area.
         arm = 0.5_dp*along(:, k) - to_center(:, k)
         at_center = at_center + [inner(1)*arm(1), inner(2)*arm(2), 0.5_dp*(inner(1)*arm(2) + inner(2)*arm(1))]
      end do
      at_center = at_center/area
   end subroutine balance_parts

   !> The stress that puts a force on a side and has no part along the side alone: xx, yy, xy [F/L^2].
   pure function with_force(force, along, inverse) result(stress)
      real(dp), intent(in) :: force(2) !! the traction, times the length of the side [F/L]
      real(dp), intent(in) :: along(2) !! the side, the body on its left [L]
      real(dp), intent(in) :: inverse !! the inverse square of its length [1/L^2]
      real(dp) :: stress(3)
      real(dp) :: normal(2), push

      normal = inverse*[along(2), -along(1)]
      push = force(1)*normal(1) + force(2)*normal(2)
      stress = [normal(1)*(2.0_dp*force(1) - push*along(2)), normal(2)*(2.0_dp*force(2) + push*along(1)), &
         force(1)*normal(2) + force(2)*normal(1) + push*along(1)*normal(1)]
   end function with_force

   !> The square of a vector as a stress: xx, yy, xy.
   pure function square(vector)
      real(dp), intent(in) :: vector(2) !! the vector
      real(dp) :: square(3)

      square = [vector(1)**2, vector(2)**2, vector(1)*vector(2)]
   end function square

   !> The vector product of two vectors.
   pure real(dp) function cross(a, b)
      real(dp), intent(in) :: a(2) !! one
      real(dp), intent(in) :: b(2) !! the other

      cross = a(1)*b(2) - a(2)*b(1)
   end function cross

end module amontons_equilibrated_stress
