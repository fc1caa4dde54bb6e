!> The error value that a procedure returns when it fails; lists of the faults of input files, or of verified results,
!> so that one run reports all of them; and warnings, one sentence each, about valid results.
!>
!> A procedure that can fail ends its argument list with `type(error_t), allocatable, intent(out) :: error`. Allocated
!> means failed, and the caller returns at once.
module amontons_error
   use amontons_kinds, only: dp
   use amontons_text, only: newline, occurrences, vector_text, short_text, to_text, with_unit
   implicit none (type, external)
   private

   public :: error_t, fault_list_t, input_refused, new_error, no_equilibrium, numerical_failure, system_failure, &
      warning_list_t

   !> Kind of an error: invalid input, that is, a deck, a mesh or an argument. Exit status 1.
   integer, parameter :: input_refused = 1
   !> Kind of an error: the computation failed, for example because a matrix is not positive definite. Exit status 2.
   integer, parameter :: numerical_failure = 2
   !> Kind of an error: the system failed, for example because a file cannot be written or memory ran out. Exit status
   !> 3.
   integer, parameter :: system_failure = 3

   !> Kind of an error: contact and friction cannot balance the loads, or nothing holds the body. Exit status 2,
   !> too; 6 in the C interface.
   integer, parameter :: no_equilibrium = 6

   !> A failure, described in the user's words.
   type :: error_t
      integer :: kind = system_failure
         !! Whose fault it is: `input_refused`, `numerical_failure`, `no_equilibrium` or `system_failure`.
      character(:), allocatable :: message !! What, where and what was expected; a line for each fault.
   end type error_t

   !> Largest number of faults that are kept; further ones are only counted, since such a file is of another kind than
   !> the reader expects.
   integer, parameter :: most_kept = 1000

   !> One fault of a file.
   type :: fault_t
      integer :: line = 0 !! where, counted from 1; 0 for the whole file, and where the sentence has the line
      character(:), allocatable :: sentence !! the fault, as a sentence
   end type fault_t

   !> The faults found so far, ordered by line.
   type :: fault_list_t
      private
      type(fault_t), allocatable :: faults(:) !! the first `n` of these are in use
      integer, public :: n = 0 !! number of faults found, more than are kept perhaps
   contains
      generic, public :: add => add_in_file, add_in_line
      procedure, public :: append => fault_list_append
      procedure, public :: finish => fault_list_finish
      procedure, public :: text => fault_list_text
      procedure, private :: add_in_file => fault_list_add_in_file
      procedure, private :: add_in_line => fault_list_add_in_line
   end type fault_list_t

   !> Warnings in the order in which they were found.
   type :: warning_list_t
      private
      character(:), allocatable :: text !! the sentences, each with a line end behind it; not allocated without any
      character(:), allocatable, public :: units !! names of the units of the case; may be left out
   contains
      procedure :: add => warning_list_add
      procedure :: item => warning_list_item
      procedure :: n => warning_list_n
      procedure :: number => warning_list_number
      procedure :: place => warning_list_place
   end type warning_list_t

