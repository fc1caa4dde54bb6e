!> A chunk of a sweep: consecutive cases that one thread solves, one after the other; their rows in NAME.sweep.csv, and
!> their statistics: how many converged, and the extremes of their results.
!>
!> A chunk begins at rest; each further case of it starts from its neighbor, if that belongs to the chunk. So no result
!> depends on the number of threads, nor on where a sweep was interrupted.
!>
!> Rows are made on several threads without functions that return a text: gfortran 12 keeps the length of such a text in
!> a variable that all threads share.
module amontons_sweep_chunk
   use amontons_body, only: body_t
   use amontons_checkpoint, only: archive_t
   use amontons_cone, only: least_squares
   use amontons_config, only: config_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_document, only: field, status_runs
   use amontons_equilibrium, only: recover_with_travel
   use amontons_error, only: error_t, numerical_failure
   use amontons_key_results, only: body_peaks, body_peaks_at_rest, contact_results_t, new_contact_results, resultants
   use amontons_kinds, only: dp, int64
   use amontons_load_family, only: acting_t, add_part, check_shear, load_case_t, one_part, parting_t, &
      recover_displacements
   use amontons_load_solver, only: load_solver_t, new_load_solver
   use amontons_material, only: n_strains
   use amontons_model_warnings, only: add_sweep_warnings
   use amontons_named_forces, only: find_responses, force_form_t, named_quantities, named_tests, new_force_form, &
      set_named_values
   use amontons_quantity, only: expanded, largest_t, longest_key, quantity_t, scales
   use amontons_result, only: certificate_limit, outcome_names, outcome_no_equilibrium, outcome_not_converged, &
      outcome_numbers, outcome_solved, result_t
   use amontons_result_warnings, only: case_warning_names, find_case_warnings, tally_t
   use amontons_solve_case, only: cache_t, prepare_case
   use amontons_stress_field, only: find_node_stresses
   use amontons_study, only: study_monitor_t
   use amontons_sweep, only: sweep_t, swept_friction, swept_load
   use amontons_text, only: longest_decimal, newline, put_decimals, put_integer, put_text
   implicit none (type, external)
   private

   public :: append_row, case_keys, case_result_t, chunk_length, chunk_t, condense_task, find_stored_numbers, &
      new_case, new_chunk, outcome_labels, prepare_sweep, ranked_quantities, read_warnings, solve_cases, solve_chunks, &
      sweep_header, sweep_statistics_t, sweep_task_t

   !> Names of the outcomes in listings.
   character(14), parameter :: outcome_labels(size(outcome_names)) = [character(14) :: 'Converged', 'NOT CONVERGED', &
      'No equilibrium', 'Numbers failed']

   !> The stored result of one case.
   type :: case_result_t
      integer :: outcome = outcome_not_converged !! its outcome
      logical :: has_solution = .false. !! whether it has numbers, all of them finite
      real(dp), allocatable :: quantity(:) !! the numbers that `case_keys` names
      real(dp), allocatable :: scale(:) !! scales of their rounding errors, if larger than the numbers themselves
      real(dp) :: residual = 0.0_dp !! residual of the contact problem [-]
      real(dp) :: force_error = 0.0_dp !! residual and rounding errors, over its forces [-]
      integer :: n_iterations = 0 !! iterations, of all attempts
      logical :: is_warned(size(case_warning_names)) = .false. !! its warnings, if it converged
   contains
      procedure :: is_empty => case_result_is_empty
   end type case_result_t

   !> Counts and extremes of the first cases of a sweep. Extremes are those of converged cases.
   type :: sweep_statistics_t
      integer :: n_cases = 0 !! number of cases
      integer :: n_outcomes(size(outcome_names)) = 0 !! number of cases of each outcome
      integer :: failed_case = 0 !! the first case with a numerical failure; 0 if there is none
      integer(int64) :: n_iterations = 0 !! sum of their iterations
      type(largest_t) :: residual = largest_t(-1.0_dp) !! largest residual; -1 without a case [-]
      type(largest_t) :: force_error = largest_t(-1.0_dp) !! largest error estimate; -1 without a case [-]
      type(largest_t), allocatable :: extremes(:, :)
         !! the largest of the negative of each number of a case, and of the number; not allocated without a case (n, 2)
      type(tally_t) :: warned(size(case_warning_names)) !! the cases that each warning is about
   contains
      procedure :: add => sweep_statistics_add
      procedure :: append => sweep_statistics_append
      procedure :: outcome => sweep_statistics_outcome
      procedure :: visit => sweep_statistics_visit
   end type sweep_statistics_t

   !> Number of cases in a chunk: few enough that an interrupt is quick, many enough that the first case, which begins
   !> at rest, hardly matters.
   integer, parameter :: chunk_length = 64

   !> The data of a sweep that all threads read.
   type :: sweep_task_t
      type(sweep_t) :: sweep !! the cases
      type(load_solver_t) :: solver !! their loads and the solver
      type(force_form_t) :: forces !! the forces by name, where they are asked for
      type(quantity_t), allocatable :: named(:) !! their names; none where they are not asked for
      character(:), allocatable :: units !! names of the units of the case
      integer :: n_quantities = 0 !! numbers that are kept of a case
      logical :: wants_error_estimate = .false.
         !! whether the error of stresses is to be estimated, of fields and of the case certified
   end type sweep_task_t

   !> Consecutive cases and their results.
   type :: chunk_t
      integer :: first = 1 !! its first case
      integer :: last = 0 !! its last case
      logical :: is_done = .false. !! whether it has been solved
      character(:), allocatable :: rows !! rows of its cases
      type(sweep_statistics_t) :: statistics !! their statistics, numbered from 1
      type(case_result_t) :: results(chunk_length) !! stored results of its cases
      character(:), allocatable :: fault !! the numerical failure of its last case without a solution
      integer :: fault_kind = 0 !! the kind of that error; 0 for none
      logical :: keeps_solutions = .false. !! whether the solutions of its cases are asked for
      type(contact_solution_t), allocatable :: solutions(:) !! these solutions (cases)
   contains
      procedure :: is_broken => chunk_is_broken
   end type chunk_t

