!> The group of a deck that describes a load.
module amontons_config_loads
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_by_temperature, load_on_nodes, load_on_region, load_on_sides, load_t
   implicit none (type, external)
   private

   public :: describe_load

   !> The group of a load.
   type(group_t), parameter, public :: load_group = group_t('load', is_repeatable=.true.)

contains

   !> Describes one `&load`: on the sides of a set, on nodes, on a region, or by temperature.
   subroutine describe_load(visitor, load)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(load_t), intent(inout) :: load !! the load
      logical :: has_point, on_nodes, is_given(4)
      logical :: has_force, has_gravity, has_speed, has_center
      integer :: material

      on_nodes = load%target == load_on_nodes
      has_point = on_nodes .and. .not. is_filled(load%set)
      call visitor%open_group(load_group)
      call visitor%text(key_t('name', 'by which `&sweep` and `&steps` know it; several loads may share a name', &
         default='none', is_filled=.true., also='label'), load%name)
      call visitor%text(key_t('set', 'the boundary set of a traction, pressure or total force; the node set or '// &
         'boundary set of point forces', is_filled=.true., also='nset surface'), load%set)
      call visitor%vector(key_t('point', 'coordinates of the node of a `force`', 'L', also='node'), load%point, &
         has_point)
      call visitor%text(key_t('region', 'the region of a body force or temperature', default='the whole body', &
         also='elset'), load%region)
      call describe_side_load(visitor, load, is_given(load_on_sides))
      call visitor%vector(key_t('force', 'a force on the node at `point`, or on each node of `set`, which'// &
         ' adds up: see `total_force`', 'F', also='f fx fy cload'), load%force, on_nodes)
      is_given(load_on_nodes) = on_nodes
      ! Describes the keys of forces per volume.
      has_gravity = any(abs(load%gravity) > 0.0_dp)
      has_speed = abs(load%angular_speed) > 0.0_dp
      has_force = load%target == load_on_region .and. (any(abs(load%body_force) > 0.0_dp) .or. &
         .not. (has_gravity .or. has_speed))
      has_center = has_speed .and. any(abs(load%center) > 0.0_dp)
      call visitor%vector(key_t('body_force', 'force per volume, on `region` or on the whole body', 'F/L³', &
         also='weight'), load%body_force, has_force)
      call visitor%vector(key_t('gravity', 'acceleration along x, y, z that gives the `density` its weight', 'L/T²', &
         also='g acceleration grav'), load%gravity, has_gravity)
      call visitor%real(key_t('angular_speed', 'of a rotation, in radians per time: the centrifugal force on the'// &
         ' `density`', '1/T', default='none', also='omega spin centrif speed'), load%angular_speed, has_speed)
      call visitor%vector(key_t('center', 'a point of the axis of rotation; not for a body of revolution', 'L', &
         default='the origin', also='origin'), load%center, has_center)
      call visitor%vector(key_t('axis', 'direction of the axis of rotation, of any length; a solid needs it; not'// &
         ' for a body of revolution', default='normal to the plane', is_nonzero=.true.), load%axis)
      is_given(load_on_region) = has_force .or. has_gravity .or. has_speed
      call describe_temperature(visitor, load, is_given(load_by_temperature))
      call visitor%close_group()
      load%target = max(load_on_sides, findloc(is_given, .true., dim=1))
      call visitor%locate('set', load%origin)
      ! Judges the keys of a `&load` together.
      if (.not. visitor%is_judging()) return
      call visitor%require(any(is_given), '', '&load needs traction, pressure, total_force, total_moment, '// &
         'traction_theta, torque, force, body_force, gravity, angular_speed or temperature')
      call visitor%require(count(is_given) <= 1, '', &
         'tractions, pressure, total_force, total_moment and torque, force, body forces, and temperature need a '// &
         '&load for each')
      if (count(is_given) /= 1) return
      call visitor%only('set', load%target <= load_on_nodes, 'traction, pressure, total_force, torque or force')
      call visitor%only('point', load%target == load_on_nodes, 'force')
      call visitor%only('region', load%target >= load_on_region, 'body_force, gravity, angular_speed or temperature')
      call visitor%only('center axis', visitor%has('angular_speed'), 'angular_speed')
      call visitor%only('about', visitor%has('total_moment'), 'total_moment')
      call visitor%state_dimensions(2, 'traction_theta torque')
      call visitor%state_dimensions(3, 'total_moment')
      call visitor%require(visitor%n_dim < 3 .or. visitor%has('axis') .or. .not. has_speed, 'angular_speed', &
         'angular_speed of a solid needs the axis of its rotation')
      call visitor%require(visitor%has('set') .or. load%target /= load_on_sides, '', &
         'traction, pressure, total_force and torque need set')
      call visitor%require((visitor%has('set') .neqv. visitor%has('point')) .or. load%target /= load_on_nodes, &
         'force', 'force needs either set or point')
      material = 0
      do while (load%target == load_by_temperature)
         material = visitor%deck%next_group('material', material)
         if (material == 0) exit
         call visitor%require(visitor%deck%has(material, 'expansion'), 'temperature', &
            'temperature needs the expansion of every &material; 0 for one that does not expand')
      end do
   end subroutine describe_load

   !> Describes the keys of a load on sides.
   subroutine describe_side_load(visitor, load, is_given)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(load_t), intent(inout) :: load !! the load
      logical, intent(out) :: is_given !! whether it has any of them
      logical :: has(4), has_total, has_moment, has_twist(2)
      real(dp) :: slopes(size(load%traction_slope))

      has_total = any(abs(load%total_force) > 0.0_dp)
      has_moment = any(abs(load%total_moment) > 0.0_dp)
      has_twist = abs([load%traction_theta, load%torque]) > 0.0_dp
      slopes = reshape(load%traction_slope, shape(slopes))
      has = load%target == load_on_sides .and. (.not. any([has_total, has_moment, has_twist]) .or. &
         any(abs([load%traction, slopes, load%pressure, load%pressure_slope]) > 0.0_dp))
      call visitor%vector(key_t('traction', 'force per area along x, y and, in a solid, z, at the origin of the'// &
         ' coordinates', 'F/L²', also='t trac stress shear'), load%traction, has(1))
      call visitor%vector(key_t('traction_slope', 'its change: of each component along x, then of each along y, and'// &
         ' in a solid of each along z', 'F/L³'), slopes, has(2))
      call visitor%real(key_t('pressure', 'force per area against the outward normal, at the origin: a positive one'// &
         ' presses on the body', 'F/L²', also='p press'), load%pressure, has(3))
      call visitor%vector(key_t('pressure_slope', 'its change along x, y and z', 'F/L³'), load%pressure_slope, has(4))
      call visitor%vector(key_t('total_force', 'the resultant of a uniform traction on `set`, in all: over the '// &
         'thickness, or all around an axis of revolution', 'F', also='resultant total sum'), load%total_force, &
         has_total)
      load%traction_slope = reshape(slopes, shape(load%traction_slope))
      call visitor%reals(key_t('total_moment', 'in a solid: the moment of a traction on `set`, with that of'// &
         ' `total_force`; the traction is linear', 'F L', default='none', also='mx my mz'), load%total_moment, &
         has_moment)
      call visitor%reals(key_t('about', 'the point that `total_moment` is counted about, and that `total_force`'// &
         ' then goes through', 'L', default='the centroid of `set`'), load%about, load%has_about)
      call visitor%real(key_t('traction_theta', 'with `twist` in `&material`: force per area around the axis', &
         'F/L²', default='`0.0`'), load%traction_theta, has_twist(1))
      call visitor%real(key_t('torque', 'with `twist` in `&material`: moment about the axis of a traction on `set`'// &
         ' in proportion to the radius, in all', 'F L', default='`0.0`', also='moment mt mz'), load%torque, &
         has_twist(2))
      is_given = any([has, has_total, has_moment, has_twist])
      call visitor%require(.not. (any(has) .and. (has_total .or. has_moment)), &
         trim(merge('total_force ', 'total_moment', has_total)), &
         'give either '//trim(merge('total_force ', 'total_moment', has_total))//', or traction and pressure')
   end subroutine describe_side_load

   !> Describes the keys of a temperature.
   subroutine describe_temperature(visitor, load, is_given)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(load_t), intent(inout) :: load !! the load
      logical, intent(out) :: is_given !! whether it has any of them
      character(*), parameter :: table_key = 'temperature_table'
      logical :: has_value, has_slope, has_table

      has_table = is_filled(load%temperature_file)
      has_value = load%target == load_by_temperature .and. .not. has_table
      has_slope = any(abs(load%temperature_slope) > 0.0_dp)
      call visitor%real(key_t('temperature', 'above that at which nothing is strained, at the origin; on `region`'// &
         ' or on the whole body', 'K', also='temp dtemp'), load%temperature, has_value)
      call visitor%vector(key_t('temperature_slope', 'its change along x, y and z', 'K/L'), load%temperature_slope, &
         has_slope)
      call visitor%text(key_t(table_key, 'file with the numbers of nodes, as in the mesh file, and their'// &
         ' temperatures, instead', is_file=.true., is_filled=.true.), load%temperature_file, has_table)
      call visitor%table(table_key, load%temperature_file, load%temperature_table)
      is_given = has_value .or. has_slope .or. has_table
      if (.not. allocated(load%temperature_table)) return
      associate (numbers => load%temperature_table(1, :))
         call visitor%require(all(numbers >= 1.0_dp .and. numbers < huge(1) .and. .not. abs(numbers - anint(numbers)) &
            > 0.0_dp), table_key, table_key//' must have the number of a node, 1 or above, in each row')
      end associate
      call visitor%require(.not. (has_value .or. has_slope), table_key, &
         'give either temperature and temperature_slope, or temperature_table')
   end subroutine describe_temperature

end module amontons_config_loads
