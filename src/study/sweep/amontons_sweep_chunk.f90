!> A chunk of a sweep: consecutive cases that one thread solves, one after the other.
!>
!> A chunk begins at rest; each further case of it starts from its neighbor, if that belongs to the chunk. So no result
!> depends on the number of threads, nor on where a sweep was interrupted.
module amontons_sweep_chunk
   use amontons_body, only: body_t
   use amontons_condensation, only: condensed_load_t
   use amontons_config, only: config_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_document, only: status_runs
   use amontons_error, only: error_t
   use amontons_key_results, only: body_peaks, body_peaks_at_rest
   use amontons_kinds, only: dp
   use amontons_load_case, only: check_shear, load_case_t, recover_displacements
   use amontons_load_family, only: acting_t, one_part, parting_t
   use amontons_load_solver, only: forget_start, load_solver_t, new_load_solver
   use amontons_model_warnings, only: add_sweep_warnings
   use amontons_quantity, only: quantity_t
   use amontons_result, only: outcome_no_equilibrium, outcome_not_converged, outcome_numbers, result_t
   use amontons_result_warnings, only: find_case_warnings
   use amontons_solve_case, only: cache_t, prepare_case
   use amontons_stress_field, only: find_node_stresses
   use amontons_study, only: study_monitor_t
   use amontons_sweep, only: sweep_t, swept_friction, swept_load
   use amontons_sweep_table, only: append_row, case_keys, case_result_t, set_numbers, sweep_statistics_t
   implicit none (type, external)
   private

   public :: chunk_length, chunk_t, new_case, new_chunk, prepare_sweep, solve_again, solve_chunks, sweep_task_t

   !> Number of cases of a chunk: few enough that an interrupt need not wait, many enough that the one which begins at
   !> rest does not count.
   integer, parameter :: chunk_length = 64

   !> What all threads share and none changes.
   type :: sweep_task_t
      type(sweep_t) :: sweep !! the cases
      type(load_solver_t) :: solver !! their loads, and the way to their solutions
      character(:), allocatable :: units !! names of the units of the case
      integer :: n_quantities = 0 !! numbers that are kept of a case
      logical :: wants_error_estimate = .false.
         !! whether the error of stresses is to be estimated, of fields and of the case certified
   end type sweep_task_t

   !> Consecutive cases and what became of them.
   type :: chunk_t
      integer :: first = 1 !! its first case
      integer :: last = 0 !! its last case
      logical :: is_done = .false. !! whether it has been solved
      character(:), allocatable :: rows !! rows of its cases
      type(sweep_statistics_t) :: statistics !! what is known of them together, numbered from 1
      type(case_result_t) :: results(chunk_length) !! what is kept of its cases
   end type chunk_t

