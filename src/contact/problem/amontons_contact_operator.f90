!> The matrix of a contact problem: the stiffness S of a body, dense or as the band matrix of the whole body, or the
!> compliance A of a reduced problem, dense or sparse.
!>
!> One operator serves all loads of its body, on all threads at once: contact problems point to it. Methods that need a
!> dense matrix ask for it by `prepare_stiffness` or `prepare_compliance`, which make it once.
module amontons_contact_operator
   use amontons_band_stiffness, only: band_stiffness_t
   use amontons_dense, only: allocate_matrix, cholesky_factor, cholesky_inverse
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   use amontons_symmetric_matrix, only: new_dense_matrix, new_sparse_matrix, symmetric_matrix_t
   implicit none (type, external)
   private

   public :: contact_operator_t, new_band_operator, new_compliance_operator, new_dense_stiffness, &
      new_softened_operator, new_stiffness_operator

   !> The matrix of a contact problem. A body has `stiffness`, `band` or both, a reduced problem has `compliance` alone.
   type :: contact_operator_t
      integer :: n = 0 !! number of its rows, 1 + n_tangents for each point
      integer :: n_tangents = 1 !! number of tangential directions of a point: 1 in the plane, 2 in space
      logical :: is_held = .true. !! whether the supports alone hold the body, so that S is positive definite
      logical :: is_loose = .false. !! whether springs of `set_springs` are all that holds the body
      real(dp), allocatable :: augmentation(:)
         !! the stiffness rho that turns displacements into forces in the contact law: the diagonal of S or, in a
         !! reduced problem, the reciprocal one of A; a displacement that no force changes takes the smallest of the
         !! others; one number for both tangents of a point in space (n) [F/L]
      real(dp) :: least_augmentation = 0.0_dp
         !! lower bound of rho: the means over a few cells may have no stiffness of their own [F/L]
      type(symmetric_matrix_t), allocatable :: stiffness
         !! S as a dense matrix; where there is a band, not before `prepare_stiffness` (n, n) [F/L]
      type(band_stiffness_t), allocatable :: band !! S of a slender body with a long contact line
      type(symmetric_matrix_t), allocatable :: compliance
         !! the matrix A = (S + alpha I)^-1 of the paper's (2.3), made by `prepare_compliance`; always there in a
         !! reduced problem (n, n) [L/F]
      real(dp) :: proximal_parameter = 0.0_dp !! alpha of the proximal iteration: 0 for a held body [F/L]
   contains
      procedure :: add_motion => contact_operator_add_motion
      procedure :: copy_dense => contact_operator_copy_dense
      procedure :: copy_stiffness => contact_operator_copy_stiffness
      procedure :: cut => contact_operator_cut
      procedure :: find_augmentation => contact_operator_find_augmentation
      procedure :: find_parts => contact_operator_find_parts
      procedure :: has_stiffness => contact_operator_has_stiffness
      procedure :: n_pairs => contact_operator_n_pairs
      procedure :: multiply_stiffness => contact_operator_multiply_stiffness
      procedure :: prepare_compliance => contact_operator_prepare_compliance
      procedure :: prepare_stiffness => contact_operator_prepare_stiffness
      procedure :: set_springs => contact_operator_set_springs
   end type contact_operator_t

   !> Parts of a sparse compliance with fewer rows are made dense, which all methods accept.
   integer, parameter :: least_sparse_rows = 200

