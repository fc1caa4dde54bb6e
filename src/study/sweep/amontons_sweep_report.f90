!> The files of a sweep, all of them, each whole, or none: its listing, with what varies and what became of the cases
!> together, and its summary, in numbers that a script reads.
module amontons_sweep_report
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_document, only: document_t, json_logical, json_number, json_string
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_listing, only: certificate_text, factorization_text, head_text, listed_phases, method_text, &
      model_text, quantities_text, times_text, warnings_text
   use amontons_manifest, only: find_earlier_files, manifest_t, with_manifest
   use amontons_output_file, only: commit_files, hold_signals, output_file_t, release_signals, write_text_file
   use amontons_quantity, only: quantity_t, scales
   use amontons_report, only: add_head, certificate_member, last_members, member, quantities_member, size_counts
   use amontons_result, only: certificate_limit, outcome_names, outcome_solved, solution_word, word_no_equilibrium, &
      word_solved
   use amontons_solve_sweep, only: sweep_result_t
   use amontons_sweep, only: sweep_axis_t, sweep_t, swept_load
   use amontons_sweep_table, only: outcome_labels, ranked_quantities, sweep_statistics_t
   use amontons_system, only: file_name_t
   use amontons_terminal, only: phase_write
   use amontons_text, only: counted, flush_right, heading, labeled, newline, scientific, short_text, to_text, with_unit
   implicit none (type, external)
   private

   public :: n_documents, new_sweep_summary, sweep_documents, write_sweep_report

   !> Number of files that every sweep leaves, the table not counted.
   integer, parameter :: n_files = 3
   !> Number of those that are made of text and are not the summary.
   integer, parameter :: n_documents = 2

