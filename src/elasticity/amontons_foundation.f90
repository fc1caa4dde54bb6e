!> Elastic foundations: springs along sides, in proportion to the displacement along normal and tangent.
module amontons_foundation
   use amontons_constraints, only: support_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_side, only: new_side_geometry, side_geometry_t
   implicit none (type, external)
   private

   public :: new_foundation, spring_side_t

   !> Most unknowns of a side: two of each of three nodes.
   integer, parameter :: max_unknowns = 6

   !> The springs of one side: a small stiffness on its nodes.
   type :: spring_side_t
      integer :: n_nodes = 0 !! number of nodes of the side, 2 or 3
      integer :: node(3) = 0 !! the nodes
      real(dp) :: stiffness(max_unknowns, max_unknowns) = 0.0_dp !! stiffness on x and y of each node [F/L]
   end type spring_side_t

contains

   !> Makes the springs of all supports: integral of N_i N_j (k_n n n^T + k_t t t^T) along each side.
   pure subroutine new_foundation(sides, mesh, materials, supports, error)
      type(spring_side_t), allocatable, intent(out) :: sides(:) !! the springs, side by side
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, for the depth
      type(support_t), intent(in) :: supports(:) !! the supports, with their spring moduli
      type(error_t), allocatable, intent(out) :: error !! a support names a set that the mesh has not
      type(spring_side_t), allocatable :: more(:)
      integer, allocatable :: nodes(:, :)
      integer :: i, k

      allocate (sides(0))
      do i = 1, size(supports)
         if (.not. any(supports(i)%spring > 0.0_dp)) cycle
         call mesh%set_sides(supports(i)%set, nodes, error)
         if (allocated(error)) then
            error%message = supports(i)%origin//error%message
            return
         end if
         allocate (more(size(nodes, 2)))
         do k = 1, size(more)
            call make_springs(more(k), supports(i)%spring, nodes(:, k), mesh, materials)
         end do
         sides = [sides, more]
         deallocate (more)
      end do
   end subroutine new_foundation

   !> Makes the springs of one side.
   pure subroutine make_springs(side, moduli, nodes, mesh, materials)
      type(spring_side_t), intent(out) :: side !! the springs
      real(dp), intent(in) :: moduli(2) !! stress per displacement along normal and tangent [F/L^3]
      integer, intent(in) :: nodes(4) !! first corner, second corner, middle or 0, element
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials
      type(side_geometry_t) :: geometry
      real(dp) :: tangent(2), normal(2), modulus(2, 2), area
      integer :: point, i, j

      side%n_nodes = count(nodes(:3) > 0)
      side%node = nodes(:3)
      call new_side_geometry(geometry, nodes(:3), mesh%coordinates)
      do point = 1, size(geometry%along, 2)
         area = norm2(geometry%along(:, point))
         tangent = geometry%along(:, point)/area
         normal = [tangent(2), -tangent(1)]
         area = area*materials%list(materials%of_element(nodes(4)))%depth(geometry%position(1, point))
         do j = 1, 2
            modulus(:, j) = area*(moduli(1)*normal*normal(j) + moduli(2)*tangent*tangent(j))
         end do
         do j = 1, side%n_nodes
            do i = 1, side%n_nodes
               side%stiffness(2*i - 1:2*i, 2*j - 1:2*j) = side%stiffness(2*i - 1:2*i, 2*j - 1:2*j) &
                  + geometry%values(i, point)*geometry%values(j, point)*modulus
            end do
         end do
      end do
   end subroutine make_springs

end module amontons_foundation
