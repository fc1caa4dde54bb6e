!> What the stresses of the surface and the slips of a cycle say about fretting: the parameters of Ruiz, and that of
!> Smith, Watson and Topper on the critical plane.
!>
!> All of them are made of the largest values of some numbers over the steps of the cycle, so that no step need be kept.
module amontons_fretting
   use amontons_kinds, only: dp
   use amontons_surface_stress, only: surface_stress_t
   implicit none (type, external)
   private

   public :: fretting_t, n_extremes, n_parameters, parameter_names

   !> Planes through a point, by the angle of their normals to the tangent: 2 degrees apart.
   integer, parameter :: n_planes = 90
   !> Numbers of a point whose largest values are kept: shear, stress along the surface, slip and its opposite; stress,
   !> strain and the opposite of the strain along the normal of each plane.
   integer, parameter :: n_extremes = 4 + 3*n_planes
   !> Number of parameters.
   integer, parameter :: n_parameters = 5
   !> What they are called in tables.
   character(14), parameter :: parameter_names(n_parameters) = [character(14) :: 'surface_stress', 'ruiz_1', 'ruiz_2', &
      'swt', 'swt_angle']

   !> The cycle so far.
   type :: fretting_t
      real(dp), allocatable :: stress(:, :) !! stresses of the surface at the end of the last step (4, m) [F/L^2]
      real(dp), allocatable :: extreme(:, :) !! largest values over the cycle (n_extremes, m)
   contains
      procedure :: add => fretting_add
      procedure :: begin => fretting_begin
      procedure :: parameters => fretting_parameters
   end type fretting_t

contains

   !> Begins a cycle.
   pure subroutine fretting_begin(self, surface, stress, position)
      class(fretting_t), intent(inout) :: self !! the cycle; becomes a new one
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (4, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (m) [L]

      self%stress = stress
      self%extreme = sample(surface, stress, position)
   end subroutine fretting_begin

   !> Adds the end of a step.
   pure subroutine fretting_add(self, surface, stress, position)
      class(fretting_t), intent(inout) :: self !! the cycle; gains the step
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (4, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (m) [L]

      self%stress = stress
      self%extreme = max(self%extreme, sample(surface, stress, position))
   end subroutine fretting_add

   !> The numbers of which the largest values are kept (n_extremes, m).
   pure function sample(surface, stress, position)
      type(surface_stress_t), intent(in) :: surface !! the surface, for its material
      real(dp), intent(in) :: stress(:, :) !! stresses of the surface (4, m) [F/L^2]
      real(dp), intent(in) :: position(:) !! tangential displacements less those of the obstacle (m) [L]
      real(dp) :: sample(n_extremes, size(position))
      real(dp) :: frames(3, n_planes), on_planes(n_planes), strains(n_planes)
      integer :: k, p

      do k = 1, n_planes
         associate (angle => plane_angle(k))
            frames(:, k) = [sin(angle)**2, 2.0_dp*sin(angle)*cos(angle), cos(angle)**2]
         end associate
      end do
      do p = 1, size(position)
         on_planes = matmul(stress(:3, p), frames)
         strains = ((1.0_dp + surface%poisson(p))*on_planes - surface%poisson(p)*sum(stress([1, 3, 4], p))) &
            /surface%young(p)
         sample(:, p) = [abs(stress(2, p)), stress(3, p), position(p), -position(p), on_planes, strains, -strains]
      end do
   end function sample

   !> The angle of the normal of a plane to the tangent, towards the outward normal: 0, 2, -2, 4, ... degrees [rad].
   pure real(dp) function plane_angle(plane) result(angle)
      integer, intent(in) :: plane !! number of the plane

      angle = acos(-1.0_dp)/n_planes*(plane/2*merge(1, -1, modulo(plane, 2) == 0))
   end function plane_angle

   !> The parameters of each point over the cycle so far: stress along the surface at the end of the last step [F/L^2],
   !> Ruiz' first [F/L] and second [F^2/L^3], that of Smith, Watson and Topper [F/L^2] and the angle of its plane [rad]
   !> (m, n_parameters).
   pure function fretting_parameters(self) result(parameters)
      class(fretting_t), intent(in) :: self !! the cycle so far
      real(dp) :: parameters(size(self%extreme, 2), n_parameters)
      ! Planes whose values differ by rounding are the same; the first of them has the smallest angle.
      real(dp), parameter :: rounding = 1.0e-9_dp
      real(dp) :: on_planes(n_planes)
      integer :: p, plane

      do p = 1, size(parameters, 1)
         associate (largest => self%extreme(:, p))
            parameters(p, 1) = self%stress(3, p)
            parameters(p, 2) = largest(1)*(largest(3) + largest(4))
            parameters(p, 3) = max(0.0_dp, largest(2))*parameters(p, 2)
            on_planes = max(0.0_dp, largest(5:4 + n_planes))*0.5_dp*(largest(5 + n_planes:4 + 2*n_planes) &
               + largest(5 + 2*n_planes:))
            plane = findloc(on_planes >= (1.0_dp - rounding)*maxval(on_planes), .true., dim=1)
            parameters(p, 4:5) = [on_planes(plane), plane_angle(plane)]
         end associate
      end do
   end function fretting_parameters

end module amontons_fretting
