!> The study of a reduced problem that another program, or an earlier run, has written, and its files, in the form of
!> those of a deck with a body; they are written as a whole or not at all.
module amontons_reduced_study
   use amontons_config, only: config_t
   use amontons_contact_table, only: add_point_table, column_t, points_text
   use amontons_document, only: document_t, json_number, json_string
   use amontons_error, only: error_t
   use amontons_friction_law, only: slip_point
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp
   use amontons_listing, only: head_text, method_text, outcome_text, residual_text, solutions_table_text, &
      solutions_text, status_counts, times_text, uniqueness_text, violations_text, warnings_text
   use amontons_manifest, only: manifest_t
   use amontons_output_file, only: output_file_t
   use amontons_quantity, only: quantity_t, scales
   use amontons_report, only: add_head, certificate_member, commit_case, effort_members, last_members, member, &
      quantities_member, status_members, uniqueness_member, write_documents
   use amontons_result, only: certificate_limit, solution_word
   use amontons_siconos_text, only: write_reduced_file
   use amontons_solve_case, only: cache_t
   use amontons_solve_reduced, only: find_reduced_solutions, prepare_reduced, reduced_result_t, solve_reduced
   use amontons_study, only: method_numbers, outcome_t, solution_line, study_monitor_t, study_options_t, study_t
   use amontons_system, only: make_directory
   use amontons_terminal, only: phase_read, phase_recover, phase_solve, phase_write
   use amontons_text, only: heading, labeled, scientific, short_text, to_text
   implicit none (type, external)
   private

   public :: new_reduced_summary, reduced_documents, reduced_study_t

   !> The study of a reduced problem.
   type, extends(study_t) :: reduced_study_t
   contains
      procedure :: check => reduced_study_check
      procedure :: solve => reduced_study_solve
   end type reduced_study_t