contains

   !> Makes body and loads of a sweep ready, everything that its deck can get wrong.
   subroutine prepare_sweep(task, cache, config, result, error)
      type(sweep_task_t), intent(out) :: task !! the sweep; its loads are not condensed yet
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the sweep needs another
      type(config_t), intent(in) :: config !! the deck
      type(result_t), intent(out) :: result !! gains the load case of the deck as it stands, and warnings on the model
      type(error_t), allocatable, intent(out) :: error !! the deck is at fault
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
      ! What is told is the deck's.
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

   !> Which quantity multiplies what: that of number k belongs to part 1 + k.
   pure function parting_of(sweep, load_case) result(parting)
      type(sweep_t), intent(in) :: sweep !! the sweep
      type(load_case_t), intent(in) :: load_case !! the load case of the deck
      type(parting_t) :: parting
      integer :: i, k

      parting = one_part(load_case)
      parting%n_parts = 1 + size(sweep%axes)
      parting%is_coefficient = [.false., sweep%axes%target == swept_friction]
      do k = 1, size(sweep%axes)
         associate (axis => sweep%axes(k))
            do i = 1, size(parting%load)
               if (axis%target == swept_load .and. axis%name == load_case%loads(i)%name) parting%load(i) = 1 + k
            end do
            do i = 1, size(parting%friction)
               if (axis%acts_on(load_case%contacts(i)%set)) parting%friction(i) = 1 + k
            end do
         end associate
      end do
   end function parting_of

   !> The number of a case as a member of the family of loads.
   pure subroutine set_case(task, number, acting)
      type(sweep_task_t), intent(in) :: task !! the sweep
      integer, intent(in) :: number !! number of the case
      type(acting_t), intent(inout) :: acting !! a member; gains the factors of the case

      acting%factor(2:) = task%sweep%values(number)
   end subroutine set_case

   !> The load case of a case of the sweep, condensed if the loads are.
   subroutine new_case(load_case, task, body, number)
      type(load_case_t), intent(out) :: load_case !! the load case
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the case
      type(acting_t) :: acting

      call task%solver%loads%at_rest(acting)
      call set_case(task, number, acting)
      call task%solver%loads%load_case(body, acting, load_case)
   end subroutine new_case

   !> The chunk that begins behind a number of cases, as far as there are cases.
   pure subroutine new_chunk(chunk, n_before, n_cases)
      type(chunk_t), intent(out) :: chunk !! the chunk
      integer, intent(in) :: n_before !! number of cases before it, a multiple of the length of a chunk
      integer, intent(in) :: n_cases !! the last case there is

      chunk%first = n_before + 1
      chunk%last = n_before + min(chunk_length, n_cases - n_before)
   end subroutine new_chunk

   !> Solves chunks on all threads, as many as are begun before the monitor stops the sweep. A single chunk leaves the
   !> threads to the loops within it.
   subroutine solve_chunks(task, body, problem, monitor, chunks)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! the chunks

      !$omp parallel default(none) if (size(chunks) > 1) shared(task, body, problem, monitor, chunks)
      call share_chunks(task, body, problem, monitor, chunks)
      !$omp end parallel
   end subroutine solve_chunks

   !> One thread's share of the chunks, with a contact problem of its own.
   subroutine share_chunks(task, body, problem, monitor, chunks)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! the chunks
      type(contact_problem_t) :: own
      type(contact_solution_t) :: solutions(chunk_length)
      integer :: i

      own = problem
      !$omp do schedule(dynamic, 1)
      do i = 1, size(chunks)
         if (.not. monitor%is_stopped()) call solve_chunk(task, body, own, chunks(i), solutions)
      end do
      !$omp end do
   end subroutine share_chunks

   !> Solves the cases of a chunk.
   subroutine solve_chunk(task, body, problem, chunk, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left as that of the last case
      type(chunk_t), intent(inout) :: chunk !! the chunk
      type(contact_solution_t), intent(out) :: solutions(chunk_length) !! the solutions of its cases
      character(:), allocatable :: runs
      integer :: i

      call solve_cases(task, body, problem, chunk, spread(.true., 1, chunk_length), solutions)
      call find_numbers(task, body, chunk, solutions)
      chunk%rows = ''
      do i = 1, chunk%last - chunk%first + 1
         call status_runs(runs, solutions(i)%status, body%zone%set)
         call append_row(chunk%rows, task%sweep, chunk%first + i - 1, chunk%results(i), runs)
         call chunk%statistics%add(chunk%results(i))
      end do
      chunk%is_done = .true.
   end subroutine solve_chunk

   !> Solves some cases of a chunk again, and those whose solutions they start from, without their numbers.
   subroutine solve_again(task, body, problem, chunk, is_wanted, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left as that of the last case
      type(chunk_t), intent(inout) :: chunk !! the chunk; gains what became of these cases, and no rows
      logical, intent(in) :: is_wanted(:) !! which of its cases are asked for (cases of the chunk)
      type(contact_solution_t), intent(out) :: solutions(chunk_length) !! the solutions of these cases
      logical :: is_needed(chunk_length)
      integer :: i, neighbor

      is_needed = .false.
      is_needed(:size(is_wanted)) = is_wanted
      do i = size(is_wanted), 1, -1
         neighbor = task%sweep%neighbor(chunk%first + i - 1) - chunk%first + 1
         if (is_needed(i) .and. neighbor >= 1) is_needed(neighbor) = .true.
      end do
      call solve_cases(task, body, problem, chunk, is_needed, solutions)
   end subroutine solve_again

   !> Solves cases of a chunk, each from its neighbor.
   subroutine solve_cases(task, body, problem, chunk, is_needed, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem; left as that of the last case
      type(chunk_t), intent(inout) :: chunk !! the chunk; gains what became of the cases
      logical, intent(in) :: is_needed(chunk_length) !! which cases are solved
      type(contact_solution_t), intent(inout) :: solutions(chunk_length) !! their solutions
      type(acting_t) :: acting
      character(:), allocatable :: reason
      integer :: i, number, neighbor, outcome

      call task%solver%loads%at_rest(acting)
      do i = 1, chunk%last - chunk%first + 1
         if (.not. is_needed(i)) cycle
         number = chunk%first + i - 1
         neighbor = task%sweep%neighbor(number) - chunk%first + 1
         call set_case(task, number, acting)
         call task%solver%loads%pose(body, acting, problem)
         call new_contact_solution(solutions(i), problem%n_points)
         ! By a method of its own a deck is solved as it would be alone.
         if (neighbor >= 1 .and. task%solver%is_auto) then
            if (solutions(neighbor)%is_converged) solutions(i) = solutions(neighbor)
         end if
         call forget_start(problem, solutions(i))
         call task%solver%solve(body, acting, problem, solutions(i), outcome, reason)
         call keep(task, body, acting, problem, solutions(i), outcome, chunk%results(i))
      end do
   end subroutine solve_cases

   !> Finds the numbers of all cases of a chunk.
   subroutine find_numbers(task, body, chunk, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(chunk_t), intent(inout) :: chunk !! the chunk, its cases solved; their results gain the numbers
      type(contact_solution_t), intent(in) :: solutions(chunk_length) !! their solutions
      type(quantity_t), allocatable :: peaks(:, :)
      type(acting_t) :: acting
      integer :: i

      call find_body_results(peaks, task, body, chunk, solutions)
      call task%solver%loads%at_rest(acting)
      do i = 1, chunk%last - chunk%first + 1
         associate (kept => chunk%results(i), loads => task%solver%loads)
            if (kept%outcome == outcome_no_equilibrium) then
               kept%quantity = spread(0.0_dp, 1, task%n_quantities)
            else
               call set_case(task, chunk%first + i - 1, acting)
               call set_numbers(kept, body, solutions(i), loads%friction_of(acting), loads%base%slip_bound, &
                  loads%gap_of(acting), peaks(:, i))
            end if
         end associate
      end do
   end subroutine find_numbers

   !> Finds the key results of the whole body, if the deck asks for them, of all cases of a chunk.
   subroutine find_body_results(peaks, task, body, chunk, solutions)
      type(quantity_t), allocatable, intent(out) :: peaks(:, :)
         !! `body_peaks` of each case, of one without displacements at rest; none unless asked for (any, cases)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(chunk_t), intent(in) :: chunk !! the chunk, its cases solved
      type(contact_solution_t), intent(in) :: solutions(chunk_length) !! their solutions
      ! How many cases are worked on together: fields of more take much memory beside a factor, and gain little.
      integer, parameter :: n_together = 4
      integer, allocatable :: cases(:)
      integer :: first, i, n

      n = chunk%last - chunk%first + 1
      peaks = spread(body_peaks_at_rest(), 2, n)
      if (.not. task%sweep%has_body_results) then
         peaks = peaks(:0, :)
         return
      end if
      cases = [(i, i=1, n)]
      cases = pack(cases, chunk%results(:n)%outcome /= outcome_no_equilibrium .and. &
         solutions(:n)%residual < huge(1.0_dp))
      do first = 1, size(cases), n_together
         associate (some => cases(first:min(size(cases), first + n_together - 1)))
            call find_peaks(peaks, task, body, chunk, solutions, some)
         end associate
      end do
   end subroutine find_body_results

   !> Finds the key results of the body of a few cases with one pass over the factor and the elements.
   subroutine find_peaks(peaks, task, body, chunk, solutions, cases)
      type(quantity_t), intent(inout) :: peaks(:, :) !! gains those of these cases (any, cases)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(chunk_t), intent(in) :: chunk !! the chunk
      type(contact_solution_t), intent(in) :: solutions(chunk_length) !! the solutions of its cases
      integer, intent(in) :: cases(:) !! the cases, numbered from 1 in the chunk
      type(condensed_load_t) :: condensed(size(cases))
      type(acting_t) :: acting
      real(dp), allocatable :: displacement(:, :), field(:, :, :), stress(:, :, :), strain(:), strains(:, :)
      integer :: k

      allocate (displacement(2*body%zone%n_points, size(cases)), stress(4, body%mesh%n_nodes, size(cases)))
      associate (loads => task%solver%loads)
         call loads%at_rest(acting)
         do k = 1, size(cases)
            call set_case(task, chunk%first + cases(k) - 1, acting)
            displacement(:, k) = solutions(cases(k))%displacement
            call loads%sum_condensed(acting%factor, condensed(k))
            call loads%sum_thermal(acting%factor, strain)
            if (.not. allocated(strain)) cycle
            if (.not. allocated(strains)) allocate (strains(size(strain), size(cases)))
            strains(:, k) = strain
         end do
         ! No quantity multiplies prescribed displacements: they are those of the first part.
         call recover_displacements(field, body, loads%parts(1), condensed, displacement)
      end associate
      call find_node_stresses(stress, size(cases), body%mesh, body%materials, body%coloring, field, strains)
      do k = 1, size(cases)
         peaks(:, cases(k)) = body_peaks(body%mesh, field(:, :, k), stress(:, :, k))
      end do
   end subroutine find_peaks

   !> Keeps what became of a case, but for its numbers.
   subroutine keep(task, body, acting, problem, solution, outcome, kept)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(acting_t), intent(in) :: acting !! what acts
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      type(contact_solution_t), intent(in) :: solution !! its solution
      integer, intent(in) :: outcome !! what came of it
      type(case_result_t), intent(out) :: kept !! what is kept of it
      integer, allocatable :: reached(:)

      ! Rows know no reasons: numbers that are none did not converge.
      kept%outcome = merge(outcome_not_converged, outcome, outcome == outcome_numbers)
      kept%n_iterations = solution%n_iterations
      if (outcome == outcome_no_equilibrium) return
      kept%residual = solution%residual
      kept%force_error = force_error(problem, solution, task%solver%loads%largest_force(acting%factor))
      if (.not. solution%is_converged) return
      associate (base => task%solver%loads%base)
         call find_case_warnings(kept%is_warned, body, task%solver%size_of_body, base%contacts, base%gap, solution)
         ! What lies beyond an end of a set bears no force: that of the end is in doubt.
         reached = body%free_boundary%reached_ends(base%contacts, body%mesh%coordinates, base%gap, solution%status)
         kept%force_error = max(kept%force_error, max(0.0_dp, maxval(solution%force( &
            body%free_boundary%ends(reached)%point)))/max(maxval(solution%force), tiny(1.0_dp)))
      end associate
   end subroutine keep

   !> What residual and rounding errors, as forces, are of the largest force that acts in a case [-].
   pure real(dp) function force_error(problem, solution, largest_load)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      type(contact_solution_t), intent(in) :: solution !! its solution
      real(dp), intent(in) :: largest_load !! the largest nodal force of the loads [F]
      real(dp) :: acting, wrong

      wrong = solution%residual*problem%force_scale() &
         + epsilon(wrong)*maxval(problem%augmentation()*abs(solution%displacement))
      acting = max(largest_load, maxval(abs(solution%force)))
      if (.not. acting > 0.0_dp) acting = problem%force_scale()
      force_error = min(wrong/acting, huge(force_error))
   end function force_error

end module amontons_sweep_chunk
