!> Tractions on the sides of three-node triangles with which every element is in equilibrium (Ladeveze and Leguillon,
!> SIAM J. Numer. Anal. 20, 1983), from a finite element solution that is in equilibrium with the loads.
!>
!> The moment of a traction at a corner is its integral times the corner's linear shape function. Around a node the
!> moments of one side follow from those of the side before and the element between them, so that one vector is free at
!> an inner node; the moments come as close as possible to those of the mean stress on both sides, by what their
!> difference weighs in the energy: its square times the area of the elements over that of the side's length.
module amontons_equilibrated_sides
   use amontons_coloring, only: worth_threads
   use amontons_constraints, only: constraints_t
   use amontons_elasticity, only: element_geometry_t, element_stress, new_element_geometry, set_thermal_strain
   use amontons_incidence, only: incidence_t, new_incidence
   use amontons_kinds, only: dp
   use amontons_known_traction, only: known_traction_t, known_tractions_t
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: element_forces_t, find_element_forces, find_side_moments, next

   !> The corner after each corner of a triangle.
   integer, parameter :: next(3) = [2, 3, 1]

   !> The forces inside an element: what its sides must balance.
   type :: element_forces_t
      real(dp) :: depth = 1.0_dp !! its depth [L]
      real(dp) :: side(2, 3) = 0.0_dp !! force of its mean stress on each side [F]
      real(dp) :: weight(3) = 1.0_dp !! its area over the square of each side's length [-]
      real(dp) :: load(2) = 0.0_dp !! load in the element, shared by its corners alike [F]
      real(dp) :: solved(3) = 0.0_dp !! mean stress xx, yy, xy of the displacements to be judged [F/L^2]
   end type element_forces_t

