!> The contact problem: the small problem on the contact points to which a body is condensed, and the active set, an
!> assumption on the state of every point that turns the contact law into linear equations.
!>
!> The displacements v = (u_N; u_T) of m contact points and the forces lambda = (lambda_N; lambda_T) obey `S v = q -
!> lambda`, which is (2.1) of the paper condensed to the points, and the contact law, its (2.2), with the distance u_N -
!> d to the obstacle and the slip u_T - a from the anchor; only load histories have anchors. S is symmetric and positive
!> semidefinite; its kernel is that of the rigid motions that only contact holds. A reduced problem comes without S, in
!> the dual form `v = v_free - A lambda` with a compliance A that may be semidefinite. All vectors list the m normal
!> components first, the m tangential ones after them: n = 2m. In space the m components along a second tangent follow,
!> n = 3m; any two perpendicular tangents will do, since the law is isotropic.
!>
!> States of a point: closed, u_N = d; open, lambda_N = 0; stick, u_T = a; slip along s = +1 or -1, lambda_T = s (g +
!> phi lambda_N). In space s is a unit vector, that of y = lambda_T + rho_T (u_T - a) where the set is derived. Across s
!> acts a spring, lambda_T = s (g + phi lambda_N) + k (I - s s^T) (u_T - a), k = c/(1 - c) rho_T, c = (g + phi
!> lambda_N)/|y|: the derivative of the law (Alart and Curnier). Two active sets are equal if the states of all points
!> are, whatever s.
module amontons_contact_problem
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_contact_operator, only: contact_operator_t
   use amontons_friction_law, only: contact_status, cut_to_bound, disc_violation, law_violation, open_point, &
      slip_plus, slip_point, tangential_norm
   use amontons_kinds, only: dp
   use amontons_rounding, only: computed_rounding, sum_rounding
   use amontons_symmetric_matrix, only: turned_pairs
   implicit none (type, external)
   private

   public :: active_set_t, contact_problem_t, new_contact_problem, new_reduced_problem

   !> Load, gap, anchor and friction on the contact points, and the operator that they share with other problems of the
   !> same body: a copy of a problem has the same operator, which must outlive both. A reduced problem has
   !> `free_displacement` in the place of `load`.
   type :: contact_problem_t
      integer :: n_points = 0 !! number m of contact points
      type(contact_operator_t), pointer :: matrix => null() !! S, or A of a reduced problem, of n rows
      real(dp), allocatable :: load(:) !! condensed load q (n) [F]
      real(dp), allocatable :: free_displacement(:) !! displacements v_free without contact forces (n) [L]
      real(dp), allocatable :: gap(:) !! initial distance d to the obstacle along the normal (m) [L]
      real(dp), allocatable :: anchor(:) !! tangential displacements a that slips are counted from (n - m) [L]
      real(dp), allocatable :: friction(:) !! Coulomb coefficient phi (m) [-]
      real(dp), allocatable :: slip_bound(:) !! given slip bound g, added to phi lambda_N (m) [F]
      real(dp), allocatable :: softness(:)
         !! E of springs in S between the body and points that depend on each other: S (v - E lambda) = q - lambda; not
         !! allocated without them (n) [L/F]
      real(dp) :: prescribed = 0.0_dp !! largest displacement that supports prescribe; it acts through the load [L]
      real(dp) :: rounding = 0.0_dp
         !! largest force that S gives a point under a rigid motion of a loose body, over its largest displacement [F/L]
      real(dp) :: uncanceled(2) = 0.0_dp
         !! size of the nodal forces of loads, and of those of heat, which cancel but for rounding [F]
   contains
      procedure :: bound => contact_problem_bound
      procedure :: count_from => contact_problem_count_from
      procedure :: cut => contact_problem_cut
      procedure :: displacement => contact_problem_displacement
      procedure :: dual_load => contact_problem_dual_load
      procedure :: force_scale => contact_problem_force_scale
      procedure :: from => contact_problem_from
      procedure :: is_unloaded => contact_problem_is_unloaded
      procedure :: largest => contact_problem_largest
      procedure :: reference => contact_problem_reference
      procedure :: measure => contact_problem_measure
      procedure :: residual => contact_problem_residual
      procedure :: strained => contact_problem_strained
      procedure :: status => contact_problem_status
      procedure :: violation => contact_problem_violation
      procedure :: violation_weights => contact_problem_violation_weights
   end type contact_problem_t

   !> Share of two forces below which rounding errors make up their difference; energies that cancel leave as much [-].
   real(dp), parameter, public :: rounding_share = 1.0e-5_dp

   !> The assumed state of every point.
   type :: active_set_t
      logical, allocatable :: is_closed(:) !! whether it touches (m)
      integer, allocatable :: slip_direction(:) !! sign of its slip along `axes`, 0 if it sticks (m)
      real(dp), allocatable :: axes(:, :)
         !! in space, direction s that each point slides along or would slide along (2, m) [-]
      real(dp), allocatable :: spring(:) !! in space, stiffness k across it (m) [F/L]
   contains
      procedure :: equals => active_set_equals
      procedure :: gives_force => active_set_gives_force
      procedure :: update => active_set_update
      procedure :: assume_stick => active_set_assume_stick
      procedure :: impose => active_set_impose
      procedure :: slip_axes => active_set_slip_axes
      procedure :: turn => active_set_turn
   end type active_set_t

