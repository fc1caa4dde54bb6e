!> NAME.summary.json, read back and compared with what follows from the other files.
module amontons_summary_check
   use amontons_agreement, only: agree, contradiction, fault_text_t
   use amontons_certificate, only: certificate_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, stick_point
   use amontons_kinds, only: dp
   use amontons_text, only: newline, read_real, to_text
   implicit none (type, external)
   private

   public :: summary_check_t

   !> A summary and what does not agree with it.
   type :: summary_check_t
      character(:), allocatable :: path !! name of the file
      character(:), allocatable :: text !! all of its bytes
      type(fault_text_t) :: faults !! what does not agree
   contains
      procedure :: expect_certificate => summary_check_expect_certificate
      procedure :: expect_contact => summary_check_expect_contact
      procedure :: expect_number => summary_check_expect_number
      procedure :: expect_text => summary_check_expect_text
      procedure :: take_condition => summary_check_take_condition
      procedure :: value => summary_check_value
   end type summary_check_t

contains

   !> The text of a member's value, up to the comma or bracket behind it; empty if there is no such member.
   pure function summary_check_value(self, section, member) result(value)
      class(summary_check_t), intent(in) :: self !! the summary
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
   end function summary_check_value

   !> Takes the condition number, which only the factor gives, as it is stated; 0 if it is not.
   pure subroutine summary_check_take_condition(self, condition)
      class(summary_check_t), intent(in) :: self !! the summary
      real(dp), intent(out) :: condition !! the condition number [-]
      logical :: is_stated

      call read_real(self%value('', 'condition'), condition, is_stated)
      if (.not. is_stated) condition = 0.0_dp
   end subroutine summary_check_take_condition

   !> Compares a member with the text that follows from the other files.
   subroutine summary_check_expect_text(self, section, member, text)
      class(summary_check_t), intent(inout) :: self !! the summary
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      character(*), intent(in) :: text !! its value as JSON
      character(:), allocatable :: stated

      stated = self%value(section, member)
      if (stated /= text .or. len(stated) /= len(text)) call self%faults%add(self%path, &
         full_name(section, member)//' is '//stated//', but '//text//' follows from the other files')
   end subroutine summary_check_expect_text

   !> Compares a member with the number that follows from the other files.
   subroutine summary_check_expect_number(self, section, member, number, scale)
      class(summary_check_t), intent(inout) :: self !! the summary
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      real(dp), intent(in) :: number !! its value
      real(dp), intent(in) :: scale !! the largest number of its kind
      real(dp) :: stated
      logical :: ok

      call read_real(self%value(section, member), stated, ok)
      if (.not. ok) then
         call self%faults%add(self%path, full_name(section, member)//": expected a number, found '"// &
            self%value(section, member)//"'")
      else if (.not. agree(stated, number, max(abs(number), scale))) then
         call self%faults%add(self%path, contradiction(full_name(section, member), stated, number))
      end if
   end subroutine summary_check_expect_number

   !> Compares the certificate. Violations are ratios: 1 is a large one.
   subroutine summary_check_expect_certificate(self, certificate)
      class(summary_check_t), intent(inout) :: self !! the summary
      type(certificate_t), intent(in) :: certificate !! the certificate that follows from the other files

      associate (c => certificate)
         call self%expect_number('certificate', 'equilibrium', c%equilibrium, 1.0_dp)
         call self%expect_number('certificate', 'penetration', c%penetration, 1.0_dp)
         call self%expect_number('certificate', 'tension', c%tension, 1.0_dp)
         call self%expect_number('certificate', 'friction_excess', c%friction_excess, 1.0_dp)
         call self%expect_number('certificate', 'complementarity', c%complementarity, 1.0_dp)
         call self%expect_number('certificate', 'slip_below_bound', c%slip_below_bound, 1.0_dp)
         call self%expect_number('certificate', 'wrong_dissipation', c%wrong_dissipation, 1.0_dp)
         call self%expect_number('certificate', 'resultant', c%resultant, 1.0_dp)
         call self%expect_number('certificate', 'moment', c%moment, 1.0_dp)
         call self%expect_number('certificate', 'energy', c%energy, 1.0_dp)
         if (c%has_duality_gap) call self%expect_number('certificate', 'duality_gap', c%duality_gap, 1.0_dp)
         call self%expect_number('certificate', 'strain_energy', c%strain_energy, abs(c%strain_energy))
         call self%expect_number('certificate', 'dissipation', c%dissipation, abs(c%strain_energy))
      end associate
   end subroutine summary_check_expect_certificate

   !> Compares the counts of the contact points and the sums of their forces.
   subroutine summary_check_expect_contact(self, status, normal, tangential)
      class(summary_check_t), intent(inout) :: self !! the summary
      integer, intent(in) :: status(:) !! statuses of the points (m)
      real(dp), intent(in) :: normal(:) !! their normal forces (m) [F]
      real(dp), intent(in) :: tangential(:) !! their tangential forces (m) [F]
      real(dp) :: scale

      scale = sum(abs(normal)) + sum(abs(tangential))
      call self%expect_text('counts', 'contact_points', to_text(size(status)))
      call self%expect_text('counts', 'open', to_text(count(status == open_point)))
      call self%expect_text('counts', 'stick', to_text(count(status == stick_point)))
      call self%expect_text('counts', 'slip', to_text(count(status == slip_plus .or. status == slip_minus)))
      call self%expect_number('resultants', 'normal_force', sum(normal), scale)
      call self%expect_number('resultants', 'tangential_force', sum(tangential), scale)
   end subroutine summary_check_expect_contact

   !> A member with the one that it is in.
   pure function full_name(section, member) result(name)
      character(*), intent(in) :: section !! the member that it is in; empty for none
      character(*), intent(in) :: member !! its name
      character(:), allocatable :: name

      name = member
      if (len(section) > 0) name = section//'.'//member
   end function full_name

end module amontons_summary_check
