!> Least squares with matrices of many zeros, vectors that a matrix maps to zero, and the distance of a vector from the
!> cone of forces with friction.
!>
!> The cone: of a vector the best approximation by works of contact forces, with factors at least 0, is found by Lawson
!> and Hanson's algorithm (Solving Least Squares Problems, 1974, chapter 23). Its columns are made on demand: of each
!> contact set the force that works most against what remains of the vector, n, or n + phi t with t along the slip of
!> the point there, in the plane and in space alike. Forces of given slip bounds g are a convex set; the largest work of
!> all forces of a set against the remainder is that of g t. A row of its own for each set, 1 for its columns and for
!> the vector, makes sums of factors of at most 1 of them. Where nothing opposes the remainder it is, by Farkas' lemma,
!> a motion along which the vector does work and no force of the cone does.
module amontons_cone
   use amontons_integer_list, only: fill_bins
   use amontons_kinds, only: dp
   use amontons_rounding, only: difference_rounding
   implicit none (type, external)
   private

   public :: cone_t, least_squares, new_cone, null_vectors

   !> Of a column the length, over its own, below which it is no more than a sum of the columns before it.
   real(dp), parameter :: damping = 1.0e-9_dp

   !> The works of unit contact forces on some motions: of each point along the normal and the tangents.
   type :: cone_t
      integer :: n_motions = 0 !! number of motions
      integer, allocatable :: start(:) !! first entry of each point (m + 1)
      integer, allocatable :: motion(:) !! the motions on which the forces of a point do work (entries)
      real(dp), allocatable :: work(:, :) !! works of normal and tangential forces (1 + n_tangents, entries) [-]
      real(dp), allocatable :: friction(:) !! friction coefficient; negative where a point bears no normal force (m) [-]
      real(dp), allocatable :: slip_bound(:) !! given slip bound (m) [F]
      integer, allocatable :: set(:) !! the contact set of each point; columns of several sets enter at once (m)
   contains
      procedure :: remainder => cone_remainder
      procedure, private :: find_opposing => cone_find_opposing
   end type cone_t

   !> The triangle R of an orthogonal transformation Q R of a matrix, made of its rows one by one.
   type :: triangle_t
      real(dp), allocatable :: row(:, :) !! row k of R in column k (n, n)
      real(dp), allocatable :: right(:) !! Q^T times the right-hand side (n)
      integer, allocatable :: last(:) !! last entry of each row that is not 0; 0 for a row that is missing (n)
   contains
      procedure :: add_row => triangle_add_row
      procedure :: solution => triangle_solution
   end type triangle_t

