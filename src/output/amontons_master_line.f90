!> Lines of the masters of contact pairs, as the grid of the contact line has them behind the points of the slaves, and
!> how the displacements of contact points are made up of those of either side.
module amontons_master_line
   use amontons_contact_rows, only: contact_rows_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: has_pairs, master_line_t, new_master_line, side_rows

   !> The lines of all masters, one after the other; a node of two masters occurs in both.
   type :: master_line_t
      integer :: n_nodes = 0 !! number of nodes
      integer, allocatable :: node(:) !! the nodes (n_nodes)
      integer, allocatable :: set(:) !! the contact set that each belongs to (n_nodes)
      real(dp), allocatable :: normal(:, :) !! unit outward normals of the masters there (2, n_nodes) [-]
      integer, allocatable :: segment(:, :) !! places in `node` of the ends of each line segment (2, segments)
   contains
      procedure :: forces => master_line_forces
   end type master_line_t

contains

   !> Whether any contact set meets another deformable body.
   pure logical function has_pairs(zone)
      type(contact_zone_t), intent(in) :: zone !! the contact points

      has_pairs = any(zone%pairs%master%n_sides > 0)
   end function has_pairs

   !> Finds the lines of the masters; a side with a node in its middle is two segments.
   pure subroutine new_master_line(line, zone)
      type(master_line_t), intent(out) :: line !! the lines
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer :: set, side

      allocate (line%node(0), line%set(0), line%segment(2, 0), line%normal(2, 0))
      do set = 1, size(zone%pairs)
         associate (master => zone%pairs(set)%master)
            do side = 1, master%n_sides
               if (master%side(3, side) > 0) then
                  call add_segment(line, set, master%side([1, 3], side), master%normal(:, [1, 3], side))
                  call add_segment(line, set, master%side([3, 2], side), master%normal(:, [3, 2], side))
               else
                  call add_segment(line, set, master%side(:2, side), master%normal(:, :2, side))
               end if
            end do
         end associate
      end do
      line%n_nodes = size(line%node)
   end subroutine new_master_line

   !> Adds a segment, and its ends where they are new.
   pure subroutine add_segment(line, set, ends, normals)
      type(master_line_t), intent(inout) :: line !! the lines
      integer, intent(in) :: set !! number of the contact set
      integer, intent(in) :: ends(2) !! the nodes at its ends
      real(dp), intent(in) :: normals(2, 2) !! their normals [-]
      integer :: place(2), i

      do i = 1, 2
         place(i) = findloc(line%node == ends(i) .and. line%set == set, .true., dim=1)
         if (place(i) > 0) cycle
         line%node = [line%node, ends(i)]
         line%set = [line%set, set]
         place(i) = size(line%node)
         line%normal = reshape([line%normal, normals(:, i)], [2, place(i)])
      end do
      line%segment = reshape([line%segment, place], [2, size(line%segment, 2) + 1])
   end subroutine add_segment

   !> The forces of the contact points on the nodes of the masters (2, n_nodes) [F].
   pure function master_line_forces(self, zone, force, n_nodes) result(forces)
      class(master_line_t), intent(in) :: self !! the lines
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) (2m) [F]
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      real(dp) :: forces(2, self%n_nodes)
      type(contact_rows_t) :: rows
      real(dp), allocatable :: on_nodes(:, :)
      integer :: set, k

      rows = side_rows(zone, .true.)
      do set = 1, size(zone%pairs)
         if (.not. any(self%set == set)) cycle
         on_nodes = rows%forces(merge(force, 0.0_dp, [zone%set == set, zone%set == set]), n_nodes)
         do k = 1, self%n_nodes
            if (self%set(k) == set) forces(:, k) = on_nodes(:, self%node(k))
         end do
      end do
   end function master_line_forces

   !> The rows of the contact points without the nodes of their masters, or of these alone. All nodes are those of the
   !> slave where the obstacle is rigid.
   pure function side_rows(zone, of_master) result(rows)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      logical, intent(in) :: of_master !! whether the nodes of the masters are wanted
      type(contact_rows_t) :: rows
      logical :: is_wanted(size(zone%rows%node))
      integer :: p, i

      allocate (rows%start(zone%n_points + 1), source=1)
      do p = 1, zone%n_points
         associate (master => zone%pairs(zone%set(p))%master)
            do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
               is_wanted(i) = .not. of_master
               if (master%n_sides > 0) is_wanted(i) = any(master%side(:3, :) == zone%rows%node(i)) .eqv. of_master
            end do
            rows%start(p + 1) = rows%start(p) + count(is_wanted(zone%rows%start(p):zone%rows%start(p + 1) - 1))
         end associate
      end do
      rows%node = pack(zone%rows%node, is_wanted)
      rows%part = reshape(pack(zone%rows%part, spread(is_wanted, 1, 2)), [2, size(rows%node)])
      rows%tangent = reshape(pack(zone%rows%tangent, spread(is_wanted, 1, 2)), [2, size(rows%node)])
   end function side_rows

end module amontons_master_line
