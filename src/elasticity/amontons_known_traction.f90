!> The tractions on the boundary of a body that are known before its stresses are: those of the loads, none on free
!> sides and along directions that supports leave free.
module amontons_known_traction
   use amontons_constraints, only: constraints_t, spring_side_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_sides, load_t
   use amontons_mesh, only: mesh_t
   use amontons_side_table, only: new_side_table, side_element, side_number, side_place, side_table_t
   implicit none (type, external)
   private

   public :: known_traction_t, known_tractions_t, new_boundary_sides

   !> The traction on a side of the boundary, at its first corner, its middle and its second corner.
   type :: known_traction_t
      integer :: corner(2) = 0 !! first and second corner node; the body is on the left
      integer :: middle = 0 !! node in the middle, 0 on a side of a linear element
      integer :: element = 0 !! the element of the side
      real(dp) :: position(2, 3) = 0.0_dp !! coordinates of the three places [L]
      real(dp) :: normal(2, 3) = 0.0_dp !! unit outward normal there [-]
      logical :: is_known(2) = .true. !! whether the traction along normal and tangent (-n_y, n_x) is known
      real(dp) :: traction(2, 3) = 0.0_dp !! force per area along x and y at the three places [F/L^2]
   contains
      procedure :: goes_on => known_traction_goes_on
      procedure :: mean => known_traction_mean
   end type known_traction_t

   !> The sides of the boundary.
   type :: known_tractions_t
      type(known_traction_t), allocatable :: side(:) !! the sides
      integer, allocatable, private :: number(:) !! which side of an element each is, by `side_number`; ascending
   contains
      procedure :: add_loads => known_tractions_add_loads
      procedure :: forget => known_tractions_forget
      procedure :: add_nodal => known_tractions_add_nodal
      procedure, private :: place_of => known_tractions_place_of
   end type known_tractions_t

