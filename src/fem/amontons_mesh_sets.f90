!> The named sets of a mesh, from the groups of a draft: boundary sets, sets of nodes, regions.
module amontons_mesh_sets
   use amontons_element, only: n_corners
   use amontons_integer_list, only: integer_list_t
   use amontons_mesh, only: boundary_set_t, mesh_t, node_set_t, region_t
   use amontons_mesh_draft, only: counted, draft_group_t, mesh_draft_t, point1
   use amontons_mesh_source, only: mesh_source_t
   use amontons_side_table, only: side_of_element_t, side_table_t
   use amontons_tag_map, only: tag_map_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: name_sets

   !> A set being collected: every member once, in the order found.
   type :: collection_t
      integer, allocatable :: stamp(:) !! last set that each thing was put into
      type(integer_list_t) :: members !! the members
      integer :: set = 0 !! number of the set
   contains
      procedure :: begin => collection_begin
      procedure :: put => collection_put
   end type collection_t

   !> Why lines and sides of a set are no sides of the boundary.
   type :: losses_t
      integer :: n_inside = 0 !! number of those with elements on both sides
      integer :: n_elsewhere = 0 !! number of those without any element
   end type losses_t

contains
end module amontons_mesh_sets
