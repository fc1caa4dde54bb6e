!> NAME.contact.csv: one row per contact point, in the order of the contact line.
module amontons_contact_table
   use amontons_body, only: body_t
   use amontons_contact_rows, only: contact_rows_t
   use amontons_friction_law, only: status_names
   use amontons_kinds, only: dp
   use amontons_result, only: result_t
   use amontons_text, only: as_lines, comma_separated, newline, to_text
   implicit none (type, external)
   private

   public :: contact_header, contact_point_t, contact_table_text, new_contact_point

   !> The header of the table.
   character(*), parameter :: contact_header = 'point,x,y,normal_x,normal_y,weight,gap,slip,normal_force,'// &
      'tangential_force,contact_pressure,contact_shear,status'

   !> What a load history adds to it.
   character(*), parameter :: record_header = ',slip_step,slip_accumulated,dissipation'

   !> What is known of one contact point, a node or a cell of constant multipliers.
   type :: contact_point_t
      real(dp) :: position(2) = 0.0_dp !! coordinates of the node or of the center of the cell [L]
      real(dp) :: normal(2) = 0.0_dp !! unit outward normal of the body [-]
      real(dp) :: weight = 0.0_dp !! tributary length, or length of the cell [L]
      real(dp) :: gap = 0.0_dp !! distance to the obstacle, d - u_N [L]
      real(dp) :: slip = 0.0_dp !! tangential displacement u_T [L]
      real(dp) :: normal_force = 0.0_dp !! lambda_N, compression positive [F]
      real(dp) :: tangential_force = 0.0_dp !! lambda_T, along the slip [F]
      real(dp) :: pressure = 0.0_dp !! normal force over tributary area, compression positive [F/L^2]
      real(dp) :: shear = 0.0_dp !! tangential force over tributary area [F/L^2]
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
      point%gap = result%load_case%free_gap(p) - result%solution%displacement(p)
      point%slip = result%solution%displacement(m + p)
      if (body%zone%is_tangent_fixed(p)) then
         row = body%zone%rows%picked([p])
         displacement = row%displacement(result%displacement)
         point%slip = displacement(2)
      end if
      point%normal_force = result%solution%force(p)
      point%tangential_force = result%solution%force(m + p)
      point%pressure = point%normal_force/body%zone%area(p)
      point%shear = point%tangential_force/body%zone%area(p)
      point%status = trim(status_names(result%solution%status(p)))
   end subroutine new_contact_point

   !> The whole table.
   pure function contact_table_text(body, result) result(text)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text
      character(400) :: rows(body%zone%n_points)
      type(contact_point_t) :: point
      integer :: p

      do p = 1, body%zone%n_points
         call new_contact_point(point, body, result, p)
         rows(p) = to_text(p)//','//comma_separated([point%position, point%normal, point%weight, point%gap, &
            point%slip, point%normal_force, point%tangential_force, point%pressure, point%shear]) &
            //','//point%status
         if (allocated(result%slip_record)) rows(p) = trim(rows(p))//','//comma_separated(result%slip_record(p, :))
      end do
      text = contact_header
      if (allocated(result%slip_record)) text = text//record_header
      text = text//newline//as_lines(rows)
   end function contact_table_text

end module amontons_contact_table
