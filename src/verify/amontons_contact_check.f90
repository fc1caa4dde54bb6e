!> The rows of NAME.contact.csv, read back and held against the body, its displacements and the contact law.
module amontons_contact_check
   use amontons_agreement, only: agree, contradiction, fault_text_t
   use amontons_body, only: body_t
   use amontons_contact_table, only: contact_header
   use amontons_csv_table, only: csv_table_t, read_csv_table
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, status_names, stick_point
   use amontons_kinds, only: dp
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: check_contact_rows, check_statuses, contact_table_t, law_scales_t, new_law_scales, read_contact_rows, &
      read_point_rows

   !> Columns of numbers between the number of the point and its status.
   integer, parameter :: n_numbers = 11
   integer, parameter :: at_gap = 6, at_slip = 7, at_normal_force = 8, at_tangential_force = 9
   character(17), parameter :: column_names(n_numbers) = [character(17) :: 'x', 'y', 'normal_x', 'normal_y', &
      'weight', 'gap', 'slip', 'normal_force', 'tangential_force', 'contact_pressure', 'contact_shear']

   !> What the table states.
   type :: contact_table_t
      real(dp), allocatable :: gap(:) !! distance to the obstacle (m) [L]
      real(dp), allocatable :: slip(:) !! tangential displacement (m) [L]
      real(dp), allocatable :: force(:) !! normal forces, then tangential ones (2m) [F]
      integer, allocatable :: status(:) !! statuses (m)
      real(dp), allocatable, private :: numbers(:, :) !! all numbers (n_numbers, m)
   end type contact_table_t

   !> What is small beside the displacements and the forces of a case.
   type :: law_scales_t
      real(dp) :: length = 0.0_dp !! displacements up to this count as none [L]
      real(dp) :: force = 0.0_dp !! forces up to this count as none [F]
   end type law_scales_t

