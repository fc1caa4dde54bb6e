!> The files of a case while they are verified: its summary and its deck as they were read, and what does not agree.
module amontons_verified_case
   use amontons_config, only: config_t
   use amontons_document, only: document_t
   use amontons_document_check, only: compare_document
   use amontons_error, only: fault_list_t
   use amontons_kinds, only: dp
   use amontons_summary, only: member_value
   use amontons_text, only: read_real
   implicit none (type, external)
   private

   public :: verified_case_t

   !> A case, its faults and its verdict.
   type :: verified_case_t
      character(:), allocatable :: stem !! directory and name of the case
      character(:), allocatable :: summary !! all bytes of its summary; not allocated if it cannot be read
      type(config_t) :: config !! the case as its effective deck has it
      type(fault_list_t) :: faults !! what does not agree
      logical :: is_certified = .false. !! whether it converged and its certificate passes, or it has no equilibrium
   contains
      procedure :: compare => verified_case_compare
      procedure :: fault => verified_case_fault
      procedure :: number => verified_case_number
      procedure :: value => verified_case_value
   end type verified_case_t

contains

   !> Compares the texts as they were written with those that follow from the other files.
   subroutine verified_case_compare(self, documents, summary)
      class(verified_case_t), intent(inout) :: self !! the case; gains the faults
      type(document_t), intent(in) :: documents(:) !! the texts, but for the summary
      type(document_t), intent(in) :: summary !! the summary
      integer :: i

      call compare_document(self%faults, self%stem, summary)
      do i = size(documents), 1, -1
         call compare_document(self%faults, self%stem, documents(i))
      end do
   end subroutine verified_case_compare

   !> Adds what is wrong with a file, if anything is.
   pure subroutine verified_case_fault(self, ending, sentence)
      class(verified_case_t), intent(inout) :: self !! the case; gains the fault
      character(*), intent(in) :: ending !! what the name of the file ends with, behind that of the case
      character(*), intent(in) :: sentence !! what is wrong; empty if nothing is

      if (len(sentence) > 0) call self%faults%add(self%stem//ending, sentence)
   end subroutine verified_case_fault

   !> A member of the summary as a number; 0 if it is none.
   pure real(dp) function verified_case_number(self, section, member) result(number)
      class(verified_case_t), intent(in) :: self !! the case
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      logical :: ok

      call read_real(self%value(section, member), number, ok)
      if (.not. ok) number = 0.0_dp
   end function verified_case_number

   !> The text of a member of the summary; empty if there is no such member.
   pure function verified_case_value(self, section, member) result(value)
      class(verified_case_t), intent(in) :: self !! the case
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      character(:), allocatable :: value

      value = member_value(self%summary, section, member)
   end function verified_case_value

end module amontons_verified_case
