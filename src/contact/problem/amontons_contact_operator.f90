!> The matrix of a contact problem: the stiffness S of a body, dense or as the band matrix of the whole body, or the
!> compliance A of a reduced problem, dense or sparse.
!>
!> One operator serves all loads of its body, on all threads at once: contact problems point to it. Methods that need a
!> dense matrix ask for it by `prepare_stiffness` or `prepare_compliance`, which make it once.
!>
!> The stiffness of a slender body is not formed: a product with S is one with the stiffness of the whole body, after
!> the interior displacements are solved for. The unknowns are in an order that makes the matrix a narrow band, those of
!> a contact point in its normal and tangential direction. Time and memory are proportional to the length of the body.
module amontons_contact_operator
   use amontons_band_matrix, only: new_symmetric_band, symmetric_band_t
   use amontons_dense, only: allocate_matrix, cholesky_factor, cholesky_inverse
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: positions, sparse_matrix_t
   use amontons_symmetric_matrix, only: new_dense_matrix, new_sparse_matrix, symmetric_matrix_t
   implicit none (type, external)
   private

   public :: band_stiffness_t, contact_operator_t, new_band_operator, new_band_stiffness, new_compliance_operator, &
      new_dense_stiffness, new_softened_operator, new_stiffness_operator

   !> The stiffness of a body, its contact points in (u_N; u_T).
   type :: band_stiffness_t
      type(symmetric_band_t) :: whole !! stiffness of the whole body by position [F/L]
      integer, allocatable :: place(:) !! position of each component of v (2m)
      integer :: reach = 0 !! largest distance between the positions of a point whose slip is no spring of its own
      real(dp), allocatable :: diagonal(:) !! diagonal of S (2m) [F/L]
      integer, allocatable, private :: interior(:) !! position of each unknown that is of no contact point
      type(symmetric_band_t), private :: factor !! Cholesky factor of `whole`, its contact rows those of the unit matrix
   contains
      procedure :: condensed => band_stiffness_condensed
      procedure :: interior_displacement => band_stiffness_interior_displacement
      procedure :: multiply => band_stiffness_multiply
      procedure, private :: find_interior => band_stiffness_find_interior
   end type band_stiffness_t

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
      procedure :: largest_terms => contact_operator_largest_terms
      procedure :: n_pairs => contact_operator_n_pairs
      procedure :: multiply_stiffness => contact_operator_multiply_stiffness
      procedure :: prepare_compliance => contact_operator_prepare_compliance
      procedure :: prepare_stiffness => contact_operator_prepare_stiffness
      procedure :: set_springs => contact_operator_set_springs
   end type contact_operator_t

   !> Parts of a sparse compliance with fewer rows are made dense, which all methods accept.
   integer, parameter :: least_sparse_rows = 200

