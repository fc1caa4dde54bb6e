!> The condensed stiffness S of a slender body without forming it: a product with S is one with the stiffness of the
!> whole body, after the interior displacements are solved for.
!>
!> The unknowns are in an order that makes the matrix a narrow band, those of a contact point in its normal and
!> tangential direction. Time and memory are proportional to the length of the body.
module amontons_band_stiffness
   use amontons_band_matrix, only: new_symmetric_band, symmetric_band_t
   use amontons_dense, only: allocate_matrix
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp, int64
   use amontons_sparse_matrix, only: positions, sparse_matrix_t
   implicit none (type, external)
   private

   public :: band_stiffness_t, new_band_stiffness

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
      procedure :: fill_dense => band_stiffness_fill_dense
      procedure :: interior_displacement => band_stiffness_interior_displacement
      procedure :: multiply => band_stiffness_multiply
      procedure :: set_diagonal => band_stiffness_set_diagonal
      procedure, private :: find_interior => band_stiffness_find_interior
   end type band_stiffness_t

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
      integer :: at(2, matrix%n), position(matrix%n)
      real(dp) :: weight(2, matrix%n)
      integer :: p, m, k, n_interior, n_constrained, i, info, width

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
      ! Room for the matrix and its factor, and for the factors of the body and of a method, which are made later.
      width = largest_distance(matrix, at)
      call allocate_matrix(room, 11*(width + 1), matrix%n + count(unknown == 0), 'the band stiffness', error)
      if (allocated(error)) return
      deallocate (room)
      call new_symmetric_band(stiffness%whole, matrix%n + count(unknown == 0), width)
      call add_matrix(stiffness%whole, matrix, at, weight)
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

   !> Sets the diagonal of this copy to that of the original plus springs at the contact points.
   pure subroutine band_stiffness_set_diagonal(self, original, springs)
      class(band_stiffness_t), intent(inout) :: self !! a copy, with any springs before
      type(band_stiffness_t), intent(in) :: original !! the original
      real(dp), intent(in) :: springs(:) !! stiffness of the springs in (u_N; u_T) (2m) [F/L]

      self%whole%entry(1, self%place) = original%whole%entry(1, self%place) + springs
      self%diagonal = original%diagonal + springs
   end subroutine band_stiffness_set_diagonal

   !> The largest difference of the positions that one entry of a matrix couples.
   pure integer function largest_distance(matrix, at) result(width)
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix
      integer, intent(in) :: at(:, :) !! the positions that each unknown stands for, 0 for none (2, n)
      integer(int64) :: entry
      integer :: j, k, l

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
   end function largest_distance

   !> Adds the entries of a matrix, transformed to the normal and tangential directions of the contact points.
   pure subroutine add_matrix(band, matrix, at, weight)
      type(symmetric_band_t), intent(inout) :: band !! the matrix by position
      type(sparse_matrix_t), intent(in) :: matrix !! the matrix by unknown
      integer, intent(in) :: at(:, :) !! the positions that each unknown stands for, 0 for none (2, n)
      real(dp), intent(in) :: weight(:, :) !! their shares in it (2, n) [-]
      integer(int64) :: entry
      integer :: i, j, k, l
      real(dp) :: value

      do j = 1, matrix%n
         do entry = matrix%column_start(j), matrix%column_start(j + 1) - 1
            i = matrix%row(entry)
            do k = 1, count(at(:, j) > 0)
               do l = 1, count(at(:, i) > 0)
                  ! The entry across the diagonal adds as much, on the other side of the new diagonal or on it.
                  if (i == j .and. at(l, i) < at(k, j)) cycle
                  value = weight(k, j)*weight(l, i)*matrix%value(entry)
                  if (i /= j .and. at(l, i) == at(k, j)) value = 2.0_dp*value
                  call band%add(at(l, i), at(k, j), value)
               end do
            end do
         end do
      end do
   end subroutine add_matrix

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

   !> The product S v.
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

   !> Fills an array with S, column by column, for methods that need the dense matrix.
   pure subroutine band_stiffness_fill_dense(self, dense)
      class(band_stiffness_t), intent(in) :: self !! the stiffness
      real(dp), contiguous, intent(out) :: dense(:, :) !! S (2m, 2m) [F/L]
      real(dp) :: unit(size(self%place)), mean
      integer :: i, j

      do j = 1, size(unit)
         unit = 0.0_dp
         unit(j) = 1.0_dp
         call self%multiply(unit, dense(:, j))
      end do
      do j = 1, size(unit)
         do i = j + 1, size(unit)
            mean = 0.5_dp*(dense(i, j) + dense(j, i))
            dense(i, j) = mean
            dense(j, i) = mean
         end do
      end do
   end subroutine band_stiffness_fill_dense

end module amontons_band_stiffness
