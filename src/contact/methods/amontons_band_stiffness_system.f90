!> Newton's linear system in the displacements of a whole slender body, whose condensed stiffness is never made; and a
!> start for Newton's method on it.
!>
!> The rows of K u = f that hold an unknown displacement, the interior's among them; closed u_N and sticking u_T are
!> known, and a closed sliding point has its tangential row less phi times its normal one. It gives the same steps as
!> the condensed stiffness does.
module amontons_band_stiffness_system
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_active_set, only: active_set_t
   use amontons_band_matrix, only: band_lu_t, new_band_matrix
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: bounded
   use amontons_kinds, only: dp
   use amontons_newton_system, only: newton_system_t
   implicit none (type, external)
   private

   public :: band_stiffness_system_t, spring_start_t

   !> The equations of one active set, by position.
   type :: equations_t
      logical, allocatable :: is_known(:) !! whether the displacement is known (n)
      real(dp), allocatable :: known(:) !! the known displacements, 0 else (n) [L]
      real(dp), allocatable :: stiffening(:) !! what is added to the diagonal (n) [F/L]
      real(dp), allocatable :: load(:) !! loads, with what goes with the stiffening (n) [F]
      real(dp), allocatable :: slope(:) !! how many times the normal row is taken off a point's tangential one (m) [-]
      real(dp), allocatable :: coupling(:) !! stiffness of a point's slip against its normal displacement (m) [F/L]
   end type equations_t

   !> The system, with room for its factors.
   type, extends(newton_system_t) :: band_stiffness_system_t
      private
      type(band_lu_t) :: factors !! the factors of the last active set
   contains
      procedure, public :: solve => band_stiffness_system_solve
      procedure :: solve_softened => band_stiffness_system_solve_softened
      procedure :: solve_equations => band_stiffness_system_solve_equations
   end type band_stiffness_system_t

   !> A first pair of forces and displacements found in a way that lets fronts of opening or sliding pass, which
   !> Newton's steps move by a few points each: by springs between the points and the obstacle, so soft at first that
   !> the ends of the line feel each other, and so hard at last that neighbors hardly do.
   type, extends(contact_method_t) :: spring_start_t
   contains
      procedure :: solve => spring_start_solve
   end type spring_start_t

