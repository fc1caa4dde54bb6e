!> The configuration of a case: what a deck says, checked, with every default in place.
module amontons_config
   use amontons_condensation, only: condensation_names
   use amontons_config_body, only: read_loads, read_materials, read_supports
   use amontons_config_contact, only: read_contacts
   use amontons_config_reduced, only: read_problem, reduced_source_t
   use amontons_config_sweep, only: read_sweep
   use amontons_constraints, only: support_t
   use amontons_contact_zone, only: contact_t
   use amontons_deck, only: deck_t, read_deck, read_deck_text
   use amontons_deck_reference, only: group_names, repeatable_names
   use amontons_deck_rules, only: origin_of, require
   use amontons_element, only: element_names
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_t
   use amontons_material, only: material_t
   use amontons_methods, only: acceleration_names, box_names, local_names, method_names, method_options_t, &
      space_names, variant_names
   use amontons_new_factorization, only: factorization_names
   use amontons_number_table, only: beside
   use amontons_rectangle, only: diagonal_names, rectangle_t
   use amontons_sweep, only: sweep_t
   use amontons_system, only: absolute_path
   use amontons_text, only: quoted, to_text
   implicit none (type, external)
   private

   public :: config_t, new_reduced_config, read_config

   !> Everything that defines a case.
   type :: config_t
      character(:), allocatable :: file !! name of the deck
      character(:), allocatable :: name !! name of the case, and of its files
      character(:), allocatable :: title !! what the case is about, for the listing
      type(reduced_source_t) :: reduced !! the reduced problem that there is in the place of a body, if one is given
      character(:), allocatable :: mesh_file !! name of the mesh file from the root on; empty for a rectangle
      character(:), allocatable :: mesh_origin !! where the mesh was specified, for messages: 'deck.nml:12: '
      type(rectangle_t) :: rectangle !! the rectangle that is the body where there is no mesh file
      type(material_t), allocatable :: materials(:) !! its materials
      type(support_t), allocatable :: supports(:) !! its supports
      type(load_t), allocatable :: loads(:) !! its loads
      type(contact_t), allocatable :: contacts(:) !! its contact sets
      type(sweep_t) :: sweep !! what varies from case to case; nothing for a single case
      type(method_options_t) :: method !! the contact method
      character(:), allocatable :: factorization !! one of `factorization_names`
      character(:), allocatable :: condensation !! one of `condensation_names`
   end type config_t

