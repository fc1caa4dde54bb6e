!> The cells of constant multipliers of a pair.
module amontons_mortar_cells
   use amontons_constraints, only: constraints_t
   use amontons_contact_cells, only: contact_cells_t, new_contact_cells
   use amontons_contact_set, only: cell_partition_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_mortar_points, only: cell_pieces, mortar_piece_t
   use amontons_mortar_segments, only: mortar_segment_t
   use amontons_pair_refusals, only: held_slave_text
   implicit none (type, external)
   private

   public :: choose_cells

contains

   !> Makes cells the points of a pair, in the place of corners: not those that face nothing.
   pure subroutine choose_cells(pair, set, against, partition, mesh, materials, constraints, error)
      type(mortar_pair_t), intent(inout) :: pair !! the pair
      character(*), intent(in) :: set !! name of the slave's boundary set
      character(*), intent(in) :: against !! name of the master's
      type(cell_partition_t), intent(in) :: partition !! how to cut it
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(constraints_t), intent(in) :: constraints !! the supports
      type(error_t), allocatable, intent(out) :: error
         !! the partition does not fit the line, or supports hold all nodes of a cell along its normal
      real(dp), parameter :: no_direction(2) = 0.0_dp
      type(contact_cells_t) :: cells
      type(mortar_piece_t), allocatable :: pieces(:)
      integer, allocatable :: point(:), kept(:)
      logical :: is_free, moves
      integer :: cell, k

      call new_contact_cells(cells, mesh, materials, set, pair%line, partition, no_direction, error)
      if (allocated(error)) return
      pair%cells = [(mortar_segment_t(cells%segments(k)%side, cells%segments(k)%cell, cells%segments(k)%range), &
         k=1, size(cells%segments))]
      call cell_pieces(pieces, pair%segments, pair%cells)
      pair%is_tangent_fixed = pair%is_tangent_fixed(:0)
      allocate (kept(0), point(0:cells%n_cells))
      point = 0
      do cell = 1, cells%n_cells
         if (all(pieces%point(1) /= cell)) cycle
         moves = .false.
         is_free = .false.
         do k = cells%rows%start(cell), cells%rows%start(cell + 1) - 1
            moves = moves .or. constraints%leaves_free(cells%rows%node(k), cells%normal(:, cell))
            is_free = is_free .or. all(constraints%is_free(:, cells%rows%node(k)))
         end do
         if (.not. moves) then
            call new_error(error, input_refused, held_slave_text(set, against, cells%center(:, cell), 'force', &
               'exchange set and against'))
            return
         end if
         kept = [kept, cell]
         point(cell) = size(kept)
         pair%is_tangent_fixed = [pair%is_tangent_fixed, .not. is_free]
      end do
      pair%cells%master = point(pair%cells%master)
      pair%normal = cells%normal(:, kept)
      pair%next = point(cells%next(kept))
      pair%node = pair%node(:0)
      deallocate (pair%covered_share)
      pair%held_node = pair%node
      pair%shared_node = pair%node
      pair%joined_node = pair%node
      pair%idle_side = pair%idle_side(:, :0)
   end subroutine choose_cells

end module amontons_mortar_cells
