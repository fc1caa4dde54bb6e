!> Accuracy in the files of a case on refined meshes: how its numbers change from mesh to mesh.
module amontons_accuracy_text
   use amontons_convergence, only: refined_quantity_t, verdict_names
   use amontons_json, only: json_numbers, json_string, quantity_members
   use amontons_kinds, only: dp
   use amontons_listing_text, only: flush_right, heading, scientific, short_text, unit_of
   use amontons_quantity, only: quantity_t
   use amontons_summary_members, only: member
   use amontons_text, only: as_lines, comma_separated, newline, to_text
   implicit none (type, external)
   private

   public :: convergence_member, convergence_table_text, convergence_text

contains

   !> The section of the listing.
   pure function convergence_text(list, units) result(text)
      type(refined_quantity_t), intent(in) :: list(:) !! the numbers
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: width = 13
      character(200 + len(units)) :: rows(0:size(list))
      integer :: i

      rows(0) = repeat(' ', 22)//flush_right('finest mesh', width)//flush_right('+-', width)// &
         flush_right('extrapolated', width)// &
         flush_right('order', 8)//'  from mesh to mesh'
      if (len_trim(units) > 0) rows(0) = trim(rows(0))//'  unit'
      do i = 1, size(list)
         associate (quantity => list(i)%quantity, judged => list(i)%convergence)
            rows(i) = quantity%label
            rows(i)(23:) = flush_right(short_text(quantity%value), width)// &
               flush_right(scientific(judged%bar), width)// &
               flush_right(short_text(judged%extrapolated), width)//flush_right(order_text(judged%order), 8)//'  '// &
               verdict_names(judged%verdict)//repeat(' ', 8)//unit_of(units, trim(quantity%dimension))
         end associate
      end do
      text = heading('Refined meshes ('//to_text(size(list(1)%convergence%value))// &
         ', each of half the element size)')// &
         as_lines(rows)
   end function convergence_text

   !> An order of convergence with two decimals; a dash where there is none.
   pure function order_text(order) result(text)
      real(dp), intent(in) :: order !! the order, 0 for none [-]
      character(:), allocatable :: text
      character(6) :: digits

      text = '-'
      if (.not. order > 0.0_dp) return
      write (digits, '(f6.2)') min(order, 99.0_dp)
      text = trim(adjustl(digits))
   end function order_text

   !> The member of the summary.
   pure function convergence_member(list) result(text)
      type(refined_quantity_t), intent(in) :: list(:) !! the numbers
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(list)
         associate (judged => list(i)%convergence)
            if (i > 1) text = text//', '
            text = text//json_string(trim(list(i)%quantity%key))//': {"values": ['//json_numbers(judged%value)// &
               '], "verdict": '//json_string(trim(verdict_names(judged%verdict)))//', '//quantity_members([ &
               quantity_t('order', '', judged%order), quantity_t('extrapolated', '', judged%extrapolated), &
               quantity_t('error_bar', '', judged%bar)])//'}'
         end associate
      end do
      text = member('convergence', '{'//text//'}')
   end function convergence_member

   !> NAME.convergence.csv: a row for each number, a column for each mesh.
   pure function convergence_table_text(list) result(text)
      type(refined_quantity_t), intent(in) :: list(:) !! the numbers
      character(:), allocatable :: text
      integer :: i

      text = 'quantity'
      do i = 1, size(list(1)%convergence%value)
         text = text//',mesh_'//to_text(i)
      end do
      text = text//',verdict,order,extrapolated,error_bar'//newline
      do i = 1, size(list)
         associate (judged => list(i)%convergence)
            text = text//trim(list(i)%quantity%key)//','//comma_separated(judged%value)//','// &
               trim(verdict_names(judged%verdict))//','//comma_separated([judged%order, judged%extrapolated, &
               judged%bar])//newline
         end associate
      end do
   end function convergence_table_text

end module amontons_accuracy_text