contains

   !> Lists the sides of the boundary, free of tractions where supports and springs leave them known.
   subroutine new_boundary_sides(tractions, mesh, constraints, springs)
      type(known_tractions_t), intent(out) :: tractions !! the sides of the boundary
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      type(side_table_t) :: table
      logical, allocatable :: is_there(:)
      integer :: overlapping(2), i, left, right, number

      call new_side_table(table, mesh, overlapping)
      allocate (is_there(0:side_number(mesh%n_elements + 1, 0)), source=.false.)
      do i = 1, table%n_sides
         is_there(table%boundary(i)) = .true.
      end do
      is_there(0) = .false.
      allocate (tractions%side(count(is_there)), tractions%number(count(is_there)))
      i = 0
      do number = 1, ubound(is_there, 1)
         if (.not. is_there(number)) cycle
         i = i + 1
         tractions%number(i) = number
         call place_side(tractions%side(i), mesh, side_element(number), side_place(number))
         tractions%side(i)%is_known = .not. (held(tractions%side(i), constraints, 1) .and. &
            held(tractions%side(i), constraints, 2))
      end do
      do i = 1, size(springs)
         call table%find(springs(i)%node(1), springs(i)%node(2), left, right)
         tractions%side(tractions%place_of(left))%is_known = .false.
      end do
   end subroutine new_boundary_sides

   !> Adds the tractions of loads.
   pure subroutine known_tractions_add_loads(self, mesh, loads, factor)
      class(known_tractions_t), intent(inout) :: self !! the sides of the boundary
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(load_t), intent(in) :: loads(:) !! the loads
      real(dp), intent(in), optional :: factor(:) !! what each load is multiplied by; 1 without it (loads) [-]
      integer :: i

      do i = 1, size(loads)
         if (loads(i)%target /= load_on_sides) cycle
         if (present(factor)) then
            call add_load(self, mesh, loads(i), factor(i))
         else
            call add_load(self, mesh, loads(i), 1.0_dp)
         end if
      end do
   end subroutine known_tractions_add_loads

   !> Which of the sides one of an element is.
   pure integer function known_tractions_place_of(self, number) result(place)
      class(known_tractions_t), intent(in) :: self !! the sides
      integer, intent(in) :: number !! its number, by `side_number`
      integer :: last, middle

      place = 1
      last = size(self%number)
      do while (place < last)
         middle = (place + last)/2
         if (self%number(middle) < number) then
            place = middle + 1
         else
            last = middle
         end if
      end do
   end function known_tractions_place_of

   !> Places a side of an element.
   pure subroutine place_side(traction, mesh, element, place)
      type(known_traction_t), intent(out) :: traction !! the side, free of tractions
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      integer, intent(in) :: place !! the side's place in it
      real(dp) :: tangent(2, 3), chord(2), bend(2)
      integer :: nodes(3), i

      nodes = mesh%side(element, place)
      traction%corner = nodes(:2)
      traction%middle = nodes(3)
      traction%element = element
      associate (first => mesh%coordinates(:, nodes(1)), second => mesh%coordinates(:, nodes(2)))
         traction%position(:, 1) = first
         traction%position(:, 2) = 0.5_dp*(first + second)
         traction%position(:, 3) = second
         if (nodes(3) > 0) traction%position(:, 2) = mesh%coordinates(:, nodes(3))
         chord = second - first
         bend = 2.0_dp*(2.0_dp*traction%position(:, 2) - first - second)
      end associate
      tangent(:, 1) = chord + bend
      tangent(:, 2) = chord
      tangent(:, 3) = chord - bend
      do i = 1, 3
         traction%normal(:, i) = [tangent(2, i), -tangent(1, i)]/norm2(tangent(:, i))
      end do
   end subroutine place_side

   !> Whether supports hold normal and tangent of a side at a corner of it.
   pure function held(side, constraints, corner)
      type(known_traction_t), intent(in) :: side !! the side
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: corner !! the corner, 1 or 2
      logical :: held(2)

      associate (normal => side%normal(:, 2), node => side%corner(corner))
         held = .not. [constraints%leaves_free(node, normal), constraints%leaves_free(node, [-normal(2), normal(1)])]
      end associate
   end function held

   !> Adds the traction and the pressure of a load.
   pure subroutine add_load(tractions, mesh, load, factor)
      class(known_tractions_t), intent(inout) :: tractions !! the sides of the boundary
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(load_t), intent(in) :: load !! a load on the sides of a set
      real(dp), intent(in) :: factor !! what it is multiplied by [-]
      integer :: i, k

      associate (set => mesh%sets(mesh%find_set(load%set)))
         do i = 1, size(set%element)
            associate (side => tractions%side(tractions%place_of(side_number(set%element(i), set%side(i)))))
               do k = 1, 3
                  associate (x => side%position(:, k))
                     side%traction(:, k) = side%traction(:, k) + factor*(load%traction &
                        + matmul(load%traction_slope, x) &
                        - (load%pressure + dot_product(load%pressure_slope, x))*side%normal(:, k))
                  end associate
               end do
            end associate
         end do
      end associate
   end subroutine add_load

   !> Adds to the traction on the sides of a boundary set one given at nodes, linear or quadratic between them: that of
   !> contact, beside that of loads. Nothing is known along a direction that supports hold at a corner.
   pure subroutine known_tractions_add_nodal(self, mesh, constraints, set, traction)
      class(known_tractions_t), intent(inout) :: self !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      character(*), intent(in) :: set !! name of the boundary set
      real(dp), intent(in) :: traction(:, :) !! force per area at the nodes of the mesh, x and y (2, n_nodes) [F/L^2]
      real(dp) :: at_places(2, 3)
      integer :: i

      associate (set_sides => mesh%sets(mesh%find_set(set)))
         do i = 1, size(set_sides%element)
            associate (side => self%side(self%place_of(side_number(set_sides%element(i), set_sides%side(i)))))
               side%is_known = .not. (held(side, constraints, 1) .or. held(side, constraints, 2))
               at_places(:, 1) = traction(:, side%corner(1))
               at_places(:, 3) = traction(:, side%corner(2))
               at_places(:, 2) = 0.5_dp*(at_places(:, 1) + at_places(:, 3))
               if (side%middle > 0) at_places(:, 2) = traction(:, side%middle)
               side%traction = side%traction + at_places
            end associate
         end do
      end associate
   end subroutine known_tractions_add_nodal

   !> Leaves the traction unknown on every side between two marked corners.
   pure subroutine known_tractions_forget(self, is_marked)
      class(known_tractions_t), intent(inout) :: self !! the sides
      logical, intent(in) :: is_marked(:) !! the marks of the nodes (n_nodes)
      integer :: i

      do i = 1, size(self%side)
         if (all(is_marked(self%side(i)%corner))) self%side(i)%is_known = .false.
      end do
   end subroutine known_tractions_forget

   !> Whether another side goes on smoothly at a node that both meet: by less than 30 degrees.
   pure logical function known_traction_goes_on(self, other, place) result(goes_on)
      class(known_traction_t), intent(in) :: self !! the side
      type(known_traction_t), intent(in) :: other !! the other side
      integer, intent(in) :: place(2) !! which place of each is the node, 1 or 3
      real(dp), parameter :: smooth = cos(acos(-1.0_dp)/6.0_dp)

      goes_on = place(1) /= place(2) .and. all(self%is_known .eqv. other%is_known) .and. &
         dot_product(self%normal(:, place(1)), other%normal(:, place(2))) > smooth
   end function known_traction_goes_on

   !> What is known at a node where another side goes on smoothly, as the middle of a side: with the mean of normals and
   !> tractions.
   pure function known_traction_mean(self, other, place) result(mean)
      class(known_traction_t), intent(in) :: self !! the side
      type(known_traction_t), intent(in) :: other !! the other side
      integer, intent(in) :: place(2) !! which place of each is the node, 1 or 3
      type(known_traction_t) :: mean

      mean%is_known = self%is_known
      mean%position(:, 2) = self%position(:, place(1))
      mean%normal(:, 2) = self%normal(:, place(1)) + other%normal(:, place(2))
      mean%normal(:, 2) = mean%normal(:, 2)/norm2(mean%normal(:, 2))
      mean%traction(:, 2) = 0.5_dp*(self%traction(:, place(1)) + other%traction(:, place(2)))
   end function known_traction_mean

end module amontons_known_traction
