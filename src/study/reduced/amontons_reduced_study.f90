!> The study of a reduced problem that another program, or an earlier run, has written, from its file to its result and
!> the files of that, in the form of those of a deck with a body, written as a whole or not at all. The result is
!> checked: every condition of the contact law, contact by contact, with W as it was read.
module amontons_reduced_study
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_cone, only: cone_t, new_cone
   use amontons_config, only: config_t
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_method_t, contact_solution_t, effort_t, new_contact_solution
   use amontons_contact_table, only: add_point_table, column_t, points_text
   use amontons_document, only: document_t, json_number, json_string
   use amontons_error, only: error_t, new_error, numerical_failure, warning_list_t
   use amontons_friction_law, only: point_violations, point_violations_t, slip_point
   use amontons_key_results, only: resultants
   use amontons_kinds, only: dp
   use amontons_listing, only: add_outcome, head_text, method_text, solutions_table_text, &
      solutions_text, status_counts, times_text, uniqueness_text, violations_text, warnings_text
   use amontons_manifest, only: manifest_t
   use amontons_methods, only: method_options_t, new_contact_method, solve_components
   use amontons_output_file, only: output_file_t
   use amontons_quantity, only: quantity_t, relative, scales
   use amontons_reduced_system, only: reduced_system_t
   use amontons_report, only: add_head, certificate_member, commit_case, effort_members, last_members, member, &
      quantities_member, status_members, uniqueness_member, write_documents
   use amontons_result, only: certificate_limit, solution_word
   use amontons_rounding, only: result_rounding
   use amontons_siconos_text, only: read_reduced_file, write_reduced_file
   use amontons_solve_case, only: cache_t
   use amontons_study, only: method_numbers, outcome_t, solution_line, study_monitor_t, study_options_t, study_t
   use amontons_system, only: make_directory
   use amontons_terminal, only: new_timings, phase_read, phase_recover, phase_solve, phase_write, timings_t
   use amontons_text, only: heading, labeled, scientific, short_text, to_text
   use amontons_uniqueness, only: all_solutions_t, find_all_solutions, most_points, new_uniqueness, uniqueness_t
   implicit none (type, external)
   private

   public :: find_reduced_solutions, new_reduced_check, new_reduced_summary, prepare_reduced, reduced_documents, &
      reduced_result_t, reduced_study_t, solve_reduced, solve_reduced_system

   !> The result of a reduced problem, with everything that the reports contain.
   type :: reduced_result_t
      type(reduced_system_t) :: system !! the reduced problem, and its solution
      type(contact_solution_t) :: solution !! statuses and record of the method, in the method's own units
      type(point_violations_t) :: check !! violations of the contact law
      type(uniqueness_t) :: uniqueness !! the friction below which the solution is the only one
      type(all_solutions_t), allocatable :: all_solutions
         !! all solutions, where they were asked for; their forces are r, all normal ones first
      type(warning_list_t) :: warnings !! warnings on the problem
      logical :: has_reduced_files = .false. !! whether the problem was written again
      type(timings_t) :: timings !! times of the phases
   end type reduced_result_t

   !> The study of a reduced problem.
   type, extends(study_t) :: reduced_study_t
   contains
      procedure :: check => reduced_study_check
      procedure :: solve => reduced_study_solve
   end type reduced_study_t