contains

   !> Makes the stiffness from the matrix of a body.
   subroutine new_band_stiffness(stiffness, matrix, order, unknown, map, error)
      type(band_stiffness_t), intent(out) :: stiffness !! the stiffness
      type(sparse_matrix_t), intent(in) :: matrix !! K, the unknowns of the contact points last [F/L]
      integer, intent(in) :: order(:) !! position k holds unknown order(k) (n)
      integer, intent(in) :: unknown(:, :)
         !! places of each point's displacements among the contact unknowns; 0 for a slip that a support prevents (2, m)
      real(dp), intent(in) :: map(:, :, :) !! unknowns of a point = map (u_N, u_T) (2, 2, m) [-]
      type(error_t), allocatable, intent(out) :: error
         !! the body is not held even if all contact points are, or memory ran out
      real(dp), allocatable :: room(:, :)
      integer :: at(2, matrix%n), position(matrix%n), j, l, width
      real(dp) :: weight(2, matrix%n), value
      integer :: p, m, k, n_interior, n_constrained, i, info
      integer(int64) :: entry

      m = size(unknown, 2)
      position = positions(order)
      n_interior = size(position) - count(unknown > 0)
      stiffness%interior = position(:n_interior)
      at = 0
      at(1, :n_interior) = stiffness%interior
      weight = 0.0_dp
      weight(1, :n_interior) = 1.0_dp
      allocate (stiffness%place(2*m))
      n_constrained = 0
      do p = 1, m
         associate (n_unknowns => count(unknown(:, p) > 0), place => stiffness%place)
            place(p) = position(n_interior + unknown(1, p))
            if (n_unknowns == 2) then
               place(p + m) = position(n_interior + unknown(2, p))
               stiffness%reach = max(stiffness%reach, abs(place(p + m) - place(p)))
            else
               n_constrained = n_constrained + 1
               place(p + m) = size(position) + n_constrained
            end if
            do k = 1, n_unknowns
               at(:n_unknowns, n_interior + unknown(k, p)) = place(p:p + (n_unknowns - 1)*m:m)
               weight(:n_unknowns, n_interior + unknown(k, p)) = map(k, :n_unknowns, p)
            end do
         end associate
      end do
      ! The largest difference of the positions that one entry of the matrix couples.
      width = 0
      do j = 1, matrix%n
         do entry = matrix%column_start(j), matrix%column_start(j + 1) - 1
            do k = 1, count(at(:, j) > 0)
               do l = 1, count(at(:, matrix%row(entry)) > 0)
                  width = max(width, abs(at(k, j) - at(l, matrix%row(entry))))
               end do
            end do
         end do
      end do
      ! Room for the matrix and its factor, and for the factors of the body and of a method, which are made later.
      call allocate_matrix(room, 11*(width + 1), matrix%n + count(unknown == 0), 'the band stiffness', error)
      if (allocated(error)) return
      deallocate (room)
      call new_symmetric_band(stiffness%whole, matrix%n + count(unknown == 0), width)
      ! Add the entries of the matrix, transformed to the normal and tangential directions of the contact points.
      do j = 1, matrix%n
         do entry = matrix%column_start(j), matrix%column_start(j + 1) - 1
            i = matrix%row(entry)
            do k = 1, count(at(:, j) > 0)
               do l = 1, count(at(:, i) > 0)
                  ! The entry across the diagonal adds as much, on the other side of the new diagonal or on it.
                  if (i == j .and. at(l, i) < at(k, j)) cycle
                  value = weight(k, j)*weight(l, i)*matrix%value(entry)
                  if (i /= j .and. at(l, i) == at(k, j)) value = 2.0_dp*value
                  call stiffness%whole%add(at(l, i), at(k, j), value)
               end do
            end do
         end do
      end do
      do p = 1, m
         if (unknown(2, p) == 0) call stiffness%whole%decouple(stiffness%place(p + m))
      end do
      stiffness%factor = stiffness%whole
      do i = 1, size(stiffness%place)
         call stiffness%factor%decouple(stiffness%place(i))
      end do
      call stiffness%factor%factorize(info)
      if (info /= 0) call new_error(error, numerical_failure, 'the stiffness is singular even with all contact '// &
         'points held: neither supports nor contact points hold some part of the body')
      if (allocated(error)) return
      call find_diagonal(stiffness)
      ! Nothing loads a slip that a support prevents; its spring is as stiff as the point.
      do p = 1, m
         if (unknown(2, p) > 0) cycle
         stiffness%diagonal(p + m) = stiffness%diagonal(p)
         stiffness%whole%entry(1, stiffness%place(p + m)) = stiffness%diagonal(p)
      end do
   end subroutine new_band_stiffness

   !> Computes the diagonal of S = K_cc - K_ci K_ii^-1 K_ic. The neighbors of a contact point are neighbors of each
   !> other, so that the entries of K_ii^-1 within a band suffice.
   pure subroutine find_diagonal(stiffness)
      type(band_stiffness_t), intent(inout) :: stiffness !! the stiffness, gains the diagonal of S
      type(symmetric_band_t) :: inverse
      logical :: is_contact(stiffness%whole%n)
      integer, allocatable :: near(:)
      integer :: i, j, k, width

      is_contact = .false.
      is_contact(stiffness%place) = .true.
      width = stiffness%whole%width
      do i = 1, size(stiffness%place)
         near = neighbors(stiffness%whole, stiffness%place(i), is_contact)
         if (size(near) > 0) width = max(width, near(size(near)) - near(1))
      end do
      call stiffness%factor%inverse_band(width, inverse)
      allocate (stiffness%diagonal(size(stiffness%place)))
      do i = 1, size(stiffness%place)
         near = neighbors(stiffness%whole, stiffness%place(i), is_contact)
         associate (coupling => [(stiffness%whole%element(near(j), stiffness%place(i)), j=1, size(near))])
            stiffness%diagonal(i) = stiffness%whole%entry(1, stiffness%place(i))
            do k = 1, size(near)
               stiffness%diagonal(i) = stiffness%diagonal(i) - coupling(k)* &
                  sum([(inverse%element(near(j), near(k))*coupling(j), j=1, size(near))])
            end do
         end associate
      end do
   end subroutine find_diagonal

   !> The interior positions coupled to a position, in ascending order.
   pure function neighbors(matrix, position, is_contact) result(near)
      type(symmetric_band_t), intent(in) :: matrix !! the stiffness of the whole body
      integer, intent(in) :: position !! the position
      logical, intent(in) :: is_contact(:) !! whether a position is one of a contact point (n)
      integer, allocatable :: near(:)
      integer :: j

      associate (all_near => [(j, j=max(1, position - matrix%width), min(matrix%n, position + matrix%width))])
         near = pack(all_near, [(.not. is_contact(all_near(j)) &
            .and. abs(matrix%element(all_near(j), position)) > 0.0_dp, j=1, size(all_near))])
      end associate
   end function neighbors

   !> Computes all displacements from those of the contact points: solves K_ii x_i = f_i - K_ic v.
   pure subroutine band_stiffness_find_interior(self, v, x, interior_load)
      class(band_stiffness_t), intent(in) :: self !! the stiffness
      real(dp), intent(in) :: v(:) !! (u_N; u_T) (2m) [L]
      real(dp), contiguous, intent(out) :: x(:) !! all displacements by position (n) [L]
      real(dp), intent(in), optional :: interior_load(:) !! f_i, by unknown; 0 if absent [F]
      real(dp) :: right(size(x))

      x = 0.0_dp
      x(self%place) = v
      call self%whole%multiply(x, right)
      right = -right
      if (present(interior_load)) right(self%interior) = right(self%interior) + interior_load
      right(self%place) = 0.0_dp
      call self%factor%solve(right)
      x = right
      x(self%place) = v
   end subroutine band_stiffness_find_interior

   !> The product S v, by the band matrix of the whole body: the interior displacements follow from v.
   pure subroutine band_stiffness_multiply(self, v, product)
      class(band_stiffness_t), intent(in) :: self !! the stiffness
      real(dp), intent(in) :: v(:) !! the vector (2m) [L]
      real(dp), intent(out) :: product(:) !! the product (2m) [F]
      real(dp) :: x(self%whole%n), y(self%whole%n)

      call self%find_interior(v, x)
      call self%whole%multiply(x, y)
      product = y(self%place)
   end subroutine band_stiffness_multiply

   !> A load condensed to the contact points: q = f_c - K_ci K_ii^-1 f_i (2m) [F].
   pure function band_stiffness_condensed(self, interior_load, contact_load) result(condensed)
      class(band_stiffness_t), intent(in) :: self !! the stiffness
      real(dp), intent(in) :: interior_load(:) !! f_i, by unknown [F]
      real(dp), intent(in) :: contact_load(:) !! f_c on (u_N; u_T) (2m) [F]
      real(dp), allocatable :: condensed(:)
      real(dp) :: x(self%whole%n), y(self%whole%n)

      call self%find_interior(spread(0.0_dp, 1, size(contact_load)), x, interior_load)
      call self%whole%multiply(x, y)
      condensed = contact_load - y(self%place)
   end function band_stiffness_condensed

   !> The displacements of the interior from those of the contact points, by unknown [L].
   pure function band_stiffness_interior_displacement(self, interior_load, v) result(interior)
      class(band_stiffness_t), intent(in) :: self !! the stiffness
      real(dp), intent(in) :: interior_load(:) !! f_i, by unknown [F]
      real(dp), intent(in) :: v(:) !! (u_N; u_T) (2m) [L]
      real(dp), allocatable :: interior(:)
      real(dp) :: x(self%whole%n)

      call self%find_interior(v, x, interior_load)
      interior = x(self%interior)
   end function band_stiffness_interior_displacement

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

   !> The stiffness of each row in the terms of a product S v: the diagonal of S, with a band that of the whole body,
   !> which is far larger where what is nearly incompressible or stiff hangs on something soft (n) [F/L].
   pure function contact_operator_largest_terms(self) result(terms)
      class(contact_operator_t), intent(in) :: self !! the operator, with a stiffness
      real(dp), allocatable :: terms(:)
      ! Sum of the magnitudes of a row of the matrix of a body, over its diagonal entry.
      real(dp), parameter :: of_row = 4.0_dp

      terms = self%augmentation
      if (allocated(self%band)) terms = max(terms, of_row*self%band%whole%entry(1, self%band%place))
   end function contact_operator_largest_terms

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

   !> The product S v, whatever the form of the operator.
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
         matrix%proximal_parameter = share*sum(matrix%augmentation)/(matrix%n*(matrix%n/(1 + matrix%n_tangents)))
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
      real(dp) :: unit(matrix%n), mean
      integer :: i, j

      call allocate_matrix(dense, matrix%n, matrix%n, 'the contact points', error)
      if (allocated(error)) return
      if (allocated(matrix%stiffness)) then
         dense(:, :) = matrix%stiffness%values
         return
      end if
      do j = 1, matrix%n
         unit = 0.0_dp
         unit(j) = 1.0_dp
         call matrix%band%multiply(unit, dense(:, j))
      end do
      do j = 1, matrix%n
         do i = j + 1, matrix%n
            mean = 0.5_dp*(dense(i, j) + dense(j, i))
            dense(i, j) = mean
            dense(j, i) = mean
         end do
      end do
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
         self%band%whole%entry(1, self%band%place) = body%band%whole%entry(1, self%band%place) + springs
         self%band%diagonal = body%band%diagonal + springs
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

   !> Adds k m m^T to the stiffness: a spring k that resists a motion m of all points.
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

   !> Makes the operator of one part of the contact points that does not act on the others.
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