contains

   !> Makes the operator of a dense stiffness, whose array it takes over.
   pure subroutine new_stiffness_operator(matrix, stiffness, is_held, n_tangents, least_augmentation)
      type(contact_operator_t), intent(out) :: matrix !! the operator
      real(dp), allocatable, intent(inout) :: stiffness(:, :) !! S (n, n); not allocated on return [F/L]
      logical, intent(in) :: is_held !! whether S is positive definite
      integer, intent(in), optional :: n_tangents !! number of tangential directions of a point; 1 if it is not given
      real(dp), intent(in), optional :: least_augmentation !! lower bound of rho; 0 if absent [F/L]

      matrix%n = size(stiffness, 1)
      matrix%is_held = is_held
      if (present(n_tangents)) matrix%n_tangents = n_tangents
      if (present(least_augmentation)) matrix%least_augmentation = least_augmentation
      allocate (matrix%stiffness)
      call new_dense_matrix(matrix%stiffness, stiffness, matrix%n_pairs())
      call matrix%find_augmentation()
   end subroutine new_stiffness_operator

   !> Makes the operator of a stiffness represented by the band matrix of a whole body.
   pure subroutine new_band_operator(matrix, band, is_held)
      type(contact_operator_t), intent(out) :: matrix !! the operator
      type(band_stiffness_t), allocatable, intent(inout) :: band !! S; not allocated on return
      logical, intent(in) :: is_held !! whether S is positive definite

      matrix%n = size(band%place)
      matrix%is_held = is_held
      call move_alloc(band, matrix%band)
      call matrix%find_augmentation()
   end subroutine new_band_operator

   !> Makes the operator of a reduced problem.
   pure subroutine new_compliance_operator(matrix, compliance)
      type(contact_operator_t), intent(out) :: matrix !! the operator
      type(symmetric_matrix_t), intent(in) :: compliance
         !! A, positive semidefinite; in space with the pairs of tangents (n, n) [L/F]

      matrix%n = compliance%n
      if (compliance%n_pairs > 0) matrix%n_tangents = 2
      matrix%compliance = compliance
      call matrix%find_augmentation()
   end subroutine new_compliance_operator

   !> The number of points in space, whose two tangential rows form a pair; 0 in the plane.
   pure integer function contact_operator_n_pairs(self) result(n_pairs)
      class(contact_operator_t), intent(in) :: self !! the operator

      n_pairs = merge(0, self%n/3, self%n_tangents == 1)
   end function contact_operator_n_pairs

   !> Whether there is a stiffness, so that forces follow from displacements; otherwise displacements follow from
   !> forces.
   pure logical function contact_operator_has_stiffness(self) result(has_stiffness)
      class(contact_operator_t), intent(in) :: self !! the operator

      has_stiffness = allocated(self%stiffness) .or. allocated(self%band)
   end function contact_operator_has_stiffness

   !> Computes the augmentation rho, the stiffness of each row: the diagonal of S or, in a reduced problem, the
   !> reciprocal diagonal of A.
   pure subroutine contact_operator_find_augmentation(self)
      class(contact_operator_t), intent(inout) :: self !! the operator, with a new matrix
      ! Of the largest of a point.
      real(dp), parameter :: least_share = 1.0e-6_dp
      integer :: i

      if (allocated(self%band)) then
         self%augmentation = self%band%diagonal
      else if (allocated(self%stiffness)) then
         self%augmentation = self%stiffness%diagonal()
      else
         self%augmentation = self%compliance%reciprocal_diagonal()
      end if
      ! Forces of a loose body on two points are known without S, which has rounding there.
      associate (rho => self%augmentation, m => max(1, self%n/(1 + self%n_tangents)))
         rho = max(rho, self%least_augmentation, least_share*[(maxval(rho(1 + mod(i - 1, m)::m)), i=1, size(rho))])
      end associate
   end subroutine contact_operator_find_augmentation

   !> The product S v.
   pure subroutine contact_operator_multiply_stiffness(self, v, product)
      class(contact_operator_t), intent(in) :: self !! the operator, with a stiffness
      real(dp), contiguous, intent(in) :: v(:) !! the vector (n) [L]
      real(dp), contiguous, intent(out) :: product(:) !! the product (n) [F]

      if (allocated(self%band)) then
         call self%band%multiply(v, product)
      else
         call self%stiffness%multiply(v, product)
      end if
   end subroutine contact_operator_multiply_stiffness

   !> Makes the stiffness a dense matrix unless it already is one.
   subroutine contact_operator_prepare_stiffness(self, error)
      class(contact_operator_t), intent(inout) :: self !! the operator, with a stiffness
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp), allocatable :: dense(:, :)

      ! Threads share the operator.
      !$omp critical (amontons_contact_operator)
      if (.not. allocated(self%stiffness)) then
         call new_dense_stiffness(self, dense, error)
         if (.not. allocated(error)) then
            allocate (self%stiffness)
            call new_dense_matrix(self%stiffness, dense, self%n_pairs())
         end if
      end if
      !$omp end critical (amontons_contact_operator)
   end subroutine contact_operator_prepare_stiffness

   !> Makes the dual matrix A = (S + alpha I)^-1 unless it is there already: for a held body the paper's (2.3),
   !> A = C K^-1 C^T with C = (N; T), without a column of K^-1.
   !>
   !> A body that only contact holds has no S^-1: alpha is then a third of the mean diagonal of S shared among the
   !> points, and the methods iterate v_k (see `dual_load`) until it has no effect. So the rigid motion, which
   !> all points resist together, is held about as firmly as one point on any mesh: measured on the long bar, less
   !> slows the sweeps and more slows the proximal iteration.
   subroutine contact_operator_prepare_compliance(self, error)
      class(contact_operator_t), intent(inout) :: self !! the operator
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite, or memory ran out

      ! Threads share the operator.
      !$omp critical (amontons_contact_operator)
      if (.not. allocated(self%compliance)) call invert_stiffness(self, error)
      !$omp end critical (amontons_contact_operator)
   end subroutine contact_operator_prepare_compliance

   !> Computes the dual matrix A from the stiffness.
   subroutine invert_stiffness(matrix, error)
      class(contact_operator_t), intent(inout) :: matrix !! the operator; gains A and alpha
      type(error_t), allocatable, intent(out) :: error !! S is not positive (semi)definite, or memory ran out
      real(dp), parameter :: share = 1.0_dp/3.0_dp
      real(dp), allocatable :: factor(:, :)
      integer :: i, info

      call new_dense_stiffness(matrix, factor, error)
      if (allocated(error)) return
      if (.not. matrix%is_held) then
         matrix%proximal_parameter = share*sum([(factor(i, i), i=1, matrix%n)]) &
            /(matrix%n*(matrix%n/(1 + matrix%n_tangents)))
         do i = 1, matrix%n
            factor(i, i) = factor(i, i) + matrix%proximal_parameter
         end do
      end if
      call cholesky_factor(factor, info)
      if (info /= 0) then
         call new_error(error, numerical_failure, 'the condensed stiffness of the contact points is not positive '// &
            'definite: the supports do not hold the body, or its stiffness is degenerate')
         return
      end if
      call cholesky_inverse(factor)
      allocate (matrix%compliance)
      call new_dense_matrix(matrix%compliance, factor, matrix%n_pairs())
   end subroutine invert_stiffness

   !> Makes a dense copy of the stiffness.
   subroutine new_dense_stiffness(matrix, dense, error)
      class(contact_operator_t), intent(in) :: matrix !! the operator, with a stiffness
      real(dp), allocatable, intent(out) :: dense(:, :) !! S (n, n) [F/L]
      type(error_t), allocatable, intent(out) :: error !! memory ran out

      call allocate_matrix(dense, matrix%n, matrix%n, 'the contact points', error)
      if (allocated(error)) return
      if (allocated(matrix%stiffness)) then
         dense(:, :) = matrix%stiffness%values
      else
         call matrix%band%fill_dense(dense)
      end if
   end subroutine new_dense_stiffness

   !> Makes a copy of the operator with a dense stiffness.
   subroutine contact_operator_copy_dense(self, copy, error)
      class(contact_operator_t), intent(in) :: self !! the operator, with a stiffness
      type(contact_operator_t), intent(out) :: copy !! its copy
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp), allocatable :: dense(:, :)

      call new_dense_stiffness(self, dense, error)
      if (.not. allocated(error)) call new_stiffness_operator(copy, dense, self%is_held, self%n_tangents, &
         self%least_augmentation)
   end subroutine contact_operator_copy_dense

   !> Makes a copy of the operator with the stiffness in its present form.
   subroutine contact_operator_copy_stiffness(self, copy, error)
      class(contact_operator_t), intent(in) :: self !! the operator, with a stiffness
      type(contact_operator_t), intent(out) :: copy !! its copy
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(band_stiffness_t), allocatable :: band

      if (.not. allocated(self%band)) then
         call self%copy_dense(copy, error)
      else
         band = self%band
         call new_band_operator(copy, band, self%is_held)
      end if
   end subroutine contact_operator_copy_stiffness

   !> Sets this copy of a stiffness to that of the body plus springs between each point and a fixed support.
   pure subroutine contact_operator_set_springs(self, body, springs)
      class(contact_operator_t), intent(inout) :: self !! a copy of the body's stiffness, with any springs before
      type(contact_operator_t), intent(in) :: body !! the body's
      real(dp), intent(in) :: springs(:) !! diagonal of the springs' stiffness, all of it above 0 (n) [F/L]
      integer :: i

      if (allocated(self%band)) then
         call self%band%set_diagonal(body%band, springs)
      else
         do i = 1, self%n
            self%stiffness%values(i, i) = body%stiffness%values(i, i) + springs(i)
         end do
      end if
      call self%find_augmentation()
      if (allocated(self%compliance)) deallocate (self%compliance)
      self%proximal_parameter = 0.0_dp
      self%is_held = .true.
      self%is_loose = body%is_loose .or. .not. body%is_held
   end subroutine contact_operator_set_springs

   !> Makes the operator of a reduced problem with springs in series with the points.
   pure subroutine new_softened_operator(matrix, original, springs)
      type(contact_operator_t), intent(out) :: matrix !! the operator
      type(contact_operator_t), intent(in) :: original !! that of the reduced problem
      real(dp), intent(in) :: springs(:) !! diagonal of the springs' compliance, all of it above 0 (n) [L/F]
      type(symmetric_matrix_t) :: softened
      integer :: i, j

      softened = original%compliance
      if (softened%is_sparse()) then
         associate (a => original%compliance)
            call new_sparse_matrix(softened, a%n, [a%row, (i, i=1, a%n)], &
               [((j, i=a%first(j), a%first(j + 1) - 1), j=1, a%n), (i, i=1, a%n)], [a%entry, springs])
            softened%n_pairs = a%n_pairs
         end associate
      else
         do i = 1, softened%n
            softened%values(i, i) = softened%values(i, i) + springs(i)
         end do
      end if
      call new_compliance_operator(matrix, softened)
   end subroutine new_softened_operator

   !> Adds the stiffness of a spring that resists one motion of all points.
   pure subroutine contact_operator_add_motion(self, spring, motion)
      class(contact_operator_t), intent(inout) :: self !! the operator, its stiffness a dense matrix
      real(dp), intent(in) :: spring !! stiffness of the spring [F/L]
      real(dp), intent(in) :: motion(:) !! displacements of the motion (n) [-]
      integer :: j

      do j = 1, self%n
         self%stiffness%values(:, j) = self%stiffness%values(:, j) + spring*motion(j)*motion
      end do
      call self%find_augmentation()
   end subroutine contact_operator_add_motion

   !> Numbers the components of the problem: two points belong to the same one if an entry of the matrix couples them,
   !> directly or through others. A band is one component.
   pure subroutine contact_operator_find_parts(self, n_points, part, n_parts)
      class(contact_operator_t), intent(in) :: self !! the operator
      integer, intent(in) :: n_points !! number m of points; row i is one of point 1 + mod(i - 1, m)
      integer, allocatable, intent(out) :: part(:) !! number of the part of each point (m)
      integer, intent(out) :: n_parts !! number of parts

      allocate (part(n_points), source=1)
      n_parts = 1
      if (allocated(self%band)) return
      if (allocated(self%stiffness)) then
         call number_parts(self%stiffness, part, n_parts)
      else
         call number_parts(self%compliance, part, n_parts)
      end if
   end subroutine contact_operator_find_parts

   !> Numbers the components of a matrix, each from its first point by a search over the coupled points.
   pure subroutine number_parts(matrix, part, n_parts)
      type(symmetric_matrix_t), intent(in) :: matrix !! the matrix (2m, 2m)
      integer, intent(out) :: part(:) !! number of the part of each point (m)
      integer, intent(out) :: n_parts !! number of parts
      integer :: reached(size(part)), n_reached, n_followed, first, column, point, i, m, begin, last
      real(dp) :: entry

      m = size(part)
      part = 0
      n_parts = 0
      n_reached = 0
      n_followed = 0
      begin = 1
      last = matrix%n
      do first = 1, m
         if (part(first) > 0) cycle
         n_parts = n_parts + 1
         part(first) = n_parts
         n_reached = n_reached + 1
         reached(n_reached) = first
         do while (n_followed < n_reached .and. n_reached < m)
            n_followed = n_followed + 1
            do column = reached(n_followed), matrix%n, m
               if (n_reached == m) exit
               if (matrix%is_sparse()) then
                  begin = matrix%first(column)
                  last = matrix%first(column + 1) - 1
               end if
               do i = begin, last
                  if (matrix%is_sparse()) then
                     point = 1 + mod(matrix%row(i) - 1, m)
                     entry = matrix%entry(i)
                  else
                     point = 1 + mod(i - 1, m)
                     entry = matrix%values(i, column)
                  end if
                  if (part(point) > 0 .or. .not. abs(entry) > 0.0_dp) cycle
                  part(point) = n_parts
                  n_reached = n_reached + 1
                  reached(n_reached) = point
               end do
            end do
         end do
      end do
   end subroutine number_parts

   !> Makes the operator of a component.
   subroutine contact_operator_cut(self, rows, part, error)
      class(contact_operator_t), intent(in) :: self !! the operator, in several parts
      integer, intent(in) :: rows(:) !! rows of the part
      type(contact_operator_t), intent(out) :: part !! the operator of the part
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      real(dp), allocatable :: values(:, :)

      part%n = size(rows)
      part%n_tangents = self%n_tangents
      part%is_held = self%is_held
      part%least_augmentation = self%least_augmentation
      if (.not. allocated(self%stiffness) .and. size(rows) >= least_sparse_rows) then
         if (self%compliance%is_sparse()) then
            allocate (part%compliance)
            call cut_sparse(part%compliance, self%compliance, rows)
            part%compliance%n_pairs = part%n_pairs()
            call part%find_augmentation()
            return
         end if
      end if
      call allocate_matrix(values, part%n, part%n, 'contact points', error)
      if (allocated(error)) return
      if (allocated(self%stiffness)) then
         call self%stiffness%fill_block(rows, rows, values)
         allocate (part%stiffness)
         call new_dense_matrix(part%stiffness, values, part%n_pairs())
      else
         call self%compliance%fill_block(rows, rows, values)
         allocate (part%compliance)
         call new_dense_matrix(part%compliance, values, part%n_pairs())
      end if
      call part%find_augmentation()
   end subroutine contact_operator_cut

   !> The rows and columns of a component of a sparse matrix.
   pure subroutine cut_sparse(part, matrix, rows)
      type(symmetric_matrix_t), intent(out) :: part !! the part
      type(symmetric_matrix_t), intent(in) :: matrix !! the whole
      integer, intent(in) :: rows(:) !! the rows
      real(dp), allocatable :: entry(:)
      integer, allocatable :: place(:), row(:), column(:)
      integer :: i, j, n

      allocate (place(matrix%n), source=0)
      place(rows) = [(i, i=1, size(rows))]
      n = sum(matrix%first(rows + 1) - matrix%first(rows))
      allocate (row(n), column(n), entry(n))
      n = 0
      do j = 1, size(rows)
         do i = matrix%first(rows(j)), matrix%first(rows(j) + 1) - 1
            if (place(matrix%row(i)) == 0) cycle
            n = n + 1
            row(n) = place(matrix%row(i))
            column(n) = j
            entry(n) = matrix%entry(i)
         end do
      end do
      call new_sparse_matrix(part, size(rows), row(:n), column(:n), entry(:n))
   end subroutine cut_sparse

end module amontons_contact_operator
