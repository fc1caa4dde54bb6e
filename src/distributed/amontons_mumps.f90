!> Factorization by MUMPS of a matrix whose entries are spread over the ranks, with its Schur complement on rank 0.
!>
!> Arguments that MUMPS uses on rank 0 alone are ignored on the others. Every rank calls every procedure at the same
!> time.
module amontons_mumps
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_int, c_int64_t, c_null_char, c_null_ptr, &
      c_ptr
   use amontons_error, only: error_t, new_error, numerical_failure, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: mumps_report_t, mumps_t, mumps_text, new_mumps_error

   !> The report of MUMPS on a job.
   type, bind(c) :: mumps_report_t
      integer(c_int) :: code = 0 !! 0 or more: done; else what went wrong
      integer(c_int) :: detail = 0 !! its detail
      integer(c_int64_t) :: n_entries = 0 !! entries of the factor
      real(c_double) :: n_flops = 0.0_c_double !! floating-point operations of the factorization
      real(c_double) :: own_mb = 0.0_c_double !! memory that the factorization takes on this rank [MB]
      real(c_double) :: largest_mb = 0.0_c_double !! on the rank where it takes most [MB]
   end type mumps_report_t

   !> An instance of MUMPS; the matrix belongs to the caller.
   type :: mumps_t
      type(c_ptr), private :: handle = c_null_ptr !! MUMPS's side of it
      type(mumps_report_t) :: report !! its last report
   contains
      procedure :: analyze => mumps_analyze
      procedure :: factorize => mumps_factorize
      procedure :: free => mumps_free
      procedure :: solve => mumps_solve
   end type mumps_t

   abstract interface
      !> Tells an instance of MUMPS to free its factor or its other memory.
      subroutine release(handle) bind(c)
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle !! the instance
      end subroutine release
   end interface

   procedure(release), bind(c, name='amontons_mumps_free') :: c_mumps_free
   procedure(release), bind(c, name='amontons_mumps_drop_matrix') :: c_mumps_drop_matrix

   ! allow(assumed-size): C takes an address without a shape
   interface
      subroutine c_mumps_text(text, size) bind(c, name='amontons_mumps_text')
         import :: c_char, c_int
         implicit none (type, external)
         ! allow(assumed-size-character-intent): C writes here
         character(c_char), intent(out) :: text(*)
         integer(c_int), value :: size
      end subroutine c_mumps_text

      function c_mumps_new() bind(c, name='amontons_mumps_new') result(handle)
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr) :: handle
      end function c_mumps_new

      subroutine c_mumps_analyze(handle, n, n_entries, row, column, n_schur, schur, position, report) &
         bind(c, name='amontons_mumps_analyze')
         import :: c_int, c_int64_t, c_ptr, mumps_report_t
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int), value, intent(in) :: n, n_schur
         integer(c_int64_t), value, intent(in) :: n_entries
         integer(c_int), intent(inout) :: row(*), column(*), schur(*), position(*)
         type(mumps_report_t), intent(inout) :: report
      end subroutine c_mumps_analyze

      subroutine c_mumps_factorize(handle, value, schur, report) bind(c, name='amontons_mumps_factorize')
         import :: c_double, c_ptr, mumps_report_t
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         real(c_double), intent(inout) :: value(*), schur(*)
         type(mumps_report_t), intent(inout) :: report
      end subroutine c_mumps_factorize

      subroutine c_mumps_solve(handle, is_backward, n_loads, all, of_schur, report) &
         bind(c, name='amontons_mumps_solve')
         import :: c_double, c_int, c_ptr, mumps_report_t
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: handle
         integer(c_int), value, intent(in) :: is_backward, n_loads
         real(c_double), intent(inout) :: all(*), of_schur(*)
         type(mumps_report_t), intent(inout) :: report
      end subroutine c_mumps_solve
   end interface

