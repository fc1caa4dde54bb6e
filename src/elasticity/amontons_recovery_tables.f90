!> Tables for the recovery of stresses: the tractions that are known on the boundary before the stresses are, and the
!> patches of elements.
!>
!> The known tractions are those of the loads, and zero on free sides and in directions that supports leave free. A
!> patch consists of the elements of one material around a corner node, with coordinates in which a polynomial is fitted
!> to their stresses. Patches do not depend on the loads: one table serves all cases of a body.
module amontons_recovery_tables
   use amontons_constraints, only: constraints_t, spring_side_t
   use amontons_elasticity, only: element_geometry_t, new_element_geometry
   use amontons_element, only: max_face_nodes, max_nodes, n_corners, n_sampling_points, n_side_corners
   use amontons_face, only: center_shapes, place_face, place_side
   use amontons_frame, only: new_frame
   use amontons_integer_list, only: integer_list_t, new_tag_map, tag_map_t
   use amontons_kinds, only: dp
   use amontons_loads, only: load_on_sides, load_t
   use amontons_material, only: materials_t, n_strains
   use amontons_mesh, only: find_set, incidence_t, mesh_t, new_incidence, side_element, side_number, side_place, &
      worth_threads
   implicit none (type, external)
   private

   public :: block_size, far_weight, find_terms, frame_t, is_linear, known_traction_t, known_tractions_t, max_terms, &
      new_boundary_sides, new_patch_table, new_recovery_tables, patch_table_t, recovery_tables_t, samples_t, &
      solve_normal, sum_samples

   !> Most places where the traction on a side is known: its corners and its middle.
   integer, parameter :: max_places = 5

   !> The traction on a side of the boundary, at its corners and in its middle. In the plane z is 0.
   type :: known_traction_t
      integer :: n_corners = 2 !! number of corners; the middle is the place behind them
      integer :: node(max_face_nodes) = 0 !! its nodes, as of `mesh_side`, then 0
      integer :: element = 0 !! the element of the side
      real(dp) :: position(3, max_places) = 0.0_dp !! coordinates of the places [L]
      real(dp) :: normal(3, max_places) = 0.0_dp !! unit outward normal there [-]
      logical :: is_known(3) = .true. !! whether the traction along normal and tangents, of `new_frame`, is known
      real(dp) :: traction(3, max_places) = 0.0_dp !! force per area at the places [F/L^2]
   end type known_traction_t

   !> The sides of the boundary.
   type :: known_tractions_t
      type(known_traction_t), allocatable :: side(:) !! the sides
      type(tag_map_t), private :: place !! places of the sides by their numbers in the elements, see `side_number`
   contains
      procedure :: add_loads => known_tractions_add_loads
      procedure :: forget => known_tractions_forget
      procedure :: add_nodal => known_tractions_add_nodal
   end type known_tractions_t

   !> Most terms of a polynomial: 1, x, y, x^2, x y, y^2, x^2 y, x y^2, x^2 y^2; in space 1, x, y, z, x^2, y^2, x y,
   !> y z, z x, z^2.
   integer, parameter :: max_terms = 10
   !> Terms of the polynomial of each kind of element: linear; quadratic, of quadrilaterals in x and in y.
   integer, parameter :: n_kind_terms(*) = [3, 3, 6, 9, 9, 4, 10, 4, 10]

   !> Weight of a sample of an element that was added to a patch with too few: such samples determine only the
   !> coefficients that near ones leave open.
   real(dp), parameter :: far_weight = 0.1_dp

   !> Smallest pivot of the normal equations, for each sample. A regular patch has pivots of a few hundredths, one with
   !> a row of elements too few has 0. In between, what the polynomial cannot be of the stresses grows towards the node.
   real(dp), parameter :: least_pivot = 4.0e-3_dp

   !> Coordinates of a patch in which its nodes have equal variance in all directions and, if the terms of the
   !> polynomial depend on it, the sides of its elements lie along the axes. So slender and rotated elements need no
   !> special treatment. For a linear polynomial the samples have this property instead, and the normal matrix is a
   !> multiple of the identity.
   type :: frame_t
      real(dp) :: center(3) = 0.0_dp !! mean of the points that are spread [L]
      real(dp) :: scale(3, 3) = 0.0_dp !! distance from the center to coordinates of the polynomial [1/L]
      integer :: n_terms = 1 !! terms of the polynomial
      integer :: n_dim = 2 !! number of dimensions
   end type frame_t

   !> The points of the elements where their stresses are most accurate.
   type :: samples_t
      integer, allocatable :: start(:) !! where the samples of an element begin (n_elements + 1)
      real(dp), allocatable :: position(:, :) !! coordinates (n_dim, n_samples) [L]
   end type samples_t

   !> Moments of weighted points about one of them.
   type :: moments_t
      real(dp) :: origin(3) = 0.0_dp !! coordinates of this one [L]
      real(dp) :: weight = 0.0_dp !! sum of the weights [-]
      real(dp) :: first(3) = 0.0_dp !! first moments [L]
      real(dp) :: second(3, 3) = 0.0_dp !! second moments [L^2]
   contains
      procedure :: add => moments_add
   end type moments_t

   !> Number of consecutive elements in a block. The polynomials of all patches would take more memory than anything
   !> except the factor; those of one block fit in a cache, and few elements share patches with another block.
   integer, parameter :: block_size = 8192

   !> The patches.
   type :: patch_table_t
      integer, allocatable :: of_corner(:)
         !! patch of each corner of the elements, by its place in the list of its block; placed as `node` of the mesh
      integer, allocatable :: block_start(:) !! where the list of each block of elements begins in `listed` (blocks + 1)
      integer, allocatable :: listed(:) !! the patches that the elements of each block have corners in
      integer, allocatable :: node(:) !! node of each patch
      integer, allocatable :: start(:) !! where the elements of each patch begin in `element` (patches + 1)
      integer, allocatable :: element(:) !! the elements of the patches, first those that meet at its node
      integer, allocatable :: n_near(:) !! how many elements of each patch meet at its node
      type(frame_t), allocatable :: frame(:) !! coordinates and terms of the patches
      logical :: is_linear = .false. !! whether no polynomial has terms of the second order
      type(samples_t) :: samples !! the points whose stresses are fitted
   contains
      procedure :: at_corner => patch_table_at_corner
   end type patch_table_t

   !> Consecutive patches.
   type :: chunk_t
      type(integer_list_t) :: elements !! their elements
   end type chunk_t

   !> The tables; together about as large as the mesh.
   type :: recovery_tables_t
      type(patch_table_t) :: patches !! the patches of the elements
      type(known_tractions_t) :: sides !! the sides of the boundary, free of tractions
   end type recovery_tables_t

