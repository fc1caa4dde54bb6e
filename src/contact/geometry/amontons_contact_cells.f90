!> The cells of a contact set with constant multipliers: parts of sides, areas, normals, rows, quadrature points.
!>
!> A cell is cut out of the sides by lengths along the line, whatever the nodes. Its displacement is the mean of the
!> body's displacement along the normal of the geometry at each point, integrated exactly on straight sides; its
!> multiplier is then the force on the cell, stress times area. Cells of a pair are cut out of its slave.
module amontons_contact_cells
   use amontons_boundary, only: patch_t
   use amontons_contact_rows, only: contact_quadrature_t, contact_rows_t
   use amontons_contact_set, only: cell_partition_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: face_t, new_face
   use amontons_frame, only: new_frame, new_frames
   use amontons_kinds, only: dp
   use amontons_line, only: line_t
   use amontons_mesh, only: mesh_t
   use amontons_mortar_pair, only: cell_pieces, least_cover, mortar_pair_t, mortar_piece_t
   use amontons_obstacle, only: unit_vector
   use amontons_pair_checks, only: held_slave_text
   use amontons_rounding, only: computed_rounding
   use amontons_surface, only: meshed_body_t, mortar_segment_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: choose_cells, contact_cells_t, new_contact_cells

   !> Nodes and quadrature points of a part of a side.
   integer, parameter :: n_segment_nodes = 3, n_segment_points = 3

   !> The cells in the order of the line.
   type :: contact_cells_t
      integer :: n_cells = 0 !! number of cells
      type(line_t) :: line !! how they follow each other
      real(dp), allocatable :: length(:) !! length of each cell (n_cells) [L]
      real(dp), allocatable :: area(:) !! length times depth of the body (n_cells) [L^2]
      real(dp), allocatable :: center(:, :) !! centroid (2, n_cells) [L]
      real(dp), allocatable :: normal(:, :) !! mean unit normal (n_dim, n_cells) [-]
      type(contact_rows_t) :: rows !! the nodes' shares in the mean displacements
      type(contact_quadrature_t) :: quadrature !! the quadrature points
      type(mortar_segment_t), allocatable :: segments(:)
         !! the parts of the sides, cell by cell, with the cell in the place of the side of the master
      logical, allocatable :: is_held(:) !! whether supports hold all its nodes along its normal (n_cells)
      logical, allocatable :: is_fixed(:, :) !! whether supports bear the shear of all its nodes (n_tangents, n_cells)
   end type contact_cells_t

