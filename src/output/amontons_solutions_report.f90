!> Uniqueness of a solution, and all solutions, in the files: lines of the listing, and NAME.solutions.csv.
module amontons_solutions_report
   use amontons_all_solutions, only: all_solutions_t
   use amontons_friction_law, only: status_names
   use amontons_kinds, only: dp
   use amontons_listing_text, only: heading, labeled, short_text
   use amontons_text, only: as_lines, comma_separated, newline, to_text
   use amontons_uniqueness, only: uniqueness_t
   implicit none (type, external)
   private

   public :: solutions_table_text, solutions_text, uniqueness_text

contains

   !> The lines on uniqueness.
   pure function uniqueness_text(uniqueness, friction) result(text)
      type(uniqueness_t), intent(in) :: uniqueness !! the bound
      real(dp), intent(in) :: friction(:) !! Coulomb coefficients of the problem (m) [-]
      character(:), allocatable :: text
      character(:), allocatable :: known

      text = ''
      if (size(friction) == 0) return
      if (uniqueness%is_unique .and. .not. uniqueness%has_bound) then
         known = 'unique, since there is no Coulomb friction'
      else if (.not. uniqueness%has_bound) then
         known = 'no bound is known'
      else if (uniqueness%is_for_any) then
         known = 'unique for any friction'
      else
         known = 'proven below '//short_text(uniqueness%friction)
         if (uniqueness%is_exact) known = known//', the exact bound'
         if (uniqueness%is_unique) known = 'unique (friction '//short_text(maxval(friction))//'; '//known//')'
      end if
      if (.not. uniqueness%is_unique) known = 'not proven (friction '//short_text(maxval(friction))//'; '//known//')'
      text = labeled('Uniqueness', known)
   end function uniqueness_text

   !> The section on all solutions.
   pure function solutions_text(solutions, force) result(text)
      type(all_solutions_t), intent(in) :: solutions !! all solutions
      real(dp), intent(in) :: force(:) !! forces of the solution that the listing reports (2m) [F]
      character(:), allocatable :: text
      integer :: i, m, p

      m = size(force)/2
      text = heading('All solutions')//labeled('Found', to_text(solutions%n))
      if (solutions%has_family) text = text//labeled('Note', 'some statuses admit a continuum of solutions, of '// &
         'which only the corners are found')
      do i = 1, solutions%n
         text = text//labeled('Solution '//to_text(i), kind_of(i))
         do p = 1, m
            text = text//labeled('', 'point '//to_text(p)//': '//trim(status_names(solutions%status(p, i)))// &
               ', forces '//short_text(solutions%force(p, i))//', '//short_text(solutions%force(m + p, i)))
         end do
      end do

   contains

      !> Whether a solution is alone, and whether it is the one reported.
      pure function kind_of(solution) result(words)
         integer, intent(in) :: solution !! number of the solution
         character(:), allocatable :: words
         ! Rounding, and the tolerance of the method that found the reported one.
         real(dp), parameter :: same = 1.0e-6_dp

         words = trim(merge('isolated            ', 'between two statuses', solutions%is_isolated(solution)))
         if (maxval(abs(solutions%force(:, solution) - force)) <= same*maxval(abs(force))) words = words// &
            '; the one reported'
      end function kind_of

   end function solutions_text

   !> NAME.solutions.csv: one row for each point of each solution.
   pure function solutions_table_text(solutions, gap) result(text)
      type(all_solutions_t), intent(in) :: solutions !! all solutions
      real(dp), intent(in) :: gap(:) !! initial distance to the obstacle along the normal (m) [L]
      character(:), allocatable :: text
      character(150) :: rows(size(gap), solutions%n)
      integer :: i, p, m

      m = size(gap)
      do i = 1, solutions%n
         associate (v => solutions%displacement(:, i), force => solutions%force(:, i))
            do p = 1, m
               rows(p, i) = to_text(i)//','//trim(merge('yes', 'no ', solutions%is_isolated(i)))//','//to_text(p) &
                  //','//comma_separated([gap(p) - v(p), v(m + p), force(p), force(m + p)]) &
                  //','//status_names(solutions%status(p, i))
            end do
         end associate
      end do
      text = 'solution,isolated,point,gap,slip,normal_force,tangential_force,status'//newline &
         //as_lines(reshape(rows, [size(rows)]))
   end function solutions_table_text

end module amontons_solutions_report
