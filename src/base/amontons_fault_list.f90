!> The faults of input files, or of results that are verified, collected so that one run reports them all.
module amontons_fault_list
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_text, only: newline, to_text
   implicit none (type, external)
   private

   public :: fault_list_t

   !> How many faults are kept; a file with more is not the file its reader expects, and the rest is only counted.
   integer, parameter :: most_kept = 1000

   !> One thing that is wrong.
   type :: fault_t
      integer :: line = 0 !! where, counted from 1; 0 for the whole file, and where the sentence says it
      character(:), allocatable :: sentence !! what is wrong
   end type fault_t

   !> Everything found wrong so far, ordered by line.
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

contains

   !> Puts a fault behind those of its line and of the lines before.
   !>
   !> The same fault again is not another one: a wrong value with a repeat count is wrong in every element.
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

   !> Adds a fault of one of several files; what the sentence quotes may be any bytes.
   pure subroutine fault_list_add_in_file(self, file, sentence)
      class(fault_list_t), intent(inout) :: self !! the faults so far
      character(*), intent(in) :: file !! name of the file, or file and line
      character(*), intent(in) :: sentence !! what is wrong

      call self%add(0, file//': '//printable(sentence))
   end subroutine fault_list_add_in_file

   !> A text that quotes what was changed, with question marks for all that is no letter, digit or sign.
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

   !> Adds the faults of another list.
   pure subroutine fault_list_append(self, other)
      class(fault_list_t), intent(inout) :: self !! the faults so far
      type(fault_list_t), intent(in) :: other !! the other list
      integer :: i

      do i = 1, min(other%n, most_kept)
         call self%add(other%faults(i)%line, other%faults(i)%sentence)
      end do
      self%n = self%n + max(0, other%n - most_kept)
   end subroutine fault_list_append

   !> The first faults as lines of text, without the end of the last one; empty if there is none. They show what is
   !> wrong, the others only how much.
   pure function fault_list_text(self) result(text)
      class(fault_list_t), intent(in) :: self !! the faults
      character(:), allocatable :: text
      integer, parameter :: enough = 20

      text = told(self, '', enough)
   end function fault_list_text

   !> Turns the faults into one error, a line of text for each; no fault, no error.
   subroutine fault_list_finish(self, file, error)
      class(fault_list_t), intent(in) :: self !! all faults
      character(*), intent(in) :: file !! name of the file
      type(error_t), allocatable, intent(out) :: error !! the faults, in order

      if (self%n > 0) call new_error(error, input_refused, told(self, file//':', most_kept))
   end subroutine fault_list_finish

   !> The first faults as lines of text.
   pure function told(list, head, most) result(text)
      type(fault_list_t), intent(in) :: list !! the faults
      character(*), intent(in) :: head !! what each begins with, before the number of its line; or nothing
      integer, intent(in) :: most !! how many are told; of the others only the number
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
   end function told

end module amontons_fault_list
