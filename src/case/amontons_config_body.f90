!> The materials, supports and loads that a deck asks for.
module amontons_config_body
   use amontons_constraints, only: support_t, supported_components
   use amontons_deck, only: deck_t
   use amontons_deck_rules, only: origin_of, require
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_nodes, load_on_region, load_on_sides, load_t
   use amontons_material, only: formulation_names, hypothesis_names, material_t, new_material
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: read_loads, read_materials, read_supports

contains

   !> Reads all `&material`.
   subroutine read_materials(materials, deck)
      type(material_t), allocatable, intent(out) :: materials(:) !! the materials
      type(deck_t), intent(inout) :: deck !! the deck
      integer, allocatable :: groups(:)
      integer :: i

      groups = deck%groups('material')
      if (size(groups) == 0 .and. deck%is_understood(0)) call deck%fault(0, '', '&material needs young and poisson')
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
      character(:), allocatable :: hypothesis, formulation, region
      logical :: has_young, has_poisson

      young = 1.0_dp
      poisson = 0.0_dp
      thickness = 1.0_dp
      hypothesis = trim(hypothesis_names(1))
      formulation = trim(formulation_names(1))
      region = ''
      call deck%get(group, 'young', young, has_young)
      call deck%get(group, 'poisson', poisson, has_poisson)
      call deck%get(group, 'thickness', thickness)
      call deck%get_word(group, 'hypothesis', hypothesis, hypothesis_names)
      call deck%get_word(group, 'formulation', formulation, formulation_names)
      call deck%get(group, 'region', region)
      call deck%refuse_unknown(group)
      call require(deck, group, 'young', young > 0.0_dp, 'be positive, found '//to_text(young))
      call require(deck, group, 'poisson', poisson > -1.0_dp .and. poisson < 0.5_dp, &
         'lie above -1 and below 0.5, found '//to_text(poisson))
      call require(deck, group, 'thickness', thickness > 0.0_dp, 'be positive, found '//to_text(thickness))
      if (.not. deck%is_understood(group)) return
      if (.not. (has_young .and. has_poisson)) call deck%fault(group, 'young', '&material needs young and poisson')
      call require(deck, group, 'formulation', formulation /= 'b-bar' .or. hypothesis /= 'plane stress', &
         "not be 'b-bar' in plane stress, where nothing locks")
      ! Its rules are those above.
      call new_material(material, young, poisson, hypothesis, thickness, error)
      call material%choose_formulation(formulation)
      material%region = region
      material%origin = origin_of(deck, group, 'region')
   end subroutine read_material

   !> Reads all `&support`.
   subroutine read_supports(supports, deck)
      type(support_t), allocatable, intent(out) :: supports(:) !! the supports
      type(deck_t), intent(inout) :: deck !! the deck
      integer, allocatable :: groups(:)
      logical :: has_set, has_point, has_spring(2)
      integer :: i, k

      groups = deck%groups('support')
      allocate (supports(size(groups)))
      do i = 1, size(groups)
         supports(i)%set = ''
         supports(i)%origin = origin_of(deck, groups(i), 'set')
         call deck%get(groups(i), 'set', supports(i)%set, has_set)
         call deck%get(groups(i), 'point', supports(i)%point, has_point)
         do k = 1, size(supported_components)
            call deck%get(groups(i), supported_components(k), supports(i)%displacement(k), supports(i)%is_held(k))
         end do
         call deck%get(groups(i), 'spring_n', supports(i)%spring(1), has_spring(1))
         call deck%get(groups(i), 'spring_t', supports(i)%spring(2), has_spring(2))
         call deck%refuse_unknown(groups(i))
         call require(deck, groups(i), 'set', .not. has_set .or. len_trim(supports(i)%set) > 0, 'not be empty')
         call require(deck, groups(i), 'spring_n', supports(i)%spring(1) >= 0.0_dp, 'be at least 0')
         call require(deck, groups(i), 'spring_t', supports(i)%spring(2) >= 0.0_dp, 'be at least 0')
         if (.not. deck%is_understood(groups(i))) cycle
         call require(deck, groups(i), 'set', has_set .neqv. has_point, 'be given, or else point')
         call require(deck, groups(i), 'ux', any(supports(i)%is_held) .or. any(has_spring), &
            'be given, or uy, un, ut, spring_n or spring_t')
         call require(deck, groups(i), 'point', .not. (has_point .and. (any(has_spring) .or. &
            any(supports(i)%is_held(3:)))), 'not go with un, ut or springs: a point has no normal')
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
      logical :: has_name, has_set, has_point, has_region, on_sides(4), on_nodes, on_region

      slopes = 0.0_dp
      load%name = ''
      load%set = ''
      load%region = ''
      load%origin = origin_of(deck, group, 'set')
      call deck%get(group, 'name', load%name, has_name)
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
      call require(deck, group, 'name', .not. has_name .or. len_trim(load%name) > 0, 'not be empty')
      call require(deck, group, 'set', .not. has_set .or. len_trim(load%set) > 0, 'not be empty')
      if (.not. deck%is_understood(group)) return
      load%target = load_on_sides
      if (on_nodes) load%target = load_on_nodes
      if (on_region) load%target = load_on_region
      call require(deck, group, 'traction', count([any(on_sides), on_nodes, on_region]) == 1, &
         'be given, or pressure, force or body_force; different kinds stand in groups of their own')
      if (deck%is_sound(group)) call check_target(load, deck, group, has_set, has_point, has_region)
   end subroutine read_load

   !> Checks that a load is told what it acts on, in the words that belong to its kind.
   subroutine check_target(load, deck, group, has_set, has_point, has_region)
      type(load_t), intent(in) :: load !! the load
      type(deck_t), intent(inout) :: deck !! the deck
      integer, intent(in) :: group !! the group
      logical, intent(in) :: has_set !! whether it names a set
      logical, intent(in) :: has_point !! whether it names a point
      logical, intent(in) :: has_region !! whether it names a region

      select case (load%target)
      case (load_on_sides)
         call require(deck, group, 'set', has_set, 'name the side that traction or pressure act on')
         call require(deck, group, 'point', .not. has_point, 'go with force')
         call require(deck, group, 'region', .not. has_region, 'go with body_force')
      case (load_on_nodes)
         call require(deck, group, 'force', has_set .neqv. has_point, 'go with either set or point')
         call require(deck, group, 'region', .not. has_region, 'go with body_force')
      case default
         call require(deck, group, 'body_force', .not. (has_set .or. has_point), &
            'not go with set or point: it acts on a region, or on the whole body')
      end select
   end subroutine check_target

end module amontons_config_body
