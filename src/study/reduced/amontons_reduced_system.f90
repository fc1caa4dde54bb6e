!> Reduced problems in the convention of other programs: `u = W r + q`, the forces r in Coulomb's cones.
!>
!> The unknowns of a contact are consecutive, normal before tangential, two of them in the plane and three in space:
!> `u_N >= 0 _|_ r_N >= 0`, `|r_T| <= mu r_N`, and r_T opposes u_T. With lambda = (r_N; -r_T) this is the dual form of
!> the contact problem: W_NN = A11, W_NT = -A12, W_TT = A22, q_N = -B1, q_T = B2 (theory, section 2); n is the number of
!> unknowns. W may differ from its transpose by rounding: the contact problem has the mean of both, and
!> `set_free_displacement` adds the difference to the free displacements.
module amontons_reduced_system
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_contact_operator, only: contact_operator_t, new_compliance_operator
   use amontons_contact_problem, only: contact_problem_t, new_reduced_problem
   use amontons_dense, only: allocate_matrix
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_friction_law, only: tangential_norm
   use amontons_kinds, only: dp
   use amontons_rounding, only: sum_rounding
   use amontons_symmetric_matrix, only: new_dense_matrix, new_sparse_matrix, symmetric_matrix_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: entries_t, new_condensed_system, new_dense_system, new_reduced_system, reduced_system_t

   !> Largest error of an entry of W, over the root of the product of its two diagonal entries: files have six digits or
   !> more.
   real(dp), parameter :: rounding = 1.0e-3_dp
   !> Largest difference of an entry from its mirror image in space, on the same scale: rotating bodies add a skew part
   !> to W that is no rounding error.
   real(dp), parameter :: gyroscopic = 5.0e-2_dp
   !> Smallest positive diagonal entry over the largest one: a residual of all contacts hides what is wrong at contacts
   !> in units still farther apart.
   real(dp), parameter :: least_part = 1.0e-20_dp
   !> Largest share of nonzero entries, and smallest number of rows, of a matrix that is stored as sparse.
   real(dp), parameter :: sparse_fill = 0.25_dp
   integer, parameter :: most_dense_rows = 200

   !> Entries of a matrix in the order of a file.
   type :: entries_t
      integer :: n = 0 !! number of entries
      integer, allocatable :: row(:) !! their rows, from 1 (at least n)
      integer, allocatable :: column(:) !! their columns, from 1 (at least n)
      integer, allocatable :: place(:) !! their positions in the file, for messages (at least n)
      real(dp), allocatable :: value(:) !! the entries; those of one place add up (at least n) [L/F]
   contains
      procedure :: append => entries_append
   end type entries_t

   !> A reduced problem. W is stored column by column, without its zeros.
   type :: reduced_system_t
      integer :: n_contacts = 0 !! number m of contacts
      integer :: dimension = 2 !! number of unknowns of a contact: 2 in the plane, 3 in space
      integer, allocatable :: first(:) !! where each column begins in `row` and `entry`, and the end (n + 1)
      integer, allocatable :: row(:) !! rows of the entries, ascending within a column
      real(dp), allocatable :: entry(:) !! the entries [L/F]
      real(dp), allocatable :: q(:) !! u without forces (n) [L]
      real(dp), allocatable :: friction(:) !! mu (m) [-]
      real(dp) :: asymmetry = 0.0_dp !! largest difference of W from its transpose [L/F]
      real(dp) :: largest = 0.0_dp !! largest diagonal entry of W [L/F]
      character(:), allocatable :: form !! its source, for the listing: 'Siconos text, dense'
      real(dp), allocatable :: u(:) !! displacements of a solution, if there is one (n) [L]
      real(dp), allocatable :: r(:) !! forces of that solution (n) [F]
   contains
      procedure :: by_component => reduced_system_by_component
      procedure :: by_contact => reduced_system_by_contact
      procedure :: compliance_unit => reduced_system_compliance_unit
      procedure :: contact_problem => reduced_system_contact_problem
      procedure :: diagonal => reduced_system_diagonal
      procedure :: is_dense => reduced_system_is_dense
      procedure :: largest_part => reduced_system_largest_part
      procedure :: length_unit => reduced_system_length_unit
      procedure :: multiply => reduced_system_multiply
      procedure :: set_solution => reduced_system_set_solution
      procedure :: set_free_displacement => reduced_system_set_free_displacement
      procedure :: skew_displacement => reduced_system_skew_displacement
   end type reduced_system_t

