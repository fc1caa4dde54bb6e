!> The way of a case from its configuration to its result. Cases that share a body share its factorization, and
!> one hands the state of its contact points to the next, one mesh to a finer one.
module amontons_solve_case
   use amontons_body, only: body_t, condense_body, new_body
   use amontons_case_error, only: prepare_estimates
   use amontons_config, only: body_text, check_names, config_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_contact_zone, only: contact_zone_t
   use amontons_equilibrium, only: check_balance
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_case, only: new_load_case
   use amontons_mesh, only: mesh_t
   use amontons_mesh_file, only: new_mesh
   use amontons_model_warnings, only: add_model_warnings
   use amontons_outcome_words, only: outcome_no_equilibrium
   use amontons_result, only: result_t
   use amontons_solve_load_case, only: solve_load_case
   use amontons_terminal, only: new_timings, phase_condense, phase_recover
   use amontons_uniqueness, only: uniqueness_t
   implicit none (type, external)
   private

   public :: cache_t, condense_case, prepare_case, prepare_single_case, solve_case

   !> Where a case ended: where the next case of the same body starts.
   type :: state_t
      character(:), allocatable :: case_name !! name of the case whose state it is
      type(contact_solution_t) :: solution !! its solution
      type(uniqueness_t) :: uniqueness !! the friction below which it is the only one
      integer, allocatable :: set(:) !! which contact set each point belongs to (m)
      real(dp), allocatable :: position(:, :) !! coordinates of the points (2, m) [L]
      real(dp), allocatable :: area(:) !! their tributary areas (m) [L^2]
   contains
      procedure :: prolong => state_prolong
   end type state_t

   !> The body at hand, for the cases of a run that share it.
   type :: cache_t
      character(:), allocatable :: key !! the deck text that the body was made from
      type(body_t), allocatable :: body !! the body
      character(:), allocatable :: first_case !! the case that the body was made for
      logical :: is_condensed = .false. !! whether the body is factorized
      type(contact_problem_t) :: problem !! its contact problem, once it is condensed
      type(state_t), allocatable :: state !! where the last case of this body ended; not allocated before the first
      logical :: is_refining = .false. !! whether the next body is the one at hand on a finer mesh, and keeps its state
   end type cache_t

