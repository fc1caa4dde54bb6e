!> The parts of a listing that follow from other files, compared line by line.
module amontons_listing_check
   use amontons_agreement, only: agree, fault_text_t
   use amontons_kinds, only: dp
   use amontons_text, only: newline, read_real, to_text
   implicit none (type, external)
   private

   public :: check_section

   !> What stands between the words of a listing.
   character(*), parameter :: separators = ' (),;:'
   !> Numbers have seven digits; the last may be rounded up in one listing and down in another [-].
   real(dp), parameter :: rounding = 2.0e-6_dp

contains

   !> Compares one or more sections, headings included, with those of a listing.
   subroutine check_section(faults, path, listing, section, scale)
      type(fault_text_t), intent(inout) :: faults !! gains the first line that does not agree
      character(*), intent(in) :: path !! name of the listing
      character(*), intent(in) :: listing !! the listing
      character(*), intent(in) :: section !! what should stand there, from an empty line on, whole lines
      real(dp), intent(in) :: scale !! what numbers are measured by besides themselves; 0 for themselves alone
      integer :: at_listing, at_section, last_listing, last_section

      at_section = 2
      ! The heading.
      at_listing = index(listing, section(:1 + index(section(2:), newline))) + 1
      if (at_listing == 1) then
         call faults%add(path, "the section '"//section(2:index(section(2:), newline))//"' is missing")
         return
      end if
      do while (at_section <= len(section))
         last_section = at_section + index(section(at_section:), newline) - 2
         last_listing = at_listing + index(listing(at_listing:)//newline, newline) - 2
         if (.not. lines_agree(listing(at_listing:last_listing), section(at_section:last_section), scale)) then
            call faults%add(path//':'//to_text(line_number(listing, at_listing)), "'"// &
               trim(adjustl(listing(at_listing:last_listing)))//"', but '"// &
               trim(adjustl(section(at_section:last_section)))//"' follows from the other files")
            return
         end if
         at_section = last_section + 2
         at_listing = min(last_listing + 2, len(listing) + 1)
      end do
   end subroutine check_section

   !> Whether two lines have the same words, but for the rounding of numbers.
   pure logical function lines_agree(stated, computed, scale) result(is_same)
      character(*), intent(in) :: stated !! one line
      character(*), intent(in) :: computed !! the other line
      real(dp), intent(in) :: scale !! what numbers are measured by besides themselves
      integer :: i, j, last_i, last_j

      is_same = stated == computed
      if (is_same) return
      i = 1
      j = 1
      do
         i = next_word(stated, i)
         j = next_word(computed, j)
         if (i > len(stated) .or. j > len(computed)) exit
         last_i = i + scan(stated(i:)//' ', separators) - 2
         last_j = j + scan(computed(j:)//' ', separators) - 2
         if (.not. words_agree(stated(i:last_i), computed(j:last_j), scale)) return
         i = last_i + 1
         j = last_j + 1
      end do
      is_same = i > len(stated) .and. j > len(computed)
   end function lines_agree

   !> Whether two words are the same, or numbers that differ by rounding.
   pure logical function words_agree(stated, computed, scale) result(is_same)
      character(*), intent(in) :: stated !! one word
      character(*), intent(in) :: computed !! the other word
      real(dp), intent(in) :: scale !! what numbers are measured by besides themselves
      real(dp) :: a, b
      logical :: is_a, is_b

      is_same = stated == computed
      if (is_same) return
      call read_real(stated, a, is_a)
      call read_real(computed, b, is_b)
      if (is_a .and. is_b) is_same = abs(a - b) <= rounding*max(abs(a), abs(b)) .or. agree(a, b, scale)
   end function words_agree

   !> Where the next word begins; behind the end of the line if there is none.
   pure integer function next_word(line, first) result(place)
      character(*), intent(in) :: line !! the line
      integer, intent(in) :: first !! where to begin
      integer :: i

      place = len(line) + 1
      if (first > len(line)) return
      i = verify(line(first:), separators)
      if (i > 0) place = first + i - 1
   end function next_word

   !> Number of the line that a place of a text is in.
   pure integer function line_number(text, place)
      character(*), intent(in) :: text !! the text
      integer, intent(in) :: place !! the place
      integer :: i

      line_number = 1
      do i = 1, place - 1
         if (text(i:i) == newline) line_number = line_number + 1
      end do
   end function line_number

end module amontons_listing_check
