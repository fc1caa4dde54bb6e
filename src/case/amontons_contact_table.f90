!> NAME.contact.csv: one row per contact point, in the order of the contact line, 17 significant digits.
module amontons_contact_table
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_body, only: body_t
   use amontons_contact_rows, only: contact_rows_t
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_friction_law, only: status_names
   use amontons_kinds, only: dp
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_result, only: result_t
   use amontons_text, only: to_text, to_text_17
   implicit none (type, external)
   private

   public :: contact_point_t, new_contact_point, write_contact_table

   !> What is known of one contact point, a node or a cell of constant multipliers.
   type :: contact_point_t
      real(dp) :: position(2) = 0.0_dp !! coordinates of the node or of the centre of the cell [L]
      real(dp) :: normal(2) = 0.0_dp !! unit outward normal of the body [-]
      real(dp) :: weight = 0.0_dp !! tributary length, or length of the cell [L]
      real(dp) :: gap = 0.0_dp !! distance to the obstacle, d - u_N [L]
      real(dp) :: slip = 0.0_dp !! tangential displacement u_T [L]
      real(dp) :: normal_force = 0.0_dp !! lambda_N, compression positive [F]
      real(dp) :: tangential_force = 0.0_dp !! lambda_T, along the slip [F]
      real(dp) :: normal_stress = 0.0_dp !! normal force over tributary area, compression positive [F/L^2]
      real(dp) :: tangential_stress = 0.0_dp !! tangential force over tributary area [F/L^2]
      character(:), allocatable :: status !! 'open', 'stick', 'slip+' or 'slip-'
   end type contact_point_t

contains

   !> Gathers what is known of a contact point.
   pure subroutine new_contact_point(point, body, result, p)
      type(contact_point_t), intent(out) :: point !! the point
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      integer, intent(in) :: p !! number of the point
      type(contact_rows_t) :: row
      real(dp) :: displacement(2)
      integer :: m

      m = body%zone%n_points
      point%position = body%zone%position(:, p)
      point%normal = body%zone%normal(:, p)
      point%weight = body%zone%weight(p)
      point%gap = body%problem%gap(p) - result%solution%displacement(p)
      point%slip = result%solution%displacement(m + p)
      if (body%zone%is_guided(p)) then
         row = body%zone%rows%picked([p])
         displacement = row%displacement(result%displacement)
         point%slip = displacement(2)
      end if
      point%normal_force = result%solution%force(p)
      point%tangential_force = result%solution%force(m + p)
      point%normal_stress = point%normal_force/body%zone%area(p)
      point%tangential_stress = point%tangential_force/body%zone%area(p)
      point%status = trim(status_names(result%solution%status(p)))
   end subroutine new_contact_point

   !> Writes the table under its temporary name.
   subroutine write_contact_table(file, path, body, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written, or a number is not finite
      type(contact_point_t) :: point
      character(:), allocatable :: row
      real(dp), allocatable :: numbers(:)
      integer :: p, i, status
      logical :: is_finite

      is_finite = .true.
      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status) 'point,x,y,normal_x,normal_y,weight,gap,slip,normal_force,'// &
         'tangential_force,normal_stress,tangential_stress,status'
      do p = 1, body%zone%n_points
         call new_contact_point(point, body, result, p)
         numbers = [point%position, point%normal, point%weight, point%gap, point%slip, point%normal_force, &
            point%tangential_force, point%normal_stress, point%tangential_stress]
         is_finite = is_finite .and. all(ieee_is_finite(numbers))
         row = to_text(p)
         do i = 1, size(numbers)
            row = row//','//to_text_17(numbers(i))
         end do
         if (status == 0) write (file%unit, '(a)', iostat=status) row//','//point%status
      end do
      call file%finish(status, error)
      if (.not. (is_finite .or. allocated(error))) call new_error(error, numerical_failure, &
         'stresses on the contact line leave the range of double precision (1.8e308): choose other units')
   end subroutine write_contact_table

end module amontons_contact_table
