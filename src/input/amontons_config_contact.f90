!> What a deck says of contact sets.
module amontons_config_contact
   use amontons_cell_partition, only: cell_partition_t, multiplier_names
   use amontons_contact_zone, only: contact_t
   use amontons_deck_visitor, only: deck_visitor_t, group_t, is_filled, key_t
   use amontons_kinds, only: dp
   use amontons_line_field, only: line_field_t
   use amontons_obstacle, only: obstacle_names
   implicit none (type, external)
   private

   public :: describe_contact

   !> The group of a contact set.
   type(group_t), parameter, public :: contact_group = group_t('contact', is_repeatable=.true.)
   !> Keys of Coulomb's coefficient: its value, slope and table.
   type(key_t), parameter :: friction_keys(3) = [ &
      key_t('friction', "Coulomb's coefficient; 0 is frictionless contact", at_least=0.0_dp, also='mu f coefficient'), &
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
      logical :: has_name

      has_name = is_filled(contact%name)
      call visitor%open_group(contact_group)
      call visitor%text(key_t('name', 'by which `&steps` know it, besides its `set`', default='none', &
         is_filled=.true., also='label'), contact%name, has_name)
      call visitor%text(key_t('set', 'the boundary set that may touch the obstacle', is_filled=.true., &
         is_required=.true., is_shared=.true., also='surface side'), contact%set)
      call describe_field(visitor, friction_keys, contact%friction)
      call describe_field(visitor, bound_keys, contact%slip_bound)
      call describe_obstacle(visitor, contact)
      call describe_partition(visitor, contact%partition)
      call visitor%close_group()
      call visitor%locate('set', contact%origin)
      call judge_contact(visitor, contact)
   end subroutine describe_contact

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

   !> Describes the keys of the obstacle and of the gap to it.
   subroutine describe_obstacle(visitor, contact)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(contact_t), intent(inout) :: contact !! the contact set
      logical :: has_radius, has_line, has_direction

      call visitor%word(key_t('obstacle', 'the rigid obstacle', also='kind type shape'), contact%obstacle%kind, &
         obstacle_names)
      has_radius = contact%obstacle%has_radius()
      has_line = is_filled(contact%obstacle%file)
      has_direction = any(abs(contact%direction) > 0.0_dp)
      associate (obstacle => contact%obstacle)
         call visitor%reals(key_t('point', 'a point of the obstacle: its apex; of a polyline, where its 0, 0 is put', &
            'L', also='origin'), obstacle%point)
         call visitor%reals(key_t('normal', "direction of the obstacle's outward normal there, of any length, to"// &
            ' the body', is_nonzero=.true.), obstacle%normal)
         call visitor%real(key_t('radius', 'of a circle or parabola, where it is required: radius of curvature;'// &
            ' positive bulges to the body, negative is hollow', 'L', is_nonzero=.true., also='r'), obstacle%radius, &
            has_radius)
         call visitor%text(key_t('line', 'of a polyline, where it is required: file of its points', is_file=.true., &
            is_filled=.true., also='file'), obstacle%file, has_line)
         call visitor%table('line', obstacle%file, obstacle%line)
      end associate
      call visitor%reals(key_t('gap_direction', 'along which gaps are measured and closed, to the obstacle', &
         default="the body's normal", is_nonzero=.true., is_shared=.true.), contact%direction, has_direction)
      call visitor%real(key_t('extra_gap', 'added to every gap; negative for an interference', 'L', &
         also='gap clearance interference'), contact%extra_gap)
   end subroutine describe_obstacle

   !> Describes the keys of the multipliers.
   subroutine describe_partition(visitor, partition)
      class(deck_visitor_t), intent(inout) :: visitor !! the visitor
      type(cell_partition_t), intent(inout) :: partition !! the multipliers
      character(:), allocatable :: multipliers
      logical :: has_cells, has_ends

      multipliers = trim(merge(multiplier_names(2), multiplier_names(1), partition%is_constant))
      has_cells = partition%n_cells > 0
      has_ends = allocated(partition%ends)
      call visitor%word(key_t('multipliers', 'contact forces at the nodes, or stresses that are constant on cells'// &
         ' of the contact line', is_shared=.true.), multipliers, multiplier_names)
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

      if (.not. visitor%is_judging()) return
      associate (obstacle => contact%obstacle)
         call visitor%only('radius', obstacle%has_radius(), "obstacle = 'circle' or 'parabola'")
         call visitor%require(visitor%has('radius') .or. .not. obstacle%has_radius(), 'obstacle', &
            "obstacle = '"//obstacle%kind//"' needs radius")
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