contains

   !> Writes NAME.lst, NAME.deck.nml and NAME.summary.json and gives NAME.sweep.csv and, where there are fields,
   !> NAME.sweep.pvd their names. Names change hands only after every file is complete; the checkpoint goes last.
   subroutine write_sweep_report(directory, config, body, result, error)
      character(*), intent(in) :: directory !! output directory
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(inout) :: result !! the result of all cases; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(n_files + merge(1, 0, allocated(result%collection)))
      type(file_name_t), allocatable :: earlier(:)
      type(output_file_t) :: table
      type(manifest_t) :: manifest
      character(:), allocatable :: stem

      if (allocated(result%collection)) files(n_files) = result%collection
      stem = directory//'/'//config%name
      call write_files(files, manifest, stem, config, body, result, error)
      if (.not. allocated(error)) call find_earlier_files(earlier, directory, config%name, manifest)
      call hold_signals()
      call result%checkpoint%table_file(table, 1, stem//'.sweep.csv')
      if (.not. allocated(error)) call table%commit(error)
      call commit_files(files, error, earlier)
      if (.not. allocated(error)) call result%checkpoint%remove()
      call result%checkpoint%close()
      call release_signals()
   end subroutine write_sweep_report

   !> Makes the text files of a sweep, but for the table and the summary.
   subroutine sweep_documents(documents, config, body, result)
      type(document_t), intent(out) :: documents(n_documents) !! the files
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result of all cases

      call new_sweep_listing(documents(1), config, body, result)
      documents(2)%ending = '.deck.nml'
      call documents(2)%add(config%deck_text())
   end subroutine sweep_documents

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, manifest, stem, config, body, result, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files, the summary last
      type(manifest_t), intent(out) :: manifest !! their manifest
      character(*), intent(in) :: stem !! directory and name of the case
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(document_t) :: documents(n_documents), summary
      integer :: i

      call sweep_documents(documents, config, body, result)
      do i = 1, size(documents)
         call write_text_file(files(i), stem//documents(i)%ending, documents(i)%text(), error)
         if (allocated(error)) return
      end do
      manifest = result%grids
      call manifest%add_outputs(files, '', error)
      if (allocated(error)) return
      associate (load_case => result%certified%load_case, table => result%checkpoint%checksum(1))
         call manifest%outputs%append_known(config%name//'.sweep.csv', table%n_bytes, table%value())
         call manifest%add_inputs(body%mesh, load_case%contacts, load_case%loads)
      end associate
      call result%certified%timings%begin(phase_write)
      call new_sweep_summary(summary, config, body, result)
      call write_text_file(files(size(files)), stem//summary%ending, with_manifest(summary%text(), manifest), error)
   end subroutine write_files

   !> Makes the listing.
   subroutine new_sweep_listing(listing, config, body, result)
      type(document_t), intent(out) :: listing !! the listing
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result

      listing%ending = '.lst'
      call listing%record(head_text(config))
      associate (certified => result%certified, statistics => result%statistics)
         call listing%add(warnings_text(certified%warnings))
         call listing%add(model_text(body, certified%load_case, config%units)//list_axes(config))
         call listing%record(list_solution(config, result))
         if (statistics%residual_case > 0) then
            call listing%add(list_extremes(ranked_quantities(body, config%sweep), statistics, config%units))
            call list_certificate(listing, result, config%units)
         end if
         call listing%record(times_text(certified%timings, listed_phases))
      end associate
   end subroutine new_sweep_listing

   !> Adds the certificate of the case with the largest error estimate, and how accurate its stresses are.
   subroutine list_certificate(listing, result, units)
      type(document_t), intent(inout) :: listing !! the listing
      type(sweep_result_t), intent(in) :: result !! the result
      character(*), intent(in) :: units !! names of the units
      character(:), allocatable :: text

      text = certificate_text(result%certified%certificate, result%certified%method%tolerance)// &
         labeled('Worst case', to_text(result%statistics%worst_case)//', by the estimated error of its forces')
      if (allocated(result%certified%error_estimate)) text = text//heading('Accuracy of the worst case '// &
         '(energy norm of the stress error)')//quantities_text(result%certified%error_estimate%quantities(), units)
      if (result%has_certificate) then
         call listing%add(text, [1.0_dp])
      else
         call listing%record(text)
      end if
   end subroutine list_certificate

   !> What varies, and in which combination.
   pure function list_axes(config) result(text)
      type(config_t), intent(in) :: config !! the deck
      character(:), allocatable :: text
      integer :: i

      text = heading('Sweep')
      do i = 1, size(config%sweep%axes)
         associate (axis => config%sweep%axes(i))
            text = text//labeled(trim(merge('along with', 'vary      ', axis%is_paired)), axis_text(axis))
         end associate
      end do
      text = text//labeled('Cases', to_text(config%sweep%n_cases())//', row by row in '//config%name//'.sweep.csv')
      if (config%sweep%n_fields() > 0) text = text//labeled('Fields', 'of '//to_text(config%sweep%n_fields())// &
         ' cases, those that converged, in '//config%name//'.sweep.pvd')
   end function list_axes

   !> A quantity and its values; of many values the first and the last ones.
   pure function axis_text(axis) result(text)
      type(sweep_axis_t), intent(in) :: axis !! the quantity
      character(:), allocatable :: text
      integer, parameter :: n_shown = 8
      integer :: i

      if (axis%target == swept_load) then
         text = "factor of load '"//axis%name//"': "
      else
         text = axis%label()//': '
      end if
      text = text//counted(size(axis%values), 'value')//', '
      do i = 1, size(axis%values)
         if (i == n_shown .and. size(axis%values) > n_shown) text = text//'... '
         if (i >= n_shown .and. i < size(axis%values)) cycle
         text = text//short_text(axis%values(i))
         if (i < size(axis%values)) text = text//', '
      end do
   end function axis_text

   !> How the cases were solved.
   function list_solution(config, result) result(text)
      type(config_t), intent(in) :: config !! the deck
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      associate (statistics => result%statistics)
         text = heading('Solution')//labeled('Method', method_text(config%method))// &
            labeled('Factorization', factorization_text(result%certified))// &
            labeled('Converged', to_text(statistics%n_outcomes(outcome_solved))//' of '//to_text(statistics%n_cases)// &
            ' cases')
         do i = 1, size(outcome_labels)
            if (i /= outcome_solved .and. statistics%n_outcomes(i) > 0) text = text// &
               labeled(trim(outcome_labels(i)), counted(statistics%n_outcomes(i), 'case'))
         end do
         text = text//labeled('Iterations', to_text(statistics%n_iterations)//', '// &
            scientific(real(statistics%n_iterations, dp)/max(1, statistics%n_cases))//' per case')
         if (statistics%residual_case > 0) text = text//labeled('Largest residual', scientific(statistics%residual)// &
            ' in case '//to_text(statistics%residual_case)//', tolerance '//scientific(config%method%tolerance))
         if (result%n_resumed > 0) text = text//labeled('Done earlier', counted(result%n_resumed, 'case'))
         if (result%checkpoint%is_anew) text = text// &
            labeled('Note', 'the rows of an interrupted run are damaged or '// &
            'of another deck or version: all cases were solved again')
         text = text//labeled('Cases per second', short_text(result%cases_per_second()))
         if (result%n_sharing > 1) text = text//labeled('Solved by', counted(result%n_sharing, 'rank'))
      end associate
   end function list_solution

   !> Extremes of the cases that converged.
   pure function list_extremes(list, statistics, units) result(text)
      type(quantity_t), intent(in) :: list(:) !! what cases are ranked by
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: width = 14
      integer :: name_width, i

      name_width = maxval(len_trim(list%key))
      text = heading('Extremes of the cases that converged')//repeat(' ', name_width + 2)// &
         flush_right('least', width)// &
         flush_right('in case', width)//flush_right('greatest', width)//flush_right('in case', width)//newline
      do i = 1, size(list)
         text = text//'  '//list(i)%key(:name_width)//with_unit(flush_right(short_text(statistics%least(i)), width)// &
            flush_right(to_text(statistics%least_case(i)), width)// &
            flush_right(short_text(statistics%greatest(i)), width)// &
            flush_right(to_text(statistics%greatest_case(i)), width), units, trim(list(i)%dimension))//newline
      end do
   end function list_extremes

   !> Makes the summary.
   subroutine new_sweep_summary(summary, config, body, result)
      type(document_t), intent(out) :: summary !! the summary
      type(config_t), intent(in) :: config !! the deck
      type(body_t), intent(in) :: body !! the body
      type(sweep_result_t), intent(in) :: result !! the result

      associate (statistics => result%statistics, certified => result%certified)
         call add_head(summary, config, config%method%method, outcome_word(result), certified%warnings)
         if (statistics%outcome() == word_no_equilibrium) call summary%add(member('message', json_string( &
            'no case has an equilibrium: contact and friction cannot balance the loads of any')))
         call summary%add(member('iterations', to_text(statistics%n_iterations)))
         call summary%add(member('sweep', '{'//count_members(result)//'}'))
         call summary%add(member('quantities', '['//axis_members(config%sweep)//']'))
         if (statistics%residual_case > 0) then
            call summary%add(member('residual', json_number(statistics%residual)))
            call summary%add(member('extremes', '{'//extreme_members(body, config%sweep, statistics)//'}'))
            call add_certificate_members(summary, result)
         end if
         if (certified%condition > 0.0_dp) call summary%record(member('condition', json_number(certified%condition)))
         call summary%add(member('counts', '{'//size_counts(body)//'}'))
         call summary%record(last_members(certified%timings))
      end associate
   end subroutine new_sweep_summary

   !> What became of the sweep in a word.
   pure function outcome_word(result) result(word)
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: word

      word = result%statistics%outcome()
      if (word == word_solved) word = solution_word(.true., result%certified%certificate%largest() &
         <= certificate_limit(result%certified%method%tolerance))
   end function outcome_word

   !> Adds the certificate of the case with the largest error estimate, and how accurate its stresses are.
   subroutine add_certificate_members(summary, result)
      type(document_t), intent(inout) :: summary !! the summary
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      associate (certificate => result%certified%certificate)
         text = certificate_member(certificate%violations(), certificate_limit(result%certified%method%tolerance), &
            certificate%energies(), '"case": '//to_text(result%statistics%worst_case)//', ')
         if (result%has_certificate) then
            call summary%add(text, [1.0_dp, 1.0_dp, scales([certificate%violations(), certificate%energies()])])
         else
            call summary%record(text)
         end if
         if (.not. allocated(result%certified%error_estimate)) return
         associate (accuracy => result%certified%error_estimate%quantities())
            if (result%has_certificate) then
               call summary%add(quantities_member('accuracy', accuracy))
            else
               call summary%record(quantities_member('accuracy', accuracy))
            end if
         end associate
      end associate
   end subroutine add_certificate_members

   !> Counts of the cases, and how fast they were solved.
   pure function count_members(result) result(text)
      type(sweep_result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      integer :: i

      text = '"cases": '//to_text(result%statistics%n_cases)
      do i = 1, size(outcome_names)
         text = text//', "'//trim(outcome_names(i))//'": '//to_text(result%statistics%n_outcomes(i))
      end do
      text = text//', "done_earlier": '//to_text(result%n_resumed)//', "cases_per_second": '// &
         json_number(result%cases_per_second())
   end function count_members

   !> What varies: name, number of values, the least and the greatest of them.
   pure function axis_members(sweep) result(text)
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(sweep%axes)
         if (i > 1) text = text//', '
         associate (axis => sweep%axes(i))
            text = text//'{"name": '//json_string(axis%label())// &
               ', "values": '//to_text(size(axis%values))// &
               ', "least": '//json_number(minval(axis%values))// &
               ', "greatest": '//json_number(maxval(axis%values))// &
               ', "paired": '//json_logical(axis%is_paired)//'}'
         end associate
      end do
   end function axis_members

   !> Extremes of the cases that converged.
   pure function extreme_members(body, sweep, statistics) result(text)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(sweep_statistics_t), intent(in) :: statistics !! counts and extremes
      character(:), allocatable :: text
      type(quantity_t), allocatable :: list(:)
      integer :: i

      text = ''
      list = ranked_quantities(body, sweep)
      do i = 1, size(list)
         if (i > 1) text = text//', '
         text = text//'"'//trim(list(i)%key)//'": {"least": '//json_number(statistics%least(i))//', "least_case": '// &
            to_text(statistics%least_case(i))//', "greatest": '//json_number(statistics%greatest(i))// &
            ', "greatest_case": '//to_text(statistics%greatest_case(i))//'}'
      end do
   end function extreme_members

end module amontons_sweep_report
