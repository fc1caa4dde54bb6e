!> The parts of a mesh, one for each body: a generated rectangle or a file, with its position and a prefix for the names
!> of its sets; and the union of the parts, without merging nodes. Files are Gmsh's MSH or in the input format of Abaqus
!> and CalculiX, distinguished by their first character.
module amontons_mesh_file
   use amontons_abaqus, only: read_abaqus
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_file_model, only: file_model_t, raw_mesh_t, use_names
   use amontons_generated_mesh, only: box_t, new_box_mesh, new_rectangle_mesh, rectangle_t, refine_mesh
   use amontons_gmsh, only: read_gmsh
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_kinds, only: dp
   use amontons_mesh, only: find_set, mesh_t, named_set_t, parents_t
   use amontons_mesh_cleanup, only: new_clean_mesh
   use amontons_text, only: lower_case, newline
   implicit none (type, external)
   private

   public :: append_mesh, mesh_part_t, name_mesh, new_mesh, read_file_model, read_mesh_file

   !> A part of a mesh.
   type :: mesh_part_t
      character(:), allocatable :: name !! its name; empty where its sets keep theirs
      character(:), allocatable :: file !! name of the mesh file from the root on; empty for a rectangle
      logical :: is_used(size(use_names)) = .false. !! which of `use_names` are read from the file as well
      integer :: step = 0 !! the step whose supports and loads are used; 0 if the file has only one
      type(rectangle_t) :: rectangle !! the rectangle that it is where there is no file
      logical :: is_box = .false. !! whether it is a box instead
      type(box_t) :: box !! the box
      real(dp) :: origin(3) = 0.0_dp !! position of the origin of its own coordinates [L]
      integer :: n_refinements = 0 !! number of uniform refinements
      integer :: n_finest = 0 !! that of the finest mesh of a study on several ones, which is checked to be possible
      character(:), allocatable :: place !! where it was specified, for messages: 'deck.nml:12: '
   end type mesh_part_t