contains

   !> Makes the cone of some points without given slip bounds.
   pure subroutine new_cone(cone, works, friction)
      type(cone_t), intent(out) :: cone !! the cone
      real(dp), intent(in) :: works(:, :)
         !! works of unit forces: displacements (u_N; u_T) of the points under the motions (rows, motions) [-]
      real(dp), intent(in) :: friction(:)
         !! friction coefficient of each point; negative where it bears no normal force (m) [-]
      integer :: k, m, n_entries, p, pass

      m = size(friction)
      cone%n_motions = size(works, 2)
      cone%friction = friction
      allocate (cone%slip_bound(m), source=0.0_dp)
      allocate (cone%set(m), source=1)
      allocate (cone%start(m + 1), source=1)
      do pass = 1, 2
         n_entries = 0
         do p = 1, m
            do k = 1, size(works, 2)
               if (.not. any(abs(works(p::m, k)) > 0.0_dp)) cycle
               n_entries = n_entries + 1
               if (pass == 1) cycle
               cone%motion(n_entries) = k
               cone%work(:, n_entries) = works(p::m, k)
            end do
            cone%start(p + 1) = n_entries + 1
         end do
         if (pass == 1) allocate (cone%motion(n_entries), cone%work(size(works, 1)/max(1, m), n_entries))
      end do
   end subroutine new_cone

   !> The remainder of a vector after its best approximation by forces of the cone; 0 if it is rounding.
   pure function cone_remainder(self, vector) result(remainder)
      class(cone_t), intent(in) :: self !! the cone
      real(dp), intent(in) :: vector(:) !! the vector (motions)
      real(dp) :: remainder(size(vector))
      real(dp), allocatable :: columns(:, :), factor(:), whole(:), rest(:), found(:, :)
      integer, allocatable :: start(:), order(:)
      real(dp) :: before, errors
      logical :: is_single
      integer :: round

      whole = [vector, spread(norm2(vector), 1, maxval([0, pack(self%set, self%slip_bound > 0.0_dp)]))]
      rest = whole
      allocate (columns(size(whole), 0), factor(0))
      is_single = .false.
      do round = 1, 100 + 10*size(whole)
         errors = difference_rounding*(norm2(whole) + sum(factor))
         if (norm2(rest(:size(vector))) <= errors) rest(:size(vector)) = 0.0_dp
         if (.not. any(abs(rest(:size(vector))) > 0.0_dp)) exit
         call self%find_opposing(found, rest, norm2(vector), is_single)
         if (size(found, 2) == 0) exit
         found = found(:, new_columns(found, columns))
         columns = reshape([columns, found], [size(whole), size(factor) + size(found, 2)])
         factor = [factor, spread(0.0_dp, 1, size(found, 2))]
         ! In the order of their first motions: the triangle of the columns has a narrow band.
         call fill_bins(start, order, first_entries(columns), size(whole))
         columns = columns(:, order)
         factor = factor(order)
         before = norm2(rest)
         call improve_factors(columns, factor, whole)
         rest = whole - matmul(columns, factor)
         ! Several columns may hinder each other; one makes the remainder smaller.
         if (is_single .and. .not. norm2(rest) < before - errors) exit
         is_single = .not. norm2(rest) < before - errors
      end do
      remainder = rest(:size(vector))
   end function cone_remainder

   !> Finds the columns of the forces that work most against a remainder: of each contact set that of a point, and that
   !> of its given slip bounds.
   pure subroutine cone_find_opposing(self, found, rest, unit, is_single)
      class(cone_t), intent(in) :: self !! the cone
      real(dp), allocatable, intent(out) :: found(:, :) !! the columns, of length 1 (motions and sets, any)
      real(dp), intent(in) :: rest(:) !! the remainder (motions and sets)
      real(dp), intent(in) :: unit !! entry of a column of given slip bounds in the row of its set
      logical, intent(in) :: is_single !! whether of all these only the one that works most is wanted
      real(dp) :: columns(size(rest), maxval([0, self%set]) + size(rest) - self%n_motions)
      real(dp) :: gain(size(columns, 2)), largest, least
      real(dp), dimension(size(self%work, 1)) :: way, force
      real(dp), allocatable :: column(:)
      integer :: best(maxval([0, self%set])), i, n_sets, p, trial
      logical :: is_rough(size(best))

      n_sets = size(best)
      columns = 0.0_dp
      least = difference_rounding*norm2(rest)
      gain = least
      best = 0
      do p = 1, size(self%friction)
         associate (motion => self%motion(self%start(p):self%start(p + 1) - 1), &
            work => self%work(:, self%start(p):self%start(p + 1) - 1), set => self%set(p))
            way = matmul(work, rest(motion))
            way(2:) = way(2:)/max(norm2(way(2:)), tiny(1.0_dp))
            if (self%slip_bound(p) > 0.0_dp) then
               columns(motion, n_sets + set) = columns(motion, n_sets + set) &
                  + self%slip_bound(p)*matmul([0.0_dp, way(2:)], work)
               columns(self%n_motions + set, n_sets + set) = unit
            end if
            if (self%friction(p) < 0.0_dp) cycle
            ! Beside large friction rounding would lose the normal force.
            do trial = 1, 2
               column = matmul([1.0_dp, merge(self%friction(p), 0.0_dp, trial == 2)*way(2:)], work)
               largest = dot_product(column, rest(motion))/max(norm2(column), tiny(1.0_dp))
               if (.not. largest > gain(set)) cycle
               gain(set) = largest
               best(set) = p
               is_rough(set) = trial == 2
            end do
         end associate
      end do
      do i = n_sets + 1, size(gain)
         columns(:, i) = columns(:, i)/max(norm2(columns(:, i)), tiny(1.0_dp))
         gain(i) = dot_product(columns(:, i), rest)
      end do
      do i = 1, n_sets
         if (best(i) == 0) cycle
         p = best(i)
         associate (motion => self%motion(self%start(p):self%start(p + 1) - 1), &
            work => self%work(:, self%start(p):self%start(p + 1) - 1))
            way = matmul(work, rest(motion))
            force = [1.0_dp, merge(self%friction(p), 0.0_dp, is_rough(i))*way(2:)/max(norm2(way(2:)), tiny(1.0_dp))]
            columns(motion, i) = matmul(force, work)/norm2(matmul(force, work))
         end associate
      end do
      if (is_single) gain = merge(gain, least, [(i == maxloc(gain, dim=1), i=1, size(gain))])
      found = columns(:, pack([(i, i=1, size(gain))], gain > least))
   end subroutine cone_find_opposing

   !> Makes the factors of columns, at least 0, better, until their sum is the best approximation that has only these
   !> columns, or fewer: those whose factors would fall below 0 are removed.
   pure subroutine improve_factors(columns, factor, vector)
      real(dp), allocatable, intent(inout) :: columns(:, :) !! the columns, of length 1 (k, n)
      real(dp), allocatable, intent(inout) :: factor(:) !! their factors (n)
      real(dp), intent(in) :: vector(:) !! the vector that their sum comes close to (k)
      real(dp), allocatable :: change(:), share(:)
      integer, allocatable :: kept(:)
      integer :: i

      allocate (share(0))
      do
         change = damped_solution(columns, vector - matmul(columns, factor), 1.0_dp)
         share = merge(factor/max(-change, tiny(1.0_dp)), 1.0_dp, factor + change <= 0.0_dp)
         if (all(share >= 1.0_dp)) exit
         factor = factor + minval(share)*change
         kept = pack([(i, i=1, size(factor))], share > minval(share))
         columns = columns(:, kept)
         factor = factor(kept)
      end do
      factor = factor + change
   end subroutine improve_factors

   !> Those of some columns that are not among others.
   pure function new_columns(found, columns) result(new)
      real(dp), intent(in) :: found(:, :) !! the columns (k, any)
      real(dp), intent(in) :: columns(:, :) !! the others (k, n)
      integer, allocatable :: new(:)
      integer :: first(size(columns, 2)), of_found(size(found, 2)), i, k
      logical :: is_new(size(found, 2))

      first = first_entries(columns)
      of_found = first_entries(found)
      is_new = .true.
      do i = 1, size(found, 2)
         associate (same => pack([(k, k=1, size(first))], first == of_found(i)))
            is_new(i) = .not. any([(all(abs(columns(:, same(k)) - found(:, i)) <= 0.0_dp), k=1, size(same))])
         end associate
      end do
      new = pack([(i, i=1, size(is_new))], is_new)
   end function new_columns

   !> The first entry of each column that is not 0.
   pure function first_entries(columns) result(first)
      real(dp), intent(in) :: columns(:, :) !! the columns (k, n)
      integer :: first(size(columns, 2)), i

      do i = 1, size(first)
         first(i) = findloc(abs(columns(:, i)) > 0.0_dp, .true., dim=1)
      end do
   end function first_entries

   !> The factors of columns whose sum is closest to a vector; where several are, about the smallest.
   pure function least_squares(matrix, vector) result(factor)
      real(dp), intent(in) :: matrix(:, :) !! the columns (k, n)
      real(dp), intent(in) :: vector(:) !! the vector (k)
      real(dp) :: factor(size(matrix, 2)), scale

      scale = maxval([0.0_dp, norm2(matrix, dim=1)])
      factor = damped_solution(matrix, vector, scale)
      associate (left => matmul(vector - matmul(matrix, factor), matrix))
         if (any(abs(left) > difference_rounding*norm2(vector)*norm2(matrix, dim=1))) factor = factor &
            + damped_solution(matrix, vector - matmul(matrix, factor), scale)
      end associate
   end function least_squares

   !> The factors x of columns that make |A x - b|^2 + |d x|^2 least, with a small d.
   pure function damped_solution(matrix, vector, scale) result(factor)
      real(dp), intent(in) :: matrix(:, :) !! the columns A (k, n)
      real(dp), intent(in) :: vector(:) !! the vector b (k)
      real(dp), intent(in) :: scale !! the largest length of a column, to which d is in proportion
      real(dp) :: factor(size(matrix, 2))
      type(triangle_t) :: triangle
      real(dp) :: row(size(factor))
      integer :: i

      call new_triangle(triangle, size(factor))
      do i = 1, size(vector)
         call triangle%add_row(matrix(i, :), vector(i))
      end do
      do i = 1, size(factor)
         row = 0.0_dp
         row(i) = damping*scale
         call triangle%add_row(row, 0.0_dp)
      end do
      factor = triangle%solution()
   end function damped_solution

   !> Combinations of the columns of a matrix that are 0, each of length 1 (columns, any).
   pure function null_vectors(matrix, negligible) result(vectors)
      real(dp), intent(in) :: matrix(:, :) !! the matrix (k, n)
      real(dp), intent(in) :: negligible(:)
         !! length of each column, less the best combination of those before it, up to which it is one of these (n)
      real(dp), allocatable :: vectors(:, :)
      type(triangle_t) :: triangle
      real(dp) :: row(size(matrix, 2))
      integer, allocatable :: missing(:)
      integer :: i

      call new_triangle(triangle, size(matrix, 2))
      do i = 1, size(matrix, 1)
         call triangle%add_row(matrix(i, :), 0.0_dp)
      end do
      do i = 1, size(row)
         if (abs(triangle%row(i, i)) > negligible(i)) cycle
         row = triangle%row(:, i)
         row(:i) = 0.0_dp
         triangle%row(:, i) = 0.0_dp
         triangle%last(i) = 0
         call triangle%add_row(row, 0.0_dp)
      end do
      missing = pack([(i, i=1, size(row))], triangle%last == 0)
      allocate (vectors(size(row), size(missing)))
      do i = 1, size(missing)
         ! The column that has no row of its own, made of those before it.
         triangle%right = -triangle%row(missing(i), :)
         vectors(:, i) = triangle%solution()
         vectors(missing(i), i) = 1.0_dp
         vectors(:, i) = vectors(:, i)/norm2(vectors(:, i))
      end do
   end function null_vectors

   !> Begins an orthogonal transformation of a matrix without rows.
   pure subroutine new_triangle(triangle, n)
      type(triangle_t), intent(out) :: triangle !! the triangle
      integer, intent(in) :: n !! number of columns of the matrix

      allocate (triangle%row(n, n), triangle%right(n), source=0.0_dp)
      allocate (triangle%last(n), source=0)
   end subroutine new_triangle

   !> Adds a row of the matrix by plane rotations (George and Heath 1980): of rows in the order of their first entries
   !> only a band of the triangle is touched.
   pure subroutine triangle_add_row(self, added, right)
      class(triangle_t), intent(inout) :: self !! the triangle
      real(dp), intent(in) :: added(:) !! the row (n)
      real(dp), intent(in) :: right !! its entry of the right-hand side
      real(dp) :: row(size(added)), value, length, cosine, sine, before
      integer :: j, k, last

      row = added
      value = right
      last = findloc(abs(row) > 0.0_dp, .true., dim=1, back=.true.)
      do k = 1, size(row)
         if (k > last) return
         if (abs(row(k)) <= 0.0_dp) cycle
         if (self%last(k) == 0) then
            self%row(k:last, k) = row(k:last)
            self%right(k) = value
            self%last(k) = last
            return
         end if
         last = max(last, self%last(k))
         length = hypot(self%row(k, k), row(k))
         cosine = self%row(k, k)/length
         sine = row(k)/length
         do j = k, last
            before = self%row(j, k)
            self%row(j, k) = cosine*before + sine*row(j)
            row(j) = cosine*row(j) - sine*before
         end do
         before = self%right(k)
         self%right(k) = cosine*before + sine*value
         value = cosine*value - sine*before
         self%last(k) = last
      end do
   end subroutine triangle_add_row

   !> Solves R x = right; x is 0 where a row is missing.
   pure function triangle_solution(self) result(x)
      class(triangle_t), intent(in) :: self !! the triangle
      real(dp) :: x(size(self%right))
      integer :: k

      x = 0.0_dp
      do k = size(x), 1, -1
         if (self%last(k) == 0) cycle
         x(k) = (self%right(k) - dot_product(self%row(k + 1:self%last(k), k), x(k + 1:self%last(k))))/self%row(k, k)
      end do
   end function triangle_solution

end module amontons_cone
