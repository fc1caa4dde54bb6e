!> What a deck may hold: every group and every key, with its values, unit, default and meaning.
!>
!> The readers of the groups take their values in their own words; tests/app/test_reference.py holds them against this
!> table, key by key, word by word and default by default.
module amontons_deck_reference
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_text, only: lower_case, nearest_word, newline
   implicit none (type, external)
   private

   public :: group_names, reference_text, repeatable_names

   !> Groups of a deck.
   character(8), parameter :: group_names(*) = [character(8) :: 'case', 'problem', 'mesh', 'material', 'support', &
      'load', 'contact', 'sweep', 'solver', 'output']
   !> Groups that may stand more than once.
   character(8), parameter :: repeatable_names(*) = [character(8) :: 'material', 'support', 'load', 'contact', 'sweep']

   !> A key of a group, described in Markdown.
   type :: key_t
      character(8) :: group !! name of the group
      character(16) :: name !! name of the key
      logical :: is_required !! whether the group must have it
      character(110) :: values !! number and type of its values, and what they must obey; or the words it takes
      character(6) :: unit !! unit of the values
      character(70) :: default !! what holds where the key is absent; in backquotes where a deck could say it
      character(190) :: meaning !! what it says
   end type key_t

   !> Keys of a case and of its mesh.
   type(key_t), parameter :: mesh_keys(*) = [ &
      key_t('case', 'name', .false., 'text', '', "name of the deck's file without its folder and last extension", &
      'name of the case and of its files; 1 to 200 characters, without `/`'), &
      key_t('case', 'title', .false., 'text', '', "`''`", 'what the case is about, for the listing'), &
      key_t('problem', 'kind', .false., "`'body'`, `'reduced'`", '', "`'body'`", &
      'a body, described by the groups below; or a reduced problem from a file'), &
      key_t('problem', 'file', .false., 'text', '', '', &
      "with `kind = 'reduced'`: name of its file, seen from the deck's folder"), &
      key_t('problem', 'friction', .false., 'number, at least 0', '', "the file's", &
      "with `kind = 'reduced'`: Coulomb's coefficient of all contacts, in the place of the file's"), &
      key_t('mesh', 'kind', .false., "`'rectangle'`, `'file'`", '', "`'rectangle'`", 'where the mesh comes from'), &
      key_t('mesh', 'file', .false., 'text', '', '', &
      "with `kind = 'file'`, where it is required: name of the mesh file, seen from the deck's folder"), &
      key_t('mesh', 'size', .true., '2 numbers above 0', 'L', '', 'of the rectangle: width and height'), &
      key_t('mesh', 'cells', .true., '2 whole numbers, at least 1', '', '', &
      'of the rectangle: number of cells along x and y'), &
      key_t('mesh', 'element', .false., "`'tri3'`, `'quad4'`, `'tri6'`, `'quad8'`, `'quad9'`", '', "`'quad4'`", &
      'a quadrilateral, or two triangles in each cell; linear or quadratic'), &
      key_t('mesh', 'diagonal', .false., "`'right'`, `'left'`, `'alternating'`", '', "`'right'`", &
      'how triangles halve a cell: `/`, `\`, or by turns; no effect on quadrilaterals'), &
      key_t('mesh', 'grading', .false., 'number above 0', '', '`1.0`', 'height of the top row of cells over that of'// &
      ' the bottom row; the rows between follow a geometric series')]

   !> Keys of materials and supports.
   type(key_t), parameter :: body_keys(*) = [ &
      key_t('material', 'young', .true., 'number above 0', 'F/L²', '', "Young's modulus"), &
      key_t('material', 'poisson', .true., 'number above -1 and below 0.5', '', '', "Poisson's ratio"), &
      key_t('material', 'thickness', .false., 'number above 0', 'L', '`1.0`', &
      'thickness of a plane body; it multiplies stiffness and loads, so that forces are in [F]'), &
      key_t('material', 'hypothesis', .false., "`'plane strain'`, `'plane stress'`, `'axisymmetric'`", '', &
      "`'plane strain'`", 'how the body is reduced to the plane; the same for all materials'), &
      key_t('material', 'region', .false., 'text', '', 'all the rest', &
      'the region of the mesh that the material fills'), &
      key_t('support', 'set', .false., 'text', '', '', 'the nodes of a boundary set; this or `point` is required'), &
      key_t('support', 'point', .false., '2 numbers', 'L', '', 'the node at these coordinates'), &
      key_t('support', 'ux', .false., 'number', 'L', 'free', 'prescribed displacement along x'), &
      key_t('support', 'uy', .false., 'number', 'L', 'free', 'prescribed displacement along y'), &
      key_t('support', 'un', .false., 'number', 'L', 'free', &
      'prescribed displacement along the outward normal; with `set` only'), &
      key_t('support', 'ut', .false., 'number', 'L', 'free', &
      'prescribed displacement along the tangent; with `set` only'), &
      key_t('support', 'spring_n', .false., 'number, at least 0', 'F/L³', '`0.0`', &
      'elastic foundation: stress per displacement along the normal; with `set` only'), &
      key_t('support', 'spring_t', .false., 'number, at least 0', 'F/L³', '`0.0`', &
      'elastic foundation: stress per displacement along the tangent; with `set` only')]

   !> Keys of loads.
   type(key_t), parameter :: load_keys(*) = [ &
      key_t('load', 'name', .false., 'text', '', 'none', &
      'by which a `&sweep` knows it; several loads may share a name'), &
      key_t('load', 'set', .false., 'text', '', '', &
      'the boundary set of a traction or pressure; the node set or boundary set of point forces'), &
      key_t('load', 'point', .false., '2 numbers', 'L', '', 'coordinates of the node of a `force`'), &
      key_t('load', 'region', .false., 'text', '', 'the whole body', 'the region of a `body_force`'), &
      key_t('load', 'traction', .false., '2 numbers', 'F/L²', '`0.0, 0.0`', &
      'force per area along x and y, at the origin of the coordinates'), &
      key_t('load', 'traction_slope', .false., '4 numbers', 'F/L³', '`0.0, 0.0, 0.0, 0.0`', 'its change: of the'// &
      ' x component along x, of the y component along x, of the x component along y, of the y component along y'), &
      key_t('load', 'pressure', .false., 'number', 'F/L²', '`0.0`', &
      'force per area against the outward normal, at the origin: a positive one presses on the body'), &
      key_t('load', 'pressure_slope', .false., '2 numbers', 'F/L³', '`0.0, 0.0`', 'its change along x and y'), &
      key_t('load', 'force', .false., '2 numbers', 'F', '', &
      'a force on the node at `point`, or on every node of `set`'), &
      key_t('load', 'body_force', .false., '2 numbers', 'F/L³', '', &
      'force per volume, on `region` or on the whole body')]

   !> Keys of contact sets.
   type(key_t), parameter :: contact_keys(*) = [ &
      key_t('contact', 'set', .true., 'text', '', '', 'the boundary set that may touch the obstacle'), &
      key_t('contact', 'friction', .false., 'number, at least 0', '', '`0.0`', &
      "Coulomb's coefficient; 0 is frictionless contact"), &
      key_t('contact', 'friction_slope', .false., '2 numbers', '1/L', '`0.0, 0.0`', &
      'change of the coefficient along x and y; `friction` is then its value at the origin'), &
      key_t('contact', 'friction_table', .false., 'text', '', '', &
      'file with the coefficient over the length of the contact line, instead'), &
      key_t('contact', 'slip_bound', .false., 'number, at least 0', 'F/L²', '`0.0`', &
      'given bound of the shear stress (Tresca friction)'), &
      key_t('contact', 'slip_bound_slope', .false., '2 numbers', 'F/L³', '`0.0, 0.0`', &
      'change of the bound along x and y; `slip_bound` is then its value at the origin'), &
      key_t('contact', 'slip_bound_table', .false., 'text', '', '', &
      'file with the bound over the length of the contact line, instead'), &
      key_t('contact', 'obstacle', .false., "`'plane'`, `'circle'`, `'parabola'`, `'polyline'`", '', "`'plane'`", &
      'the rigid obstacle'), &
      key_t('contact', 'point', .false., '2 numbers', 'L', '`0.0, 0.0`', &
      'a point of the obstacle: its apex; of a polyline, where its 0, 0 is put'), &
      key_t('contact', 'normal', .false., '2 numbers, not both 0', '', '`0.0, 1.0`', &
      "direction of the obstacle's outward normal there, of any length, to the body"), &
      key_t('contact', 'radius', .false., 'number, not 0', 'L', '', 'of a circle or parabola, where it is required:'// &
      ' radius of curvature; positive bulges to the body, negative is hollow'), &
      key_t('contact', 'line', .false., 'text', '', '', 'of a polyline, where it is required: file of its points'), &
      key_t('contact', 'gap_direction', .false., '2 numbers, not both 0', '', "the body's normal", &
      'along which gaps are measured and closed, to the obstacle'), &
      key_t('contact', 'extra_gap', .false., 'number', 'L', '`0.0`', &
      'added to every gap; negative for an interference'), &
      key_t('contact', 'multipliers', .false., "`'nodal'`, `'constant'`", '', "`'nodal'`", &
      'contact forces at the nodes, or stresses that are constant on cells of the contact line'), &
      key_t('contact', 'cells', .false., 'whole number, at least 1', '', 'every two sides', &
      "with `'constant'`: number of equal cells on each piece of the line"), &
      key_t('contact', 'cell_ends', .false., 'numbers above 0, ascending', 'L', '', &
      "with `'constant'`, instead of `cells`: lengths along the line (of one piece) where one cell ends and the "// &
      'next begins')]

   !> Keys of sweeps, of the solver and of what is written.
   type(key_t), parameter :: solver_keys(*) = [ &
      key_t('sweep', 'load', .false., 'text', '', '', &
      'with `factor`, where it is required: the name of the load'), &
      key_t('sweep', 'contact', .false., 'text', '', 'all', &
      'with `friction` or `friction_factor`: the `set` of the `&contact`'), &
      key_t('sweep', 'factor', .false., 'numbers', '', '', 'what the loads of that name are multiplied by'), &
      key_t('sweep', 'friction', .false., 'numbers, at least 0', '', '', &
      "Coulomb's coefficient, in the place of the key `friction` of `&contact` (a `friction_slope` stays)"), &
      key_t('sweep', 'friction_factor', .false., 'numbers, at least 0', '', '', &
      'what the friction of `&contact` is multiplied by, slope and table included'), &
      key_t('sweep', 'count', .false., 'whole number, at least 2', '', '', &
      'the two numbers given are the first and the last of so many, in equal steps'), &
      key_t('sweep', 'combine', .false., "`'product'`, `'paired'`", '', "`'product'`", &
      'every value with every combination of the groups'// &
      ' before, or value by value along with the group before'), &
      key_t('solver', 'method', .false., &
      "`'auto'`, `'newton'`, `'splitting'`, `'fixed_point'`, `'psor'`, `'extragradient'`, `'lemke'`", '', &
      "`'auto'`", 'the contact method'), &
      key_t('solver', 'variant', .false., "`'exact'`, `'clip'`, `'printed'`", '', "`'exact'`", &
      'of `splitting`: how half steps are done; only `exact` is right in general'), &
      key_t('solver', 'space', .false., "`'dual'`, `'primal'`", '', "`'dual'`", &
      'of `psor`: sweep in the forces or in the displacements'), &
      key_t('solver', 'omega', .false., 'number above 0 and below 2', '', '`1.0`', 'of `psor`: relaxation'), &
      key_t('solver', 'local', .false., "`'point'`, `'block'`", '', "`'point'`", &
      'of `psor`: a point component by component, or both components at once, exactly'), &
      key_t('solver', 'acceleration', .false., "`'none'`, `'aitken'`, `'anderson'`", '', "`'none'`", &
      'of `psor`: extrapolate the sweeps; what would raise the residual is dropped'), &
      key_t('solver', 'box', .false., "`'auto'`, `'newton'`, `'mprgp'`", '', "`'auto'`", &
      'of `splitting` and `fixed_point`: solver of the quadratic programs: projected Newton (active sets), or'// &
      ' MPRGP, which needs products only; `auto` is the first unless A is sparse'), &
      key_t('solver', 'tolerance', .false., 'number above 0 and below 1', '', '`1.0e-10`', &
      'residual that counts as solved, free of units'), &
      key_t('solver', 'max_iterations', .false., 'whole number, at least 1', '', '`1000`', &
      'most iterations, of all stages together with `auto`'), &
      key_t('solver', 'factorization', .false., "`'auto'`, `'band'`, `'sparse'`, `'substructured'`", '', "`'auto'`", &
      'Cholesky factorisation of the stiffness: band matrix, sparse matrix, condensation of the body piece by piece'// &
      ' on all threads, or the one that should be quickest'), &
      key_t('solver', 'condensation', .false., "`'auto'`, `'dense'`, `'band'`", '', "`'auto'`", &
      'form of the stiffness of the contact points: a dense matrix, or a band matrix of the whole body, which is'// &
      ' quicker for long contact lines of slender bodies'), &
      key_t('output', 'fields_every', .false., 'whole number, at least 1', '', 'none', &
      'with `&sweep`: the fields of case 1 and of every so-many-th case behind it are written as `.vtu`')]

   !> All keys, group by group in the order of `group_names`.
   type(key_t), parameter :: all_keys(*) = [mesh_keys, body_keys, load_keys, contact_keys, solver_keys]

