!> The configuration of a case: what a deck says, checked, with every default in place.
module amontons_config
   use amontons_constraints, only: support_t
   use amontons_contact_zone, only: contact_t
   use amontons_deck, only: deck_t, read_deck
   use amontons_element, only: element_names
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_nodes, load_on_region, load_on_sides, load_t
   use amontons_material, only: hypothesis_names, material_t, new_material
   use amontons_methods, only: method_names, method_options_t
   use amontons_psor, only: space_names
   use amontons_rectangle, only: diagonal_names, rectangle_t
   use amontons_splitting, only: variant_names
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: config_t, factorization_names, read_config

   !> Factorisations, as a deck writes them.
   character(6), parameter :: factorization_names(3) = [character(6) :: 'auto', 'band', 'sparse']
   !> Groups of a deck.
   character(8), parameter :: group_names(*) = [character(8) :: 'case', 'mesh', 'material', 'support', 'load', &
      'contact', 'solver', 'output']
   !> Groups that may stand more than once.
   character(8), parameter :: repeatable_names(*) = [character(8) :: 'material', 'support', 'load', 'contact']

   !> Everything that defines a case.
   type :: config_t
      character(:), allocatable :: file !! name of the deck
      character(:), allocatable :: name !! name of the case, and of its files
      character(:), allocatable :: title !! what the case is about, for the listing
      type(rectangle_t) :: rectangle !! the body
      type(material_t), allocatable :: materials(:) !! its materials
      type(support_t), allocatable :: supports(:) !! its supports
      type(load_t), allocatable :: loads(:) !! its loads
      type(contact_t), allocatable :: contacts(:) !! its contact sets
      type(method_options_t) :: method !! the contact method
      character(:), allocatable :: factorization !! one of `factorization_names`
   end type config_t