contains

   !> Reads a reduced problem from its file, with the friction of the deck if it has one.
   subroutine prepare_reduced(config, result, error)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(out) :: result !! gains the problem
      type(error_t), allocatable, intent(out) :: error !! the file is invalid

      call new_timings(result%timings)
      call read_reduced_file(result%system, config%reduced%file, error)
      if (allocated(error)) error%message = config%reduced%origin//error%message
      if (allocated(error)) return
      if (config%reduced%has_friction) result%system%friction = config%reduced%friction
      associate (system => result%system)
         if (system%asymmetry > result_rounding*system%largest) call result%warnings%add( &
            'W is not symmetric: it differs from its transpose by up to '//short_text(system%asymmetry)// &
            ', beside a diagonal of up to '//short_text(system%largest))
      end associate
   end subroutine prepare_reduced

   !> Reads and solves the problem of a case.
   subroutine solve_reduced(config, result, error)
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file is invalid, or the computation failed numerically

      call prepare_reduced(config, result, error)
      if (allocated(error)) return
      call solve_prepared(config%method, result, error)
   end subroutine solve_reduced

   !> Solves a reduced problem given in arrays.
   subroutine solve_reduced_system(system, options, result, error)
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(method_options_t), intent(in) :: options !! the contact method
      type(reduced_result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the computation failed numerically

      call new_timings(result%timings)
      result%system = system
      call solve_prepared(options, result, error)
   end subroutine solve_reduced_system

   !> Solves the problem that a result holds.
   subroutine solve_prepared(options, result, error)
      type(method_options_t), intent(in) :: options !! the contact method
      type(reduced_result_t), intent(inout) :: result !! the problem; gains its solution
      type(error_t), allocatable, intent(out) :: error !! the computation failed numerically
      class(contact_method_t), allocatable :: method
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: problem
      logical :: is_finite

      call result%timings%begin(phase_solve)
      call new_contact_method(method, options, error)
      if (allocated(error)) return
      call new_contact_solution(result%solution, result%system%n_contacts, result%system%dimension - 1)
      if (result%system%n_contacts == 0) then
         result%solution%residual = 0.0_dp
         result%solution%is_converged = .true.
         result%uniqueness%is_unique = .true.
      else
         call result%system%contact_problem(matrix, problem, error)
         if (allocated(error)) return
         call iterate(method, result%system, problem, result%solution, error)
         if (.not. (allocated(error) .or. result%solution%is_converged)) call check_motions(result%system, error)
         if (allocated(error)) return
         call new_uniqueness(result%uniqueness, problem)
      end if
      call result%timings%begin(phase_recover)
      associate (system => result%system)
         call system%set_solution(result%solution%force, system%length_unit()/system%compliance_unit())
         is_finite = all(ieee_is_finite([system%r, system%u]))
         if (.not. is_finite .or. (any(abs(result%solution%force) > 0.0_dp) .and. .not. any(abs(system%r) &
            >= tiny(1.0_dp)))) call new_error(error, numerical_failure, 'the forces that solve it are too '// &
            merge('small', 'large', is_finite)//' for numbers of double precision: count forces or lengths in '// &
            'another unit')
         if (allocated(error)) return
         call new_reduced_check(result%check, system)
      end associate
      ! The caller writes the result next.
      call result%timings%begin(phase_write)
   end subroutine solve_prepared

   !> Finds all solutions of a problem with few contacts.
   subroutine find_reduced_solutions(solutions, system, error)
      type(all_solutions_t), intent(out) :: solutions !! the solutions; their forces are r, all normal ones first
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(error_t), allocatable, intent(out) :: error !! it has too many contacts
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: problem
      real(dp), allocatable :: skew_part(:, :)
      real(dp) :: force(size(system%q))
      integer :: j, m

      m = system%n_contacts
      call system%contact_problem(matrix, problem, error)
      if (allocated(error)) return
      ! A problem of many contacts is refused before anything asks for its skew part.
      allocate (skew_part(2*m, merge(2*m, 0, system%asymmetry > 0.0_dp .and. m <= most_points)))
      do j = 1, size(skew_part, 2)
         force = 0.0_dp
         force(j) = 1.0_dp
         skew_part(:, j) = -system%skew_displacement(force)
      end do
      call find_all_solutions(solutions, problem, error, skew_part)
      if (allocated(error)) return
      associate (length => system%length_unit(), force_unit => system%length_unit()/system%compliance_unit())
         solutions%displacement = length*solutions%displacement
         solutions%force(:m, :) = force_unit*solutions%force(:m, :)
         solutions%force(m + 1:, :) = 0.0_dp - force_unit*solutions%force(m + 1:, :)
      end associate
   end subroutine find_reduced_solutions

   !> Solves the symmetric problem repeatedly until its forces solve the problem as it was read: the displacements by
   !> the skew part of W at the forces found are added to the free displacements. If W is symmetric, one solution
   !> suffices.
   subroutine iterate(method, system, problem, solution, error)
      class(contact_method_t), intent(inout) :: method !! the method
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(contact_solution_t), intent(inout) :: solution !! the solution
      type(error_t), allocatable, intent(out) :: error !! the computation failed numerically
      type(effort_t) :: effort
      real(dp), allocatable :: history(:)
      real(dp) :: residual, tolerance
      integer :: n_left
      logical :: is_symmetric_solved

      tolerance = method%tolerance
      ! The last change of the right-hand side must not spoil the solution.
      if (system%asymmetry > 0.0_dp) method%tolerance = 0.5_dp*tolerance
      n_left = method%max_iterations
      allocate (history(0))
      do
         method%max_iterations = n_left
         residual = solution%residual
         call solve_components(method, problem, solution, error)
         if (allocated(error)) return
         if (.not. (solution%residual < huge(solution%residual) .and. all(ieee_is_finite(solution%force)))) then
            call new_error(error, numerical_failure, 'floating-point overflow in the contact method: '// &
               'check the units of W, q and mu')
            return
         end if
         n_left = n_left - solution%n_iterations
         history = [history, solution%history(:solution%n_iterations)]
         call effort%add(solution%effort)
         is_symmetric_solved = solution%is_converged
         ! Judges forces by the problem as it was read: displacements, residual and statuses that belong to them.
         call system%set_free_displacement(problem, solution%force)
         solution%displacement = problem%displacement(problem%dual_load(solution%displacement), solution%force)
         call solution%measure(problem)
         solution%is_converged = solution%residual <= tolerance
         if (solution%is_converged .or. .not. is_symmetric_solved .or. n_left < 1) exit
         if (.not. solution%residual < 0.5_dp*residual) exit
      end do
      solution%history = history
      solution%effort = effort
      solution%n_iterations = size(history)
   end subroutine iterate

   !> Refuses a problem in which no motion keeps the contacts apart: forces that W does not feel, y >= 0 with y W = 0,
   !> ask of q that y q >= 0 (Farkas' lemma). Where y q = -1, forces that solve the problem are at least 1/|y W|.
   pure subroutine check_motions(system, error)
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      type(error_t), allocatable, intent(out) :: error !! there is no solution
      ! Forces would be longer than 1e10, in units that make the diagonal of W and the largest q 1. More contacts take
      ! minutes.
      real(dp), parameter :: impossible = 1.0e-10_dp
      integer, parameter :: most_contacts = 200
      type(cone_t) :: cone
      real(dp), allocatable :: columns(:, :), root(:)
      integer :: j, k

      if (system%n_contacts > most_contacts) return
      allocate (columns(size(system%q) + 1, system%n_contacts), source=0.0_dp)
      root = sqrt(max(system%diagonal(), 0.0_dp))
      where (.not. root > 0.0_dp) root = 1.0_dp
      associate (n => size(system%q), dimension => system%dimension, row => system%row)
         do j = 1, n
            do k = system%first(j), system%first(j + 1) - 1
               if (modulo(row(k), dimension) == 1) columns(j, 1 + row(k)/dimension) = &
                  system%entry(k)/(root(row(k))*root(j))
            end do
         end do
         columns(n + 1, :) = system%q(1::dimension)/root(1::dimension)
         columns(n + 1, :) = columns(n + 1, :)/max(maxval(abs(columns(n + 1, :))), tiny(1.0_dp))
         call new_cone(cone, transpose(columns), spread(0.0_dp, 1, size(columns, 2)))
         if (norm2(cone%remainder([(0.0_dp, k=1, n), -1.0_dp])) <= impossible) call new_error(error, &
            numerical_failure, &
            'no solution: no motion keeps the contacts apart that q moves together, whatever the forces')
      end associate
   end subroutine check_motions

   !> Checks the solution of a reduced problem: displacements over the largest of u and q, forces over the largest r.
   pure subroutine new_reduced_check(check, system)
      type(point_violations_t), intent(out) :: check !! the violations
      type(reduced_system_t), intent(in) :: system !! the reduced problem and its solution
      real(dp), dimension(size(system%q)) :: motion, force

      if (system%n_contacts == 0) return
      motion = relative(system%by_component(system%u), max(system%largest_part(system%u), &
         system%largest_part(system%q)))
      ! r_T opposes the slip.
      force = relative(-system%by_component(system%r), system%largest_part(system%r))
      associate (m => system%n_contacts)
         check = point_violations(-motion(:m), motion(m + 1:), force(:m), force(m + 1:), &
            system%friction*max(0.0_dp, force(:m)))
      end associate
   end subroutine new_reduced_check

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
         self%config%method%tolerance, condition=0.0_dp)
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
         call documents(1)%add(heading('Solution')//labeled('Method', method_text(config%method)))
         call add_outcome(documents(1), solution, config%method%tolerance, '')
         call documents(1)%record(uniqueness_text(result%uniqueness, result%system%friction, ''))
         text = labeled('Contacts', status_counts(solution%status, result%system%dimension))
         ! Each contact in space has tangents of its own.
         if (result%system%dimension == 2) then
            text = text//labeled('Sum of forces', 'normal '//short_text(sum(result%system%r(1::2)))//', tangential '// &
               short_text(sum(result%system%r(2::2))))
         else
            text = text//labeled('Sum of forces', 'normal '//short_text(sum(result%system%r(1::3))))
         end if
         call documents(1)%add(text, [result%system%largest_part(result%system%r)])
         text = ''
         if (allocated(result%all_solutions)) text = solutions_text(result%all_solutions, [result%system%r(1::2), &
            result%system%r(2::2)])
         call documents(1)%record(text)
      end associate
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

   !> Makes the summary of a reduced problem.
   subroutine new_reduced_summary(summary, config, result)
      type(document_t), intent(out) :: summary !! the summary
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(in) :: result !! the result
      type(quantity_t) :: no_quantities(0)
      type(quantity_t), allocatable :: sums(:)

      associate (solution => result%solution, system => result%system)
         sums = resultants([system%r(1::system%dimension), system%r(2::system%dimension)], system%n_contacts, .false.)
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
