!> The result of a case: its outcome, with the word that all files use, and everything that the reports contain; and the
!> numbers of a result on successively refined meshes: their selection and their convergence, which is observed order,
!> extrapolated value and error bar.
!>
!> The bar is the grid convergence index of Roache (J. Fluids Eng. 116, 1994; ASME V&V 20), not as a ratio, with his
!> factors of safety: 1.25 if three meshes show an order of convergence, otherwise 3.
module amontons_result
   use amontons_body, only: body_t
   use amontons_certificate, only: certificate_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_document, only: document_t
   use amontons_error, only: error_t, warning_list_t
   use amontons_key_results, only: interval_t, lengths_t
   use amontons_kinds, only: dp, int64
   use amontons_load_family, only: load_case_t
   use amontons_loads, only: add_point_forces, load_on_nodes
   use amontons_methods, only: method_options_t
   use amontons_pose, only: pose_t
   use amontons_quantity, only: quantity_t
   use amontons_rounding, only: result_rounding
   use amontons_stress_field, only: error_estimate_t, stress_field_t
   use amontons_terminal, only: timings_t
   use amontons_text, only: vector_text
   use amontons_uniqueness, only: all_solutions_t, uniqueness_t
   implicit none (type, external)
   private

   public :: certificate_limit, convergence_t, factor_t, has_bar, has_converged, judge_meshes, new_convergence, &
      outcome_names, outcome_word, refined_quantities, refined_quantity_t, result_t, solution_word, &
      status_not_converged, verdict_names

   !> Behavior of the values on the last three meshes.
   character(11), parameter :: verdict_names(*) = [character(11) :: 'converging', 'slow', 'oscillating', 'diverging', &
      'unchanged', 'absent']
   integer, parameter :: converging = 1, slow = 2, oscillating = 3, diverging = 4, unchanged = 5, absent = 6

   !> A number on meshes each of which halves the sides of the one before.
   type :: convergence_t
      real(dp), allocatable :: value(:) !! its values, on the coarsest mesh first
      integer :: verdict = unchanged !! place in `verdict_names`
      real(dp) :: order = 0.0_dp !! observed order of convergence; 0 where there is none [-]
      real(dp) :: extrapolated = 0.0_dp !! Richardson's extrapolation; the last value where there is no order
      real(dp) :: bar = 0.0_dp !! half width of the error bar around the last value, if it has one, see `has_bar`
   end type convergence_t

   !> A number of a result on refined meshes.
   type :: refined_quantity_t
      type(quantity_t) :: quantity !! the number on the finest mesh
      type(convergence_t) :: convergence !! its convergence over the meshes
   end type refined_quantity_t

   !> Outcome of a load case: the residual is at most the tolerance.
   integer, parameter, public :: outcome_solved = 1
   !> Outcome of a load case: the residual stayed above the tolerance.
   integer, parameter, public :: outcome_not_converged = 2
   !> Outcome of a load case: contact and friction cannot balance the loads.
   integer, parameter, public :: outcome_no_equilibrium = 3
   !> Outcome of a load case: its numbers are not finite, or have no correct digit.
   integer, parameter, public :: outcome_numbers = 4

   !> Word for a solution: the residual is at most the tolerance, and the certificate, if there is one, passes.
   character(*), parameter, public :: word_solved = 'solved'
   !> Word for no equilibrium: contact and friction cannot balance the loads.
   character(*), parameter, public :: word_no_equilibrium = 'no_equilibrium'
   !> Word for no convergence: the residual is above the tolerance, or a step of a history cannot be taken.
   character(*), parameter, public :: word_not_converged = 'not_converged'
   !> Word for a failed certificate: the method converged, but a violation is above its limit.
   character(*), parameter, public :: word_not_certified = 'not_certified'

   !> Word for a numerical failure: numbers are not finite, or have no correct digit.
   character(*), parameter, public :: word_numerical_failure = 'numerical_failure'

   !> Words for the outcomes in result files.
   character(17), parameter :: outcome_names(4) = [character(17) :: word_solved, word_not_converged, &
      word_no_equilibrium, word_numerical_failure]

   !> Exit status of a case that did not converge, or whose certificate failed; the others are the kinds of
   !> `amontons_error`.
   integer, parameter :: status_not_converged = 4

   !> Index of the depth worn among the columns of `slip_record`.
   integer, parameter, public :: depth_worn = 5

   !> The factorization of the body.
   type :: factor_t
      character(:), allocatable :: name !! its name
      integer(int64) :: n_entries = 0_int64 !! stored entries
      real(dp) :: n_flops = 0.0_dp !! floating-point operations it took
   end type factor_t

   !> Solution, certificate and record of a case.
   type :: result_t
      type(contact_solution_t) :: solution !! forces, displacements and statuses of the contact points
      type(method_options_t) :: method !! the contact method and its options
      type(load_case_t) :: load_case !! loads, prescribed displacements, obstacles and friction
      real(dp), allocatable :: displacement(:, :) !! displacement of all nodes (components, n_nodes) [L]
      type(pose_t), allocatable :: poses(:) !! poses of the pieces that turn far; not allocated without them
      type(stress_field_t) :: stress !! stresses of the body, of the displacements
      type(certificate_t) :: certificate !! violations on the full model
      type(warning_list_t) :: warnings !! warnings on the model and the result
      integer :: outcome = outcome_not_converged
         !! the outcome, or that of the next step of a history that ended early
      real(dp) :: condition = 0.0_dp
         !! condition number of the stiffness in the 1-norm, estimated where rounding shows; else 0 [-]
      type(uniqueness_t) :: uniqueness !! the friction below which the solution is the only one
      type(all_solutions_t), allocatable :: all_solutions !! all solutions, where they were asked for
      logical :: has_reduced_files = .false. !! whether its reduced problem was written
      logical :: wants_error_estimate = .false. !! whether the error of the stresses is to be estimated
      type(error_estimate_t), allocatable :: error_estimate !! the estimate, where it is wanted
      type(refined_quantity_t), allocatable :: convergence(:) !! its numbers on refined meshes, where asked for
      type(quantity_t), allocatable :: key_results(:) !! largest values with their places, and what contact sets carry
      type(interval_t), allocatable :: closed(:) !! the closed parts of the contact line
      type(interval_t), allocatable :: stuck(:) !! its parts that stick
      type(lengths_t) :: lengths !! lengths of the open, slip and stick zones
      real(dp) :: method_error = -1.0_dp
         !! largest difference of a contact force from the exact solution, over the largest force; -1 if not asked [-]
      real(dp), allocatable :: slip_record(:, :)
         !! of a load history: slip of its last step [L], accumulated slip [L], dissipation [F L], the integral of the
         !! pressure over the slip [F/L] and the depth worn [L] of each point; parameters of fretting where they are
         !! asked for (m, 5 or 10)
      type(quantity_t), allocatable :: history_results(:)
         !! of a load history: its works, its last cycle, the extremes of its steps
      logical :: is_complete = .true. !! whether a study of several steps has come to its end
      character(:), allocatable :: answer
         !! why there is no state to show: no equilibrium, or a first step of a history that did not converge
      real(dp) :: earlier_violation = 0.0_dp
         !! largest violation of the certificates of earlier steps of a study of several [-]
      type(document_t) :: study_listing !! section of the listing on a study of several steps; empty for others
      type(document_t) :: study_members !! members of such a study in the summary
      character(:), allocatable :: shared_with !! the case whose factorization was used; not allocated for an own one
      character(:), allocatable :: started_from !! the case whose solution was the start; not allocated for a cold start
      type(factor_t) :: factor !! the factorization in use
      type(timings_t) :: timings !! times of the phases
   end type result_t

