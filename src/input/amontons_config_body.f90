!> What a deck says of the body: mesh, materials, supports, loads.
module amontons_config_body
   use amontons_constraints, only: support_t, supported_components
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_element, only: element_names
   use amontons_error, only: error_t
   use amontons_file_model, only: use_names
   use amontons_kinds, only: dp
   use amontons_loads, only: load_by_temperature, load_on_nodes, load_on_region, load_on_sides, load_t
   use amontons_material, only: formulation_names, hypothesis_names, material_t, new_material
   use amontons_mesh_file, only: mesh_part_t
   use amontons_rectangle, only: diagonal_names, rectangle_t
   implicit none (type, external)
   private

   public :: describe_load, describe_material, describe_mesh, describe_support, require_expansion

   !> The group of the mesh.
   type(group_t), parameter, public :: mesh_group = group_t('mesh', is_repeatable=.true., is_shared=.true.)
   !> The group of a material.
   type(group_t), parameter, public :: material_group = group_t('material', is_repeatable=.true., is_shared=.true.)
   !> The group of a support.
   type(group_t), parameter, public :: support_group = group_t('support', is_repeatable=.true., is_shared=.true.)
   !> The group of a load.
   type(group_t), parameter, public :: load_group = group_t('load', is_repeatable=.true.)

   !> What `ux`, `uy`, `un` and `ut` mean.
   character(67), parameter :: component_meanings(*) = [character(67) :: &
      'prescribed displacement along x', &
      'prescribed displacement along y', &
      'prescribed displacement along the outward normal; with `set` only', &
      'prescribed displacement along the tangent; with `set` only']
   !> What other programs call these.
   character(8), parameter :: component_words(*) = [character(8) :: 'u u1 dx', 'v u2 dy', 'u_n', 'u_t']

