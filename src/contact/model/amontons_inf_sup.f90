!> The discrete inf-sup constant of constant multipliers shows whether the mesh can represent them:
!> beta = min over multipliers mu of max over displacements v of (mu, C v) / (|mu| |v|), both norms those of L2 on the
!> contact line: the least norm of the projection of a multiplier of norm 1 onto the traces of the body's displacements.
!> It depends on mesh, cells and supports alone and lies between 0 and 1.
module amontons_inf_sup
   use amontons_constraints, only: constraints_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_error, only: error_t
   use amontons_face, only: face_t, set_faces
   use amontons_kinds, only: dp
   use amontons_sparse_lu, only: sparse_lu_t
   use amontons_sparse_matrix, only: entries_t
   use amontons_surface, only: meshed_body_t
   implicit none (type, external)
   private

   public :: inf_sup_constant, poor_inf_sup

   !> Smallest inf-sup constant of the constant multipliers of a contact set without a warning.
   real(dp), parameter :: poor_inf_sup = 0.3_dp

contains

   !> The constant of one contact set; 0 if some multiplier does no work on any displacement [-].
   !>
   !> It is the root of the least eigenvalue of C M^-1 C^T, M the mass matrix of the displacements on the line, by
   !> inverse iteration with the sparse matrix (M, C^T; C, 0).
   real(dp) function inf_sup_constant(zone, number, set, body) result(beta)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: number !! number of the contact set
      character(*), intent(in) :: set !! name of its boundary set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      integer, parameter :: n_steps = 200
      real(dp), parameter :: settled = 1.0e-6_dp ! the constant is shown with four digits
      type(sparse_lu_t) :: saddle
      type(entries_t) :: entries
      integer :: place(2, body%mesh%n_nodes), n, r, info, i
      real(dp), allocatable :: x(:), right(:)
      real(dp) :: last

      beta = 0.0_dp
      call new_trace_mass(entries, place, n, set, body)
      call add_rows(entries, r, zone, number, body%constraints, place, n)
      if (r > n) return
      call saddle%factorize(n + r, entries, info)
      if (info /= 0) return
      ! From a vector that changes sign from entry to entry; the estimate comes from above.
      x = [(sin(real(i, dp)**2), i=1, r)]
      do i = 1, n_steps
         last = beta
         right = [spread(0.0_dp, 1, n), x/norm2(x)]
         call saddle%solve_transposed(right, info)
         if (info /= 0) return
         x = right(n + 1:)
         beta = 1.0_dp/sqrt(norm2(x))
         if (abs(last - beta) <= settled*beta) return
      end do
   end function inf_sup_constant

   !> Lists the mass matrix of the free displacements on a contact line: (v, v) = |v|^2.
   pure subroutine new_trace_mass(entries, place, n, set, body)
      type(entries_t), intent(out) :: entries !! the entries of the matrix [L^2]
      integer, intent(out) :: place(:, :) !! place of each displacement along e1, e2 in it, 0 for none (2, n_nodes)
      integer, intent(out) :: n !! number of free displacements on the line
      character(*), intent(in) :: set !! name of the boundary set
      type(meshed_body_t), intent(in) :: body !! mesh, materials and supports
      type(face_t), allocatable :: faces(:)
      type(error_t), allocatable :: error
      real(dp) :: mass, block(2, 2)
      logical :: is_free(2, body%mesh%n_nodes)
      integer :: i, j, k, point, c, b

      call set_faces(faces, body%mesh, set, error, body%materials)
      is_free = .false.
      do k = 1, size(faces)
         is_free(:, faces(k)%node(:faces(k)%n_nodes)) = .true.
      end do
      is_free = is_free .and. body%constraints%is_free(:2, :)
      n = count(is_free)
      place = unpack([(i, i=1, n)], is_free, 0)
      do k = 1, size(faces)
         do j = 1, faces(k)%n_nodes
            do i = 1, faces(k)%n_nodes
               associate (face => faces(k), of_row => body%constraints%frame(:2, :2, faces(k)%node(i)), &
                  of_column => body%constraints%frame(:2, :2, faces(k)%node(j)))
                  mass = 0.0_dp
                  do point = 1, size(face%area)
                     mass = mass + face%area(point)*face%values(i, point)*face%values(j, point)
                  end do
                  block = mass*matmul(transpose(of_row), of_column)
                  do b = 1, 2
                     do c = 1, 2
                        call entries%add(place(c, face%node(i)), place(b, face%node(j)), block(c, b))
                     end do
                  end do
               end associate
            end do
         end do
      end do
   end subroutine new_trace_mass

   !> Adds the rows of C of a contact set and their transposes, each for a multiplier of norm 1; those of constrained
   !> tangents are left out.
   pure subroutine add_rows(entries, r, zone, number, constraints, place, n)
      type(entries_t), intent(inout) :: entries !! gains the entries of C and C^T [L]
      integer, intent(out) :: r !! number of rows
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: number !! number of the contact set
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: place(:, :) !! place of each displacement among the columns, 0 for none (2, n_nodes)
      integer, intent(in) :: n !! number of columns
      integer :: p, i, a, k

      r = 0
      do k = 1, 2
         do p = 1, zone%n_points
            if (zone%set(p) /= number .or. (k == 2 .and. zone%is_fixed(1, p))) cycle
            r = r + 1
            do i = zone%rows%start(p), zone%rows%start(p + 1) - 1
               associate (frame => constraints%frame(:, :, zone%rows%node(i)), block => zone%rows%block(:, :, i))
                  do a = 1, 2
                     associate (column => place(a, zone%rows%node(i)), &
                        share => sqrt(zone%area(p))*dot_product(block(:, k), frame(:, a)))
                        call entries%add(n + r, column, share)
                        call entries%add(column, n + r, share)
                     end associate
                  end do
               end associate
            end do
         end do
      end do
   end subroutine add_rows

end module amontons_inf_sup
