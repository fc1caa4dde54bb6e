!> The key results of the whole body of cases of a sweep. Several cases at a time share a pass over the factor and the
!> shape functions of each element.
module amontons_sweep_peaks
   use amontons_body, only: body_t
   use amontons_condensation, only: condensed_load_t
   use amontons_key_results, only: body_peaks, body_peaks_at_rest
   use amontons_kinds, only: dp
   use amontons_load_case, only: recover_displacements
   use amontons_quantity, only: quantity_t
   use amontons_stress_field, only: find_node_stresses
   use amontons_sweep_model, only: sweep_model_t
   implicit none (type, external)
   private

   public :: find_peaks

   !> How many cases are worked on together: fields of more take much memory beside a factor, and gain little.
   integer, parameter :: n_together = 4

contains

   !> Finds the key results of the body of some cases.
   subroutine find_peaks(peaks, body, model, values, displacement)
      type(quantity_t), allocatable, intent(out) :: peaks(:, :) !! `body_peaks` of each case (quantities, cases)
      type(body_t), intent(in) :: body !! the body, condensed
      type(sweep_model_t), intent(in) :: model !! the contact problems of the sweep
      real(dp), intent(in) :: values(:, :) !! value of each quantity of each case (quantities, cases) [-]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the contact points of each case (2m, cases) [L]
      integer :: first, last

      allocate (peaks(size(body_peaks_at_rest()), size(values, 2)))
      do first = 1, size(values, 2), n_together
         last = min(size(values, 2), first + n_together - 1)
         call find_peaks_together(peaks(:, first:last), body, model, values(:, first:last), &
            displacement(:, first:last))
      end do
   end subroutine find_peaks

   !> Finds the key results of the body of a few cases at once.
   subroutine find_peaks_together(peaks, body, model, values, displacement)
      type(quantity_t), intent(out) :: peaks(:, :) !! `body_peaks` of each case (quantities, cases)
      type(body_t), intent(in) :: body !! the body, condensed
      type(sweep_model_t), intent(in) :: model !! the contact problems of the sweep
      real(dp), intent(in) :: values(:, :) !! value of each quantity of each case (quantities, cases) [-]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the contact points of each case (2m, cases) [L]
      type(condensed_load_t) :: condensed(size(values, 2))
      real(dp), allocatable :: field(:, :, :), stress(:, :, :), strain(:), strains(:, :)
      integer :: k

      do k = 1, size(condensed)
         call model%condense(values(:, k), condensed(k))
         call model%sum_thermal_strain(values(:, k), strain)
         if (.not. allocated(strain)) cycle
         if (.not. allocated(strains)) allocate (strains(size(strain), size(condensed)))
         strains(:, k) = strain
      end do
      call recover_displacements(field, body, model%fixed, condensed, displacement)
      allocate (stress(4, body%mesh%n_nodes, size(condensed)))
      call find_node_stresses(stress, size(condensed), body%mesh, body%materials, body%coloring, field, strains)
      do k = 1, size(condensed)
         peaks(:, k) = body_peaks(body%mesh, field(:, :, k), stress(:, :, k))
      end do
   end subroutine find_peaks_together

end module amontons_sweep_peaks
