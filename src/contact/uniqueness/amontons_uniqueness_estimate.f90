!> A sufficient bound of the friction below which a contact problem has one solution: an estimate of what friction can
!> gain from the coupling of normal and tangential directions; section 5 of doc/theory.md has the proof.
module amontons_uniqueness_estimate
   use amontons_dense, only: cholesky_factor, cholesky_inverse, cholesky_solve, symmetric_multiply, &
      transposed_product, triangular_solve
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: estimated_bound

   !> The blocks of a stiffness that the estimate needs, in the relation's units.
   type :: coupling_t
      real(dp), allocatable :: normal(:, :) !! S_11 (m, m)
      real(dp), allocatable :: difference(:, :) !! S_21 S_11^+ S_12 (m, m)
      real(dp), allocatable :: factor(:, :) !! Cholesky factor of S_T = S_22 - S_21 S_11^+ S_12 (m, m)
   end type coupling_t

contains

   !> A multiple of given coefficients below which the solution is unique, from norms; 0 if rigid motions with slip are
   !> free. With kappa and gamma of section 5 of doc/theory.md, kappa < gamma + 1/gamma (2 if gamma > 1).
   pure real(dp) function estimated_bound(s, friction) result(bound)
      real(dp), intent(in) :: s(:, :) !! S, positive semidefinite (2m, 2m) [-]
      real(dp), intent(in) :: friction(:) !! phi (m) [-]
      ! What rounding may have added to the estimate, and what it makes of no coupling.
      real(dp), parameter :: caution = 1.0_dp - 1.0e-6_dp, rounding = 1.0e-12_dp
      type(coupling_t) :: coupling
      real(dp) :: gamma
      logical :: is_definite

      bound = 0.0_dp
      call new_coupling(coupling, s, is_definite)
      if (.not. is_definite) return
      gamma = sqrt(largest_eigenvalue(transformed(coupling%factor, coupling%difference)))
      gamma = max(gamma, rounding)
      bound = caution*merge(gamma + 1.0_dp/gamma, 2.0_dp, gamma < 1.0_dp)/friction_gain(coupling, friction)
   end function estimated_bound

   !> Takes the blocks of a stiffness and eliminates the normal displacements.
   pure subroutine new_coupling(coupling, s, is_definite)
      type(coupling_t), intent(out) :: coupling !! the blocks
      real(dp), intent(in) :: s(:, :) !! S (2m, 2m) [-]
      logical, intent(out) :: is_definite !! whether S_T is positive definite beyond rounding
      ! Free rigid motions along the normals are in the kernel of S_11 and of S_21: any small number holds them.
      real(dp), parameter :: hold = 1.0e-11_dp, least_root = 1.0e-4_dp
      real(dp), allocatable :: factor(:, :), cross(:, :), mixed(:, :)
      integer :: i, info, m

      m = size(s, 1)/2
      coupling%normal = s(:m, :m)
      factor = coupling%normal
      do i = 1, m
         factor(i, i) = (1.0_dp + hold)*factor(i, i)
      end do
      call cholesky_factor(factor, info)
      is_definite = info == 0
      if (.not. is_definite) return
      cross = s(:m, m + 1:)
      mixed = cross
      call cholesky_solve(factor, mixed)
      allocate (coupling%difference(m, m))
      call transposed_product(cross, mixed, coupling%difference)
      coupling%factor = s(m + 1:, m + 1:) - coupling%difference
      call cholesky_factor(coupling%factor, info)
      is_definite = info == 0
      if (.not. is_definite) return
      is_definite = all([(coupling%factor(i, i) > least_root*sqrt(s(m + i, m + i)), i=1, m)])
   end subroutine new_coupling

   !> The number kappa: the square root of the product of the largest eigenvalues of D A_22 D and of
   !> D^-1 Phi S_11 Phi D^-1, A_22 = G^-1, on the points with friction. The diagonal D balances the two.
   pure real(dp) function friction_gain(coupling, friction) result(gain)
      type(coupling_t), intent(in) :: coupling !! the blocks
      real(dp), intent(in) :: friction(:) !! phi (m) [-]
      real(dp), allocatable :: compliance(:, :), stiffness(:, :), weight(:)
      integer :: i

      compliance = coupling%factor
      call cholesky_inverse(compliance)
      associate (rough => pack([(i, i=1, size(friction))], friction > 0.0_dp))
         compliance = compliance(rough, rough)
         stiffness = coupling%normal(rough, rough)
         weight = [(friction(rough(i))*sqrt(stiffness(i, i)/compliance(i, i)), i=1, size(rough))]
         do i = 1, size(rough)
            compliance(:, i) = compliance(:, i)*sqrt(weight)*sqrt(weight(i))
            stiffness(:, i) = stiffness(:, i)*friction(rough)/sqrt(weight)*friction(rough(i))/sqrt(weight(i))
         end do
      end associate
      gain = sqrt(largest_eigenvalue(compliance)*largest_eigenvalue(stiffness))
   end function friction_gain

   !> The matrix L^-1 X L^-T of a symmetric X.
   pure function transformed(l, x) result(y)
      real(dp), intent(in) :: l(:, :) !! L in the lower triangle (n, n)
      real(dp), intent(in) :: x(:, :) !! X (n, n)
      real(dp), allocatable :: y(:, :)

      y = x
      call triangular_solve(l, y)
      y = transpose(y)
      call triangular_solve(l, y)
   end function transformed

   !> The largest eigenvalue of a positive semidefinite matrix, from above: a Cholesky factor proves that no eigenvalue
   !> is larger. Power iterations tell where to look.
   pure real(dp) function largest_eigenvalue(matrix) result(above)
      real(dp), intent(in) :: matrix(:, :) !! the matrix (n, n)
      real(dp), parameter :: resolution = 1.0e-4_dp
      integer, parameter :: n_powers = 60
      real(dp) :: vector(size(matrix, 1)), image(size(matrix, 1)), below, middle, step
      integer :: i

      vector = [(1.0_dp + modulo(i, 7), i=1, size(vector))]
      below = 0.0_dp
      do i = 1, n_powers
         vector = vector/norm2(vector)
         call symmetric_multiply(matrix, vector, image)
         below = dot_product(vector, image)
         if (.not. below > 0.0_dp) exit
         vector = image
      end do
      below = max(below, epsilon(below)*maxval(abs(matrix)))
      above = below
      if (.not. below > 0.0_dp) return
      step = resolution
      above = (1.0_dp + step)*below
      do while (.not. is_above(above))
         below = above
         step = 4.0_dp*step
         above = (1.0_dp + step)*below
      end do
      do while (above - below > 2.0_dp*resolution*above)
         middle = 0.5_dp*(below + above)
         if (is_above(middle)) then
            above = middle
         else
            below = middle
         end if
      end do

   contains

      !> Whether a number is larger than every eigenvalue.
      pure logical function is_above(number)
         real(dp), intent(in) :: number !! the number
         real(dp) :: difference(size(matrix, 1), size(matrix, 1))
         integer :: k, info

         difference = -matrix
         do k = 1, size(matrix, 1)
            difference(k, k) = difference(k, k) + number
         end do
         call cholesky_factor(difference, info)
         is_above = info == 0
      end function is_above

   end function largest_eigenvalue

end module amontons_uniqueness_estimate
