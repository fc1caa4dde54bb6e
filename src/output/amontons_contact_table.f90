!> Columns of the table of contact points: NAME.contact.csv has all columns, listing and grids the ones selected for
!> them. Also, for the grid of the contact line, the lines of the masters of contact pairs; and the contributions of
!> either side to the displacements of the contact points.
module amontons_contact_table
   use amontons_body, only: body_t
   use amontons_contact_rows, only: contact_rows_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_document, only: document_t
   use amontons_friction_law, only: status_names, tangential_norm
   use amontons_kinds, only: dp
   use amontons_result, only: result_t
   use amontons_text, only: as_lines, columns, comma_separated, flush_right, heading, n_characters, replaced, to_text, &
      unit_of
   implicit none (type, external)
   private

   public :: add_point_table, at_nodes, column_t, contact_columns, master_line_t, new_master_line, pair_names, &
      points_text, side_rows

   !> The lines of all masters, one after the other; a node of two masters occurs in both.
   type :: master_line_t
      integer :: n_nodes = 0 !! number of nodes
      integer, allocatable :: node(:) !! the nodes (n_nodes)
      integer, allocatable :: set(:) !! the contact set that each belongs to (n_nodes)
      real(dp), allocatable :: normal(:, :) !! unit outward normals of the masters there (n_dim, n_nodes) [-]
      integer, allocatable :: segment(:, :) !! places in `node` of the ends of each line segment (2, segments)
   contains
      procedure :: forces => master_line_forces
   end type master_line_t

   !> A column: a number of every contact point, which is a node or a cell of constant multipliers.
   type :: column_t
      character(32) :: key = '' !! its name in files
      character(12) :: label = '' !! its heading in the listing; blank for what this leaves out
      character(9) :: dimension = '' !! its dimension, as `unit_of` takes it
      logical :: is_field = .false. !! whether the grids show it
      real(dp) :: scale = 0.0_dp !! scale of its rounding errors, if larger than the numbers themselves
      real(dp), allocatable :: values(:) !! the numbers (m)
   end type column_t

   !> Names of the columns that a load history adds.
   character(32), parameter :: slip_keys(*) = [character(32) :: 'slip_step', 'slip_accumulated', 'dissipation', &
      'wear_integral', 'wear_depth', 'surface_stress', 'ruiz_1', 'ruiz_2', 'swt', 'swt_angle']
   !> Dimensions of the columns that a load history adds.
   character(7), parameter :: slip_dimensions(size(slip_keys)) = [character(7) :: 'L', 'L', 'F L', 'F/L', 'L', &
      'F/L^2', 'F/L', 'F^2/L^3', 'F/L^2', 'rad']