contains

   !> The reference of a group as Markdown; of all groups where the name is empty.
   pure subroutine reference_text(name, text, error)
      character(*), intent(in) :: name !! name of the group, with or without `&`, in upper or lower case; or empty
      character(:), allocatable, intent(out) :: text !! the reference, its last line not ended
      type(error_t), allocatable, intent(out) :: error !! there is no such group
      character(:), allocatable :: wanted
      integer :: i

      wanted = lower_case(name)
      if (index(wanted, '&') == 1) wanted = wanted(2:)
      text = ''
      do i = 1, size(group_names)
         if (len(wanted) > 0 .and. group_names(i) /= wanted) cycle
         if (len(text) > 0) text = text//newline//newline
         text = text//group_text(group_names(i))
      end do
      if (len(text) > 0) return
      text = nearest_word(wanted, group_names)
      if (len(text) > 0) text = '; did you mean &'//text//'?'
      call new_error(error, input_refused, '&'//wanted//' is not a group of a deck'//text)
   end subroutine reference_text

   !> Heading and table of one group.
   pure function group_text(group) result(text)
      character(*), intent(in) :: group !! name of the group
      character(:), allocatable :: text
      integer :: i

      text = '### `&'//trim(group)//'`'
      if (any(repeatable_names == group)) text = text//' (may be repeated)'
      text = text//newline//newline
      text = text//'| key | value | unit | default | meaning |'//newline//'|---|---|---|---|---|'
      do i = 1, size(all_keys)
         if (all_keys(i)%group == group) text = text//newline//row_text(all_keys(i))
      end do
   end function group_text

   !> The row of one key.
   pure function row_text(key) result(text)
      type(key_t), intent(in) :: key !! the key
      character(:), allocatable :: text

      text = '`'//trim(key%name)//'`'
      if (key%is_required) text = '**'//text//'**'
      text = '| '//text//' | '//trim(key%values)//' |'//cell(key%unit)//cell(key%default)//' '//trim(key%meaning)//' |'
   end function row_text

   !> A cell that may be empty, its right border included.
   pure function cell(content) result(text)
      character(*), intent(in) :: content !! what stands in it, blank padded
      character(:), allocatable :: text

      text = ' '
      if (len_trim(content) > 0) text = text//trim(content)//' '
      text = text//'|'
   end function cell

end module amontons_deck_reference
