!> The error in the constitutive relation of a solved contact problem on three-node triangles: how far the stresses of
!> its displacements are from a stress field in equilibrium with the loads and with contact tractions that obey the
!> contact law, and the law's own error besides (Coorevits, Hild and Hjiaj, SIAM J. Sci. Comput. 23, 2001).
!>
!> Without friction, or for a given slip bound, it is never below the error of the stresses. The contact forces of the
!> nodes become tractions that are linear on every side; what the nodal forces change by is put right by one more
!> solution for the displacements, which the stress field is made of.
module amontons_error_bound
   use amontons_body, only: body_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_rows, only: turned
   use amontons_contact_solution, only: contact_solution_t
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_element, only: tri3
   use amontons_equilibrated_sides, only: element_forces_t, find_element_forces, find_side_moments
   use amontons_equilibrated_stress, only: stress_distance
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_tractions_t
   use amontons_load_case, only: load_case_t, recover_displacement
   use amontons_loads, only: sum_body_force
   use amontons_quantity, only: quantity_t
   implicit none (type, external)
   private

   public :: error_bound_t, find_error_bound, has_error_bound

   !> The error in the constitutive relation.
   type :: error_bound_t
      real(dp) :: norm = 0.0_dp !! the error, in the norm of the error estimate [sqrt(F L)]
      logical :: is_bound = .false. !! whether the error of the stresses is never larger; an estimate otherwise
   contains
      procedure :: quantities => error_bound_quantities
   end type error_bound_t

   !> A side between two contact points, with the tractions at both: along the normals and along the tangents.
   type :: contact_side_t
      integer :: element !! its element
      integer :: place !! its place in the element
      integer :: point(2) !! the contact points at its ends, 0 for none
      real(dp) :: area !! its length times the depth of the body [L^2]
      real(dp) :: share(2) !! how many times the force over the area of each point the traction is there [-]
   end type contact_side_t

