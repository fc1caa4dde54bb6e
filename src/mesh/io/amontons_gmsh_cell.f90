!> Types of Gmsh's elements, and which of them are read.
module amontons_gmsh_cell
   use amontons_element, only: quad4, quad8, quad9, tri3, tri6
   use amontons_input_file, only: input_file_t
   use amontons_raw_mesh, only: line2, line3, no_cell, point1
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: dimension_of, take_cell_kind

contains

   !> Takes the type of an element; refuses those that are not read.
   pure subroutine take_cell_kind(input, kind)
      type(input_file_t), intent(inout) :: input !! the file, at the type
      integer, intent(out) :: kind !! kind of the cell, `no_cell` where there is a fault
      integer :: type, place

      place = input%position
      call input%take_integer(type, 'the type of an element')
      kind = no_cell
      select case (type)
      case (1)
         kind = line2
      case (2)
         kind = tri3
      case (3)
         kind = quad4
      case (8)
         kind = line3
      case (9)
         kind = tri6
      case (10)
         kind = quad9
      case (15)
         kind = point1
      case (16)
         kind = quad8
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

end module amontons_gmsh_cell
