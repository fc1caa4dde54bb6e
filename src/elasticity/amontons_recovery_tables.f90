!> What the recovery of stresses needs of a body, whatever loads it.
module amontons_recovery_tables
   use amontons_constraints, only: constraints_t, spring_side_t
   use amontons_known_traction, only: known_tractions_t, new_boundary_sides
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_patch_table, only: new_patch_table, patch_table_t
   implicit none (type, external)
   private

   public :: new_recovery_tables, recovery_tables_t

   !> The tables; about as large as the mesh.
   type :: recovery_tables_t
      type(patch_table_t) :: patches !! the patches of the elements
      type(known_tractions_t) :: sides !! the sides of the boundary, free of tractions
   end type recovery_tables_t

contains

   !> Makes the tables of a body.
   subroutine new_recovery_tables(tables, mesh, materials, constraints, springs)
      type(recovery_tables_t), intent(out) :: tables !! the tables
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(constraints_t), intent(in) :: constraints !! its supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along its sides

      call new_boundary_sides(tables%sides, mesh, constraints, springs)
      call new_patch_table(tables%patches, mesh, materials)
   end subroutine new_recovery_tables

end module amontons_recovery_tables