contains

   !> Reads a case from a deck. All faults of the deck are told in one error, one line each; what a group means is
   !> judged only where its form is right.
   subroutine read_config(config, file, error)
      type(config_t), intent(out) :: config !! the case
      character(*), intent(in) :: file !! name of the deck
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      type(deck_t) :: deck

      call read_deck(deck, file, error)
      if (allocated(error)) return
      config%file = file
      if (deck%n_faults() > 0) then
         call deck%finish(error)
         return
      end if
      call deck%refuse_unknown_groups(group_names, repeatable_names)
      call read_case(config, deck)
      call read_mesh(config%rectangle, deck)
      call read_materials(config%materials, deck)
      call read_supports(config%supports, deck)
      call read_loads(config%loads, deck)
      call read_contacts(config%contacts, deck)
      call read_solver(config, deck)
      call deck%refuse_unknown(deck%group('output'))
      call deck%finish(error)
   end subroutine read_config

   !> Reads `&case`: name and title.
   subroutine read_case(config, deck)
      type(config_t), intent(inout) :: config !! the case
      type(deck_t), intent(inout) :: deck !! the deck
      integer :: group, last_slash, last_point

      group = deck%group('case')
      last_slash = index(config%file, '/', back=.true.)
      config%name = config%file(last_slash + 1:)
      last_point = index(config%name, '.', back=.true.)
      if (last_point > 1) config%name = config%name(:last_point - 1)
      config%title = ''
      call deck%get(group, 'name', config%name)
      call deck%get(group, 'title', config%title)
      if (len_trim(config%name) == 0 .or. has_unusable_character(config%name)) call deck%fault(group, 'name', &
         "name must be usable as a file name: not empty, without '/' and control characters")
      call deck%refuse_unknown(group)
   end subroutine read_case

   !> Whether a name has a character that file names or decks cannot have.
   pure logical function has_unusable_character(name)
      character(*), intent(in) :: name !! the name
      character, parameter :: blank = ' '
      integer :: i

      has_unusable_character = any([(name(i:i) < blank .or. name(i:i) == '/', i=1, len(name))])
   end function has_unusable_character

   !> Reads `&mesh`: the rectangle and its cells.
   subroutine read_mesh(rectangle, deck)
      type(rectangle_t), intent(inout) :: rectangle !! the rectangle
      type(deck_t), intent(inout) :: deck !! the deck
      character(:), allocatable :: kind
      integer :: group, n_faults
      logical :: has_size, has_cells

      group = deck%group('mesh')
      ! A group that is missing may be the one whose name is a fault already.
      n_faults = merge(0, deck%n_faults(), group == 0)
      kind = 'rectangle'
      rectangle%size = 0.0_dp
      rectangle%cells = 0
      rectangle%element = 'quad4'
      rectangle%diagonal = 'right'
      call deck%get_word(group, 'kind', kind, ['rectangle'])
      call deck%get(group, 'size', rectangle%size, has_size)
      call deck%get(group, 'cells', rectangle%cells, has_cells)
      call deck%get_word(group, 'element', rectangle%element, element_names)
      call deck%get_word(group, 'diagonal', rectangle%diagonal, diagonal_names)
      call deck%get(group, 'grading', rectangle%grading)
      call deck%refuse_unknown(group)
      if (deck%n_faults() > n_faults) return
      if (.not. (has_size .and. has_cells)) call deck%fault(group, 'kind', '&mesh needs size and cells')
      call require(deck, group, 'size', all(rectangle%size > 0.0_dp), 'be positive')
      call require(deck, group, 'cells', all(rectangle%cells > 0), 'be positive')
      call require(deck, group, 'grading', rectangle%grading > 0.0_dp, 'be positive')
   end subroutine read_mesh

   !> Records a fault unless a value is as it must be.
   subroutine require(deck, group, key, is_right, rule)
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key
      logical, intent(in) :: is_right !! whether the value is as it must be
      character(*), intent(in) :: rule !! what it must do, for the message: 'be positive'

      if (.not. is_right) call deck%fault(group, key, key//' must '//rule)
   end subroutine require

   !> Reads all `&material`.
   subroutine read_materials(materials, deck)
      type(material_t), allocatable, intent(out) :: materials(:) !! the materials
      type(deck_t), intent(inout) :: deck !! the deck
      integer, allocatable :: groups(:)
      integer :: i

      groups = deck%groups('material')
      if (size(groups) == 0 .and. deck%n_faults() == 0) call deck%fault(0, '', '&material needs young and poisson')
      allocate (materials(size(groups)))
      do i = 1, size(groups)
         call read_material(materials(i), deck, groups(i))
      end do
   end subroutine read_materials

   !> Reads one `&material`.
   subroutine read_material(material, deck, group)
      type(material_t), intent(inout) :: material !! the material
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      type(error_t), allocatable :: error
      real(dp) :: young, poisson, thickness
      character(:), allocatable :: hypothesis, region
      integer :: n_faults
      logical :: has_young, has_poisson

      n_faults = deck%n_faults()
      young = 1.0_dp
      poisson = 0.0_dp
      thickness = 1.0_dp
      hypothesis = trim(hypothesis_names(1))
      region = ''
      call deck%get(group, 'young', young, has_young)
      call deck%get(group, 'poisson', poisson, has_poisson)
      call deck%get(group, 'thickness', thickness)
      call deck%get_word(group, 'hypothesis', hypothesis, hypothesis_names)
      call deck%get(group, 'region', region)
      call deck%refuse_unknown(group)
      if (deck%n_faults() > n_faults) return
      if (.not. (has_young .and. has_poisson)) call deck%fault(group, 'young', '&material needs young and poisson')
      call new_material(material, young, poisson, hypothesis, thickness, error)
      ! The message begins with the key that is at fault.
      if (allocated(error)) call deck%fault(group, error%message(:index(error%message, ' ') - 1), error%message)
      if (allocated(error)) return
      material%region = region
      material%origin = origin_of(deck, group, 'region')
   end subroutine read_material

   !> Reads all `&support`.
   subroutine read_supports(supports, deck)
      type(support_t), allocatable, intent(out) :: supports(:) !! the supports
      type(deck_t), intent(inout) :: deck !! the deck
      character(2), parameter :: keys(4) = ['ux', 'uy', 'un', 'ut']
      integer, allocatable :: groups(:)
      logical :: has_set, has_point, has_spring(2)
      integer :: i, k, n_faults

      groups = deck%groups('support')
      allocate (supports(size(groups)))
      do i = 1, size(groups)
         n_faults = deck%n_faults()
         supports(i)%set = ''
         supports(i)%origin = origin_of(deck, groups(i), 'set')
         call deck%get(groups(i), 'set', supports(i)%set, has_set)
         call deck%get(groups(i), 'point', supports(i)%point, has_point)
         do k = 1, 4
            call deck%get(groups(i), keys(k), supports(i)%displacement(k), supports(i)%is_held(k))
         end do
         call deck%get(groups(i), 'spring_n', supports(i)%spring(1), has_spring(1))
         call deck%get(groups(i), 'spring_t', supports(i)%spring(2), has_spring(2))
         call deck%refuse_unknown(groups(i))
         if (deck%n_faults() > n_faults) cycle
         call require(deck, groups(i), 'set', has_set .neqv. has_point, 'be given, or else point')
         call require(deck, groups(i), 'set', .not. has_set .or. len_trim(supports(i)%set) > 0, 'not be empty')
         call require(deck, groups(i), 'ux', any(supports(i)%is_held) .or. any(has_spring), &
            'be given, or uy, un, ut, spring_n or spring_t')
         call require(deck, groups(i), 'point', .not. (has_point .and. (any(has_spring) .or. &
            any(supports(i)%is_held(3:)))), 'not go with un, ut or springs: a point has no normal')
         call require(deck, groups(i), 'spring_n', supports(i)%spring(1) >= 0.0_dp, 'be at least 0')
         call require(deck, groups(i), 'spring_t', supports(i)%spring(2) >= 0.0_dp, 'be at least 0')
      end do
   end subroutine read_supports

   !> Reads all `&load`.
   subroutine read_loads(loads, deck)
      type(load_t), allocatable, intent(out) :: loads(:) !! the loads
      type(deck_t), intent(inout) :: deck !! the deck
      integer, allocatable :: groups(:)
      integer :: i

      groups = deck%groups('load')
      allocate (loads(size(groups)))
      do i = 1, size(groups)
         call read_load(loads(i), deck, groups(i))
      end do
   end subroutine read_loads

   !> Reads one `&load`: on the sides of a set, on nodes, or on a region.
   subroutine read_load(load, deck, group)
      type(load_t), intent(inout) :: load !! the load
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      real(dp) :: slopes(4)
      logical :: has_set, has_point, has_region, on_sides(4), on_nodes, on_region
      integer :: n_faults

      n_faults = deck%n_faults()
      slopes = 0.0_dp
      load%set = ''
      load%region = ''
      load%origin = origin_of(deck, group, 'set')
      call deck%get(group, 'set', load%set, has_set)
      call deck%get(group, 'point', load%point, has_point)
      call deck%get(group, 'region', load%region, has_region)
      call deck%get(group, 'traction', load%traction, on_sides(1))
      call deck%get(group, 'traction_slope', slopes, on_sides(2))
      call deck%get(group, 'pressure', load%pressure, on_sides(3))
      call deck%get(group, 'pressure_slope', load%pressure_slope, on_sides(4))
      call deck%get(group, 'force', load%force, on_nodes)
      call deck%get(group, 'body_force', load%body_force, on_region)
      load%traction_slope = reshape(slopes, [2, 2])
      call deck%refuse_unknown(group)
      if (deck%n_faults() > n_faults) return
      load%target = load_on_sides
      if (on_nodes) load%target = load_on_nodes
      if (on_region) load%target = load_on_region
      call require(deck, group, 'traction', count([any(on_sides), on_nodes, on_region]) == 1, &
         'be given, or pressure, force or body_force; different kinds stand in groups of their own')
      if (deck%n_faults() > n_faults) return
      call require(deck, group, 'set', has_set .or. .not. any(on_sides), 'name the side that traction or pressure act on')
      call require(deck, group, 'force', .not. on_nodes .or. (has_set .neqv. has_point), 'go with either set or point')
      call require(deck, group, 'point', on_nodes .or. .not. has_point, 'go with force')
      call require(deck, group, 'region', on_region .or. .not. has_region, 'go with body_force')
      call require(deck, group, 'body_force', .not. (on_region .and. has_set), &
         'not go with set: it acts on a region, or on the whole body')
      call require(deck, group, 'set', .not. has_set .or. len_trim(load%set) > 0, 'not be empty')
   end subroutine read_load

   !> Reads all `&contact`.
   subroutine read_contacts(contacts, deck)
      type(contact_t), allocatable, intent(out) :: contacts(:) !! the contact sets
      type(deck_t), intent(inout) :: deck !! the deck
      character(:), allocatable :: obstacle
      integer, allocatable :: groups(:)
      integer :: i, n_faults

      groups = deck%groups('contact')
      allocate (contacts(size(groups)))
      do i = 1, size(groups)
         n_faults = deck%n_faults()
         contacts(i)%set = ''
         contacts(i)%origin = origin_of(deck, groups(i), 'set')
         obstacle = 'plane'
         call deck%get(groups(i), 'set', contacts(i)%set)
         call deck%get(groups(i), 'friction', contacts(i)%friction)
         call deck%get_word(groups(i), 'obstacle', obstacle, ['plane'])
         call deck%get(groups(i), 'point', contacts(i)%point)
         call deck%get(groups(i), 'normal', contacts(i)%normal)
         call deck%refuse_unknown(groups(i))
         if (deck%n_faults() > n_faults) cycle
         if (len_trim(contacts(i)%set) == 0) call deck%fault(groups(i), 'set', '&contact needs a set')
         call require(deck, groups(i), 'friction', contacts(i)%friction >= 0.0_dp, &
            'be at least 0, found '//to_text(contacts(i)%friction))
         call require(deck, groups(i), 'normal', norm2(contacts(i)%normal) > 0.0_dp, 'not be zero')
      end do
   end subroutine read_contacts

   !> Reads `&solver`: method, its options, factorisation.
   subroutine read_solver(config, deck)
      type(config_t), intent(inout) :: config !! the case
      type(deck_t), intent(inout) :: deck !! the deck
      integer :: group, n_faults

      n_faults = deck%n_faults()
      group = deck%group('solver')
      config%factorization = trim(factorization_names(1))
      associate (method => config%method)
         method%method = trim(method_names(1))
         method%variant = trim(variant_names(1))
         method%space = trim(space_names(1))
         call deck%get_word(group, 'method', method%method, method_names)
         call deck%get_word(group, 'variant', method%variant, variant_names)
         call deck%get_word(group, 'space', method%space, space_names)
         call deck%get(group, 'omega', method%omega)
         call deck%get(group, 'tolerance', method%tolerance)
         call deck%get(group, 'max_iterations', method%max_iterations)
         call deck%get_word(group, 'factorization', config%factorization, factorization_names)
         call deck%refuse_unknown(group)
         if (deck%n_faults() > n_faults) return
         call require(deck, group, 'omega', method%omega > 0.0_dp .and. method%omega < 2.0_dp, &
            'lie above 0 and below 2, found '//to_text(method%omega))
         call require(deck, group, 'tolerance', method%tolerance > 0.0_dp .and. method%tolerance < 1.0_dp, &
            'lie above 0 and below 1, found '//to_text(method%tolerance))
         call require(deck, group, 'max_iterations', method%max_iterations > 0, 'be at least 1, found '// &
            to_text(method%max_iterations))
      end associate
   end subroutine read_solver

   !> Where a key of a group stands, as messages begin: 'deck.nml:12: '.
   function origin_of(deck, group, key) result(origin)
      type(deck_t), intent(in) :: deck !! the deck
      integer, intent(in) :: group !! the group
      character(*), intent(in) :: key !! the key
      character(:), allocatable :: origin

      origin = deck%file//':'//to_text(deck%line_of(group, key))//': '
   end function origin_of

end module amontons_config