contains

   !> Lists the sides of the boundary, with zero traction where supports and springs leave it known.
   subroutine new_boundary_sides(tractions, mesh, outer, constraints, springs)
      type(known_tractions_t), intent(out) :: tractions !! the sides of the boundary
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      integer, intent(in) :: outer(:) !! numbers of the elements' sides on its boundary
      type(constraints_t), intent(in) :: constraints !! the supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along sides
      real(dp) :: position(2, 3), normal(2, 3)
      integer :: i

      call new_tag_map(tractions%place, outer)
      allocate (tractions%side(size(outer)))
      do i = 1, size(outer)
         associate (side => tractions%side(i))
            side%element = side_element(outer(i))
            side%n_corners = n_side_corners(mesh%element_kind(side%element))
            associate (nodes => mesh%side(side%element, side_place(outer(i))), n_dim => size(mesh%coordinates, 1), &
               n => side%n_corners + 1)
               side%node(:size(nodes)) = nodes
               if (n_dim == 3) then
                  call place_face(side%position(:, :n), side%normal(:, :n), nodes, mesh%coordinates)
               else
                  call place_side(position, normal, nodes, mesh%coordinates)
                  side%position(:2, :3) = position
                  side%normal(:2, :3) = normal
               end if
               side%is_known(:n_dim) = .not. held(side, constraints, n_dim, at_all=.true.)
            end associate
         end associate
      end do
      do i = 1, size(springs)
         tractions%side(tractions%place%find(springs(i)%number))%is_known = .false.
      end do
   end subroutine new_boundary_sides

   !> Adds the tractions and pressures of loads on the sides of sets.
   pure subroutine known_tractions_add_loads(self, mesh, loads, factor)
      class(known_tractions_t), intent(inout) :: self !! the sides of the boundary
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(load_t), intent(in) :: loads(:) !! the loads
      real(dp), intent(in), optional :: factor(:) !! what each load is multiplied by; 1 without it (loads) [-]
      real(dp) :: share
      integer :: i, k, n_dim, point

      share = 1.0_dp
      n_dim = size(mesh%coordinates, 1)
      do i = 1, size(loads)
         if (loads(i)%target /= load_on_sides) cycle
         if (present(factor)) share = factor(i)
         associate (load => loads(i), set => mesh%sets(find_set(mesh%sets, loads(i)%set)))
            do k = 1, size(set%element)
               associate (side => self%side(self%place%find(side_number(set%element(k), set%side(k)))))
                  do point = 1, side%n_corners + 1
                     associate (x => side%position(:n_dim, point), traction => side%traction(:n_dim, point))
                        traction = traction + share*(load%traction(:n_dim) &
                           + matmul(load%traction_slope(:n_dim, :n_dim), x) &
                           - (load%pressure + dot_product(load%pressure_slope(:n_dim), x))*side%normal(:n_dim, point))
                     end associate
                  end do
               end associate
            end do
         end associate
      end do
   end subroutine known_tractions_add_loads

   !> Whether supports hold normal and tangents of a side at its corners.
   pure function held(side, constraints, n_dim, at_all)
      type(known_traction_t), intent(in) :: side !! the side
      type(constraints_t), intent(in) :: constraints !! the supports
      integer, intent(in) :: n_dim !! number of dimensions
      logical, intent(in) :: at_all !! whether at all corners, or else at one of them
      logical :: held(n_dim), is_held
      real(dp) :: frame(n_dim, n_dim)
      integer :: i, k

      frame = new_frame(side%normal(:n_dim, side%n_corners + 1), n_dim)
      do i = 1, n_dim
         do k = 1, side%n_corners
            is_held = constraints%rigid_of(side%node(k)) > 0
            if (.not. is_held) is_held = .not. constraints%leaves_free(side%node(k), frame(:, i))
            ! The first corner that is not like the answer decides.
            if (is_held .neqv. at_all) exit
         end do
         held(i) = is_held
      end do
   end function held

   !> Adds a traction given at nodes, linear or quadratic between them, on the sides of a boundary set: that of contact,
   !> in addition to the loads. In directions that supports hold at a corner the traction is unknown.
   pure subroutine known_tractions_add_nodal(self, mesh, constraints, set, traction)
      class(known_tractions_t), intent(inout) :: self !! the sides
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(constraints_t), intent(in) :: constraints !! the supports
      character(*), intent(in) :: set !! name of the boundary set
      real(dp), intent(in) :: traction(:, :) !! force per area at the nodes of the mesh (n_dim, n_nodes) [F/L^2]
      real(dp) :: shapes(max_nodes)
      integer :: i, n, n_dim

      n_dim = size(traction, 1)
      associate (set_sides => mesh%sets(find_set(mesh%sets, set)))
         do i = 1, size(set_sides%element)
            associate (side => self%side(self%place%find(side_number(set_sides%element(i), set_sides%side(i)))))
               side%is_known(:n_dim) = .not. held(side, constraints, n_dim, at_all=.false.)
               n = count(side%node > 0)
               shapes = center_shapes(n, n_dim)
               associate (at_corners => side%traction(:n_dim, :side%n_corners), &
                  at_center => side%traction(:n_dim, side%n_corners + 1))
                  at_corners = at_corners + traction(:, side%node(:side%n_corners))
                  at_center = at_center + matmul(traction(:, side%node(:n)), shapes(:n))
               end associate
            end associate
         end do
      end associate
   end subroutine known_tractions_add_nodal

   !> Marks the traction as unknown on every side between two marked corners.
   pure subroutine known_tractions_forget(self, is_marked)
      class(known_tractions_t), intent(inout) :: self !! the sides
      logical, intent(in) :: is_marked(:) !! the marks of the nodes (n_nodes)
      integer :: i

      do i = 1, size(self%side)
         associate (side => self%side(i))
            if (all(is_marked(side%node(:side%n_corners)))) side%is_known = .false.
         end associate
      end do
   end subroutine known_tractions_forget

   !> Whether a polynomial has no terms of the second order.
   elemental logical function is_linear(frame)
      type(frame_t), intent(in) :: frame !! coordinates and terms of its patch

      is_linear = frame%n_terms <= 4
   end function is_linear

   !> Sets the coordinates of a patch, and finds whether its samples determine the polynomial.
   pure subroutine place_patch(frame, is_determined, mesh, samples, elements, n_near)
      type(frame_t), intent(inout) :: frame !! the coordinates; have their number of terms
      logical, intent(out) :: is_determined
         !! whether there is a sample more than terms and the matrix is well conditioned; always for a constant
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(samples_t), intent(in) :: samples !! the samples of all elements
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! number of leading elements of the patch, which meet at its node
      real(dp) :: normal(max_terms, max_terms), right(n_strains, max_terms)
      real(dp) :: unused(n_strains, max_terms)
      type(moments_t) :: moments
      integer :: k, n_dim
      logical :: is_last

      n_dim = frame%n_dim
      is_last = frame%n_terms == 1
      ! In space the last resort is a linear polynomial along the directions in which there are several samples.
      if (is_last .and. n_dim == 3) frame%n_terms = 4
      is_determined = is_last
      if (is_last .and. n_dim == 2) then
         frame%center(:2) = samples%position(:, samples%start(elements(1)))
         frame%scale = 0.0_dp
         return
      end if
      if (.not. is_last .and. sum(samples%start(elements + 1) - samples%start(elements)) <= frame%n_terms) return
      call sum_corners(moments, mesh, elements)
      call spread_points(frame, moments, 0.0_dp, is_determined)
      if (frame%n_terms == 9 .and. n_dim == 2) call turn_frame(frame%scale(:2, :2), mesh, elements)
      if (is_linear(frame)) then
         ! Whether the samples spread in all directions, as the corners do.
         call sum_positions(moments, samples, elements, n_near)
         call spread_points(frame, moments, least_pivot, is_determined)
         is_determined = is_determined .or. is_last
      else
         ! In a layer the square of one coordinate is undetermined: each of the three is the last one in turn.
         do k = 1, merge(3, 1, n_dim == 3 .and. frame%n_terms < max_terms)
            if (k > 1) frame%scale = cshift(frame%scale, 1)
            call sum_samples(normal, right, frame, samples, elements, n_near)
            call solve_normal(unused, frame%n_terms, normal, right, is_determined)
            if (is_determined) return
         end do
      end if
   end subroutine place_patch

   !> Sums the moments of the corners of some elements.
   pure subroutine sum_corners(moments, mesh, elements)
      type(moments_t), intent(out) :: moments !! the moments
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: elements(:) !! the elements
      integer :: first, i, k

      moments%origin(:size(mesh%coordinates, 1)) = mesh%coordinates(:, mesh%node(mesh%node_start(elements(1))))
      do i = 1, size(elements)
         first = mesh%node_start(elements(i))
         do k = first, first + n_corners(mesh%element_kind(elements(i))) - 1
            call moments%add(mesh%coordinates(:, mesh%node(k)), 1.0_dp)
         end do
      end do
   end subroutine sum_corners

   !> Sums the moments of the samples of a patch.
   pure subroutine sum_positions(moments, samples, elements, n_near)
      type(moments_t), intent(out) :: moments !! the moments
      type(samples_t), intent(in) :: samples !! the samples of all elements
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! number of leading elements of the patch, which meet at its node
      real(dp) :: weight
      integer :: i, k

      moments%origin(:size(samples%position, 1)) = samples%position(:, samples%start(elements(1)))
      do i = 1, size(elements)
         weight = merge(1.0_dp, far_weight, i <= n_near)
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            call moments%add(samples%position(:, k), weight)
         end do
      end do
   end subroutine sum_positions

   !> Adds a point to the moments of a set of points.
   pure subroutine moments_add(self, x, weight)
      class(moments_t), intent(inout) :: self !! the moments of other points
      real(dp), intent(in) :: x(:) !! coordinates of the point (n_dim) [L]
      real(dp), intent(in) :: weight !! its weight [-]
      integer :: k

      self%weight = self%weight + weight
      do k = 1, size(x)
         associate (way => x(k) - self%origin(k))
            self%first(k) = self%first(k) + weight*way
            self%second(:size(x), k) = self%second(:size(x), k) + weight*way*(x - self%origin(:size(x)))
         end associate
      end do
   end subroutine moments_add

   !> Sets coordinates in which some points have equal variance in all directions in which they are spread, and are 0 in
   !> others.
   pure subroutine spread_points(frame, moments, least, is_spread)
      type(frame_t), intent(inout) :: frame !! the coordinates; those before say which variance counts
      type(moments_t), intent(in) :: moments !! the moments of the points
      real(dp), intent(in) :: least
         !! least variance that counts; 0 for points that span the plane or space, and have no coordinates before [-]
      logical, intent(out) :: is_spread !! whether they are spread in all directions
      real(dp) :: covariance(3, 3), axis(3), along(3), pivot
      integer :: j, k

      associate (mean => moments%first/moments%weight)
         frame%center = moments%origin + mean
         do k = 1, 3
            covariance(:, k) = moments%second(:, k)/moments%weight - mean(k)*mean
         end do
      end associate
      if (.not. least > 0.0_dp) then
         frame%scale = reshape([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], [3, 3], pad=[1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp])
      end if
      ! The rows, made orthonormal in the product of the covariance one after another.
      is_spread = .true.
      do k = 1, frame%n_dim
         axis = frame%scale(k, :)
         do j = 1, k
            along = axis(1)*covariance(:, 1) + axis(2)*covariance(:, 2) + axis(3)*covariance(:, 3)
            if (j < k) axis = axis - dot_product(frame%scale(j, :), along)*frame%scale(j, :)
         end do
         pivot = dot_product(axis, along)
         is_spread = is_spread .and. pivot > least
         frame%scale(k, :) = 0.0_dp
         if (pivot > least) frame%scale(k, :) = axis/sqrt(pivot)
      end do
   end subroutine spread_points

   !> Turns the coordinates of a patch until the sides of its quadrilaterals lie along the axes. Their angle is that of
   !> the sum of the fourth powers of the sides as complex numbers, which do not depend on the sign of a side and on
   !> which axis it lies along.
   pure subroutine turn_frame(scale, mesh, elements)
      real(dp), intent(inout) :: scale(2, 2) !! what distances are multiplied by [1/L]
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: elements(:) !! the elements of the patch
      complex(dp) :: direction
      real(dp) :: side(2), angle
      integer :: i, k, n

      direction = 0.0_dp
      do i = 1, size(elements)
         n = n_corners(mesh%element_kind(elements(i)))
         if (n < 4) cycle
         associate (corner => mesh%node(mesh%node_start(elements(i)):mesh%node_start(elements(i)) + n - 1))
            do k = 1, n
               side = matmul(scale, mesh%coordinates(:, corner(1 + mod(k, n))) - mesh%coordinates(:, corner(k)))
               direction = direction + cmplx(side(1), side(2), dp)**4
            end do
         end associate
      end do
      angle = 0.25_dp*atan2(direction%im, direction%re)
      scale = matmul(reshape([cos(angle), -sin(angle), sin(angle), cos(angle)], [2, 2]), scale)
   end subroutine turn_frame

   !> Sums the normal equations of the samples of a patch; without stresses the right-hand sides are 0.
   pure subroutine sum_samples(normal, right, frame, samples, elements, n_near, stress)
      real(dp), intent(out) :: normal(max_terms, max_terms) !! the lower triangle of their matrix
      real(dp), intent(out) :: right(n_strains, max_terms) !! their right-hand sides (component, term) [F/L^2]
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      type(samples_t), intent(in) :: samples !! the samples of all elements
      integer, intent(in) :: elements(:) !! the elements of the patch
      integer, intent(in) :: n_near !! number of leading elements of the patch, which meet at its node
      real(dp), contiguous, intent(in), optional :: stress(:, :) !! stresses of the samples (any, n_samples) [F/L^2]
      real(dp) :: p(max_terms), weight
      integer :: i, j, k, n

      n = frame%n_terms
      normal(:n, :n) = 0.0_dp
      right(:, :n) = 0.0_dp
      do i = 1, size(elements)
         weight = merge(1.0_dp, far_weight, i <= n_near)
         do k = samples%start(elements(i)), samples%start(elements(i) + 1) - 1
            call find_terms(frame, n, samples%position(:, k), p)
            do j = 1, n
               normal(j:n, j) = normal(j:n, j) + (weight*p(j))*p(j:n)
               if (present(stress)) right(:, j) = right(:, j) + (weight*p(j))*stress(:, k)
            end do
         end do
      end do
   end subroutine sum_samples

   !> The terms of a patch's polynomial at a point; entries beyond the last term are 0.
   pure subroutine find_terms(frame, n, position, p)
      type(frame_t), intent(in) :: frame !! coordinates of the patch
      integer, intent(in) :: n !! number of terms
      real(dp), intent(in) :: position(frame%n_dim) !! the point [L]
      real(dp), intent(inout) :: p(max_terms) !! the terms, the first always 1
      real(dp) :: x, y, distance(2), place(3)

      p(1) = 1.0_dp
      if (frame%n_dim == 3) then
         place = matmul(frame%scale, position(:3) - frame%center)
         p(2:4) = place
         if (n > 4) p(5:) = [place(:2)**2, place*cshift(place, 1), place(3)**2]
         return
      end if
      distance = position(:2) - frame%center(:2)
      x = frame%scale(1, 1)*distance(1) + frame%scale(1, 2)*distance(2)
      y = frame%scale(2, 1)*distance(1) + frame%scale(2, 2)*distance(2)
      p(2) = x
      p(3) = y
      if (n > 3) p(4:9) = [x*x, x*y, y*y, x*x*y, x*y*y, x*x*y*y]
   end subroutine find_terms

   !> Solves the normal equations of a patch, unless their matrix is badly conditioned. They are so small that calling
   !> BLAS would take longer.
   pure subroutine solve_normal(x, n, normal, right, is_determined)
      real(dp), intent(inout) :: x(n_strains, max_terms) !! the solution (component, term) [F/L^2]
      integer, intent(in) :: n !! number of equations
      real(dp), intent(in) :: normal(max_terms, max_terms) !! the lower triangle of the matrix
      real(dp), intent(in) :: right(n_strains, max_terms) !! the right-hand sides (component, term) [F/L^2]
      logical, intent(out) :: is_determined !! whether the matrix is well conditioned
      ! The factors of L D L^T: below the diagonal L D, behind it the reciprocals of D.
      real(dp) :: factor(max_terms, max_terms), reciprocal(max_terms), entry
      integer :: i, j, k

      do j = 1, n
         do i = j, n
            factor(i, j) = normal(i, j)
         end do
         x(:, j) = right(:, j)
         do k = 1, j - 1
            entry = factor(j, k)*reciprocal(k)
            do i = j, n
               factor(i, j) = factor(i, j) - entry*factor(i, k)
            end do
            x(:, j) = x(:, j) - entry*x(:, k)
         end do
         is_determined = factor(j, j) > least_pivot*normal(1, 1)
         if (.not. is_determined) return
         reciprocal(j) = 1.0_dp/factor(j, j)
      end do
      do j = n, 1, -1
         do k = j + 1, n
            x(:, j) = x(:, j) - factor(k, j)*x(:, k)
         end do
         x(:, j) = reciprocal(j)*x(:, j)
      end do
   end subroutine solve_normal

   !> Finds the patches of a mesh, the elements of one material around each corner node, on which stresses are
   !> recovered.
   subroutine new_patch_table(table, mesh, materials)
      type(patch_table_t), intent(out) :: table !! the patches
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      ! So many that lists of their elements are long, and threads have enough of them.
      integer, parameter :: chunk_size = 4096
      type(incidence_t) :: incidence
      type(chunk_t), allocatable :: chunks(:)
      integer, allocatable :: first_element(:)
      integer :: first, i, k, n

      call new_samples(table%samples, mesh, materials)
      call new_incidence(incidence, mesh)
      call number_patches(table%of_corner, table%node, first_element, mesh, materials, incidence)
      deallocate (incidence%corner)
      call list_blocks(table, mesh)
      n = size(table%node)
      allocate (table%frame(n), table%n_near(n), table%start(n + 1), chunks((n - 1)/chunk_size + 1))
      !$omp parallel do default(none) schedule(dynamic) if (mesh%n_elements >= worth_threads) private(k, first) &
      !$omp shared(table, mesh, materials, incidence, chunks, first_element, n)
      do i = 1, size(chunks)
         do k = (i - 1)*chunk_size + 1, min(n, i*chunk_size)
            first = chunks(i)%elements%n
            call add_patch(table, chunks(i)%elements, k, first_element(k), mesh, materials, incidence)
            table%start(k + 1) = chunks(i)%elements%n - first
         end do
      end do
      !$omp end parallel do
      table%start(1) = 1
      do k = 1, n
         table%start(k + 1) = table%start(k) + table%start(k + 1)
      end do
      allocate (table%element(table%start(n + 1) - 1))
      do i = 1, size(chunks)
         first = table%start((i - 1)*chunk_size + 1)
         table%element(first:first + chunks(i)%elements%n - 1) = chunks(i)%elements%item(:chunks(i)%elements%n)
         deallocate (chunks(i)%elements%item)
      end do
      table%is_linear = all(is_linear(table%frame))
   end subroutine new_patch_table

   !> Places the points of the elements where their stresses are most accurate.
   subroutine new_samples(samples, mesh, materials)
      type(samples_t), intent(out) :: samples !! the points
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(element_geometry_t) :: geometry
      integer :: i

      allocate (samples%start(mesh%n_elements + 1))
      samples%start(1) = 1
      do i = 1, mesh%n_elements
         samples%start(i + 1) = samples%start(i) + n_sampling_points(mesh%element_kind(i))
      end do
      allocate (samples%position(size(mesh%coordinates, 1), samples%start(mesh%n_elements + 1) - 1))
      !$omp parallel do default(none) schedule(static) if (mesh%n_elements >= worth_threads) &
      !$omp firstprivate(geometry) shared(samples, mesh, materials)
      do i = 1, mesh%n_elements
         call new_element_geometry(geometry, mesh, i, materials%list(materials%of_element(i)), &
            n_sampling_points(mesh%element_kind(i)))
         samples%position(:, samples%start(i):samples%start(i + 1) - 1) = geometry%position(:, :geometry%n_points)
      end do
      !$omp end parallel do
   end subroutine new_samples

   !> Numbers the patches: one for each corner node and each material at the node.
   subroutine number_patches(of_corner, node, element, mesh, materials, incidence)
      integer, allocatable, intent(out) :: of_corner(:) !! patch of each corner, placed as `node` of the mesh
      integer, allocatable, intent(out) :: node(:) !! node of each patch
      integer, allocatable, intent(out) :: element(:) !! first element of each patch
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer :: n, i, k, same

      allocate (of_corner(size(mesh%node)), source=0)
      n = 0
      do i = 1, mesh%n_nodes
         do k = incidence%start(i), incidence%start(i + 1) - 1
            do same = incidence%start(i), k
               if (materials%of_element(incidence%element(same)) == materials%of_element(incidence%element(k))) exit
            end do
            if (same == k) then
               n = n + 1
               of_corner(incidence%corner(k)) = n
            else
               of_corner(incidence%corner(k)) = of_corner(incidence%corner(same))
            end if
         end do
      end do
      allocate (node(n), element(n))
      do i = mesh%n_nodes, 1, -1
         do k = incidence%start(i + 1) - 1, incidence%start(i), -1
            associate (patch => of_corner(incidence%corner(k)))
               node(patch) = i
               element(patch) = incidence%element(k)
            end associate
         end do
      end do
   end subroutine number_patches

   !> Lists, for each block of elements, the patches that its elements have corners in.
   pure subroutine list_blocks(table, mesh)
      type(patch_table_t), intent(inout) :: table !! the patches, those of the corners by their numbers; gains the lists
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(integer_list_t) :: list
      integer, allocatable :: place(:)
      integer :: block, element, i, before

      allocate (place(size(table%node)), source=0)
      allocate (table%block_start((mesh%n_elements - 1)/block_size + 2))
      table%block_start(1) = 1
      do block = 1, size(table%block_start) - 1
         before = list%n
         do element = (block - 1)*block_size + 1, min(mesh%n_elements, block*block_size)
            do i = mesh%node_start(element), mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
               associate (patch => table%of_corner(i))
                  if (place(patch) <= before) then
                     call list%append(patch)
                     place(patch) = list%n
                  end if
                  patch = place(patch) - before
               end associate
            end do
         end do
         table%block_start(block + 1) = list%n + 1
      end do
      table%listed = list%items()
   end subroutine list_blocks

   !> Adds a patch. If it has too few samples for its polynomial, the elements around it are added; terms that remain
   !> undetermined are left out.
   pure subroutine add_patch(table, list, patch, first_element, mesh, materials, incidence)
      type(patch_table_t), intent(inout) :: table !! the patches; this one gains its coordinates
      type(integer_list_t), intent(inout) :: list !! elements of patches; gains those of this one
      integer, intent(in) :: patch !! number of the patch
      integer, intent(in) :: first_element !! its first element
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer, parameter :: most_growths = 2
      integer :: element, first, growth, i, k
      logical :: is_determined

      first = list%n + 1
      associate (frame => table%frame(patch), n_near => table%n_near(patch))
         frame%n_terms = n_kind_terms(mesh%element_kind(first_element))
         frame%n_dim = size(mesh%coordinates, 1)
         call add_elements_at(list, first, table%node(patch), materials, incidence, materials%of_element(first_element))
         n_near = list%n - first + 1
         do growth = 0, most_growths
            if (growth > 0) then
               do i = first, list%n
                  ! A copy: the list may move to a larger place as it grows.
                  element = list%item(i)
                  do k = mesh%node_start(element), mesh%node_start(element) + n_corners(mesh%element_kind(element)) - 1
                     call add_elements_at(list, first, mesh%node(k), materials, incidence, &
                        materials%of_element(element))
                  end do
               end do
            end if
            call place_patch(frame, is_determined, mesh, table%samples, list%item(first:list%n), n_near)
            if (is_determined) return
         end do
         do while (.not. is_determined)
            if (is_linear(frame)) then
               frame%n_terms = 1
            else if (frame%n_dim == 3) then
               frame%n_terms = merge(9, 4, frame%n_terms == max_terms)
            else
               frame%n_terms = frame%n_terms - 3
            end if
            call place_patch(frame, is_determined, mesh, table%samples, list%item(first:list%n), n_near)
         end do
      end associate
   end subroutine add_patch

   !> Adds the elements of a material at a node that the patch does not have yet.
   pure subroutine add_elements_at(list, first, node, materials, incidence, material)
      type(integer_list_t), intent(inout) :: list !! elements of patches, those of this one last
      integer, intent(in) :: first !! where these begin
      integer, intent(in) :: node !! the node
      type(materials_t), intent(in) :: materials !! the materials
      type(incidence_t), intent(in) :: incidence !! the elements at each node
      integer, intent(in) :: material !! number of the material
      integer :: k

      do k = incidence%start(node), incidence%start(node + 1) - 1
         associate (element => incidence%element(k))
            if (materials%of_element(element) /= material) cycle
            if (list%n >= first) then
               if (any(list%item(first:list%n) == element)) cycle
            end if
            call list%append(element)
         end associate
      end do
   end subroutine add_elements_at

   !> The patch around a corner of an element.
   pure integer function patch_table_at_corner(self, element, corner) result(patch)
      class(patch_table_t), intent(in) :: self !! the patches
      integer, intent(in) :: element !! the element
      integer, intent(in) :: corner !! the corner, placed as `node` of the mesh

      patch = self%listed(self%block_start((element - 1)/block_size + 1) - 1 + self%of_corner(corner))
   end function patch_table_at_corner

   !> Makes the tables by which the stresses of a body are recovered: patches of elements, sides free of tractions.
   subroutine new_recovery_tables(tables, mesh, outer, materials, constraints, springs)
      type(recovery_tables_t), intent(out) :: tables !! the tables
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      integer, intent(in) :: outer(:) !! numbers of the elements' sides on its boundary
      type(materials_t), intent(in) :: materials !! its materials
      type(constraints_t), intent(in) :: constraints !! its supports
      type(spring_side_t), intent(in) :: springs(:) !! springs along its sides

      call new_boundary_sides(tables%sides, mesh, outer, constraints, springs)
      call new_patch_table(tables%patches, mesh, materials)
   end subroutine new_recovery_tables

end module amontons_recovery_tables