contains

   !> Finds the forces inside the elements of a finite element solution.
   subroutine find_element_forces(forces, mesh, materials, body_force, displacement, judged, thermal_strain)
      type(element_forces_t), allocatable, intent(out) :: forces(:) !! the forces (n_elements)
      type(mesh_t), intent(in) :: mesh !! a checked mesh of three-node triangles
      type(materials_t), intent(in) :: materials !! its materials, of a plane body
      real(dp), intent(in) :: body_force(:, :) !! force per volume of each element, x and y (2, n_elements) [F/L^3]
      real(dp), intent(in) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: judged(:, :) !! displacement of the nodes whose stresses are to be judged (2, n_nodes) [L]
      real(dp), intent(in), optional :: thermal_strain(:)
         !! strain of free thermal expansion at the nodes of each element, in the order of `mesh%node` [-]
      type(element_geometry_t) :: geometry
      real(dp) :: stress(4), along(2)
      integer :: i, k

      allocate (forces(mesh%n_elements))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) private(stress, along, k) &
      !$omp shared(forces, mesh, materials, body_force, displacement, judged, thermal_strain)
      do i = 1, mesh%n_elements
         associate (material => materials%list(materials%of_element(i)))
            call new_element_geometry(geometry, mesh, i, material, 1)
            if (present(thermal_strain)) call set_thermal_strain(geometry, &
               thermal_strain(mesh%node_start(i):mesh%node_start(i + 1) - 1))
            stress = element_stress(geometry, material, displacement, 1)
            forces(i)%depth = material%thickness
            do k = 1, 3
               along = mesh%coordinates(:, geometry%node(next(k))) - mesh%coordinates(:, geometry%node(k))
               forces(i)%side(:, k) = material%thickness &
                  *[stress(1)*along(2) - stress(3)*along(1), stress(3)*along(2) - stress(2)*along(1)]
               forces(i)%weight(k) = geometry%volume(1)/(material%thickness*(along(1)**2 + along(2)**2))
            end do
            stress = element_stress(geometry, material, judged, 1)
            forces(i)%solved = stress(:3)
            forces(i)%load = geometry%volume(1)*body_force(:, i)
         end associate
      end do
      !$omp end parallel do
   end subroutine find_element_forces

   !> Finds the moments of the tractions that act on each element along its sides.
   subroutine find_side_moments(moment, imbalance, mesh, constraints, tractions, forces)
      real(dp), allocatable, intent(out) :: moment(:, :, :, :)
         !! x and y at the first and second corner of each side (2, 2, 3, n_elements) [F]
      real(dp), intent(out) :: imbalance
         !! by how much the solution misses equilibrium with the loads, over the norm of the moments [-]
      type(mesh_t), intent(in) :: mesh !! a checked mesh of three-node triangles
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_tractions_t), intent(in) :: tractions !! the tractions on the boundary
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements, from `find_element_forces`
      type(incidence_t) :: incidence
      real(dp) :: squares(2)
      integer :: node

      call new_incidence(incidence, mesh)
      allocate (moment(2, 2, 3, mesh%n_elements))
      squares = 0.0_dp
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp shared(moment, mesh, constraints, tractions, forces, incidence) reduction(+: squares)
      do node = 1, mesh%n_nodes
         call balance_node(moment, squares, mesh, constraints, tractions, forces, &
            incidence%corner(incidence%start(node):incidence%start(node + 1) - 1), &
            incidence%element(incidence%start(node):incidence%start(node + 1) - 1))
      end do
      !$omp end parallel do
      imbalance = sqrt(squares(1)/max(squares(2), tiny(1.0_dp)))
   end subroutine find_side_moments

   !> Finds the moments at a node: of one fan of elements after the other, where several meet there.
   pure subroutine balance_node(moment, squares, mesh, constraints, tractions, forces, place, elements)
      real(dp), intent(inout) :: moment(:, :, :, :) !! as in `find_side_moments` [F]
      real(dp), intent(inout) :: squares(2) !! gains those of what is missing to equilibrium, and of the moments [F^2]
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_tractions_t), intent(in) :: tractions !! the tractions on the boundary
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements
      integer, intent(in) :: place(:) !! the node's place in each of its elements, as in `node` of the mesh
      integer, intent(in) :: elements(:) !! the elements
      integer, dimension(size(elements)) :: after, before, corner
      integer :: fan(2, size(elements))
      logical :: is_left(size(elements))
      integer :: begin, i, k, n_left, n

      do i = 1, size(elements)
         associate (nodes => mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i)) + 2))
            corner(i) = place(i) - mesh%node_start(elements(i)) + 1
            after(i) = nodes(next(corner(i)))
            before(i) = nodes(next(next(corner(i))))
         end associate
      end do
      is_left = .true.
      n_left = size(elements)
      do while (n_left > 0)
         begin = first_of_fan(after, before, is_left)
         i = begin
         n = 0
         do while (i > 0)
            n = n + 1
            fan(:, n) = [elements(i), corner(i)]
            is_left(i) = .false.
            n_left = n_left - 1
            k = i
            do i = size(elements), 1, -1
               if (after(i) == before(k) .and. is_left(i)) exit
            end do
         end do
         call balance_fan(moment, squares, constraints, tractions, forces, fan(:, :n), mesh%node(place(1)), &
            before(k) == after(begin))
      end do
   end subroutine balance_node

   !> The first element of a fan: one at the boundary begins where no element precedes, one around an inner node
   !> anywhere.
   pure integer function first_of_fan(after, before, is_left) result(first)
      integer, intent(in) :: after(:) !! the corner behind the node in each element
      integer, intent(in) :: before(:) !! the corner before it
      logical, intent(in) :: is_left(:) !! which elements are in no fan yet; one at the least is
      integer :: i, k

      first = 0
      do i = size(after), 1, -1
         if (.not. is_left(i)) cycle
         first = i
         do k = 1, size(after)
            if (before(k) == after(i)) exit
         end do
         if (k > size(after)) return
      end do
   end function first_of_fan

   !> Finds the moments at the node of a fan of elements, which follow each other counter-clockwise.
   pure subroutine balance_fan(moment, squares, constraints, tractions, forces, fan, node, is_closed)
      real(dp), intent(inout) :: moment(:, :, :, :) !! as in `find_side_moments` [F]
      real(dp), intent(inout) :: squares(2) !! gains those of what is missing to equilibrium, and of the moments [F^2]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_tractions_t), intent(in) :: tractions !! the tractions on the boundary
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements
      integer, intent(in) :: fan(:, :) !! the elements, and which corner of each the node is (2, elements)
      integer, intent(in) :: node !! the node
      logical, intent(in) :: is_closed !! whether the last element meets the first
      real(dp) :: sum_to(2, 0:size(fan, 2)), missed(2), first(2), weight, of_weights
      integer :: i, n

      n = size(fan, 2)
      sum_to(:, 0) = 0.0_dp
      missed = 0.0_dp
      of_weights = 0.0_dp
      ! Each element asks for the moments of its own stress on the side behind it and on the one before it.
      do i = 1, n
         associate (own => forces(fan(1, i)), c => fan(2, i), a => next(fan(2, i)), b => next(next(fan(2, i))))
            sum_to(:, i) = sum_to(:, i - 1) - 0.5_dp*own%side(:, a) - own%load/3.0_dp
            weight = own%weight(c)
            missed = missed - weight*(0.5_dp*own%side(:, c) + sum_to(:, i - 1))
            of_weights = of_weights + weight
            weight = own%weight(b)
            missed = missed + weight*(0.5_dp*own%side(:, b) - sum_to(:, i))
            of_weights = of_weights + weight
         end associate
      end do
      first = missed/of_weights
      if (is_closed) then
         squares(1) = squares(1) + sum(sum_to(:, n)**2)
      else
         call keep_boundary(first, squares(1), constraints, forces, sum_to(:, n), node, &
            tractions%at(fan(1, 1), fan(2, 1)), tractions%at(fan(1, n), next(next(fan(2, n)))))
      end if
      do i = 1, n
         moment(:, 1, fan(2, i), fan(1, i)) = -first - sum_to(:, i - 1)
         moment(:, 2, next(next(fan(2, i))), fan(1, i)) = first + sum_to(:, i)
         squares(2) = squares(2) + sum((first + sum_to(:, i - 1))**2) + sum((first + sum_to(:, i))**2)
      end do
   end subroutine balance_fan

   !> Moves the moments of a fan at the boundary to those that its first and last side are known to have.
   pure subroutine keep_boundary(first, missing, constraints, forces, total, node, begin, end)
      real(dp), intent(inout) :: first(2) !! moment of the first side, on what is before it [F]
      real(dp), intent(inout) :: missing !! gains the square of what is missing to equilibrium [F^2]
      type(constraints_t), intent(in) :: constraints !! the supports
      type(element_forces_t), intent(in) :: forces(:) !! the forces inside the elements
      real(dp), intent(in) :: total(2) !! what is added to this moment up to the last side [F]
      integer, intent(in) :: node !! the node
      type(known_traction_t), intent(in) :: begin !! the first side
      type(known_traction_t), intent(in) :: end !! the last side
      ! Directions that differ by less than this angle are one.
      real(dp), parameter :: parallel = 1.0e-6_dp
      real(dp) :: axes(2, 2), direction(2), value, across, kept(2)
      logical :: is_known(2)
      integer :: i, k, n_kept

      n_kept = 0
      kept = 0.0_dp
      do k = 1, 2
         if (k == 1) call find_axes(axes, is_known, constraints, begin)
         if (k == 2) call find_axes(axes, is_known, constraints, end)
         do i = 1, 2
            if (.not. is_known(i)) cycle
            direction = axes(:, i)
            if (k == 1) value = -dot_product(direction, applied_moment(begin, forces(begin%element)%depth, node))
            if (k == 2) value = dot_product(direction, applied_moment(end, forces(end%element)%depth, node) - total)
            value = value - dot_product(direction, first)
            across = dot_product(direction, outward(kept))
            if (n_kept == 0) then
               kept = direction
               first = first + value*direction
               n_kept = 1
            else if (n_kept == 1 .and. abs(across) > parallel) then
               first = first + value/across*outward(kept)
               n_kept = 2
            else
               missing = missing + value**2
            end if
         end do
      end do
   end subroutine keep_boundary

   !> Two directions, and along which of them the traction of a side is that applied to it: no support holds both of its
   !> corners along it.
   pure subroutine find_axes(axes, is_known, constraints, side)
      real(dp), intent(out) :: axes(2, 2) !! the directions, unit vectors as columns [-]
      logical, intent(out) :: is_known(2) !! whether the traction along each is that applied
      type(constraints_t), intent(in) :: constraints !! the supports
      type(known_traction_t), intent(in) :: side !! the side
      integer :: i

      ! A corner that supports hold completely says nothing about directions.
      i = merge(2, 1, all(.not. constraints%is_free(:, side%corner(1))))
      axes = constraints%frame(side%corner(i))
      do i = 1, 2
         is_known(i) = constraints%leaves_free(side%corner(1), axes(:, i)) .or. &
            constraints%leaves_free(side%corner(2), axes(:, i))
      end do
   end subroutine find_axes

   !> The moment at a corner of the traction that is applied to a side [F].
   pure function applied_moment(side, depth, node) result(moment)
      type(known_traction_t), intent(in) :: side !! the side
      real(dp), intent(in) :: depth !! its depth [L]
      integer, intent(in) :: node !! the corner
      real(dp) :: moment(2)
      integer :: here, there

      here = merge(1, 3, side%corner(1) == node)
      there = 4 - here
      moment = depth*norm2(side%position(:, 3) - side%position(:, 1))/6.0_dp* &
         (2.0_dp*side%traction(:, here) + side%traction(:, there))
   end function applied_moment

   !> The outward normal of a side, times its length.
   pure function outward(along)
      real(dp), intent(in) :: along(2) !! the way along the side, the body on the left [L]
      real(dp) :: outward(2)

      outward = [along(2), -along(1)]
   end function outward

end module amontons_equilibrated_sides
