!> Types of Gmsh's elements, and which of them are read; physical groups of a Gmsh mesh: which cells belong to which,
!> and what they are called.
module amontons_gmsh_groups
   use amontons_element, only: quad4, quad8, quad9, tri3, tri6
   use amontons_input_file, only: input_file_t
   use amontons_integer_list, only: integer_list_t, new_tag_map, tag_map_t
   use amontons_raw_mesh, only: line2, line3, no_cell, point1, raw_mesh_t
   use amontons_text, only: counted, to_text
   implicit none (type, external)
   private

   public :: dimension_of, gmsh_groups_t, take_cell_kind

   !> Kind of cell of each of Gmsh's first types, `no_cell` where it is not read.
   integer, parameter :: kind_of_type(*) = [line2, tri3, quad4, no_cell, no_cell, no_cell, no_cell, line3, tri6, &
      quad9, no_cell, no_cell, no_cell, no_cell, point1, quad8]

   !> The groups of one dimension.
   type :: dimension_t
      type(integer_list_t) :: named_tag !! number of each physical group that has a name, positive
      type(integer_list_t) :: named_group !! its set in the raw mesh; a name without members is still a set
      type(integer_list_t) :: entity !! numbers of entities, not negative
      type(integer_list_t) :: entity_tag !! number of a physical group that each belongs to
      type(integer_list_t) :: run_owner !! what a run of cells belongs to: an entity or a physical group
      type(integer_list_t) :: run_first !! first cell of the run
      type(integer_list_t) :: run_last !! last cell of the run
   end type dimension_t

   !> What a file says about its physical groups, dimension by dimension: points, curves, surfaces.
   type :: gmsh_groups_t
      logical :: has_entities = .false. !! whether runs belong to entities, and those to groups
      type(dimension_t) :: of_dimension(0:2) !! the groups of each dimension
   contains
      procedure :: add_run => gmsh_groups_add_run
      procedure :: put => gmsh_groups_put
   end type gmsh_groups_t

