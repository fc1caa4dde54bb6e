!> A chunk of a sweep: consecutive cases that one thread solves, one after the other.
!>
!> A chunk begins at rest; each further case of it starts from its neighbor, if that belongs to the chunk. So no result
!> depends on the number of threads, nor on where a sweep was interrupted.
module amontons_sweep_chunk
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_document, only: status_runs
   use amontons_equilibrium, only: check_balance
   use amontons_error, only: error_t
   use amontons_key_results, only: body_peaks_at_rest
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t
   use amontons_methods, only: new_contact_method
   use amontons_newton, only: newton_t
   use amontons_quantity, only: quantity_t
   use amontons_result_warnings, only: find_case_warnings
   use amontons_spin, only: find_spin
   use amontons_study_monitor, only: study_monitor_t
   use amontons_sweep, only: sweep_t
   use amontons_sweep_model, only: new_sweep_loads, sweep_model_t
   use amontons_sweep_peaks, only: find_peaks
   use amontons_sweep_statistics, only: case_converged, case_keys, case_no_equilibrium, case_result_t, set_numbers, &
      sweep_statistics_t
   use amontons_sweep_table, only: append_row
   implicit none (type, external)
   private

   public :: chunk_length, chunk_t, new_chunk, new_sweep_task, solve_again, solve_chunks, sweep_task_t

   !> Number of cases of a chunk: few enough that an interrupt need not wait, many enough that the one which begins at
   !> rest does not count.
   integer, parameter :: chunk_length = 64

   !> What all threads share and none changes.
   type :: sweep_task_t
      type(sweep_t) :: sweep !! the cases
      type(sweep_model_t) :: model !! their contact problems
      class(contact_method_t), allocatable :: method !! the deck's method
      character(:), allocatable :: units !! names of the units of the case
      integer :: n_quantities = 0 !! numbers that are kept of a case
      logical :: is_auto = .false. !! whether the deck leaves the method to the program
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

   !> What the cases of a sweep share, but for the contact problem, which takes the condensed body.
   subroutine new_sweep_task(task, body, prepared, config, error)
      type(sweep_task_t), intent(out) :: task !! the sweep; its model is to be prepared
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: prepared !! the load case of the deck as it stands
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! there is no such method, or a load does not fit the mesh

      task%sweep = config%sweep
      task%units = config%units
      task%wants_error_estimate = config%accuracy%wants_estimate()
      task%n_quantities = size(case_keys(body, config%sweep))
      call new_contact_method(task%method, config%method, error)
      if (allocated(error)) return
      task%is_auto = config%method%method == 'auto'
      call new_sweep_loads(task%model, body, prepared, config, error)
   end subroutine new_sweep_task

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
   subroutine solve_chunks(task, body, monitor, chunks)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! the chunks

      !$omp parallel default(none) if (size(chunks) > 1) shared(task, body, monitor, chunks)
      call share_chunks(task, body, monitor, chunks)
      !$omp end parallel
   end subroutine solve_chunks

   !> One thread's share of the chunks, with a contact problem of its own.
   subroutine share_chunks(task, body, monitor, chunks)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      class(study_monitor_t), intent(in) :: monitor !! may stop the sweep
      type(chunk_t), intent(inout) :: chunks(:) !! the chunks
      type(contact_problem_t) :: problem
      type(contact_solution_t) :: solutions(chunk_length)
      integer :: i

      problem = task%model%problem
      !$omp do schedule(dynamic, 1)
      do i = 1, size(chunks)
         if (.not. monitor%is_stopped()) call solve_chunk(task, body, problem, chunks(i), solutions)
      end do
      !$omp end do
   end subroutine share_chunks

   !> Solves the cases of a chunk.
   subroutine solve_chunk(task, body, problem, chunk, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! a copy of the model's; left as that of the last case
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
      type(contact_problem_t), intent(inout) :: problem !! a copy of the model's; left as that of the last case
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
      type(contact_problem_t), intent(inout) :: problem !! a copy of the model's; left as that of the last case
      type(chunk_t), intent(inout) :: chunk !! the chunk; gains what became of the cases
      logical, intent(in) :: is_needed(chunk_length) !! which cases are solved
      type(contact_solution_t), intent(inout) :: solutions(chunk_length) !! their solutions
      integer :: i, number, neighbor

      do i = 1, chunk%last - chunk%first + 1
         if (.not. is_needed(i)) cycle
         number = chunk%first + i - 1
         neighbor = task%sweep%neighbor(number) - chunk%first + 1
         call task%model%set_case(problem, task%sweep%values(number))
         if (neighbor >= 1) solutions(i) = solutions(neighbor)
         call solve_one(task, body, number, problem, solutions(i), chunk%results(i))
      end do
   end subroutine solve_cases

   !> Finds the numbers of all cases of a chunk.
   subroutine find_numbers(task, body, chunk, solutions)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      type(chunk_t), intent(inout) :: chunk !! the chunk, its cases solved; their results gain the numbers
      type(contact_solution_t), intent(in) :: solutions(chunk_length) !! their solutions
      type(quantity_t), allocatable :: peaks(:, :)
      integer :: i

      call find_body_results(peaks, task, body, chunk, solutions)
      do i = 1, chunk%last - chunk%first + 1
         associate (kept => chunk%results(i), model => task%model)
            if (kept%outcome == case_no_equilibrium) then
               kept%quantity = spread(0.0_dp, 1, task%n_quantities)
            else
               call set_numbers(kept, body, solutions(i), model%fixed%friction + matmul(model%friction, &
                  task%sweep%values(chunk%first + i - 1)), model%fixed%slip_bound, model%problem%gap, peaks(:, i))
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
      type(quantity_t), allocatable :: found(:, :)
      real(dp), allocatable :: values(:, :), displacement(:, :)
      integer, allocatable :: cases(:)
      integer :: i, n

      n = chunk%last - chunk%first + 1
      peaks = spread(body_peaks_at_rest(), 2, n)
      if (.not. task%sweep%has_body_results) then
         peaks = peaks(:0, :)
         return
      end if
      cases = [(i, i=1, n)]
      cases = pack(cases, chunk%results(:n)%outcome /= case_no_equilibrium .and. &
         solutions(:n)%residual < huge(1.0_dp))
      allocate (values(size(task%sweep%axes), size(cases)), displacement(2*body%zone%n_points, size(cases)))
      do i = 1, size(cases)
         values(:, i) = task%sweep%values(chunk%first + cases(i) - 1)
         displacement(:, i) = solutions(cases(i))%displacement
      end do
      call find_peaks(found, body, task%model, values, displacement)
      do i = 1, size(cases)
         peaks(:, cases(i)) = found(:, i)
      end do
   end subroutine find_body_results

   !> Solves one case: where the deck leaves the method to the program, by Newton from the neighbor's solution, whose
   !> statuses are nearly right; otherwise, and where that fails, from rest as the deck by itself would be.
   subroutine solve_one(task, body, number, problem, solution, kept)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the case
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(contact_solution_t), intent(inout) :: solution !! its neighbor's, which may be without; its own on return
      type(case_result_t), intent(out) :: kept !! what is kept of it
      integer, parameter :: n_newton_steps = 8
      type(newton_t) :: newton
      real(dp), allocatable :: amounts(:)
      type(error_t), allocatable :: error
      integer, allocatable :: reached(:)
      integer :: n_iterations
      logical :: is_solved, has_equilibrium

      n_iterations = 0
      is_solved = .false.
      ! A body that nothing loads stays at rest; from elsewhere, rounding would choose its statuses.
      if (task%is_auto .and. solution%is_converged .and. any(abs(problem%load) > 0.0_dp)) then
         newton%tolerance = task%method%tolerance
         newton%max_iterations = min(n_newton_steps, task%method%max_iterations)
         call newton%solve(problem, solution, error)
         n_iterations = solution%n_iterations
         is_solved = solution%is_converged
      end if
      has_equilibrium = .true.
      if (.not. is_solved) call solve_from_rest(task, body, number, problem, solution, has_equilibrium)
      if (has_equilibrium) then
         call find_spin(amounts, body, task%model%fixed%is_in_reach, problem, solution)
         has_equilibrium = .not. allocated(amounts)
      end if
      if (.not. has_equilibrium) then
         solution%is_converged = .false.
         kept%outcome = case_no_equilibrium
         kept%n_iterations = n_iterations
         return
      end if
      if (solution%is_converged) kept%outcome = case_converged
      kept%residual = solution%residual
      kept%force_error = force_error(problem, solution, &
         task%model%largest_force(task%sweep%values(number)))
      kept%n_iterations = solution%n_iterations + merge(0, n_iterations, is_solved)
      if (.not. solution%is_converged) return
      associate (fixed => task%model%fixed)
         call find_case_warnings(kept%is_warned, body, task%model%size_of_body, fixed%contacts, fixed%gap, solution)
         ! What lies beyond an end of a set bears no force: that of the end is in doubt.
         reached = body%free_boundary%reached_ends(fixed%contacts, body%mesh%coordinates, fixed%gap, solution%status)
         kept%force_error = max(kept%force_error, max(0.0_dp, maxval(solution%force( &
            body%free_boundary%ends(reached)%point)))/max(maxval(solution%force), tiny(1.0_dp)))
      end associate
   end subroutine solve_one

   !> Solves a case from rest, if the loads have an equilibrium.
   subroutine solve_from_rest(task, body, number, problem, solution, has_equilibrium)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the case
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(contact_solution_t), intent(out) :: solution !! its solution
      logical, intent(out) :: has_equilibrium !! whether contact and friction can balance the loads
      type(error_t), allocatable :: error

      call new_contact_solution(solution, problem%n_points)
      ! Threads cannot make the texts of errors side by side, see `amontons_sweep_table`.
      !$omp critical
      call check_balance_of(task, body, number, error)
      !$omp end critical
      has_equilibrium = .not. allocated(error)
      if (.not. has_equilibrium) return
      call task%method%solve(problem, solution, error)
      if (allocated(error)) solution%is_converged = .false.
   end subroutine solve_from_rest

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

   !> Whether contact forces can balance the loads of a case.
   pure subroutine check_balance_of(task, body, number, error)
      type(sweep_task_t), intent(in) :: task !! the sweep
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: number !! number of the case
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium
      type(load_case_t) :: load_case

      call task%model%load_case(task%sweep%values(number), load_case)
      call check_balance(body, load_case, error)
   end subroutine check_balance_of

end module amontons_sweep_chunk
