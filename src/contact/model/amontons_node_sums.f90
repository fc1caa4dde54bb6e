!> Forces on the nodes of a body and their work, summed up: what the certificate needs of them, with one pass over all.
module amontons_node_sums
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: node_sums_t, norm_of, sum_nodes, binary_scale

   !> Forces and their work, summed up over the nodes.
   type :: node_sums_t
      real(dp) :: largest_load = 0.0_dp !! largest component of a nodal load [F]
      real(dp) :: largest_contact = 0.0_dp !! of a contact force [F]
      real(dp) :: largest_reaction = 0.0_dp !! of a reaction [F]
      real(dp) :: load(2) = 0.0_dp !! resultant of the loads [F]
      real(dp) :: contact(2) = 0.0_dp !! of the contact forces [F]
      real(dp) :: reaction(2) = 0.0_dp !! of the reactions of supports and springs [F]
      real(dp) :: forces = 0.0_dp !! magnitudes of all these, components taken singly: the scale of resultants [F]
      real(dp) :: springs = 0.0_dp !! magnitudes of the forces of the springs [F]
      real(dp) :: internal_work = 0.0_dp !! work of the internal forces [F L]
      real(dp) :: internal_size = 0.0_dp !! sum of its magnitudes [F L]
      real(dp) :: external_work = 0.0_dp !! work of loads and contact forces [F L]
      real(dp) :: support_work = 0.0_dp !! of the reactions on what they prescribe [F L]
      real(dp) :: external_size = 0.0_dp !! sum of the magnitudes of both [F L]
   end type node_sums_t

contains

   !> Sums up forces and their work over the nodes, all in one pass.
   pure subroutine sum_nodes(sums, loads, contact, reaction, internal, springs, displacement, prescribed)
      type(node_sums_t), intent(out) :: sums !! the sums
      real(dp), intent(in) :: loads(:, :) !! nodal forces of the loads (2, n_nodes) [F]
      real(dp), intent(in) :: contact(:, :) !! nodal forces of the obstacle (2, n_nodes) [F]
      real(dp), intent(in) :: reaction(:, :) !! nodal reactions (2, n_nodes) [F]
      real(dp), intent(in) :: internal(:, :) !! nodal forces of stresses and springs (2, n_nodes) [F]
      real(dp), intent(in) :: springs(:, :) !! those of the springs (2, n_nodes) [F]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: prescribed(:, :) !! prescribed displacements (2, n_nodes) [L]
      integer :: i, node

      do node = 1, size(loads, 2)
         do i = 1, 2
            associate (f => loads(i, node), c => contact(i, node), r => reaction(i, node), k => internal(i, node), &
               s => springs(i, node), u => displacement(i, node), p => prescribed(i, node))
               sums%largest_load = max(sums%largest_load, abs(f))
               sums%largest_contact = max(sums%largest_contact, abs(c))
               sums%largest_reaction = max(sums%largest_reaction, abs(r))
               sums%load(i) = sums%load(i) + f
               sums%contact(i) = sums%contact(i) + c
               sums%reaction(i) = sums%reaction(i) + (r - s)
               sums%forces = sums%forces + (abs(f) + abs(c) + abs(r - s))
               sums%springs = sums%springs + abs(s)
               sums%internal_work = sums%internal_work + k*u
               sums%internal_size = sums%internal_size + abs(k*u)
               sums%external_work = sums%external_work + (f + c)*u
               sums%support_work = sums%support_work + r*p
               sums%external_size = sums%external_size + (abs(f*u) + abs(c*u) + abs(r*p))
            end associate
         end do
      end do
   end subroutine sum_nodes

   !> The norm of nodal forces. Squares over that of the largest neither overflow nor vanish [F].
   pure real(dp) function norm_of(forces, largest) result(norm)
      real(dp), intent(in) :: forces(:, :) !! the forces (2, n_nodes) [F]
      real(dp), intent(in) :: largest !! their largest component [F]
      real(dp) :: unit
      integer :: node

      norm = 0.0_dp
      if (.not. largest > 0.0_dp) return
      unit = binary_scale(largest)
      do node = 1, size(forces, 2)
         norm = norm + ((forces(1, node)*unit)**2 + (forces(2, node)*unit)**2)
      end do
      norm = sqrt(norm)/unit
   end function norm_of

   !> The power of two that brings a number near 1: a factor that rounds nothing, quicker than a divisor.
   pure real(dp) function binary_scale(number) result(unit)
      real(dp), intent(in) :: number !! the number, positive
      ! Beyond it a power of two, or the number times it, would leave the range.
      integer, parameter :: most = 1000

      unit = scale(1.0_dp, max(-most, min(most, -exponent(number))))
   end function binary_scale

end module amontons_node_sums