contains

   !> Finds the pair of the hardest springs.
   subroutine spring_start_solve(self, problem, solution, error)
      class(spring_start_t), intent(in) :: self !! the method
      type(contact_problem_t), intent(in) :: problem !! the problem, on a band
      type(contact_solution_t), intent(inout) :: solution !! the result
      type(error_t), allocatable, intent(out) :: error !! never allocated; kept for the common interface
      real(dp), parameter :: hardest = 10.0_dp, factor = 10.0_dp
      integer, parameter :: most_steps = 4
      type(band_stiffness_system_t) :: system
      type(active_set_t) :: active_set, last
      real(dp), dimension(2*problem%n_points) :: rho, next, force, no_force
      real(dp) :: scale, hardness
      integer :: step, info, m

      m = problem%n_points
      call solution%reset()
      rho = problem%augmentation()
      scale = problem%force_scale()
      no_force = 0.0_dp
      call active_set%assume_stick(problem, rho, scale)
      hardness = 1.0_dp/real(m, dp)**2
      do while (hardness <= hardest)
         do step = 1, most_steps
            call system%solve_softened(problem, active_set, hardness*rho, next, force, info)
            if (info /= 0 .or. solution%n_iterations >= self%max_iterations) exit
            solution%displacement = next
            call solution%record_residual(problem%violation(next, force)/scale)
            last = active_set
            call active_set%update(problem, hardness*rho, next, no_force)
            if (active_set%equals(last)) exit
         end do
         ! Forces of the springs, cut to the contact law: Newton's first active set is that of these springs.
         solution%force = hardness*rho*(solution%displacement - problem%reference())
         hardness = factor*hardness
      end do
      solution%force(:m) = max(0.0_dp, solution%force(:m))
      solution%force(m + 1:) = bounded(solution%force(m + 1:), problem%bound(solution%force(:m)))
      solution%effort = system%effort
      call solution%measure(problem)
   end subroutine spring_start_solve

   !> Solves for the displacements, then takes the forces from the equilibrium.
   subroutine band_stiffness_system_solve(self, problem, active_set, regularization, displacement, force, imbalance, &
      info)
      class(band_stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a band stiffness
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: regularization !! regularization, as part of the diagonal of S [-]
      real(dp), intent(inout) :: displacement(:) !! v before the step, and after it (2m) [L]
      real(dp), intent(inout) :: force(:) !! lambda before the step, and after it (2m) [F]
      real(dp), intent(out) :: imbalance !! largest violation of the equilibrium by the pair after the step [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      type(equations_t) :: equations
      real(dp), allocatable :: x(:), balanced(:)
      integer :: m

      m = problem%n_points
      imbalance = 0.0_dp
      associate (band => problem%matrix%band, place => problem%matrix%band%place)
         call new_equations(equations, problem, active_set%slip_direction)
         equations%is_known(place) = active_set%gives_force()
         equations%known(place) = merge(problem%reference(), 0.0_dp, equations%is_known(place))
         equations%stiffening(place) = regularization*band%diagonal
         equations%load(place) = equations%load(place) + regularization*band%diagonal*displacement
         equations%slope = merge(problem%friction*active_set%slip_direction, 0.0_dp, active_set%is_closed)
         call self%solve_equations(problem, equations, x, info)
         if (info /= 0) return
         displacement = x(place)
         allocate (balanced(size(x)))
         call band%whole%multiply(x, balanced)
         balanced(place) = balanced(place) - problem%load
         force = -balanced(place)
         balanced(place) = 0.0_dp
         call active_set%impose(problem, force, imbalance)
         imbalance = max(imbalance, maxval(abs(balanced)))
      end associate
      call self%effort%multiply(1.0_dp)
   end subroutine band_stiffness_system_solve

   !> Solves with springs between the points and the obstacle.
   subroutine band_stiffness_system_solve_softened(self, problem, active_set, springs, displacement, force, info)
      class(band_stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem, with a band stiffness
      type(active_set_t), intent(in) :: active_set !! state of each point
      real(dp), intent(in) :: springs(:) !! stiffness of the springs (2m) [F/L]
      real(dp), intent(out) :: displacement(:) !! v (2m) [L]
      real(dp), intent(out) :: force(:) !! lambda (2m) [F]
      integer, intent(out) :: info !! 0, or nonzero where the system is singular
      type(equations_t) :: equations
      real(dp), allocatable :: x(:)
      integer :: m

      m = problem%n_points
      associate (place => problem%matrix%band%place)
         call new_equations(equations, problem, active_set%slip_direction)
         equations%stiffening(place) = merge(springs, 0.0_dp, active_set%gives_force())
         equations%load(place) = equations%load(place) + equations%stiffening(place)*problem%reference()
         equations%coupling = active_set%slip_direction*problem%friction*equations%stiffening(place(:m))
         equations%load(place(m + 1:)) = equations%load(place(m + 1:)) + equations%coupling*problem%gap
         call self%solve_equations(problem, equations, x, info)
         displacement = x(place)
         call problem%matrix%band%whole%multiply(x, equations%load)
         force = problem%load - equations%load(place)
      end associate
   end subroutine band_stiffness_system_solve_softened

   !> The equations of a body that nothing touches, but for the given slip bounds.
   pure subroutine new_equations(equations, problem, direction)
      type(equations_t), intent(out) :: equations !! the equations
      type(contact_problem_t), intent(in) :: problem !! the problem
      integer, intent(in) :: direction(:) !! sign of the slip of each point, 0 if it sticks (m)

      associate (n => problem%matrix%band%whole%n, m => problem%n_points)
         allocate (equations%is_known(n), source=.false.)
         allocate (equations%known(n), equations%stiffening(n), equations%load(n), source=0.0_dp)
         allocate (equations%slope(m), equations%coupling(m), source=0.0_dp)
         equations%load(problem%matrix%band%place) = problem%load - [spread(0.0_dp, 1, m), direction*problem%slip_bound]
      end associate
   end subroutine new_equations

   !> Solves the equations, with one step of refinement: the condition of a slender body is high.
   subroutine band_stiffness_system_solve_equations(self, problem, equations, x, info)
      class(band_stiffness_system_t), intent(inout) :: self !! the system
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      real(dp), allocatable, intent(out) :: x(:) !! all displacements by position (n) [L]
      integer, intent(out) :: info !! 0, or nonzero where the equations have no finite solution
      real(dp), allocatable :: right(:)

      call fill_matrix(self%factors, problem, equations)
      call self%factors%factorize(info)
      call self%effort%factorize(.true.)
      x = equations%known
      if (info /= 0) return
      right = residual(problem, equations, x)
      call self%factors%solve(right)
      x = x + right
      right = residual(problem, equations, x)
      call self%factors%solve(right)
      x = x + right
      if (.not. all(ieee_is_finite(x))) info = 1
   end subroutine band_stiffness_system_solve_equations

   !> Fills the matrix; the rows and columns of known displacements are those of the unit matrix.
   pure subroutine fill_matrix(matrix, problem, equations)
      type(band_lu_t), intent(inout) :: matrix !! the matrix
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      integer :: i, j

      associate (whole => problem%matrix%band%whole, is_known => equations%is_known)
         ! A tangential row reaches as far as its normal one.
         call new_band_matrix(matrix, whole%n, whole%width + problem%matrix%band%reach)
         do j = 1, whole%n
            if (is_known(j)) then
               call matrix%add(j, j, 1.0_dp)
               cycle
            end if
            call matrix%add(j, j, whole%entry(1, j) + equations%stiffening(j))
            do i = j + 1, min(whole%n, j + whole%width)
               if (is_known(i)) cycle
               call matrix%add(i, j, whole%entry(i - j + 1, j))
               call matrix%add(j, i, whole%entry(i - j + 1, j))
            end do
         end do
      end associate
      call add_slip_rows(matrix, problem, equations)
   end subroutine fill_matrix

   !> Adds to the tangential rows of sliding points what goes with the normal force.
   pure subroutine add_slip_rows(matrix, problem, equations)
      type(band_lu_t), intent(inout) :: matrix !! the matrix
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      integer :: j, p

      associate (whole => problem%matrix%band%whole, is_known => equations%is_known, slope => equations%slope, &
         normal => problem%matrix%band%place(:problem%n_points), &
         tangential => problem%matrix%band%place(problem%n_points + 1:))
         do p = 1, problem%n_points
            if (abs(equations%coupling(p)) > 0.0_dp) call matrix%add(tangential(p), normal(p), equations%coupling(p))
            if (.not. abs(slope(p)) > 0.0_dp) cycle
            do j = max(1, normal(p) - whole%width), min(whole%n, normal(p) + whole%width)
               if (.not. is_known(j)) call matrix%add(tangential(p), j, -slope(p)*whole%element(normal(p), j))
            end do
         end do
      end associate
   end subroutine add_slip_rows

   !> What given displacements leave of the load; 0 where they are known (n) [F].
   pure function residual(problem, equations, x)
      type(contact_problem_t), intent(in) :: problem !! the problem
      type(equations_t), intent(in) :: equations !! the equations
      real(dp), intent(in) :: x(:) !! all displacements by position (n) [L]
      real(dp) :: residual(size(x))
      integer :: m

      m = problem%n_points
      associate (normal => problem%matrix%band%place(:m), tangential => problem%matrix%band%place(m + 1:))
         call problem%matrix%band%whole%multiply(x, residual)
         residual(tangential) = residual(tangential) - equations%slope*(residual(normal) - problem%load(:m))
         residual = equations%load - residual - equations%stiffening*x
         residual(tangential) = residual(tangential) - equations%coupling*x(normal)
      end associate
      where (equations%is_known) residual = 0.0_dp
   end function residual

end module amontons_band_stiffness_system
