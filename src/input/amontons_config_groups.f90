!> The groups of a deck that describe a case: name, options and output; mesh, materials, supports and loads; contact
!> sets, ties and their obstacles.
module amontons_config_groups
   use amontons_case_label, only: case_label_t
   use amontons_constraints, only: along_normal, along_tangent, longest_name, support_t, supported_components
   use amontons_contact_set, only: contact_t, gap_names, line_field_t, multiplier_names, sliding_names, tie_t, &
      usual_most_nodal
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_element, only: element_names, is_solid
   use amontons_error, only: error_t
   use amontons_file_model, only: use_loads, use_names, use_supports
   use amontons_generated_mesh, only: diagonal_names
   use amontons_history, only: fretting_names, history_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_motion, load_t, new_load
   use amontons_material, only: formulation_names, hypothesis_names, material_t
   use amontons_mesh_file, only: mesh_part_t
   use amontons_obstacle, only: obstacle_dimensions, obstacle_names, obstacle_t
   use amontons_rigid_set, only: rigid_components
   use amontons_rounding, only: input_rounding
   use amontons_surface_file, only: read_surface_file
   use amontons_sweep, only: key_result_names, sweep_t
   use amontons_text, only: counted, to_text
   use amontons_triangulation, only: new_triangulation
   implicit none (type, external)
   private

   public :: accuracy_options_t, add_driven_set, describe_accuracy, describe_case, describe_contact, &
      describe_material, describe_mesh, describe_output, describe_preload, describe_problem, describe_rigid, &
      describe_support, describe_tie, driven_set_t, reduced_source_t

   !> The group of the case.
   type(group_t), parameter, public :: case_group = group_t('case')

   !> The group of the accuracy.
   type(group_t), parameter, public :: accuracy_group = group_t('accuracy')
   !> Kinds of error estimates, as a deck writes them.
   character(8), parameter :: estimate_names(2) = [character(8) :: 'recovery', 'none']
   !> Smallest number of refinements that show an order of convergence.
   integer, parameter :: fewest_refinements = 2

   !> Options on the accuracy.
   type :: accuracy_options_t
      character(8) :: estimate = 'recovery' !! one of `estimate_names`
      integer :: n_refinements = 0 !! on how many meshes, each refined from the one before, the case is solved again
   contains
      procedure :: wants_estimate => accuracy_wants_estimate
   end type accuracy_options_t

   !> The group of the output files.
   type(group_t), parameter, public :: output_group = group_t('output')

   !> The group of the problem.
   type(group_t), parameter, public :: problem_group = group_t('problem')
   !> Kinds of problems, as a deck writes them.
   character(7), parameter :: kind_names(2) = [character(7) :: 'body', 'reduced']

   !> The file of a reduced problem, and what replaces its contents.
   type :: reduced_source_t
      logical :: is_given = .false. !! whether the problem is a reduced one
      character(:), allocatable :: file !! name of its file, for messages
      character(:), allocatable :: path !! name of its file from the root on
      character(:), allocatable :: origin !! where the file was named, for messages: 'deck.nml:12: '; may be empty
      logical :: has_friction = .false. !! whether `friction` takes the place of the file's coefficients
      real(dp) :: friction = 0.0_dp !! Coulomb coefficient of all contacts [-]
   end type reduced_source_t

   !> The group of the mesh.
   type(group_t), parameter, public :: mesh_group = group_t('mesh', is_repeatable=.true., is_shared=.true.)
   !> The group of a material.
   type(group_t), parameter, public :: material_group = group_t('material', is_repeatable=.true., is_shared=.true.)
   !> The group of a support.
   type(group_t), parameter, public :: support_group = group_t('support', is_repeatable=.true., is_shared=.true.)
   !> The group of a rigid set.
   type(group_t), parameter, public :: rigid_group = group_t('rigid', is_repeatable=.true., is_shared=.true.)
   !> The group of a preload.
   type(group_t), parameter, public :: preload_group = group_t('preload', is_repeatable=.true., is_shared=.true.)
   !> A rigid set or a preload as a deck describes it.
   type :: driven_set_t
      type(support_t) :: motion !! the set, and the prescribed part of its motion
      type(load_t) :: drive !! the force and the moment that act on it
      type(tie_t) :: tie !! of a preload: the two sides of the cut
   end type driven_set_t

   !> Meanings of `supported_components`.
   character(82), parameter :: component_meanings(*) = [character(82) :: &
      'prescribed displacement along x', &
      'prescribed displacement along y', &
      'prescribed displacement along z, in a solid', &
      'prescribed displacement along the outward normal; with `set` only', &
      'prescribed displacement along the tangent, in a solid 0; with `set` only', &
      'prescribed displacement around the axis; with `twist = .true.` in `&material` only', &
      'prescribed angle of rotation about the axis, likewise']
   !> Their names in other programs.
   character(8), parameter :: component_words(*) = [character(8) :: 'u u1 dx', 'v u2 dy', 'w u3 dz', 'u_n', 'u_t', &
      'u_theta', 'angle']
   !> Units of them.
   character(3), parameter :: component_units(*) = [character(3) :: 'L', 'L', 'L', 'L', 'L', 'L', 'rad']

   !> The group of a contact set.
   type(group_t), parameter, public :: contact_group = group_t('contact', is_repeatable=.true.)
   !> The group of a tie.
   type(group_t), parameter, public :: tie_group = group_t('tie', is_repeatable=.true., is_shared=.true.)
   !> Keys of Coulomb's coefficient: its value, slope and table.
   type(key_t), parameter :: friction_keys(3) = [ &
      key_t('friction', "Coulomb's coefficient; 0 is frictionless contact", at_least=0.0_dp, &
      also='mu mu_s f cof coefficient'), &
      key_t('friction_slope', 'change of the coefficient along x, y and z; `friction` is then its value at the'// &
      ' origin', '1/L'), &
      key_t('friction_table', 'file with the coefficient over the length of the contact line, instead', is_file=.true.)]
   !> Keys of the given bound: its value, slope and table.
   type(key_t), parameter :: bound_keys(3) = [ &
      key_t('slip_bound', 'given bound of the shear stress (Tresca friction)', 'F/L²', at_least=0.0_dp, &
      also='tresca g'), &
      key_t('slip_bound_slope', 'change of the bound along x, y and z; `slip_bound` is then its value at the origin', &
      'F/L³'), &
      key_t('slip_bound_table', 'file with the bound over the length of the contact line, instead', is_file=.true.)]
   !> Keys of what is added to gaps: its value, slope and table.
   type(key_t), parameter :: gap_keys(3) = [ &
      key_t('extra_gap', 'added to every gap; negative for an interference', 'L', also='clearance interference'), &
      key_t('gap_slope', 'change of it along x, y and z, as of a taper; `extra_gap` is then its value at the origin'), &
      key_t('gap_table', 'file with what is added over the length of the contact line, instead', is_file=.true.)]

