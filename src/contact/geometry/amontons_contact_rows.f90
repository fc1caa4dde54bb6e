!> The rows of the contact matrix C = (N; T), section 2 of the paper: the displacement of a contact point as a sum over
!> nodal displacements.
!>
!> The normal displacement of a point is a sum of scalar products of nodal displacements with `part`, a normal times the
!> share of the node. The tangential one is the same sum with the parts turned by a right angle, unless `tangent` has
!> shares of its own. A node that is a contact point itself has one part, its normal, and further ones if it also
!> represents a corner beside it; a cell of constant multipliers has one part for each node of its sides.
!>
!> The quadrature points are the positions where gap, friction and slip bound of the points are evaluated: the node
!> itself, or the quadrature points of a cell. In both lists the entries of point p are those from `start(p)` to
!> `start(p + 1) - 1`.
module amontons_contact_rows
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: contact_quadrature_t, contact_rows_t, picked_places, share_parts, turned

   !> The rows of all points; the parts of point p are those from `start(p)` to `start(p + 1) - 1`, and a node may occur
   !> several times.
   type :: contact_rows_t
      integer, allocatable :: start(:) !! first part of each point, and one beyond the last (m + 1)
      integer, allocatable :: node(:) !! node of each part (parts)
      real(dp), allocatable :: part(:, :) !! normal times share of the node (2, parts) [-]
      real(dp), allocatable :: tangent(:, :) !! tangent times its share in the tangential displacement (2, parts) [-]
      real(dp), allocatable :: around(:)
         !! its share in the displacement around the axis, the second tangential one of a twisted body (parts) [-]
   contains
      procedure :: add => contact_rows_add
      procedure :: axes => contact_rows_axes
      procedure :: begin => contact_rows_begin
      procedure :: picked => contact_rows_picked
      procedure :: merge_nodes => contact_rows_merge_nodes
      procedure :: displacement => contact_rows_displacement
      procedure :: forces => contact_rows_forces
      procedure :: set_tangents => contact_rows_set_tangents
   end type contact_rows_t

   !> The quadrature points of all points; those of point p are the ones from `start(p)` to `start(p + 1) - 1`.
   type :: contact_quadrature_t
      integer, allocatable :: start(:) !! first quadrature point of each point, and one beyond the last (m + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (2, quadrature points) [L]
      real(dp), allocatable :: normal(:, :) !! unit normal n towards the obstacle (2, quadrature points) [-]
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

   !> A vector turned counterclockwise by a right angle: the tangent of a normal.
   pure function turned(vector)
      real(dp), intent(in) :: vector(2) !! the vector
      real(dp) :: turned(2)

      turned = [-vector(2), vector(1)]
   end function turned

   !> Sets the tangential parts to the normal ones turned by a right angle.
   pure subroutine contact_rows_set_tangents(self)
      class(contact_rows_t), intent(inout) :: self !! the rows
      integer :: i

      do i = 1, size(self%node)
         self%tangent(:, i) = turned(self%part(:, i))
      end do
   end subroutine contact_rows_set_tangents

   !> Normal, tangent and, in a twisted body, the direction around the axis, each times the share of a part, as columns
   !> (components, components) [-].
   pure function contact_rows_axes(self, part, n_components) result(axes)
      class(contact_rows_t), intent(in) :: self !! the rows
      integer, intent(in) :: part !! number of the part
      integer, intent(in) :: n_components !! number of components of a displacement
      real(dp) :: axes(n_components, n_components)

      axes = 0.0_dp
      axes(:2, 1) = self%part(:, part)
      axes(:2, 2) = self%tangent(:, part)
      axes(3:, 3:) = self%around(part)
   end function contact_rows_axes

   !> Appends the rows C of further contact points to these.
   pure subroutine contact_rows_add(self, others)
      class(contact_rows_t), intent(inout) :: self !! the rows
      type(contact_rows_t), intent(in) :: others !! the rows to add

      self%start = [self%start, size(self%node) + others%start(2:)]
      self%node = [self%node, others%node]
      self%part = reshape([self%part, others%part], [2, size(self%node)])
      self%tangent = reshape([self%tangent, others%tangent], [2, size(self%node)])
      self%around = [self%around, others%around]
   end subroutine contact_rows_add

   !> The rows C of some of the contact points.
   pure function contact_rows_picked(self, points) result(picked)
      class(contact_rows_t), intent(in) :: self !! the rows
      integer, intent(in) :: points(:) !! the points to pick
      type(contact_rows_t) :: picked
      integer, allocatable :: places(:)

      places = picked_places(self%start, points)
      picked = contact_rows_t(starts(self%start(points + 1) - self%start(points)), self%node(places), &
         self%part(:, places), self%tangent(:, places), self%around(places))
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
         rows%part(:, place)*spread(share, 1, 2), rows%tangent(:, place)*spread(share, 1, 2), rows%around(place)*share)
   end subroutine share_parts

   !> Merges the parts of a point that have the same node, and removes parts that are 0.
   pure subroutine contact_rows_merge_nodes(self)
      class(contact_rows_t), intent(inout) :: self !! the rows, their tangents not set yet
      integer :: p, i, k, n, first

      n = 0
      do p = 1, size(self%start) - 1
         first = n + 1
         do i = self%start(p), self%start(p + 1) - 1
            if (.not. any(abs(self%part(:, i)) > 0.0_dp)) cycle
            k = findloc(self%node(first:n), self%node(i), dim=1)
            if (k > 0) then
               self%part(:, first + k - 1) = self%part(:, first + k - 1) + self%part(:, i)
               self%around(first + k - 1) = self%around(first + k - 1) + self%around(i)
            else
               n = n + 1
               self%node(n) = self%node(i)
               self%part(:, n) = self%part(:, i)
               self%around(n) = self%around(i)
            end if
         end do
         self%start(p) = first
      end do
      self%start(size(self%start)) = n + 1
      self%node = self%node(:n)
      self%part = self%part(:, :n)
      self%around = self%around(:n)
   end subroutine contact_rows_merge_nodes

   !> C u: normal displacements of all points, then the tangential ones, at last those around the axis (components m)
   !> [L].
   pure function contact_rows_displacement(self, field) result(displacement)
      class(contact_rows_t), intent(in) :: self !! the rows
      real(dp), intent(in) :: field(:, :) !! displacement of all nodes (components, n_nodes) [L]
      real(dp) :: displacement(size(field, 1)*(size(self%start) - 1))
      integer :: p, i, m

      m = size(self%start) - 1
      displacement = 0.0_dp
      do p = 1, m
         do i = self%start(p), self%start(p + 1) - 1
            associate (u => field(:, self%node(i)))
               displacement(p) = displacement(p) + dot_product(self%part(:, i), u(:2))
               displacement(p + m) = displacement(p + m) + dot_product(self%tangent(:, i), u(:2))
               if (size(u) > 2) displacement(p + 2*m) = displacement(p + 2*m) + self%around(i)*u(3)
            end associate
         end do
      end do
   end function contact_rows_displacement

   !> -C^T lambda: the forces of the obstacle on the nodes (components, n_nodes) [F].
   pure function contact_rows_forces(self, force, n_nodes, n_components) result(forces)
      class(contact_rows_t), intent(in) :: self !! the rows
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) (components m) [F]
      integer, intent(in) :: n_nodes !! number of nodes
      integer, intent(in) :: n_components !! number of components of a force
      real(dp), allocatable :: forces(:, :)
      integer :: p, i, m

      m = size(self%start) - 1
      allocate (forces(n_components, n_nodes), source=0.0_dp)
      do p = 1, m
         do i = self%start(p), self%start(p + 1) - 1
            associate (on_node => forces(:, self%node(i)))
               on_node(:2) = on_node(:2) - force(p)*self%part(:, i) - force(p + m)*self%tangent(:, i)
               if (size(on_node) > 2) on_node(3) = on_node(3) - force(p + 2*m)*self%around(i)
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
      self%position = reshape([self%position, others%position], [2, n])
      self%normal = reshape([self%normal, others%normal], [2, n])
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
   pure subroutine contact_quadrature_begin(self, sizes)
      class(contact_quadrature_t), intent(inout) :: self !! the quadrature points
      integer, intent(in) :: sizes(:) !! number of entries of each point (m)

      self%start = starts(sizes)
      associate (n => sum(sizes))
         allocate (self%position(2, n), self%normal(2, n), self%outward(n), self%arc_length(n), self%gap(n), &
            self%share(n), source=0.0_dp)
      end associate
   end subroutine contact_quadrature_begin

   !> Allocates the parts of all points, all numbers 0.
   pure subroutine contact_rows_begin(self, sizes)
      class(contact_rows_t), intent(inout) :: self !! the rows
      integer, intent(in) :: sizes(:) !! number of entries of each point (m)

      self%start = starts(sizes)
      allocate (self%node(sum(sizes)), source=0)
      allocate (self%part(2, sum(sizes)), self%tangent(2, sum(sizes)), self%around(sum(sizes)), source=0.0_dp)
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
