!> Bodies that turn without end on a round contact line, or slide along a flat one, although friction holds them back.
!>
!> `check_balance` lets normal forces be as large as they like, and friction with them: that of forces on opposite sides
!> of a hole bears any moment. How large they are follows from the solution alone. A free rigid motion that the normals
!> of the round line do no work on is opposed by friction alone; where the loads' work on it is more than all that
!> friction can take at the normal forces found, unequal facets of the mesh bear the rest, or the method finds no
!> equilibrium. Where it finds none, or all friction is used up, a weak spring against the motion shows what the normal
!> forces are while the body turns, before facets have wedged it.
module amontons_spin
   use amontons_auto, only: auto_t
   use amontons_body, only: body_t, find_rigid_modes, largest_motion
   use amontons_contact_operator, only: contact_operator_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_rows, only: turned
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: symmetric_eigenvectors
   use amontons_equilibrium, only: round_normals
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   use amontons_methods, only: solve_components
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   public :: can_spin, check_spin, find_spin

contains

   !> Refuses the solution of a contact problem that friction cannot hold.
   subroutine check_spin(body, is_in_reach, problem, solution, error)
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: solution !! what a method found, converged or not
      type(error_t), allocatable, intent(out) :: error !! there is no equilibrium; names the motion
      real(dp), allocatable :: amounts(:)
      character(:), allocatable :: motion

      call find_spin(amounts, body, is_in_reach, problem, solution)
      if (.not. allocated(amounts)) return
      motion = largest_motion(body%motions, amounts)
      if (solution%is_converged .and. is_round(body%zone)) then
         call new_error(error, numerical_failure, 'no equilibrium but for the irregularities of the mesh: on the '// &
            'round line that its nodes lie on friction is exhausted and cannot balance the loads; '//motion// &
            '; add a support or friction')
      else
         call new_error(error, numerical_failure, 'no equilibrium: all contact points slip, and friction cannot '// &
            'balance the loads; '//motion//'; add a support or friction')
      end if
   end subroutine check_spin

   !> Whether the normal of some point is not that of the round line through it.
   pure logical function is_round(zone)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      ! What rounding leaves of normals that agree.
      real(dp), parameter :: same = 1.0e-9_dp

      is_round = any(abs(round_normals(zone) - zone%normal) > same)
   end function is_round

   !> Whether a body has a motion that friction alone opposes where all points are in reach that are now.
   logical function can_spin(body, is_in_reach)
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      real(dp), allocatable :: spins(:, :)

      can_spin = size(body%rigid_modes, 2) > 0
      if (.not. can_spin) return
      call new_spins(spins, on_round_line(body%zone, body%motions), body, is_in_reach)
      can_spin = size(spins, 2) > 0
   end function can_spin

   !> Finds a motion that friction cannot hold.
   subroutine find_spin(amounts, body, is_in_reach, problem, solution)
      real(dp), allocatable, intent(out) :: amounts(:)
         !! amounts of the free motions of each piece; not allocated if friction holds them (motions)
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points can close (m)
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(contact_solution_t), intent(in) :: solution !! what a method found, converged or not
      real(dp), allocatable :: on_round(:, :), spins(:, :), force(:)

      if (size(body%rigid_modes, 2) == 0) return
      ! Loads drive a spin: without any, all that forces leave is rounding errors.
      if (.not. any(abs(problem%load) > 0.0_dp)) return
      on_round = on_round_line(body%zone, body%motions)
      call new_spins(spins, on_round, body, is_in_reach)
      if (size(spins, 2) == 0) return
      associate (modes => body%rigid_modes)
         if (solution%is_converged) then
            call find_unbalanced(amounts, problem, solution%force, spins, on_round, modes)
            if (allocated(amounts)) return
            if (.not. is_exhausted(problem, solution%force, spins, on_round, modes)) return
         end if
         call find_forces_of_spin(force, problem, matmul(modes, spins))
         if (allocated(force)) call find_unbalanced(amounts, problem, force, spins, on_round, modes)
      end associate
   end subroutine find_spin

   !> Finds the spin that loads drive by more than friction can take at given normal forces.
   pure subroutine find_unbalanced(amounts, problem, force, spins, on_round, modes)
      real(dp), allocatable, intent(out) :: amounts(:)
         !! amounts of the free motions of each piece; not allocated if friction holds them (motions)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: force(:) !! contact forces (2m) [F]
      real(dp), intent(in) :: spins(:, :) !! amounts of the free motions (motions, spins)
      real(dp), intent(in) :: on_round(:, :) !! displacements of the points in frames of the round line (2m, motions)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points in their own (2m, motions) [-]
      ! As much as the balance before the solution leaves to the mesh; where the mesh has no say, what methods leave.
      real(dp), parameter :: unbalanced_when_round = 1.0e-2_dp, unbalanced = 1.0e-8_dp, same = 1.0e-9_dp
      real(dp) :: motion(2*problem%n_points), drive, capacity, allowed

      allowed = merge(unbalanced_when_round, unbalanced, any(abs(on_round - modes) > same))
      amounts = matmul(matmul(matmul(problem%load, modes) - matmul(force, on_round), spins), transpose(spins))
      motion = matmul(on_round, amounts)
      associate (m => problem%n_points, load => problem%load)
         drive = dot_product(load, matmul(modes, amounts)) - dot_product(force(:m), motion(:m))
         capacity = sum(problem%bound(force(:m))*abs(motion(m + 1:)))
         if (.not. drive > capacity + allowed*sum(abs(load*matmul(modes, amounts)))) deallocate (amounts)
      end associate
   end subroutine find_unbalanced

   !> Whether all friction acts against the spin that the loads drive. A round line then still turns, and what its
   !> facets leave of a normal displacement wedges it in the end: normal forces, and friction with them, grow until they
   !> bear the loads.
   pure logical function is_exhausted(problem, force, spins, on_round, modes)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: force(:) !! contact forces that a method found (2m) [F]
      real(dp), intent(in) :: spins(:, :) !! amounts of the free motions (motions, spins)
      real(dp), intent(in) :: on_round(:, :) !! displacements of the points in frames of the round line (2m, motions)
      real(dp), intent(in) :: modes(:, :) !! displacements of the points in their own (2m, motions) [-]
      ! What facets leave of the tangents of the round line.
      real(dp), parameter :: almost = 0.99_dp
      real(dp) :: motion(2*problem%n_points), capacity

      motion = matmul(on_round, matmul(matmul(matmul(problem%load, modes), spins), transpose(spins)))
      associate (m => problem%n_points)
         capacity = sum(problem%bound(force(:m))*abs(motion(m + 1:)))
         is_exhausted = capacity > 0.0_dp .and. dot_product(force(m + 1:), motion(m + 1:)) >= almost*capacity
      end associate
   end function is_exhausted

   !> Displacements of the contact points under the free motions, along the normals and tangents of the round line that
   !> they lie on (2m, motions) [-].
   pure function on_round_line(zone, motions) result(on_round)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(rigid_motions_t), intent(in) :: motions(:) !! the free motions of each piece
      real(dp), allocatable :: on_round(:, :)
      real(dp), allocatable :: modes(:, :)
      real(dp) :: normals(2, zone%n_points), along, across
      integer :: p, m

      m = zone%n_points
      normals = round_normals(zone)
      call find_rigid_modes(modes, zone, motions)
      allocate (on_round, mold=modes)
      do p = 1, m
         along = dot_product(normals(:, p), zone%normal(:, p))
         across = dot_product(normals(:, p), turned(zone%normal(:, p)))
         on_round(p, :) = along*modes(p, :) + across*modes(m + p, :)
         on_round(m + p, :) = along*modes(m + p, :) - across*modes(p, :)
      end do
   end function on_round_line

   !> Finds the free motions that all points in reach follow along the tangents of the round line.
   subroutine new_spins(spins, on_round, body, is_in_reach)
      real(dp), allocatable, intent(out) :: spins(:, :) !! amounts of the free motions, orthonormal (motions, spins)
      real(dp), intent(in) :: on_round(:, :) !! displacements of the points in frames of the round line (2m, motions)
      type(body_t), intent(in) :: body !! the body
      logical, intent(in) :: is_in_reach(:) !! which points count (m)
      ! A square: what meshes of curves leave of a thousandth of the motion.
      real(dp), parameter :: negligible = 1.0e-6_dp
      real(dp), allocatable :: along_normals(:, :), gram(:, :), values(:)
      integer :: i, info, m

      m = size(is_in_reach)
      associate (modes => body%rigid_modes)
         allocate (along_normals, source=merge(on_round(:m, :), 0.0_dp, spread(is_in_reach, 2, size(modes, 2))))
         allocate (gram, source=matmul(transpose(along_normals), along_normals))
         allocate (values(size(gram, 1)))
         call symmetric_eigenvectors(gram, values, info)
         if (info /= 0) values = huge(1.0_dp)
         associate (is_spin => [(values(i) <= negligible*sum(matmul(modes, gram(:, i))**2), i=1, size(values))])
            spins = gram(:, pack([(i, i=1, size(values))], is_spin))
         end associate
      end associate
   end subroutine new_spins

   !> Finds the contact forces while a body spins: those of the problem with weak springs against the motions.
   subroutine find_forces_of_spin(force, problem, spins)
      real(dp), allocatable, intent(out) :: force(:) !! the contact forces; not allocated if none are found (2m) [F]
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: spins(:, :) !! displacements of the points under each motion (2m, spins) [-]
      ! Points slip before such springs bear much; matrices of more points are left alone: they take minutes.
      real(dp), parameter :: weak = 1.0e-3_dp
      integer, parameter :: most_points = 2000
      type(contact_operator_t), target :: matrix
      type(contact_problem_t) :: held
      type(contact_solution_t) :: found
      type(auto_t) :: method
      type(error_t), allocatable :: error
      real(dp) :: stiffness
      integer :: i

      if (problem%n_points > most_points) return
      call problem%matrix%copy_dense(matrix, error)
      if (allocated(error)) return
      held = problem
      held%matrix => matrix
      do i = 1, size(spins, 2)
         stiffness = weak*maxval(problem%augmentation())/sum(spins(:, i)**2)
         call matrix%add_motion(stiffness, spins(:, i))
      end do
      call new_contact_solution(found, problem%n_points)
      call solve_components(method, held, found, error)
      if (allocated(error) .or. .not. found%is_converged) return
      force = found%force
   end subroutine find_forces_of_spin

end module amontons_spin