contains

   !> The version of MUMPS.
   function mumps_text() result(text)
      character(:), allocatable :: text
      character(40) :: buffer

      buffer = c_null_char
      call c_mumps_text(buffer, len(buffer, c_int))
      text = buffer(:index(buffer, c_null_char) - 1)
   end function mumps_text

   !> Makes the instance and analyzes a matrix.
   subroutine mumps_analyze(self, n, row, column, n_schur, position, error)
      class(mumps_t), intent(inout) :: self !! the instance
      integer, intent(in) :: n !! number of unknowns; of rank 0
      integer, contiguous, intent(inout) :: row(:) !! rows of the entries that this rank has
      integer, contiguous, intent(inout) :: column(:) !! their columns; of each pair of symmetric entries one is given
      integer, intent(in) :: n_schur !! number of Schur variables, which are the last unknowns; used on rank 0
      integer, contiguous, intent(inout) :: position(:) !! position of each unknown; of rank 0
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      integer, allocatable :: schur(:)
      integer :: i

      call self%free()
      self%handle = c_mumps_new()
      allocate (schur(n_schur))
      do i = 1, n_schur
         schur(i) = n - n_schur + i
      end do
      call c_mumps_analyze(self%handle, int(n, c_int), size(row, kind=c_int64_t), row, column, int(n_schur, c_int), &
         schur, position, self%report)
      call new_mumps_error(self%report, error)
   end subroutine mumps_analyze

   !> Factorizes the matrix, whose entries may be deallocated afterwards.
   subroutine mumps_factorize(self, value, schur, error)
      class(mumps_t), intent(inout) :: self !! the instance, the matrix analyzed
      real(dp), contiguous, intent(inout) :: value(:) !! values of the entries that this rank has
      real(dp), contiguous, intent(inout) :: schur(:, :) !! the Schur complement; of rank 0 (n_schur, n_schur)
      type(error_t), allocatable, intent(out) :: error !! the matrix is singular, or memory ran out

      call c_mumps_factorize(self%handle, value, schur, self%report)
      call new_mumps_error(self%report, error)
      call c_mumps_drop_matrix(self%handle)
   end subroutine mumps_factorize

   !> Half of a solution: forward, it condenses loads to the Schur variables; backward, after a forward one, it expands
   !> the Schur variables to all unknowns under these loads.
   subroutine mumps_solve(self, is_backward, all_unknowns, of_schur)
      class(mumps_t), intent(inout) :: self !! the instance, the matrix factorized
      logical, intent(in) :: is_backward !! forward or backward half
      real(dp), contiguous, intent(inout) :: all_unknowns(:, :)
         !! the loads, or all unknowns on return; of rank 0 (n, loads)
      real(dp), contiguous, intent(inout) :: of_schur(:, :)
         !! the condensed loads, or the Schur variables; of rank 0 (n_schur, loads)

      call c_mumps_solve(self%handle, merge(1_c_int, 0_c_int, is_backward), size(all_unknowns, 2, kind=c_int), &
         all_unknowns, of_schur, self%report)
   end subroutine mumps_solve

   !> Frees the memory of the instance of MUMPS.
   subroutine mumps_free(self)
      class(mumps_t), intent(inout) :: self !! the instance

      if (c_associated(self%handle)) call c_mumps_free(self%handle)
      self%handle = c_null_ptr
   end subroutine mumps_free

   !> Makes an error of the report of MUMPS, if it is one.
   pure subroutine new_mumps_error(report, error)
      type(mumps_report_t), intent(in) :: report !! the report
      type(error_t), allocatable, intent(out) :: error !! what went wrong, if anything
      integer(int64) :: wanted

      if (report%code >= 0) return
      ! Negative counts are in millions.
      wanted = merge(int(report%detail, int64), -1000000*int(report%detail, int64), report%detail >= 0)
      select case (report%code)
      case (-10, -40)
         call new_error(error, numerical_failure, 'the stiffness is singular to rounding: the distributed '// &
            'factorization met a pivot that is not positive')
      case (-5, -7, -8, -9, -11, -13, -17, -19, -20)
         ! not raised: but by the unit tests of a build with MPI
         call new_error(error, system_failure, 'memory ran out in the distributed factorization: on a rank MUMPS '// &
            'asked for '//to_text(ceiling(8.0e-6_dp*wanted, int64))//' MB more, beside the '// &
            to_text(nint(report%largest_mb, int64))//' MB that it foresaw at most (its error '// &
            to_text(int(report%code))//'); use more machines, or fewer ranks on each')
      case default
         ! not raised: but by the unit tests of a build with MPI
         call new_error(error, system_failure, 'the distributed factorization failed (error '// &
            to_text(int(report%code))//', '//to_text(wanted)//" of MUMPS); factorization = 'multifrontal' does without")
      end select
   end subroutine new_mumps_error

end module amontons_mumps
