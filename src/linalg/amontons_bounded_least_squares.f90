!> Least squares with bounds on the factors.
module amontons_bounded_least_squares
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: bounded_remainder

   !> What rounding leaves of a zero, over the numbers it came from.
   real(dp), parameter :: negligible = 1.0e-13_dp

   !> How a vector is made up of columns.
   type :: approximation_t
      real(dp), allocatable :: factor(:) !! the factors of the columns in use; 0 for the others (n)
      logical, allocatable :: is_used(:) !! which columns have a factor between 0 and the most (n)
      logical, allocatable :: is_full(:) !! which have the most (n)
      real(dp), allocatable :: remainder(:) !! what the columns leave of the vector (k)
   end type approximation_t

contains

   !> What is left of a vector after its best approximation by columns with factors from 0 to a bound each: Lawson and
   !> Hanson's algorithm (Solving Least Squares Problems, 1974, chapter 23) with upper bounds (P. B. Stark, R. L.
   !> Parker: Bounded-variable least squares, Computational Statistics 10 (1995)).
   pure function bounded_remainder(columns, most, vector) result(remainder)
      real(dp), intent(in) :: columns(:, :) !! the columns (k, n)
      real(dp), intent(in) :: most(:) !! upper bounds of the factors, at least 0; huge if there is none (n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      real(dp) :: remainder(size(vector))
      real(dp) :: unit(size(columns, 1), size(columns, 2)), longest(size(columns, 2)), gain(size(columns, 2))
      type(approximation_t) :: best
      integer :: i, step

      do i = 1, size(columns, 2)
         unit(:, i) = columns(:, i)/max(norm2(columns(:, i)), tiny(1.0_dp))
         longest(i) = most(i)
         if (most(i) < huge(most)) longest(i) = most(i)*norm2(columns(:, i))
      end do
      best%factor = 0.0_dp*longest
      allocate (best%is_used(size(longest)), best%is_full(size(longest)), source=.false.)
      best%remainder = vector
      do step = 1, 3*size(columns, 2)
         if (norm2(best%remainder) <= negligible*norm2(vector)) exit
         gain = matmul(best%remainder, unit)
         where (best%is_full) gain = -gain
         i = maxloc(gain, dim=1, mask=.not. best%is_used .and. most > 0.0_dp)
         if (i == 0) exit
         if (gain(i) <= negligible*norm2(best%remainder)) exit
         best%is_used(i) = .true.
         if (best%is_full(i)) best%factor(i) = longest(i)
         best%is_full(i) = .false.
         call settle_factors(unit, longest, vector, best)
      end do
      remainder = best%remainder
   end function bounded_remainder

   !> Moves the factors to the best approximation by the columns in use; a column whose factor meets a bound on the way
   !> is given up, and the way goes on from there.
   pure subroutine settle_factors(columns, most, vector, best)
      real(dp), intent(in) :: columns(:, :) !! the columns, of length 1 (k, n)
      real(dp), intent(in) :: most(:) !! upper bounds of the factors (n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      type(approximation_t), intent(inout) :: best !! the approximation, some columns in use
      real(dp) :: full(size(most)), trial(size(most))

      do
         full = merge(most, 0.0_dp, best%is_full)
         call approximate(columns, vector - matmul(columns, full), best%is_used, trial, best%remainder)
         if (all(.not. best%is_used .or. (trial > 0.0_dp .and. trial < most))) exit
         best%factor = best%factor + share_in_bounds(best, most, trial)*(trial - best%factor)
         best%is_full = best%is_full .or. (best%is_used .and. best%factor >= (1.0_dp - negligible)*most)
         best%is_used = best%is_used .and. .not. best%is_full &
            .and. best%factor > negligible*maxval(best%factor)
         best%factor = merge(best%factor, 0.0_dp, best%is_used)
      end do
      best%factor = trial
   end subroutine settle_factors

   !> The share of the way from the factors of the columns in use to others on which all stay in their bounds.
   pure real(dp) function share_in_bounds(best, most, trial) result(share)
      type(approximation_t), intent(in) :: best !! the approximation
      real(dp), intent(in) :: most(:) !! upper bounds of the factors (n)
      real(dp), intent(in) :: trial(:) !! the other factors (n)
      integer :: i

      share = 1.0_dp
      do i = 1, size(most)
         if (.not. best%is_used(i)) cycle
         if (trial(i) <= 0.0_dp) share = min(share, best%factor(i)/max(best%factor(i) - trial(i), tiny(share)))
         if (trial(i) >= most(i)) share = min(share, (most(i) - best%factor(i))/max(trial(i) - best%factor(i), &
            tiny(share)))
      end do
   end function share_in_bounds

   !> Approximates a vector best by the columns in use, made orthogonal one by one (Gram and Schmidt): of columns that
   !> are all but parallel, as those of a flat contact line far from the middle of the body, no digit is lost.
   pure subroutine approximate(columns, vector, is_used, factor, remainder)
      real(dp), intent(in) :: columns(:, :) !! the columns, of length 1 (k, n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      logical, intent(in) :: is_used(:) !! which columns are in use, k at the most (n)
      real(dp), intent(out) :: factor(:) !! their factors; 0 for the others (n)
      real(dp), intent(out) :: remainder(:) !! what they leave of the vector (k)
      real(dp) :: axes(size(vector), count(is_used)), share(count(is_used), count(is_used) + 1), length
      integer, allocatable :: column(:)
      integer :: i, n

      column = pack([(i, i=1, size(is_used))], is_used)
      n = size(column)
      do i = 1, n
         axes(:, i) = columns(:, column(i))
         call orthogonalize(axes(:, :i - 1), axes(:, i), share(:i - 1, i))
         length = max(norm2(axes(:, i)), tiny(1.0_dp))
         axes(:, i) = axes(:, i)/length
         share(i, i) = length
      end do
      remainder = vector
      call orthogonalize(axes, remainder, share(:, n + 1))
      factor = 0.0_dp
      do i = n, 1, -1
         factor(column(i)) = (share(i, n + 1) - dot_product(share(i, i + 1:n), factor(column(i + 1:n))))/share(i, i)
      end do
   end subroutine approximate

   !> Takes from a vector its components along orthogonal axes; what rounding leaves of them, a second time.
   pure subroutine orthogonalize(axes, vector, share)
      real(dp), intent(in) :: axes(:, :) !! the axes, of length 1 (k, n)
      real(dp), intent(inout) :: vector(:) !! the vector (k)
      real(dp), intent(out) :: share(:) !! its components (n)
      real(dp) :: along
      integer :: i, turn

      share = 0.0_dp
      do turn = 1, 2
         do i = 1, size(axes, 2)
            along = dot_product(axes(:, i), vector)
            vector = vector - along*axes(:, i)
            share(i) = share(i) + along
         end do
      end do
   end subroutine orthogonalize

end module amontons_bounded_least_squares
