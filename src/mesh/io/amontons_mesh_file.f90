!> The parts of a mesh, a body each: a generated rectangle or a file, where it is put and how its sets are named. Files
!> are Gmsh's MSH or in the input format of Abaqus and CalculiX, told apart by their first character.
module amontons_mesh_file
   use amontons_abaqus, only: read_abaqus
   use amontons_error, only: error_t
   use amontons_file_model, only: file_model_t, use_names
   use amontons_gmsh, only: read_gmsh
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_joined_mesh, only: append_mesh, name_mesh
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_mesh_cleanup, only: new_clean_mesh
   use amontons_raw_mesh, only: raw_mesh_t
   use amontons_rectangle, only: new_rectangle_mesh, rectangle_t
   use amontons_refined_mesh, only: refine_mesh
   use amontons_text, only: newline
   implicit none (type, external)
   private

   public :: mesh_part_t, new_mesh, read_file_model, read_mesh_file

   !> A part of a mesh.
   type :: mesh_part_t
      character(:), allocatable :: name !! its name; empty where its sets keep theirs
      character(:), allocatable :: file !! name of the mesh file from the root on; empty for a rectangle
      logical :: is_used(size(use_names)) = .false. !! which of `use_names` are taken from the file, too
      type(rectangle_t) :: rectangle !! the rectangle that it is where there is no file
      real(dp) :: origin(2) = 0.0_dp !! where the origin of its own coordinates is put [L]
      integer :: n_refinements = 0 !! how often every element is cut in four
      character(:), allocatable :: place !! where it was specified, for messages: 'deck.nml:12: '
   end type mesh_part_t

contains

   !> Reads a mesh file; what can be put right is, with a note, and the rest is refused.
   subroutine read_mesh_file(mesh, file, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh; quadratic elements still need `mesh%check`
      character(*), intent(in) :: file !! name of the file
      character(:), allocatable, intent(out) :: notes
         !! what was put right or left out, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file, and where
      logical :: nothing(size(use_names))

      nothing = .false.
      call read_used_mesh(mesh, file, nothing, notes, error)
   end subroutine read_mesh_file

   !> Reads a mesh file of which more than the mesh is used. The mesh has the sets that `read_file_model` names.
   subroutine read_used_mesh(mesh, file, is_used, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh; quadratic elements still need `mesh%check`
      character(*), intent(in) :: file !! name of the file
      logical, intent(in) :: is_used(:) !! which of `use_names` are used
      character(:), allocatable, intent(out) :: notes
         !! what was put right or left out, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file, and where
      type(input_file_t) :: input
      type(raw_mesh_t) :: raw

      call read_raw_mesh(raw, input, file, is_used, error)
      if (allocated(error)) return
      if (.not. allocated(input%error)) call new_clean_mesh(mesh, raw, input)
      call move_alloc(input%error, error)
      mesh%source = file
      call mesh%files%add(file)
      notes = ''
      if (allocated(raw%notes)) notes = raw%notes
   end subroutine read_used_mesh

   !> Reads what a mesh file says beside the mesh.
   subroutine read_file_model(model, file, is_used, error)
      type(file_model_t), intent(out) :: model !! materials, supports and loads
      character(*), intent(in) :: file !! name of the file
      logical, intent(in) :: is_used(:) !! which of `use_names` are used
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file, and where
      type(input_file_t) :: input
      type(raw_mesh_t) :: raw

      call read_raw_mesh(raw, input, file, is_used, error)
      if (allocated(error)) return
      call move_alloc(input%error, error)
      model = raw%model
   end subroutine read_file_model

   !> Reads a mesh file as it is.
   subroutine read_raw_mesh(raw, input, file, is_used, error)
      type(raw_mesh_t), intent(out) :: raw !! what it says
      type(input_file_t), intent(out) :: input !! the file, with the first fault in it
      character(*), intent(in) :: file !! its name
      logical, intent(in) :: is_used(:) !! which of `use_names` are used
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read

      call new_input_file(input, file, error)
      if (allocated(error)) return
      raw%model%is_used = is_used
      call input%skip_white()
      select case (input%text(min(input%position, len(input%text)):min(input%position, len(input%text))))
      case ('$')
         if (any(is_used)) call input%refuse( &
            'materials, supports and loads can be used of Abaqus and CalculiX files only')
         call read_gmsh(raw, input)
      case ('*')
         call read_abaqus(raw, input)
      case default
         call input%refuse('neither a Gmsh mesh, which begins with $MeshFormat, nor an Abaqus one, which begins '// &
            'with a keyword such as *NODE; a .geo file is to be meshed first: gmsh -2')
      end select
   end subroutine read_raw_mesh

   !> Makes or reads the parts of a mesh. Refinements that all have in common come last, so that a mesh that is refined
   !> once more keeps the numbers of its nodes.
   subroutine new_mesh(mesh, parts, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(mesh_part_t), intent(in) :: parts(:) !! its parts, one at the least
      character(:), allocatable, intent(out) :: notes !! what was put right in files, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! a file or a rectangle is at fault
      type(mesh_t) :: other
      character(:), allocatable :: more
      integer :: i, n_common

      n_common = minval(parts%n_refinements)
      call new_part(mesh, parts(1), n_common, notes, error)
      do i = 2, size(parts)
         if (.not. allocated(error)) call new_part(other, parts(i), n_common, more, error)
         if (allocated(error)) return
         call append_mesh(mesh, other, error)
         if (allocated(error)) error%message = parts(i)%place//error%message
         if (len(notes) > 0 .and. len(more) > 0) notes = notes//newline
         notes = notes//more
      end do
      if (allocated(error)) return
      call refine_mesh(mesh, n_common, error)
      if (allocated(error)) error%message = parts(1)%place//error%message
   end subroutine new_mesh

   !> Makes or reads one part of a mesh.
   subroutine new_part(mesh, part, n_common, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      type(mesh_part_t), intent(in) :: part !! the part
      integer, intent(in) :: n_common !! how often it will be refined together with the others
      character(:), allocatable, intent(out) :: notes !! what was put right in a file, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! the file or the rectangle is at fault
      integer :: node

      notes = ''
      if (len(part%file) > 0) then
         call read_used_mesh(mesh, part%file, part%is_used, notes, error)
      else
         call new_rectangle_mesh(mesh, part%rectangle, error)
      end if
      if (allocated(error)) error%message = part%place//error%message
      if (allocated(error)) return
      do node = 1, mesh%n_nodes
         mesh%coordinates(:, node) = part%origin + mesh%coordinates(:, node)
      end do
      if (len(part%name) > 0) call name_mesh(mesh, part%name)
      call refine_mesh(mesh, part%n_refinements - n_common, error)
      if (allocated(error)) error%message = part%place//error%message
   end subroutine new_part

end module amontons_mesh_file
