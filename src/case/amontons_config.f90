!> The configuration of a case: what a deck says, checked, with every default in place.
module amontons_config
   use amontons_constraints, only: support_t
   use amontons_contact_zone, only: contact_t
   use amontons_deck, only: deck_t, read_deck
   use amontons_element, only: element_names
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t
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
   character(8), parameter :: repeatable_names(3) = [character(8) :: 'support', 'load', 'contact']

   !> Everything that defines a case.
   type :: config_t
      character(:), allocatable :: file !! name of the deck
      character(:), allocatable :: name !! name of the case, and of its files
      character(:), allocatable :: title !! what the case is about, for the listing
      type(rectangle_t) :: rectangle !! the body
      type(material_t) :: material !! its material
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
      call read_material(config%material, deck)
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
      call require(deck, group, 'size', .not. has_size .or. all(rectangle%size > 0.0_dp), 'be positive')
      call require(deck, group, 'cells', .not. has_cells .or. all(rectangle%cells > 0), 'be positive')
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

   !> Reads `&material`.
   subroutine read_material(material, deck)
      type(material_t), intent(inout) :: material !! the material
      type(deck_t), intent(inout) :: deck !! the deck
      type(error_t), allocatable :: error
      real(dp) :: young, poisson, thickness
      character(:), allocatable :: hypothesis
      integer :: group, n_faults
      logical :: has_young, has_poisson

      group = deck%group('material')
      ! A group that is missing may be the one whose name is a fault already.
      n_faults = merge(0, deck%n_faults(), group == 0)
      young = 1.0_dp
      poisson = 0.0_dp
      thickness = 1.0_dp
      hypothesis = trim(hypothesis_names(1))
      call deck%get(group, 'young', young, has_young)
      call deck%get(group, 'poisson', poisson, has_poisson)
      call deck%get(group, 'thickness', thickness)
      call deck%get_word(group, 'hypothesis', hypothesis, hypothesis_names)
      call deck%refuse_unknown(group)
      if (deck%n_faults() > n_faults) return
      if (.not. (has_young .and. has_poisson)) call deck%fault(group, 'young', '&material needs young and poisson')
      call new_material(material, young, poisson, hypothesis, thickness, error)
      ! The message begins with the key that is at fault.
      if (allocated(error)) call deck%fault(group, error%message(:index(error%message, ' ') - 1), error%message)
   end subroutine read_material

   !> Reads all `&support`.
   subroutine read_supports(supports, deck)
      type(support_t), allocatable, intent(out) :: supports(:) !! the supports
      type(deck_t), intent(inout) :: deck !! the deck
      character(2), parameter :: keys(4) = ['ux', 'uy', 'un', 'ut']
      integer, allocatable :: groups(:)
      logical :: has_set, has_point
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
         call deck%refuse_unknown(groups(i))
         if (deck%n_faults() > n_faults) cycle
         call require(deck, groups(i), 'set', has_set .neqv. has_point, 'be given, or else point')
         call require(deck, groups(i), 'set', .not. has_set .or. len_trim(supports(i)%set) > 0, 'not be empty')
         call require(deck, groups(i), 'ux', any(supports(i)%is_held), 'be given, or uy, un or ut')
         call require(deck, groups(i), 'point', .not. (has_point .and. any(supports(i)%is_held(3:))), &
            'not go with un or ut: a point has no normal')
      end do
   end subroutine read_supports

   !> Reads all `&load`.
   subroutine read_loads(loads, deck)
      type(load_t), allocatable, intent(out) :: loads(:) !! the loads
      type(deck_t), intent(inout) :: deck !! the deck
      integer, allocatable :: groups(:)
      logical :: has_set, has_traction, has_pressure, has_body_force
      integer :: i, n_faults

      groups = deck%groups('load')
      allocate (loads(size(groups)))
      do i = 1, size(groups)
         n_faults = deck%n_faults()
         loads(i)%set = ''
         loads(i)%origin = origin_of(deck, groups(i), 'set')
         call deck%get(groups(i), 'set', loads(i)%set, has_set)
         call deck%get(groups(i), 'traction', loads(i)%traction, has_traction)
         call deck%get(groups(i), 'pressure', loads(i)%pressure, has_pressure)
         call deck%get(groups(i), 'body_force', loads(i)%body_force, has_body_force)
         call deck%refuse_unknown(groups(i))
         if (deck%n_faults() > n_faults) cycle
         call require(deck, groups(i), 'traction', has_traction .or. has_pressure .or. has_body_force, &
            'be given, or pressure or body_force')
         call require(deck, groups(i), 'set', has_set .or. .not. (has_traction .or. has_pressure), &
            'name the side that traction or pressure act on')
         call require(deck, groups(i), 'body_force', .not. (has_body_force .and. has_set), &
            'not go with set: it acts on the whole body')
         call require(deck, groups(i), 'set', .not. has_set .or. len_trim(loads(i)%set) > 0, 'not be empty')
      end do
   end subroutine read_loads

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