contains

   !> Reads the problem and reports its size.
   subroutine reduced_study_check(self, cache, outcome, error)
      class(reduced_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! not used: there is no body
      type(outcome_t), intent(inout) :: outcome !! gains the size, and the warnings on the problem
      type(error_t), allocatable, intent(out) :: error !! the file is invalid
      type(reduced_result_t) :: result

      call prepare_reduced(self%config, result, error)
      if (allocated(error)) return
      outcome%warnings = result%warnings
      outcome%text = self%config%name//': deck OK; '//result%system%form//', '//to_text(result%system%n_contacts)// &
         ' contacts, '//to_text(size(result%system%entry))//' entries of W'
      associate (unused => cache)
      end associate
   end subroutine reduced_study_check

   !> Solves the problem and writes its files.
   subroutine reduced_study_solve(self, cache, options, monitor, outcome, error)
      class(reduced_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! not used: there is no body
      type(study_options_t), intent(in) :: options !! options of the command line
      class(study_monitor_t), intent(inout) :: monitor !! not used: there is one case only
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solution lacks, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the file is invalid, or no files can be written
      type(reduced_result_t) :: result

      call solve_reduced(self%config, result, error)
      if (options%writes_reduced .and. .not. allocated(error)) call write_reduced_file(options%directory, &
         self%config%name, result%system, error)
      result%has_reduced_files = options%writes_reduced
      if (options%wants_all_solutions .and. .not. allocated(error)) then
         allocate (result%all_solutions)
         call result%timings%begin(phase_solve)
         call find_reduced_solutions(result%all_solutions, result%system, error)
         call result%timings%begin(phase_write)
      end if
      if (.not. allocated(error)) call write_reduced_report(options%directory, self%config, result, error)
      if (allocated(error)) return
      outcome%text = solution_line(self%config%name, result%solution)//'; '// &
         to_text(result%system%n_contacts)//' contacts'
      outcome%warnings = result%warnings
      outcome%numbers = method_numbers(result%solution)
      call outcome%judge(result%solution%is_converged, result%solution%residual, result%check%largest(), &
         self%config%method%tolerance)
      associate (unused => cache, unused_too => monitor)
      end associate
   end subroutine reduced_study_solve

   !> Writes NAME.lst, NAME.contact.csv, NAME.deck.nml and NAME.summary.json, and NAME.solutions.csv if all solutions
   !> are known. The files get their final names when all are complete.
   subroutine write_reduced_report(directory, config, result, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary
      type(output_file_t), allocatable :: files(:)
      type(manifest_t) :: manifest
      character(:), allocatable :: stem

      call make_directory(directory, error)
      if (allocated(error)) return
      call reduced_documents(documents, config, result)
      allocate (files(size(documents) + 1))
      stem = directory//'/'//config%name
      call write_documents(files, stem, documents, error)
      call manifest%add_case(files, stem, result%has_reduced_files, error)
      if (.not. allocated(error)) then
         call manifest%add_input(config%reduced%path)
         call result%timings%begin(phase_write)
         call new_reduced_summary(summary, config, result)
      end if
      call commit_case(files, manifest, directory, config%name, summary, error)
   end subroutine write_reduced_report

   !> Makes the text files of a reduced problem, except for the summary.
   subroutine reduced_documents(documents, config, result)
      type(document_t), allocatable, intent(out) :: documents(:) !! the files
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      character(0) :: no_names(0)
      character(:), allocatable :: text
      real(dp) :: length, force
      integer :: k

      allocate (documents(3 + merge(1, 0, allocated(result%all_solutions))))
      ! Gap, slip and forces of the contacts, a column each.
      associate (u => result%system%u, r => result%system%r)
         length = maxval(abs([u, result%system%q]))
         force = maxval(abs(r))
         if (result%system%dimension == 2) then
            allocate (columns(4))
            columns%key = [character(16) :: 'gap', 'slip', 'normal_force', 'tangential_force']
            columns%label = [character(12) :: 'gap', 'slip', 'normal force', 'tang. force']
         else
            allocate (columns(8))
            columns%key = [character(18) :: 'gap', 'slip_1', 'slip_2', 'normal_force', 'tangential_force_1', &
               'tangential_force_2', 'direction_1', 'direction_2']
            columns%label = [character(12) :: 'gap', 'slip 1', 'slip 2', 'normal force', 'tang. force1', &
               'tang. force2', 'direction 1', 'direction 2']
            ! The unit vector of the slip of a contact that slides.
            do k = 1, 2
               columns(6 + k)%values = merge(u(k + 1::3)/max(hypot(u(2::3), u(3::3)), tiny(length)), 0.0_dp, &
                  result%solution%status == slip_point)
            end do
            columns(7:)%dimension = '-'
            columns(7:)%scale = 1.0_dp
         end if
         do k = 1, result%system%dimension
            associate (motion => columns(k), load => columns(result%system%dimension + k))
               motion%dimension = 'L'
               motion%scale = length
               motion%values = u(k::result%system%dimension)
               load%dimension = 'F'
               load%scale = force
               load%values = r(k::result%system%dimension)
            end associate
         end do
      end associate
      documents(1)%ending = '.lst'
      call documents(1)%record(head_text(config))
      call documents(1)%add(warnings_text(result%warnings))
      ! The section of the listing on the problem in the file.
      text = heading('Reduced problem u = W r + q')//labeled('File', config%reduced%path)//labeled('Form', &
         result%system%form)//labeled('Contacts', to_text(result%system%n_contacts)// &
         trim(merge('         ', ' in space', result%system%dimension == 2)))
      if (result%system%n_contacts /= 0) then
         text = text//labeled('Matrix W', to_text(size(result%system%entry))//' entries, '// &
            trim(merge('used as dense ', 'used as sparse', result%system%is_dense())))// &
            labeled('Diagonal of W', 'up to '//short_text(result%system%largest))// &
            labeled('Largest q', short_text(maxval(abs(result%system%q))))
         if (maxval(result%system%friction) > minval(result%system%friction)) then
            text = text//labeled('Friction', short_text(minval(result%system%friction))//' to '// &
               short_text(maxval(result%system%friction)))
         else
            text = text//labeled('Friction', short_text(result%system%friction(1)))
         end if
         if (config%reduced%has_friction) text = text//labeled('', "the deck's, in the place of the file's")
         if (result%system%asymmetry > 0.0_dp) text = text//labeled('Note', 'W differs from its transpose by up to '// &
            scientific(result%system%asymmetry)//'; the forces below solve the problem with W as given in the file')
      end if
      call documents(1)%add(text)
      ! How the problem was solved.
      associate (solution => result%solution)
         text = heading('Solution')//labeled('Method', method_text(config%method))//outcome_text(solution)// &
            residual_text(solution, config%method%tolerance)// &
            uniqueness_text(result%uniqueness, result%system%friction)// &
            labeled('Contacts', status_counts(solution%status, result%system%dimension))
         ! Each contact in space has tangents of its own.
         if (result%system%dimension == 2) then
            text = text//labeled('Sum of forces', 'normal '//short_text(sum(result%system%r(1::2)))//', tangential '// &
               short_text(sum(result%system%r(2::2))))
         else
            text = text//labeled('Sum of forces', 'normal '//short_text(sum(result%system%r(1::3))))
         end if
         if (allocated(result%all_solutions)) text = text//solutions_text(result%all_solutions, &
            [result%system%r(1::2), result%system%r(2::2)])
      end associate
      call documents(1)%record(text)
      call documents(1)%add(heading('Checks on the problem as read (relative errors)')// &
         violations_text(result%check%violations(), certificate_limit(config%method%tolerance)), [1.0_dp])
      call documents(1)%add(points_text('Contacts (u and r as in the file: a tangential force opposes its slip)', &
         columns, result%solution%status, config%units), [0.0_dp, columns%scale, 0.0_dp])
      call documents(1)%record(times_text(result%timings, [phase_read, phase_solve, phase_recover]))
      call add_point_table(documents(2), columns, result%solution%status, no_names)
      documents(3)%ending = '.deck.nml'
      call documents(3)%add(config%deck_text())
      if (.not. allocated(result%all_solutions)) return
      documents(4)%ending = '.solutions.csv'
      call documents(4)%record(solutions_table_text(result%all_solutions, spread(0.0_dp, 1, result%system%n_contacts)))
   end subroutine reduced_documents

   !> Makes the summary.
   subroutine new_reduced_summary(summary, config, result)
      type(document_t), intent(out) :: summary !! the summary
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      type(quantity_t) :: no_quantities(0)
      type(quantity_t), allocatable :: sums(:)

      associate (solution => result%solution, system => result%system)
         sums = resultants([system%r(1::system%dimension), system%r(2::system%dimension)], system%n_contacts)
         if (system%dimension == 3) sums = sums(:1)
         call add_head(summary, config, config%method%method, solution_word(solution%is_converged, &
            result%check%largest() <= certificate_limit(config%method%tolerance)), result%warnings)
         call summary%record(effort_members(solution))
         call summary%add(member('problem', '{"file": '//json_string(config%reduced%path)//', "form": '// &
            json_string(system%form)//', "dimension": '//to_text(system%dimension)//', "entries": '// &
            to_text(size(system%entry))//', "largest_compliance": '// &
            json_number(system%largest)//', "asymmetry": '//json_number(system%asymmetry)//'}'), [system%largest])
         call summary%add(certificate_member(result%check%violations(), certificate_limit(config%method%tolerance), &
            no_quantities), [1.0_dp])
         call summary%record(uniqueness_member(result%uniqueness))
         call summary%add(member('counts', '{"contact_points": '//to_text(system%n_contacts)//', '// &
            status_members(solution%status)//'}'))
         call summary%add(quantities_member('resultants', sums), scales(sums))
         call summary%record(last_members(result%timings))
      end associate
   end subroutine new_reduced_summary

end module amontons_reduced_study
