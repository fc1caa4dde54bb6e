!> What a deck says of contact sets.
module amontons_config_contact
   use amontons_contact_set, only: cell_partition_t, contact_t, gap_names, line_field_t, multiplier_names, pairing_t, &
      tie_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_kinds, only: dp
   use amontons_obstacle, only: obstacle_names, obstacle_t
   implicit none (type, external)
   private

   public :: describe_contact, describe_tie

   !> The group of a contact set.
   type(group_t), parameter, public :: contact_group = group_t('contact', is_repeatable=.true.)
   !> The group of a tie.
   type(group_t), parameter, public :: tie_group = group_t('tie', is_repeatable=.true., is_shared=.true.)
   !> Keys of Coulomb's coefficient: its value, slope and table.
   type(key_t), parameter :: friction_keys(3) = [ &
      key_t('friction', "Coulomb's coefficient; 0 is frictionless contact", at_least=0.0_dp, &
      also='mu mu_s f cof coefficient'), &
      key_t('friction_slope', 'change of the coefficient along x and y; `friction` is then its value at the origin', &
      '1/L'), &
      key_t('friction_table', 'file with the coefficient over the length of the contact line, instead', is_file=.true.)]
   !> Keys of the given bound: its value, slope and table.
   type(key_t), parameter :: bound_keys(3) = [ &
      key_t('slip_bound', 'given bound of the shear stress (Tresca friction)', 'F/L²', at_least=0.0_dp, &
      also='tresca g'), &
      key_t('slip_bound_slope', 'change of the bound along x and y; `slip_bound` is then its value at the origin', &
      'F/L³'), &
      key_t('slip_bound_table', 'file with the bound over the length of the contact line, instead', is_file=.true.)]

