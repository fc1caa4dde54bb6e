!> Contact sets and ties as a deck describes them. A contact set is a boundary set that may touch an obstacle or another
!> body, with friction along the line and multipliers that are nodal or constant on the cells of a partition (the
!> paper's Lambda_H). A tie is a boundary set that is bonded.
module amontons_contact_set
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_obstacle, only: obstacle_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: cell_partition_t, contact_t, gap_names, line_field_t, multiplier_names, new_contact, new_tie, pairing_t, &
      sliding_names, tie_t, usual_most_nodal

   !> Sources of the gaps of a pair, as a deck names them: the meshes, or 0 wherever the bodies face each other.
   character(8), parameter :: gap_names(*) = [character(8) :: 'mesh', 'touching']

   !> How far the points of a set slide, as a deck names it: so little that partners, normals and arms stay those at
   !> rest, or any way.
   character(6), parameter :: sliding_names(*) = [character(6) :: 'small', 'finite']

   !> The other body of a contact set. The set is the slave, which carries the multipliers; the boundary of the other
   !> body is the master.
   type :: pairing_t
      character(:), allocatable :: against
         !! name of the master's boundary set; empty or not allocated for a rigid obstacle
      real(dp) :: search = 0.0_dp
         !! largest distance of the master along the slave's normal; 0 for twice the longest side [L]
      character(8) :: gap = 'mesh' !! source of the gaps, one of `gap_names`
      logical :: is_tied = .false. !! whether the surfaces are bonded
   contains
      procedure :: has_mesh_gap => pairing_has_mesh_gap
      procedure :: is_pair => pairing_is_pair
      procedure :: label => pairing_label
   end type pairing_t

   !> A boundary set bonded to that of another body: no gap, no slip.
   type :: tie_t
      character(:), allocatable :: name !! name of its forces; empty or not allocated for that of its set
      character(:), allocatable :: set !! name of the slave's boundary set
      character(:), allocatable :: to !! name of the master's boundary set
      real(dp) :: search = 0.0_dp
         !! largest distance of the master along the slave's normal; 0 for twice the longest side [L]
      logical :: has_jump = .false. !! whether it is a preload: the slave is shifted along its normal by a jump
      character(:), allocatable :: origin !! where the tie was specified, for messages: 'deck.nml:12: '
   end type tie_t

   !> A quantity along a contact line or face: constant, linear in the coordinates, or given by a table over the length
   !> of a line.
   type :: line_field_t
      real(dp) :: value = 0.0_dp !! its value at the origin of the coordinates; everywhere if nothing else is set
      real(dp) :: slope(3) = 0.0_dp !! its change along x, y and, in space, z [per L]
      real(dp), allocatable :: table(:, :) !! arc lengths and values, the arc lengths ascending (2, entries) [L, any]
      character(:), allocatable :: file !! the file of the table; empty or not allocated without one
   contains
      procedure :: at => line_field_at
      procedure :: vanishes => line_field_vanishes
   end type line_field_t

   !> Kinds of multipliers, as a deck writes them: at the nodes, constant on cells, or at the corners of a pair's slave.
   character(8), parameter :: multiplier_names(*) = [character(8) :: 'nodal', 'constant', 'mortar']

   !> Above so many contact unknowns their dense matrices take most of time and memory, and corners, a quarter of the
   !> nodes of quadratic faces, resolve the pressure.
   integer, parameter :: usual_most_nodal = 6000

   !> The multipliers of a contact set. Constant ones have equal cells, cells with given ends or, without either, a
   !> cell for every two sides. In space those of a large set on a rigid obstacle belong to the corners of its faces.
   type :: cell_partition_t
      logical :: is_constant = .false. !! whether the multipliers are constant on cells; nodal otherwise
      integer :: most_nodal = usual_most_nodal
         !! largest number of unknowns of nodal multipliers of quadratic faces in space; -1 if no face has them, huge if
         !! all have
      integer :: n_cells = 0 !! number of equal cells on each piece of the line; 0 for none asked for
      real(dp), allocatable :: ends(:)
         !! boundaries between cells, ascending lengths along the line; not allocated if not given [L]
   contains
      procedure :: cell_ends => cell_partition_cell_ends
   end type cell_partition_t

   !> A boundary set that may touch a rigid obstacle or another body, and the friction there: |lambda_T| <= g + phi
   !> lambda_N.
   type :: contact_t
      character(:), allocatable :: name
         !! its name in load histories, in addition to that of its set, and of its forces; empty or not allocated
         !! without one
      character(:), allocatable :: set !! name of the boundary set
      type(obstacle_t) :: obstacle !! the rigid obstacle, if the set is not paired
      type(pairing_t) :: pairing !! the other body, if the set is paired
      real(dp) :: direction(3) = 0.0_dp !! along which gaps count, towards the obstacle; 0 for the body's normal [-]
      type(line_field_t) :: extra_gap !! added to every gap; negative for an interference [L]
      type(line_field_t) :: friction !! Coulomb's coefficient phi, at least 0 [-]
      type(line_field_t) :: slip_bound !! given (Tresca) bound g of the shear stress, at least 0 [F/L^2]
      real(dp) :: wear = 0.0_dp !! Archard's coefficient: depth worn per pressure and slip, at least 0 [L^2/F]
      character(6) :: sliding = 'small' !! how far its points slide, one of `sliding_names`
      type(cell_partition_t) :: partition !! whether multipliers are nodal or constant on cells, and on which cells
      character(:), allocatable :: origin !! where the contact was specified, for messages: 'deck.nml:12: '
   contains
      procedure :: slides_far => contact_slides_far
   end type contact_t

contains

   !> Makes a contact set with the rigid plane y = 0 as its obstacle.
   pure subroutine new_contact(contact, set, friction)
      type(contact_t), intent(out) :: contact !! the contact set
      character(*), intent(in) :: set !! name of the boundary set
      real(dp), intent(in) :: friction !! Coulomb's coefficient phi, at least 0 [-]

      contact%set = set
      contact%friction%value = friction
      contact%origin = ''
   end subroutine new_contact

   !> Whether normals, gaps and partners of the set are those at the moved places.
   elemental logical function contact_slides_far(self) result(slides_far)
      class(contact_t), intent(in) :: self !! the contact set

      slides_far = self%sliding == sliding_names(2)
   end function contact_slides_far

   !> Makes a tie between two boundary sets.
   pure subroutine new_tie(tie, set, to)
      type(tie_t), intent(out) :: tie !! the tie
      character(*), intent(in) :: set !! name of the slave's boundary set
      character(*), intent(in) :: to !! name of the master's boundary set

      tie%set = set
      tie%to = to
      tie%origin = ''
   end subroutine new_tie

   !> The name of a contact set in files and messages: SLAVE/MASTER for a pair, else SET.
   pure function pairing_label(self, set) result(label)
      class(pairing_t), intent(in) :: self !! the pairing
      character(*), intent(in) :: set !! name of the contact set
      character(:), allocatable :: label

      label = set
      if (self%is_pair()) label = label//'/'//self%against
   end function pairing_label

   !> Whether the set meets another deformable body.
   elemental logical function pairing_is_pair(self) result(is_pair)
      class(pairing_t), intent(in) :: self !! the pairing

      is_pair = .false.
      if (allocated(self%against)) is_pair = len(self%against) > 0
   end function pairing_is_pair

   !> Whether the gaps are the distances between the meshes of two deformable bodies.
   elemental logical function pairing_has_mesh_gap(self) result(has_mesh_gap)
      class(pairing_t), intent(in) :: self !! the pairing

      has_mesh_gap = self%is_pair() .and. self%gap == gap_names(1)
   end function pairing_has_mesh_gap

   !> Whether the quantity is 0 along the whole line.
   pure logical function line_field_vanishes(self) result(vanishes)
      class(line_field_t), intent(in) :: self !! the quantity

      vanishes = .not. (abs(self%value) > 0.0_dp .or. any(abs(self%slope) > 0.0_dp) .or. allocated(self%table))
   end function line_field_vanishes

   !> The quantity at a position on the line; a table is interpolated linearly, and constant beyond its ends.
   pure real(dp) function line_field_at(self, position, arc_length) result(value)
      class(line_field_t), intent(in) :: self !! the quantity
      real(dp), intent(in) :: position(:) !! coordinates of the point (n_dim) [L]
      real(dp), intent(in) :: arc_length !! length along the line from its first node [L]
      real(dp) :: share
      integer :: i

      value = self%value + dot_product(self%slope(:size(position)), position)
      if (.not. allocated(self%table)) return
      associate (arc_lengths => self%table(1, :), values => self%table(2, :))
         i = count(arc_lengths <= arc_length)
         if (i == 0) then
            value = values(1)
         else if (i == size(values)) then
            value = values(i)
         else
            share = (arc_length - arc_lengths(i))/(arc_lengths(i + 1) - arc_lengths(i))
            value = values(i) + share*(values(i + 1) - values(i))
         end if
      end associate
   end function line_field_at

   !> The ends of the cells of a piece of the line, from its beginning.
   pure subroutine cell_partition_cell_ends(self, side_lengths, ends, error)
      class(cell_partition_t), intent(in) :: self !! the partition
      real(dp), intent(in) :: side_lengths(:) !! lengths of the sides of the piece, in order [L]
      real(dp), allocatable, intent(out) :: ends(:) !! 0 and the end of each cell (cells + 1) [L]
      type(error_t), allocatable, intent(out) :: error !! a given end lies beyond the line, or the cells are too many
      real(dp) :: length
      integer :: i, n

      length = sum(side_lengths)
      n = size(side_lengths)
      ! A quadratic side has two nodes of its own; more cells than nodes are never independent.
      if (self%n_cells > 2*n + 1) then
         call new_error(error, input_refused, 'cells must be at least two sides long, found '//to_text(self%n_cells)// &
            ' cells on '//to_text(n)//' sides')
         return
      end if
      if (allocated(self%ends)) then
         if (self%ends(size(self%ends)) >= length) then
            call new_error(error, input_refused, 'cell_ends must lie before the end of the contact line, which '// &
               'ends the last cell: its length is '//to_text(length)//', found '//to_text(self%ends(size(self%ends))))
            return
         end if
         ends = [0.0_dp, self%ends, length]
      else if (self%n_cells > 0) then
         ends = [(length*i/self%n_cells, i=0, self%n_cells)]
      else
         ends = [0.0_dp, (sum(side_lengths(:2*i)), i=1, n/2)]
         if (n == 1) ends = [0.0_dp, 0.0_dp]
         ends(size(ends)) = length
      end if
   end subroutine cell_partition_cell_ends

end module amontons_contact_set