contains

   !> Reads a case from a deck. All faults of the deck are told in one error, one line each; what a group means is
   !> judged only where its form is right, and what follows from another fault is not told.
   subroutine read_config(config, file, error)
      type(config_t), intent(out) :: config !! the case
      character(*), intent(in) :: file !! name of the deck, `-` for standard input
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck
      type(deck_t) :: deck

      call read_deck(deck, file, error)
      if (allocated(error)) return
      config%file = deck%file
      call read_groups(config, deck, error)
   end subroutine read_config

   !> Makes the case of a reduced problem's file alone: that of a deck which names the file and nothing else.
   subroutine new_reduced_config(config, file, error)
      type(config_t), intent(out) :: config !! the case
      character(*), intent(in) :: file !! name of the reduced problem's file
      type(error_t), allocatable, intent(out) :: error !! the name cannot stand in a deck
      type(deck_t) :: deck

      call read_deck_text(deck, file, "&problem kind = 'reduced'  file = "//quoted(absolute_path(file))//' /')
      config%file = file
      call read_groups(config, deck, error)
      config%reduced%file = file
      config%reduced%origin = ''
   end subroutine new_reduced_config

   !> Reads all groups of a deck.
   subroutine read_groups(config, deck, error)
      type(config_t), intent(inout) :: config !! the case, gains what the groups say
      type(deck_t), intent(inout) :: deck !! the deck
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the deck

      call deck%refuse_unknown_groups(group_names, repeatable_names)
      call read_case(config, deck)
      call read_problem(config%reduced, deck)
      if (.not. config%reduced%is_given) then
         call read_mesh(config, deck)
         call read_materials(config%materials, deck)
         call read_supports(config%supports, deck)
         call read_loads(config%loads, deck)
         call read_contacts(config%contacts, deck)
         call read_sweep(config%sweep, deck, config%loads, config%contacts)
      end if
      call read_solver(config, deck)
      call read_output(config%sweep, deck)
      call deck%finish(error)
   end subroutine read_groups

   !> Reads `&case`: name and title.
   subroutine read_case(config, deck)
      type(config_t), intent(inout) :: config !! the case
      type(deck_t), intent(inout) :: deck !! the deck
      ! File names end at 255 characters; temporary ones add up to 30 to the name.
      integer, parameter :: longest_name = 200
      integer :: group, last_slash, last_point

      group = deck%group('case')
      last_slash = index(config%file, '/', back=.true.)
      config%name = config%file(last_slash + 1:)
      last_point = index(config%name, '.', back=.true.)
      if (last_point > 1) config%name = config%name(:last_point - 1)
      config%title = ''
      call deck%get(group, 'name', config%name)
      call deck%get(group, 'title', config%title)
      if (len_trim(config%name) == 0 .or. len(config%name) > longest_name &
         .or. has_unusable_character(config%name)) then
         call deck%fault(group, 'name', 'name must be usable as a file name: 1 to '//to_text(longest_name)// &
            " characters without '/' and control characters")
      end if
      call deck%refuse_unknown(group)
   end subroutine read_case

   !> Whether a name has a character that file names or decks cannot have.
   pure logical function has_unusable_character(name)
      character(*), intent(in) :: name !! the name
      character, parameter :: blank = ' '
      integer :: i

      has_unusable_character = any([(name(i:i) < blank .or. name(i:i) == '/', i=1, len(name))])
   end function has_unusable_character

   !> Reads `&mesh`: a rectangle and its cells, or a file.
   subroutine read_mesh(config, deck)
      type(config_t), intent(inout) :: config !! the case
      type(deck_t), intent(inout) :: deck !! the deck
      character(:), allocatable :: kind
      integer :: group
      logical :: has_size, has_cells, has_file

      group = deck%group('mesh')
      kind = 'rectangle'
      config%mesh_file = ''
      associate (rectangle => config%rectangle)
         rectangle%size = 0.0_dp
         rectangle%cells = 0
         rectangle%element = 'quad4'
         rectangle%diagonal = 'right'
         call deck%get_word(group, 'kind', kind, [character(9) :: 'rectangle', 'file'])
         call deck%get(group, 'file', config%mesh_file, has_file)
         call deck%get(group, 'size', rectangle%size, has_size)
         call deck%get(group, 'cells', rectangle%cells, has_cells)
         call deck%get_word(group, 'element', rectangle%element, element_names)
         call deck%get_word(group, 'diagonal', rectangle%diagonal, diagonal_names)
         call deck%get(group, 'grading', rectangle%grading)
      end associate
      call deck%refuse_unknown(group)
      if (kind /= 'file') call check_rectangle(config%rectangle, deck, group, has_size, has_cells)
      if (.not. deck%is_understood(group)) return
      if (kind == 'file') then
         config%mesh_origin = origin_of(deck, group, 'file')
         call require(deck, group, 'file', len_trim(config%mesh_file) > 0, "name the mesh of kind 'file'")
         call require(deck, group, 'size', .not. (has_size .or. has_cells), "not go with kind 'file'")
         if (len(config%mesh_file) > 0) config%mesh_file = absolute_path(beside(deck%file, config%mesh_file))
      else
         config%mesh_origin = origin_of(deck, group, 'cells')
         if (has_file) then
            call require(deck, group, 'file', .false., "go with kind 'file'")
         else if (.not. (has_size .and. has_cells)) then
            call deck%fault(group, 'kind', '&mesh needs size and cells')
         end if
      end if
   end subroutine read_mesh

   !> Checks the numbers of a rectangle.
   subroutine check_rectangle(rectangle, deck, group, has_size, has_cells)
      type(rectangle_t), intent(in) :: rectangle !! the rectangle
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      logical, intent(in) :: has_size !! whether the size is given
      logical, intent(in) :: has_cells !! whether the cells are given

      call require(deck, group, 'size', .not. has_size .or. all(rectangle%size > 0.0_dp), 'be positive')
      call require(deck, group, 'cells', .not. has_cells .or. all(rectangle%cells > 0), 'be positive')
      call require(deck, group, 'grading', rectangle%grading > 0.0_dp, 'be positive')
   end subroutine check_rectangle

   !> Reads `&solver`: method, its options, factorisation.
   subroutine read_solver(config, deck)
      type(config_t), intent(inout) :: config !! the case
      type(deck_t), intent(inout) :: deck !! the deck
      integer :: group

      group = deck%group('solver')
      config%factorization = trim(factorization_names(1))
      config%condensation = trim(condensation_names(1))
      associate (method => config%method)
         method%method = trim(method_names(1))
         method%variant = trim(variant_names(1))
         method%space = trim(space_names(1))
         method%box = trim(box_names(1))
         method%local = trim(local_names(1))
         method%acceleration = trim(acceleration_names(1))
         call deck%get_word(group, 'method', method%method, method_names)
         call deck%get_word(group, 'variant', method%variant, variant_names)
         call deck%get_word(group, 'space', method%space, space_names)
         call deck%get_word(group, 'box', method%box, box_names)
         call deck%get_word(group, 'local', method%local, local_names)
         call deck%get_word(group, 'acceleration', method%acceleration, acceleration_names)
         call deck%get(group, 'omega', method%omega)
         call deck%get(group, 'tolerance', method%tolerance)
         call deck%get(group, 'max_iterations', method%max_iterations)
         call deck%get_word(group, 'factorization', config%factorization, factorization_names)
         call deck%get_word(group, 'condensation', config%condensation, condensation_names)
         call deck%refuse_unknown(group)
         call require(deck, group, 'omega', method%omega > 0.0_dp .and. method%omega < 2.0_dp, &
            'lie above 0 and below 2, found '//to_text(method%omega))
         call require(deck, group, 'tolerance', method%tolerance > 0.0_dp .and. method%tolerance < 1.0_dp, &
            'lie above 0 and below 1, found '//to_text(method%tolerance))
         call require(deck, group, 'max_iterations', method%max_iterations > 0, 'be at least 1, found '// &
            to_text(method%max_iterations))
         call require(deck, group, 'space', .not. (config%reduced%is_given .and. method%method == 'psor' &
            .and. method%space == 'primal'), "be 'dual' for a reduced problem, which has no stiffness to sweep on")
         if (.not. allocated(config%contacts)) return
         call require(deck, group, 'condensation', .not. (config%condensation == 'band' &
            .and. any(config%contacts%partition%is_constant)), "be 'dense' or 'auto' with constant multipliers")
      end associate
   end subroutine read_solver

   !> Reads `&output`: the fields that a sweep shall leave.
   subroutine read_output(sweep, deck)
      type(sweep_t), intent(inout) :: sweep !! the sweep
      type(deck_t), intent(inout) :: deck !! the deck
      integer :: group
      logical :: is_given

      group = deck%group('output')
      call deck%get(group, 'fields_every', sweep%fields_every, is_given)
      call deck%refuse_unknown(group)
      if (.not. is_given) return
      call require(deck, group, 'fields_every', sweep%is_given(), 'go with &sweep')
      call require(deck, group, 'fields_every', sweep%fields_every > 0, 'be at least 1, found '// &
         to_text(sweep%fields_every))
   end subroutine read_output

end module amontons_config
