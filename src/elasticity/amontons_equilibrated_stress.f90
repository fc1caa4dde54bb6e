!> A stress field that is in equilibrium at every point of a mesh of three-node triangles, and how far it is from that
!> of displacements.
!>
!> In each of the three parts that the center of a triangle makes of it, the stress is linear, with continuous tractions
!> (Johnson and Mercier, Numer. Math. 30, 1978). Tractions on the sides that are in equilibrium with a uniform load
!> determine it: at a corner by the tractions on both sides, in the center by the equilibrium of the parts.
module amontons_equilibrated_stress
   use amontons_coloring, only: worth_threads
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_equilibrated_sides, only: next, outward, stress_times
   use amontons_kinds, only: dp
   use amontons_material, only: material_t, materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: find_corner_stresses, stress_distance

contains

   !> The norm of stresses less those in equilibrium [sqrt(F L)].
   real(dp) function stress_distance(mesh, materials, moment, body_force, stress) result(distance)
      type(mesh_t), intent(in) :: mesh !! a checked mesh of three-node triangles
      type(materials_t), intent(in) :: materials !! its materials, of a plane body
      real(dp), intent(in) :: moment(:, :, :, :)
         !! moments of the tractions in equilibrium, from `find_side_moments` (2, 2, 3, n_elements) [F]
      real(dp), intent(in) :: body_force(:, :) !! force per volume of each element, x and y (2, n_elements) [F/L^3]
      real(dp), intent(in) :: stress(:, :, :)
         !! xx, yy, xy, zz at the corners of each element, linear between them (4, 3, n_elements) [F/L^2]
      integer :: i

      distance = 0.0_dp
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp shared(mesh, materials, moment, body_force, stress) reduction(+: distance)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)), first => mesh%node_start(i))
            distance = distance + material%thickness*element_distance(material, &
               mesh%coordinates(:, mesh%node(first:first + 2)), moment(:, :, :, i)/material%thickness, &
               body_force(:, i), stress(:, :, i))
         end associate
      end do
      !$omp end parallel do
      distance = sqrt(distance)
   end function stress_distance

   !> Evaluates the stresses of displacements at the corners of the elements.
   subroutine find_corner_stresses(stress, mesh, materials, displacement, thermal_strain)
      real(dp), allocatable, intent(out) :: stress(:, :, :)
         !! xx, yy, xy, zz at the corners of each element (4, 3, n_elements) [F/L^2]
      type(mesh_t), intent(in) :: mesh !! a checked mesh of three-node triangles
      type(materials_t), intent(in) :: materials !! its materials
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      type(element_geometry_t) :: geometry
      integer :: i, k

      allocate (stress(4, 3, mesh%n_elements))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) private(k) &
      !$omp firstprivate(geometry) shared(stress, mesh, materials, displacement, thermal_strain)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)))
            call new_element_geometry(geometry, mesh, i, material, 1)
            do k = 1, 3
               if (present(thermal_strain)) call set_thermal_strain(geometry, &
                  spread(thermal_strain(mesh%node_start(i) + k - 1), 1, 3))
               stress(:, k, i) = element_stress(geometry, material, displacement, 1)
            end do
         end associate
      end do
      !$omp end parallel do
   end subroutine find_corner_stresses

   !> The square of the norm of an element's stresses less those in equilibrium, for a depth of 1 [F].
   pure real(dp) function element_distance(material, x, moment, body_force, stress) result(distance)
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: x(2, 3) !! its corners [L]
      real(dp), intent(in) :: moment(2, 2, 3)
         !! moments of the tractions at the first and second corner of each side, over the depth [F/L]
      real(dp), intent(in) :: body_force(2) !! force per volume, x and y [F/L^3]
      real(dp), intent(in) :: stress(4, 3) !! its stresses at the corners, linear between them [F/L^2]
      real(dp) :: at_corner(3, 2, 3), at_center(3), area, missing(4, 3), middle(4)
      integer :: part, i

      area = 0.5_dp*dot_product(x(:, 2) - x(:, 1), outward(x(:, 3) - x(:, 1)))
      call find_stress(at_corner, at_center, x, area, moment, body_force)
      distance = 0.0_dp
      missing(4, :) = 0.0_dp
      do part = 1, 3
         missing(:3, 1) = at_corner(:, 1, part) - stress(:3, part)
         missing(:3, 2) = at_corner(:, 2, part) - stress(:3, next(part))
         missing(:3, 3) = at_center - sum(stress(:3, :), dim=2)/3.0_dp
         ! The middles of the sides of a part integrate squares of what is linear there.
         do i = 1, 3
            middle = 0.5_dp*(missing(:, i) + missing(:, next(i)))
            distance = distance + area/9.0_dp*material%squared_norm(middle)
         end do
      end do
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
      real(dp) :: center(2), normal(2, 3), length(3), traction(2, 2, 3), by_load(3, 3)
      integer :: k

      center = sum(x, dim=2)/3.0_dp
      do k = 1, 3
         normal(:, k) = outward(x(:, next(k)) - x(:, k))
         length(k) = norm2(normal(:, k))
         normal(:, k) = normal(:, k)/length(k)
         ! A stress that balances the load: -f_x (x - x_c) and -f_y (y - y_c).
         by_load(:, k) = [-body_force*(x(:, k) - center), 0.0_dp]
      end do
      do k = 1, 3
         traction(:, 1, k) = 2.0_dp*(2.0_dp*moment(:, 1, k) - moment(:, 2, k))/length(k) &
            - stress_times(by_load(:, k), normal(:, k))
         traction(:, 2, k) = 2.0_dp*(2.0_dp*moment(:, 2, k) - moment(:, 1, k))/length(k) &
            - stress_times(by_load(:, next(k)), normal(:, k))
      end do
      do k = 1, 3
         call join_corner(at_corner(:, 2, k), at_corner(:, 1, next(k)), traction(:, 2, k), traction(:, 1, next(k)), &
            normal(:, k), normal(:, next(k)), center - x(:, next(k)))
      end do
      call balance_parts(at_center, at_corner, x, center, area, length, traction)
      do k = 1, 3
         at_corner(:, 1, k) = at_corner(:, 1, k) + by_load(:, k)
         at_corner(:, 2, k) = at_corner(:, 2, k) + by_load(:, next(k))
      end do
   end subroutine find_stress

   !> Finds the stresses of the two parts that meet at a corner: each has the traction of its side, and they have one
   !> traction along the line to the center.
   pure subroutine join_corner(stress_a, stress_b, traction_a, traction_b, normal_a, normal_b, to_center)
      real(dp), intent(out) :: stress_a(3) !! stress of the part whose side ends there: xx, yy, xy [F/L^2]
      real(dp), intent(out) :: stress_b(3) !! stress of the part whose side begins there: xx, yy, xy [F/L^2]
      real(dp), intent(in) :: traction_a(2) !! traction on the side that ends there [F/L^2]
      real(dp), intent(in) :: traction_b(2) !! traction on the side that begins there [F/L^2]
      real(dp), intent(in) :: normal_a(2) !! outward normal of the former [-]
      real(dp), intent(in) :: normal_b(2) !! outward normal of the latter [-]
      real(dp), intent(in) :: to_center(2) !! the way to the center [L]
      real(dp) :: tangent_a(2), tangent_b(2), across(2), jump(2), turn

      tangent_a = outward(normal_a)
      tangent_b = outward(normal_b)
      across = outward(to_center)
      stress_a = with_traction(traction_a, normal_a)
      stress_b = with_traction(traction_b, normal_b)
      jump = stress_times(stress_b - stress_a, across)
      turn = cross(tangent_a, tangent_b)
      stress_a = stress_a + cross(jump, tangent_b)/(turn*dot_product(tangent_a, across))*square(tangent_a)
      stress_b = stress_b - cross(tangent_a, jump)/(turn*dot_product(tangent_b, across))*square(tangent_b)
   end subroutine join_corner

   !> Finds the stress in the center, with which each part is in equilibrium.
   pure subroutine balance_parts(at_center, at_corner, x, center, area, length, traction)
      real(dp), intent(out) :: at_center(3) !! xx, yy, xy [F/L^2]
      real(dp), intent(in) :: at_corner(3, 2, 3) !! as in `find_stress` [F/L^2]
      real(dp), intent(in) :: x(2, 3) !! the corners [L]
      real(dp), intent(in) :: center(2) !! the center [L]
      real(dp), intent(in) :: area !! the area [L^2]
      real(dp), intent(in) :: length(3) !! lengths of the sides [L]
      real(dp), intent(in) :: traction(2, 2, 3) !! tractions at the first and second corner of each side [F/L^2]
      real(dp) :: force(2), arm(2)
      integer :: k

      at_center = 0.0_dp
      do k = 1, 3
         ! Twice the force that the stress in the center has to put on the sides of the part within the triangle.
         force = length(k)*(traction(:, 1, k) + traction(:, 2, k)) &
            + stress_times(at_corner(:, 2, k), outward(center - x(:, next(k)))) &
            + stress_times(at_corner(:, 1, k), outward(x(:, k) - center))
         ! A stress is the sum of the moments of the forces that it puts on the sides, over the area.
         arm = 0.5_dp*(x(:, k) + x(:, next(k))) - center
         at_center = at_center + [force(1)*arm(1), force(2)*arm(2), 0.5_dp*(force(1)*arm(2) + force(2)*arm(1))]/area
      end do
   end subroutine balance_parts

   !> The stress that has a traction on a normal and none along the tangent across it: xx, yy, xy [F/L^2].
   pure function with_traction(traction, normal) result(stress)
      real(dp), intent(in) :: traction(2) !! the traction [F/L^2]
      real(dp), intent(in) :: normal(2) !! the normal [-]
      real(dp) :: stress(3)

      stress = [2.0_dp*traction(1)*normal(1), 2.0_dp*traction(2)*normal(2), &
         traction(1)*normal(2) + traction(2)*normal(1)] - dot_product(traction, normal)*square(normal)
   end function with_traction

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