contains

   !> Whether any contact set meets another deformable body.
   pure logical function has_pairs(zone)
      type(contact_zone_t), intent(in) :: zone !! the contact points

      has_pairs = any(zone%pairs%master%n_sides > 0)
   end function has_pairs

   !> Finds the lines of the masters; a side with a node in its middle is two segments.
   pure subroutine new_master_line(line, zone)
      type(master_line_t), intent(out) :: line !! the lines
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, allocatable :: place(:), ends(:)
      integer :: set, side, i, n, n_segments

      n = sum(zone%pairs%master%n_sides)
      allocate (line%node(3*n), line%set(3*n), line%segment(2, 2*n), line%normal(2, 3*n))
      n_segments = 0
      do set = 1, size(zone%pairs)
         associate (master => zone%pairs(set)%master)
            if (master%n_sides > 0) place = spread(0, 1, maxval(master%side(:3, :)))
            do side = 1, master%n_sides
               ends = pack([1, 3, 2], master%side([1, 3, 2], side) > 0)
               do i = 1, size(ends)
                  associate (node => master%side(ends(i), side))
                     if (place(node) == 0) then
                        line%n_nodes = line%n_nodes + 1
                        place(node) = line%n_nodes
                        line%node(line%n_nodes) = node
                        line%set(line%n_nodes) = set
                        line%normal(:, line%n_nodes) = master%normal(:, ends(i), side)
                     end if
                  end associate
                  if (i == 1) cycle
                  n_segments = n_segments + 1
                  line%segment(:, n_segments) = place(master%side(ends(i - 1:i), side))
               end do
            end do
         end associate
      end do
      line%node = line%node(:line%n_nodes)
      line%set = line%set(:line%n_nodes)
      line%normal = line%normal(:, :line%n_nodes)
      line%segment = line%segment(:, :n_segments)
   end subroutine new_master_line

   !> The forces of the contact points on the nodes of the masters (components, n_nodes) [F].
   pure function master_line_forces(self, zone, force, n_nodes) result(forces)
      class(master_line_t), intent(in) :: self !! the lines
      type(contact_zone_t), intent(in) :: zone !! the contact points
      real(dp), intent(in) :: force(:) !! (lambda_N; lambda_T) (n_rows) [F]
      integer, intent(in) :: n_nodes !! number of nodes of the mesh
      real(dp) :: forces(1 + zone%n_tangents, self%n_nodes)
      type(contact_rows_t) :: rows
      real(dp), allocatable :: on_nodes(:, :)
      integer :: set, k

      rows = side_rows(zone, .true.)
      do set = 1, size(zone%pairs)
         if (.not. any(self%set == set)) cycle
         on_nodes = rows%forces(merge(force, 0.0_dp, [(zone%set == set, k=0, zone%n_tangents)]), n_nodes)
         do k = 1, self%n_nodes
            if (self%set(k) == set) forces(:, k) = on_nodes(:, self%node(k))
         end do
      end do
   end function master_line_forces

   !> The rows of the contact points with nothing on the nodes of their masters, or on these alone. With a rigid
   !> obstacle all nodes belong to the slave.
   pure function side_rows(zone, of_master) result(rows)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      logical, intent(in) :: of_master !! whether the nodes of the masters are wanted
      type(contact_rows_t) :: rows
      logical :: is_master(0:maxval([0, zone%rows%node]))
      integer :: p, i, set

      rows = zone%rows
      set = 0
      do p = 1, zone%n_points
         associate (master => zone%pairs(zone%set(p))%master)
            if (zone%set(p) /= set) then
               set = zone%set(p)
               is_master = .false.
               do i = 1, master%n_sides
                  ! Nodes that no row has are counted as node 0.
                  associate (nodes => master%side(:size(master%side, 1) - 1, i))
                     is_master(merge(nodes, 0, nodes <= ubound(is_master, 1))) = .true.
                  end associate
               end do
            end if
         end associate
         do i = rows%start(p), rows%start(p + 1) - 1
            if (is_master(rows%node(i)) .neqv. of_master) rows%block(:, :, i) = 0.0_dp
         end do
      end do
   end function side_rows

   !=contact.csv `point` | | number of the point, from 1
   !=contact.csv `x`, `y` | L | coordinates of the node, or of the center of the cell
   !=contact.csv `normal_x`, `normal_y` | – | unit outward normal $n$ of the body
   !=contact.csv `weight` | L | tributary length, or length of the cell
   !=contact.csv `gap` | L | distance left to the obstacle along the normal, $d - u_N$; 0 when closed
   !=contact.csv `slip` | L | tangential displacement $u_T$ since rest; where a load history moves the obstacle, less
   !=   its displacement there
   !=contact.csv `normal_force` | F | $\lambda_N$, compression positive
   !=contact.csv `tangential_force` | F | $\lambda_T$, with the sign of the slip; 0 where a support bears it
   !=contact.csv `contact_pressure` | F/L² | normal force over tributary area, or over the area of the cell; of a pair
   !=   with `sliding = 'finite'` that on the node, which is smoother than the multiplier
   !=contact.csv `contact_shear` | F/L² | tangential force over the same area
   !=contact.csv `slip_theta`, `tangential_force_theta`, `contact_shear_theta` | L, F, F/L² | of a twisted body: the
   !=   same around the axis
   !=contact.csv `shear_bound` | F/L² | what friction can bear: friction times pressure, plus the given slip bound over
   !=   the area
   !=contact.csv `master_x`, `master_y` | L | with a pair: mean place on the master that the point faces; with a rigid
   !=   obstacle the mean of the point's nodes
   !=contact.csv `pair` | | with a pair: `SLAVE/MASTER`, the two sets, with a semicolon for each comma; with a rigid
   !=   obstacle the set
   !=contact.csv `place_x`, `place_y`, `turn` | L, L, rad | with `sliding = 'finite'`: where the node is at the end, and
   !=   the angle by which the normal has turned since rest; normals, weights, areas and places on the master are
   !=   those at the end, too
   !=contact.csv `z`, `normal_z`, `area`, `master_z` | L, –, L², L | of a solid; `area` for `weight`: tributary area
   !=contact.csv `slip_x`, `slip_y`, `slip_z` | L | of a solid: the slip as a vector; `slip` is its length
   !=contact.csv `force_x`, `force_y`, `force_z` | F | of a solid: force of the obstacle on the body;
   !=   `tangential_force` and `contact_shear` are magnitudes
   !=contact.csv `status` | | `open`, `stick`, `slip+` or `slip-`; `slip` of a twisted body or a solid
   !> Makes the columns, in the order of the table.
   subroutine contact_columns(list, body, result)
      type(column_t), allocatable, intent(out) :: list(:) !! the columns
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      real(dp), parameter :: known_share = 1.0e-2_dp ! 1e-10 over 1e-8, see below
      real(dp) :: at_points(body%zone%n_rows), motion(body%zone%n_rows - body%zone%n_points), length, &
         slip_scales(size(slip_keys))
      character, parameter :: axes(3) = ['x', 'y', 'z']
      real(dp), dimension(body%zone%n_points) :: slip, shear
      real(dp), allocatable :: nodal(:)
      integer :: i, n
      logical :: in_space

      allocate (list(0))
      associate (zone => body%zone, load_case => result%load_case, force => result%solution%force, &
         m => body%zone%n_points)
         at_points = zone%rows%displacement(result%displacement)
         where (.not. [transpose(zone%is_fixed)]) at_points(m + 1:) = result%solution%displacement(m + 1:)
         motion = at_points(m + 1:) - load_case%obstacle_motion
         ! A gap is the difference of a gap, itself one of coordinates, and a displacement, a slip that of
         ! displacements.
         length = max(maxval(abs(result%displacement)), maxval(abs(load_case%gap)), &
            1.0e-6_dp*maxval(abs(zone%position)))
         n = size(zone%position, 1)
         in_space = n == 3
         nodal = zone%nodal_forces(force)
         slip = of_tangents(motion)
         shear = of_tangents(force(m + 1:))
         do i = 1, n
            call add(axes(i), axes(i), 'L', zone%position(i, :), maxval(abs(zone%position)))
         end do
         do i = 1, n
            call add('normal_'//axes(i), '', '', zone%frame(i, 1, :), 1.0_dp)
         end do
         if (in_space) call add('area', '', 'L^2', zone%area, 0.0_dp)
         if (.not. in_space) call add('weight', '', 'L', zone%weight, 0.0_dp)
         call add('gap', 'gap', 'L', load_case%free_gap - result%solution%displacement(:m), length, .true.)
         call add('slip', 'slip', 'L', slip, max(length, maxval(abs(load_case%obstacle_motion))), .true.)
         call add('normal_force', 'normal force', 'F', force(:m), 0.0_dp)
         ! In space shear is a part of vectors, and has their rounding errors.
         call add('tangential_force', 'tang. force', 'F', shear, merge(maxval(abs(force)), 0.0_dp, in_space))
         call add('contact_pressure', 'pressure', 'F/L^2', nodal(:m)/zone%area, 0.0_dp, .true.)
         shear = of_tangents(nodal(m + 1:))
         call add('contact_shear', 'shear', 'F/L^2', shear/zone%area, merge(maxval(abs(nodal(:m)/zone%area)), &
            0.0_dp, in_space), .true.)
         if (in_space) then
            at_points = reshape(zone%global_vectors([0.0_dp*slip, motion]), shape(at_points))
            do i = 1, n
               call add('slip_'//axes(i), '', 'L', at_points(i::n), length)
            end do
            at_points = -reshape(zone%global_vectors(force), shape(at_points))
            do i = 1, n
               call add('force_'//axes(i), 'force '//axes(i), 'F', at_points(i::n), maxval(abs(force)))
            end do
         else if (body%materials%is_twisted()) then
            call add('slip_theta', 'slip theta', 'L', motion(m + 1:), length, .true.)
            call add('tangential_force_theta', 'force theta', 'F', force(2*m + 1:), 0.0_dp)
            call add('contact_shear_theta', 'shear theta', 'F/L^2', force(2*m + 1:)/zone%area, 0.0_dp, .true.)
         end if
         ! The shear stress that friction can bear.
         call add('shear_bound', '', 'F/L^2', (load_case%slip_bound + load_case%friction*max(0.0_dp, force(:m))) &
            /zone%area, 0.0_dp, .true.)
         if (has_pairs(zone)) call add('master_x', '', 'L', zone%foot(1, :), maxval(abs(zone%position)))
         if (has_pairs(zone)) call add('master_y', '', 'L', zone%foot(2, :), maxval(abs(zone%position)))
         if (has_pairs(zone) .and. in_space) call add('master_z', '', 'L', zone%foot(3, :), maxval(abs(zone%position)))
         if (body%slides_far) call add_places()
         ! Works and integrals of a load history have rounding errors of forces, which are known to about 1e-10 of the
         ! largest one, where numbers agree to 1e-8 of their scale.
         associate (pressure => maxval(abs(force(:m)/zone%area)))
            slip_scales = [length, length, known_share*length*[maxval(abs(force)), pressure, &
               maxval([0.0_dp, load_case%contacts%wear])*pressure], spread(0.0_dp, 1, size(slip_keys) - 5)]
         end associate
      end associate
      if (.not. allocated(result%slip_record)) return
      do i = 1, size(result%slip_record, 2)
         call add(trim(slip_keys(i)), '', trim(slip_dimensions(i)), result%slip_record(:, i), slip_scales(i), .true.)
      end do

   contains

      !> What a table has of tangential vectors: the component along the first tangent, in space the length (m).
      pure function of_tangents(vectors) result(values)
         real(dp), intent(in) :: vectors(:) !! the components (n_rows - m)
         real(dp) :: values(body%zone%n_points)

         values = vectors(:size(values))
         if (in_space) values = tangential_norm(vectors, size(values))
      end function of_tangents

      !> Adds where the points are at the end, and by which angle their normals have turned.
      subroutine add_places()
         real(dp) :: place(size(body%zone%position, 1), body%zone%n_points)
         integer :: p

         associate (zone => body%zone)
            place = zone%position + result%displacement(:n, zone%rows%node(zone%rows%start(:zone%n_points)))
            do i = 1, n
               call add('place_'//axes(i), 'place '//axes(i), 'L', place(i, :), maxval(abs(zone%position)) + length)
            end do
            call add('turn', 'turn', '', [(angle_between(body%zone_at_rest%normal(p), zone%normal(p)), &
               p=1, zone%n_points)], 1.0_dp, .true.)
         end associate
      end subroutine add_places

      !> The angle between two unit vectors [rad].
      pure real(dp) function angle_between(a, b) result(angle)
         real(dp), intent(in) :: a(:) !! the first (n_dim) [-]
         real(dp), intent(in) :: b(:) !! the second (n_dim) [-]

         angle = 2.0_dp*asin(min(1.0_dp, 0.5_dp*norm2(a - b)))
      end function angle_between

      !> Adds a column to the table.
      subroutine add(key, label, dimension, values, scale, is_field)
         character(*), intent(in) :: key !! its name in files
         character(*), intent(in) :: label !! its heading in the listing
         character(*), intent(in) :: dimension !! its dimension, as `unit_of` takes it
         real(dp), intent(in) :: values(:) !! its numbers (m)
         real(dp), intent(in) :: scale !! scale of its rounding errors, if larger than the numbers
         logical, intent(in), optional :: is_field !! whether the grids show it; default no
         type(column_t) :: column

         column = column_t(key, label, dimension, scale=max(scale, maxval(abs(values))))
         column%values = values
         if (present(is_field)) column%is_field = is_field
         list = [list, column]
      end subroutine add

   end subroutine contact_columns

   !> A quantity of the contact points at nodes: the mean over the points that a node contributes to, weighted by their
   !> shares in it, extended over the faces of corners that are points; 0 at other nodes (nodes).
   pure function at_nodes(body, values, nodes) result(means)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: values(:) !! the quantity (m)
      integer, intent(in) :: nodes(:) !! the nodes
      real(dp), allocatable :: means(:), extended(:, :)
      real(dp) :: share, total(body%mesh%n_nodes)
      integer :: p, i, k

      allocate (means(body%mesh%n_nodes), source=0.0_dp)
      total = 0.0_dp
      associate (rows => body%zone%rows)
         do p = 1, body%zone%n_points
            do k = rows%start(p), body%zone%last_own_part(p)
               share = norm2(rows%block(:, 1, k))*body%zone%area(p)
               if (.not. share > 0.0_dp) cycle
               associate (node => rows%node(k))
                  total(node) = total(node) + share
                  means(node) = means(node) + share/total(node)*(values(p) - means(node))
               end associate
            end do
         end do
      end associate
      extended = reshape(means, [1, size(means)])
      do i = 1, merge(0, size(body%zone%pairs), allocated(body%zone%line))
         call body%zone%pairs(i)%extend(extended)
      end do
      means = merge(means(nodes), extended(1, nodes), total(nodes) > 0.0_dp)
   end function at_nodes

   !> Names of the pairs of the contact points, SLAVE/MASTER, or SET with a rigid obstacle; empty if all obstacles are
   !> rigid. Commas are replaced by semicolons, since a comma would end the field.
   pure function pair_names(zone, contacts) result(names)
      type(contact_zone_t), intent(in) :: zone !! the contact points
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      character(:), allocatable :: names(:)
      integer :: i, width

      width = maxval([0, (len(contacts(i)%pairing%label(contacts(i)%set)), i=1, size(contacts))])
      allocate (character(width) :: names(merge(zone%n_points, 0, has_pairs(zone))))
      do i = 1, size(names)
         names(i) = replaced(contacts(zone%set(i))%pairing%label(contacts(zone%set(i))%set), ',', ';')
      end do
   end function pair_names

   !> Makes NAME.contact.csv of a table of points.
   pure subroutine add_point_table(document, list, status, names)
      type(document_t), intent(inout) :: document !! gains the table
      type(column_t), intent(in) :: list(:) !! the columns of numbers
      integer, intent(in) :: status(:) !! the statuses (m)
      character(*), intent(in) :: names(:) !! the pairs of the points; none where there are no pairs (m, or 0)
      character(:), allocatable :: text, rows(:)
      integer :: p, i

      document%ending = '.contact.csv'
      ! A table of points: number of the point, columns of numbers, pair, status.
      allocate (character(26*(size(list) + 1) + len(names)) :: rows(0:size(status)))
      text = 'point'
      do i = 1, size(list)
         text = text//','//trim(list(i)%key)
      end do
      if (size(names) > 0) text = text//',pair'
      rows(0) = text//',status'
      do p = 1, size(status)
         rows(p) = to_text(p)//','//comma_separated([(list(i)%values(p), i=1, size(list))])
         if (size(names) > 0) rows(p) = trim(rows(p))//','//names(p)
         rows(p) = trim(rows(p))//','//status_names(status(p))
      end do
      call document%add(as_lines(rows), [0.0_dp, list%scale, 0.0_dp])
   end subroutine add_point_table

   !> The table of points for a listing; a line below its headings has the units, if the case names them.
   pure function points_text(title, list, status, units) result(text)
      character(*), intent(in) :: title !! its heading
      type(column_t), intent(in) :: list(:) !! the columns of numbers
      integer, intent(in) :: status(:) !! the statuses (m)
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      character(:), allocatable :: rows(:), labels, units_line
      type(column_t), allocatable :: shown(:)
      integer :: p, i, first, width

      shown = pack(list, list%label /= '')
      ! Numbers with six digits, or a unit with a long name.
      width = max(13, 1 + maxval([(n_characters(unit_of(units, trim(shown(i)%dimension))), i=1, size(shown))]))
      labels = flush_right('point', 7)
      units_line = repeat(' ', len(labels))
      do i = 1, size(shown)
         labels = labels//flush_right(trim(shown(i)%label), width)
         units_line = units_line//flush_right(unit_of(units, trim(shown(i)%dimension)), width)
      end do
      first = merge(-1, 0, len_trim(units) > 0)
      allocate (character(20 + 2*width*size(shown)) :: rows(first:size(status)))
      rows(0) = units_line
      rows(first) = labels//'  status'
      do p = 1, size(status)
         rows(p) = flush_right(to_text(p), 7)//columns([(shown(i)%values(p), i=1, size(shown))], width)//'  '// &
            status_names(status(p))
      end do
      text = heading(title)//as_lines(rows)
   end function points_text

end module amontons_contact_table
