!> The discrete inf-sup constant of constant multipliers: whether the mesh can represent them.
!>
!> beta = min over multipliers mu of max over displacements v of (mu, C v) / (|mu| |v|), both norms those of L2 on the
!> contact line: the least norm of the projection of a multiplier of norm 1 onto the traces of the body's displacements.
!> It depends on mesh, cells and supports alone and lies between 0 and 1.
module amontons_inf_sup
   use amontons_constraints, only: constraints_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: cholesky_factor, cholesky_solve
   use amontons_element, only: new_side_geometry, side_geometry_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_surface, only: meshed_body_t
   implicit none (type, external)
   private

   public :: inf_sup_constant

contains

   !> The constant of one contact set; 0 if some multiplier does no work on any displacement [-].
   pure real(dp) function inf_sup_constant(zone, number, set, body) result(beta)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: number !! number of the contact set
      character(*), intent(in) :: set !! name of its boundary set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer :: place(2, body%mesh%n_nodes), n
      real(dp), allocatable :: mass(:, :), rows(:, :), projected(:, :), gram(:, :), x(:)
      integer, parameter :: n_steps = 200
      real(dp), parameter :: settled = 1.0e-6_dp
      real(dp) :: last
      integer :: info, i

      beta = 0.0_dp
      call trace_mass(mass, place, n, set, body)
      rows = scaled_rows(zone, number, body%constraints, place, n)
      if (size(rows, 1) > n) return
      call cholesky_factor(mass, info)
      if (info /= 0) return
      projected = transpose(rows)
      call cholesky_solve(mass, projected)
      gram = matmul(rows, projected)
      call cholesky_factor(gram, info)
      if (info /= 0) return
      ! Inverse iteration from a vector that changes sign from entry to entry; the estimate comes from above.
      x = [(sin(real(i, dp)**2), i=1, size(gram, 1))]
      do i = 1, n_steps
         last = beta
         x = x/norm2(x)
         call cholesky_solve(gram, x)
         beta = 1.0_dp/sqrt(norm2(x))
         if (abs(last - beta) <= settled*beta) return
      end do
   end function inf_sup_constant

   !> The mass matrix of the free displacements on a contact line: (v, v) = |v|^2.
   pure subroutine trace_mass(mass, place, n, set, body)
      real(dp), allocatable, intent(out) :: mass(:, :) !! the matrix (n, n) [L^2]
      integer, intent(out) :: place(:, :) !! place of each displacement along e1, e2 in it, 0 for none (2, n_nodes)
      integer, intent(out) :: n !! number of free displacements on the line
      character(*), intent(in) :: set !! name of the boundary set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(side_geometry_t) :: geometry
      type(error_t), allocatable :: error
      integer, allocatable :: sides(:, :)
      real(dp) :: area, block(2, 2)
      logical :: is_free(2, body%mesh%n_nodes)
      integer :: i, j, side, point, c, b

      call body%mesh%set_sides(set, sides, error)
      is_free = .false.
      is_free(:, pack(sides(:3, :), sides(:3, :) > 0)) = .true.
      is_free = is_free .and. body%constraints%is_free(:2, :)
      n = count(is_free)
      place = unpack([(i, i=1, n)], is_free, 0)
      allocate (mass(n, n), source=0.0_dp)
      do side = 1, size(sides, 2)
         call new_side_geometry(geometry, sides(:3, side), body%mesh%coordinates)
         do point = 1, size(geometry%along, 2)
            area = norm2(geometry%along(:, point)) &
               *body%materials%list(body%materials%of_element(sides(4, side)))%depth(geometry%position(1, point))
            do j = 1, count(sides(:3, side) > 0)
               do i = 1, count(sides(:3, side) > 0)
                  associate (of_row => body%constraints%frame(sides(i, side)), &
                     of_column => body%constraints%frame(sides(j, side)))
                     block = area*geometry%values(i, point)*geometry%values(j, point) &
                        *matmul(transpose(of_row(:2, :2)), of_column(:2, :2))
                  end associate
                  do b = 1, 2
                     do c = 1, 2
                        associate (row => place(c, sides(i, side)), column => place(b, sides(j, side)))
                           if (min(row, column) > 0) mass(row, column) = mass(row, column) + block(c, b)
                        end associate
                     end do
                  end do
               end do
            end do
         end do
      end do
   end subroutine trace_mass

   !> The rows of C of a contact set, each for a multiplier of norm 1; those of constrained tangents are left out.
   pure function scaled_rows(zone, number, constraints, place, n) result(rows)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: number !! number of the contact set
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: place(:, :) !! place of each displacement among the columns, 0 for none (2, n_nodes)
      integer, intent(in) :: n !! number of columns
      real(dp), allocatable :: rows(:, :)
      real(dp) :: all_rows(2*zone%n_points, n)
      logical :: is_active(2*zone%n_points)
      integer :: p, i, a, k, row

      all_rows = 0.0_dp
      is_active = [zone%set == number, zone%set == number .and. .not. zone%is_tangent_fixed]
      do p = 1, zone%n_points
         if (zone%set(p) /= number) cycle
         do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
            associate (frame => constraints%frame(zone%rows%node(i)), axes => zone%rows%axes(i, 1 + zone%n_tangents))
               do k = 1, 2
                  row = p + (k - 1)*zone%n_points
                  do a = 1, 2
                     associate (column => place(a, zone%rows%node(i)))
                        if (column > 0) all_rows(row, column) = all_rows(row, column) &
                           + sqrt(zone%area(p))*dot_product(axes(:, k), frame(:, a))
                     end associate
                  end do
               end do
            end associate
         end do
      end do
      rows = all_rows(pack([(i, i=1, size(is_active))], is_active), :)
   end function scaled_rows

end module amontons_inf_sup
