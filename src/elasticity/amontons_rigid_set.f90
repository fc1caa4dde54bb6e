!> Sets of nodes that move as rigid bodies.
!>
!> A rigid set moves by `u = (ux - turn (y - y0), uy + turn (x - x0))` about a point, in a twisted body by
!> `u = (ux, uy, turn x)`: it turns about the axis; in space by `u = (ux, uy, uz) + (turn_x, turn_y, turn_z) x (x -
!> x0)`. These unknowns belong to two of its nodes, the leading ones: displacements to the first, turns times a length
!> to the second. Any forces with the same resultant do the same work on every motion: those that carry resultants act
!> on the two, in space on a third node, too.
module amontons_rigid_set
   use amontons_dense, only: cholesky_factor, cholesky_solve, vector_product
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_mesh, only: find_set, mesh_t
   use amontons_rounding, only: input_rounding
   implicit none (type, external)
   private

   public :: new_rigid_set, rigid_components, rigid_face_t, rigid_set_t

   !> Number of motions of a set in space.
   integer, parameter :: n_motions = 6
   !> Number of components of the displacements of its carriers.
   integer, parameter :: n_carried = 9
   !> The components of a rigid motion, as a deck writes them; in the plane the last one is called `turn`.
   character(6), parameter :: rigid_components(n_motions) = [character(6) :: 'ux', 'uy', 'uz', 'turn_x', 'turn_y', &
      'turn_z']

   !> A set that moves as a rigid body, and the point of its rotation, for a support or load.
   type :: rigid_face_t
      logical :: is_given = .false. !! whether it is
      logical :: has_point = .false.
         !! whether the point is given; else it is the middle of the extents of the set along x and y
      real(dp) :: point(3) = 0.0_dp !! the point [L]
   end type rigid_face_t

   !> A set that moves as a rigid body.
   type :: rigid_set_t
      integer, allocatable :: node(:) !! its nodes
      integer, allocatable :: component(:) !! its motions, as indices of `rigid_components`
      integer, allocatable :: lead(:) !! the leading node whose own unknown each of them is (motions)
      integer, allocatable :: axis(:) !! which of the node's own unknowns it is (motions)
      integer, allocatable :: carrier(:) !! the nodes that resultants act on: the leading ones, in space and a third one
      real(dp), allocatable :: point(:) !! the point that displacements and moment are counted about (n_dim) [L]
      real(dp), allocatable :: place(:, :) !! coordinates of the carriers (n_dim, carriers) [L]
      real(dp) :: length = 0.0_dp
         !! the length that scales turns: the distance of the leading nodes, in a twisted body the radius of the second
         !! [L]
   contains
      procedure :: displacement => rigid_set_displacement
      procedure :: own_unknowns => rigid_set_own_unknowns
      procedure :: carrier_forces => rigid_set_carrier_forces
      procedure, private :: basis => rigid_set_basis
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
      real(dp), allocatable :: height(:)
      logical :: is_met(0:mesh%n_nodes)
      integer :: first, last, set, i, k

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
               is_met(sides(:size(sides, 1) - 1, i)) = .true.
            end do
         end if
         first = last + 2
      end do
      rigid%node = pack([(i, i=1, mesh%n_nodes)], is_met(1:))
      if (size(rigid%node) < 2) then
         call new_error(error, input_refused, "the rigid set '"//names//"' needs two nodes or more")
         return
      end if
      associate (x => mesh%coordinates(:, rigid%node), n_dim => size(mesh%coordinates, 1))
         i = maxloc(merge(x(1, :), norm2(x - spread(x(:, 1), 2, size(x, 2)), dim=1), n_components > n_dim), dim=1)
         rigid%carrier = rigid%node([merge(2, 1, i == 1), i])
         rigid%component = [1, 2, 6]
         rigid%axis = [1, 2, merge(3, 1, n_components > n_dim)]
         rigid%point = 0.5_dp*(minval(x, dim=2) + maxval(x, dim=2))
         rigid%length = norm2(x(:, i) - mesh%coordinates(:, rigid%carrier(1)))
         if (n_components > n_dim) rigid%length = x(1, i)
         if (n_dim == 3) then
            rigid%component = [1, 2, 3, 4, 5, 6]
            rigid%axis = [1, 2, 3, 1, 2, 3]
            associate (along => (x(:, i) - x(:, 1))/rigid%length)
               height = [(norm2(vector_product(along, x(:, k) - x(:, 1))), k=1, size(x, 2))]
            end associate
            rigid%carrier = [rigid%carrier, rigid%node(maxloc(height, dim=1))]
            if (.not. maxval(height) > input_rounding*rigid%length) then
               call new_error(error, input_refused, "the rigid set '"//names//"' needs three nodes that do not lie "// &
                  'on a line')
               return
            end if
         end if
         rigid%lead = rigid%carrier([(merge(1, 2, k <= n_dim), k=1, size(rigid%axis))])
         if (face%has_point) rigid%point = face%point(:n_dim)
      end associate
      rigid%place = mesh%coordinates(:, rigid%carrier)
   end subroutine new_rigid_set

   !> The matrix of a node's displacement in terms of the own unknowns of the leading nodes
   !> (components, components, leading node) [-].
   pure function rigid_set_displacement(self, place) result(block)
      class(rigid_set_t), intent(in) :: self !! the set
      real(dp), intent(in) :: place(:) !! coordinates of the node (n_dim) [L]
      real(dp) :: block(maxval(self%axis), maxval(self%axis), 2)
      integer :: k

      block = 0.0_dp
      do k = 1, size(place)
         block(k, k, 1) = 1.0_dp
      end do
      if (size(place) == 3) then
         do k = 1, 3
            block(:, k, 2) = vector_product(block(:, k, 1), place - self%point)/self%length
         end do
      else if (self%axis(3) == 1) then
         block(:, 1, 2) = [self%point(2) - place(2), place(1) - self%point(1)]/self%length
      else
         block(3, 3, 2) = place(1)/self%length
      end if
   end function rigid_set_displacement

   !> The displacements of the three carriers of a set in space in terms of the six own unknowns (9, 6) [-].
   pure function rigid_set_basis(self) result(basis)
      class(rigid_set_t), intent(in) :: self !! the set
      real(dp) :: basis(n_carried, n_motions)
      integer :: k

      do k = 1, 3
         basis(3*k - 2:3*k, :) = reshape(self%displacement(self%place(:, k)), [3, n_motions])
      end do
   end function rigid_set_basis

   !> The own unknowns of the leading nodes in a rigid motion (components, 2) [L].
   pure function rigid_set_own_unknowns(self, moved) result(own)
      class(rigid_set_t), intent(in) :: self !! the set
      real(dp), intent(in) :: moved(:, :) !! displacements of the carriers (components, carriers) [L]
      real(dp) :: own(size(moved, 1), 2), block(size(moved, 1), size(moved, 1), 2)
      real(dp) :: basis(n_carried, n_motions), gram(n_motions, n_motions), unknown(n_motions)
      integer :: info

      if (size(self%axis) == n_motions) then
         basis = self%basis()
         gram = matmul(transpose(basis), basis)
         unknown = matmul(reshape(moved, [n_carried]), basis)
         call cholesky_factor(gram, info)
         call cholesky_solve(gram, unknown)
         own = reshape(unknown, [3, 2])
         return
      end if
      own(:, 1) = moved(:, 1)
      own(:, 2) = 0.0_dp
      if (self%axis(3) > 1) then
         own(3, :) = [0.0_dp, moved(3, 2)]
      else
         own(1, 2) = dot_product([self%place(2, 1) - self%place(2, 2), self%place(1, 2) - self%place(1, 1)], &
            moved(:, 2) - moved(:, 1))/self%length
         block = self%displacement(self%place(:, 1))
         own(:, 1) = moved(:, 1) - block(:, 1, 2)*own(1, 2)
      end if
   end function rigid_set_own_unknowns

   !> Forces on the carriers with a given resultant (components, carriers) [F].
   pure function rigid_set_carrier_forces(self, resultant) result(forces)
      class(rigid_set_t), intent(in) :: self !! the set
      real(dp), intent(in) :: resultant(:) !! force, and moment about the point or the axis, by motions [F, F L]
      real(dp) :: forces(maxval(self%axis), size(self%carrier))
      real(dp) :: arm(2), moment
      real(dp) :: basis(n_carried, n_motions), gram(n_motions, n_motions), unknown(n_motions)
      integer :: info

      if (size(self%axis) == n_motions) then
         basis = self%basis()
         gram = matmul(transpose(basis), basis)
         unknown = [resultant(:3), resultant(4:)/self%length]
         call cholesky_factor(gram, info)
         call cholesky_solve(gram, unknown)
         forces = reshape(matmul(basis, unknown), [3, 3])
         return
      end if
      forces = 0.0_dp
      forces(:2, 1) = resultant(:2)
      forces(3:, 2) = resultant(3)/self%length
      if (self%axis(3) > 1) return
      arm = self%point - self%place(:, 1)
      moment = resultant(3) + arm(1)*resultant(2) - arm(2)*resultant(1)
      arm = self%place(:, 2) - self%place(:, 1)
      forces(:, 2) = moment/self%length**2*[-arm(2), arm(1)]
      forces(:, 1) = forces(:, 1) - forces(:, 2)
   end function rigid_set_carrier_forces

end module amontons_rigid_set