contains

   !> Makes a contact problem without load, gap, anchor, friction or slip bound.
   subroutine new_contact_problem(problem, matrix)
      type(contact_problem_t), intent(out) :: problem !! the problem; set its load, gap and friction next
      type(contact_operator_t), target, intent(inout) :: matrix
         !! the operator, with a stiffness; must outlive the problem

      problem%matrix => matrix
      associate (m => problem%n_points)
         m = matrix%n/(1 + matrix%n_tangents)
         allocate (problem%load(matrix%n), problem%gap(m), problem%anchor(matrix%n - m), problem%friction(m), &
            problem%slip_bound(m), source=0.0_dp)
      end associate
   end subroutine new_contact_problem

   !> Makes a reduced problem: the free displacements include the gaps; there are no anchors and no given slip bound.
   subroutine new_reduced_problem(problem, matrix, free_displacement, friction)
      type(contact_problem_t), intent(out) :: problem !! the problem
      type(contact_operator_t), target, intent(inout) :: matrix !! the operator, a compliance; must outlive the problem
      real(dp), intent(in) :: free_displacement(:)
         !! displacements without contact forces, the normal ones counted from the obstacle on (n) [L]
      real(dp), intent(in) :: friction(:) !! Coulomb coefficient phi (m) [-]

      problem%matrix => matrix
      problem%n_points = size(friction)
      problem%free_displacement = free_displacement
      problem%friction = friction
      associate (m => problem%n_points)
         allocate (problem%gap(m), problem%anchor(matrix%n - m), problem%slip_bound(m), source=0.0_dp)
      end associate
   end subroutine new_reduced_problem

   !> Changes the origin of the displacements, v = c + w: S w = q - S c - lambda. Small displacements w keep their
   !> digits beside a large c.
   pure subroutine contact_problem_count_from(self, center)
      class(contact_problem_t), intent(inout) :: self !! the problem, with a stiffness
      real(dp), contiguous, intent(in) :: center(:) !! c (n) [L]
      real(dp) :: stiffening(self%matrix%n)

      call self%matrix%multiply_stiffness(center, stiffening)
      self%load = self%load - stiffening
      self%gap = self%gap - center(:self%n_points)
      self%anchor = self%anchor - center(self%n_points + 1:)
   end subroutine contact_problem_count_from

   !> The problem for the displacements relative to a rigid motion, which strains nothing and causes no forces.
   function contact_problem_from(self, motion) result(problem)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: motion(:) !! displacements of the points under the motion (n) [L]
      type(contact_problem_t) :: problem

      problem = self
      problem%gap = self%gap - motion(:self%n_points)
      problem%anchor = self%anchor - motion(self%n_points + 1:)
   end function contact_problem_from

   !> The slip bounds g + phi max(0, lambda_N) for given normal forces (m) [F].
   pure function contact_problem_bound(self, normal_force) result(bound)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: normal_force(:) !! lambda_N (m) [F]
      real(dp), allocatable :: bound(:)

      bound = self%slip_bound + self%friction*max(0.0_dp, normal_force)
   end function contact_problem_bound

   !> Forces cut to the contact law: tension becomes 0, and friction is limited to the bound of the resulting normal
   !> force (n) [F].
   pure function contact_problem_cut(self, force) result(cut)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: force(:) !! the forces (n) [F]
      real(dp) :: cut(size(force))

      cut(:self%n_points) = max(0.0_dp, force(:self%n_points))
      cut(self%n_points + 1:) = cut_to_bound(force(self%n_points + 1:), self%bound(cut(:self%n_points)))
   end function contact_problem_cut

   !> The largest magnitude of a normal or tangential component of a vector, in space of a tangential vector; 0 for an
   !> empty one.
   pure real(dp) function contact_problem_largest(self, vector) result(largest)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: vector(:) !! the vector (n)

      if (self%matrix%n_tangents == 1) then
         largest = maxval(abs(vector))
      else
         largest = max(maxval(abs(vector(:self%n_points))), &
            maxval(tangential_norm(vector(self%n_points + 1:), self%n_points)))
      end if
   end function contact_problem_largest

   !> The displacements (d; a) that the contact law counts distances and slips from (n) [L].
   pure function contact_problem_reference(self) result(reference)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), allocatable :: reference(:)

      reference = [self%gap, self%anchor]
   end function contact_problem_reference

   !> The dual load of the paper's (2.3), B = v_free - (d; a), where v_free = A (q + alpha v_k) with the proximal center
   !> v_k unless the problem is a reduced one and gives it (n) [L].
   pure function contact_problem_dual_load(self, center) result(b)
      class(contact_problem_t), intent(in) :: self !! the problem, its compliance prepared
      real(dp), intent(in) :: center(:) !! v_k; without effect for a held body (n) [L]
      real(dp), allocatable :: b(:)

      if (.not. self%matrix%has_stiffness()) then
         b = self%free_displacement
      else
         allocate (b(self%matrix%n))
         call self%matrix%compliance%multiply(self%load + self%matrix%proximal_parameter*center, b)
      end if
      b = b - self%reference()
   end function contact_problem_dual_load

   !> The displacements v = B - A lambda + (d; a) for given forces (n) [L].
   pure function contact_problem_displacement(self, dual_load, force) result(displacement)
      class(contact_problem_t), intent(in) :: self !! the problem, its compliance prepared
      real(dp), intent(in) :: dual_load(:) !! B (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      real(dp), allocatable :: displacement(:)

      allocate (displacement(self%matrix%n))
      call self%matrix%compliance%multiply(force, displacement)
      displacement = dual_load - displacement + self%reference()
   end function contact_problem_displacement

   !> Whether zero forces and displacements are a solution: nothing loads the body, no point overlaps its obstacle, and
   !> none with a given slip bound has slipped.
   pure logical function contact_problem_is_unloaded(self) result(is_unloaded)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp) :: acting(self%matrix%n)

      if (.not. self%matrix%has_stiffness()) then
         acting = self%dual_load(self%free_displacement)
         acting(:self%n_points) = max(0.0_dp, acting(:self%n_points))
      else
         acting = abs(self%load)
         associate (m => self%n_points)
            acting(:m) = acting(:m) + max(max(0.0_dp, -self%gap), self%slip_bound*tangential_norm(self%anchor, m))
         end associate
      end if
      is_unloaded = .not. any(abs(acting) > 0.0_dp)
   end function contact_problem_is_unloaded

   !> The force scale, by which residuals are divided: `largest_acting_force`. Without any, the force
   !> that would close the smallest gap, or 1 if there is no gap [F]. It is at least a small share of what cancels in
   !> the loads and, with v known, of the largest terms of S v, which covers their rounding errors.
   pure real(dp) function contact_problem_force_scale(self, contact_force, displacement) result(scale)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in), optional :: contact_force(:) !! lambda (n) [F]
      real(dp), intent(in), optional :: displacement(:) !! v (n) [L]

      scale = max(largest_acting_force(self, contact_force, displacement), rounding_share*sum(self%uncanceled))
      if (present(displacement) .and. self%matrix%is_held .and. .not. self%matrix%is_loose &
         .and. self%matrix%has_stiffness()) then
         scale = max(scale, rounding_share*self%largest(self%matrix%largest_terms()*displacement))
      end if
      if (scale > 0.0_dp) return
      scale = minval(self%matrix%augmentation(:self%n_points)*self%gap, mask=self%gap > 0.0_dp)
      if (.not. any(self%gap > 0.0_dp)) scale = 1.0_dp
   end function contact_problem_force_scale

   !> The largest force on a point if all points were held at their gaps and anchors (in a reduced problem, if it alone
   !> were held). If all these forces are rounding errors of the forces by interference and prescribed displacements of
   !> single points, a share of the latter [F].
   !>
   !> A loose body moves out of an interference without forces: if the forces are known, the scale is at most these and
   !> the loads, as far as rounding allows. Of loads by heat or prescribed displacements a share counts. A loose body
   !> that follows prescribed displacements may do so without forces; the rounding errors of S are then in its forces.
   pure real(dp) function largest_acting_force(self, contact_force, displacement) result(scale)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in), optional :: contact_force(:) !! lambda (n) [F]
      real(dp), intent(in), optional :: displacement(:) !! v (n) [L]
      real(dp), parameter :: share_of_moves = 1.0e-3_dp ! residuals within tolerance are larger than rounding errors
      real(dp), parameter :: share_at_rest = 1.0e-2_dp ! the same where no load can press; stiff parts round more
      real(dp), parameter :: far = 1.0e3_dp ! a body that moves so many times as far as supports flees
      real(dp), parameter :: least_residual = 1.0e-11_dp ! a tenth of the tolerance is rounding of a loose body's S
      real(dp), dimension(self%matrix%n) :: held, force
      real(dp) :: acting, uncanceled

      uncanceled = 0.0_dp
      if (.not. self%matrix%has_stiffness()) then
         force = self%matrix%augmentation*self%dual_load(self%free_displacement)
      else
         held = [min(0.0_dp, self%gap), self%anchor]
         force = self%load
         if (any(abs(held) > 0.0_dp)) then
            call self%matrix%multiply_stiffness(held, force)
            force = self%load - force
         end if
         uncanceled = maxval(self%matrix%augmentation)*(self%prescribed + self%largest(held))
      end if
      scale = self%largest(force)
      if (scale <= sum_rounding*uncanceled) scale = rounding_share*uncanceled
      if (present(contact_force) .and. self%matrix%has_stiffness()) then
         acting = max(merge(share_of_moves, 1.0_dp, self%prescribed > 0.0_dp)*self%largest(self%load), &
            self%largest(contact_force))
         if (acting > 0.0_dp) scale = min(scale, max(acting, rounding_share*uncanceled))
      end if
      if (present(contact_force) .and. present(displacement) .and. self%prescribed > 0.0_dp .and. &
         (self%matrix%is_loose .or. .not. self%matrix%is_held)) then
         uncanceled = maxval(self%matrix%augmentation)*self%prescribed
         if (self%largest(displacement) <= far*self%prescribed .and. self%largest(contact_force) <= &
            computed_rounding*uncanceled) scale = max(scale, self%rounding/least_residual*self%largest(displacement), &
            merge(share_of_moves, share_at_rest, self%uncanceled(1) > 0.0_dp)*uncanceled)
      end if
   end function largest_acting_force

   !> Weights of the violations at each point. In a reduced problem the violation of a point is divided by its own
   !> scale, which is the force scale or the force of the largest free displacement at this point, whichever is larger:
   !> otherwise stiff points, whose forces are large, would hide violations at soft ones (m) [-].
   pure function contact_problem_violation_weights(self) result(weight)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), allocatable :: weight(:)
      real(dp) :: rho(self%matrix%n), length

      allocate (weight(self%n_points), source=1.0_dp)
      if (self%matrix%has_stiffness()) return
      length = self%largest(self%dual_load(self%free_displacement))
      if (.not. length > 0.0_dp) return
      rho = self%matrix%augmentation
      associate (m => self%n_points)
         weight = max(1.0_dp, self%force_scale()/(length*min(rho(:m), rho(m + 1:2*m))))
      end associate
   end function contact_problem_violation_weights

   !> The displacements that S belongs to: v - E lambda (n) [L].
   pure function contact_problem_strained(self, displacement, force) result(strained)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      real(dp), allocatable :: strained(:)

      strained = displacement
      if (allocated(self%softness)) strained = displacement - self%softness*force
   end function contact_problem_strained

   !> The residual of a pair (v, lambda) [-].
   pure real(dp) function contact_problem_residual(self, displacement, force) result(residual)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), contiguous, intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      real(dp) :: scale

      call self%measure(displacement, force, residual, scale)
   end function contact_problem_residual

   !> The residual of a pair (v, lambda): the largest violation of `S v = q - lambda`, or of `v = v_free - A lambda`
   !> turned into forces, and of the contact law, weighted and divided by the force scale. It depends on no method and
   !> no unit, and is zero at a solution only; it is huge if numbers are not finite.
   pure subroutine contact_problem_measure(self, displacement, force, residual, scale)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), contiguous, intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      real(dp), intent(out) :: residual !! the residual [-]
      real(dp), intent(out) :: scale !! the force scale of the pair [F]
      real(dp) :: imbalance(self%matrix%n)
      integer :: i

      if (.not. self%matrix%has_stiffness()) then
         call self%matrix%compliance%multiply(force, imbalance)
         imbalance = [(self%violation_weights(), i=0, self%matrix%n_tangents)]*self%matrix%augmentation*(imbalance &
            - self%free_displacement + displacement)
      else
         call self%matrix%multiply_stiffness(self%strained(displacement, force), imbalance)
         imbalance = imbalance - self%load + force
      end if
      scale = self%force_scale(force, displacement)
      ! maxval ignores NaN.
      residual = huge(residual)
      if (.not. all(ieee_is_finite(imbalance))) return
      residual = max(self%largest(imbalance), self%violation(displacement, force))/scale
   end subroutine contact_problem_measure

   !> The largest weighted violation of the contact law by a pair (v, lambda) [F].
   pure real(dp) function contact_problem_violation(self, displacement, force) result(violation)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      real(dp) :: rho(self%matrix%n), at_points(self%n_points)
      integer :: m

      m = self%n_points
      rho = self%matrix%augmentation
      if (self%matrix%n_tangents == 2) then
         associate (slip => displacement(m + 1:) - self%anchor)
            at_points = max(abs(min(force(:m), rho(:m)*(self%gap - displacement(:m)))), disc_violation( &
               force(m + 1:2*m), force(2*m + 1:), slip(:m), slip(m + 1:), self%bound(force(:m)), rho(m + 1:2*m)))
         end associate
         violation = maxval(self%violation_weights()*at_points)
         return
      end if
      violation = max(0.0_dp, maxval(self%violation_weights()*law_violation(force(:m), displacement(:m) - self%gap, &
         force(m + 1:), displacement(m + 1:) - self%anchor, self%friction, self%slip_bound, rho(:m), rho(m + 1:))))
   end function contact_problem_violation

   !> Status of every point of a pair (v, lambda): the active bound of the law; open without a force (m).
   pure function contact_problem_status(self, displacement, force) result(status)
      class(contact_problem_t), intent(in) :: self !! the problem
      real(dp), intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      integer, allocatable :: status(:)
      real(dp) :: augmented(self%matrix%n)
      integer :: m

      m = self%n_points
      augmented = force + self%matrix%augmentation*(displacement - self%reference())
      if (self%matrix%n_tangents == 1) then
         status = contact_status(augmented(:m), augmented(m + 1:), self%friction, self%slip_bound)
      else
         status = contact_status(augmented(:m), tangential_norm(augmented(m + 1:), m), self%friction, self%slip_bound)
         where (status == slip_plus) status = slip_point
      end if
      where (max(abs(force(:m)), tangential_norm(force(m + 1:), m)) <= 0.0_dp) status = open_point
   end function contact_problem_status

   !> Assumes that every point is closed and sticks, except for points so far from the obstacle that pulling them to the
   !> nearest point's gap would take more force than there is; a point without any slip bound slips.
   pure subroutine active_set_assume_stick(self, problem, rho, force_scale)
      class(active_set_t), intent(inout) :: self !! the active set
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: rho(:) !! stiffness that turns displacements into forces (n) [F/L]
      real(dp), intent(in) :: force_scale !! the force that residuals are measured by [F]

      self%is_closed = rho(:problem%n_points)*(problem%gap - minval(problem%gap)) <= problem%n_points*force_scale
      self%slip_direction = merge(0, 1, problem%friction + problem%slip_bound > 0.0_dp)
      if (problem%matrix%n_tangents == 1) return
      self%axes = spread([1.0_dp, 0.0_dp], 2, problem%n_points)
      self%spring = spread(0.0_dp, 1, problem%n_points)
   end subroutine active_set_assume_stick

   !> Sets the active set to that of a pair (v, lambda): the branch of the law on which the augmented forces lie.
   pure subroutine active_set_update(self, problem, rho, displacement, force)
      class(active_set_t), intent(inout) :: self !! the active set
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(in) :: rho(:) !! stiffness that turns displacements into forces (n) [F/L]
      real(dp), intent(in) :: displacement(:) !! v (n) [L]
      real(dp), intent(in) :: force(:) !! lambda (n) [F]
      ! Keeps the spring finite at a point that hardly slides; less than the true share makes convergence linear there.
      real(dp), parameter :: most_share = 0.9999_dp
      real(dp) :: augmented(problem%matrix%n), bound(problem%n_points), length(problem%n_points)
      integer :: i

      augmented = force + rho*(displacement - problem%reference())
      associate (m => problem%n_points)
         bound = problem%bound(augmented(:m))
         self%is_closed = augmented(:m) > 0.0_dp
         if (problem%matrix%n_tangents == 1) then
            self%slip_direction = merge(nint(sign(1.0_dp, augmented(m + 1:))), 0, abs(augmented(m + 1:)) > bound)
         else
            length = tangential_norm(augmented(m + 1:), m)
            self%slip_direction = merge(1, 0, length > bound)
            self%axes = spread([1.0_dp, 0.0_dp], 2, m)
            do i = 1, m
               if (length(i) > 0.0_dp) self%axes(:, i) = augmented([m + i, 2*m + i])/length(i)
            end do
            length = min(most_share, bound/max(length, bound, tiny(1.0_dp)))
            self%spring = length/(1.0_dp - length)*rho(m + 1:2*m)
         end if
         where (.not. bound > 0.0_dp) self%slip_direction = 1
      end associate
   end subroutine active_set_update

   !> Sets the forces that the active set determines, in a vector of forces in equilibrium with displacements.
   pure subroutine active_set_impose(self, problem, force, imbalance)
      class(active_set_t), intent(in) :: self !! the active set
      type(contact_problem_t), intent(in) :: problem !! the problem
      real(dp), intent(inout) :: force(:) !! q - S v, and then lambda (n) [F]
      real(dp), intent(out) :: imbalance !! the largest change by that [F]
      real(dp) :: balanced(size(force))
      integer :: m

      m = problem%n_points
      balanced = force
      where (.not. self%is_closed) force(:m) = 0.0_dp
      call self%turn(force, 1)
      associate (direction => self%slip_direction)
         where (direction /= 0) force(m + 1:2*m) = direction*(problem%slip_bound + problem%friction*force(:m))
      end associate
      call self%turn(force, -1)
      imbalance = max(0.0_dp, problem%largest(force - balanced))
   end subroutine active_set_impose

   !> Whether the force of each component is unknown and its displacement given: the normal one of closed points, the
   !> tangential ones of sticking points; for the others the displacement is unknown (n).
   pure function active_set_gives_force(self) result(gives_force)
      class(active_set_t), intent(in) :: self !! the active set
      logical, allocatable :: gives_force(:)

      gives_force = [self%is_closed, self%slip_direction == 0]
      if (allocated(self%axes)) gives_force = [gives_force, self%slip_direction == 0]
   end function active_set_gives_force

   !> In space the axes of the tangents, with the first one along the slip where a point slides (2, m) [-].
   pure function active_set_slip_axes(self) result(axes)
      class(active_set_t), intent(in) :: self !! the active set
      real(dp) :: axes(2, size(self%slip_direction))
      integer :: p

      do p = 1, size(self%slip_direction)
         axes(:, p) = merge([1.0_dp, 0.0_dp], self%axes(:, p), self%slip_direction(p) == 0)
      end do
   end function active_set_slip_axes

   !> Turns the tangential components of each point to the axes along and across its slip, or back; unchanged in the
   !> plane.
   pure subroutine active_set_turn(self, vector, sense)
      class(active_set_t), intent(in) :: self !! the active set
      real(dp), intent(inout) :: vector(:) !! the vector (n)
      integer, intent(in) :: sense !! 1 to the axes, -1 back

      if (allocated(self%axes)) vector = turned_pairs(vector, self%slip_axes(), sense)
   end subroutine active_set_turn

   !> Whether two active sets are the same.
   pure logical function active_set_equals(self, other) result(equals)
      class(active_set_t), intent(in) :: self !! the active set
      type(active_set_t), intent(in) :: other !! the other

      equals = all(self%is_closed .eqv. other%is_closed) .and. all(self%slip_direction == other%slip_direction)
   end function active_set_equals

end module amontons_contact_problem
