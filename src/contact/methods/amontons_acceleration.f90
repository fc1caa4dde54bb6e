!> Acceleration of iterations x -> G(x) (Anderson, J. ACM 12, 1965): the next point is the combination of the last
!> images G(x) whose steps G(x) - x cancel best.
!>
!> With one difference of steps this is Aitken's extrapolation along the last step (Irons and Tuck, Int. J. Numer. Meth.
!> Eng. 1, 1969). A point may carry quantities that depend on it linearly: they follow without being computed anew.
module amontons_acceleration
   use amontons_dense, only: cholesky_factor_softly, cholesky_solve
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: acceleration_names, acceleration_t, new_acceleration

   !> The kinds, as a deck writes them.
   character(8), parameter :: acceleration_names(3) = [character(8) :: 'none', 'aitken', 'anderson']
   !> How many differences of steps each kind looks back on; ten gained little over five.
   integer, parameter :: depths(3) = [0, 1, 5]

   !> The last images and steps of an iteration.
   type :: acceleration_t
      integer :: depth = 0 !! most differences looked back on; 0 for no acceleration
      integer :: n_kept = 0 !! number of images kept
      real(dp), allocatable, private :: image(:, :) !! images with what they carry, oldest first (n, depth + 1)
      real(dp), allocatable, private :: step(:, :) !! steps that led to them, without what they carry (k, depth + 1)
   contains
      procedure :: extrapolate => acceleration_extrapolate
      procedure :: forget => acceleration_forget
   end type acceleration_t

contains

   !> An acceleration without memory.
   pure subroutine new_acceleration(acceleration, name)
      type(acceleration_t), intent(out) :: acceleration !! the acceleration
      character(*), intent(in) :: name !! one of `acceleration_names`

      acceleration%depth = depths(findloc(acceleration_names == name, .true., dim=1))
   end subroutine new_acceleration

   !> Forgets what has been, as after a step that led astray.
   pure subroutine acceleration_forget(self)
      class(acceleration_t), intent(inout) :: self !! the acceleration

      self%n_kept = 0
   end subroutine acceleration_forget

   !> Takes up a step from a point to its image, and proposes where to go on.
   pure subroutine acceleration_extrapolate(self, point, image, proposal, is_given)
      class(acceleration_t), intent(inout) :: self !! the acceleration
      real(dp), intent(in) :: point(:) !! the point, in one unit (k)
      real(dp), intent(in) :: image(:) !! its image, and then what it carries (n)
      real(dp), intent(out) :: proposal(:) !! an image put together from those known (n)
      logical, intent(out) :: is_given !! whether there is a proposal
      real(dp) :: difference(size(point), self%depth)
      real(dp) :: norm(self%depth)
      real(dp), allocatable :: normal(:, :), right(:)
      logical :: is_soft
      integer :: i, n

      is_given = .false.
      if (self%depth == 0) return
      call keep(self, image(:size(point)) - point, image)
      n = self%n_kept - 1
      if (n == 0) return
      do i = 1, n
         difference(:, i) = self%step(:, i + 1) - self%step(:, i)
         norm(i) = norm2(difference(:, i))
      end do
      if (any(norm(:n) <= tiny(1.0_dp))) return
      ! Differences of equal length, so that the old and large ones do not drown the new ones.
      normal = matmul(transpose(difference(:, :n)), difference(:, :n))/ &
         (spread(norm(:n), 1, n)*spread(norm(:n), 2, n))
      right = matmul(self%step(:, n + 1), difference(:, :n))/norm(:n)
      call cholesky_factor_softly(normal, spread(1.0_dp, 1, n), is_soft)
      call cholesky_solve(normal, right)
      proposal = image
      do i = 1, n
         proposal = proposal - right(i)/norm(i)*(self%image(:, i + 1) - self%image(:, i))
      end do
      is_given = .true.
   end subroutine acceleration_extrapolate

   !> Keeps a step and its image, in the place of the oldest if there are enough.
   pure subroutine keep(self, step, image)
      class(acceleration_t), intent(inout) :: self !! the acceleration
      real(dp), intent(in) :: step(:) !! the step (k)
      real(dp), intent(in) :: image(:) !! its image (n)
      integer :: i

      if (.not. allocated(self%image)) then
         allocate (self%image(size(image), self%depth + 1), self%step(size(step), self%depth + 1))
      end if
      if (self%n_kept == self%depth + 1) then
         do i = 1, self%depth
            self%image(:, i) = self%image(:, i + 1)
            self%step(:, i) = self%step(:, i + 1)
         end do
         self%n_kept = self%depth
      end if
      self%n_kept = self%n_kept + 1
      self%image(:, self%n_kept) = image
      self%step(:, self%n_kept) = step
   end subroutine keep

end module amontons_acceleration