contains

   !> Appends an entry of a sparse matrix.
   pure subroutine entries_append(self, row, column, value, place)
      class(entries_t), intent(inout) :: self !! the entries
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      real(dp), intent(in) :: value !! the entry [L/F]
      integer, intent(in) :: place !! its position in the file
      integer, allocatable :: room(:)

      if (.not. allocated(self%row)) allocate (self%row(0), self%column(0), self%place(0), self%value(0))
      if (self%n == size(self%row)) then
         room = spread(0, 1, self%n + 64)
         self%row = [self%row, room]
         self%column = [self%column, room]
         self%place = [self%place, room]
         self%value = [self%value, real(room, dp)]
      end if
      self%n = self%n + 1
      self%row(self%n) = row
      self%column(self%n) = column
      self%value(self%n) = value
      self%place(self%n) = place
   end subroutine entries_append

   !> Makes a reduced problem, unless W cannot be symmetric and positive semidefinite.
   pure subroutine new_reduced_system(system, entries, q, friction, sentence, place)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      type(entries_t), intent(in) :: entries !! W, rows and columns within range
      real(dp), intent(in) :: q(:) !! u without forces (n) [L]
      real(dp), intent(in) :: friction(:) !! mu, not negative (m) [-]
      character(:), allocatable, intent(out) :: sentence !! the fault, as a sentence; not allocated if there is none
      integer, intent(out) :: place !! the place of the entry that it is about
      type(symmetric_matrix_t) :: w, transposed
      real(dp), allocatable :: diagonal(:)
      integer :: fault(2), k

      associate (n => entries%n)
         call new_sparse_matrix(w, size(q), entries%row(:n), entries%column(:n), entries%value(:n))
         call new_sparse_matrix(transposed, size(q), entries%column(:n), entries%row(:n), entries%value(:n))
      end associate
      system%n_contacts = size(friction)
      if (size(q) > 2*size(friction)) system%dimension = 3
      system%q = q
      system%friction = friction
      call move_alloc(w%first, system%first)
      call move_alloc(w%row, system%row)
      call move_alloc(w%entry, system%entry)
      allocate (diagonal, source=system%diagonal())
      system%largest = max(0.0_dp, maxval(diagonal))
      place = 0
      if (any(diagonal < -sum_rounding*system%largest)) then
         fault = minloc(diagonal, dim=1)
         sentence = entry_name(fault)//' = '//to_text(diagonal(fault(1)))//': expected no negative number on the '// &
            'diagonal of W'
      else if (any(diagonal > 0.0_dp .and. diagonal < least_part*system%largest)) then
         fault = minloc(diagonal, dim=1, mask=diagonal > 0.0_dp)
         sentence = entry_name(fault)//' = '//to_text(diagonal(fault(1)))//' beside a diagonal entry of '// &
            to_text(system%largest)//': expected positive numbers on the diagonal of W within a factor of 1e20; '// &
            'count contacts in units that are closer to each other'
      else
         call check_entries(system, transposed, diagonal, sentence, fault)
      end if
      if (.not. allocated(sentence)) return
      do k = 1, entries%n
         if (entries%row(k) == fault(1) .and. entries%column(k) == fault(2)) place = entries%place(k)
      end do
   end subroutine new_reduced_system

   !> Compares W with its transpose and every entry with the diagonal.
   pure subroutine check_entries(system, transposed, diagonal, sentence, fault)
      type(reduced_system_t), intent(inout) :: system !! the reduced problem; gains its asymmetry
      type(symmetric_matrix_t), intent(in) :: transposed !! the transpose of W, column by column
      real(dp), intent(in) :: diagonal(:) !! the diagonal of W (n) [L/F]
      character(:), allocatable, intent(out) :: sentence !! the fault, as a sentence; not allocated if there is none
      integer, intent(out) :: fault(2) !! row and column of the entry that it is about
      real(dp) :: column(size(diagonal)), mirrored(size(diagonal)), scale, difference, off
      integer :: j, k

      off = merge(rounding, gyroscopic, system%dimension == 2)
      column = 0.0_dp
      mirrored = 0.0_dp
      fault = 0
      do j = 1, size(diagonal)
         associate (own => [(k, k=system%first(j), system%first(j + 1) - 1)], &
            other => [(k, k=transposed%first(j), transposed%first(j + 1) - 1)])
            column(system%row(own)) = system%entry(own)
            mirrored(transposed%row(other)) = transposed%entry(other)
            do k = 1, size(own)
               fault = [system%row(own(k)), j]
               scale = sqrt(max(0.0_dp, diagonal(fault(1))))*sqrt(max(0.0_dp, diagonal(j)))
               difference = abs(column(fault(1)) - mirrored(fault(1)))
               system%asymmetry = max(system%asymmetry, difference)
               if (abs(column(fault(1))) > (1.0_dp + off)*scale + sum_rounding*system%largest) then
                  sentence = entry_name(fault)//' = '//to_text(column(fault(1)))//' beside the diagonal entries '// &
                     to_text(diagonal(fault(1)))//' and '//to_text(diagonal(j))//': expected a positive '// &
                     'semidefinite W, no entry of which exceeds the root of their product'
                  return
               end if
               if (difference > off*scale + sum_rounding*system%largest) then
                  sentence = entry_name(fault)//' = '//to_text(column(fault(1)))//' and '//entry_name(fault(2:1:-1))// &
                     ' = '//to_text(mirrored(fault(1)))//' differ by more than rounding: expected a symmetric W'
                  return
               end if
            end do
            column(system%row(own)) = 0.0_dp
            mirrored(transposed%row(other)) = 0.0_dp
         end associate
      end do
   end subroutine check_entries

   !> The name of an entry in messages: 'W(3, 1)', counted from 1.
   pure function entry_name(place) result(name)
      integer, intent(in) :: place(2) !! row and column
      character(:), allocatable :: name

      name = 'W('//to_text(place(1))//', '//to_text(place(2))//')'
   end function entry_name

   !> Makes the reduced problem of a contact problem, from its compliance and dual load.
   subroutine new_condensed_system(system, problem, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      type(contact_problem_t), intent(in) :: problem !! the contact problem; its operator gains its compliance
      type(error_t), allocatable, intent(out) :: error !! there is no such reduced problem
      real(dp), allocatable :: values(:, :), sign(:), dual_load(:)
      integer, allocatable :: order(:)
      integer :: m, i, j

      m = problem%n_points
      if (.not. problem%matrix%is_held) then
         call new_error(error, input_refused, 'this case has no reduced problem u = W r + q to write: only contact '// &
            'holds a rigid-body mode, so that W would be infinite; add a support')
      else if (any(problem%slip_bound > 0.0_dp)) then
         call new_error(error, input_refused, 'this case has no reduced problem u = W r + q to write: it '// &
            'knows only the bound mu r of the friction, no given slip_bound')
      else
         call problem%matrix%prepare_compliance(error)
      end if
      if (allocated(error)) return
      system%dimension = 1 + problem%matrix%n_tangents
      order = [((i + j*m, j=0, problem%matrix%n_tangents), i=1, m)]
      sign = [(1.0_dp, (-1.0_dp, j=1, problem%matrix%n_tangents), i=1, m)]
      values = problem%matrix%compliance%block(order, order)
      allocate (system%first(size(order) + 1), source=1)
      do j = 1, size(order)
         system%first(j + 1) = system%first(j) + count(abs(values(:, j)) > 0.0_dp)
      end do
      system%row = pack(spread([(i, i=1, size(order))], 2, size(order)), abs(values) > 0.0_dp)
      system%entry = pack(spread(sign, 1, size(sign))*spread(sign, 2, size(sign))*values, abs(values) > 0.0_dp)
      system%n_contacts = m
      dual_load = problem%dual_load(spread(0.0_dp, 1, size(order)))
      system%q = -sign*dual_load(order)
      system%friction = problem%friction
      system%largest = maxval(system%diagonal())
      system%form = 'condensed'
   end subroutine new_condensed_system

   !> Whether W is to be stored as a dense matrix.
   pure logical function reduced_system_is_dense(self) result(is_dense)
      class(reduced_system_t), intent(in) :: self !! the reduced problem

      is_dense = size(self%q) <= most_dense_rows .or. size(self%entry) >= sparse_fill*real(size(self%q), dp)**2
   end function reduced_system_is_dense

   !> The diagonal of W (n) [L/F].
   pure function reduced_system_diagonal(self) result(diagonal)
      class(reduced_system_t), intent(in) :: self !! the reduced problem
      real(dp) :: diagonal(size(self%q))
      integer :: j, k

      diagonal = 0.0_dp
      do j = 1, size(diagonal)
         do k = self%first(j), self%first(j + 1) - 1
            if (self%row(k) == j) diagonal(j) = self%entry(k)
         end do
      end do
   end function reduced_system_diagonal

   !> The products W r and W^T r (n) [L].
   pure subroutine reduced_system_multiply(self, r, product, transposed_product)
      class(reduced_system_t), intent(in) :: self !! the reduced problem
      real(dp), intent(in) :: r(:) !! the forces (n) [F]
      real(dp), intent(out) :: product(:) !! W r (n) [L]
      real(dp), intent(out) :: transposed_product(:) !! W^T r (n) [L]
      integer :: j, k

      product = 0.0_dp
      do j = 1, size(r)
         transposed_product(j) = 0.0_dp
         do k = self%first(j), self%first(j + 1) - 1
            product(self%row(k)) = product(self%row(k)) + self%entry(k)*r(j)
            transposed_product(j) = transposed_product(j) + self%entry(k)*r(self%row(k))
         end do
      end do
   end subroutine reduced_system_multiply

   !> The unit of displacements for the methods, a power of two that makes their numbers of order one [L].
   pure real(dp) function reduced_system_length_unit(self) result(unit)
      class(reduced_system_t), intent(in) :: self !! the reduced problem

      unit = 1.0_dp
      if (any(abs(self%q) > 0.0_dp)) unit = scale(1.0_dp, exponent(maxval(abs(self%q))))
   end function reduced_system_length_unit

   !> The unit of compliances for the methods, a power of two [L/F].
   pure real(dp) function reduced_system_compliance_unit(self) result(unit)
      class(reduced_system_t), intent(in) :: self !! the reduced problem

      unit = 1.0_dp
      if (self%largest > 0.0_dp) unit = scale(1.0_dp, exponent(self%largest))
   end function reduced_system_compliance_unit

   !> Makes the contact problem in the units of `compliance_unit` and `length_unit`.
   subroutine reduced_system_contact_problem(self, matrix, problem, error)
      class(reduced_system_t), intent(in) :: self !! the reduced problem
      type(contact_operator_t), target, intent(inout) :: matrix !! its operator; must outlive the contact problem
      type(contact_problem_t), intent(out) :: problem !! the contact problem
      type(error_t), allocatable, intent(out) :: error !! memory ran out
      type(symmetric_matrix_t) :: compliance
      integer, allocatable :: row(:), column(:)
      real(dp), allocatable :: half(:), values(:, :)
      integer :: j, k, n

      n = size(self%q)
      allocate (column(size(self%row)))
      do j = 1, n
         column(self%first(j):self%first(j + 1) - 1) = contact_number(j, self%n_contacts, self%dimension)
      end do
      row = contact_number(self%row, self%n_contacts, self%dimension)
      half = 0.5_dp*(self%entry/self%compliance_unit())*merge(1.0_dp, -1.0_dp, &
         row > self%n_contacts .eqv. column > self%n_contacts)
      if (self%is_dense()) then
         call allocate_matrix(values, n, n, 'the reduced problem', error)
         if (allocated(error)) return
         values = 0.0_dp
         do k = 1, size(half)
            values(row(k), column(k)) = values(row(k), column(k)) + half(k)
            values(column(k), row(k)) = values(column(k), row(k)) + half(k)
         end do
         call new_dense_matrix(compliance, values)
      else
         call new_sparse_matrix(compliance, n, [row, column], [column, row], [half, half])
      end if
      if (self%dimension == 3) compliance%n_pairs = self%n_contacts
      call new_compliance_operator(matrix, compliance)
      call new_reduced_problem(problem, matrix, spread(0.0_dp, 1, n), self%friction)
      call self%set_free_displacement(problem, spread(0.0_dp, 1, n))
   end subroutine reduced_system_contact_problem

   !> The row of an unknown in the contact problem, where all normal ones precede the tangential ones.
   elemental integer function contact_number(unknown, n_contacts, dimension) result(number)
      integer, intent(in) :: unknown !! number of the unknown here, from 1
      integer, intent(in) :: n_contacts !! number of contacts
      integer, intent(in) :: dimension !! number of unknowns of a contact

      number = 1 + (unknown - 1)/dimension + modulo(unknown - 1, dimension)*n_contacts
   end function contact_number

   !> Sets the free displacements of the contact problem to q plus the displacements by the skew part of W at
   !> given forces: a solution with these forces solves the problem with the original W.
   pure subroutine reduced_system_set_free_displacement(self, problem, force)
      class(reduced_system_t), intent(in) :: self !! the reduced problem
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      real(dp), intent(in) :: force(:) !! lambda, in the units of the contact problem (n)

      problem%free_displacement = self%by_component(self%q/self%length_unit())
      if (self%asymmetry > 0.0_dp) problem%free_displacement = problem%free_displacement + self%skew_displacement(force)
   end subroutine reduced_system_set_free_displacement

   !> The displacements by the skew part of W at forces of the contact problem, in the units of the methods (2m).
   pure function reduced_system_skew_displacement(self, force) result(displacement)
      class(reduced_system_t), intent(in) :: self !! the reduced problem
      real(dp), intent(in) :: force(:) !! lambda (2m)
      real(dp) :: displacement(size(self%q))
      real(dp), dimension(size(self%q)) :: product, transposed_product

      call self%multiply(self%by_contact(force), product, transposed_product)
      displacement = self%by_component(0.5_dp*(product - transposed_product)/self%compliance_unit())
   end function reduced_system_skew_displacement

   !> Displacements in the order of the contact problem, component by component, with the normal distance negative (n).
   pure function reduced_system_by_component(self, u) result(v)
      class(reduced_system_t), intent(in) :: self !! the reduced problem
      real(dp), intent(in) :: u(:) !! displacements, contact by contact (n)
      real(dp) :: v(size(u))
      integer :: k

      v = [(u(k::self%dimension), k=1, self%dimension)]
      v(:self%n_contacts) = -v(:self%n_contacts)
   end function reduced_system_by_component

   !> Forces of the contact problem in the order of W, contact by contact, the tangential ones reversed (n).
   pure function reduced_system_by_contact(self, force) result(r)
      class(reduced_system_t), intent(in) :: self !! the reduced problem
      real(dp), intent(in) :: force(:) !! lambda (n)
      real(dp) :: r(size(force))
      integer :: k

      r(1::self%dimension) = force(:self%n_contacts)
      do k = 1, self%dimension - 1
         r(k + 1::self%dimension) = 0.0_dp - force(k*self%n_contacts + 1:(k + 1)*self%n_contacts)
      end do
   end function reduced_system_by_contact

   !> The largest magnitude of a normal component or a tangential vector among displacements or forces of the contacts.
   pure real(dp) function reduced_system_largest_part(self, values) result(largest)
      class(reduced_system_t), intent(in) :: self !! the reduced problem, with contacts
      real(dp), intent(in) :: values(:) !! displacements or forces, contact by contact (n)

      associate (parts => self%by_component(values), m => self%n_contacts)
         largest = max(maxval(abs(parts(:m))), maxval(tangential_norm(parts(m + 1:), m)))
      end associate
   end function reduced_system_largest_part

   !> Sets the solution from the forces of a contact problem: r and u = W r + q.
   pure subroutine reduced_system_set_solution(self, force, unit)
      class(reduced_system_t), intent(inout) :: self !! the reduced problem, gains u and r
      real(dp), intent(in) :: force(:) !! lambda of the contact problem (2m)
      real(dp), intent(in) :: unit !! the force that it is counted in [F]
      real(dp) :: transposed_product(size(self%q))

      if (.not. allocated(self%u)) allocate (self%u(size(self%q)))
      self%r = self%by_contact(unit*force)
      call self%multiply(self%r, self%u, transposed_product)
      self%u = self%u + self%q
   end subroutine reduced_system_set_solution

   !> Makes a reduced problem from arrays, of the plane or of space. The unknowns of a contact are adjacent, the
   !> normal one first.
   pure subroutine new_dense_system(system, w, q, friction, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      real(dp), intent(in) :: w(:, :) !! W, symmetric and positive semidefinite (n, n) [L/F]
      real(dp), intent(in) :: q(:) !! u without forces (n) [L]
      real(dp), intent(in) :: friction(:) !! mu, at least 0 (m) [-]
      type(error_t), allocatable, intent(out) :: error !! sizes or numbers that cannot be
      type(entries_t) :: entries
      character(:), allocatable :: sentence
      integer :: i, n, place, at(2)

      ! Three unknowns of a contact are those of space.
      n = merge(3, 2, size(q) == 3*size(friction))*size(friction)
      if (any([shape(w), size(q)] /= n)) then
         call new_error(error, input_refused, 'expected W of '//to_text(n)//' rows and columns and '// &
            'as many numbers q for the '//to_text(size(friction))//' contacts of mu, found W of '// &
            to_text(size(w, 1))//' x '//to_text(size(w, 2))//' and '//to_text(size(q))//' numbers q')
      else if (.not. all(ieee_is_finite(w))) then
         at = findloc(ieee_is_finite(w), .false.)
         call refuse(entry_name(at), w(at(1), at(2)), 'a finite number', error)
      else if (.not. all(ieee_is_finite(q))) then
         i = findloc(ieee_is_finite(q), .false., dim=1)
         call refuse('q('//to_text(i)//')', q(i), 'a finite number', error)
      else if (.not. all(ieee_is_finite(friction) .and. friction >= 0.0_dp)) then
         i = findloc(ieee_is_finite(friction) .and. friction >= 0.0_dp, .false., dim=1)
         call refuse('mu('//to_text(i)//')', friction(i), 'a finite number, at least 0', error)
      end if
      if (allocated(error)) return
      entries%n = count(abs(w) > 0.0_dp)
      entries%row = pack(spread([(i, i=1, n)], 2, n), abs(w) > 0.0_dp)
      entries%column = pack(spread([(i, i=1, n)], 1, n), abs(w) > 0.0_dp)
      entries%value = pack(w, abs(w) > 0.0_dp)
      entries%place = spread(0, 1, entries%n)
      call new_reduced_system(system, entries, q, friction, sentence, place)
      if (allocated(sentence)) call new_error(error, input_refused, sentence)
      system%form = 'arrays'
   end subroutine new_dense_system

   !> Makes the error that a number is not what was expected.
   pure subroutine refuse(name, value, expected, error)
      character(*), intent(in) :: name !! the number's name, counted from 1
      real(dp), intent(in) :: value !! the number
      character(*), intent(in) :: expected !! the expected value
      type(error_t), allocatable, intent(out) :: error !! says so

      call new_error(error, input_refused, name//' = '//to_text(value)//': expected '//expected)
   end subroutine refuse

end module amontons_reduced_system
