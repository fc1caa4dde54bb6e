!> Sets of nodes that move as rigid bodies: `u = (ux - turn (y - y0), uy + turn (x - x0))` about a point, in a twisted
!> body `u = (ux, uy, turn x)`, which turns about its axis.
!>
!> The three unknowns belong to two of the nodes, the leading ones: ux and uy to the first, turn times a length to the
!> second. Any forces on the two with the same resultant do the same work on every motion.
module amontons_rigid_set
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_mesh, only: find_set, mesh_t
   implicit none (type, external)
   private

   public :: new_rigid_set, rigid_components, rigid_face_t, rigid_set_t

   !> The components of a rigid motion, as a deck writes them.
   character(4), parameter :: rigid_components(3) = [character(4) :: 'ux', 'uy', 'turn']

   !> A set that moves as a rigid body, and the point of its rotation, for a support or load.
   type :: rigid_face_t
      logical :: is_given = .false. !! whether it is
      logical :: has_point = .false. !! whether the point is given; else it is the middle of the set
      real(dp) :: point(2) = 0.0_dp !! the point [L]
   end type rigid_face_t

   !> A set that moves as a rigid body.
   type :: rigid_set_t
      integer, allocatable :: node(:) !! its nodes
      integer :: lead(3) = 0 !! the nodes whose own unknowns are ux, uy and turn; the first two are the same
      integer :: axis(3) = [1, 2, 1] !! which of their own unknowns these are
      real(dp) :: point(2) = 0.0_dp !! the point that displacements and moment are counted about [L]
      real(dp) :: place(2, 2) = 0.0_dp !! coordinates of the leading nodes [L]
      real(dp) :: length = 0.0_dp
         !! the length that scales the turn: their distance, in a twisted body the radius of the second [L]
   contains
      procedure :: displacement => rigid_set_displacement
      procedure :: lead_forces => rigid_set_lead_forces
   end type rigid_set_t

contains

   !> Finds the nodes of one or several boundary or node sets.
   subroutine new_rigid_set(rigid, mesh, names, face, n_components, error)
      type(rigid_set_t), intent(out) :: rigid !! the set
      type(mesh_t), intent(in) :: mesh !! the mesh
      character(*), intent(in) :: names !! names of the sets, separated by commas
      type(rigid_face_t), intent(in) :: face !! the point
      integer, intent(in) :: n_components !! number of components of a displacement, 3 in a twisted body
      type(error_t), allocatable, intent(out) :: error !! no such set, an empty name, one twice, or one node only
      character(:), allocatable :: name, seen
      integer, allocatable :: sides(:, :)
      logical :: is_met(0:mesh%n_nodes)
      integer :: first, last, set, i

      is_met = .false.
      first = 1
      seen = ','
      do while (first <= len(names) + 1)
         last = index(names(first:)//',', ',') + first - 2
         name = trim(adjustl(names(first:last)))
         if (len(name) == 0 .or. index(seen, ','//name//',') > 0) call new_error(error, input_refused, &
            "set = '"//names//"' has a name that is empty or stands twice")
         if (allocated(error)) return
         seen = seen//name//','
         set = find_set(mesh%node_sets, name)
         if (set > 0) is_met(mesh%node_sets(set)%node) = .true.
         if (set == 0 .or. find_set(mesh%sets, name) > 0) then
            call mesh%set_sides(name, sides, error)
            if (allocated(error)) return
            do i = 1, size(sides, 2)
               is_met(sides(:3, i)) = .true.
            end do
         end if
         first = last + 2
      end do
      rigid%node = pack([(i, i=1, mesh%n_nodes)], is_met(1:))
      if (size(rigid%node) < 2) then
         call new_error(error, input_refused, "the rigid set '"//names//"' needs two nodes or more")
         return
      end if
      associate (x => mesh%coordinates(:, rigid%node))
         i = maxloc(merge(x(1, :), hypot(x(1, :) - x(1, 1), x(2, :) - x(2, 1)), n_components > 2), dim=1)
         rigid%lead = rigid%node([merge(2, 1, i == 1), merge(2, 1, i == 1), i])
         rigid%axis(3) = 2*n_components - 3
         rigid%point = 0.5_dp*(minval(x, dim=2) + maxval(x, dim=2))
      end associate
      if (face%has_point) rigid%point = face%point
      rigid%place = mesh%coordinates(:, rigid%lead(2:))
      rigid%length = merge(rigid%place(1, 2), norm2(rigid%place(:, 2) - rigid%place(:, 1)), n_components > 2)
   end subroutine new_rigid_set

   !> The matrix of a node's displacement in terms of the own unknowns of the leading nodes
   !> (components, components, leading node) [-].
   pure function rigid_set_displacement(self, place) result(block)
      class(rigid_set_t), intent(in) :: self !! the set
      real(dp), intent(in) :: place(2) !! coordinates of the node [L]
      real(dp) :: block(max(2, self%axis(3)), max(2, self%axis(3)), 2)

      block = 0.0_dp
      block(1, 1, 1) = 1.0_dp
      block(2, 2, 1) = 1.0_dp
      block(3:, 3:, 2) = place(1)/self%length
      if (self%axis(3) == 1) block(:, 1, 2) = [self%point(2) - place(2), place(1) - self%point(1)]/self%length
   end function rigid_set_displacement

   !> Forces on the leading nodes with a given resultant (components, 2) [F].
   pure function rigid_set_lead_forces(self, resultant) result(forces)
      class(rigid_set_t), intent(in) :: self !! the set
      real(dp), intent(in) :: resultant(3) !! force along x and y, moment about the point or the axis [F, F L]
      real(dp) :: forces(max(2, self%axis(3)), 2)
      real(dp) :: arm(2), moment

      forces = 0.0_dp
      forces(:2, 1) = resultant(:2)
      forces(3:, 2) = resultant(3)/self%length
      if (self%axis(3) > 1) return
      arm = self%point - self%place(:, 1)
      moment = resultant(3) + arm(1)*resultant(2) - arm(2)*resultant(1)
      arm = self%place(:, 2) - self%place(:, 1)
      forces(:, 2) = moment/self%length**2*[-arm(2), arm(1)]
      forces(:, 1) = forces(:, 1) - forces(:, 2)
   end function rigid_set_lead_forces

end module amontons_rigid_set