contains

   !> What is small beside the displacements and the forces of a case.
   pure function new_law_scales(limit, displacement, force_scale) result(scales)
      real(dp), intent(in) :: limit !! the share that counts as none [-]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: force_scale !! what the certificate measures contact forces by [F]
      type(law_scales_t) :: scales

      scales%length = limit*maxval(abs(displacement))
      scales%force = limit*force_scale
   end function new_law_scales

   !> Reads NAME.contact.csv of a body.
   subroutine read_contact_rows(table, path, n_points, fault)
      type(contact_table_t), intent(out) :: table !! what it states
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: n_points !! number of contact points
      character(:), allocatable, intent(out) :: fault !! why it cannot be read; empty if it can

      allocate (table%numbers(n_numbers, n_points), table%status(n_points))
      call read_point_rows(path, contact_header, table%numbers, table%status, fault)
      if (len(fault) > 0) return
      table%gap = table%numbers(at_gap, :)
      table%slip = table%numbers(at_slip, :)
      table%force = [table%numbers(at_normal_force, :), table%numbers(at_tangential_force, :)]
   end subroutine read_contact_rows

   !> Reads a table with a row for each contact point: its number, columns of numbers, its status.
   subroutine read_point_rows(path, header, numbers, status, fault)
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: header !! its first line
      real(dp), intent(out) :: numbers(:, :) !! the numbers (columns, m)
      integer, intent(out) :: status(:) !! the statuses (m)
      character(:), allocatable, intent(out) :: fault !! why it cannot be read; empty if it can
      type(csv_table_t) :: rows
      integer :: p, i, n

      n = size(numbers, 1)
      call read_csv_table(rows, path, header, n + 2, fault)
      if (len(fault) == 0 .and. rows%n_rows /= size(status)) fault = to_text(rows%n_rows)//' rows, but there are '// &
         to_text(size(status))//' contact points'
      if (len(fault) > 0) return
      do p = 1, size(status)
         if (rows%field(p, 1) /= to_text(p)) fault = 'line '//to_text(p + 1)//': expected point '//to_text(p)// &
            ", found '"//rows%field(p, 1)//"'"
         do i = 1, n
            call rows%get_number(p, i + 1, numbers(i, p), fault)
         end do
         call read_status(rows, p, n + 2, status(p), fault)
         if (len(fault) > 0) return
      end do
   end subroutine read_point_rows

   !> Reads a status.
   pure subroutine read_status(rows, row, column, status, fault)
      type(csv_table_t), intent(in) :: rows !! the table
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      integer, intent(out) :: status !! the status, 0 if there is none
      character(:), allocatable, intent(inout) :: fault !! gains why there is none, unless it tells a fault already
      integer :: i

      status = 0
      do i = 1, size(status_names)
         if (rows%field(row, column) == trim(status_names(i))) status = i
      end do
      if (status == 0 .and. len(fault) == 0) fault = 'line '//to_text(row + 1)//": expected a status, found '"// &
         rows%field(row, column)//"'"
   end subroutine read_status

   !> Compares the rows with the contact points, the displacements of the body, and each other.
   subroutine check_contact_rows(faults, path, table, body, gap, displacement)
      type(fault_text_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: path !! name of the file
      type(contact_table_t), intent(in) :: table !! what it states
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: gap(:) !! initial gap of every point (m) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (2, n_nodes) [L]
      real(dp) :: computed(n_numbers, body%zone%n_points), scale(n_numbers)
      real(dp) :: at_points(2*body%zone%n_points)
      integer :: p, i, m

      associate (zone => body%zone)
         m = zone%n_points
         if (m == 0) return
         at_points = zone%rows%displacement(displacement)
         computed(1:2, :) = zone%position
         computed(3:4, :) = zone%normal
         computed(5, :) = zone%weight
         computed(at_gap, :) = gap - at_points(:m)
         computed(at_slip, :) = at_points(m + 1:)
         computed(at_normal_force, :) = table%force(:m)
         computed(at_tangential_force, :) = table%force(m + 1:)
         computed(10, :) = table%force(:m)/zone%area
         computed(11, :) = table%force(m + 1:)/zone%area
      end associate
      do i = 1, n_numbers
         scale(i) = maxval(abs(computed(i, :)))
      end do
      scale(1:2) = maxval(scale(1:2))
      scale(3:4) = 1.0_dp
      ! A gap is the difference of the initial gap and a displacement.
      scale(at_gap) = max(maxval(abs(gap)), maxval(abs(displacement)))
      scale(at_slip) = maxval(abs(displacement))
      do p = 1, m
         do i = 1, n_numbers
            if (agree(table%numbers(i, p), computed(i, p), scale(i))) cycle
            call faults%add(path//':'//to_text(p + 1), contradiction(trim(column_names(i))//' of point '// &
               to_text(p), table%numbers(i, p), computed(i, p)))
         end do
      end do
   end subroutine check_contact_rows

   !> Holds the statuses of a converged case against the contact law, point by point.
   subroutine check_statuses(faults, path, has_rows, table, friction, slip_bound, is_tangent_fixed, scales)
      type(fault_text_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: path !! name of the file
      logical, intent(in) :: has_rows !! whether it has a line for each point, behind one of names
      type(contact_table_t), intent(in) :: table !! what it states; the tangential forces along the slip
      real(dp), intent(in) :: friction(:) !! Coulomb coefficients (m) [-]
      real(dp), intent(in) :: slip_bound(:) !! given bounds of the tangential force (m) [F]
      logical, intent(in) :: is_tangent_fixed(:) !! whether a support bears the shear (m)
      type(law_scales_t), intent(in) :: scales !! what counts as none
      character(:), allocatable :: place, wrong
      integer :: p

      do p = 1, size(table%status)
         wrong = status_fault(table, p, friction(p), slip_bound(p), is_tangent_fixed(p), scales)
         if (len(wrong) == 0) cycle
         place = path
         if (has_rows) place = path//':'//to_text(p + 1)
         call faults%add(place, wrong)
      end do
   end subroutine check_statuses

   !> What is wrong with the status of a point; empty if nothing is.
   pure function status_fault(table, p, friction, slip_bound, is_tangent_fixed, scales) result(fault)
      type(contact_table_t), intent(in) :: table !! what is stated of the points; the tangential forces along the slip
      integer, intent(in) :: p !! which point
      real(dp), intent(in) :: friction !! its Coulomb coefficient [-]
      real(dp), intent(in) :: slip_bound !! given bound of its tangential force [F]
      logical, intent(in) :: is_tangent_fixed !! whether a support bears its shear
      type(law_scales_t), intent(in) :: scales !! what counts as none
      character(:), allocatable :: fault
      real(dp) :: bound

      fault = normal_fault(table%status(p), table%gap(p), table%force(p), scales)
      bound = 0.0_dp
      if (.not. is_tangent_fixed) bound = slip_bound + friction*max(0.0_dp, table%force(p))
      if (len(fault) == 0) fault = tangential_fault(table%status(p), merge(0.0_dp, table%slip(p), is_tangent_fixed), &
         table%force(size(table%status) + p), bound, scales)
      if (len(fault) > 0) fault = 'point '//to_text(p)//" is '"//trim(status_names(table%status(p)))//"', but "//fault
   end function status_fault

   !> What is wrong with the gap and the normal force of a point: what is open bears none, what is closed has no gap.
   pure function normal_fault(status, gap, force, scales) result(wrong)
      integer, intent(in) :: status !! status of the point
      real(dp), intent(in) :: gap !! its gap [L]
      real(dp), intent(in) :: force !! its normal force [F]
      type(law_scales_t), intent(in) :: scales !! what counts as none
      character(:), allocatable :: wrong

      wrong = ''
      if (force < -scales%force) wrong = 'the normal force pulls'
      if (gap < -scales%length) wrong = 'it is behind the obstacle'
      if (status == open_point .and. force > scales%force) wrong = 'it bears a normal force'
      if (status /= open_point .and. gap > scales%length) wrong = 'there is a gap'
   end function normal_fault

   !> What is wrong with the slip and the tangential force of a point: what sticks does not move, what slides does so
   !> along its friction, at the bound.
   pure function tangential_fault(status, slip, force, bound, scales) result(wrong)
      integer, intent(in) :: status !! status of the point
      real(dp), intent(in) :: slip !! its slip [L]
      real(dp), intent(in) :: force !! its tangential force [F]
      real(dp), intent(in) :: bound !! what friction can bear [F]
      type(law_scales_t), intent(in) :: scales !! what counts as none
      character(:), allocatable :: wrong
      real(dp) :: direction

      wrong = ''
      if (abs(force) > bound + scales%force) wrong = 'the tangential force is above its bound'
      if (status == stick_point .and. abs(slip) > scales%length) wrong = 'it moves along the obstacle'
      if (status /= slip_plus .and. status /= slip_minus) return
      direction = merge(1.0_dp, -1.0_dp, status == slip_plus)
      if (direction*slip < -scales%length) wrong = 'it moves the other way'
      if (direction*force < bound - scales%force) wrong = 'the tangential force is not at its bound'
   end function tangential_fault

end module amontons_contact_check
