!> NAME.summary.json, read back: what only the run knew, and the faults of the case.
module amontons_summary_file
   use amontons_fault_list, only: fault_list_t
   use amontons_kinds, only: dp
   use amontons_text, only: newline, read_real
   implicit none (type, external)
   private

   public :: summary_file_t

   !> A summary and what does not agree with it.
   type :: summary_file_t
      character(:), allocatable :: path !! name of the file
      character(:), allocatable :: text !! all of its bytes
      type(fault_list_t) :: faults !! what does not agree
   contains
      procedure :: number => summary_file_number
      procedure :: value => summary_file_value
   end type summary_file_t

contains

   !> The text of a member's value, up to the comma or bracket behind it; empty if there is no such member.
   pure function summary_file_value(self, section, member) result(value)
      class(summary_file_t), intent(in) :: self !! the summary
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      character(:), allocatable :: value
      integer :: first, last

      value = ''
      if (len(section) == 0) then
         first = index(self%text, newline//'  "'//member//'": ') + 1
         last = first + index(self%text(first:), newline) - 2
      else
         first = index(self%text, newline//'  "'//section//'": {') + 1
         last = first + index(self%text(first:), newline) - 2
         if (first > 1) first = first + index(self%text(first:last), '"'//member//'": ') - 1
      end if
      if (first < 2 .or. self%text(first:first) == newline .or. last < first) return
      first = first + index(self%text(first:last), '": ') + 2
      if (len(section) > 0) last = first + scan(self%text(first:last), ',}') - 2
      if (len(section) == 0 .and. self%text(last:last) == ',') last = last - 1
      value = self%text(first:last)
   end function summary_file_value

   !> A member as a number; 0 if it is none.
   pure real(dp) function summary_file_number(self, section, member) result(number)
      class(summary_file_t), intent(in) :: self !! the summary
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      logical :: ok

      call read_real(self%value(section, member), number, ok)
      if (.not. ok) number = 0.0_dp
   end function summary_file_number

end module amontons_summary_file