contains

   !> Describes `&case`: name and title.
   subroutine describe_case(visitor, label)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      class(case_label_t), intent(inout) :: label !! what the case is called; its file is set
      ! File names end at 255 characters; temporary ones add up to 30 to the name.
      integer, parameter :: longest_name = 200
      character, parameter :: blank = ' '
      integer :: i, last_point, n_commas
      logical :: are_units

      if (.not. allocated(label%name)) then
         label%name = label%file(index(label%file, '/', back=.true.) + 1:)
         last_point = index(label%name, '.', back=.true.)
         if (last_point > 1) label%name = label%name(:last_point - 1)
      end if
      call visitor%open_group(case_group)
      call visitor%text(key_t('name', 'name of the case and of its files; 1 to 200 characters, without `/`', &
         default="name of the deck's file without its folder and last extension", also='job id'), label%name)
      call visitor%text(key_t('title', 'what the case is about, for the listing', also='heading description'), &
         label%title)
      call visitor%text(key_t('units', "names of the units of length, force and stress, as `'mm, N, MPa'`, to label"// &
         ' listing, grids, figures and report; nothing is converted', default='none', is_filled=.true., also='unit'), &
         label%units)
      call visitor%close_group()
      n_commas = 0
      are_units = .true.
      do i = 1, len(label%units)
         if (label%units(i:i) /= ',') cycle
         n_commas = n_commas + 1
         are_units = are_units .and. len_trim(label%units(:i - 1)) > scan(label%units(:i - 1), ',', back=.true.)
      end do
      are_units = are_units .and. len_trim(label%units) > scan(label%units, ',', back=.true.) .and. &
         (n_commas == 1 .or. n_commas == 2)
      call visitor%require(are_units .or. .not. visitor%has('units'), 'units', &
         "units must name a length, a force and, if you like, a stress: 'mm, N, MPa'")
      if (len_trim(label%name) == 0 .or. len(label%name) > longest_name .or. &
         any([(label%name(i:i) < blank .or. label%name(i:i) == '/', i=1, len(label%name))])) then
         call visitor%deck%fault(visitor%place, 'name', 'name must be usable as a file name: 1 to '// &
            to_text(longest_name)//" characters without '/' and control characters")
      end if
   end subroutine describe_case

   !> Describes `&accuracy`.
   subroutine describe_accuracy(visitor, accuracy, begins_anew)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(accuracy_options_t), intent(inout) :: accuracy !! the options
      logical, intent(in) :: begins_anew !! whether the deck has neither a sweep nor a state to start from

      call visitor%open_group(accuracy_group)
      call visitor%word(key_t('estimate', 'estimate of the error of the stresses of every element: by recovered'// &
         ' stresses, or none, which saves some time', also='error'), accuracy%estimate, estimate_names)
      call visitor%whole(key_t('refinements', 'the case, or the history, is solved on its mesh and on so many'// &
         ' refined ones, and the key results get error bars', default='none', at_least=real(fewest_refinements, dp), &
         also='refine levels'), accuracy%n_refinements)
      call visitor%close_group()
      call visitor%only('refinements', begins_anew, 'a deck without &sweep and without start')
   end subroutine describe_accuracy

   !> Whether the deck asks for the estimated error of the stresses.
   pure logical function accuracy_wants_estimate(self)
      class(accuracy_options_t), intent(in) :: self !! the options

      accuracy_wants_estimate = self%estimate == estimate_names(1)
   end function accuracy_wants_estimate

   !> Describes `&output`: the files of a sweep or a history in addition to its table.
   subroutine describe_output(visitor, sweep, history)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(sweep_t), intent(inout) :: sweep !! the sweep
      type(history_t), intent(inout) :: history !! the history
      character(len(key_result_names)) :: key_results
      integer :: fields_every
      logical :: has_key_results, has_fretting
      character(len(fretting_names)) :: fretting

      fields_every = max(sweep%fields_every, history%fields_every)
      call visitor%open_group(output_group)
      call visitor%whole(key_t('fields_every', 'with `&sweep` or `&history`: the fields of case or step 1 and of'// &
         ' every so-many-th behind it are written as `.vtu`', default='none', at_least=1.0_dp, &
         also='out every frequency'), fields_every)
      has_key_results = sweep%has_forces
      key_results = key_result_names(merge(3, merge(2, 1, sweep%has_forces), sweep%has_body_results))
      call visitor%word(key_t('key_results', 'with `&sweep`: the key results of each case, of the contact points;'// &
         ' these and forces by name; or all, with the largest von Mises stress and displacement of the body, which'// &
         ' take longer', default="`'contact'`"), key_results, key_result_names, has_key_results)
      sweep%has_body_results = key_results == key_result_names(3)
      sweep%has_forces = key_results /= key_result_names(1)
      ! Describes what a history leaves of its steps.
      call visitor%whole(key_t('points_every', 'with `&history`: the contact points of step 1 and of every'// &
         ' so-many-th step behind it are written as a table', default='none', at_least=1.0_dp), history%points_every)
      call visitor%whole(key_t('states_every', 'with `&history`: all that another history needs to `start` from'// &
         ' step 1 or from a so-many-th step behind it is written', default='none', at_least=1.0_dp), &
         history%states_every)
      call visitor%list(key_t('probe', 'with `&history`: coordinates of nodes, one after the other, whose'// &
         ' displacements the table of the history shows', 'L', default='none', also='probes'), history%probes)
      has_fretting = history%has_fretting
      fretting = fretting_names(merge(2, 1, history%has_fretting))
      call visitor%word(key_t('fretting', 'with `&history`: whether the stress along the surface and the parameters'// &
         ' of Ruiz and of Smith, Watson and Topper are computed at each contact point', default="`'none'`"), fretting, &
         fretting_names, has_fretting)
      history%has_fretting = fretting == fretting_names(2)
      call visitor%close_group()
      if (.not. allocated(history%probe_origin)) history%probe_origin = ''
      call visitor%locate('probe', history%probe_origin)
      if (sweep%is_given()) sweep%fields_every = fields_every
      if (history%is_given) history%fields_every = fields_every
      call visitor%only('fields_every', sweep%is_given() .or. history%is_given, 'a deck with &sweep or &history')
      call visitor%only('key_results', sweep%is_given(), 'a deck with &sweep')
      call visitor%only('points_every states_every probe fretting', history%is_given, 'a deck with &history')
   end subroutine describe_output

   !> Describes `&problem`.
   subroutine describe_problem(visitor, reduced)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(reduced_source_t), intent(inout) :: reduced !! the reduced problem, if there is one
      character(len(kind_names)) :: kind
      logical :: has_kind

      has_kind = reduced%is_given
      call visitor%open_group(problem_group)
      kind = kind_names(merge(2, 1, reduced%is_given .or. visitor%has('file')))
      call visitor%word(key_t('kind', 'a body, described by the groups below; or a reduced problem from a file', &
         default="with a `file` `'reduced'`, else `'body'`"), kind, kind_names, has_kind)
      call visitor%text(key_t('file', "of a reduced problem: name of its file, seen from the deck's folder", &
         is_file=.true., is_filled=.true., also='filename path'), reduced%path)
      call visitor%real(key_t('friction', "with `kind = 'reduced'`: Coulomb's coefficient of all contacts,"// &
         " instead of the file's", default="the file's", at_least=0.0_dp, also='mu'), reduced%friction, &
         reduced%has_friction)
      call visitor%close_group()
      reduced%file = reduced%path
      reduced%is_given = kind == 'reduced'
      call visitor%locate('file', reduced%origin)
      if (visitor%is_judging()) then
         call visitor%only('file friction', reduced%is_given, "kind = 'reduced'")
         call visitor%require(visitor%has('file') .or. .not. reduced%is_given, 'kind', &
            "kind = 'reduced' needs file = 'PROBLEM'")
      else if (visitor%place > 0) then
         ! A body that is missing here is not missed as well.
         reduced%is_given = reduced%is_given .or. visitor%deck%count_groups('mesh') == 0
      end if
   end subroutine describe_problem

   !> Describes one `&mesh`: a rectangle or box and its cells, or a file.
   subroutine describe_mesh(visitor, part)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(mesh_part_t), intent(inout) :: part !! the part of the mesh
      character(9), parameter :: kind_names(3) = [character(9) :: 'rectangle', 'box', 'file']
      character(9) :: kind
      character(8) :: element
      type(key_t) :: size_key, cells_key, element_key
      logical :: is_file, is_rectangle, is_stepped, needs_size, is_written

      call visitor%open_group(mesh_group)
      kind = kind_names(merge(3, merge(2, 1, part%is_box), is_filled(part%file) .or. visitor%has('file')))
      call visitor%text(key_t('name', 'of one body among several: its sets are `NAME.left` and so on, and the whole'// &
         ' of it is the region `NAME`', default='none', is_filled=.true., also='label body'), part%name)
      call visitor%word(key_t('kind', 'where the mesh comes from', also='type', &
         default="with a `file` `'file'`, else `'rectangle'`"), kind, kind_names)
      is_rectangle = kind == kind_names(1)
      part%is_box = kind == kind_names(2)
      is_file = kind == kind_names(3)
      call visitor%text(key_t('file', "name of the mesh file, seen from the deck's folder", is_file=.true., &
         is_filled=.true., also='filename path'), part%file)
      call visitor%words(key_t('use', 'what the body takes from an Abaqus or CalculiX file besides the mesh', &
         default='none', also='read import'), use_names, part%is_used)
      is_stepped = part%step > 0
      call visitor%whole(key_t('step', 'of a file with several: the step whose supports and loads are used,'// &
         ' with what it keeps of those before', default='the only one', at_least=1.0_dp), part%step, &
         is_stepped)
      ! Describes the keys of a rectangle or box.
      needs_size = .not. (is_file .or. visitor%has('file'))
      is_written = .not. is_file
      size_key = key_t('size', 'of a rectangle: width and height; of a box: lengths along x, y and z', 'L', &
         above=0.0_dp, is_required=needs_size, is_vector=.true., also='length lengths dimensions')
      cells_key = key_t('cells', 'number of cells along x, y and, in a box, z', at_least=1.0_dp, &
         is_required=needs_size, is_vector=.true., also='elements divisions n nx ny h')
      element_key = key_t('element', 'a quadrilateral, or two triangles in each cell; in a box a hexahedron, `hex8`'// &
         ' where none is given, or six tetrahedra; linear or quadratic', also='type etype order')
      if (part%is_box) then
         call visitor%reals(size_key, part%box%size, is_written)
         call visitor%wholes(cells_key, part%box%cells, is_written)
         call visitor%word(element_key, part%box%element, element_names, is_written)
         element = part%box%element
      else
         call visitor%reals(size_key, part%rectangle%size, is_written)
         call visitor%wholes(cells_key, part%rectangle%cells, is_written)
         call visitor%word(element_key, part%rectangle%element, element_names, is_written)
         element = part%rectangle%element
      end if
      is_written = is_rectangle
      call visitor%word(key_t('diagonal', 'how triangles halve a cell: `/`, `\`, or by turns; no effect on'// &
         ' quadrilaterals'), part%rectangle%diagonal, diagonal_names, is_written)
      call visitor%real(key_t('grading', 'height of the top row of cells over that of the bottom row; the rows'// &
         ' between follow a geometric series', above=0.0_dp, also='bias ratio'), part%rectangle%grading, is_written)
      call visitor%vector(key_t('origin', 'where the lower left corner of a rectangle, that of least coordinates of'// &
         ' a box, or the origin of the file is put', 'L', also='position offset translate'), part%origin)
      call visitor%whole(key_t('refine', 'how often every element is cut in four, in space in eight, curved '// &
         'sides along their curve; sets and regions follow', at_least=0.0_dp, also='refinement refinements'), &
         part%n_refinements)
      call visitor%close_group()
      call visitor%locate(trim(merge('file ', 'cells', is_file)), part%place)
      if (.not. visitor%is_judging()) return
      call visitor%only('file use step', is_file, "kind = 'file'")
      call visitor%only('step', any(part%is_used([use_supports, use_loads])), "use = 'supports' or 'loads'")
      call visitor%only('use', .not. visitor%has('name'), 'a mesh without a name')
      call visitor%only('size cells element', .not. is_file, "kind = 'rectangle' or 'box'")
      call visitor%only('diagonal grading', is_rectangle, "kind = 'rectangle'")
      call visitor%state_dimensions(merge(3, 2, part%is_box), 'size')
      call visitor%require(is_solid(findloc(element_names == element, .true., dim=1)) .eqv. part%is_box, 'element', &
         trim(element)//' is no element of a '//trim(kind))
      call visitor%require(visitor%has('file') .or. .not. is_file, 'kind', "kind = 'file' needs file = 'MESH'")
   end subroutine describe_mesh

   !> Describes one `&material`.
   subroutine describe_material(visitor, material)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(material_t), intent(inout) :: material !! the material
      real(dp), allocatable :: young(:), poisson(:), shear(:), expansion(:)
      logical :: is_orthotropic, is_known, has_axis(2), has_thickness, has_hypothesis
      character(len(hypothesis_names)) :: hypothesis

      is_orthotropic = material%shear(1) > 0.0_dp
      is_known = all(material%young > 0.0_dp)
      young = material%young(:merge(3, 1, is_orthotropic))
      poisson = material%poisson(:merge(3, 1, is_orthotropic))
      shear = material%shear(:merge(merge(3, 1, visitor%n_dim == 3), 0, is_orthotropic))
      expansion = material%expansion(:merge(3, 1, is_orthotropic))
      has_axis = is_orthotropic .and. visitor%n_dim == 3
      has_thickness = visitor%n_dim == 2
      has_hypothesis = visitor%n_dim == 2 .or. material%hypothesis /= ''
      call visitor%open_group(material_group)
      call visitor%list(key_t('young', "Young's modulus; of an orthotropic material `E1, E2, E3` along its axes,"// &
         ' the third of which is that of z, or of the circumference', 'F/L²', above=0.0_dp, is_required=.true., &
         also='e modulus e_modulus youngs_modulus'), young, is_known)
      call visitor%list(key_t('poisson', "Poisson's ratio; of an orthotropic material `nu12, nu13, nu23`: nu12 is"// &
         ' how much axis 2 contracts when axis 1 is pulled', above=-1.0_dp, &
         below=merge(huge(0.5_dp), 0.5_dp, size(young) > 1), is_required=.true., also='nu poissons_ratio'), poisson, &
         is_known)
      call visitor%list(key_t('shear', 'with three numbers in `young`: shear modulus G12 in the plane, in a solid'// &
         ' `G12, G13, G23`', 'F/L²', above=0.0_dp, default='isotropic', also='g g12 shear_modulus'), shear, &
         is_orthotropic)
      call visitor%reals(key_t('axis1', 'with `shear`, in a solid: direction of axis 1', default='that of x', &
         is_nonzero=.true., also='a'), material%axis1, has_axis(1))
      call visitor%reals(key_t('axis2', 'likewise a direction in the plane of axes 1 and 2', &
         default='that of y', is_nonzero=.true., also='b'), material%axis2, has_axis(2))
      call visitor%real(key_t('angle', 'with `shear`: angle of axis 1 to the x axis, counterclockwise; in a solid'// &
         ' by which axes 1 and 2 are turned about axis 3', '°', also='orientation'), material%angle, is_orthotropic)
      call visitor%real(key_t('thickness', 'thickness of a plane body; it multiplies stiffness and loads, so that'// &
         ' forces are in [F]', 'L', above=0.0_dp, also='t depth'), material%thickness, has_thickness)
      hypothesis = material%hypothesis
      call visitor%word(key_t('hypothesis', 'how a plane mesh represents the body; the same for all materials', &
         also='type plane model state plane_stress plane_strain'), hypothesis, hypothesis_names, has_hypothesis)
      if (has_hypothesis) material%hypothesis = hypothesis
      call visitor%flag(key_t('twist', &
         "with `hypothesis = 'axisymmetric'`: whether the body may twist about its axis; the"// &
         ' same for all materials', default='`.false.`', also='torsion'), material%is_twisted)
      call visitor%word(key_t('formulation', "of all elements but `tri3` and `tet4`: `'b-bar'` is right where the"// &
         " material is nearly incompressible; `'auto'` is `'b-bar'` for a Poisson's ratio of 0.49 or more"), &
         material%formulation, formulation_names)
      call visitor%real(key_t('density', 'mass per volume, for `gravity` and `angular_speed` of `&load`', 'M/L³', &
         at_least=0.0_dp, also='rho mass'), material%density)
      call visitor%list(key_t('expansion', 'coefficient of thermal expansion, for `temperature` of `&load`; with'// &
         ' `shear` one number or three, along the axes', '1/K', default='`0.0`', also='alpha cte'), expansion, &
         is_known)
      call visitor%text(key_t('region', 'the region of the mesh that the material fills', default='all the rest', &
         also='set elset'), material%region)
      call visitor%close_group()
      material%origin = ''
      call visitor%locate('region', material%origin)
      call visitor%require(material%formulation /= 'b-bar' .or. material%hypothesis /= 'plane stress', 'formulation', &
         "formulation must not be 'b-bar' in plane stress, where nothing locks")
      if (visitor%is_judging()) call judge_material(visitor, material, young, poisson, shear, expansion)
   end subroutine describe_material

   !> Judges the constants of a material together, and derives its law.
   subroutine judge_material(visitor, material, young, poisson, shear, expansion)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(material_t), intent(inout) :: material !! the material; gains the constants
      real(dp), intent(in) :: young(:) !! the numbers given for Young's modulus, and so on
      real(dp), intent(in) :: poisson(:) !! Poisson's ratio
      real(dp), intent(in) :: shear(:) !! shear modulus; none for an isotropic material
      real(dp), intent(in) :: expansion(:) !! coefficient of thermal expansion
      type(error_t), allocatable :: error
      logical :: is_orthotropic

      is_orthotropic = size(young) == 3
      call visitor%state_dimensions(2, 'thickness hypothesis')
      call visitor%state_dimensions(3, 'axis1 axis2')
      if (is_orthotropic .and. any(size(shear) == [1, 3])) call visitor%state_dimensions( &
         merge(2, 3, size(shear) == 1), 'shear', ' of '//counted(size(shear), 'number'))
      call visitor%only('shear axis1 axis2 angle', is_orthotropic, 'three numbers in young')
      call visitor%require(size(young) == 1 .or. is_orthotropic, 'young', &
         'young: expected 1 number or 3, found '//to_text(size(young)))
      call visitor%require(size(poisson) == size(young), 'poisson', 'poisson must have as many numbers as young')
      call visitor%require(size(expansion) == 1 .or. size(expansion) == size(young), 'expansion', &
         'expansion must be one number, or as many as young has')
      call visitor%require(visitor%has('shear') .or. .not. is_orthotropic, 'young', &
         'three numbers in young need shear')
      call visitor%require(any(size(shear) == [0, 1, 3]), 'shear', &
         'shear: expected 1 number or 3, found '//to_text(size(shear)))
      call visitor%require(material%formulation /= 'b-bar' .or. .not. is_orthotropic, 'formulation', &
         "formulation must not be 'b-bar' with an orthotropic material")
      if (.not. ((size(young) == 1 .or. is_orthotropic) .and. size(poisson) == size(young) &
         .and. any(size(expansion) == [1, size(young)]) .and. size(shear) <= 3 .and. (is_orthotropic .eqv. &
         size(shear) > 0) .and. all(young > 0.0_dp) .and. all(poisson > -1.0_dp) .and. all(shear > 0.0_dp))) return
      material%young = reshape(young, [3], young)
      material%poisson = reshape(poisson, [3], poisson)
      if (is_orthotropic) material%shear = reshape(shear, [3], shear)
      material%expansion = reshape(expansion, [3], expansion)
      call material%derive(error)
      if (allocated(error)) call visitor%require(.false., merge('twist', merge('axis1', 'young', &
         visitor%has('axis1')), material%is_twisted), error%message)
   end subroutine judge_material

   !> Describes one `&support`.
   subroutine describe_support(visitor, support)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(support_t), intent(inout) :: support !! the support
      logical :: has_point, has_spring(2)
      integer :: k

      has_point = allocated(support%set) .and. .not. is_filled(support%set)
      ! A support that holds nothing else has them even if they are 0.
      has_spring = any(support%spring > 0.0_dp) .or. all(.not. support%is_held)
      call visitor%open_group(support_group)
      call visitor%text(key_t('name', 'name of its reactions, by which `&steps` know it, too; several'// &
         ' supports may share a name', &
         default='that of its set', is_filled=.true., also='label'), support%name)
      call visitor%text(key_t('set', 'the nodes of a boundary set; this or `point` is required', is_filled=.true., &
         also='nset boundary'), support%set)
      call visitor%vector(key_t('point', 'the node at these coordinates', 'L', also='node'), support%point, has_point)
      do k = 1, size(supported_components)
         call visitor%real(key_t(supported_components(k), component_meanings(k), component_units(k), default='free', &
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
      call visitor%require(visitor%has('set') .neqv. has_point, 'set', '&support needs either set or point')
      call visitor%require(any([support%is_held, has_spring]), '', &
         '&support needs one of ux, uy, uz, un, ut, utheta, turn, spring_n and spring_t')
      call visitor%require(.not. (has_point .and. any([has_spring, support%is_held(along_normal:along_tangent)])), &
         'point', 'un, ut, spring_n and spring_t need set: a point has no normal')
      call visitor%state_dimensions(3, 'uz')
      call visitor%state_dimensions(2, 'utheta turn')
   end subroutine describe_support

   !> Describes one `&rigid`: sets that move as a rigid body.
   subroutine describe_rigid(visitor, motion, drive, has)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(support_t), intent(inout) :: motion !! the sets, and the prescribed part of their motion
      type(load_t), intent(inout) :: drive !! the force and the moment that act on them
      logical, intent(in) :: has(size(rigid_components)) !! which of the components of `rigid_components` the body has
      character(*), parameter :: forced(size(has)) = [character(6) :: 'force', 'force', 'force', 'moment', 'moment', &
         'moment']
      character(*), parameter :: meanings(size(has)) = [character(60) :: 'displacement of the point along x', &
         'displacement of the point along y', 'displacement of the point along z, in a solid', &
         'in a solid: rotation about x in radians, right-handed', 'likewise about y', 'likewise about z']
      character, parameter :: units(size(has)) = ['L', 'L', 'L', ' ', ' ', ' ']
      character(8), parameter :: others(size(has)) = [character(8) :: 'u x', 'v y', 'w z', 'rx ur1', 'ry ur2', 'rz ur3']
      logical :: has_force, has_moment, has_turn, is_driven(size(has)), is_missing(size(has))
      real(dp), allocatable :: moment(:)
      integer :: k

      has_force = any(abs(drive%force) > 0.0_dp)
      has_moment = any(abs(drive%moment) > 0.0_dp)
      call visitor%open_group(rigid_group)
      call visitor%text(key_t('name', 'of the rigid body: `&steps` know its motion as a support, force and'// &
         ' moment as a load, along with others of the name; results have it', is_filled=.true., is_required=.true., &
         is_free=.true., also='label'), motion%name)
      call visitor%text(key_t('set', 'the boundary or node set that moves as a rigid body; several are separated by'// &
         " commas: `'left, right'`", is_filled=.true., is_required=.true., also='nset surface', &
         hint="several sets: 'A, B'"), motion%set)
      call visitor%vector(key_t('point', 'what `ux`, `uy` and `moment` are counted about', 'L', &
         default='the middle of its extents along x, y and z', also='center node reference'), motion%rigid%point, &
         motion%rigid%has_point)
      has_turn = motion%is_held(size(has)) .and. visitor%n_dim < 3
      if (has_turn) motion%is_held(size(has)) = .false.
      call visitor%real(key_t('turn', 'in the plane: rotation in radians, counterclockwise', default='free', &
         is_free=.true., also='rotation angle theta'), motion%displacement(size(has)), has_turn)
      do k = 1, size(rigid_components)
         call visitor%real(key_t(rigid_components(k), meanings(k), units(k), default='free', is_free=.true., &
            also=others(k)), motion%displacement(k), motion%is_held(k))
      end do
      motion%is_held(size(has)) = motion%is_held(size(has)) .or. has_turn
      moment = drive%moment
      if (visitor%n_dim < 3) moment = drive%moment(3:)
      call visitor%vector(key_t('force', 'force on the point', 'F', default='none', &
         also='f fx fy'), drive%force, has_force)
      call visitor%list(key_t('moment', 'moment about the point: one number, counterclockwise, with `twist` about'// &
         ' the axis; of a solid three', 'F L', default='none', also='m torque'), moment, has_moment)
      call describe_lock(visitor, motion)
      call visitor%close_group()
      call visitor%locate('set', motion%origin)
      motion%rigid%is_given = .true.
      if (.not. visitor%is_judging()) return
      call visitor%state_dimensions(2, 'turn')
      call visitor%state_dimensions(3, 'uz turn_x turn_y turn_z')
      if (has_moment) then
         call visitor%require(any(size(moment) == [1, 3]), 'moment', &
            'moment: expected 1 number or 3, found '//to_text(size(moment)))
         if (all(size(moment) /= [1, 3])) return
         call visitor%state_dimensions(merge(2, 3, size(moment) == 1), 'moment', &
            ' of '//counted(size(moment), 'number'))
         drive%moment(4 - size(moment):) = moment
      end if
      ! Components that the plane has not.
      is_missing = .not. has .or. ([.false., .false., .true., .true., .true., .false.] .and. visitor%n_dim < 3)
      call check_driven(visitor, motion, all(motion%is_held(:size(has)) .or. is_missing))
      is_driven = abs([drive%force, drive%moment]) > 0.0_dp
      do k = 1, size(rigid_components)
         call visitor%require(.not. (motion%is_held(k) .and. is_driven(k)), trim(forced(k)), &
            trim(merge('turn  ', rigid_components(k), has_turn .and. k == size(has)))// &
            ' is prescribed: nothing is left for '//trim(forced(k))//' to move')
      end do
      is_driven = is_driven .or. (motion%is_held(:size(has)) .and. abs(motion%displacement(:size(has))) > 0.0_dp)
      call visitor%require(.not. any(is_driven .and. .not. has), 'set', 'a rigid set of a body of revolution moves '// &
         'along the axis only: give uy or the second component of force; with twist turn and moment, too')
   end subroutine describe_rigid

   !> Describes one `&preload`: a cut whose sides are moved together.
   subroutine describe_preload(visitor, motion, drive, tie)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(support_t), intent(inout) :: motion !! the support that prescribes the jump
      type(load_t), intent(inout) :: drive !! the force
      type(tie_t), intent(inout) :: tie !! the two sides
      logical :: has_force

      has_force = .not. motion%is_held(1)
      call visitor%open_group(preload_group)
      call visitor%text(key_t('name', 'of the preload: `&sweep` and `&steps` know its force as a load and its'// &
         ' shortening as a support, along with others of the name; results have it', is_filled=.true., &
         is_required=.true., is_free=.true., also='label'), tie%name)
      call visitor%text(key_t('set', 'the boundary set on one side of the cut, the slave, as of `&tie`', &
         is_filled=.true., is_required=.true., also='slave surface'), tie%set)
      call visitor%text(key_t('to', 'the boundary set on the other side', is_filled=.true., is_required=.true., &
         also='against master target'), tie%to)
      call visitor%real(key_t('search', 'how far the other side may be along the normal, either way', 'L', &
         default='twice the longest side', above=0.0_dp), tie%search)
      call visitor%real(key_t('force', 'the preload: what the sides pull each other with along the normal; this or'// &
         ' `shortening` is required', 'F', default='none', is_free=.true., also='f pretension tension'), &
         drive%force(1), has_force)
      call visitor%real(key_t('shortening', 'how far the sides are moved into each other along the normal', 'L', &
         default='free', is_free=.true., also='adjustment jump'), motion%displacement(1), motion%is_held(1))
      call describe_lock(visitor, motion)
      call visitor%close_group()
      call visitor%locate('set', tie%origin)
      tie%has_jump = .true.
      motion%is_jump = .true.
      motion%name = tie%name
      motion%set = tie%set
      motion%origin = tie%origin
      if (.not. visitor%is_judging()) return
      call check_driven(visitor, motion, motion%is_held(1))
      call visitor%require(has_force .neqv. motion%is_held(1), 'force', '&preload needs either force or shortening')
      call visitor%require(tie%to /= tie%set, 'to', 'to must name another set than set')
   end subroutine describe_preload

   !> Describes when a rigid set or preload is locked.
   subroutine describe_lock(visitor, motion)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(support_t), intent(inout) :: motion !! the support that prescribes its motion; gains the time
      logical :: has_time

      has_time = motion%lock_time < huge(1.0_dp)
      call visitor%real(key_t('lock_time', 'with `&history`: one of its `times`; from then on what is free stays'// &
         ' where it is', default='never', also='lock'), motion%lock_time, has_time)
   end subroutine describe_lock

   !> Checks the name of a rigid set or preload, which must fit in tables, and its lock.
   subroutine check_driven(visitor, motion, is_held)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(support_t), intent(in) :: motion !! the support that prescribes its motion
      logical, intent(in) :: is_held !! whether all of its motion is prescribed

      call visitor%require(len(motion%name) <= longest_name, 'name', 'name must have at most '// &
         to_text(longest_name)//' characters')
      call visitor%only('lock_time', visitor%deck%count_groups('history') > 0, 'a deck with &history')
      call visitor%require(.not. (visitor%has('lock_time') .and. is_held), 'lock_time', &
         'the whole motion is prescribed: nothing is left for lock_time to lock')
   end subroutine check_driven

   !> Adds the support and the load that represent a rigid set or preload, and the tie of a preload.
   subroutine add_driven_set(supports, loads, ties, set, has)
      type(support_t), allocatable, intent(inout) :: supports(:) !! gains the motion
      type(load_t), allocatable, intent(inout) :: loads(:) !! gains force and moment
      type(tie_t), allocatable, intent(inout) :: ties(:) !! gains the two sides of a preload
      type(driven_set_t), intent(in) :: set !! the rigid set or preload
      logical, intent(in) :: has(size(rigid_components)) !! which of the components of `rigid_components` the body has
      type(support_t) :: support
      type(load_t) :: load

      support = set%motion
      if (support%rigid%is_given) support%is_held(:size(has)) = support%is_held(:size(has)) .or. .not. has
      call new_load(load, support%set)
      load%name = support%name
      load%origin = support%origin
      load%target = load_on_motion
      load%force = set%drive%force
      load%moment = set%drive%moment
      supports = [supports, support]
      loads = [loads, load]
      if (support%is_jump) ties = [ties, set%tie]
   end subroutine add_driven_set

   !> Describes one `&contact`.
   subroutine describe_contact(visitor, contact)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(contact_t), intent(inout) :: contact !! the contact set
      logical :: is_pair, has_kind, has_point, has_normal, has_radius, has_axis, has_line, has_file
      logical :: has_gap, has_wear

      call visitor%open_group(contact_group)
      call visitor%text(key_t('name', 'name of its forces, by which `&steps` know it besides its `set`', &
         default='that of its set', is_filled=.true., is_shared=.true., also='label'), contact%name)
      call visitor%text(key_t('set', 'the boundary set that may touch an obstacle, or another body', is_filled=.true., &
         is_required=.true., is_shared=.true., also='surface side'), contact%set)
      call describe_field(visitor, friction_keys, contact%friction)
      call describe_field(visitor, bound_keys, contact%slip_bound)
      has_wear = contact%wear > 0.0_dp
      call visitor%real(key_t('wear', "with `&history`: Archard's coefficient, the depth worn per pressure and"// &
         ' slip, added to the gap after each step', 'L²/F', default='none', at_least=0.0_dp, &
         also='wear_coefficient archard'), contact%wear, has_wear)
      ! Describes the keys of a second deformable body.
      is_pair = contact%pairing%is_pair()
      has_gap = is_pair
      call visitor%text(key_t('against', 'the boundary set of another deformable body, the master, instead of'// &
         ' a rigid obstacle; `set` is the slave', default='none', is_filled=.true., is_shared=.true., &
         also='to master target'), contact%pairing%against, is_pair)
      call visitor%real(key_t('search', 'with `against`: how far the master may be along the normal of the slave,'// &
         ' either way', 'L', default='twice the longest side', above=0.0_dp, is_shared=.true.), &
         contact%pairing%search)
      call visitor%word(key_t('gap', 'with `against`: where gaps come from: from the meshes, or 0 wherever the'// &
         ' bodies face each other', default="`'mesh'`", is_shared=.true., also='adjust', &
         hint='a distance is extra_gap'), contact%pairing%gap, gap_names, has_gap)
      is_pair = contact%pairing%is_pair()
      ! Describes the keys of a rigid obstacle and of the gap to it.
      has_kind = .not. is_pair
      has_point = has_kind
      call visitor%word(key_t('obstacle', 'the rigid obstacle', also='kind type shape'), contact%obstacle%kind, &
         obstacle_names, has_kind)
      has_radius = contact%obstacle%has_radius()
      has_line = contact%obstacle%kind == 'polyline'
      has_file = contact%obstacle%kind == 'surface'
      has_normal = has_kind .and. .not. has_file
      call visitor%vector(key_t('point', 'a point of the obstacle: its apex; of a polyline or surface, where the'// &
         ' origin of its file is put', 'L', also='origin center centre apex'), contact%obstacle%point, has_point)
      associate (normal => contact%obstacle%normal)
         if (visitor%n_dim > 0 .and. .not. any(abs(normal) > 0.0_dp)) normal(visitor%n_dim) = 1.0_dp
      end associate
      call visitor%vector(key_t('normal', "direction of the obstacle's outward normal there, of any length, to"// &
         ' the body', is_nonzero=.true.), contact%obstacle%normal, has_normal)
      call visitor%real(key_t('radius', 'of a circle, parabola, sphere, cylinder or paraboloid, where it is'// &
         ' required: radius of curvature; positive bulges to the body, negative is hollow', 'L', is_nonzero=.true., &
         also='r'), contact%obstacle%radius, has_radius)
      has_axis = contact%obstacle%kind == 'cylinder'
      call visitor%reals(key_t('axis', 'of a cylinder, where it is required: direction of its axis, perpendicular'// &
         ' to `normal`, of any length', default='none', is_nonzero=.true.), contact%obstacle%axis, has_axis)
      call visitor%text(key_t('line', 'of a polyline, where it is required: file of its points', is_file=.true., &
         is_filled=.true.), contact%obstacle%file, has_line)
      call visitor%table('line', contact%obstacle%file, contact%obstacle%line)
      call visitor%text(key_t('file', 'of a surface, where it is required: its triangles, an STL file (text or'// &
         ' binary) or a Gmsh mesh', is_file=.true., is_filled=.true.), contact%obstacle%file, has_file)
      call visitor%text(key_t('part', 'of a surface in a Gmsh mesh: the physical surface that it is', &
         default='all triangles', is_filled=.true.), contact%obstacle%part)
      call visitor%list(key_t('inside', 'of a surface: a point in the rigid body, which tells its sides; without it'// &
         ' the corners of each triangle must be counterclockwise seen from outside', 'L'), contact%obstacle%inside)
      call read_surface(visitor, contact%obstacle)
      call visitor%vector(key_t('gap_direction', 'along which gaps are measured and closed, to the obstacle', &
         default="the body's normal", is_nonzero=.true., is_shared=.true.), contact%direction)
      call visitor%word(key_t('sliding', 'whether normals, gaps and partners stay those at rest, or are those at'// &
         ' the moved places', default="`'small'`", is_shared=.true.), contact%sliding, sliding_names)
      call describe_field(visitor, gap_keys, contact%extra_gap)
      call describe_multipliers(visitor, contact)
      call visitor%close_group()
      call visitor%locate('set', contact%origin)
      ! Judges the keys of a `&contact` together.
      if (.not. visitor%is_judging()) return
      if (contact%pairing%is_pair()) then
         call visitor%only('obstacle point normal radius axis line file part inside gap_direction', .false., &
            'a rigid obstacle, not with against')
         call visitor%require(contact%pairing%against /= contact%set, 'against', 'against must name another set'// &
            " than set; for self contact, split the set '"//contact%set//"' in two, the lips of a slit by "// &
            "NewPhysicalGroup of Gmsh's Plugin(Crack)")
      end if
      call visitor%only('search gap', contact%pairing%is_pair(), 'contact against another body')
      associate (obstacle => contact%obstacle)
         associate (n_dim => obstacle_dimensions(obstacle%kind))
            if (n_dim > 0) call visitor%state_dimensions(n_dim, 'obstacle', " = '"//trim(obstacle%kind)//"'")
         end associate
         call visitor%only('radius', obstacle%has_radius(), &
            "obstacle = 'circle', 'parabola', 'sphere', 'cylinder' or 'paraboloid'")
         call visitor%require(visitor%has('radius') .or. .not. obstacle%has_radius(), 'obstacle', &
            "obstacle = '"//trim(obstacle%kind)//"' needs radius")
         call visitor%only('axis', obstacle%kind == 'cylinder', "obstacle = 'cylinder'")
         call visitor%require(visitor%has('axis') .or. obstacle%kind /= 'cylinder', 'obstacle', &
            "obstacle = 'cylinder' needs axis, the direction of its axis")
         call visitor%require(.not. abs(dot_product(obstacle%axis, obstacle%outward(3))) &
            > input_rounding*norm2(obstacle%axis), 'axis', 'the axis of a cylinder must be perpendicular to its normal')
         call visitor%only('line', obstacle%kind == 'polyline', "obstacle = 'polyline'")
         call visitor%require(visitor%has('line') .or. obstacle%kind /= 'polyline', 'obstacle', &
            "obstacle = 'polyline' needs line = 'FILE.csv'")
         call visitor%only('file part inside', obstacle%kind == 'surface', "obstacle = 'surface'")
         call visitor%require(visitor%has('file') .or. obstacle%kind /= 'surface', 'obstacle', &
            "obstacle = 'surface' needs file = 'FILE.stl'")
         call visitor%only('normal', obstacle%kind /= 'surface', 'an obstacle without a file of triangles')
      end associate
      call judge_sliding(visitor, contact)
      call visitor%only('wear', visitor%deck%count_groups('history') > 0, 'a deck with &history')
   end subroutine describe_contact

   !> Describes the keys of a `&contact` on its multipliers.
   subroutine describe_multipliers(visitor, contact)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(contact_t), intent(inout) :: contact !! the contact set
      character(len(multiplier_names)) :: multipliers
      logical :: is_pair, is_given

      associate (partition => contact%partition)
         is_pair = contact%pairing%is_pair()
         ! In space multipliers that a deck does not state depend on the mesh.
         is_given = is_pair .or. visitor%n_dim /= 3 .or. partition%most_nodal /= usual_most_nodal
         multipliers = multiplier_names(merge(2, merge(3, 1, is_pair .or. partition%most_nodal < 0), &
            partition%is_constant))
         call visitor%word(key_t('multipliers', 'contact forces at the nodes, stresses that are constant on cells '// &
            'of the contact line, or mortar multipliers at the corners of the slave, in space of any set', &
            default='nodal; mortar with `against`, or on large quadratic sets', is_shared=.true.), multipliers, &
            multiplier_names, is_given)
         call visitor%require(.not. is_pair .or. multipliers /= multiplier_names(1), 'multipliers', &
            "multipliers must be 'mortar' or 'constant' with against")
         partition%is_constant = multipliers == multiplier_names(2)
         if (visitor%has('multipliers') .and. .not. is_pair) partition%most_nodal = merge(-1, huge(0), &
            multipliers == multiplier_names(3))
         if (partition%is_constant) call visitor%state_dimensions(2, 'multipliers', " = 'constant'")
         if (partition%most_nodal < 0) call visitor%state_dimensions(3, 'multipliers', " = 'mortar' without against")
         call visitor%whole(key_t('cells', "with `'constant'`: number of equal cells on each piece of the line", &
            default='every two sides', at_least=1.0_dp, is_shared=.true.), partition%n_cells)
         call visitor%list(key_t('cell_ends', "with `'constant'`, instead of `cells`: lengths along the line (of "// &
            'one piece) where one cell ends and the next begins', 'L', above=0.0_dp, is_ascending=.true., &
            is_shared=.true.), partition%ends)
         call visitor%only('cells cell_ends', partition%is_constant, "multipliers = 'constant'")
         call visitor%require(.not. (visitor%has('cells') .and. visitor%has('cell_ends')), 'cell_ends', &
            'give either cells or cell_ends')
      end associate
   end subroutine describe_multipliers

   !> Judges what does not go with contact that slides far.
   subroutine judge_sliding(visitor, contact)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(contact_t), intent(in) :: contact !! the contact set

      if (.not. contact%slides_far()) return
      call visitor%require(.not. (contact%partition%is_constant .or. contact%partition%most_nodal < 0 .or. &
         visitor%has('gap_direction') .or. contact%pairing%gap == gap_names(2)), 'sliding', &
         "sliding = 'finite' does not go with constant multipliers, gap_direction or gap = 'touching', nor with "// &
         "'mortar' without against")
      call visitor%require(visitor%deck%count_groups('sweep') == 0, 'sliding', &
         "sliding = 'finite' does not go with &sweep: a history takes the way in steps")
   end subroutine judge_sliding

   !> Reads the triangles of an obstacle.
   subroutine read_surface(visitor, obstacle)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(obstacle_t), intent(inout) :: obstacle !! the obstacle
      type(error_t), allocatable :: error
      real(dp), allocatable :: place(:, :), inside(:)

      if (.not. (obstacle%kind == 'surface' .and. visitor%has('file') .and. is_filled(obstacle%file))) return
      if (visitor%has('inside')) then
         call visitor%require(size(obstacle%inside) == 3, 'inside', 'inside must have three numbers')
         if (size(obstacle%inside) /= 3) return
         inside = obstacle%inside - obstacle%point
      end if
      call read_surface_file(place, obstacle%file, obstacle%part, error)
      if (.not. allocated(error)) then
         call new_triangulation(obstacle%surface, place, error, inside)
         if (allocated(error)) error%message = obstacle%file//': '//error%message
      end if
      if (allocated(error)) call visitor%require(.false., 'file', 'file: '//error%message)
   end subroutine read_surface

   !> Describes one `&tie`.
   subroutine describe_tie(visitor, tie)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(tie_t), intent(inout) :: tie !! the tie

      call visitor%open_group(tie_group)
      call visitor%text(key_t('name', 'name of its forces', default='that of its set', is_filled=.true., &
         also='label'), tie%name)
      call visitor%text(key_t('set', 'the boundary set that is bonded, the slave', is_filled=.true., &
         is_required=.true., also='slave surface'), tie%set)
      call visitor%text(key_t('to', 'the boundary set of the body that it is bonded to, the master', is_filled=.true., &
         is_required=.true., also='against master target'), tie%to)
      call visitor%real(key_t('search', 'how far the master may be along the normal of the slave, either way', 'L', &
         default='twice the longest side', above=0.0_dp), tie%search)
      call visitor%close_group()
      call visitor%locate('set', tie%origin)
      if (visitor%is_judging()) call visitor%require(tie%to /= tie%set, 'to', 'to must name another set than set')
   end subroutine describe_tie

   !> Describes the keys of a quantity along the line.
   subroutine describe_field(visitor, keys, field)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(key_t), intent(in) :: keys(3) !! keys of its value, slope and table
      type(line_field_t), intent(inout) :: field !! the quantity
      type(key_t) :: value_key

      value_key = keys(1)
      ! Where a slope may raise it, it is measured at the contact points.
      if (visitor%has(keys(2)%name)) value_key%at_least = -huge(1.0_dp)
      call visitor%real(value_key, field%value)
      call visitor%vector(keys(2), field%slope)
      call visitor%text(keys(3), field%file)
      call visitor%state_dimensions(2, trim(keys(3)%name))
      call visitor%table(trim(keys(3)%name), field%file, field%table, station='length', least=keys(1)%at_least)
      if (allocated(field%table)) call visitor%require(.not. any(abs([field%value, field%slope]) > 0.0_dp), &
         trim(keys(3)%name), 'give either '//trim(keys(1)%name)//' and '//trim(keys(2)%name)//', or '// &
         trim(keys(3)%name))
   end subroutine describe_field

end module amontons_config_groups
