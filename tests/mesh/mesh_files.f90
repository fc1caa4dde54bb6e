!> Mesh files for the tests: small ones written line by line, and what a mesh read from a file measures.
module mesh_files
   use amontons_element, only: n_element_points, quadrature_point
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_mesh, only: jacobian_determinant, mesh_t, named_set_t
   use amontons_mesh_file, only: read_mesh_file
   implicit none (type, external)
   private

   public :: area_of, format_22, length_of, nodes_22, read_lines, read_text, square_22, text_file

   !> Name of the file that the small meshes are written to.
   character(*), parameter :: text_file = 'mesh_of_the_test'
   character, parameter :: line_feed = achar(10)

   !> How a text in version 2.2 begins.
   character(*), parameter :: format_22 = '$MeshFormat|2.2 0 8|$EndMeshFormat|'
   !> The nodes of the unit square: 1 to 4 at the corners, 5 beside it.
   character(*), parameter :: nodes_22 = '$Nodes|5|1 0 0 0|2 1 0 0|3 1 1 0|4 0 1 0|5 2 0 0|$EndNodes|'

contains

   !> The unit square as one quadrilateral, behind some other elements, in version 2.2.
   function square_22(n, elements) result(lines)
      integer, intent(in) :: n !! number of other elements
      character(*), intent(in) :: elements !! the other elements, a `|` behind each
      character(:), allocatable :: lines

      lines = format_22//nodes_22//'$Elements|'//achar(iachar('1') + n)//'|'//elements// &
         '9 3 2 0 1 1 2 3 4|$EndElements|'
   end function square_22

   !> Writes a text to the test's file as it is.
   subroutine write_text(text)
      character(*), intent(in) :: text !! every byte of the file
      integer :: unit

      open (newunit=unit, file=text_file, status='replace', action='write', access='stream', form='unformatted')
      write (unit) text
      close (unit)
   end subroutine write_text

   !> Reads a mesh from a text.
   subroutine read_text(mesh, text, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      character(*), intent(in) :: text !! every byte of the file
      character(:), allocatable, intent(out) :: notes !! what was put right
      type(error_t), allocatable, intent(out) :: error !! what is wrong

      call write_text(text)
      call read_mesh_file(mesh, text_file, notes, error)
   end subroutine read_text

   !> Reads a mesh from lines.
   subroutine read_lines(mesh, lines, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      character(*), intent(in) :: lines !! the lines of the file, a `|` behind each
      character(:), allocatable, intent(out) :: notes !! what was put right
      type(error_t), allocatable, intent(out) :: error !! what is wrong
      character(len(lines)) :: text
      integer :: i

      do i = 1, len(lines)
         text(i:i) = merge(line_feed, lines(i:i), lines(i:i) == '|')
      end do
      call read_text(mesh, text, notes, error)
   end subroutine read_lines

   !> Area of some elements: the integral of the Jacobian's determinant.
   real(dp) function area_of(mesh, elements) result(area)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: elements(:) !! the elements
      real(dp) :: weight, xi(2)
      integer :: i, point

      area = 0.0_dp
      do i = 1, size(elements)
         associate (kind => mesh%element_kind(elements(i)))
            do point = 1, n_element_points(kind, .false.)
               call quadrature_point(kind, n_element_points(kind, .false.), point, xi, weight)
               area = area + weight*jacobian_determinant(mesh, elements(i), xi)
            end do
         end associate
      end do
   end function area_of

   !> Sum of the way from the first to the second corner over all sides of a boundary set.
   function length_of(mesh, set) result(way)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(named_set_t), intent(in) :: set !! the boundary set
      real(dp) :: way(2)
      integer :: i, nodes(3)

      way = 0.0_dp
      do i = 1, size(set%element)
         nodes = mesh%side(set%element(i), set%side(i))
         way = way + mesh%coordinates(:, nodes(2)) - mesh%coordinates(:, nodes(1))
      end do
   end function length_of

end module mesh_files
