!> What is known of the contact points, a column each: NAME.contact.csv writes all columns, the listing and the grids
!> those that are for them.
module amontons_contact_table
   use amontons_body, only: body_t
   use amontons_document, only: document_t
   use amontons_friction_law, only: status_names
   use amontons_kinds, only: dp
   use amontons_listing_text, only: columns, heading, right
   use amontons_result, only: result_t
   use amontons_text, only: as_lines, comma_separated, newline, to_text
   use amontons_units, only: unit_of
   implicit none (type, external)
   private

   public :: add_point_table, column_t, contact_columns, points_text, table_header, table_text

   !> A number of every contact point, a node or a cell of constant multipliers.
   type :: column_t
      character(16) :: key = '' !! its name in files
      character(12) :: label = '' !! its heading in the listing; blank for what this leaves out
      character(9) :: dimension = '' !! what it is measured in, as `unit_of` takes it
      logical :: is_field = .false. !! whether the grids show it
      real(dp) :: scale = 0.0_dp !! what rounding errors of it are measured by, if larger than the numbers themselves
      real(dp), allocatable :: values(:) !! the numbers (m)
   end type column_t

contains

   !> Gathers the columns, in the order of the table.
   subroutine contact_columns(list, body, result)
      type(column_t), allocatable, intent(out) :: list(:) !! the columns
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      real(dp) :: at_points(2*body%zone%n_points), length
      integer, parameter :: most_columns = 20
      real(dp), parameter :: no_scale = 0.0_dp
      integer :: m, n

      n = 0
      allocate (list(most_columns))
      associate (zone => body%zone, load_case => result%load_case, force => result%solution%force)
         m = zone%n_points
         at_points = zone%rows%displacement(result%displacement)
         where (.not. zone%is_tangent_fixed) at_points(m + 1:) = result%solution%displacement(m + 1:)
         ! A gap is the difference of a gap and a displacement, a slip that of displacements.
         length = max(maxval(abs(result%displacement)), maxval(abs(load_case%gap)))
         call add('x', 'x', 'L', zone%position(1, :), maxval(abs(zone%position)))
         call add('y', 'y', 'L', zone%position(2, :), maxval(abs(zone%position)))
         call add('normal_x', '', '', zone%normal(1, :), 1.0_dp)
         call add('normal_y', '', '', zone%normal(2, :), 1.0_dp)
         call add('weight', '', 'L', zone%weight, no_scale)
         call add('gap', 'gap', 'L', load_case%free_gap - result%solution%displacement(:m), length, .true.)
         call add('slip', 'slip', 'L', at_points(m + 1:), length, .true.)
         call add('normal_force', 'normal force', 'F', force(:m), no_scale)
         call add('tangential_force', 'tang. force', 'F', force(m + 1:), no_scale)
         call add('contact_pressure', 'pressure', 'F/L^2', force(:m)/zone%area, no_scale, .true.)
         call add('contact_shear', 'shear', 'F/L^2', force(m + 1:)/zone%area, no_scale, .true.)
         call add('shear_bound', '', 'F/L^2', shear_bound(force(:m)/zone%area, load_case%friction, &
            load_case%slip_bound, zone%area), no_scale, .true.)
      end associate
      if (allocated(result%slip_record)) then
         call add('slip_step', '', 'L', result%slip_record(:, 1), length, .true.)
         call add('slip_accumulated', '', 'L', result%slip_record(:, 2), length, .true.)
         call add('dissipation', '', 'F L', result%slip_record(:, 3), no_scale, .true.)
      end if
      list = list(:n)

   contains

      !> Appends a column.
      subroutine add(key, label, dimension, values, scale, is_field)
         character(*), intent(in) :: key !! its name in files
         character(*), intent(in) :: label !! its heading in the listing
         character(*), intent(in) :: dimension !! what it is measured in
         real(dp), intent(in) :: values(:) !! its numbers (m)
         real(dp), intent(in) :: scale !! what rounding errors of it are measured by besides the numbers
         logical, intent(in), optional :: is_field !! whether the grids show it; default no

         n = n + 1
         list(n)%key = key
         list(n)%label = label
         list(n)%dimension = dimension
         if (present(is_field)) list(n)%is_field = is_field
         list(n)%scale = scale
         if (size(values) > 0) list(n)%scale = max(scale, maxval(abs(values)))
         list(n)%values = values
      end subroutine add

   end subroutine contact_columns

   !> The shear stress that friction can bear [F/L^2].
   elemental real(dp) function shear_bound(pressure, friction, slip_bound, area) result(bound)
      real(dp), intent(in) :: pressure !! contact pressure [F/L^2]
      real(dp), intent(in) :: friction !! Coulomb coefficient [-]
      real(dp), intent(in) :: slip_bound !! given bound of the tangential force [F]
      real(dp), intent(in) :: area !! tributary area [L^2]

      bound = friction*max(0.0_dp, pressure)
      if (area > 0.0_dp) bound = bound + slip_bound/area
   end function shear_bound

   !> The first line of a table of points.
   pure function table_header(list) result(text)
      type(column_t), intent(in) :: list(:) !! its columns of numbers
      character(:), allocatable :: text
      integer :: i

      text = 'point'
      do i = 1, size(list)
         text = text//','//trim(list(i)%key)
      end do
      text = text//',status'
   end function table_header

   !> A table of points: number of the point, columns of numbers, status.
   pure function table_text(list, status) result(text)
      type(column_t), intent(in) :: list(:) !! the columns of numbers
      integer, intent(in) :: status(:) !! the statuses (m)
      character(:), allocatable :: text
      character(26*(size(list) + 1)), allocatable :: rows(:)
      integer :: p, i

      allocate (rows(size(status)))
      do p = 1, size(status)
         rows(p) = to_text(p)//','//comma_separated([(list(i)%values(p), i=1, size(list))])//','// &
            status_names(status(p))
      end do
      text = table_header(list)//newline//as_lines(rows)
   end function table_text

   !> Makes NAME.contact.csv of a table of points.
   pure subroutine add_point_table(document, list, status)
      type(document_t), intent(inout) :: document !! gains the table
      type(column_t), intent(in) :: list(:) !! the columns of numbers
      integer, intent(in) :: status(:) !! the statuses (m)

      document%ending = '.contact.csv'
      call document%add(table_text(list, status), [0.0_dp, list%scale, 0.0_dp])
   end subroutine add_point_table

   !> The table of points in a listing; a line below its headings has the units, where the case names them.
   pure function points_text(title, list, status, units) result(text)
      character(*), intent(in) :: title !! its heading
      type(column_t), intent(in) :: list(:) !! the columns of numbers
      integer, intent(in) :: status(:) !! the statuses (m)
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: width = 13
      character(20 + 2*width*size(list)), allocatable :: rows(:)
      integer, allocatable :: shown(:)
      integer :: p, i, first

      first = merge(-1, 0, len_trim(units) > 0)
      allocate (rows(first:size(status)))
      shown = pack([(i, i=1, size(list))], list%label /= '')
      rows(0) = ''
      rows(first) = right('point', 7)
      do i = 1, size(shown)
         rows(first) = trim(rows(first))//right(trim(list(shown(i))%label), width)
         if (first < 0) rows(0)(8 + width*(i - 1):) = right(unit_of(units, trim(list(shown(i))%dimension)), width)
      end do
      rows(first) = trim(rows(first))//'  status'
      do p = 1, size(status)
         rows(p) = right(to_text(p), 7)//columns([(list(shown(i))%values(p), i=1, size(shown))])//'  '// &
            status_names(status(p))
      end do
      text = heading(title)//as_lines(rows)
   end function points_text

end module amontons_contact_table
