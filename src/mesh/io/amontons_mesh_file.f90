!> Meshes from files: Gmsh's MSH and the input format of Abaqus and CalculiX, told apart by their first character.
module amontons_mesh_file
   use amontons_abaqus, only: read_abaqus
   use amontons_error, only: error_t
   use amontons_file_model, only: file_model_t, use_names
   use amontons_gmsh, only: read_gmsh
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_mesh, only: mesh_t
   use amontons_mesh_cleanup, only: new_clean_mesh
   use amontons_raw_mesh, only: raw_mesh_t
   implicit none (type, external)
   private

   public :: read_file_model, read_mesh_file, read_used_mesh

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

end module amontons_mesh_file
