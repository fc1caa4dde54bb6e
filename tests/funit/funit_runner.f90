!> Runs tests one after the other and reports on them in the words of pFUnit.
module funit_runner
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use funit_exception, only: anyExceptions, catch_all, exception_t, SourceLocation
   use funit_text, only: to_text
   implicit none (type, external)
   private

   public :: funit_runner_t, new_runner

   abstract interface
      !> A test, or what is done before or after every test of a suite.
      subroutine procedure_i()
         implicit none (type, external)
      end subroutine procedure_i
   end interface

   !> The tests of one executable: which to run, and how they went.
   type :: funit_runner_t
      private
      logical :: is_verbose = .false. !! whether the beginning and the end of every test are told
      character(:), allocatable :: filter !! only tests whose full name contains this are run
      character(:), allocatable :: suite !! name of the present suite
      procedure(procedure_i), pointer, nopass :: before => null() !! done before every test of the suite, if associated
      procedure(procedure_i), pointer, nopass :: after => null() !! done after every test of the suite, if associated
      integer :: n_run = 0 !! number of tests run
      integer :: n_failed = 0 !! number of tests that failed
      integer :: n_disabled = 0 !! number of tests left out
   contains
      procedure, public :: disable => runner_disable
      procedure, public :: finish => runner_finish
      procedure, public :: run => runner_run
      procedure, public :: start_suite => runner_start_suite
      procedure :: is_wanted => runner_is_wanted
      procedure :: report => runner_report
   end type funit_runner_t

contains

   !> Makes a runner after the wishes of the command line.
   subroutine new_runner(runner)
      type(funit_runner_t), intent(out) :: runner !! the runner
      character(:), allocatable :: word
      integer :: position

      runner%filter = ''
      position = 1
      do while (position <= command_argument_count())
         word = argument(position)
         select case (word)
         case ('-v', '--verbose')
            runner%is_verbose = .true.
         case ('-f', '--filter')
            position = position + 1
            runner%filter = argument(position)
         case default
            write (error_unit, '(a)') 'usage: [-v|--verbose] [-f|--filter PART_OF_NAME]'
            stop 1
         end select
         position = position + 1
      end do
   end subroutine new_runner

   !> A word of the command line; empty where there is none.
   function argument(position) result(word)
      integer, intent(in) :: position !! number of the word
      character(:), allocatable :: word
      integer :: length

      call get_command_argument(position, length=length)
      word = repeat(' ', length)
      call get_command_argument(position, word)
   end function argument

   !> Begins a suite: the tests of one file.
   subroutine runner_start_suite(self, name, before, after)
      class(funit_runner_t), intent(inout) :: self !! the runner
      character(*), intent(in) :: name !! name of the suite
      procedure(procedure_i), optional :: before !! done before every test
      procedure(procedure_i), optional :: after !! done after every test, also after a failed one

      self%suite = name
      nullify (self%before, self%after)
      if (present(before)) self%before => before
      if (present(after)) self%after => after
   end subroutine runner_start_suite

   !> Whether the filter lets a test through.
   logical function runner_is_wanted(self, full_name)
      class(funit_runner_t), intent(in) :: self !! the runner
      character(*), intent(in) :: full_name !! suite and test

      runner_is_wanted = index(full_name, self%filter) > 0
   end function runner_is_wanted

   !> Counts a test that is not to run.
   subroutine runner_disable(self, name)
      class(funit_runner_t), intent(inout) :: self !! the runner
      character(*), intent(in) :: name !! name of the test

      if (self%is_wanted(self%suite//'.'//name)) self%n_disabled = self%n_disabled + 1
   end subroutine runner_disable

   !> Runs a test; whatever is pending at its end makes it fail.
   subroutine runner_run(self, name, body)
      class(funit_runner_t), intent(inout) :: self !! the runner
      character(*), intent(in) :: name !! name of the test
      procedure(procedure_i) :: body !! the test
      character(:), allocatable :: full_name

      full_name = self%suite//'.'//name
      if (.not. self%is_wanted(full_name)) return
      self%n_run = self%n_run + 1
      if (self%is_verbose) write (output_unit, '(a)') ' Start: '//full_name
      ! Whatever the test does to the process, what was told before must be seen.
      flush (output_unit)
      if (associated(self%before)) call self%before()
      if (.not. anyExceptions()) then
         call body()
         if (associated(self%after)) call self%after()
      end if
      if (anyExceptions()) call self%report(full_name)
      if (self%is_verbose) write (output_unit, '(a)') '   end: '//full_name
   end subroutine runner_run

   !> Takes the pending exceptions and tells them.
   subroutine runner_report(self, full_name)
      class(funit_runner_t), intent(inout) :: self !! the runner
      character(*), intent(in) :: full_name !! suite and test
      type(exception_t), allocatable :: exceptions(:)
      integer :: position

      self%n_failed = self%n_failed + 1
      if (self%is_verbose) write (output_unit, '(a)') ' Failure in '//full_name
      call catch_all(exceptions)
      do position = 1, size(exceptions)
         write (output_unit, '(a)') 'Failure', ' in: ', full_name, '  Location: ', &
            place(exceptions(position)%location), exceptions(position)%message, ''
      end do
   end subroutine runner_report

   !> A line of a test file in the form that editors jump to.
   pure function place(location) result(text)
      type(SourceLocation), intent(in) :: location !! the line
      character(:), allocatable :: text

      text = '[<unknown location>]'
      if (location%file /= '') text = '['//trim(location%file)//':'//to_text(location%line)//']'
   end function place

   !> Sums up; ends the program with status 2 if a test failed.
   subroutine runner_finish(self)
      class(funit_runner_t), intent(in) :: self !! the runner
      character(:), allocatable :: text

      if (self%n_failed > 0) then
         write (output_unit, '(a)') ' FAILURES!!!', 'Tests run: '//to_text(self%n_run)//', Failures: '// &
            to_text(self%n_failed)//', Errors: 0', ', Disabled: '//to_text(self%n_disabled), '', &
            '*** Encountered 1 or more failures/errors during testing ***'
         stop 2
      end if
      text = to_text(self%n_run)//' test'
      if (self%n_run > 1) text = text//'s'
      if (self%n_disabled > 0) text = text//', '//to_text(self%n_disabled)//' disabled'
      write (output_unit, '(a)') ' OK', ' ('//text//')'
   end subroutine runner_finish

end module funit_runner
