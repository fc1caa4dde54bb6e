!> Things sorted by the bins that they belong to.
module amontons_bins
   implicit none (type, external)
   private

   public :: fill_bins

contains

   !> Sorts things by their bins; those of one bin keep their order.
   pure subroutine fill_bins(start, thing, bin, n_bins)
      integer, allocatable, intent(out) :: start(:) !! where the things of each bin begin in `thing` (n_bins + 1)
      integer, allocatable, intent(out) :: thing(:) !! the things, bin by bin
      integer, intent(in) :: bin(:) !! bin of each thing, 1 to `n_bins`; 0 for none
      integer, intent(in) :: n_bins !! number of bins
      integer, allocatable :: next(:)
      integer :: i

      allocate (start(n_bins + 1), source=0)
      do i = 1, size(bin)
         if (bin(i) > 0) start(bin(i) + 1) = start(bin(i) + 1) + 1
      end do
      start(1) = 1
      do i = 1, n_bins
         start(i + 1) = start(i + 1) + start(i)
      end do
      allocate (next, source=start)
      allocate (thing(start(n_bins + 1) - 1))
      do i = 1, size(bin)
         if (bin(i) == 0) cycle
         thing(next(bin(i))) = i
         next(bin(i)) = next(bin(i)) + 1
      end do
   end subroutine fill_bins

end module amontons_bins
