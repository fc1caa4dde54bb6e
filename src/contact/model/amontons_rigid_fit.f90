!> The rigid motion that brings a body which only contact holds to its obstacles.
!>
!> Rigid motions take no force, so that the displacements of such a body may be counted from any of them. Those that its
!> forces come from may be millions of times smaller than the way to the obstacle: counted from there, they keep their
!> digits. Where the gaps do not tell it, as those of a hollow body that stands on its ends, its displacements do.
module amontons_rigid_fit
   use amontons_body, only: body_t
   use amontons_dense, only: symmetric_eigenvectors
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t
   implicit none (type, external)
   private

   public :: fit_rigid_motion, fit_travel

contains

   !> Finds the free rigid motion that comes closest to the gaps of the points in reach, without a slip; none if it
   !> leaves much of them.
   subroutine fit_rigid_motion(motion, body, load_case)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (2m) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and anchors
      real(dp), parameter :: much = 0.1_dp
      real(dp) :: aim(2*body%zone%n_points)
      logical :: counts(2*body%zone%n_points)

      counts = [load_case%is_in_reach, load_case%is_in_reach .and. .not. body%zone%is_tangent_fixed]
      aim = merge([load_case%free_gap, load_case%anchor], 0.0_dp, counts)
      call fit(motion, body, aim, counts, much)
   end subroutine fit_rigid_motion

   !> Finds the free rigid motion in displacements of the points that are little else; none in others.
   subroutine fit_travel(motion, body, displacement)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (2m) [L]
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:) !! displacements (u_N; u_T) of the points (2m) [L]
      real(dp), parameter :: much = 0.01_dp

      call fit(motion, body, displacement, spread(.true., 1, size(displacement)), much)
   end subroutine fit_travel

   !> Finds the free rigid motion that comes closest to an aim; none if it leaves much of it.
   subroutine fit(motion, body, aim, counts, much)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (2m) [L]
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: aim(:) !! displacements to come close to, 0 where they do not count (2m) [L]
      logical, intent(in) :: counts(:) !! whether they count (2m)
      real(dp), intent(in) :: much !! how much of the aim is much [-]

      allocate (motion(size(aim)), source=0.0_dp)
      associate (modes => body%rigid_modes)
         if (size(modes, 2) == 0) return
         motion = matmul(modes, amounts_of(merge(modes, 0.0_dp, spread(counts, 2, size(modes, 2))), aim))
      end associate
      if (maxval(abs(aim - motion), mask=counts) > much*maxval(abs(aim))) motion = 0.0_dp
   end subroutine fit

   !> The least amounts of some modes whose sum comes closest to an aim.
   function amounts_of(modes, aim) result(amounts)
      real(dp), intent(in) :: modes(:, :) !! displacements under each mode, 0 where they do not count (2m, k) [-]
      real(dp), intent(in) :: aim(:) !! displacements to come close to, 0 where they do not count (2m) [L]
      real(dp) :: amounts(size(modes, 2))
      ! Squares of the modes have half of the digits.
      real(dp), parameter :: negligible = 1.0e-12_dp
      real(dp) :: gram(size(modes, 2), size(modes, 2)), values(size(modes, 2))
      integer :: info, k

      gram = matmul(transpose(modes), modes)
      call symmetric_eigenvectors(gram, values, info)
      amounts = 0.0_dp
      if (info /= 0) return
      do k = 1, size(values)
         if (values(k) > negligible*maxval(values)) amounts = amounts &
            + gram(:, k)*dot_product(matmul(aim, modes), gram(:, k))/values(k)
      end do
   end function amounts_of

end module amontons_rigid_fit