contains

   !> Cuts a contact line into cells and integrates over them.
   pure subroutine new_contact_cells(cells, body, patch, partition, direction, error)
      type(contact_cells_t), intent(out) :: cells !! the cells
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(patch_t), intent(in) :: patch !! the patch of the set
      type(cell_partition_t), intent(in) :: partition !! the partition into cells
      real(dp), intent(in) :: direction(2) !! along which gaps count; 0, 0 for the body's normal [-]
      type(error_t), allocatable, intent(out) :: error !! the partition does not fit the line
      ! The mean normal of a cell that turns by 217 degrees has this length.
      real(dp), parameter :: smallest = 0.5_dp
      integer :: cell, k

      call cut_into_cells(cells, patch%sides(), body%mesh, partition, error)
      if (allocated(error)) return
      call integrate(cells, patch, body, direction)
      allocate (cells%is_held(cells%n_cells), cells%is_fixed(body%materials%n_components() - 1, cells%n_cells))
      do cell = 1, cells%n_cells
         associate (normal => cells%normal(:, cell), center => cells%center(:, cell))
            if (norm2(normal) < smallest) then
               call new_error(error, input_refused, 'the cell of constant multipliers around '//to_text(center(1))// &
                  ', '//to_text(center(2))//' bends so far that it has no normal; make the cells smaller')
               return
            end if
            normal = normal/norm2(normal)
            associate (node => cells%rows%node(cells%rows%start(cell):cells%rows%start(cell + 1) - 1))
               cells%is_held(cell) = .not. any([(body%constraints%leaves_free(node(k), normal), k=1, size(node))])
               cells%is_fixed(:, cell) = all(body%constraints%fixed_tangents(node, spread(new_frame(normal, &
                  body%materials%n_components()), 3, size(node))), dim=2)
            end associate
         end associate
      end do
   end subroutine new_contact_cells

   !> Cuts each connected piece of a contact line into cells, by arc length along the line.
   pure subroutine cut_into_cells(cells, sides, mesh, partition, error)
      type(contact_cells_t), intent(inout) :: cells
         !! gains the number of cells, how they follow each other and their parts of the sides
      integer, intent(in) :: sides(:, :) !! the sides in order (4, sides)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(cell_partition_t), intent(in) :: partition !! the partition into cells
      type(error_t), allocatable, intent(out) :: error !! the partition does not fit the line
      real(dp), allocatable :: ends(:)
      real(dp) :: lengths(size(sides, 2))
      integer :: first, last, i, n, cell, k
      type(mortar_segment_t) :: segment
      real(dp) :: begin

      lengths = [(length_up_to(sides(:, i), mesh, 1.0_dp), i=1, size(sides, 2))]
      allocate (cells%segments(0), cells%line%next(0))
      first = 1
      do while (first <= size(sides, 2))
         last = first
         do while (last < size(sides, 2))
            if (sides(1, last + 1) /= sides(2, last)) exit
            last = last + 1
         end do
         if (allocated(partition%ends) .and. last - first + 1 < size(sides, 2)) then
            call new_error(error, input_refused, 'cell_ends needs a contact line of one piece; this one has more')
            return
         end if
         call partition%cell_ends(lengths(first:last), ends, error)
         if (allocated(error)) return
         cell = 1
         begin = 0.0_dp
         do k = 1, last - first + 1
            segment%slave = first + k - 1
            segment%range = -1.0_dp
            do
               segment%master = cells%n_cells + cell
               segment%range(1) = segment%range(2)
               segment%range(2) = 1.0_dp
               ! A cell that ends next to a node ends there.
               if (ends(cell + 1) < begin + (1.0_dp - computed_rounding)*lengths(first + k - 1)) segment%range(2) = &
                  place_at(sides(:, segment%slave), mesh, ends(cell + 1) - begin)
               cells%segments = [cells%segments, segment]
               if (ends(cell + 1) < begin + (1.0_dp + computed_rounding)*lengths(first + k - 1)) cell = min( &
                  cell + 1, size(ends) - 1)
               if (.not. segment%range(2) < 1.0_dp) exit
            end do
            begin = begin + lengths(first + k - 1)
         end do
         n = size(ends) - 1
         cells%line%next = [cells%line%next, [(cells%n_cells + i, i=2, n)], 0]
         if (sides(2, last) == sides(1, first) .and. n > 1) cells%line%next(cells%n_cells + n) = cells%n_cells + 1
         cells%n_cells = cells%n_cells + n
         first = last + 1
      end do
   end subroutine cut_into_cells

   !> Length of a side from its first corner to a local coordinate on it [L].
   pure real(dp) function length_up_to(side, mesh, place) result(length)
      integer, intent(in) :: side(4) !! first corner, second corner, middle node or 0, element
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: place !! the place, from -1 to 1 [-]
      type(face_t) :: face

      call new_face(face, side, mesh, range=[-1.0_dp, place])
      length = sum(face%length)
   end function length_up_to

   !> The local coordinate on a side at a length from its first corner, by bisection [-].
   pure real(dp) function place_at(side, mesh, length) result(place)
      integer, intent(in) :: side(4) !! first corner, second corner, middle node or 0, element
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), intent(in) :: length !! the length [L]
      integer, parameter :: n_halvings = 54
      real(dp) :: step
      integer :: i

      place = -1.0_dp
      step = 2.0_dp
      do i = 1, n_halvings
         step = 0.5_dp*step
         if (length_up_to(side, mesh, place + step) <= length) place = place + step
      end do
   end function place_at

   !> Computes areas, centers, normals, rows and quadrature points of the cells.
   pure subroutine integrate(cells, patch, body, direction)
      type(contact_cells_t), intent(inout) :: cells !! the cells
      type(patch_t), intent(in) :: patch !! the patch of the set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      real(dp), intent(in) :: direction(2) !! along which gaps count; 0, 0 for the body's normal [-]
      type(mortar_segment_t) :: segment
      integer :: n_segments(cells%n_cells), sides(4, size(patch%faces)), side(4), i, cell, k, point, before, place
      type(face_t) :: face
      real(dp) :: normal(2), outward(2), begin(maxval(patch%node))

      sides = patch%sides()
      begin(patch%node) = patch%line%arc_length
      allocate (cells%length(cells%n_cells), cells%area(cells%n_cells), cells%center(2, cells%n_cells), &
         cells%normal(2, cells%n_cells), source=0.0_dp)
      n_segments = [(count(cells%segments%master == cell), cell=1, cells%n_cells)]
      call cells%rows%begin(n_segment_nodes*n_segments, body%materials%n_components())
      call cells%quadrature%begin(n_segment_points*n_segments, size(normal))
      do i = 1, size(cells%segments)
         segment = cells%segments(i)
         side = sides(:, segment%slave)
         call new_face(face, side, body%mesh, body%materials, segment%range)
         before = n_segment_nodes*(i - 1)
         ! A straight side has no middle node; its part there is 0.
         cells%rows%node(before + 1:before + n_segment_nodes) = merge(side(:3), side(1), side(:3) > 0)
         do point = 1, n_segment_points
            associate (area => face%area(point), position => face%position(:, point), own => segment%master)
               outward = face%outward(:, point)/face%length(point)
               normal = outward
               if (any(abs(direction) > 0.0_dp)) normal = unit_vector(direction)
               place = n_segment_points*(i - 1) + point
               cells%quadrature%outward(place) = dot_product(normal, outward)
               cells%quadrature%position(:, place) = position
               cells%quadrature%normal(:, place) = normal
               cells%quadrature%share(place) = area
               cells%quadrature%arc_length(place) = begin(side(1)) &
                  + norm2(position - body%mesh%coordinates(:, side(1)))
               cells%length(own) = cells%length(own) + face%length(point)
               cells%area(own) = cells%area(own) + area
               cells%center(:, own) = cells%center(:, own) + area*position
               cells%normal(:, own) = cells%normal(:, own) + area*normal
               do k = 1, n_segment_nodes
                  cells%rows%block(:, :, before + k) = cells%rows%block(:, :, before + k) &
                     + face%values(k, point)*area*new_frame(normal, size(cells%rows%block, 1))
               end do
            end associate
         end do
      end do
      do cell = 1, cells%n_cells
         cells%center(:, cell) = cells%center(:, cell)/cells%area(cell)
         cells%normal(:, cell) = cells%normal(:, cell)/cells%area(cell)
         associate (first => cells%rows%start(cell), last => cells%rows%start(cell + 1) - 1)
            cells%rows%block(:, :, first:last) = cells%rows%block(:, :, first:last)/cells%area(cell)
         end associate
         associate (first => cells%quadrature%start(cell), last => cells%quadrature%start(cell + 1) - 1)
            cells%quadrature%share(first:last) = cells%quadrature%share(first:last)/cells%area(cell)
         end associate
      end do
   end subroutine integrate

   !> Replaces the corners of a pair by cells as its points; cells that face no master are left out.
   pure subroutine choose_cells(pair, partition, body, error)
      type(mortar_pair_t), intent(inout) :: pair !! the pair
      type(cell_partition_t), intent(in) :: partition !! the partition into cells
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(error_t), allocatable, intent(out) :: error
         !! the partition does not fit the line, or supports hold all nodes of a cell along its normal
      real(dp), parameter :: no_direction(2) = 0.0_dp
      type(contact_cells_t) :: cells
      type(mortar_piece_t), allocatable :: pieces(:)
      integer, allocatable :: point(:), kept(:), neighbor(:)
      integer :: cell, k

      call new_contact_cells(cells, body, pair%patch, partition, no_direction, error)
      if (allocated(error)) return
      pair%cells = cells%segments
      call cell_pieces(pieces, pair%segments, pair%cells)
      call join_cells(cells, pieces, pair, neighbor)
      kept = pack([(cell, cell=1, cells%n_cells)], neighbor == [(cell, cell=1, cells%n_cells)])
      do k = 1, size(kept)
         if (.not. cells%is_held(kept(k))) cycle
         call new_error(error, input_refused, held_slave_text(pair, cells%center(:, kept(k)), 'force', &
            'exchange set and against'))
         return
      end do
      allocate (point(0:cells%n_cells), source=0)
      point(kept) = [(k, k=1, size(kept))]
      point(1:) = point(neighbor)
      pair%is_fixed = cells%is_fixed(:, kept)
      pair%cells%master = point(pair%cells%master)
      pair%frame = new_frames(cells%normal(:, kept), body%materials%n_components())
      pair%line%next = point(cells%line%next(kept))
      where (pair%line%next == point(kept)) pair%line%next = 0
      pair%node = pair%node(:0)
      deallocate (pair%covered_share)
      pair%held_node = pair%node
      pair%shared_node = pair%node
      pair%joined_node = pair%node
      pair%idle_side = pair%idle_side(:, :0)
   end subroutine choose_cells

   !> Joins each cell of which the master covers little to the one beside it, if there is one that it covers well.
   pure subroutine join_cells(cells, pieces, pair, neighbor)
      type(contact_cells_t), intent(in) :: cells !! the cells
      type(mortar_piece_t), intent(in) :: pieces(:) !! the parts of the cells that face the master
      type(mortar_pair_t), intent(in) :: pair !! the pair
      integer, allocatable, intent(out) :: neighbor(:)
         !! the cell that each cell belongs to: itself, the one beside it, or 0 if it faces nothing (n_cells)
      real(dp) :: share(cells%n_cells)
      integer, allocatable :: beside(:)
      integer :: cell, k

      share = 0.0_dp
      do k = 1, size(pieces)
         associate (segment => pieces(k)%segment, own => share(pieces(k)%point(1)))
            own = own + 0.5_dp*(segment%range(2) - segment%range(1))*norm2(pair%slave%corner(:, 2, segment%slave) &
               - pair%slave%corner(:, 1, segment%slave))/cells%length(pieces(k)%point(1))
         end associate
      end do
      neighbor = merge([(cell, cell=1, cells%n_cells)], 0, share > 0.0_dp)
      do cell = 1, cells%n_cells
         if (neighbor(cell) == 0 .or. share(cell) >= least_cover) cycle
         beside = cells%line%beside(cell)
         k = maxloc(share(beside), dim=1)
         if (k == 0) cycle
         if (share(beside(k)) >= least_cover) neighbor(cell) = beside(k)
      end do
   end subroutine join_cells

end module amontons_contact_cells
