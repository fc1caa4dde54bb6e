!> The study of a single case on its mesh and on uniformly refined ones: the files are those of the finest mesh, its key
!> results with observed order, extrapolated value and error bar.
module amontons_refinement_study
   use amontons_config, only: config_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_convergence, only: new_convergence, refined_quantity_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_outcome, only: outcome_t
   use amontons_quantity, only: quantity_t
   use amontons_result, only: result_t
   use amontons_single_study, only: report_case, single_study_t
   use amontons_solve_case, only: cache_t, solve_case
   use amontons_study, only: study_options_t
   use amontons_study_monitor, only: study_monitor_t
   implicit none (type, external)
   private

   public :: refinement_study_t

   !> The study of a single case on refined meshes.
   type, extends(single_study_t) :: refinement_study_t
   contains
      procedure :: solve => refinement_study_solve
   end type refinement_study_t

   !> The numbers of a result on one mesh.
   type :: level_t
      type(quantity_t), allocatable :: quantities(:) !! the numbers, of every mesh in the same order
   end type level_t

contains

   !> Solves the case on every mesh, the coarsest first, and writes the files of the finest.
   subroutine refinement_study_solve(self, cache, options, monitor, outcome, error)
      class(refinement_study_t), intent(in) :: self !! the study
      type(cache_t), intent(inout) :: cache !! the body at hand, replaced by that of the finest mesh
      type(study_options_t), intent(in) :: options !! what is asked for besides the deck
      class(study_monitor_t), intent(inout) :: monitor !! not used: a mesh is not interrupted
      type(outcome_t), intent(inout) :: outcome !! gains status, line, what the solution lacks, and the warnings
      type(error_t), allocatable, intent(out) :: error !! the case cannot be solved, or its files not be written
      type(config_t) :: config
      type(result_t) :: result
      type(level_t), allocatable :: levels(:)
      integer :: level

      config = self%config
      allocate (levels(0:self%config%accuracy%n_refinements))
      do level = 0, self%config%accuracy%n_refinements
         config%meshes%n_refinements = self%config%meshes%n_refinements + level
         call solve_case(cache, config, result, error)
         if (allocated(error)) exit
         ! A mesh without a solution is the last one: the files say so.
         if (.not. result%solution%is_converged) exit
         cache%is_refining = .true.
         associate (energies => result%certificate%energies())
            levels(level)%quantities = [result%lengths%quantities(), result%key_results, energies(:1)]
         end associate
      end do
      cache%is_refining = .false.
      if (level > self%config%accuracy%n_refinements) call compare_levels(result, cache%body%zone, levels)
      ! The files are those of a case on the last mesh.
      config%accuracy%n_refinements = 0
      call report_case(config, cache, options, result, outcome, error)
      associate (unused => monitor)
      end associate
   end subroutine refinement_study_solve

   !> Judges how each number changes from mesh to mesh.
   pure subroutine compare_levels(result, zone, levels)
      type(result_t), intent(inout) :: result !! the result on the finest mesh; gains the judgments
      type(contact_zone_t), intent(in) :: zone !! its contact points
      type(level_t), intent(in) :: levels(:) !! the numbers on every mesh
      ! Residuals of the contact problem are at most 1e-10 of the largest force; ten times that and more is left of it.
      real(dp), parameter :: rounding = 1.0e-8_dp
      real(dp) :: values(size(levels)), side
      integer :: i, level

      side = side_at_ends(zone, result%solution%status)
      associate (last => levels(size(levels))%quantities)
         allocate (result%convergence(size(last)))
         do i = 1, size(last)
            values = [(levels(level)%quantities(i)%value, level=1, size(levels))]
            result%convergence(i)%quantity = last(i)
            call new_convergence(result%convergence(i)%convergence, values, last(i)%resolution*side, &
               rounding*max(maxval(abs(values)), last(i)%scale))
         end do
      end associate
   end subroutine compare_levels

   !> The longest side beside an end of a zone, where one status follows another; of the whole line, if none does [L].
   !> Points within a quadratic side count for their share of it.
   pure real(dp) function side_at_ends(zone, status) result(side)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: status(:) !! their statuses (m)
      integer :: p

      side = 0.0_dp
      do p = 1, zone%n_points
         if (zone%next(p) == 0) cycle
         if (status(p) /= status(zone%next(p))) side = max(side, zone%weight(p), zone%weight(zone%next(p)))
      end do
      if (side <= 0.0_dp .and. zone%n_points > 0) side = maxval(zone%weight)
   end function side_at_ends

end module amontons_refinement_study