contains

   !=sweep.csv `case` | | number of the case, from 1
   !=sweep.csv `factor_LOAD`, `friction`, `friction_SET`, `friction_factor`, `friction_factor_SET` | – | a column for
   !=   each `&sweep`, in the deck's order: the value
   !=sweep.csv `open_length`, `slip_length`, `stick_length` | L | see [Lengths](#lengths)
   !=sweep.csv `normal_force`, `tangential_force` | F | sums of the normal and of the tangential forces
   !=sweep.csv `max_contact_pressure` ... `max_slip_y` | | [key results](#key-results) of the contact points; with
   !=   [`key_results = 'forces'`](decks.md#output) the forces by name, with `'all'` these and those of the body too
   !=sweep.csv `residual` | – | residual of the contact problem
   !=sweep.csv `iterations` | | iterations, of all attempts
   !=sweep.csv `outcome` | | `solved`, `not_converged`, `no_equilibrium` (contact and friction cannot balance the loads)
   !=   or `numerical_failure` (numbers leave the range of double precision, or keep no digit)
   !=sweep.csv `warnings` | | of a converged case: `large_displacement` (of contact points, above 5 % of the body's
   !=   size), `no_contact`, `few_points` (1 or 2 closed), `pressure_jump` (the largest pressure more than twice that of
   !=   its neighbors), `large_strain` (a contact pressure above 2 % of Young's modulus), `end_of_set` (contact reaches
   !=   an end of its set, or of what `search` reaches, and the boundary goes on); empty for none
   !=sweep.csv `statuses` | | the contact line as run lengths: `4o 12+ 17s` is 4 points open, 12 `slip+`, 17 stick; `-`
   !=   is `slip-`, `*` is `slip` of a twisted body; a bar separates contact sets
   !> The stored numbers of a case: lengths, sums of forces, key results of the contact points and, if they are asked
   !> for, of the body.
   pure function case_quantities(body, solution, at_points, peaks) result(list)
      type(body_t), intent(in) :: body !! the body
      type(contact_solution_t), intent(in) :: solution !! the solution
      type(contact_results_t), intent(in) :: at_points !! its results at the contact points
      type(quantity_t), intent(in) :: peaks(:) !! `body_peaks` and forces by name, if the deck asks for them
      type(quantity_t), allocatable :: list(:)

      list = [at_points%lengths%quantities(), resultants(solution%force, body%zone%n_points, &
         .not. allocated(body%zone%line)), at_points%peaks, &
         at_points%sets, peaks]
   end function case_quantities

   !> The names of the stored numbers of a case, in the order of the columns of NAME.sweep.csv.
   pure function case_keys(body, sweep) result(keys)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(longest_key), allocatable :: keys(:)
      type(quantity_t), allocatable :: list(:)

      list = expanded(ranked_quantities(body, sweep))
      keys = list%key
   end function case_keys

   !> The numbers by which cases can be ranked: all stored numbers except positions. The values are those of a case
   !> without loads.
   pure function ranked_quantities(body, sweep) result(list)
      type(body_t), intent(in) :: body !! the body
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(quantity_t), allocatable :: list(:), peaks(:)
      type(contact_solution_t) :: solution
      type(contact_results_t) :: at_points
      real(dp) :: zeros(body%zone%n_points)

      call new_contact_solution(solution, body%zone%n_points, body%zone%n_tangents)
      zeros = 0.0_dp
      call new_contact_results(at_points, body, solution, zeros, zeros)
      peaks = body_peaks_at_rest(size(body%mesh%coordinates, 1))
      if (.not. sweep%has_body_results) peaks = peaks(:0)
      if (sweep%has_forces) peaks = [peaks, named_quantities(body)]
      list = case_quantities(body, solution, at_points, peaks)
   end function ranked_quantities

   !> Whether a case of a sweep has no solution, so that its columns of results are empty.
   elemental logical function case_result_is_empty(self) result(is_empty)
      class(case_result_t), intent(in) :: self !! the result

      is_empty = self%outcome == outcome_no_equilibrium .or. self%outcome == outcome_numbers
   end function case_result_is_empty

   !> Appends the next case to the statistics.
   pure subroutine sweep_statistics_add(self, result)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      type(case_result_t), intent(in) :: result !! stored result of the case
      type(sweep_statistics_t) :: one

      one%n_cases = 1
      one%n_outcomes(result%outcome) = 1
      one%n_iterations = result%n_iterations
      if (result%outcome == outcome_numbers) one%failed_case = 1
      if (result%outcome == outcome_solved) then
         one%residual = largest_t(result%residual, 1)
         one%force_error = largest_t(result%force_error, 1)
         allocate (one%extremes(size(result%quantity), 2), source=largest_t(at=1))
         one%extremes%value = reshape([-result%quantity, result%quantity], shape(one%extremes))
         call one%warned%append(merge(1, 0, result%is_warned), 1, 1)
      end if
      call self%append(one)
   end subroutine sweep_statistics_add

   !> Appends the statistics of the next cases, numbered from 1 in them. Of equal cases the first counts.
   pure subroutine sweep_statistics_append(self, next)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      type(sweep_statistics_t), intent(in) :: next !! those of the next cases
      integer :: n

      n = self%n_cases
      self%n_cases = n + next%n_cases
      self%n_outcomes = self%n_outcomes + next%n_outcomes
      self%n_iterations = self%n_iterations + next%n_iterations
      if (self%failed_case == 0 .and. next%failed_case > 0) self%failed_case = n + next%failed_case
      call self%warned%append(next%warned%n, n + next%warned%first, n + next%warned%last)
      call self%residual%update(next%residual%value, n + next%residual%at)
      call self%force_error%update(next%force_error%value, n + next%force_error%at)
      if (.not. allocated(next%extremes)) return
      if (.not. allocated(self%extremes)) allocate (self%extremes(size(next%extremes, 1), 2), &
         source=largest_t(-huge(1.0_dp)))
      call self%extremes%update(next%extremes%value, n + next%extremes%at)
   end subroutine sweep_statistics_append

   !> The outcome of a sweep in a word: that of a case without an answer, if there is one; no equilibrium only if no
   !> case has an equilibrium.
   pure function sweep_statistics_outcome(self) result(word)
      class(sweep_statistics_t), intent(in) :: self !! the statistics
      character(:), allocatable :: word
      integer :: outcome

      outcome = outcome_solved
      if (self%n_outcomes(outcome_solved) == 0) outcome = outcome_no_equilibrium
      if (self%n_outcomes(outcome_not_converged) > 0) outcome = outcome_not_converged
      if (self%failed_case > 0) outcome = outcome_numbers
      word = trim(outcome_names(outcome))
   end function sweep_statistics_outcome

   !> Writes the statistics to an archive, or reads them.
   pure subroutine sweep_statistics_visit(self, archive)
      class(sweep_statistics_t), intent(inout) :: self !! the statistics
      type(archive_t), intent(inout) :: archive !! the archive
      real(dp) :: n_iterations
      integer :: n, i

      n = 0
      if (allocated(self%extremes)) n = size(self%extremes, 1)
      n_iterations = real(self%n_iterations, dp)
      call archive%pass(self%n_cases)
      call archive%pass(n)
      call archive%pass(n_iterations)
      call archive%pass(self%n_outcomes)
      call archive%pass(self%failed_case)
      call archive%pass(self%residual%at)
      call archive%pass(self%residual%value)
      call archive%pass(self%force_error%at)
      call archive%pass(self%force_error%value)
      call archive%pass(self%warned%n)
      call archive%pass(self%warned%first)
      self%n_iterations = nint(n_iterations, int64)
      if (n == 0 .or. .not. archive%is_whole) return
      if (.not. allocated(self%extremes)) allocate (self%extremes(n, 2))
      do i = 1, 2
         call archive%pass(self%extremes(:, i)%value)
         call archive%pass(self%extremes(:, i)%at)
      end do
   end subroutine sweep_statistics_visit

   !> The header line of NAME.sweep.csv.
   pure function sweep_header(sweep, keys) result(text)
      type(sweep_t), intent(in) :: sweep !! the sweep
      character(*), intent(in) :: keys(:) !! names of the numbers that are kept of a case
      character(:), allocatable :: text
      integer :: i

      text = 'case'
      do i = 1, size(sweep%axes)
         text = text//','//field(sweep%axes(i)%label())
      end do
      do i = 1, size(keys)
         text = text//','//field(trim(keys(i)))
      end do
      text = text//',residual,iterations,outcome,warnings,statuses'//newline
   end function sweep_header

   !> Appends the row of a case; fields for which a case without a solution has no number are empty.
   pure subroutine append_row(rows, sweep, number, result, runs)
      character(:), allocatable, intent(inout) :: rows !! the rows so far
      type(sweep_t), intent(in) :: sweep !! the sweep
      integer, intent(in) :: number !! number of the case
      type(case_result_t), intent(in) :: result !! its result
      character(*), intent(in) :: runs !! its `status_runs`
      ! A text that grows piece by piece is copied with each of them.
      character((longest_decimal + 1)*(size(sweep%axes) + size(result%quantity) + 4) + len(outcome_names) &
         + (len(case_warning_names) + 1)*size(case_warning_names) + len(runs)) :: text
      integer :: length, i

      length = 0
      call put_integer(text, length, number)
      call put_decimals(text, length, sweep%values(number))
      if (result%has_solution) then
         call put_decimals(text, length, [result%quantity, result%residual])
      else
         call put_text(text, length, repeat(',', size(result%quantity) + 1))
      end if
      call put_text(text, length, ',')
      call put_integer(text, length, result%n_iterations)
      call put_text(text, length, ','//trim(outcome_names(result%outcome))//',')
      if (result%has_solution) then
         ! The names of warnings, blanks between them.
         do i = 1, size(result%is_warned)
            if (result%is_warned(i)) call put_text(text, length, trim(case_warning_names(i))//' ')
         end do
         if (any(result%is_warned)) length = length - 1
         call put_text(text, length, ','//runs)
      else
         call put_text(text, length, ',')
      end if
      call put_text(text, length, newline)
      rows = rows//text(:length)
   end subroutine append_row

   !> Reads warnings from their names; unknown ones are ignored.
   pure subroutine read_warnings(is_warned, names)
      logical, intent(out) :: is_warned(size(case_warning_names)) !! index in `case_warning_names`
      character(*), intent(in) :: names !! the names, blanks between them
      integer :: i

      do i = 1, size(is_warned)
         is_warned(i) = index(' '//names//' ', ' '//trim(case_warning_names(i))//' ') > 0
      end do
   end subroutine read_warnings

   !> Makes body and loads of a sweep, and so checks everything that its deck may get wrong.
   subroutine prepare_sweep(task, cache, config, result, error)
      type(sweep_task_t), intent(out) :: task !! the sweep; its loads are not condensed yet
      type(cache_t), intent(inout) :: cache !! the present body, replaced if the sweep needs another
      type(config_t), intent(in) :: config !! the deck
      type(result_t), intent(out) :: result !! gains the load case of the deck as it stands, and warnings on the model
      type(error_t), allocatable, intent(out) :: error !! the deck is invalid
      type(config_t) :: least
      type(contact_t), allocatable :: contacts(:)

      ! No case may have a friction that cannot act, or a negative one.
      least = config
      call config%sweep%set_friction(least%contacts, is_least=.true.)
      call prepare_case(cache, least, result, error)
      if (allocated(error)) return
      contacts = config%contacts
      call config%sweep%set_friction(contacts, is_least=.false.)
      call check_shear(cache%body%zone, contacts, error)
      if (allocated(error)) return
      ! Reports show the contact sets of the deck.
      result%load_case%contacts = config%contacts
      ! The case certified has an estimate, and those whose fields are written.
      task%wants_error_estimate = result%wants_error_estimate
      result%wants_error_estimate = .false.
      call add_sweep_warnings(result%warnings, config%sweep, result%load_case, cache%body%zone%set)
      task%sweep = config%sweep
      task%units = config%units
      task%n_quantities = size(case_keys(cache%body, config%sweep))
      call new_load_solver(task%solver, cache%body, result%load_case, parting_of(config%sweep, result%load_case), &
         config%method, error)
   end subroutine prepare_sweep

   !> Condenses the loads of a sweep, computes the coefficients of its forces by name, and prepares its method.
   subroutine condense_task(task, body, problem, error)
      type(sweep_task_t), intent(inout) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(error_t), allocatable, intent(out) :: error !! S is not positive definite, or memory ran out
      real(dp), allocatable :: fields(:, :, :), loads(:, :, :)

      call task%solver%loads%condense(body, problem)
      call task%solver%method%prepare(problem, error)
      allocate (task%named(0))
      if (.not. task%sweep%has_forces) return
      task%named = named_quantities(body)
      call find_responses(fields, loads, body, task%solver%loads%parts)
      call new_force_form(task%forces, body, named_tests(body), task%solver%loads%parts, fields, loads)
   end subroutine condense_task

   !> The parts of the loads of a sweep: the loads and friction that quantity number k multiplies are part 1 + k.
   pure function parting_of(sweep, load_case) result(parting)
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(load_case_t), intent(in) :: load_case !! the load case of the deck
      type(parting_t) :: parting
      integer :: i, k

      parting = one_part(load_case)
      do k = 1, size(sweep%axes)
         associate (axis => sweep%axes(k), loads => load_case%loads, supports => load_case%supports, &
            contacts => load_case%contacts)
            call add_part(parting, [(axis%target == swept_load .and. axis%name == loads(i)%name, i=1, size(loads))], &
               [(axis%target == swept_load .and. supports(i)%is_driven() .and. axis%name == supports(i)%name, &
               i=1, size(supports))], [(axis%acts_on(contacts(i)%set), i=1, size(contacts))])
         end associate
      end do
      parting%is_coefficient = [.false., sweep%axes%target == swept_friction]
   end function parting_of

   !> Makes the load case of a case of the sweep, condensed if the loads are.
   subroutine new_case(load_case, task, body, number)
      type(load_case_t), intent(out) :: load_case !! the load case
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the case
      type(acting_t) :: acting

      call task%solver%loads%at_rest(acting)
      acting%factor(2:) = task%sweep%values(number)
      call task%solver%loads%load_case(body, acting, load_case)
   end subroutine new_case

   !> Makes the chunk that follows a number of cases, as far as there are cases.
   pure subroutine new_chunk(chunk, n_before, n_cases)
      type(chunk_t), intent(out) :: chunk !! the chunk
      integer, intent(in) :: n_before !! number of cases before it, a multiple of the length of a chunk
      integer, intent(in) :: n_cases !! the last case there is

      chunk%first = n_before + 1
      chunk%fault = ''
      chunk%last = n_before + min(chunk_length, n_cases - n_before)
   end subroutine new_chunk

   !> Whether a case could not be solved for a reason other than its numbers, that is, memory ran out.
   elemental logical function chunk_is_broken(self) result(is_broken)
      class(chunk_t), intent(in) :: self !! the chunk

      is_broken = self%fault_kind > 0 .and. self%fault_kind /= numerical_failure
   end function chunk_is_broken

   !> Solves chunks on all threads, except those that have not begun when the monitor stops the sweep. A single chunk
   !> leaves the threads to the loops within it.
   subroutine solve_chunks(task, body, problem, monitor, chunks)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! the chunks
      ! Each thread has a contact problem of its own.
      type(contact_problem_t) :: own
      type(contact_solution_t), allocatable :: solutions(:)
      integer :: i

      !$omp parallel default(none) if (size(chunks) > 1) shared(task, body, problem, monitor, chunks) &
      !$omp& private(own, solutions)
      own = problem
      allocate (solutions(chunk_length))
      !$omp do schedule(dynamic, 1)
      do i = 1, size(chunks)
         if (monitor%is_stopped()) cycle
         call solve_chunk(task, body, own, chunks(i), solutions)
         if (chunks(i)%keeps_solutions) chunks(i)%solutions = solutions
      end do
      !$omp end do
      !$omp end parallel
   end subroutine solve_chunks

   !> Solves the cases of a chunk of a sweep, one after the other.
   subroutine solve_chunk(task, body, problem, chunk, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left as that of the last case
      type(chunk_t), intent(inout) :: chunk !! the chunk
      type(contact_solution_t), intent(out) :: solutions(chunk_length) !! the solutions of its cases
      character(:), allocatable :: runs
      integer :: i

      call solve_cases(task, body, problem, chunk, solutions)
      chunk%rows = ''
      if (chunk%is_broken()) return
      call find_stored_numbers(task, body, chunk, solutions)
      do i = 1, chunk%last - chunk%first + 1
         call status_runs(runs, solutions(i)%status, body%zone%set)
         call append_row(chunk%rows, task%sweep, chunk%first + i - 1, chunk%results(i), runs)
         call chunk%statistics%add(chunk%results(i))
      end do
      chunk%is_done = .true.
   end subroutine solve_chunk

   !> Solves the cases of a chunk, each from its neighbor, without computing their numbers.
   subroutine solve_cases(task, body, problem, chunk, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left as that of the last case
      type(chunk_t), intent(inout) :: chunk !! the chunk; gains what became of the cases
      type(contact_solution_t), intent(out) :: solutions(chunk_length) !! their solutions
      type(acting_t) :: acting
      character(:), allocatable :: reason
      integer, allocatable :: reached(:)
      real(dp) :: largest, wrong
      integer :: i, number, neighbor, outcome, kind

      call task%solver%loads%at_rest(acting)
      do i = 1, chunk%last - chunk%first + 1
         number = chunk%first + i - 1
         neighbor = task%sweep%neighbor(number) - chunk%first + 1
         acting%factor(2:) = task%sweep%values(number)
         call task%solver%loads%pose(body, acting, problem)
         call new_contact_solution(solutions(i), problem%n_points, problem%matrix%n_tangents)
         ! With a method named in the deck each case starts from rest, as if it were alone.
         if (neighbor >= 1 .and. task%solver%is_auto) then
            if (solutions(neighbor)%is_converged) solutions(i) = solutions(neighbor)
         end if
         call task%solver%solve(body, acting, problem, solutions(i), outcome, reason, kind)
         if (outcome == outcome_numbers) then
            chunk%fault_kind = kind
            call move_alloc(reason, chunk%fault)
            if (chunk%is_broken()) return
         end if
         ! Stores the outcome of the case, without its numbers.
         associate (kept => chunk%results(i), solution => solutions(i), base => task%solver%loads%base)
            kept%outcome = outcome
            kept%n_iterations = solution%n_iterations
            if (kept%is_empty()) cycle
            kept%residual = solution%residual
            ! Which residual below the tolerance is the largest is a matter of rounding.
            wrong = max(solution%residual, task%solver%method%tolerance)*problem%force_scale() &
               + epsilon(wrong)*maxval(problem%matrix%augmentation*abs(solution%displacement))
            largest = max(task%solver%loads%largest_force(acting%factor), maxval(abs(solution%force)))
            if (.not. largest > 0.0_dp) largest = problem%force_scale()
            ! Where nothing acts there are no forces whose errors could be certified.
            if (.not. problem%is_unloaded()) kept%force_error = min(wrong/largest, huge(kept%force_error))
            if (.not. solution%is_converged) cycle
            call find_case_warnings(kept%is_warned, body, task%solver%size_of_body, base%contacts, base%gap, solution)
            ! Nodes beyond an end of a set bear no force, so that the force at the end is uncertain.
            reached = body%free_boundary%reached_ends(base%contacts, body%mesh%coordinates, base%gap, solution%status)
            kept%force_error = max(kept%force_error, max(0.0_dp, maxval(solution%force( &
               body%free_boundary%ends(reached)%point)))/max(maxval(solution%force), tiny(1.0_dp)))
         end associate
      end do
   end subroutine solve_cases

   !> Computes the stored numbers of all cases of a chunk.
   subroutine find_stored_numbers(task, body, chunk, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(chunk_t), intent(inout) :: chunk !! the chunk, its cases solved; their results gain the numbers
      type(contact_solution_t), intent(in) :: solutions(chunk_length) !! their solutions
      type(quantity_t), allocatable :: peaks(:, :), named(:), list(:)
      type(contact_results_t) :: at_points
      type(acting_t) :: acting
      integer :: i

      call find_body_results(peaks, task, body, chunk, solutions)
      call task%solver%loads%at_rest(acting)
      do i = 1, chunk%last - chunk%first + 1
         associate (kept => chunk%results(i), loads => task%solver%loads)
            if (kept%is_empty()) then
               kept%quantity = spread(0.0_dp, 1, task%n_quantities)
               kept%scale = kept%quantity
            else
               acting%factor(2:) = task%sweep%values(chunk%first + i - 1)
               named = task%named
               if (task%sweep%has_forces) call set_named_values(named, body, task%forces%values(acting%factor, &
                  solutions(i)%displacement, solutions(i)%force), max(loads%largest_force(acting%factor), &
                  sum(abs(solutions(i)%force))), maxval(abs(solutions(i)%displacement)))
               call new_contact_results(at_points, body, solutions(i), loads%base%slip_bound &
                  + loads%friction_of(acting)*solutions(i)%force(:body%zone%n_points), loads%gap_of(acting))
               list = case_quantities(body, solutions(i), at_points, [peaks(:, i), named])
               kept%scale = scales(list)
               list = expanded(list)
               kept%quantity = list%value
               kept%has_solution = all(abs(kept%quantity) <= huge(1.0_dp)) .and. kept%residual < huge(1.0_dp)
               if (kept%has_solution) cycle
               ! A solution with numbers that are not finite is none, however small its residual.
               kept%outcome = outcome_numbers
               kept%is_warned = .false.
            end if
         end associate
      end do
   end subroutine find_stored_numbers

   !> Computes the key results of the whole body for all cases of a chunk, if the deck asks for them.
   subroutine find_body_results(peaks, task, body, chunk, solutions)
      type(quantity_t), allocatable, intent(out) :: peaks(:, :)
         !! `body_peaks` of each case, of one without displacements at rest; none unless asked for (any, cases)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(chunk_t), intent(in) :: chunk !! the chunk, its cases solved
      type(contact_solution_t), intent(in) :: solutions(chunk_length) !! their solutions
      ! Number of cases that are processed together: more take much memory in addition to the factor, and gain little.
      integer, parameter :: n_together = 4
      integer, allocatable :: cases(:)
      type(load_case_t) :: load_cases(n_together)
      type(acting_t) :: acting
      real(dp), allocatable :: displacement(:, :), force(:, :), field(:, :, :), stress(:, :, :), strains(:, :)
      real(dp), allocatable :: whole(:, :)
      logical :: is_far(n_together)
      integer :: first, i, k, n

      n = chunk%last - chunk%first + 1
      peaks = spread(body_peaks_at_rest(size(body%mesh%coordinates, 1)), 2, n)
      if (.not. task%sweep%has_body_results) then
         peaks = peaks(:0, :)
         return
      end if
      cases = [(i, i=1, n)]
      cases = pack(cases, .not. chunk%results(:n)%is_empty() .and. solutions(:n)%residual < huge(1.0_dp))
      call task%solver%loads%at_rest(acting)
      do first = 1, size(cases), n_together
         ! These cases take one pass over the factor and the elements.
         associate (some => cases(first:min(size(cases), first + n_together - 1)), loads => task%solver%loads)
            allocate (displacement(body%zone%n_rows, size(some)), force(body%zone%n_rows, size(some)), &
               stress(n_strains, body%mesh%n_nodes, size(some)))
            do k = 1, size(some)
               acting%factor(2:) = task%sweep%values(chunk%first + some(k) - 1)
               displacement(:, k) = solutions(some(k))%displacement
               is_far(k) = loses_digits(displacement(:, k))
               force(:, k) = solutions(some(k))%force
               call loads%load_case(body, acting, load_cases(k))
               if (.not. allocated(load_cases(k)%element_load)) cycle
               if (.not. allocated(strains)) allocate (strains(size(load_cases(k)%element_load), size(some)))
               strains(:, k) = load_cases(k)%element_load
            end do
            call recover_displacements(field, body, load_cases(:size(some)), displacement, force)
            do k = 1, size(some)
               if (.not. is_far(k)) cycle
               call recover_with_travel(whole, body, load_cases(k), solutions(some(k))%displacement, &
                  solutions(some(k))%force)
               field(:, :, k) = whole
            end do
            call find_node_stresses(stress, size(some), body%mesh, body%materials, body%coloring, field, strains)
            do k = 1, size(some)
               peaks(:, some(k)) = body_peaks(body%mesh, field(:, :, k), stress(:, :, k))
            end do
         end associate
         deallocate (displacement, force, stress)
         if (allocated(strains)) deallocate (strains)
      end do

   contains

      !> Whether a motion as a rigid body is so long that rounding leaves strains fewer digits than the certificate asks
      !> for. They are recovered one case at a time then, as those of a single case.
      logical function loses_digits(v)
         real(dp), intent(in) :: v(:) !! displacements of the contact points (n_rows) [L]

         loses_digits = size(body%rigid_modes, 2) > 0
         if (loses_digits) loses_digits = epsilon(v)*maxval(abs(v)) > certificate_limit(task%solver%method%tolerance) &
            *maxval(abs(v - matmul(body%rigid_modes, least_squares(body%rigid_modes, v))))
      end function loses_digits

   end subroutine find_body_results

end module amontons_sweep_chunk
