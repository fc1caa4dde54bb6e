!> Meshes from files: Gmsh's MSH and the input format of Abaqus and CalculiX, told apart by their first character.
module amontons_mesh_file
   use amontons_abaqus, only: read_abaqus
   use amontons_error, only: error_t
   use amontons_gmsh, only: read_gmsh
   use amontons_input_file, only: input_file_t, new_input_file
   use amontons_mesh, only: mesh_t
   use amontons_mesh_cleanup, only: new_clean_mesh
   use amontons_mesh_draft, only: mesh_draft_t
   implicit none (type, external)
   private

   public :: read_mesh_file

contains

   !> Reads a mesh file; what can be put right is, with a note, and the rest is refused.
   subroutine read_mesh_file(mesh, file, notes, error)
      type(mesh_t), intent(out) :: mesh !! the mesh; quadratic elements still need `mesh%check`
      character(*), intent(in) :: file !! name of the file
      character(:), allocatable, intent(out) :: notes
         !! what was put right or left out, a line of text for each
      type(error_t), allocatable, intent(out) :: error !! what is wrong with the file, and where
      type(input_file_t) :: input
      type(mesh_draft_t) :: draft

      call new_input_file(input, file, error)
      if (allocated(error)) return
      call input%skip_white()
      select case (input%text(min(input%position, len(input%text)):min(input%position, len(input%text))))
      case ('$')
         call read_gmsh(draft, input)
      case ('*')
         call read_abaqus(draft, input)
      case default
         call input%refuse('neither a Gmsh mesh, which begins with $MeshFormat, nor an Abaqus one, which begins '// &
            'with a keyword such as *NODE; a .geo file is to be meshed first: gmsh -2')
      end select
      if (.not. allocated(input%error)) call new_clean_mesh(mesh, draft, input)
      call move_alloc(input%error, error)
      mesh%source = file
      mesh%is_file = .true.
      notes = ''
      if (allocated(draft%notes)) notes = draft%notes
   end subroutine read_mesh_file

end module amontons_mesh_file