contains

   !> Notes that consecutive cells belong to an entity or a group.
   pure subroutine gmsh_groups_add_run(self, dimension, owner, first, last)
      class(gmsh_groups_t), intent(inout) :: self !! the groups
      integer, intent(in) :: dimension !! dimension of the cells
      integer, intent(in) :: owner !! number of the entity or of the physical group
      integer, intent(in) :: first !! first of the cells
      integer, intent(in) :: last !! last of the cells

      associate (all => self%of_dimension(dimension))
         if (all%run_last%n > 0) then
            if (all%run_last%item(all%run_last%n) == first - 1 .and. all%run_owner%item(all%run_owner%n) == owner) then
               all%run_last%item(all%run_last%n) = last
               return
            end if
         end if
         call all%run_owner%append(owner)
         call all%run_first%append(first)
         call all%run_last%append(last)
      end associate
   end subroutine gmsh_groups_add_run

   !> Makes the groups sets of a raw mesh. Where there are physical surfaces, the body consists of them.
   pure subroutine gmsh_groups_put(self, raw, input)
      class(gmsh_groups_t), intent(inout) :: self !! the groups
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh, its cells complete
      type(input_file_t), intent(inout) :: input !! the file
      integer :: dimension
      logical :: has_surfaces

      has_surfaces = .false.
      do dimension = 0, 2
         call put_dimension(self%of_dimension(dimension), self%has_entities, raw, input, has_surfaces)
      end do
      if (has_surfaces) call drop_others(raw)
   end subroutine gmsh_groups_put

   !> Makes the groups of one dimension sets of a raw mesh.
   pure subroutine put_dimension(groups, has_entities, raw, input, has_any)
      type(dimension_t), intent(in) :: groups !! the groups
      logical, intent(in) :: has_entities !! whether runs belong to entities, and those to groups
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      logical, intent(out) :: has_any !! whether any cell belongs to a group
      type(integer_list_t) :: tag, run
      type(tag_map_t) :: map, names
      integer :: cell, first, group, i, place, named

      call list_pairs(groups, has_entities, raw, input, tag, run)
      call new_tag_map(map, tag%items())
      call new_tag_map(names, groups%named_tag%items())
      has_any = tag%n > 0
      first = 0
      do place = 1, tag%n
         if (map%tag(place) /= first) then
            first = map%tag(place)
            named = names%find(first)
            if (named > 0) group = groups%named_group%item(named)
            if (named == 0) call raw%get_group(input, to_text(first), group)
         end if
         i = run%item(map%item(place))
         call raw%expect_members(input, groups%run_last%item(i) - groups%run_first%item(i) + 1)
         if (allocated(input%error)) return
         do cell = groups%run_first%item(i), groups%run_last%item(i)
            call raw%groups(group)%cell%append(cell)
            call raw%groups(group)%side%append(0)
         end do
      end do
   end subroutine put_dimension

   !> Lists the physical groups and the runs that belong to them.
   pure subroutine list_pairs(groups, has_entities, raw, input, tag, run)
      type(dimension_t), intent(in) :: groups !! the groups
      logical, intent(in) :: has_entities !! whether runs belong to entities, and those to groups
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      type(input_file_t), intent(inout) :: input !! the file
      type(integer_list_t), intent(out) :: tag !! numbers of physical groups
      type(integer_list_t), intent(out) :: run !! a run that belongs to each
      type(tag_map_t) :: entities
      integer :: i, place

      if (.not. has_entities) then
         tag = groups%run_owner
         call run%append_all([(i, i=1, tag%n)])
         return
      end if
      call new_tag_map(entities, groups%entity%items())
      do i = 1, groups%run_owner%n
         do place = entities%first(groups%run_owner%item(i)), size(entities%tag)
            if (entities%tag(place) /= groups%run_owner%item(i)) exit
            call tag%append(groups%entity_tag%item(entities%item(place)))
            call run%append(i)
            call raw%expect_members(input, 1)
            if (allocated(input%error)) return
         end do
      end do
   end subroutine list_pairs

   !> Takes the elements that belong to no set out of the body.
   pure subroutine drop_others(raw)
      type(raw_mesh_t), intent(inout) :: raw !! the raw mesh
      logical, allocatable :: is_kept(:)
      integer :: cell, group, n_dropped

      allocate (is_kept(raw%cell_kind%n), source=.false.)
      do group = 1, raw%n_groups
         is_kept(raw%groups(group)%cell%items()) = .true.
      end do
      n_dropped = 0
      do cell = 1, size(is_kept)
         if (is_kept(cell) .or. raw%cell_kind%item(cell) < 0) cycle
         raw%cell_kind%item(cell) = no_cell
         n_dropped = n_dropped + 1
      end do
      if (n_dropped > 0) call raw%add_note(counted(n_dropped, 'element')//' outside the physical surfaces left out')
   end subroutine drop_others

   !> Takes the type of an element; refuses those that are not read.
   pure subroutine take_cell_kind(input, kind)
      type(input_file_t), intent(inout) :: input !! the file, at the type
      integer, intent(out) :: kind !! kind of the cell, `no_cell` where there is a fault
      integer :: type, place

      place = input%position
      call input%take_integer(type, 'the type of an element')
      kind = no_cell
      if (type >= 1 .and. type <= size(kind_of_type)) kind = kind_of_type(type)
      if (kind /= no_cell) return
      select case (type)
      case (4:7, 11:14, 17:19, 29:33)
         call input%refuse('3-D mesh: found a '//solid_name(type)//' (Gmsh type '//to_text(type)// &
            '), expected plane elements', place)
      case (20:28, 36:40)
         call input%refuse('elements of third or higher order (Gmsh type '//to_text(type)//') are not supported; '// &
            'mesh with -order 1 or 2', place)
      case default
         call input%refuse('elements of Gmsh type '//to_text(type)//' are not supported: expected points (15), '// &
            'lines (1, 8), triangles (2, 9), quadrilaterals (3, 10, 16)', place)
      end select
   end subroutine take_cell_kind

   !> What a type of solid elements is called.
   pure function solid_name(type) result(name)
      integer, intent(in) :: type !! number of the type
      character(:), allocatable :: name

      select case (type)
      case (4, 11, 29:31)
         name = 'tetrahedron'
      case (5, 12, 17)
         name = 'hexahedron'
      case (6, 13, 18)
         name = 'prism'
      case (7, 14, 19)
         name = 'pyramid'
      case default
         name = 'solid element'
      end select
   end function solid_name

   !> Dimension of a kind of cell: 0 for points, 1 for lines, 2 for elements.
   elemental integer function dimension_of(kind)
      integer, intent(in) :: kind !! the kind

      dimension_of = merge(0, 1, kind == point1)
      if (kind > 0) dimension_of = 2
   end function dimension_of

end module amontons_gmsh_groups