contains

   !> Describes one `&contact`.
   subroutine describe_contact(visitor, contact)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(contact_t), intent(inout) :: contact !! the contact set
      logical :: has_name, is_pair

      has_name = is_filled(contact%name)
      call visitor%open_group(contact_group)
      call visitor%text(key_t('name', 'by which `&steps` know it, besides its `set`', default='none', &
         is_filled=.true., also='label'), contact%name, has_name)
      call visitor%text(key_t('set', 'the boundary set that may touch an obstacle, or another body', is_filled=.true., &
         is_required=.true., is_shared=.true., also='surface side'), contact%set)
      call describe_field(visitor, friction_keys, contact%friction)
      call describe_field(visitor, bound_keys, contact%slip_bound)
      call describe_pairing(visitor, contact%pairing)
      is_pair = contact%pairing%is_pair()
      call describe_obstacle(visitor, contact%obstacle, contact%direction, is_pair)
      call visitor%real(key_t('extra_gap', 'added to every gap; negative for an interference', 'L', &
         also='clearance interference'), contact%extra_gap)
      call describe_partition(visitor, contact%partition, is_pair)
      call visitor%close_group()
      call visitor%locate('set', contact%origin)
      call judge_contact(visitor, contact)
   end subroutine describe_contact

   !> Describes one `&tie`.
   subroutine describe_tie(visitor, tie)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(tie_t), intent(inout) :: tie !! the tie
      logical :: has_search

      has_search = tie%search > 0.0_dp
      call visitor%open_group(tie_group)
      call visitor%text(key_t('set', 'the boundary set that is bonded, the slave', is_filled=.true., &
         is_required=.true., also='slave surface'), tie%set)
      call visitor%text(key_t('to', 'the boundary set of the body that it is bonded to, the master', is_filled=.true., &
         is_required=.true., also='against master target'), tie%to)
      call visitor%real(key_t('search', 'how far the master may be along the normal of the slave, either way', 'L', &
         default='twice the longest side', above=0.0_dp), tie%search, has_search)
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
      logical :: has_table
      integer :: n

      value_key = keys(1)
      ! Where a slope may raise it, it is measured at the contact points.
      if (visitor%has(keys(2)%name)) value_key%at_least = -huge(1.0_dp)
      has_table = is_filled(field%file)
      call visitor%real(value_key, field%value)
      call visitor%reals(keys(2), field%slope)
      call visitor%text(keys(3), field%file, has_table)
      call visitor%table(trim(keys(3)%name), field%file, field%table)
      if (.not. allocated(field%table)) return
      n = size(field%table, 2)
      call visitor%require(all(field%table(1, 2:) > field%table(1, :n - 1)), trim(keys(3)%name), &
         trim(keys(3)%name)//' must have lengths that increase from row to row')
   end subroutine describe_field

   !> Describes the keys of a second deformable body.
   subroutine describe_pairing(visitor, pairing)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(pairing_t), intent(inout) :: pairing !! the other body
      logical :: is_pair, has_search, has_gap

      is_pair = pairing%is_pair()
      has_search = pairing%search > 0.0_dp
      has_gap = is_pair
      call visitor%text(key_t('against', 'the boundary set of another deformable body, the master, in the place of'// &
         ' a rigid obstacle; `set` is the slave', default='none', is_filled=.true., is_shared=.true., &
         also='master target'), pairing%against, is_pair)
      call visitor%real(key_t('search', 'with `against`: how far the master may be along the normal of the slave,'// &
         ' either way', 'L', default='twice the longest side', above=0.0_dp, is_shared=.true.), pairing%search, &
         has_search)
      call visitor%word(key_t('gap', 'with `against`: where gaps come from: from the meshes, or 0 wherever the'// &
         ' bodies face each other', is_shared=.true., also='adjust'), pairing%gap, gap_names, has_gap)
   end subroutine describe_pairing

   !> Describes the keys of a rigid obstacle and of the gap to it.
   subroutine describe_obstacle(visitor, obstacle, direction, is_pair)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(obstacle_t), intent(inout) :: obstacle !! the obstacle
      real(dp), intent(inout) :: direction(2) !! along which gaps count; 0, 0 for the body's normal [-]
      logical, intent(in) :: is_pair !! whether there is another body in its place
      logical :: has_kind, has_point, has_normal, has_radius, has_line, has_direction

      has_kind = .not. is_pair
      has_point = has_kind
      has_normal = has_kind
      call visitor%word(key_t('obstacle', 'the rigid obstacle', also='kind type shape'), obstacle%kind, &
         obstacle_names, has_kind)
      has_radius = obstacle%has_radius()
      has_line = is_filled(obstacle%file)
      has_direction = any(abs(direction) > 0.0_dp)
      call visitor%reals(key_t('point', 'a point of the obstacle: its apex; of a polyline, where its 0, 0 is put', &
         'L', also='origin center centre apex'), obstacle%point, has_point)
      call visitor%reals(key_t('normal', "direction of the obstacle's outward normal there, of any length, to"// &
         ' the body', is_nonzero=.true.), obstacle%normal, has_normal)
      call visitor%real(key_t('radius', 'of a circle or parabola, where it is required: radius of curvature;'// &
         ' positive bulges to the body, negative is hollow', 'L', is_nonzero=.true., also='r'), obstacle%radius, &
         has_radius)
      call visitor%text(key_t('line', 'of a polyline, where it is required: file of its points', is_file=.true., &
         is_filled=.true., also='file'), obstacle%file, has_line)
      call visitor%table('line', obstacle%file, obstacle%line)
      call visitor%reals(key_t('gap_direction', 'along which gaps are measured and closed, to the obstacle', &
         default="the body's normal", is_nonzero=.true., is_shared=.true.), direction, has_direction)
   end subroutine describe_obstacle

   !> Describes the keys of the multipliers.
   subroutine describe_partition(visitor, partition, is_pair)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(cell_partition_t), intent(inout) :: partition !! the multipliers
      logical, intent(in) :: is_pair !! whether two deformable bodies meet
      character(len(multiplier_names)) :: multipliers
      logical :: has_cells, has_ends

      multipliers = multiplier_names(merge(2, merge(3, 1, is_pair), partition%is_constant))
      has_cells = partition%n_cells > 0
      has_ends = allocated(partition%ends)
      call visitor%word(key_t('multipliers', 'contact forces at the nodes, stresses that are constant on cells of'// &
         ' the contact line, or with `against` mortar multipliers at the corners of the slave', &
         default='nodal, but mortar with `against`', is_shared=.true.), multipliers, multiplier_names)
      call visitor%require(is_pair .or. multipliers /= multiplier_names(3), 'multipliers', &
         "multipliers = 'mortar' needs against")
      call visitor%require(.not. is_pair .or. multipliers /= multiplier_names(1), 'multipliers', &
         "multipliers must be 'mortar' or 'constant' with against")
      partition%is_constant = multipliers == multiplier_names(2)
      call visitor%whole(key_t('cells', "with `'constant'`: number of equal cells on each piece of the line", &
         default='every two sides', at_least=1.0_dp, is_shared=.true.), partition%n_cells, has_cells)
      call visitor%list(key_t('cell_ends', "with `'constant'`, instead of `cells`: lengths along the line (of one"// &
         ' piece) where one cell ends and the next begins', 'L', above=0.0_dp, is_ascending=.true., &
         is_shared=.true.), partition%ends, has_ends)
   end subroutine describe_partition

   !> Judges the keys of a `&contact` together.
   subroutine judge_contact(visitor, contact)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(contact_t), intent(in) :: contact !! the contact set
      character(*), parameter :: is_constant = "multipliers = 'constant'"
      character(*), parameter :: obstacle_keys(*) = [character(13) :: 'obstacle', 'point', 'normal', 'radius', 'line', &
         'gap_direction']
      integer :: i

      if (.not. visitor%is_judging()) return
      if (contact%pairing%is_pair()) then
         do i = 1, size(obstacle_keys)
            call visitor%only(trim(obstacle_keys(i)), .false., 'a rigid obstacle, not with against')
         end do
         call visitor%require(contact%pairing%against /= contact%set, 'against', 'against must name another set'// &
            " than set; for self contact, split the set '"//contact%set//"' in two")
      end if
      call visitor%only('search', contact%pairing%is_pair(), 'contact against another body')
      call visitor%only('gap', contact%pairing%is_pair(), 'contact against another body')
      associate (obstacle => contact%obstacle)
         call visitor%only('radius', obstacle%has_radius(), "obstacle = 'circle' or 'parabola'")
         call visitor%require(visitor%has('radius') .or. .not. obstacle%has_radius(), 'obstacle', &
            "obstacle = '"//trim(obstacle%kind)//"' needs radius")
         call visitor%only('line', obstacle%kind == 'polyline', "obstacle = 'polyline'")
         call visitor%require(visitor%has('line') .or. obstacle%kind /= 'polyline', 'obstacle', &
            "obstacle = 'polyline' needs line = 'FILE.csv'")
      end associate
      call visitor%only('cells', contact%partition%is_constant, is_constant)
      call visitor%only('cell_ends', contact%partition%is_constant, is_constant)
      call visitor%require(.not. (visitor%has('cells') .and. visitor%has('cell_ends')), 'cell_ends', &
         'give either cells or cell_ends')
   end subroutine judge_contact

end module amontons_config_contact
