!> Files of surfaces in space, read as triangles: STL, as text or binary, and meshes of Gmsh.
module amontons_surface_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: real32
   use amontons_element, only: tri3
   use amontons_error, only: error_t
   use amontons_file_model, only: cell_dimension, raw_mesh_t
   use amontons_gmsh, only: read_gmsh
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_integer_list, only: new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_text, only: ends_word, lower_case
   implicit none (type, external)
   private

   public :: read_surface_file

   !> Bytes of a binary STL file before its triangles, and of a triangle: 12 numbers, the normal first, and two more.
   integer, parameter :: n_header = 84, n_triangle = 50

contains

   !> Reads the triangles of a surface from a file.
   subroutine read_surface_file(place, file, part, error)
      real(dp), allocatable, intent(out) :: place(:, :)
         !! places of their corners, three after three (3, 3 triangles) [L]
      character(*), intent(in) :: file !! name of the file
      character(*), intent(in) :: part !! the physical surface of a Gmsh mesh; empty for all triangles
      type(error_t), allocatable, intent(out) :: error !! the first fault of the file, with its position
      type(input_file_t) :: input
      logical :: is_mesh

      allocate (place(3, 0))
      call new_input_file(input, file, error)
      if (allocated(error)) return
      call input%skip_white()
      is_mesh = input%text(min(input%position, len(input%text)):min(input%position, len(input%text))) == '$'
      if (len(part) > 0 .and. .not. is_mesh) call input%refuse('part is only for the surfaces of a Gmsh mesh')
      if (is_mesh) then
         call read_mesh(place, input, part)
      else if (index(input%text(:min(n_header, len(input%text))), achar(0)) > 0) then
         call read_binary(place, input)
      else if (is_next(input, 'solid')) then
         call read_text(place, input)
      else
         call input%refuse('neither an STL file, whose text begins with solid, nor a Gmsh mesh, which begins with '// &
            '$MeshFormat')
      end if
      call move_alloc(input%error, error)
   end subroutine read_surface_file

   !> Reads the triangles of STL text. Normals are passed over: the order of the corners has their sense.
   pure subroutine read_text(place, input)
      real(dp), allocatable, intent(inout) :: place(:, :) !! places of the corners (3, 3 triangles) [L]
      type(input_file_t), intent(inout) :: input !! the file, at its first word
      ! Characters of a triangle, at least.
      integer, parameter :: shortest = len('facet outer loop vertex 0 0 0 vertex 0 0 0 vertex 0 0 0 endloop endfacet')
      character(:), allocatable :: rest
      integer :: axis, k, n

      deallocate (place)
      allocate (place(3, 3*(len(input%text)/shortest + 1)))
      n = 0
      do while (is_next(input, 'solid') .and. .not. allocated(input%error))
         call input%take_line(rest)
         call input%skip_white()
         do while (.not. (is_next(input, 'endsolid') .or. allocated(input%error)))
            call take_word(input, 'facet')
            call input%take_line(rest)
            call take_word(input, 'outer')
            call take_word(input, 'loop')
            do k = n + 1, n + 3
               call take_word(input, 'vertex')
               do axis = 1, 3
                  call input%take_real(place(axis, k), 'a coordinate')
               end do
            end do
            call take_word(input, 'endloop')
            call take_word(input, 'endfacet')
            n = n + 3
         end do
         call input%take_line(rest)
         call input%skip_white()
      end do
      if (input%position <= len(input%text)) call take_word(input, 'solid')
      place = place(:, :n)
   end subroutine read_text

   !> Whether a word is the next one of a file.
   pure logical function is_next(input, word)
      type(input_file_t), intent(in) :: input !! the file, at a word
      character(*), intent(in) :: word !! the word, in lower case

      associate (behind => input%position + len(word))
         is_next = lower_case(input%text(input%position:min(behind - 1, len(input%text)))) == word .and. &
            ends_word(input%text, behind)
      end associate
   end function is_next

   !> Reads a given word and the blanks behind it.
   pure subroutine take_word(input, word)
      type(input_file_t), intent(inout) :: input !! the file
      character(*), intent(in) :: word !! the word, in lower case

      call input%skip_white()
      if (.not. is_next(input, word)) call input%refuse("expected '"//word//"', found "//input%word())
      input%position = input%position + len(word)
      call input%skip_white()
   end subroutine take_word

   !> Reads the triangles of a binary STL file, whose numbers have their last byte first.
   pure subroutine read_binary(place, input)
      real(dp), allocatable, intent(inout) :: place(:, :) !! places of the corners (3, 3 triangles) [L]
      type(input_file_t), intent(inout) :: input !! the file
      real(real32) :: corner(3)
      integer :: at, k, n

      input%is_binary = .true.
      input%position = n_header - 3
      call input%take_integer(n, 'the number of triangles')
      if (n < 0) call input%refuse('the number of triangles is out of range', n_header - 3)
      call input%check_count(n, n_triangle, 'triangles')
      if (allocated(input%error)) return
      deallocate (place)
      allocate (place(3, 3*n))
      do k = 0, 3*n - 1
         at = n_header + n_triangle*(k/3) + 12*(1 + modulo(k, 3))
         corner = transfer(input%text(at + 1:at + 12), corner)
         if (.not. all(ieee_is_finite(corner))) call input%refuse('a coordinate is not finite', at + 1)
         place(:, k + 1) = corner
      end do
   end subroutine read_binary

   !> Reads the triangles of a Gmsh mesh.
   pure subroutine read_mesh(place, input, part)
      real(dp), allocatable, intent(inout) :: place(:, :) !! places of the corners (3, 3 triangles) [L]
      type(input_file_t), intent(inout) :: input !! the file, at its first section
      character(*), intent(in) :: part !! the physical surface; empty for all triangles
      type(raw_mesh_t) :: raw
      type(tag_map_t) :: map
      integer, allocatable :: cells(:), nodes(:)
      integer :: i, k

      call read_gmsh(raw, input)
      cells = [(i, i=1, raw%cell_kind%n)]
      if (len(part) > 0) then
         i = raw%find_group(part)
         if (i == 0) call input%refuse("there is no physical surface '"//part//"'")
         if (i > 0) cells = raw%groups(i)%cell%items()
      end if
      if (allocated(input%error)) return
      cells = pack(cells, cell_dimension(raw%cell_kind%item(cells)) == 2)
      call new_tag_map(map, raw%node_tag%items())
      nodes = [((map%find(raw%node%item(raw%cell_start%item(cells(i)) + k)), k=0, 2), i=1, size(cells))]
      i = (findloc(nodes, 0, dim=1) + 2)/3
      if (i > 0) call input%refuse('a triangle has a node that is not there', raw%cell_place%item(cells(i)))
      i = findloc(raw%cell_kind%item(cells) /= tri3, .true., dim=1)
      if (i > 0) call input%refuse('expected triangles of 3 nodes alone on the surface of an obstacle', &
         raw%cell_place%item(cells(i)))
      if (.not. allocated(input%error)) place = raw%coordinates(:, nodes)
   end subroutine read_mesh

end module amontons_surface_file
