!> The rows of the contact matrix C = (N; T), section 2 of the paper: the displacement of a contact point as a sum over
!> nodal displacements.
!>
!> The displacement of a point along each direction of its frame, normal and tangents, is a sum of scalar products of
!> nodal displacements with that direction times the share of the node. A node that is a contact point itself has one
!> part, its own frame, and further ones if it also represents a corner beside it; a cell of constant multipliers has
!> one part for each node of its sides.
!>
!> The quadrature points are the positions where gap, friction and slip bound of the points are evaluated: the node
!> itself, or the quadrature points of a cell. In both lists the entries of point p are those from `start(p)` to
!> `start(p + 1) - 1`.
module amontons_contact_rows
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: contact_quadrature_t, contact_rows_t, picked_places, share_parts

   !> The rows of all points; the parts of point p are those from `start(p)` to `start(p + 1) - 1`, and a node may occur
   !> several times.
   type :: contact_rows_t
      integer, allocatable :: start(:) !! first part of each point, and one beyond the last (m + 1)
      integer, allocatable :: node(:) !! node of each part (parts)
      real(dp), allocatable :: block(:, :, :)
         !! normal and tangents as columns, each times the share of the node in the displacement along it (components,
         !! 1 + n_tangents, parts) [-]
   contains
      procedure :: add => contact_rows_add
      procedure :: begin => contact_rows_begin
      procedure :: picked => contact_rows_picked
      procedure :: merge_nodes => contact_rows_merge_nodes
      procedure :: displacement => contact_rows_displacement
      procedure :: forces => contact_rows_forces
   end type contact_rows_t

   !> The quadrature points of all points; those of point p are the ones from `start(p)` to `start(p + 1) - 1`.
   type :: contact_quadrature_t
      integer, allocatable :: start(:) !! first quadrature point of each point, and one beyond the last (m + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (n_dim, quadrature points) [L]
      real(dp), allocatable :: normal(:, :) !! unit normal n towards the obstacle (n_dim, quadrature points) [-]
      real(dp), allocatable :: outward(:)
         !! cosine of the angle between n and the body's outward normal: 1 unless n is given (quadrature points) [-]
      real(dp), allocatable :: arc_length(:) !! length along the line from its first node (quadrature points) [L]
      real(dp), allocatable :: gap(:)
         !! distance to the other body of a pair, along n; of no meaning with a rigid obstacle (quadrature points) [L]
      real(dp), allocatable :: share(:) !! share of the point's area; they sum to 1 over a point (quadrature points) [-]
   contains
      procedure :: add => contact_quadrature_add
      procedure :: begin => contact_quadrature_begin
      procedure :: picked => contact_quadrature_picked
   end type contact_quadrature_t

contains

   !> Appends the rows C of further contact points to these.
   pure subroutine contact_rows_add(self, others)
      class(contact_rows_t), intent(inout) :: self !! the rows
      type(contact_rows_t), intent(in) :: others !! the rows to add

      self%start = [self%start, size(self%node) + others%start(2:)]
      self%node = [self%node, others%node]
      self%block = reshape([self%block, others%block], [size(self%block, 1), size(self%block, 2), &
         size(self%node)])
   end subroutine contact_rows_add

   !> The rows C of some of the contact points.
   pure function contact_rows_picked(self, points) result(picked)
      class(contact_rows_t), intent(in) :: self !! the rows
      integer, intent(in) :: points(:) !! the points to pick
      type(contact_rows_t) :: picked
      integer, allocatable :: places(:)

      places = picked_places(self%start, points)
      picked = contact_rows_t(starts(self%start(points + 1) - self%start(points)), self%node(places), &
         self%block(:, :, places))
   end function contact_rows_picked

   !> Shares the parts of nodes with other nodes at the same place that move like them, by their areas.
   pure subroutine share_parts(rows, partner, area)
      type(contact_rows_t), intent(inout) :: rows !! the rows
      integer, intent(in) :: partner(:) !! the node that each node moves like: itself but for those others (n_nodes)
      real(dp), intent(in) :: area(:) !! the areas of the nodes (n_nodes) [L^2]
      integer, allocatable :: others(:), own(:), node(:), place(:)
      real(dp), allocatable :: share(:)
      integer :: i

      others = pack([(i, i=1, size(partner))], partner /= [(i, i=1, size(partner))])
      if (size(others) == 0) return
      allocate (node(0), place(0), share(0))
      do i = 1, size(rows%node)
         own = [rows%node(i), pack(others, partner(others) == rows%node(i))]
         node = [node, own]
         place = [place, spread(i, 1, size(own))]
         share = [share, max(area(own), tiny(1.0_dp))/sum(max(area(own), tiny(1.0_dp)))]
      end do
      rows = contact_rows_t([(1 + count(place < rows%start(i)), i=1, size(rows%start))], node, &
         rows%block(:, :, place))
      do i = 1, size(share)
         rows%block(:, :, i) = rows%block(:, :, i)*share(i)
      end do
   end subroutine share_parts

   !> Merges the parts of a point that have the same node, and removes parts that are 0.
   pure subroutine contact_rows_merge_nodes(self)
      class(contact_rows_t), intent(inout) :: self !! the rows
      integer :: p, i, k, n, first

      n = 0
      do p = 1, size(self%start) - 1
         first = n + 1
         do i = self%start(p), self%start(p + 1) - 1
            if (.not. any(abs(self%block(:, :, i)) > 0.0_dp)) cycle
            k = findloc(self%node(first:n), self%node(i), dim=1)
            if (k > 0) then
               self%block(:, :, first + k - 1) = self%block(:, :, first + k - 1) + self%block(:, :, i)
            else
               n = n + 1
               self%node(n) = self%node(i)
               self%block(:, :, n) = self%block(:, :, i)
            end if
         end do
         self%start(p) = first
      end do
      self%start(size(self%start)) = n + 1
      self%node = self%node(:n)
      self%block = self%block(:, :, :n)
   end subroutine contact_rows_merge_nodes

   !> C u: normal displacements of all points, then those along the first tangents, at last those along the second
   !> (components m) [L].
   pure function contact_rows_displacement(self, field) result(displacement)
      class(contact_rows_t), intent(in) :: self !! the rows
      real(dp), intent(in) :: field(:, :) !! displacement of all nodes (components, n_nodes) [L]
      real(dp) :: displacement(size(field, 1)*(size(self%start) - 1))
      integer :: p, i, m

      m = size(self%start) - 1
      displacement = 0.0_dp
      do p = 1, m
         do i = self%start(p), self%start(p + 1) - 1
            displacement(p::m) = displacement(p::m) + matmul(field(:, self%node(i)), self%block(:, :, i))
         end do
      end do
   end function contact_rows_displacement

   !> -C^T lambda: the forces of the obstacle on the nodes (components, n_nodes) [F].
   pure function contact_rows_forces(self, force, n_nodes) result(forces)
      class(contact_rows_t), intent(in) :: self !! the rows
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) (components m) [F]
      integer, intent(in) :: n_nodes !! number of nodes
      real(dp), allocatable :: forces(:, :)
      integer :: p, i, k, m

      m = size(self%start) - 1
      allocate (forces(size(self%block, 1), n_nodes), source=0.0_dp)
      do p = 1, m
         do i = self%start(p), self%start(p + 1) - 1
            associate (on_node => forces(:, self%node(i)))
               do k = 1, size(self%block, 2)
                  on_node = on_node - force(p + (k - 1)*m)*self%block(:, k, i)
               end do
            end associate
         end do
      end do
   end function contact_rows_forces

   !> Appends the quadrature points of other points.
   pure subroutine contact_quadrature_add(self, others)
      class(contact_quadrature_t), intent(inout) :: self !! the quadrature points
      type(contact_quadrature_t), intent(in) :: others !! the quadrature points to add
      integer :: n

      self%start = [self%start, size(self%share) + others%start(2:)]
      n = size(self%share) + size(others%share)
      self%position = reshape([self%position, others%position], [size(self%position, 1), n])
      self%normal = reshape([self%normal, others%normal], [size(self%normal, 1), n])
      self%outward = [self%outward, others%outward]
      self%arc_length = [self%arc_length, others%arc_length]
      self%gap = [self%gap, others%gap]
      self%share = [self%share, others%share]
   end subroutine contact_quadrature_add

   !> The quadrature of some of the contact points.
   pure function contact_quadrature_picked(self, points) result(picked)
      class(contact_quadrature_t), intent(in) :: self !! the quadrature points
      integer, intent(in) :: points(:) !! the points to pick
      type(contact_quadrature_t) :: picked
      integer, allocatable :: places(:)

      places = picked_places(self%start, points)
      picked = contact_quadrature_t(starts(self%start(points + 1) - self%start(points)), self%position(:, places), &
         self%normal(:, places), self%outward(places), self%arc_length(places), self%gap(places), self%share(places))
   end function contact_quadrature_picked

   !> First places of consecutive ranges of given sizes, and one beyond the last range.
   pure function starts(sizes) result(start)
      integer, intent(in) :: sizes(:) !! size of the range of each point (m)
      integer :: start(size(sizes) + 1)
      integer :: k

      start(1) = 1
      do k = 1, size(sizes)
         start(k + 1) = start(k) + sizes(k)
      end do
   end function starts

   !> Allocates the quadrature points, all numbers 0.
   pure subroutine contact_quadrature_begin(self, sizes, n_dim)
      class(contact_quadrature_t), intent(inout) :: self !! the quadrature points
      integer, intent(in) :: sizes(:) !! number of entries of each point (m)
      integer, intent(in) :: n_dim !! number of coordinates of a place

      self%start = starts(sizes)
      associate (n => sum(sizes))
         allocate (self%position(n_dim, n), self%normal(n_dim, n), self%outward(n), self%arc_length(n), self%gap(n), &
            self%share(n), source=0.0_dp)
      end associate
   end subroutine contact_quadrature_begin

   !> Allocates the parts of all points, all numbers 0.
   pure subroutine contact_rows_begin(self, sizes, n_components)
      class(contact_rows_t), intent(inout) :: self !! the rows
      integer, intent(in) :: sizes(:) !! number of entries of each point (m)
      integer, intent(in) :: n_components !! number of components of a displacement

      self%start = starts(sizes)
      allocate (self%node(sum(sizes)), source=0)
      allocate (self%block(n_components, n_components, sum(sizes)), source=0.0_dp)
   end subroutine contact_rows_begin

   !> The places in the list of all entries that belong to some of the points.
   pure function picked_places(start, points) result(places)
      integer, intent(in) :: start(:) !! beginning of each range, and one beyond the last (m + 1)
      integer, intent(in) :: points(:) !! the points to pick
      integer, allocatable :: places(:)
      integer :: i, k

      places = [([(i, i=start(points(k)), start(points(k) + 1) - 1)], k=1, size(points))]
   end function picked_places

end module amontons_contact_rows
