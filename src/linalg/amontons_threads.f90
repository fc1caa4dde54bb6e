!> The number of threads of the program's own loops, which is limited to one inside foreign libraries; and the BLAS in
!> use.
module amontons_threads
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use omp_lib, only: omp_get_active_level, omp_get_max_active_levels, omp_get_max_threads, &
      omp_set_max_active_levels, omp_set_num_threads, openmp_version
   implicit none (type, external)
   private

   public :: blas_text, limit_nested_threads, n_threads, openmp_date, restore_nested_threads, &
      set_threads, thread_state_t, use_blas_threads

   !> Year and month of the OpenMP standard that the compiler follows.
   integer, parameter :: openmp_date = openmp_version

   !> The settings that `limit_nested_threads` found, for `restore_nested_threads` to put back.
   type :: thread_state_t
      private
      integer :: active_levels = 1 !! Nested parallel regions that may be active.
      integer(c_int) :: blas_threads = 1 !! Threads inside the BLAS.
   end type thread_state_t

   ! allow(assumed-size): C takes an address without a shape
   interface
      subroutine c_blas_text(text, size) bind(c, name='amontons_blas_text')
         import :: c_char, c_int
         implicit none (type, external)
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_int), value :: size
      end subroutine c_blas_text

      subroutine end_blas_threads() bind(c, name='amontons_end_blas_threads')
         implicit none (type, external)
      end subroutine end_blas_threads

      !> Sets the number of threads of the BLAS, for a library without threads of its own; 1 restores the normal state.
      subroutine use_blas_threads(n) bind(c, name='amontons_set_blas_threads')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value, intent(in) :: n !! number of threads, at least 1
      end subroutine use_blas_threads

      !> Makes the BLAS allocate the memory that it needs on each thread; returns the number of threads for which there
      !> is enough.
      function take_blas_buffers(n) bind(c, name='amontons_take_blas_buffers') result(n_taken)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value, intent(in) :: n !! number of threads, at least 1
         integer(c_int) :: n_taken
      end function take_blas_buffers

      function blas_threads() bind(c, name='amontons_blas_threads') result(n)
         import :: c_int
         implicit none (type, external)
         integer(c_int) :: n
      end function blas_threads
   end interface

contains

   !> The name of the BLAS, with its version and its kernels if it reports them.
   function blas_text() result(text)
      character(:), allocatable :: text
      character(100) :: buffer

      call c_blas_text(buffer, len(buffer, c_int))
      text = buffer(:index(buffer, c_null_char) - 1)
   end function blas_text

   !> Sets the number of threads of the parallel loops, and one for the BLAS, whose own threads gain little and compete
   !> with those of the loops. If the address space is limited, the loops get no more threads than the BLAS has memory
   !> for. Not to be called from a parallel loop.
   subroutine set_threads(n)
      integer, intent(in) :: n !! number of threads, at least 1

      call use_blas_threads(1_c_int)
      call end_blas_threads()
      call omp_set_num_threads(int(take_blas_buffers(int(n, c_int))))
   end subroutine set_threads

   !> The number of threads a parallel loop gets.
   integer function n_threads()
      n_threads = omp_get_max_threads()
   end function n_threads

   !> Limits everything called from this thread to one thread, until `restore_nested_threads`; with two levels all but
   !> the parallel loops of the caller itself.
   subroutine limit_nested_threads(state, n_levels)
      type(thread_state_t), intent(out) :: state !! the settings to be restored
      integer, intent(in), optional :: n_levels !! number of nested parallel loops that may be active, by default 0

      state%active_levels = omp_get_max_active_levels()
      state%blas_threads = blas_threads()
      if (present(n_levels)) then
         call omp_set_max_active_levels(min(state%active_levels, omp_get_active_level() + n_levels))
      else
         call omp_set_max_active_levels(omp_get_active_level())
      end if
      call use_blas_threads(1_c_int)
   end subroutine limit_nested_threads

   !> Restores the settings from before `limit_nested_threads`.
   subroutine restore_nested_threads(state)
      type(thread_state_t), intent(in) :: state !! the settings to be restored

      call omp_set_max_active_levels(state%active_levels)
      call use_blas_threads(state%blas_threads)
   end subroutine restore_nested_threads

end module amontons_threads
