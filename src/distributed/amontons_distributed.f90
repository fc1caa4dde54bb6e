!> The run on several ranks, as the rest of the program sees it; a build without MPI has a twin of this module.
module amontons_distributed
   use amontons_condenser, only: condenser_t
   use amontons_constraints, only: constraints_t, dof_map_t, spring_side_t
   use amontons_distributed_condenser, only: dismiss_ranks, distributed_condenser_t, first_free_order, follow_order, &
      order_end, share_condenser, spread_and_analyze => new_distributed_condenser
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_mumps, only: mumps_text
   use amontons_rank_work, only: check_room
   use amontons_ranks, only: all_ranks, begin_ranks, broadcast, end_ranks, give_order, has_begun, line_t, n_ranks, &
      next_order, on_all_ranks, rank
   implicit none (type, external)
   private

   public :: all_ranks, begin_ranks, broadcast, check_room, dismiss_ranks, end_ranks, first_free_order, follow_order, &
      give_order, line_t, mpi_text, n_ranks, new_distributed_condenser, next_order, on_all_ranks, order_end, rank, &
      share_condenser

contains

   !> What --version says of MPI.
   function mpi_text() result(text)
      character(:), allocatable :: text

      text = 'yes, MUMPS '//mumps_text()
   end function mpi_text

   !> Spreads a body over the ranks, assembles its stiffness and analyzes it.
   subroutine new_distributed_condenser(condenser, is_held, mesh, materials, springs, constraints, dof_map, error)
      class(condenser_t), allocatable, intent(out) :: condenser !! the condenser
      logical, intent(in) :: is_held !! whether supports alone hold the body
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(constraints_t), intent(in) :: constraints !! the supports
      type(dof_map_t), intent(in) :: dof_map !! numbers of the unknowns
      type(error_t), allocatable, intent(out) :: error !! memory ran out, or there are no ranks

      if (.not. has_begun) then
         call new_error(error, input_refused, "factorization = 'distributed' is for a run on several ranks: "// &
            'mpiexec -n 2 amontons ...')
         return
      end if
      allocate (distributed_condenser_t :: condenser)
      select type (condenser)
      type is (distributed_condenser_t)
         call spread_and_analyze(condenser, is_held, mesh, materials, springs, constraints, dof_map, error)
      end select
   end subroutine new_distributed_condenser

end module amontons_distributed
