!> The run on several ranks in a build without MPI: there is one rank.
module amontons_distributed
   use amontons_condenser, only: condenser_t
   use amontons_constraints, only: constraints_t, dof_map_t, spring_side_t
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: begin_ranks, dismiss_ranks, end_ranks, mpi_text, n_ranks, new_distributed_condenser, rank

   !> The rank of this process, and the number of ranks.
   integer, parameter :: rank = 0, n_ranks = 1

contains

   !> The text of --version about MPI.
   pure function mpi_text() result(text)
      character(:), allocatable :: text

      text = 'no'
   end function mpi_text

   !> Begins MPI; has no effect in a build without it.
   subroutine begin_ranks()
   end subroutine begin_ranks

   !> Ends MPI; has no effect in a build without it.
   subroutine end_ranks()
   end subroutine end_ranks

   !> Ends the service loop of the other ranks; has no effect in a build without MPI.
   subroutine dismiss_ranks()
   end subroutine dismiss_ranks

   !> Refuses a condenser that is spread over ranks.
   subroutine new_distributed_condenser(condenser, is_held, mesh, materials, springs, constraints, dof_map, error)
      class(condenser_t), allocatable, intent(inout) :: condenser !! not allocated on return
      logical, intent(in) :: is_held !! not used, as all that follow
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! the reason

      if (allocated(condenser)) deallocate (condenser)
      call new_error(error, input_refused, "factorization = 'distributed' needs MPI and MUMPS, and this program "// &
         "was built without them (scripts/build.sh mpi builds one); choose 'auto', 'band' or 'multifrontal'")
      associate (unused => is_held, mesh => mesh, materials => materials, springs => springs, &
         constraints => constraints, dof_map => dof_map)
      end associate
   end subroutine new_distributed_condenser

end module amontons_distributed
