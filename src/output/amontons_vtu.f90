!> The grids of a case for ParaView and meshio: unstructured grids in VTK's XML format with inline arrays in base64, the
!> form that all readers of such files support.
!>
!> NAME.vtu: mesh, displacements, stresses and contact quantities. NAME.contact.vtu: the contact line alone, as a grid
!> of line segments, and of vertices for points without a neighbor; followed by the lines of the masters of pairs, with
!> the forces that are transmitted to them.
module amontons_vtu
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_body, only: body_t
   use amontons_boundary, only: n_face_corners, new_patch, patch_t
   use amontons_contact_rows, only: contact_rows_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_table, only: at_nodes, column_t, contact_columns, master_line_t, new_master_line, side_rows
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_key_results, only: all_von_mises
   use amontons_kinds, only: dp, int32, int64
   use amontons_manifest, only: manifest_t
   use amontons_output_file, only: commit_files, new_output_file, output_file_t
   use amontons_result, only: result_t
   use amontons_rounding, only: exceeds
   use amontons_text, only: newline, to_text, unit_of, xml_escaped
   implicit none (type, external)
   private

   public :: base64_size, bytes_per_length, decode_base64, encode_base64, show_body, &
      show_contact_line, vtk_file_t, write_case_grids, write_grids

   !> The base64 letters of the numbers 0 to 63.
   character(*), parameter :: letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/'
   !> Numbers of letters, of pairs of letters, and of all characters.
   integer, parameter :: n_letters = len(letters), n_pairs = n_letters**2, n_characters = 256
   integer :: i, j
   !> The two letters of the numbers 0 to 4095.
   character(2), parameter :: pair(0:n_pairs - 1) = &
      [character(2) :: ((letters(i:i)//letters(j:j), j=1, n_letters), i=1, n_letters)]
   !> The number of each base64 letter; -1 for every other character.
   integer, parameter :: number(0:n_characters - 1) = [(index(letters, char(i)) - 1, i=0, n_characters - 1)]

   !> Size of the integer before each array that holds the array's number of bytes.
   integer(int64), parameter :: bytes_per_length = 8_int64

   !> Number of bytes that are encoded at once, a multiple of three and of the size of a number.
   integer(int64), parameter :: piece_size = 49152_int64

   !> A grid being written.
   type :: vtk_file_t
      private
      character(:), allocatable, public :: markup !! markup between the previous array and the next one
      real(dp), public :: scale = 0.0_dp
         !! what rounding errors of the next reals are measured by, if larger than they are; only comparisons ask
      character(:), allocatable :: section !! the section that is open
      character(:), allocatable, public :: units !! names of the units of the case; empty if it names none
      character(:), allocatable :: label !! unit of the array that is open
      integer :: state = 0 !! status of the last write statement; nothing is written after a failure
      character(:), allocatable :: not_finite !! the first quantity with a number that is not finite
      type(output_file_t) :: file !! the file
   contains
      procedure, public :: begin_array => vtk_file_begin_array
      procedure, public :: begin_grid => vtk_file_begin_grid
      procedure, public :: end_array => vtk_file_end_array
      procedure, public :: end_grid => vtk_file_end_grid
      procedure, public :: finish => vtk_file_finish
      procedure, public :: put_cells => vtk_file_put_cells
      procedure, public :: put_integers => vtk_file_put_integers
      procedure, public :: put_reals => vtk_file_put_reals
      procedure, public :: put_spread => vtk_file_put_spread
      procedure :: enter => vtk_file_enter
   end type vtk_file_t

   !> VTK's numbers of the element kinds, in the order of `amontons_element`.
   integer, parameter :: vtk_cell_type(*) = [5, 9, 22, 23, 28, 10, 24, 12, 25]
   !> VTK's numbers of a vertex and of a line segment.
   integer, parameter :: vtk_vertex = 1, vtk_line = 3
   !> Numbers of components of vectors and of stresses in VTK, which are in space.
   integer, parameter :: in_space = 3, as_tensor = 6

contains

   !> Number of base64 letters for a number of bytes, the final `=` signs included.
   pure integer(int64) function base64_size(n_bytes)
      integer(int64), intent(in) :: n_bytes !! number of bytes

      base64_size = 4_int64*((n_bytes + 2_int64)/3_int64)
   end function base64_size

   !> Encodes bytes.
   pure function encode_base64(bytes) result(text)
      character(*), intent(in) :: bytes !! the bytes
      character(base64_size(len(bytes, int64))) :: text
      integer(int64) :: group, n_whole
      integer :: n_left

      n_whole = len(bytes, int64)/3_int64
      do group = 0_int64, n_whole - 1_int64
         text(4*group + 1:4*group + 4) = four_letters(bytes(3*group + 1:3*group + 3))
      end do
      n_left = int(len(bytes, int64) - 3_int64*n_whole)
      if (n_left == 0) return
      text(4*n_whole + 1:) = four_letters(bytes(3*n_whole + 1:)//repeat(char(0), 3 - n_left))
      text(4*n_whole + n_left + 2:) = repeat('=', 3 - n_left)
   end function encode_base64

   !> The four letters that encode three bytes in base64.
   pure character(4) function four_letters(bytes)
      character(3), intent(in) :: bytes !! the bytes
      integer :: word

      word = ior(ishft(ichar(bytes(1:1)), 16), ior(ishft(ichar(bytes(2:2)), 8), ichar(bytes(3:3))))
      four_letters(:2) = pair(ishft(word, -12))
      four_letters(3:) = pair(iand(word, n_pairs - 1))
   end function four_letters

   !> Decodes letters.
   pure subroutine decode_base64(text, n_bytes, bytes, is_valid)
      character(*), intent(in) :: text !! the letters, `base64_size` of the number of bytes
      integer(int64), intent(in) :: n_bytes !! number of bytes
      character(:), allocatable, intent(out) :: bytes !! the bytes; undefined if the letters are not valid
      logical, intent(out) :: is_valid !! whether these are the letters of so many bytes
      integer(int64) :: group, n_whole
      character(3) :: last
      integer :: n_left

      is_valid = .true.
      allocate (character(n_bytes) :: bytes)
      n_whole = n_bytes/3_int64
      do group = 0_int64, n_whole - 1_int64
         call decode_group(text(4*group + 1:4*group + 4), bytes(3*group + 1:3*group + 3), is_valid)
      end do
      n_left = int(n_bytes - 3_int64*n_whole)
      if (n_left == 0) return
      call decode_group(text(4*n_whole + 1:4*n_whole + n_left + 1)//repeat('A', 3 - n_left), last, is_valid)
      is_valid = is_valid .and. text(4*n_whole + n_left + 2:) == repeat('=', 3 - n_left)
      bytes(3*n_whole + 1:) = last(:n_left)
   end subroutine decode_base64

   !> Decodes four base64 letters to three bytes.
   pure subroutine decode_group(text, bytes, is_valid)
      character(4), intent(in) :: text !! the letters
      character(3), intent(out) :: bytes !! the bytes
      logical, intent(inout) :: is_valid !! becomes false if one of them is no letter of base64
      integer :: numbers(4), word, k

      do k = 1, 4
         numbers(k) = number(ichar(text(k:k)))
      end do
      is_valid = is_valid .and. all(numbers >= 0)
      word = ior(ior(ishft(numbers(1), 18), ishft(numbers(2), 12)), ior(ishft(numbers(3), 6), numbers(4)))
      do k = 1, 3
         bytes(k:k) = char(iand(ishft(word, 8*(k - 3)), n_characters - 1))
      end do
   end subroutine decode_group

   !> Opens a file for a grid under a temporary name.
   subroutine new_vtk_file(vtk, path, units, error)
      type(vtk_file_t), intent(out) :: vtk !! the grid
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: units !! names of the units of the case
      type(error_t), allocatable, intent(out) :: error !! the file cannot be opened

      vtk%units = units
      call new_output_file(vtk%file, path, .true., error)
   end subroutine new_vtk_file

   !> Begins the markup of a grid.
   pure subroutine vtk_file_begin_grid(self, n_points, n_cells)
      class(vtk_file_t), intent(inout) :: self !! the grid
      integer, intent(in) :: n_points !! number of points
      integer, intent(in) :: n_cells !! number of cells

      self%section = ''
      self%markup = '<?xml version="1.0"?>'//newline// &
         '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">'//newline// &
         '  <UnstructuredGrid>'//newline//'    <Piece NumberOfPoints="'//to_text(n_points)//'" NumberOfCells="'// &
         to_text(n_cells)//'">'//newline
   end subroutine vtk_file_begin_grid

   !> Completes the markup before an array.
   pure subroutine vtk_file_begin_array(self, section, type, name, n_components, dimension)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section it belongs to
      character(*), intent(in) :: type !! VTK's word for the kind of number
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: n_components !! numbers per point or cell
      character(*), intent(in) :: dimension !! its dimension, as `unit_of` takes it

      call self%enter(section)
      self%label = unit_of(self%units, dimension)
      self%markup = self%markup//'        <DataArray type="'//type//'" Name="'//name//'"'
      ! Readers take a stated single component for a column, an unstated one for a plain array.
      if (n_components > 1) self%markup = self%markup//' NumberOfComponents="'//to_text(n_components)//'"'
      self%markup = self%markup//' format="binary">'
   end subroutine vtk_file_begin_array

   !> Begins the markup behind an array.
   pure subroutine vtk_file_end_array(self)
      class(vtk_file_t), intent(inout) :: self !! the grid

      self%markup = ''
      ! The key that readers on VTK know. It follows the numbers, where no other reader looks for them.
      if (len(self%label) > 0) self%markup = '<InformationKey name="UNITS_LABEL" location="vtkDataArray">'// &
         xml_escaped(self%label)//'</InformationKey>'
      self%markup = self%markup//'</DataArray>'//newline
   end subroutine vtk_file_end_array

   !> Completes the markup behind the last array.
   pure subroutine vtk_file_end_grid(self)
      class(vtk_file_t), intent(inout) :: self !! the grid

      call self%enter('')
      self%markup = self%markup//'    </Piece>'//newline//'  </UnstructuredGrid>'//newline//'</VTKFile>'//newline
   end subroutine vtk_file_end_grid

   !> Closes the present section and opens another one, or none if its name is empty.
   pure subroutine vtk_file_enter(self, section)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! the section to enter

      if (section == self%section) return
      if (len(self%section) > 0) self%markup = self%markup//'      </'//self%section//'>'//newline
      if (len(section) > 0) self%markup = self%markup//'      <'//section//'>'//newline
      self%section = section
   end subroutine vtk_file_enter

   !> Passes an array of reals to the file.
   subroutine vtk_file_put_reals(self, section, name, dimension, n_components, values)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData', 'Points' or 'Cells', in this order
      character(*), intent(in) :: name !! name of the quantity
      character(*), intent(in) :: dimension !! its dimension, as `unit_of` takes it
      integer, intent(in) :: n_components !! numbers per point or cell
      real(dp), intent(in) :: values(:) !! the values, those of one point or cell together

      if (.not. allocated(self%not_finite)) then
         if (.not. all(ieee_is_finite(values))) self%not_finite = name
      end if
      call self%begin_array(section, 'Float64', name, n_components, dimension)
      call write_array(self, size(values, kind=int64), reals=values)
   end subroutine vtk_file_put_reals

   !> Passes an array of integers to the file.
   subroutine vtk_file_put_integers(self, section, name, values)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData', 'Points' or 'Cells', in this order
      character(*), intent(in) :: name !! name of the quantity
      integer, intent(in) :: values(:) !! the values

      call self%begin_array(section, 'Int32', name, 1, '')
      call write_array(self, size(values, kind=int64), integers=values)
   end subroutine vtk_file_put_integers

   !> Writes an array with the markup before it: the number of its bytes, then the bytes in pieces, since an array may
   !> be as large as the largest object of a run.
   subroutine write_array(vtk, n, reals, integers)
      class(vtk_file_t), intent(inout) :: vtk !! the grid
      integer(int64), intent(in) :: n !! number of numbers
      real(dp), intent(in), optional :: reals(:) !! the numbers, if they are reals
      integer, intent(in), optional :: integers(:) !! the numbers, if they are integers
      character(piece_size) :: piece
      integer(int64) :: first, last, at, end, bytes_each

      bytes_each = merge(8_int64, 4_int64, present(reals))
      ! allow(C181): `finish` checks the state
      if (vtk%state == 0) write (vtk%file%unit, iostat=vtk%state) vtk%markup
      at = bytes_per_length
      piece(:at) = transfer(bytes_each*n, piece(:at))
      first = 1_int64
      do
         last = min(n, first - 1_int64 + (piece_size - at)/bytes_each)
         end = at + bytes_each*(last - first + 1_int64)
         if (present(reals)) then
            piece(at + 1:end) = transfer(reals(first:last), piece)
         else
            piece(at + 1:end) = transfer(int(integers(first:last), int32), piece)
         end if
         ! allow(C181): `finish` checks the state
         if (vtk%state == 0) write (vtk%file%unit, iostat=vtk%state) encode_base64(piece(:end))
         if (last == n) exit
         first = last + 1_int64
         at = 0_int64
      end do
      call vtk%end_array()
   end subroutine write_array

   !> Passes an array to the grid with its components in another order, zeros for missing ones.
   subroutine vtk_file_put_spread(self, section, name, dimension, values, n)
      class(vtk_file_t), intent(inout) :: self !! the grid
      character(*), intent(in) :: section !! 'PointData', 'CellData' or 'Points', in this order
      character(*), intent(in) :: name !! name of the quantity
      character(*), intent(in) :: dimension !! its dimension, as `unit_of` takes it
      real(dp), intent(in) :: values(:, :) !! the values (components, any)
      integer, intent(in) :: n !! number of components in the file; 0 beyond those of the values
      real(dp), allocatable :: spread_out(:, :)

      allocate (spread_out(n, size(values, 2)), source=0.0_dp)
      spread_out(:size(values, 1), :) = values
      call self%put_reals(section, name, dimension, n, reshape(spread_out, [size(spread_out)]))
   end subroutine vtk_file_put_spread

   !> Passes points and cells to the file.
   subroutine vtk_file_put_cells(self, coordinates, connectivity, ends, types)
      class(vtk_file_t), intent(inout) :: self !! the grid
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the points (2, n_points) [L]
      integer, intent(in) :: connectivity(:) !! points of the cells, from 1, cell after cell
      integer, intent(in) :: ends(:) !! where the points of each cell end (n_cells)
      integer, intent(in) :: types(:) !! VTK's number of each cell's kind (n_cells)

      call self%put_spread('Points', 'points', 'L', coordinates, in_space)
      call self%put_integers('Cells', 'connectivity', connectivity - 1)
      call self%put_integers('Cells', 'offsets', ends)
      call self%put_integers('Cells', 'types', types)
   end subroutine vtk_file_put_cells

   !> Completes and closes the file, which still has its temporary name.
   subroutine vtk_file_finish(self, file, error)
      class(vtk_file_t), intent(inout) :: self !! the grid
      type(output_file_t), intent(out) :: file !! the finished file
      type(error_t), allocatable, intent(out) :: error !! not everything could be written, or a number is not finite

      call self%end_grid()
      ! allow(C181): the output file's own `finish` checks the state
      if (self%state == 0) write (self%file%unit, iostat=self%state) self%markup
      call self%file%finish(self%state, error)
      file = self%file
      if (allocated(self%not_finite) .and. .not. allocated(error)) call new_error(error, numerical_failure, &
         "the quantity '"//self%not_finite//"' leaves the range of double precision (1.8e308): choose other units")
   end subroutine vtk_file_finish

   !> Writes the two grids of a case or step to a folder, and gives them their final names.
   subroutine write_grids(manifest, units, directory, stem, body, result, error)
      type(manifest_t), intent(inout) :: manifest !! gains them
      character(*), intent(in) :: units !! names of the units of the case
      character(*), intent(in) :: directory !! output directory, a slash behind it
      character(*), intent(in) :: stem !! name of the files without endings in it, with their folder
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(2)

      call write_case_grids(files, directory//stem, units, body, result, error)
      if (.not. allocated(error)) call manifest%add_outputs(files, stem(:index(stem, '/', back=.true.)), error)
      call commit_files(files, error)
   end subroutine write_grids

   !> Writes the two grids of a case under temporary names.
   subroutine write_case_grids(files, stem, units, body, result, error)
      type(output_file_t), intent(inout) :: files(2) !! the finished files
      character(*), intent(in) :: stem !! name of the files without endings
      character(*), intent(in) :: units !! names of the units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(vtk_file_t) :: vtk

      call new_vtk_file(vtk, stem//'.vtu', units, error)
      if (allocated(error)) return
      call show_body(vtk, body, result)
      call vtk%finish(files(1), error)
      if (.not. allocated(error)) call new_vtk_file(vtk, stem//'.contact.vtu', units, error)
      if (allocated(error)) return
      call show_contact_line(vtk, body, result)
      call vtk%finish(files(2), error)
   end subroutine write_case_grids

   !=vtu `displacement` | nodes, 3 components | L | displacement of every node
   !=vtu `gap`, `slip` | nodes | L | as in the table; 0 at nodes that are no contact points; nodes of cells of constant
   !=   multipliers have the mean of their cells, here and below
   !=vtu `contact_pressure`, `contact_shear`, `shear_bound` | nodes | F/L² | as in the table; 0 at other nodes
   !=vtu `status` | nodes | | 1 to 5, see [Statuses](#statuses); 0 at other nodes
   !=vtu `nodal_stress` | nodes, 6 components | F/L² | stress xx, yy, zz, xy, yz, xz: what the elements around the node
   !=   say there, on the mean; tension positive; zz follows from the hypothesis. Between two materials the mean of both
   !=   sides
   !=vtu `nodal_von_mises` | nodes | F/L² | von Mises stress of the nodal stress
   !=vtu `stress` | cells, 6 components | F/L² | mean stress of the element
   !=vtu `von_mises` | cells | F/L² | von Mises stress of the mean stress
   !=vtu `strain_energy_density` | cells | F/L² | mean strain energy per volume
   !=vtu `error_norm` | cells | √(F L) | estimated error of the stresses of the element, see [Accuracy](#accuracy); the
   !=   root of the sum of squares is that of the body
   !=vtu `material` | cells | | number of the `&material` group, in the order of the deck
   !> Passes the body and its result to a file, which writes or compares them.
   subroutine show_body(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      real(dp) :: share, largest(body%mesh%n_nodes)
      integer :: status(body%mesh%n_nodes), all_nodes(body%mesh%n_nodes), i, k, p

      call vtk%begin_grid(body%mesh%n_nodes, body%mesh%n_elements)
      call vtk%put_spread('PointData', 'displacement', 'L', result%displacement, in_space)
      ! Hands over the contact quantities of all nodes: 0 at those that are no contact points. A node of cells of
      ! constant multipliers has the mean of theirs, by its shares in them, and the status of the one where its share is
      ! largest, the first of equal ones.
      call contact_columns(columns, body, result)
      all_nodes = [(i, i=1, body%mesh%n_nodes)]
      do i = 1, size(columns)
         if (.not. columns(i)%is_field) cycle
         vtk%scale = columns(i)%scale
         call vtk%put_reals('PointData', trim(columns(i)%key), trim(columns(i)%dimension), 1, &
            at_nodes(body, columns(i)%values, all_nodes))
      end do
      vtk%scale = 0.0_dp
      status = 0
      largest = 0.0_dp
      associate (rows => body%zone%rows)
         do p = 1, body%zone%n_points
            do k = rows%start(p), body%zone%last_own_part(p)
               share = norm2(rows%block(:, 1, k))*body%zone%area(p)
               if (exceeds(share, largest(rows%node(k)))) status(rows%node(k)) = result%solution%status(p)
               largest(rows%node(k)) = max(largest(rows%node(k)), share)
            end do
         end do
      end associate
      call vtk%put_integers('PointData', 'status', status)
      call vtk%put_spread('PointData', 'nodal_stress', 'F/L^2', result%stress%node, as_tensor)
      call vtk%put_reals('PointData', 'nodal_von_mises', 'F/L^2', 1, all_von_mises(result%stress%node))
      call vtk%put_spread('CellData', 'stress', 'F/L^2', result%stress%element, as_tensor)
      call vtk%put_reals('CellData', 'von_mises', 'F/L^2', 1, all_von_mises(result%stress%element))
      call vtk%put_reals('CellData', 'strain_energy_density', 'F/L^2', 1, result%stress%energy_density)
      if (allocated(result%error_estimate)) then
         ! That of the stresses: an error far below is rounding.
         vtk%scale = result%error_estimate%norm/max(result%error_estimate%relative, tiny(1.0_dp))
         call vtk%put_reals('CellData', 'error_norm', 'sqrt(F L)', 1, result%error_estimate%element)
         vtk%scale = 0.0_dp
      end if
      call vtk%put_integers('CellData', 'material', body%materials%of_element)
      call vtk%put_cells(body%mesh%coordinates, body%mesh%node, body%mesh%node_start(2:) - 1, &
         vtk_cell_type(body%mesh%element_kind))
   end subroutine show_body

   !=contact.vtu `normal` | nodes, 3 components | – | unit outward normal of the body
   !=contact.vtu `slip_vector`, `force` | nodes, 3 components | L, F | of a solid: slip since rest, and force of the
   !=   obstacle on the body
   !=contact.vtu `set` | nodes | | number of the `&contact` group, in the order of the deck
   !=contact.vtu `jump` | nodes, 3 components | L | with pairs: displacement of the slave relative to the master; 0 on
   !=   the master
   !=contact.vtu `force` | nodes, 3 components | F | with pairs: contact force on the body there: the transmitted ones
   !=   on the master; they sum to 0
   !> Passes the contact line and its result to a file, which writes or compares them.
   subroutine show_contact_line(vtk, body, result)
      class(vtk_file_t), intent(inout) :: vtk !! the file
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      type(contact_rows_t) :: slave
      type(master_line_t) :: line
      real(dp), allocatable :: moved(:, :)
      integer :: i, n_lines
      integer, allocatable :: segments(:, :), lone(:), cells(:), offsets(:), types(:)
      logical, allocatable :: is_lone(:)

      call contact_columns(columns, body, result)
      allocate (cells(0), offsets(0), types(0))
      if (allocated(body%zone%line)) then
         call new_master_line(line, body%zone)
      else
         call new_contact_faces(cells, offsets, types, line, body, result%load_case%contacts)
      end if
      associate (zone => body%zone)
         ! Segments from point to point, then points without a neighbor.
         allocate (segments(2, 0), is_lone(zone%n_points))
         if (allocated(zone%line)) segments = zone%line%segments()
         is_lone = allocated(zone%line)
         is_lone([segments]) = .false.
         lone = pack([(i, i=1, zone%n_points)], is_lone)
         call vtk%begin_grid(zone%n_points + line%n_nodes, size(segments, 2) + size(lone) &
            + size(line%segment, 2) + size(offsets))
      end associate
      ! Displacements and normals; where there are pairs, how far they move apart, and the forces, too.
      associate (zone => body%zone, u => result%displacement, force => result%solution%force)
         if (allocated(zone%line)) then
            slave = side_rows(zone, .false.)
            moved = zone%global_vectors(slave%displacement(u))
         else
            moved = u(:, zone%rows%node(zone%rows%start(:zone%n_points)))
         end if
         call vtk%put_spread('PointData', 'displacement', 'L', joined(moved, u(:, line%node)), in_space)
         call vtk%put_spread('PointData', 'normal', '', joined(zone%frame(:size(line%normal, 1), 1, :), line%normal), &
            in_space)
         if (.not. allocated(zone%line)) then
            vtk%scale = maxval(abs(u))
            associate (m => zone%n_points)
               call vtk%put_spread('PointData', 'slip_vector', 'L', joined(zone%global_vectors([0.0_dp*force(:m), &
                  zone%free_slips(result%solution%displacement(m + 1:))]), 0.0_dp*u(:, line%node)), in_space)
            end associate
         else if (line%n_nodes > 0) then
            vtk%scale = maxval(abs(u))
            call vtk%put_spread('PointData', 'jump', 'L', &
               joined(zone%global_vectors(zone%rows%displacement(u)), 0.0_dp*u(:, line%node)), in_space)
         end if
         if (line%n_nodes > 0 .or. .not. allocated(zone%line)) then
            vtk%scale = maxval([0.0_dp, abs(force)])
            call vtk%put_spread('PointData', 'force', 'F', &
               joined(-zone%global_vectors(force), line%forces(zone, force, body%mesh%n_nodes)), in_space)
         end if
      end associate
      do i = 1, size(columns)
         if (.not. columns(i)%is_field) cycle
         vtk%scale = columns(i)%scale
         call vtk%put_reals('PointData', trim(columns(i)%key), trim(columns(i)%dimension), 1, &
            [columns(i)%values, at_nodes(body, columns(i)%values, line%node)])
      end do
      vtk%scale = 0.0_dp
      call vtk%put_integers('PointData', 'status', [result%solution%status, 0*line%node])
      call vtk%put_integers('PointData', 'set', [body%zone%set, line%set])
      associate (zone => body%zone)
         n_lines = size(segments, 2) + size(line%segment, 2)
         call vtk%put_cells(joined(zone%position, body%mesh%coordinates(:, line%node)), &
            [segments, zone%n_points + [line%segment], lone, cells], &
            [(2*i, i=1, n_lines), (2*n_lines + i, i=1, size(lone)), offsets], &
            [spread(vtk_line, 1, n_lines), spread(vtk_vertex, 1, size(lone)), types])
      end associate
   end subroutine show_contact_line

   !> Finds the contact faces of a solid, those of the masters of pairs among them. Their nodes that are no contact
   !> points follow the points.
   pure subroutine new_contact_faces(cells, offsets, types, line, body, contacts)
      integer, allocatable, intent(out) :: cells(:) !! the nodes of each face, by their numbers in the grid
      integer, allocatable, intent(out) :: offsets(:) !! where they end (faces)
      integer, allocatable, intent(out) :: types(:) !! their kinds, by VTK's numbers (faces)
      type(master_line_t), intent(out) :: line !! the nodes that are no contact points, without segments
      type(body_t), intent(in) :: body !! the body
      type(contact_t), intent(in) :: contacts(:) !! the contact sets
      type(patch_t) :: patch
      type(error_t), allocatable :: error
      integer :: place(body%mesh%n_nodes), set, i, k, p, role
      logical :: are_corners

      allocate (cells(0), offsets(0), types(0), line%node(0), line%set(0), line%segment(2, 0), line%normal(3, 0))
      associate (rows => body%zone%rows)
         do set = 1, size(contacts)
            ! The point of this set, or else that of an earlier one which it continues.
            place = 0
            do k = 1, 2
               do p = 1, body%zone%n_points
                  if (body%zone%set(p) == set .eqv. k == 2) place(rows%node(rows%start(p))) = p
               end do
            end do
            do role = 1, merge(2, 1, contacts(set)%pairing%is_pair())
               ! not raised: the contact zone has been made of these sets
               if (role == 1) call new_patch(patch, body%mesh, contacts(set)%set, error)
               if (role == 2) call new_patch(patch, body%mesh, contacts(set)%pairing%against, error)
               are_corners = role == 1 .and. allocated(body%zone%pairs(set)%segments)
               do i = 1, patch%n_nodes
                  associate (node => patch%node(i))
                     if (place(node) > 0 .or. (are_corners .and. patch%ends(1, i) > 0)) cycle
                     line%n_nodes = line%n_nodes + 1
                     place(node) = body%zone%n_points + line%n_nodes
                     line%node = [line%node, node]
                     line%set = [line%set, set]
                     line%normal = reshape([line%normal, patch%normal(:, i)], [3, line%n_nodes])
                  end associate
               end do
               do i = 1, size(patch%faces)
                  associate (face => patch%faces(i), n => merge(n_face_corners(patch%faces(i)), &
                     patch%faces(i)%n_nodes, are_corners))
                     cells = [cells, place(face%node(:n))]
                     offsets = [offsets, size(cells)]
                     types = [types, vtk_face_type(n)]
                  end associate
               end do
            end do
         end do
      end associate
   end subroutine new_contact_faces

   !> Number of VTK of a face, by its nodes.
   elemental integer function vtk_face_type(n_nodes)
      integer, intent(in) :: n_nodes !! number of its nodes: 3, 4, 6 or 8

      vtk_face_type = vtk_cell_type(findloc([3, 4, 6, 8] == n_nodes, .true., dim=1))
   end function vtk_face_type

   !> Vectors of the contact points followed by those of the masters' nodes.
   pure function joined(at_points, at_masters)
      real(dp), intent(in) :: at_points(:, :) !! the vectors of the points (components, m)
      real(dp), intent(in) :: at_masters(:, :) !! those of the nodes (components, n_nodes)
      real(dp), allocatable :: joined(:, :)

      allocate (joined(size(at_points, 1), size(at_points, 2) + size(at_masters, 2)))
      joined(:, :size(at_points, 2)) = at_points
      joined(:, size(at_points, 2) + 1:) = at_masters
   end function joined

end module amontons_vtu