contains

   !> Makes the body, the obstacles and the loads of a case ready, everything that its deck can get wrong.
   subroutine prepare_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! gains the load case, and the warnings on the model
      type(error_t), allocatable, intent(out) :: error !! mesh, sets, supports, contacts or loads are at fault

      call new_timings(result%timings)
      result%warnings%units = config%units
      result%wants_error_estimate = config%accuracy%wants_estimate()
      result%method = config%method
      if (has_body(cache, config)) then
         call check_names(config, cache%body%mesh, error)
      else
         call make_body(cache, config, error)
      end if
      if (allocated(error)) return
      call new_load_case(result%load_case, cache%body, config%supports, config%contacts, config%loads, error)
      if (.not. allocated(error)) call add_model_warnings(result%warnings, cache%body, result%load_case)
   end subroutine prepare_case

   !> Makes the body of a case.
   subroutine make_body(cache, config, error)
      type(cache_t), intent(inout) :: cache !! gains the body
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(out) :: error !! mesh, sets, supports or contacts are at fault
      type(mesh_t) :: mesh
      character(:), allocatable :: notes

      if (allocated(cache%body)) deallocate (cache%body)
      ! A body that cannot be made must not pass for the one before it.
      cache%key = ''
      cache%is_condensed = .false.
      allocate (cache%body)
      call new_mesh(mesh, config%meshes, notes, error)
      if (.not. allocated(error)) call check_names(config, mesh, error)
      if (allocated(error)) return
      call new_body(cache%body, mesh, config%materials, config%supports, config%contacts, error, config%ties)
      if (allocated(error)) return
      cache%body%mesh_notes = notes
      cache%key = body_text(config)
      cache%first_case = config%name
      if (allocated(cache%state) .and. .not. cache%is_refining) deallocate (cache%state)
   end subroutine make_body

   !> Whether the body at hand is that of a case.
   logical function has_body(cache, config)
      type(cache_t), intent(in) :: cache !! the body at hand
      type(config_t), intent(in) :: config !! the case

      has_body = allocated(cache%body) .and. allocated(cache%key)
      if (has_body) has_body = cache%key == body_text(config)
   end function has_body

   !> Makes a single case ready, and finds out whether its loads have an equilibrium before anything is factorized.
   subroutine prepare_single_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! gains the load case, the warnings, and that there is no equilibrium
      type(error_t), allocatable, intent(out) :: error !! mesh, sets, supports, contacts or loads are at fault
      type(error_t), allocatable :: lack

      call prepare_case(cache, config, result, error)
      if (allocated(error)) return
      call check_balance(cache%body, result%load_case, lack)
      if (.not. allocated(lack)) return
      result%outcome = outcome_no_equilibrium
      result%answer = lack%message
   end subroutine prepare_single_case

   !> Solves a single case. That there is no equilibrium is its outcome, not an error.
   subroutine solve_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the deck or the numbers are at fault

      call prepare_single_case(cache, config, result, error)
      if (allocated(error) .or. result%outcome == outcome_no_equilibrium) return
      call condense_case(cache, config, result, error)
      if (allocated(error)) return
      call start_solution(cache, result)
      call solve_load_case(result, cache%body, cache%problem, error)
      if (allocated(error)) return
      if (.not. result%solution%is_converged) return
      if (.not. allocated(cache%state)) allocate (cache%state)
      associate (state => cache%state, zone => cache%body%zone)
         state%case_name = config%name
         state%solution = result%solution
         state%uniqueness = result%uniqueness
         state%set = zone%set
         state%position = zone%position
         state%area = zone%area
      end associate
   end subroutine solve_case

   !> Factorizes and condenses the body, and makes what estimates of its error share, unless an earlier case did.
   subroutine condense_case(cache, config, result, error)
      type(cache_t), intent(inout) :: cache !! the body at hand
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(inout) :: result !! gains the times, and the case whose factorization it shares
      type(error_t), allocatable, intent(out) :: error !! the body is not held, or its stiffness is degenerate

      if (cache%is_condensed) then
         result%shared_with = cache%first_case
      else
         call condense_body(cache%body, cache%problem, config%condensation, result%timings, error)
         cache%is_condensed = .not. allocated(error)
      end if
      if (allocated(error) .or. .not. config%accuracy%wants_estimate()) return
      call result%timings%begin(phase_recover)
      call prepare_estimates(cache%body)
      call result%timings%begin(phase_condense)
   end subroutine condense_case

   !> Starts from where the last case of the same body ended, on a coarser mesh where this one is refined, or from rest.
   subroutine start_solution(cache, result)
      type(cache_t), intent(in) :: cache !! the body at hand
      type(result_t), intent(inout) :: result !! the result, its solution set to the start

      if (cache%is_refining .and. allocated(cache%state)) then
         call cache%state%prolong(result%solution, cache%body%zone)
      else if (allocated(cache%state)) then
         result%solution = cache%state%solution
         result%uniqueness = cache%state%uniqueness
         result%started_from = cache%state%case_name
      else
         call new_contact_solution(result%solution, cache%body%zone%n_points)
      end if
   end subroutine start_solution

   !> A solution that starts from this state on another mesh of the same body: stresses and displacements of a point are
   !> linear between the two points of the state that are nearest in its set.
   pure subroutine state_prolong(self, solution, zone)
      class(state_t), intent(in) :: self !! the state
      type(contact_solution_t), intent(out) :: solution !! the solution
      type(contact_zone_t), intent(in) :: zone !! the contact points of the other mesh
      real(dp) :: distance(size(self%set)), share(2)
      integer :: nearest(2), m, n, p, k

      m = size(self%set)
      n = zone%n_points
      call new_contact_solution(solution, n)
      do p = 1, n
         distance = merge(hypot(self%position(1, :) - zone%position(1, p), self%position(2, :) - zone%position(2, p)), &
            huge(1.0_dp), self%set == zone%set(p))
         if (.not. any(self%set == zone%set(p))) cycle
         do k = 1, 2
            nearest(k) = minloc(distance, dim=1)
            share(3 - k) = distance(nearest(k))
            distance(nearest(k)) = huge(1.0_dp)
         end do
         ! A state of one point alone has no second one: its distance is that of other sets.
         share = share/sum(share)
         do k = 1, 2
            associate (q => nearest(k))
               solution%displacement([p, n + p]) = solution%displacement([p, n + p]) &
                  + share(k)*self%solution%displacement([q, m + q])
               if (self%area(q) > 0.0_dp) solution%force([p, n + p]) = solution%force([p, n + p]) &
                  + share(k)*zone%area(p)/self%area(q)*self%solution%force([q, m + q])
            end associate
         end do
         solution%status(p) = self%solution%status(nearest(1))
      end do
   end subroutine state_prolong

end module amontons_solve_case