contains

   !> Judges the last three of the values of a number.
   !>
   !> Differences between successive meshes that fall by 2^p have the order p. The error bar assumes no order above 1,
   !> that of the stresses at the end of a contact: as an end lies anywhere between two nodes, a small last difference
   !> may be chance, and the one before it counts as well. An order below 0.5 is that of a singular solution: the number
   !> may have no limit. A number that a mesh cannot resolve, such as a length between nodes, changes by at least a
   !> side; the bar is not smaller. A number that is rounding on all three meshes, such as a slip if no point slips or
   !> the friction of a single point that is held, says nothing about a finer mesh: it is absent and has no bar.
   pure subroutine new_convergence(convergence, value, resolution, rounding)
      type(convergence_t), intent(out) :: convergence !! the judgment
      real(dp), intent(in) :: value(:) !! the values, three at the least, the coarsest mesh first
      real(dp), intent(in) :: resolution !! the smallest change that the last mesh can show; 0 if it shows any
      real(dp), intent(in) :: rounding !! change that is rounding
      real(dp), parameter :: least_order = 0.5_dp, most_order = 1.0_dp
      real(dp), parameter :: safety = 1.25_dp, large_safety = 3.0_dp
      real(dp) :: before, last

      convergence%value = value
      convergence%extrapolated = value(size(value))
      before = value(size(value) - 1) - value(size(value) - 2)
      last = value(size(value)) - value(size(value) - 1)
      convergence%verdict = verdict(before, last, rounding)
      if (all(abs(value(size(value) - 2:)) <= rounding)) convergence%verdict = absent
      select case (convergence%verdict)
      case (absent)
         return
      case (unchanged)
         convergence%bar = max(abs(before), rounding)
      case (oscillating)
         convergence%bar = max(abs(before), large_safety*abs(last))
      case (diverging)
         convergence%bar = large_safety*max(abs(before), abs(last))/(2.0_dp**least_order - 1.0_dp)
      case default
         convergence%order = log(before/last)/log(2.0_dp)
         convergence%extrapolated = value(size(value)) + last/(2.0_dp**convergence%order - 1.0_dp)
         if (convergence%order < least_order) then
            convergence%verdict = slow
            convergence%bar = large_safety*abs(last)/(2.0_dp**convergence%order - 1.0_dp)
         else
            convergence%bar = safety*max(abs(last), abs(before)/2.0_dp**most_order) &
               /(2.0_dp**min(convergence%order, most_order) - 1.0_dp)
         end if
      end select
      convergence%bar = max(convergence%bar, resolution)
   end subroutine new_convergence

   !> Whether a number that was found on several meshes has an error bar.
   elemental logical function has_bar(convergence)
      type(convergence_t), intent(in) :: convergence !! the judgment

      has_bar = convergence%verdict /= absent
   end function has_bar

   !> The behavior that two successive changes indicate; slow convergence counts as convergence.
   pure integer function verdict(before, last, rounding)
      real(dp), intent(in) :: before !! change from the last mesh but two to the last but one
      real(dp), intent(in) :: last !! change from the last mesh but one to the last
      real(dp), intent(in) :: rounding !! change that is rounding

      if (abs(last) <= rounding) then
         verdict = unchanged
      else if (before*last < 0.0_dp .and. abs(before) > rounding) then
         verdict = oscillating
      else if (abs(last) >= abs(before)) then
         verdict = diverging
      else
         verdict = converging
      end if
   end function verdict

   !> The outcome of a solution, as a word of summaries and tables.
   pure function solution_word(is_converged, is_certified) result(word)
      logical, intent(in) :: is_converged !! whether the residual is at most the tolerance
      logical, intent(in) :: is_certified !! whether no violation of its certificate is above the limit
      character(:), allocatable :: word

      if (.not. is_converged) then
         word = word_not_converged
      else if (.not. is_certified) then
         word = word_not_certified
      else
         word = word_solved
      end if
   end function solution_word

   !> Whether a word means that the residual is at most the tolerance.
   pure logical function has_converged(word)
      character(*), intent(in) :: word !! the word

      has_converged = word == word_solved .or. word == word_not_certified
   end function has_converged

   !> The limit of all violations of a certificate, for a tolerance of the contact method [-].
   !>
   !> It is a hundred times the tolerance, since a residual of the small problem may be larger on the full model, and at
   !> least 1e-8, the rounding of a large model.
   pure real(dp) function certificate_limit(tolerance)
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]

      certificate_limit = max(1.0e-8_dp, 100.0_dp*tolerance)
   end function certificate_limit

   !> The outcome of a case, as a word of summaries and tables.
   pure function outcome_word(result) result(word)
      type(result_t), intent(in) :: result !! its result
      character(:), allocatable :: word

      if (any(result%outcome == [outcome_no_equilibrium, outcome_numbers])) then
         word = trim(outcome_names(result%outcome))
      else
         word = solution_word(result%solution%is_converged .and. result%is_complete, &
            max(result%certificate%largest(), result%earlier_violation) <= certificate_limit(result%method%tolerance))
      end if
   end function outcome_word

   !> The numbers of a result that are compared over refined meshes.
   pure function refined_quantities(result) result(list)
      type(result_t), intent(in) :: result !! the result on one of the meshes
      type(quantity_t), allocatable :: list(:)

      associate (energies => result%certificate%energies())
         list = [result%lengths%quantities(), result%key_results, energies(:1)]
      end associate
      if (allocated(result%history_results)) list = [list, result%history_results]
   end function refined_quantities

   !> Judges the convergence of each number over the meshes. At a point force a continuum has neither a finite stress
   !> nor a finite displacement: the largest one there grows with every mesh.
   subroutine judge_meshes(result, body, values)
      type(result_t), intent(inout) :: result !! the result on the finest mesh; gains the judgments, and a warning
      type(body_t), intent(in) :: body !! its body
      real(dp), intent(in) :: values(:, :) !! `refined_quantities` of each mesh, a column for a mesh, the coarsest first
      type(quantity_t), allocatable :: list(:)
      type(error_t), allocatable :: error
      character(:), allocatable :: names
      logical :: is_beside(body%mesh%n_nodes)
      real(dp) :: side, forces(2, body%mesh%n_nodes)
      integer, allocatable :: ends(:, :)
      integer :: i, node

      forces = 0.0_dp
      do i = 1, size(result%load_case%loads)
         if (result%load_case%loads(i)%target == load_on_nodes) call add_point_forces(forces, body%mesh, &
            body%materials, result%load_case%loads(i), error)
      end do
      is_beside = .false.
      do i = 1, body%mesh%n_elements
         associate (nodes => body%mesh%node(body%mesh%node_start(i):body%mesh%node_start(i + 1) - 1))
            if (any(abs(forces(:, nodes)) > 0.0_dp)) is_beside(nodes) = .true.
         end associate
      end do
      names = ''
      ! The longest side at an end of a zone, where the status changes; of the whole line if there is no end. A part of
      ! a quadratic side between two points counts as its share of the side.
      side = 0.0_dp
      allocate (ends(2, 0))
      associate (zone => body%zone, status => result%solution%status)
         if (allocated(zone%line)) ends = zone%line%segments()
         do i = 1, size(ends, 2)
            if (status(ends(1, i)) /= status(ends(2, i))) side = max(side, maxval(zone%weight(ends(:, i))))
         end do
         if (side <= 0.0_dp .and. zone%n_points > 0) side = maxval(zone%weight)
      end associate
      list = refined_quantities(result)
      allocate (result%convergence(size(list)))
      do i = 1, size(list)
         result%convergence(i)%quantity = list(i)
         call new_convergence(result%convergence(i)%convergence, values(i, :), list(i)%resolution*side, &
            result_rounding*max(maxval(abs(values(i, :))), list(i)%scale))
         if (list(i)%n_dim == 0 .or. all(result%convergence(i)%convergence%verdict /= [slow, diverging])) cycle
         node = body%mesh%nearest_node(list(i)%place(:list(i)%n_dim))
         if (any(is_beside(max(1, node):node))) names = names//', '//trim(list(i)%label)//' at '// &
            vector_text(list(i)%place(:list(i)%n_dim))
      end do
      if (len(names) > 0) call result%warnings%add('numbers that have no limit as the mesh is refined are found '// &
         'where a point force acts: '//names(3:)//'; spread it over a set, by traction or total_force')
   end subroutine judge_meshes

end module amontons_result
