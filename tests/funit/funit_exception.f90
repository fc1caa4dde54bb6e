!> The exceptions that failed assertions leave pending until the test ends or somebody catches them.
module funit_exception
   implicit none (type, external)
   private

   public :: anyExceptions, catch, catch_all, exception_t, fail, SourceLocation, throw

   !> A line of a test file. The fixed length keeps it free of allocations: one is made for every assertion.
   type :: SourceLocation
      character(64) :: file = '' !! name of the file, without its directory; blank: unknown
      integer :: line = 0 !! number of the line
   end type SourceLocation

   !> Something that went wrong in a test.
   type :: exception_t
      character(:), allocatable :: message !! what went wrong
      type(SourceLocation) :: location !! where
   end type exception_t

   !> What was thrown and not yet caught, oldest first.
   type(exception_t), allocatable :: pending(:)

   !> Removes a pending exception and says whether there was one.
   interface catch
      procedure :: catch_last, catch_message
   end interface catch

contains

   !> Makes an exception pending.
   subroutine throw(message, location)
      character(*), intent(in) :: message !! what went wrong
      type(SourceLocation), intent(in), optional :: location !! where; absent: unknown
      type(exception_t), allocatable :: longer(:)
      integer :: n_pending

      n_pending = count_pending()
      allocate (longer(n_pending + 1))
      if (n_pending > 0) longer(:n_pending) = pending
      longer(n_pending + 1)%message = message
      if (present(location)) longer(n_pending + 1)%location = location
      call move_alloc(longer, pending)
   end subroutine throw

   !> Throws what a failed assertion has to say: the user's message on a line of its own, then the finding.
   subroutine fail(finding, message, location)
      character(*), intent(in) :: finding !! what the assertion found; may be empty
      character(*), intent(in), optional :: message !! the user's message
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      character(:), allocatable :: text

      text = ''
      if (present(message)) text = trim(message)
      if (len(text) > 0 .and. len(finding) > 0) text = text//new_line('a')
      call throw(text//finding, location)
   end subroutine fail

   !> Whether an exception is pending.
   logical function anyExceptions()
      anyExceptions = count_pending() > 0
   end function anyExceptions

   !> Removes the youngest exception.
   logical function catch_last()
      catch_last = anyExceptions()
      if (catch_last) call remove(size(pending))
   end function catch_last

   !> Removes the oldest exception with a message.
   logical function catch_message(message)
      character(*), intent(in) :: message !! exact text, trailing blanks aside
      integer :: position

      catch_message = .false.
      do position = 1, count_pending()
         catch_message = pending(position)%message == message
         if (catch_message) exit
      end do
      if (catch_message) call remove(position)
   end function catch_message

   !> Removes every exception and hands them out, oldest first.
   subroutine catch_all(exceptions)
      type(exception_t), allocatable, intent(out) :: exceptions(:) !! what was pending

      if (.not. anyExceptions()) allocate (pending(0))
      call move_alloc(pending, exceptions)
   end subroutine catch_all

   !> Number of pending exceptions.
   integer function count_pending()
      count_pending = 0
      if (allocated(pending)) count_pending = size(pending)
   end function count_pending

   !> Takes one exception out of the list.
   subroutine remove(position)
      integer, intent(in) :: position !! its place in the list
      type(exception_t), allocatable :: kept(:)

      allocate (kept(size(pending) - 1))
      kept(:position - 1) = pending(:position - 1)
      kept(position:) = pending(position + 1:)
      call move_alloc(kept, pending)
   end subroutine remove

end module funit_exception
