!> Measures what the machine can do: matrix products on one core, and memory traffic on one core and on all.
program rates
   use, intrinsic :: iso_fortran_env, only: int64, output_unit
   use amontons, only: dp, set_threads
   use omp_lib, only: omp_get_num_procs
   implicit none (type, external)

   interface
      ! allow(assumed-size): the BLAS takes the shape apart from the address
      subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         use amontons, only: dp
         implicit none (type, external)
         character, intent(in) :: transa, transb
         integer, intent(in) :: m, n, k, lda, ldb, ldc
         real(dp), intent(in) :: alpha, beta, a(lda, *), b(ldb, *)
         real(dp), intent(inout) :: c(ldc, *)
      end subroutine dgemm
   end interface

   integer, parameter :: n_trials = 5
   integer :: n_cores

   n_cores = omp_get_num_procs()
   write (output_unit, '(a, f0.1)') 'dgemm_gflops ', product_rate()
   write (output_unit, '(a, f0.1)') 'bandwidth_one_gbytes ', traffic_rate(1)
   write (output_unit, '(a, f0.1)') 'bandwidth_all_gbytes ', traffic_rate(n_cores)

contains

   !> Rate of the product of two matrices of order 2000, the best of some trials [Gflop/s].
   real(dp) function product_rate() result(rate)
      integer, parameter :: n = 2000
      real(dp), allocatable :: a(:, :), b(:, :), c(:, :)
      real(dp) :: start
      integer :: trial

      call set_threads(1)
      allocate (a(n, n), b(n, n), c(n, n))
      call random_number(a)
      call random_number(b)
      rate = 0.0_dp
      do trial = 1, n_trials
         start = seconds()
         call dgemm('N', 'N', n, n, n, 1.0_dp, a, n, b, n, 0.0_dp, c, n)
         rate = max(rate, 2.0e-9_dp*real(n, dp)**3/(seconds() - start))
      end do
   end function product_rate

   !> Rate of `a = b + s c` on vectors far larger than the caches, the best of some trials: two reads, one write and
   !> the read that comes before a write are counted [10^9 byte/s].
   real(dp) function traffic_rate(n_threads) result(rate)
      integer, intent(in) :: n_threads !! threads at work
      integer, parameter :: n = 20000000, bytes_each = 4*8
      real(dp), allocatable :: a(:), b(:), c(:)
      real(dp) :: start
      integer :: trial, i

      allocate (a(n), b(n), c(n))
      !$omp parallel do num_threads(n_threads)
      do i = 1, n
         a(i) = 0.0_dp
         b(i) = 1.0_dp
         c(i) = 2.0_dp
      end do
      rate = 0.0_dp
      do trial = 1, n_trials
         start = seconds()
         !$omp parallel do num_threads(n_threads)
         do i = 1, n
            a(i) = b(i) + 3.0_dp*c(i)
         end do
         rate = max(rate, 1.0e-9_dp*real(bytes_each, dp)*n/(seconds() - start))
      end do
      if (a(n) < 6.0_dp) rate = 0.0_dp
   end function traffic_rate

   !> The wall clock [s].
   real(dp) function seconds()
      integer(int64) :: count, rate

      call system_clock(count, rate)
      seconds = real(count, dp)/real(rate, dp)
   end function seconds

end program rates