contains

   !> Describes one `&mesh`: a rectangle and its cells, or a file.
   subroutine describe_mesh(visitor, part)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(mesh_part_t), intent(inout) :: part !! the part of the mesh
      character(9), parameter :: kind_names(2) = [character(9) :: 'rectangle', 'file']
      character(9) :: kind
      logical :: has_file, has_name, is_rectangle

      has_file = is_filled(part%file)
      has_name = is_filled(part%name)
      kind = kind_names(merge(2, 1, has_file))
      call visitor%open_group(mesh_group)
      call visitor%text(key_t('name', 'of one body among several: its sets are `NAME.left` and so on, and the whole'// &
         ' of it is the region `NAME`', default='none', is_filled=.true., also='label body'), part%name, has_name)
      call visitor%word(key_t('kind', 'where the mesh comes from', also='type'), kind, kind_names)
      is_rectangle = kind == kind_names(1)
      call visitor%text(key_t('file', "with `kind = 'file'`, where it is required: name of the mesh file, seen from"// &
         " the deck's folder", is_file=.true., is_filled=.true., also='filename path'), part%file, has_file)
      call visitor%words(key_t('use', 'what the body takes from an Abaqus or CalculiX file besides the mesh', &
         default='none', also='read import'), use_names, part%is_used)
      call describe_rectangle(visitor, part%rectangle, is_rectangle)
      call visitor%reals(key_t('origin', 'where the lower left corner of the rectangle, or the origin of the file,'// &
         ' is put', 'L', also='position offset translate'), part%origin)
      call visitor%whole(key_t('refine', 'how often every element is cut in four, curved sides along their curve;'// &
         ' sets and regions follow', at_least=0.0_dp, also='refinement refinements'), part%n_refinements)
      call visitor%close_group()
      call visitor%locate(trim(merge('cells', 'file ', is_rectangle)), part%place)
      if (.not. visitor%is_judging()) return
      call visitor%only('file', .not. is_rectangle, "kind = 'file'")
      call visitor%only('use', .not. is_rectangle, "kind = 'file'")
      call visitor%only('use', .not. has_name, 'a mesh without a name')
      call visitor%only('size', is_rectangle, "kind = 'rectangle'")
      call visitor%only('cells', is_rectangle, "kind = 'rectangle'")
      call visitor%only('element', is_rectangle, "kind = 'rectangle'")
      call visitor%only('diagonal', is_rectangle, "kind = 'rectangle'")
      call visitor%only('grading', is_rectangle, "kind = 'rectangle'")
      call visitor%require(has_file .or. is_rectangle, 'kind', "kind = 'file' needs file = 'MESH'")
   end subroutine describe_mesh

   !> Describes the keys of a rectangle.
   subroutine describe_rectangle(visitor, rectangle, is_rectangle)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(rectangle_t), intent(inout) :: rectangle !! the rectangle
      logical, intent(in) :: is_rectangle !! whether the mesh is one
      logical :: needs_size, has_size, has_cells, has_element, has_diagonal, has_grading

      needs_size = is_rectangle .and. .not. visitor%has('file')
      has_size = is_rectangle
      has_cells = is_rectangle
      has_element = is_rectangle
      has_diagonal = is_rectangle
      has_grading = is_rectangle
      call visitor%reals(key_t('size', 'of the rectangle: width and height', 'L', above=0.0_dp, &
         is_required=needs_size, also='length lengths dimensions'), rectangle%size, has_size)
      call visitor%wholes(key_t('cells', 'of the rectangle: number of cells along x and y', at_least=1.0_dp, &
         is_required=needs_size, also='elements divisions n nx ny h'), rectangle%cells, has_cells)
      call visitor%word(key_t('element', 'a quadrilateral, or two triangles in each cell; linear or quadratic', &
         also='type etype order'), rectangle%element, element_names, has_element)
      call visitor%word(key_t('diagonal', 'how triangles halve a cell: `/`, `\`, or by turns; no effect on'// &
         ' quadrilaterals'), rectangle%diagonal, diagonal_names, has_diagonal)
      call visitor%real(key_t('grading', 'height of the top row of cells over that of the bottom row; the rows'// &
         ' between follow a geometric series', above=0.0_dp, also='bias ratio'), rectangle%grading, has_grading)
   end subroutine describe_rectangle

   !> Describes one `&material`.
   subroutine describe_material(visitor, material)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(material_t), intent(inout) :: material !! the material
      type(material_t) :: derived
      type(error_t), allocatable :: error
      logical :: has_region

      has_region = is_filled(material%region)
      call visitor%open_group(material_group)
      call visitor%real(key_t('young', "Young's modulus", 'F/L²', above=0.0_dp, is_required=.true., &
         also='e modulus e_modulus youngs_modulus'), material%young)
      call visitor%real(key_t('poisson', "Poisson's ratio", above=-1.0_dp, below=0.5_dp, is_required=.true., &
         also='nu poissons_ratio'), material%poisson)
      call visitor%real(key_t('thickness', 'thickness of a plane body; it multiplies stiffness and loads, so that'// &
         ' forces are in [F]', 'L', above=0.0_dp, also='t depth'), material%thickness)
      call visitor%word(key_t('hypothesis', 'how the body is reduced to the plane; the same for all materials', &
         also='type plane model state plane_stress plane_strain'), material%hypothesis, hypothesis_names)
      call visitor%word(key_t('formulation', "of `quad4` elements: `'b-bar'` does not lock where the material is"// &
         " nearly incompressible; `'auto'` is `'b-bar'` for a Poisson's ratio of 0.49 or more"), material%formulation, &
         formulation_names)
      call visitor%real(key_t('density', 'mass per volume, for `gravity` and `angular_speed` of `&load`', 'M/L³', &
         at_least=0.0_dp, also='rho mass'), material%density)
      call visitor%real(key_t('expansion', 'coefficient of thermal expansion, for `temperature` of `&load`', &
         '1/K', also='alpha cte'), material%expansion)
      call visitor%text(key_t('region', 'the region of the mesh that the material fills', default='all the rest', &
         also='set elset'), material%region, has_region)
      call visitor%close_group()
      material%origin = ''
      call visitor%locate('region', material%origin)
      call visitor%require(material%formulation /= 'b-bar' .or. material%hypothesis /= 'plane stress', 'formulation', &
         "formulation must not be 'b-bar' in plane stress, where nothing locks")
      ! Its rules are those above.
      call new_material(derived, material%young, material%poisson, material%hypothesis, material%thickness, error)
      material%lambda = derived%lambda
      material%mu = derived%mu
      material%is_plane_stress = derived%is_plane_stress
      material%is_axisymmetric = derived%is_axisymmetric
      call material%choose_formulation((material%formulation))
   end subroutine describe_material

   !> Describes one `&support`.
   subroutine describe_support(visitor, support)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(support_t), intent(inout) :: support !! the support
      logical :: has_name, has_set, has_point, has_spring(2)
      integer :: k

      has_name = is_filled(support%name)
      has_set = is_filled(support%set)
      has_point = allocated(support%set) .and. .not. has_set
      ! A support that holds nothing else has them even if they are 0.
      has_spring = any(support%spring > 0.0_dp) .or. all(.not. support%is_held)
      call visitor%open_group(support_group)
      call visitor%text(key_t('name', 'by which `&steps` know it; several supports may share a name', default='none', &
         is_filled=.true., is_free=.true., also='label'), support%name, has_name)
      call visitor%text(key_t('set', 'the nodes of a boundary set; this or `point` is required', is_filled=.true., &
         also='nset boundary'), support%set, has_set)
      call visitor%reals(key_t('point', 'the node at these coordinates', 'L', also='node'), support%point, has_point)
      do k = 1, size(supported_components)
         call visitor%real(key_t(supported_components(k), component_meanings(k), 'L', default='free', &
            also=component_words(k), is_free=.true.), support%displacement(k), support%is_held(k))
      end do
      call visitor%real(key_t('spring_n', 'elastic foundation: stress per displacement along the normal; with `set`'// &
         ' only', 'F/L³', default='`0.0`', at_least=0.0_dp, also='k stiffness foundation'), &
         support%spring(1), has_spring(1))
      call visitor%real(key_t('spring_t', 'elastic foundation: stress per displacement along the tangent; with'// &
         ' `set` only', 'F/L³', default='`0.0`', at_least=0.0_dp), support%spring(2), has_spring(2))
      call visitor%close_group()
      call visitor%locate('set', support%origin)
      if (.not. visitor%is_judging()) return
      call visitor%require(has_set .neqv. has_point, 'set', '&support needs either set or point')
      call visitor%require(any([support%is_held, has_spring]), '', &
         '&support needs one of ux, uy, un, ut, spring_n and spring_t')
      call visitor%require(.not. (has_point .and. (any(has_spring) .or. any(support%is_held(3:)))), 'point', &
         'un, ut, spring_n and spring_t need set: a point has no normal')
   end subroutine describe_support

   !> Describes one `&load`: on the sides of a set, on nodes, on a region, or by temperature.
   subroutine describe_load(visitor, load)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(load_t), intent(inout) :: load !! the load
      logical :: has_name, has_set, has_point, has_region, on_nodes, is_given(4)

      has_name = is_filled(load%name)
      has_set = is_filled(load%set)
      has_region = is_filled(load%region)
      on_nodes = load%target == load_on_nodes
      has_point = on_nodes .and. .not. has_set
      call visitor%open_group(load_group)
      call visitor%text(key_t('name', 'by which `&sweep` and `&steps` know it; several loads may share a name', &
         default='none', is_filled=.true., also='label'), load%name, has_name)
      call visitor%text(key_t('set', 'the boundary set of a traction, pressure or total force; the node set or boundary set of'// &
         ' point forces', is_filled=.true., also='nset surface'), load%set, has_set)
      call visitor%reals(key_t('point', 'coordinates of the node of a `force`', 'L', also='node'), load%point, &
         has_point)
      call visitor%text(key_t('region', 'the region of a body force or temperature', default='the whole body', &
         also='elset'), load%region, has_region)
      call describe_tractions(visitor, load, is_given(load_on_sides))
      call visitor%reals(key_t('force', 'a force on the node at `point`, or on each node of `set`, which'// &
         ' adds up: see `total_force`', 'F', also='f fx fy cload'), load%force, on_nodes)
      is_given(load_on_nodes) = on_nodes
      call describe_body_force(visitor, load, is_given(load_on_region))
      call describe_temperature(visitor, load, is_given(load_by_temperature))
      call visitor%close_group()
      load%target = max(load_on_sides, findloc(is_given, .true., dim=1))
      call visitor%locate('set', load%origin)
      call judge_load(visitor, load, is_given)
   end subroutine describe_load

   !> Describes the keys of a load on sides.
   subroutine describe_tractions(visitor, load, is_given)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(load_t), intent(inout) :: load !! the load
      logical, intent(out) :: is_given !! whether it has any of them
      real(dp) :: slopes(4)
      logical :: has(4), has_total

      has_total = load%target == load_on_sides .and. any(abs(load%total_force) > 0.0_dp)
      has = load%target == load_on_sides .and. .not. has_total
      slopes = reshape(load%traction_slope, [4])
      call visitor%reals(key_t('traction', 'force per area along x and y, at the origin of the coordinates', 'F/L²', &
         also='t trac stress shear'), load%traction, has(1))
      call visitor%reals(key_t('traction_slope', 'its change: of the x component along x, of the y component along'// &
         ' x, of the x component along y, of the y component along y', 'F/L³'), slopes, has(2))
      call visitor%real(key_t('pressure', 'force per area against the outward normal, at the origin: a positive one'// &
         ' presses on the body', 'F/L²', also='p press'), load%pressure, has(3))
      call visitor%reals(key_t('pressure_slope', 'its change along x and y', 'F/L³'), load%pressure_slope, has(4))
      call visitor%reals(key_t('total_force', 'the resultant of a uniform traction on `set`, in all: over the '// &
         'thickness, or all around an axis of revolution', 'F', also='resultant total sum'), load%total_force, has_total)
      load%traction_slope = reshape(slopes, [2, 2])
      is_given = any(has) .or. has_total
      call visitor%require(.not. (any(has) .and. has_total), 'total_force', &
         'give either total_force, or traction and pressure')
   end subroutine describe_tractions

   !> Describes the keys of forces per volume.
   subroutine describe_body_force(visitor, load, is_given)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(load_t), intent(inout) :: load !! the load
      logical, intent(out) :: is_given !! whether it has any of them
      logical :: has_force, has_gravity, has_speed, has_center, has_axis

      has_gravity = any(abs(load%gravity) > 0.0_dp)
      has_speed = abs(load%angular_speed) > 0.0_dp
      has_force = load%target == load_on_region .and. (any(abs(load%body_force) > 0.0_dp) .or. &
         .not. (has_gravity .or. has_speed))
      has_center = has_speed .and. any(abs(load%center) > 0.0_dp)
      has_axis = has_speed .and. any(abs(load%axis) > 0.0_dp)
      call visitor%reals(key_t('body_force', 'force per volume, on `region` or on the whole body', 'F/L³', &
         also='weight'), load%body_force, has_force)
      call visitor%reals(key_t('gravity', 'acceleration along x and y that gives the `density` its weight', 'L/T²', &
         also='g acceleration grav'), load%gravity, has_gravity)
      call visitor%real(key_t('angular_speed', 'of a rotation, in radians per time: the centrifugal force on the'// &
         ' `density`', '1/T', default='none', also='omega spin centrif speed'), load%angular_speed, has_speed)
      call visitor%reals(key_t('center', 'a point of the axis of rotation; for a plane body only', 'L', &
         default='the origin', also='origin'), load%center, has_center)
      call visitor%reals(key_t('axis', 'direction of the axis of rotation where it lies in the plane; for a plane'// &
         ' body only', default='normal to the plane', is_nonzero=.true.), load%axis, has_axis)
      is_given = has_force .or. has_gravity .or. has_speed
   end subroutine describe_body_force

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
      call visitor%reals(key_t('temperature_slope', 'its change along x and y', 'K/L'), load%temperature_slope, &
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

   !> Judges the keys of a `&load` together.
   subroutine judge_load(visitor, load, is_given)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(load_t), intent(in) :: load !! the load
      logical, intent(in) :: is_given(:) !! whether it has keys of each target

      if (.not. visitor%is_judging()) return
      call visitor%require(any(is_given), '', '&load needs traction, pressure, total_force, force, body_force, '// &
         'gravity, angular_speed or temperature')
      call visitor%require(count(is_given) <= 1, '', &
         'traction and pressure or total_force, force, body forces, and temperature need a &load for each')
      if (count(is_given) /= 1) return
      call visitor%only('set', load%target <= load_on_nodes, 'traction, pressure, total_force or force')
      call visitor%only('point', load%target == load_on_nodes, 'force')
      call visitor%only('region', load%target >= load_on_region, 'body_force, gravity, angular_speed or temperature')
      call visitor%only('center', visitor%has('angular_speed'), 'angular_speed')
      call visitor%only('axis', visitor%has('angular_speed'), 'angular_speed')
      call visitor%require(visitor%has('set') .or. load%target /= load_on_sides, '', &
         'traction, pressure and total_force need set')
      call visitor%require((visitor%has('set') .neqv. visitor%has('point')) .or. load%target /= load_on_nodes, &
         'force', 'force needs either set or point')
      if (load%target == load_by_temperature) call require_expansion(visitor, 'temperature')
   end subroutine judge_load

   !> Requires that every `&material` says how it expands, since there are temperatures.
   subroutine require_expansion(visitor, key)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      character(*), intent(in) :: key !! the key that brings the temperatures
      integer :: material

      material = 0
      do
         material = visitor%deck%next_group('material', material)
         if (material == 0) exit
         call visitor%require(visitor%deck%has(material, 'expansion'), key, &
            'temperature needs the expansion of every &material; 0 for one that does not expand')
      end do
   end subroutine require_expansion

end module amontons_config_body