contains

   !> Finds the error of a body that `has_error_bound`; not with a rotation or forces on single nodes.
   subroutine find_error_bound(bound, body, problem, load_case, solution, displacement, tractions)
      type(error_bound_t), allocatable, intent(out) :: bound !! the error; not allocated where there is none
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      type(contact_solution_t), intent(in) :: solution !! the solution of the contact problem
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(known_tractions_t), intent(inout) :: tractions
         !! tractions that are known but for those of contact, which they gain
      ! What residuals of the contact problem leave, and far below any force on a single node.
      real(dp), parameter :: negligible = 1.0e-7_dp
      type(element_forces_t), allocatable :: inside(:)
      type(contact_side_t), allocatable :: sides(:)
      real(dp), allocatable :: body_force(:, :), balanced(:, :), change(:), force(:, :), moment(:, :, :, :)
      real(dp) :: distance, imbalance
      logical :: is_uniform

      call sum_body_force(body_force, is_uniform, body%mesh, body%materials, load_case%loads)
      if (.not. is_uniform) return
      call find_sides(sides, body, load_case, solution%force)
      force = reshape(solution%force, [body%zone%n_points, 2])
      call balance_rigid_motions(force, body, sides)
      change = solution%force - nodal_forces(sides, body, force)
      where (body%zone%is_tangent_fixed) change(body%zone%n_points + 1:) = 0.0_dp
      call solve_stiffness(problem, norm2(solution%force), change)
      call recover_displacement(balanced, body, load_case, solution%displacement + change)
      call add_tractions(tractions, sides, body, force)
      call find_element_forces(inside, body%mesh, body%materials, body_force, balanced, displacement, &
         load_case%thermal_strain)
      call find_side_moments(moment, imbalance, body%mesh, body%constraints, tractions, inside)
      if (.not. imbalance < negligible) return
      distance = stress_distance(body%mesh, body%materials, moment, body_force, inside, displacement, &
         load_case%thermal_strain)
      allocate (bound)
      bound%norm = sqrt(distance**2 + 2.0_dp*law_error(sides, body, load_case, solution, force))
      bound%is_bound = all(load_case%friction <= 0.0_dp) .and. &
         (all(load_case%slip_bound <= 0.0_dp) .or. problem%is_held)
   end subroutine find_error_bound

   !> Whether a body is a plane one of three-node triangles, without springs, its contact points nodes of its own.
   pure logical function has_error_bound(body)
      type(body_t), intent(in) :: body !! the body

      has_error_bound = all(body%mesh%element_kind == tri3) .and. .not. (body%is_axisymmetric &
         .or. size(body%springs) > 0 .or. any(body%zone%is_cell)) .and. size(body%zone%rows%node) == body%zone%n_points
   end function has_error_bound

   !> Lists the sides of the contact sets, and which share of the force of a point is on each.
   pure subroutine find_sides(sides, body, load_case, force)
      type(contact_side_t), allocatable, intent(out) :: sides(:) !! the sides
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      integer, allocatable :: point(:)
      integer :: i, k, n, p

      allocate (point(body%mesh%n_nodes), source=0)
      do p = 1, body%zone%n_points
         point(body%zone%node(p)) = p
      end do
      n = 0
      do i = 1, size(load_case%contacts)
         n = n + size(body%mesh%sets(body%mesh%find_set(load_case%contacts(i)%set))%element)
      end do
      allocate (sides(n))
      n = 0
      do i = 1, size(load_case%contacts)
         associate (set => body%mesh%sets(body%mesh%find_set(load_case%contacts(i)%set)))
            do k = 1, size(set%element)
               n = n + 1
               call place_side(sides(n), body, set%element(k), set%side(k), point)
            end do
         end associate
      end do
      if (.not. any(load_case%slip_bound > 0.0_dp)) call leave_open_sides(sides, body%zone%area, force)
   end subroutine find_sides

   !> Puts the forces of points on the sides that are closed at both ends, so that no traction acts across the end of a
   !> contact. A point without such a side keeps both; a slip bound would be exceeded.
   pure subroutine leave_open_sides(sides, area, force)
      type(contact_side_t), intent(inout) :: sides(:) !! the sides
      real(dp), intent(in) :: area(:) !! tributary area of the points (m) [L^2]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]
      real(dp) :: closed_area(size(area))
      integer :: i, k, p

      closed_area = 0.0_dp
      do i = 1, size(sides)
         if (.not. is_closed(sides(i), force)) cycle
         closed_area(sides(i)%point) = closed_area(sides(i)%point) + 0.5_dp*sides(i)%area
      end do
      do i = 1, size(sides)
         do k = 1, 2
            p = sides(i)%point(k)
            if (p == 0) cycle
            if (closed_area(p) > 0.0_dp) sides(i)%share(k) = merge(area(p)/closed_area(p), 0.0_dp, &
               is_closed(sides(i), force))
         end do
      end do
   end subroutine leave_open_sides

   !> Places a side of a contact set.
   pure subroutine place_side(side, body, element, place, point)
      type(contact_side_t), intent(out) :: side !! the side
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: element !! its element
      integer, intent(in) :: place !! its place in the element
      integer, intent(in) :: point(:) !! the contact point of each node, 0 for none (n_nodes)
      integer :: nodes(3)

      nodes = body%mesh%side(element, place)
      side = contact_side_t(element, place, point(nodes(:2)), norm2(body%mesh%coordinates(:, nodes(2)) - &
         body%mesh%coordinates(:, nodes(1)))*body%materials%list(body%materials%of_element(element))%thickness, 1.0_dp)
   end subroutine place_side

   !> Whether pressure acts at both ends of a side.
   pure logical function is_closed(side, force)
      type(contact_side_t), intent(in) :: side !! the side
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (2m) [F]

      is_closed = all(side%point > 0)
      if (is_closed) is_closed = all(force(side%point) > 0.0_dp)
   end function is_closed

   !> The tractions at the ends of a side that forces on the points make, along normals and tangents (end, component)
   !> [F/L^2].
   pure function side_tractions(side, body, force) result(traction)
      type(contact_side_t), intent(in) :: side !! the side
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:, :) !! forces along normals and tangents (m, 2) [F]
      real(dp) :: traction(2, 2)
      integer :: k

      traction = 0.0_dp
      do k = 1, 2
         if (side%point(k) > 0) traction(k, :) = side%share(k)*force(side%point(k), :)/body%zone%area(side%point(k))
      end do
   end function side_tractions

   !> The nodal forces of the tractions that forces on the points make (lambda_N; lambda_T) (2m) [F].
   pure function nodal_forces(sides, body, force) result(nodal)
      type(contact_side_t), intent(in) :: sides(:) !! the sides
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:, :) !! forces along normals and tangents (m, 2) [F]
      real(dp), allocatable :: nodal(:)
      real(dp), allocatable :: at_point(:, :)
      real(dp) :: traction(2, 2), on_side(2)
      integer :: i, k, l

      allocate (at_point(2, body%zone%n_points), source=0.0_dp)
      do i = 1, size(sides)
         traction = side_tractions(sides(i), body, force)
         do k = 1, 2
            if (sides(i)%point(k) == 0) cycle
            do l = 1, 2
               if (sides(i)%point(l) == 0) cycle
               ! The tractions of each end keep the normal of that end.
               associate (normal => body%zone%normal(:, sides(i)%point(l)), &
                  own => body%zone%normal(:, sides(i)%point(k)))
                  on_side = sides(i)%area/6.0_dp*merge(2.0_dp, 1.0_dp, k == l) &
                     *(traction(l, 1)*normal + traction(l, 2)*turned(normal))
                  associate (sum => at_point(:, sides(i)%point(k)))
                     sum = sum + [dot_product(on_side, own), dot_product(on_side, turned(own))]
                  end associate
               end associate
            end do
         end do
      end do
      nodal = [at_point(1, :), at_point(2, :)]
   end function nodal_forces

   !> Changes forces on the points so little, each by a factor of its own, that their tractions do the same work on the
   !> rigid motions that supports leave free.
   pure subroutine balance_rigid_motions(force, body, sides)
      real(dp), intent(inout) :: force(:, :) !! forces along normals and tangents (m, 2) [F]
      type(body_t), intent(in) :: body !! the body
      type(contact_side_t), intent(in) :: sides(:) !! the sides
      real(dp), allocatable :: motion(:, :), gram(:, :), right(:, :), weighted(:, :)
      integer :: i, k, info

      motion = body%rigid_modes
      if (size(motion, 2) == 0) return
      allocate (gram(size(motion, 2), size(motion, 2)), right(size(motion, 2), 1))
      do k = 1, size(motion, 2)
         weighted = spread(motion(:size(force, 1), k), 2, 2)*force
         gram(:, k) = matmul(nodal_forces(sides, body, weighted), motion)
      end do
      right(:, 1) = matmul(reshape(force, [size(force)]) - nodal_forces(sides, body, force), motion)
      gram = 0.5_dp*(gram + transpose(gram))
      call cholesky_factor(gram, info)
      if (info /= 0) return
      call cholesky_solve(gram, right)
      weighted = force
      do i = 1, size(motion, 2)
         force = force + right(i, 1)*spread(motion(:size(force, 1), i), 2, 2)*weighted
      end do
   end subroutine balance_rigid_motions

   !> Adds the contact tractions to those of the loads.
   pure subroutine add_tractions(tractions, sides, body, force)
      type(known_tractions_t), intent(inout) :: tractions !! the tractions on the boundary
      type(contact_side_t), intent(in) :: sides(:) !! the sides of the contact sets
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:, :) !! forces along normals and tangents (m, 2) [F]
      real(dp) :: at_ends(2, 2), traction(2, 2)
      integer :: i, k

      do i = 1, size(sides)
         at_ends = side_tractions(sides(i), body, force)
         traction = 0.0_dp
         do k = 1, 2
            if (sides(i)%point(k) == 0) cycle
            associate (normal => body%zone%normal(:, sides(i)%point(k)))
               traction(:, k) = -at_ends(k, 1)*normal - at_ends(k, 2)*turned(normal)
            end associate
         end do
         call tractions%add(sides(i)%element, sides(i)%place, traction)
      end do
   end subroutine add_tractions

   !> Solves S x = b by conjugate gradients. S may be singular, if b does no work on its kernel.
   subroutine solve_stiffness(problem, scale, x)
      type(contact_problem_t), intent(in) :: problem !! the contact problem
      real(dp), intent(in) :: scale !! norm of the contact forces, which b changes [F]
      real(dp), intent(inout) :: x(:) !! b on entry, the solution on return (2m)
      ! What is left is far below what is negligible.
      real(dp), parameter :: small = 1.0e-9_dp
      real(dp), allocatable :: rest(:), direction(:), product(:)
      real(dp) :: square, before
      integer :: i

      allocate (product(size(x)))
      rest = x
      direction = x
      x = 0.0_dp
      square = dot_product(rest, rest)
      do i = 1, 10*size(x)
         if (.not. square > (small*scale)**2) return
         call problem%multiply_stiffness(direction, product)
         associate (step => square/dot_product(direction, product))
            x = x + step*direction
            rest = rest - step*product
         end associate
         before = square
         square = dot_product(rest, rest)
         direction = rest + square/before*direction
      end do
   end subroutine solve_stiffness

   !> By how much tractions and displacements miss the contact law: pressure times gap, and what the friction that could
   !> act dissipates less what acts [F L].
   pure real(dp) function law_error(sides, body, load_case, solution, force) result(error)
      type(contact_side_t), intent(in) :: sides(:) !! the sides
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case
      type(contact_solution_t), intent(in) :: solution !! the solution
      real(dp), intent(in) :: force(:, :) !! forces along normals and tangents (m, 2) [F]
      real(dp) :: traction(2, 2), gap(2), slip(2), limit(2)
      integer :: i, k, m, p

      m = body%zone%n_points
      error = 0.0_dp
      do i = 1, size(sides)
         traction = side_tractions(sides(i), body, force)
         gap = 0.0_dp
         slip = 0.0_dp
         limit = 0.0_dp
         do k = 1, 2
            p = sides(i)%point(k)
            if (p == 0) cycle
            gap(k) = max(0.0_dp, load_case%free_gap(p) - solution%displacement(p))
            if (.not. body%zone%is_tangent_fixed(p)) slip(k) = solution%displacement(m + p) - load_case%anchor(p)
            limit(k) = load_case%slip_bound(p)/body%zone%area(p) + load_case%friction(p)*traction(k, 1)
         end do
         error = error + sides(i)%area/6.0_dp*(work(traction(:, 1), gap) + work(limit, abs(slip)) &
            - work(traction(:, 2), slip))
      end do
   end function law_error

   !> Six times the mean product of two values that are linear along a side.
   pure real(dp) function work(a, b)
      real(dp), intent(in) :: a(2) !! one at both ends
      real(dp), intent(in) :: b(2) !! the other

      work = 2.0_dp*dot_product(a, b) + a(1)*b(2) + a(2)*b(1)
   end function work

   !> The error under its names.
   pure function error_bound_quantities(self) result(list)
      class(error_bound_t), intent(in) :: self !! the error
      type(quantity_t) :: list(1)

      if (self%is_bound) then
         list = quantity_t('error_bound', 'Bound of the error', self%norm, dimension='sqrt(F L)')
      else
         list = quantity_t('constitutive_error', 'Constitutive error', self%norm, dimension='sqrt(F L)')
      end if
   end function error_bound_quantities

end module amontons_error_bound
