!> The faults of an input file, collected so that one run reports them all.
module amontons_fault_list
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_text, only: newline, to_text
   implicit none (type, external)
   private

   public :: fault_list_t

   !> How many faults are told; a file with more is not the file its reader expects, and the rest is only counted.
   integer, parameter :: most_told = 1000

   !> One thing wrong with the file.
   type :: fault_t
      integer :: line = 0 !! line of the file, 0 for the file as a whole
      character(:), allocatable :: sentence !! what is wrong and what was expected
   end type fault_t

   !> Everything found wrong with one file so far, ordered by line.
   type :: fault_list_t
      private
      type(fault_t), allocatable :: faults(:) !! the faults told, `min(n_found, most_told)` of them
      integer :: n_found = 0 !! number of faults found
   contains
      procedure, public :: add => fault_list_add
      procedure, public :: count => fault_list_count
      procedure, public :: finish => fault_list_finish
   end type fault_list_t

contains

   !> Puts a fault behind those of its line and of the lines before.
   !>
   !> The same fault again is not another one: a wrong value with a repeat count is wrong in every element.
   subroutine fault_list_add(self, line, sentence)
      class(fault_list_t), intent(inout) :: self !! the list
      integer, intent(in) :: line !! line of the file, 0 for the file as a whole
      character(*), intent(in) :: sentence !! what is wrong and what was expected
      integer :: place, i

      if (.not. allocated(self%faults)) allocate (self%faults(most_told))
      place = min(self%n_found, most_told)
      do while (place > 0)
         if (self%faults(place)%line <= line) exit
         place = place - 1
      end do
      if (place > 0) then
         if (self%faults(place)%line == line .and. self%faults(place)%sentence == sentence) return
      end if
      self%n_found = self%n_found + 1
      if (self%n_found > most_told) return
      do i = self%n_found, place + 2, -1
         self%faults(i) = self%faults(i - 1)
      end do
      self%faults(place + 1) = fault_t(line, sentence)
   end subroutine fault_list_add

   !> Number of faults found so far.
   pure integer function fault_list_count(self) result(n_faults)
      class(fault_list_t), intent(in) :: self !! the list

      n_faults = self%n_found
   end function fault_list_count

   !> Turns the faults into one error, a line of text for each; no fault, no error.
   subroutine fault_list_finish(self, file, error)
      class(fault_list_t), intent(in) :: self !! the list
      character(*), intent(in) :: file !! name of the file the faults are in
      type(error_t), allocatable, intent(out) :: error !! the faults, where there is any
      character(:), allocatable :: message
      integer :: i

      if (self%n_found == 0) return
      message = ''
      do i = 1, min(self%n_found, most_told)
         if (i > 1) message = message//newline
         message = message//file//':'
         if (self%faults(i)%line > 0) message = message//to_text(self%faults(i)%line)//':'
         message = message//' '//self%faults(i)%sentence
      end do
      if (self%n_found > most_told) message = message//newline//file//': '// &
         to_text(self%n_found - most_told)//' more faults follow'
      call new_error(error, input_refused, message)
   end subroutine fault_list_finish

end module amontons_fault_list