contains

   !> Makes an error from its kind and its message.
   pure subroutine new_error(error, kind, message)
      type(error_t), allocatable, intent(out) :: error !! the error, allocated on return
      integer, intent(in) :: kind !! `input_refused`, `numerical_failure`, `no_equilibrium` or `system_failure`
      character(*), intent(in) :: message !! what, where, what was expected

      allocate (error)
      error%kind = kind
      error%message = message
   end subroutine new_error

   !> Inserts a fault behind those of its line and of the lines before.
   !>
   !> A fault that is already in the list is not added again: a wrong value with a repeat count is wrong in every
   !> element.
   pure subroutine fault_list_add_in_line(self, line, sentence)
      class(fault_list_t), intent(inout) :: self !! the faults so far
      integer, intent(in) :: line !! line of the file; 0 for the whole file
      character(*), intent(in) :: sentence !! what is wrong, without file and line
      integer :: place, i

      if (.not. allocated(self%faults)) allocate (self%faults(most_kept))
      place = min(self%n, most_kept)
      do while (place > 0)
         if (self%faults(place)%line <= line) exit
         place = place - 1
      end do
      if (place > 0 .and. line > 0) then
         if (self%faults(place)%line == line .and. self%faults(place)%sentence == sentence) return
      end if
      self%n = self%n + 1
      if (self%n > most_kept) return
      do i = self%n, place + 2, -1
         self%faults(i) = self%faults(i - 1)
      end do
      self%faults(place + 1)%line = line
      self%faults(place + 1)%sentence = sentence
   end subroutine fault_list_add_in_line

   !> Adds a fault of one of several files; the sentence may quote any bytes.
   pure subroutine fault_list_add_in_file(self, file, sentence)
      class(fault_list_t), intent(inout) :: self !! the faults so far
      character(*), intent(in) :: file !! name of the file, or file and line
      character(*), intent(in) :: sentence !! the fault, as a sentence

      call self%add(0, file//': '//printable(sentence))
   end subroutine fault_list_add_in_file

   !> A text with every byte that is not a printable ASCII character replaced by a question mark.
   pure function printable(text)
      character(*), intent(in) :: text !! the text
      character(len(text)) :: printable
      integer :: i

      printable = text
      do i = 1, len(text)
         if (text(i:i) == newline .or. (iachar(text(i:i)) >= 32 .and. iachar(text(i:i)) < 127)) cycle
         printable(i:i) = '?'
      end do
   end function printable

   !> Appends the faults of another list.
   pure subroutine fault_list_append(self, other)
      class(fault_list_t), intent(inout) :: self !! the faults so far
      type(fault_list_t), intent(in) :: other !! the other list
      integer :: i

      do i = 1, min(other%n, most_kept)
         call self%add(other%faults(i)%line, other%faults(i)%sentence)
      end do
      self%n = self%n + max(0, other%n - most_kept)
   end subroutine fault_list_append

   !> The first faults as lines of text, without the end of the last line; empty if there are none.
   pure function fault_list_text(self) result(text)
      class(fault_list_t), intent(in) :: self !! the faults
      character(:), allocatable :: text
      integer, parameter :: enough = 20

      text = first_faults(self, '', enough)
   end function fault_list_text

   !> Makes one error of all faults, one line of text each; no error if there are no faults.
   subroutine fault_list_finish(self, file, error)
      class(fault_list_t), intent(in) :: self !! all faults
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the faults, in order

      if (self%n > 0) call new_error(error, input_refused, first_faults(self, file//':', most_kept))
   end subroutine fault_list_finish

   !> The first faults as lines of text, followed by the number of the others.
   pure function first_faults(list, head, most) result(text)
      type(fault_list_t), intent(in) :: list !! the faults
      character(*), intent(in) :: head !! text before the line number of each; may be empty
      integer, intent(in) :: most !! largest number of faults in the text; the others are counted
      character(:), allocatable :: text, place
      integer :: i

      text = ''
      do i = 1, min(list%n, most)
         place = head
         if (list%faults(i)%line > 0) place = place//to_text(list%faults(i)%line)//':'
         if (len(place) > 0) place = place//' '
         if (i > 1) text = text//newline
         text = text//place//list%faults(i)%sentence
      end do
      if (list%n <= most) return
      text = text//newline//head
      if (len(head) > 0) text = text//' '
      text = text//to_text(list%n - most)//' more faults follow'
   end function first_faults

   !> Adds a warning to the list.
   pure subroutine warning_list_add(self, sentence)
      class(warning_list_t), intent(inout) :: self !! the warnings
      character(*), intent(in) :: sentence !! the warning, a sentence without a line end

      if (.not. allocated(self%text)) self%text = ''
      self%text = self%text//sentence//newline
   end subroutine warning_list_add

   !> A number with its unit, if the case names units, for the text of a warning.
   pure function warning_list_number(self, value, dimension) result(text)
      class(warning_list_t), intent(in) :: self !! the warnings
      real(dp), intent(in) :: value !! the number
      character(*), intent(in) :: dimension !! its dimension, as `unit_of` reads it
      character(:), allocatable :: text

      text = short_text(value)
      if (allocated(self%units)) text = with_unit(text, self%units, dimension)
   end function warning_list_number

   !> A position with its unit, if the case names units, for the text of a warning.
   pure function warning_list_place(self, position) result(text)
      class(warning_list_t), intent(in) :: self !! the warnings
      real(dp), intent(in) :: position(:) !! the place [L]
      character(:), allocatable :: text

      text = vector_text(position)
      if (allocated(self%units)) text = with_unit(text, self%units, 'L')
   end function warning_list_place

   !> Number of warnings in the list.
   pure integer function warning_list_n(self) result(n)
      class(warning_list_t), intent(in) :: self !! the warnings

      n = 0
      if (allocated(self%text)) n = occurrences(self%text, newline)
   end function warning_list_n

   !> The text of one warning.
   pure function warning_list_item(self, number) result(sentence)
      class(warning_list_t), intent(in) :: self !! the warnings
      integer, intent(in) :: number !! which one, 1 to `n`
      character(:), allocatable :: sentence
      integer :: first, i

      first = 1
      do i = 1, number - 1
         first = first + index(self%text(first:), newline)
      end do
      sentence = self%text(first:first + index(self%text(first:), newline) - 2)
   end function warning_list_item

end module amontons_error