contains

   !> Prefixes the names of all sets and regions of a mesh with a name and a point; the whole mesh becomes the region of
   !> that name.
   pure subroutine name_mesh(mesh, name)
      type(mesh_t), intent(inout) :: mesh !! the mesh
      character(*), intent(in) :: name !! the name
      type(named_set_t), allocatable :: regions(:)
      integer :: i, n

      n = 0
      if (allocated(mesh%regions)) n = size(mesh%regions)
      allocate (regions(n + 1))
      regions(1)%name = name
      regions(1)%element = [(i, i=1, mesh%n_elements)]
      if (n > 0) regions(2:) = mesh%regions
      call move_alloc(regions, mesh%regions)
      call put_name_before(mesh%sets, name)
      call put_name_before(mesh%node_sets, name)
      call put_name_before(mesh%regions(2:), name)
      mesh%source = name//': '//mesh%source
   end subroutine name_mesh

   !> Prefixes the names of sets with a name and a point.
   pure subroutine put_name_before(sets, name)
      type(named_set_t), intent(inout), optional :: sets(:) !! the sets; may be not allocated
      character(*), intent(in) :: name !! the name
      integer :: i

      if (.not. present(sets)) return
      do i = 1, size(sets)
         sets(i)%name = name//'.'//sets(i)%name
      end do
   end subroutine put_name_before

   !> Appends a mesh to another one, whose nodes and elements keep their numbers. The file numbers of the appended nodes
   !> continue after the largest one before.
   subroutine append_mesh(mesh, other, error)
      type(mesh_t), intent(inout) :: mesh !! the first mesh, both on return
      type(mesh_t), intent(in) :: other !! the mesh to append
      type(error_t), allocatable, intent(out) :: error !! both have a set or region of the same name
      type(parents_t) :: first, parents
      integer, allocatable :: tags(:)
      integer :: i, last_tag

      call refuse_doubles('set', other%sets)
      call refuse_doubles('set', other%node_sets)
      call refuse_doubles('region', other%regions)
      if (allocated(error)) return
      call join_sets(mesh%sets, other%sets)
      call join_sets(mesh%node_sets, other%node_sets)
      call join_sets(mesh%regions, other%regions)
      if (allocated(mesh%node_tag) .or. allocated(other%node_tag)) then
         tags = tags_of(mesh)
         last_tag = maxval(tags)
         tags = [tags, tags_of(other)]
         where (tags(mesh%n_nodes + 1:) > 0) tags(mesh%n_nodes + 1:) = last_tag + tags(mesh%n_nodes + 1:)
         call move_alloc(tags, mesh%node_tag)
      end if
      if (allocated(mesh%parents) .or. allocated(other%parents)) then
         first = parents_of(mesh)
         parents = parents_of(other)
         parents%start = [first%start, size(first%node) + parents%start(2:)]
         parents%node = [first%node, mesh%n_nodes + parents%node]
         parents%weight = [first%weight, parents%weight]
         mesh%parents = parents
      end if
      mesh%coordinates = reshape([mesh%coordinates, other%coordinates], [size(mesh%coordinates, 1), &
         mesh%n_nodes + other%n_nodes])
      mesh%node_start = [mesh%node_start, size(mesh%node) + other%node_start(2:)]
      mesh%node = [mesh%node, mesh%n_nodes + other%node]
      mesh%element_kind = [mesh%element_kind, other%element_kind]
      mesh%n_nodes = mesh%n_nodes + other%n_nodes
      mesh%n_elements = mesh%n_elements + other%n_elements
      mesh%source = mesh%source//'; '//other%source
      mesh%has_pieces = mesh%has_pieces .or. other%has_pieces
      mesh%hypothesis = merge(other%hypothesis, mesh%hypothesis, mesh%hypothesis == '')
      do i = 1, other%files%n()
         call mesh%files%add(other%files%item(i))
      end do
      do i = 1, other%warnings%n()
         call mesh%warnings%add(other%warnings%item(i))
      end do

   contains

      !> Refuses names of sets that the first mesh has as well.
      subroutine refuse_doubles(noun, sets)
         character(*), intent(in) :: noun !! kind of thing that they are names of: 'set' or 'region'
         type(named_set_t), intent(in), optional :: sets(:) !! sets of the other mesh; may be not allocated
         logical :: is_double

         if (.not. present(sets)) return
         do i = 1, size(sets)
            is_double = find_set(mesh%sets, sets(i)%name) + find_set(mesh%node_sets, sets(i)%name) > 0
            if (noun == 'region') is_double = find_set(mesh%regions, sets(i)%name) > 0
            if (is_double .and. .not. allocated(error)) call new_error(error, input_refused, &
               'another &mesh has the '//noun//" '"//sets(i)%name//"' too; give each &mesh a name of its own")
         end do
      end subroutine refuse_doubles

      !> Appends the sets of another mesh.
      subroutine join_sets(sets, others)
         type(named_set_t), allocatable, intent(inout) :: sets(:) !! sets of the first mesh, not allocated for none
         type(named_set_t), allocatable, intent(in) :: others(:) !! the others, not allocated for none
         type(named_set_t), allocatable :: both(:)
         integer :: n

         if (.not. allocated(others)) return
         n = 0
         if (allocated(sets)) n = size(sets)
         allocate (both(n + size(others)))
         if (n > 0) both(:n) = sets
         both(n + 1:) = others
         do i = n + 1, size(both)
            if (allocated(both(i)%element)) both(i)%element = mesh%n_elements + both(i)%element
            if (allocated(both(i)%node)) both(i)%node = mesh%n_nodes + both(i)%node
         end do
         call move_alloc(both, sets)
      end subroutine join_sets

   end subroutine append_mesh

   !> The parents of the nodes of a mesh; empty ones for a mesh that is not refined.
   pure function parents_of(mesh) result(parents)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(parents_t) :: parents

      if (allocated(mesh%parents)) then
         parents = mesh%parents
      else
         allocate (parents%start(mesh%n_nodes + 1), source=1)
         allocate (parents%node(0), parents%weight(0))
      end if
   end function parents_of

   !> The numbers of the nodes in the mesh file, 0 for a node of refinement.
   pure function tags_of(mesh) result(tags)
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, allocatable :: tags(:)
      integer :: i

      if (allocated(mesh%node_tag)) then
         tags = [mesh%node_tag, spread(0, 1, mesh%n_nodes - size(mesh%node_tag))]
      else
         tags = [(i, i=1, mesh%n_nodes)]
      end if
   end function tags_of

   !> Reads a mesh file; harmless defects are repaired, with a note, and others are refused. If materials, supports or
   !> loads of the file are used, the mesh has the sets that `read_file_model` names.
   subroutine read_mesh_file(mesh, file, notes, error, is_used, step)
      type(mesh_t), intent(out) :: mesh !! the mesh; quadratic elements still need `mesh%check`
      character(*), intent(in) :: file !! name of the file
      character(:), allocatable, intent(out) :: notes
         !! repairs and omissions, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! the first fault of the file, with its position
      logical, intent(in), optional :: is_used(:) !! which of `use_names` are used; none without it
      integer, intent(in), optional :: step !! the step whose supports and loads are used; the only one without it
      type(input_file_t) :: input
      type(raw_mesh_t) :: raw

      call read_raw_mesh(raw, input, file, error, is_used, step)
      if (allocated(error)) return
      if (.not. allocated(input%error)) call new_clean_mesh(mesh, raw, input)
      call move_alloc(input%error, error)
      mesh%source = file
      mesh%files = input%files
      notes = ''
      if (allocated(raw%notes)) notes = raw%notes
   end subroutine read_mesh_file

   !> Reads materials, supports, loads and contact of a mesh file.
   subroutine read_file_model(model, file, is_used, step, error)
      type(file_model_t), intent(out) :: model !! materials, supports and loads
      character(*), intent(in) :: file !! name of the file
      logical, intent(in) :: is_used(:) !! which of `use_names` are used
      integer, intent(in) :: step !! the step whose supports and loads are used; 0 if the file has only one
      type(error_t), allocatable, intent(out) :: error !! the first fault of the file, with its position
      type(input_file_t) :: input
      type(raw_mesh_t) :: raw

      call read_raw_mesh(raw, input, file, error, is_used, step)
      if (allocated(error)) return
      call move_alloc(input%error, error)
      model = raw%model
   end subroutine read_file_model

   !> Reads a mesh file as it is, before its defects are repaired.
   subroutine read_raw_mesh(raw, input, file, error, is_used, step)
      type(raw_mesh_t), intent(out) :: raw !! its contents
      type(input_file_t), intent(out) :: input !! the file, with the first fault in it
      character(*), intent(in) :: file !! its name
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read
      logical, intent(in), optional :: is_used(:) !! which of `use_names` are used; none without it
      integer, intent(in), optional :: step !! the step whose supports and loads are used; the only one without it

      ! How many characters at the beginning tell the format.
      integer, parameter :: longest_head = 10000
      character(:), allocatable :: name

      call new_input_file(input, file, error)
      if (allocated(error)) return
      if (present(is_used)) raw%model%is_used = is_used
      if (present(step)) raw%model%step = step
      call input%skip_white()
      name = foreign_format(input%text(input%position:min(len(input%text), input%position + longest_head)))
      if (name /= '') call input%refuse(name//' files are not read: save the mesh as one of Gmsh or Abaqus, or '// &
         'take it in Python by meshio and amontons.Mesh.from_meshio')
      select case (input%text(input%position:min(input%position, len(input%text))))
      case ('$')
         if (any(raw%model%is_used)) call input%refuse( &
            'materials, supports, loads and contact can be used of Abaqus and CalculiX files only')
         call read_gmsh(raw, input)
      case ('*')
         call read_abaqus(raw, input)
      case default
         call input%refuse('neither a Gmsh mesh, which begins with $MeshFormat, nor an Abaqus one, which begins '// &
            'with a keyword such as *NODE; a .geo file is to be meshed first: gmsh -2; Python can take others by '// &
            'meshio and amontons.Mesh.from_meshio')
      end select
   end subroutine read_raw_mesh

   !> Name of the format of a file of some other programs, by its first lines; empty for any other file.
   pure function foreign_format(text) result(name)
      character(*), intent(in) :: text !! how the file begins
      character(:), allocatable :: name
      character(len(text) + 1) :: head

      head = newline//lower_case(text)
      name = ''
      if (index(text, '-1') == 1) name = 'UNV'
      if (index(head, newline//'begin bulk') + index(head, newline//'cend') > 0) name = 'Nastran'
      if (index(head, newline//'*keyword') > 0) name = 'LS-DYNA'
   end function foreign_format

   !> Makes or reads the parts of a mesh. Refinements common to all parts are done last, so that refining the mesh once
   !> more does not change the numbers of its nodes.
   subroutine new_mesh(mesh, parts, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(mesh_part_t), intent(in) :: parts(:) !! its parts, one at the least
      character(:), allocatable, intent(out) :: notes !! repairs in files, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! a file or a rectangle is invalid
      type(mesh_t) :: other
      character(:), allocatable :: more
      integer :: i, n_common

      n_common = minval(parts%n_refinements)
      call new_part(mesh, parts(1), n_common, notes, error)
      do i = 2, size(parts)
         if (.not. allocated(error)) call new_part(other, parts(i), n_common, more, error)
         if (allocated(error)) return
         if (size(mesh%coordinates, 1) /= size(other%coordinates, 1)) call new_error(error, input_refused, &
            parts(i)%place//'one &mesh is plane, and another one has solid elements')
         if (allocated(error)) return
         call append_mesh(mesh, other, error)
         if (allocated(error)) error%message = parts(i)%place//error%message
         if (len(notes) > 0 .and. len(more) > 0) notes = notes//newline
         notes = notes//more
      end do
      if (allocated(error)) return
      call refine_mesh(mesh, n_common, error, minval(parts%n_finest))
      if (allocated(error)) error%message = parts(1)%place//error%message
   end subroutine new_mesh

   !> Makes the rectangle, or reads the file, of one `&mesh`.
   subroutine new_part(mesh, part, n_common, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(mesh_part_t), intent(in) :: part !! the part
      integer, intent(in) :: n_common !! how often it will be refined together with the others
      character(:), allocatable, intent(out) :: notes !! repairs in a file, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! the file or the rectangle is invalid
      integer :: node

      notes = ''
      if (len(part%file) > 0) then
         call read_mesh_file(mesh, part%file, notes, error, part%is_used, part%step)
      else if (part%is_box) then
         call new_box_mesh(mesh, part%box, error)
      else
         call new_rectangle_mesh(mesh, part%rectangle, error)
      end if
      if (allocated(error)) error%message = part%place//error%message
      if (allocated(error)) return
      do node = 1, mesh%n_nodes
         mesh%coordinates(:, node) = part%origin(:size(mesh%coordinates, 1)) + mesh%coordinates(:, node)
      end do
      if (len(part%name) > 0) call name_mesh(mesh, part%name)
      call refine_mesh(mesh, part%n_refinements - n_common, error)
      if (allocated(error)) error%message = part%place//error%message
   end subroutine new_part

end module amontons_mesh_file
