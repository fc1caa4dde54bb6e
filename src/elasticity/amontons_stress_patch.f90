!> The polynomial of a patch of elements that fits their stresses where these are most accurate, and the tractions known
!> at their sides on the boundary.
module amontons_stress_patch
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_traction_t
   use amontons_mesh, only: mesh_t
   use amontons_patch_frame, only: far_weight, find_terms, frame_t, is_linear, max_terms, samples_t, solve_normal
   use amontons_patch_table, only: patch_table_t
   implicit none (type, external)
   private

   public :: add_linear_stresses, add_stresses, fit_polynomial

contains

   !> Fits the polynomial of a patch.
   pure subroutine fit_polynomial(coefficient, patches, patch, mesh, stress, tractions)
      real(dp), intent(out) :: coefficient(4, max_terms)
         !! coefficients of the stresses xx, yy, xy, zz: those of the terms, nothing behind the last; of a linear
         !! polynomial the stresses at the node and their gradients along x and y, as `add_linear_stresses` takes them
         !! (component, term) [F/L^2]
      type(patch_table_t), intent(in) :: patches !! the patches
      integer, intent(in) :: patch !! number of the patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      real(dp), contiguous, intent(in) :: stress(:, :) !! the stresses of the samples: xx, yy, xy, zz (4, any) [F/L^2]
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      real(dp) :: normal(max_terms, max_terms), right(4, max_terms), along(4, 2), distance(2), weight
      logical :: is_determined, has_plane
      integer :: i

      has_plane = is_linear(patches%frame(patch))
      associate (frame => patches%frame(patch), n => patches%frame(patch)%n_terms, node => patches%node(patch), &
         elements => patches%element(patches%start(patch):patches%start(patch + 1) - 1))
         if (has_plane) then
            call sum_linear_samples(weight, right, frame, patches%samples, stress, elements, patches%n_near(patch))
            coefficient(:, :3) = right(:, :3)/weight
         else
            call sum_samples(normal, right, frame, patches%samples, stress, elements, patches%n_near(patch))
            call solve_normal(coefficient, n, normal, right, is_determined)
         end if
         if (size(tractions) > 0) then
            if (has_plane) then
               normal(:n, :n) = 0.0_dp
               do i = 1, n
                  normal(i, i) = weight
               end do
            end if
            call fit_tractions(coefficient, frame, normal(:n, :n), transpose(right(:3, :n)), tractions, node)
         end if
         if (.not. has_plane) return
         along(:, 1) = frame%scale(1, 1)*coefficient(:, 2) + frame%scale(2, 1)*coefficient(:, 3)
         along(:, 2) = frame%scale(2, 2)*coefficient(:, 3)
         distance = mesh%coordinates(:, node) - frame%center
         coefficient(:, 1) = coefficient(:, 1) + distance(1)*along(:, 1) + distance(2)*along(:, 2)
         coefficient(:, 2:3) = along
      end associate
   end subroutine fit_polynomial

   !> Sums the normal equations of the samples of a patch.
   pure subroutine sum_samples(normal, right, frame, samples, stress, elements, n_near)
      real(dp), intent(out) :: normal(max_terms, max_terms) !! the lower triangle of their matrix
      real(dp), intent(out) :: right(4, max_terms) !! their right-hand sides (component, term) [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the samples of all elements
      real(dp), contiguous, intent(in) :: stress(:, :) !! their stresses (4, n_samples) [F/L^2]
      integer, contiguous, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: p(max_terms), weight
      integer :: i, j, k, n

      n = frame%n_terms
      normal(:n, :n) = 0.0_dp
      right(:, :n) = 0.0_dp
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            call find_terms(frame, n, samples%position(:, k), p)
            do j = 1, n
               normal(j:n, j) = normal(j:n, j) + (weight*p(j))*p(j:n)
               right(:, j) = right(:, j) + (weight*p(j))*stress(:, k)
            end do
         end do
      end do
   end subroutine sum_samples

   !> Sums what the normal equations of a linear polynomial come down to in the coordinates of its patch: their matrix
   !> is the sum of the weights times the identity.
   pure subroutine sum_linear_samples(total, right, frame, samples, stress, elements, n_near)
      real(dp), intent(out) :: total !! sum of the weights [-]
      real(dp), intent(out) :: right(4, max_terms) !! as in `sum_samples` [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the samples of all elements
      real(dp), contiguous, intent(in) :: stress(:, :) !! their stresses (4, n_samples) [F/L^2]
      integer, contiguous, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! how many of them meet at its node
      real(dp) :: distance(2), weight, x, y
      integer :: i, k

      total = 0.0_dp
      right(:, :3) = 0.0_dp
      weight = 1.0_dp
      do i = 1, size(elements)
         if (i > n_near) weight = far_weight
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            distance = samples%position(:, k) - frame%center
            x = weight*frame%scale(1, 1)*distance(1)
            y = weight*(frame%scale(2, 1)*distance(1) + frame%scale(2, 2)*distance(2))
            total = total + weight
            right(:, 1) = right(:, 1) + weight*stress(:, k)
            right(:, 2) = right(:, 2) + x*stress(:, k)
            right(:, 3) = right(:, 3) + y*stress(:, k)
         end do
      end do
   end subroutine sum_linear_samples

   !> Fits the stresses xx, yy and xy to the samples and, with a large weight, to known tractions. What the fit leaves
   !> is measured by the norm of the tensor, in which xy counts twice, so that the axes do not matter.
   pure subroutine fit_tractions(coefficient, frame, normal, right, tractions, node)
      real(dp), intent(inout) :: coefficient(4, max_terms) !! coefficients of the stresses; gains those of these three
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: normal(:, :) !! the lower triangle of the normal matrix of the samples
      real(dp), intent(in) :: right(:, :) !! its right-hand sides (term, component)
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions at sides that meet at the node
      integer, intent(in) :: node !! the node
      real(dp), parameter :: of_tensor(3) = [1.0_dp, 1.0_dp, 2.0_dp]
      real(dp) :: matrix(3*frame%n_terms, 3*frame%n_terms), joint(3*frame%n_terms, 1)
      integer :: i, n, info

      n = frame%n_terms
      matrix = 0.0_dp
      do i = 1, 3
         matrix((i - 1)*n + 1:i*n, (i - 1)*n + 1:i*n) = of_tensor(i)*normal
         joint((i - 1)*n + 1:i*n, 1) = of_tensor(i)*right(:, i)
      end do
      call add_tractions(matrix, joint(:, 1), frame, normal(1, 1), tractions, node)
      call cholesky_factor(matrix, info)
      call cholesky_solve(matrix, joint)
      coefficient(:3, :n) = transpose(reshape(joint, [n, 3]))
   end subroutine fit_tractions

   !> Adds the equations of known tractions to the normal equations of a patch: at the middle of each side, and at the
   !> node, where two sides that go on smoothly have the mean of their normals.
   pure subroutine add_tractions(matrix, right, frame, n_samples, tractions, node)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: tractions(:) !! the known tractions
      integer, intent(in) :: node !! the node
      type(known_traction_t) :: smooth
      integer :: i, place(2)

      do i = 1, size(tractions)
         call add_traction(matrix, right, frame, n_samples, tractions(i), 2)
      end do
      place = 0
      do i = 1, min(2, size(tractions))
         place(i) = merge(1, 3, tractions(i)%corner(1) == node)
      end do
      if (size(tractions) == 2) then
         if (tractions(1)%goes_on(tractions(2), place)) then
            smooth = tractions(1)%mean(tractions(2), place)
            call add_traction(matrix, right, frame, n_samples, smooth, 2)
            return
         end if
      end if
      do i = 1, min(2, size(tractions))
         call add_traction(matrix, right, frame, n_samples, tractions(i), place(i))
      end do
   end subroutine add_tractions

   !> Adds the known tractions at a place of a side to the normal equations.
   pure subroutine add_traction(matrix, right, frame, n_samples, side, place)
      real(dp), intent(inout) :: matrix(:, :) !! normal matrix of the stresses xx, yy, xy
      real(dp), intent(inout) :: right(:) !! its right-hand side
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: n_samples !! number of samples, by weight
      type(known_traction_t), intent(in) :: side !! the side
      integer, intent(in) :: place !! 1, 2 or 3: first corner, middle, second corner
      ! Each equation weighs as much as ten times all samples: it holds to a few percent of what they say against it.
      real(dp), parameter :: weight = 10.0_dp
      real(dp) :: row(size(right)), direction(2), p(max_terms)
      integer :: i, n

      n = frame%n_terms
      call find_terms(frame, n, side%position(:, place), p)
      associate (normal => side%normal(:, place))
         do i = 1, 2
            if (.not. side%is_known(i)) cycle
            direction = normal
            if (i == 2) direction = [-normal(2), normal(1)]
            row(:n) = direction(1)*normal(1)*p(:n)
            row(n + 1:2*n) = direction(2)*normal(2)*p(:n)
            row(2*n + 1:) = (direction(1)*normal(2) + direction(2)*normal(1))*p(:n)
            matrix = matrix + weight*n_samples*spread(row, 2, 3*n)*spread(row, 1, 3*n)
            right = right + weight*n_samples*row*dot_product(direction, side%traction(:, place))
         end do
      end associate
   end subroutine add_traction

   !> Adds multiples of the stresses of a patch's polynomial at points.
   pure subroutine add_stresses(stress, frame, coefficient, n_points, position, weight)
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(inout) :: stress(4, n_points) !! xx, yy, xy, zz; gains the multiples [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      real(dp), intent(in) :: coefficient(4, frame%n_terms) !! coefficients of its polynomial (component, term) [F/L^2]
      real(dp), intent(in) :: position(2, n_points) !! the points [L]
      real(dp), intent(in) :: weight(n_points) !! what the stress at each is multiplied by [-]
      real(dp) :: p(max_terms), sum(4)
      integer :: i, point

      do point = 1, n_points
         call find_terms(frame, frame%n_terms, position(:, point), p)
         sum = coefficient(:, 1)
         do i = 2, frame%n_terms
            sum = sum + p(i)*coefficient(:, i)
         end do
         stress(:, point) = stress(:, point) + weight(point)*sum
      end do
   end subroutine add_stresses

   !> Does the same for a linear polynomial.
   pure subroutine add_linear_stresses(stress, origin, coefficient, n_points, position, weight)
      integer, intent(in) :: n_points !! number of points
      real(dp), intent(inout) :: stress(4, n_points) !! xx, yy, xy, zz; gains the multiples [F/L^2]
      real(dp), intent(in) :: origin(2) !! the node of its patch [L]
      real(dp), intent(in) :: coefficient(4, 3) !! stresses there, their gradients along x and y [F/L^2], [F/L^3]
      real(dp), intent(in) :: position(2, n_points) !! the points [L]
      real(dp), intent(in) :: weight(n_points) !! what the stress at each is multiplied by [-]
      integer :: point

      do point = 1, n_points
         stress(:, point) = stress(:, point) + weight(point)*(coefficient(:, 1) &
            + (position(1, point) - origin(1))*coefficient(:, 2) + (position(2, point) - origin(2))*coefficient(:, 3))
      end do
   end subroutine add_linear_stresses

end module amontons_stress_patch
