!> Elasticity of one element: stiffness, stress, nodal forces.
!>
!> The four-node quadrilateral of a plane body has procedures of its own that work on its four quadrature points side by
!> side, in a quarter of the time: fine meshes have hundreds of thousands of them.
module amontons_elasticity
   use amontons_element, only: max_nodes, max_points, n_element_nodes, n_element_points, quad4, quadrature_point, &
      shape_functions, tri3
   use amontons_kinds, only: dp
   use amontons_material, only: isotropic_law, material_t
   use amontons_mesh, only: mesh_t
   implicit none (type, external)
   private

   public :: add_point_forces, element_geometry_t, element_stiffness, element_stress, find_elastic_strains, &
      is_plain_quadrilateral, new_element_geometry, plane_quadrilateral_t, set_thermal_strain

   !> Shape functions and their gradients at the quadrature points of one element.
   type :: element_geometry_t
      ! What belongs to the reference element alone serves the next element of its kind too.
      integer, private :: kind = 0 !! kind of element
      integer :: n_points = 0 !! number of quadrature points
      real(dp) :: values(max_nodes, max_points) !! shape functions (node, point) [-]
      real(dp), private :: derivatives(2, max_nodes, max_points) !! derivatives by the reference coordinates [-]
      real(dp), private :: weight(max_points) !! weights of the quadrature [-]
      real(dp) :: thermal_strain(max_points) = 0.0_dp
         !! strain of free thermal expansion at the points, from `set_thermal_strain`; the next element keeps it [-]
      ! No defaults here: setting them would take as long as all the rest, once for each element.
      integer :: n_nodes !! number of nodes
      integer :: node(max_nodes) !! numbers of the nodes in the mesh
      real(dp) :: gradient(2, max_nodes, max_points)
         !! gradients of the functions (x and y, node, point); of a twist see `materials_twist_part` [1/L]
      real(dp) :: position(2, max_points) !! coordinates of the points [L]
      real(dp) :: volume(max_points) !! quadrature weight, Jacobian and depth of each point, 0 past the last [L^3]
      logical :: has_mean_dilatation !! whether the change of volume is that of the whole element: B-bar
      real(dp) :: mean_dilatation(2, max_nodes) !! then its mean over the element by displacement (x and y, node) [1/L]
   end type element_geometry_t

   ! Shares that the points, in the order of the corners, have of values at the first side and at the last one.
   real(dp), parameter :: near = 0.5_dp + 0.5_dp/sqrt(3.0_dp), far = 1.0_dp - near
   real(dp), parameter :: first(4) = [near, near, far, far], last(4) = [near, far, far, near]
   !> Shape functions (point, corner) [-].
   real(dp), parameter, public :: quadrilateral_shapes(4, 4) = reshape([last*first, (1.0_dp - last)*first, &
      (1.0_dp - last)*(1.0_dp - first), last*(1.0_dp - first)], [4, 4])

   !> The quadrilateral.
   type :: plane_quadrilateral_t
      integer :: node(4) = 0 !! numbers of its corners in the mesh
      real(dp) :: corner(4, 2) = 0.0_dp !! their coordinates (corner, x and y) [L]
      real(dp) :: area(4) = 0.0_dp !! area of the part of the element that each point stands for [L^2]
      real(dp) :: strain(4, 3) = 0.0_dp !! strain at the points: xx, yy, engineering shear 2 xy (point, component) [-]
      real(dp) :: stress(4, 4) = 0.0_dp !! stress there: xx, yy, xy, zz (point, component) [F/L^2]
      real(dp), private :: by_xi(4, 2) = 0.0_dp !! derivatives of x and y by the first reference coordinate [L]
      real(dp), private :: by_eta(4, 2) = 0.0_dp !! by the second one [L]
   contains
      procedure :: compute_stresses => plane_quadrilateral_compute_stresses
      procedure :: energy_density => plane_quadrilateral_energy_density
      procedure :: forces => plane_quadrilateral_forces
      procedure :: set_element => plane_quadrilateral_set_element
   end type plane_quadrilateral_t

contains

   !> Evaluates the shape functions of an element.
   pure recursive subroutine new_element_geometry(geometry, mesh, element, material, n_points)
      type(element_geometry_t), intent(inout) :: geometry
         !! the shape functions at the quadrature points; on entry anything, best those of an element of the same kind
      type(mesh_t), intent(in) :: mesh !! a checked mesh
      integer, intent(in) :: element !! number of the element
      type(material_t), intent(in) :: material !! its material, for the depth
      integer, intent(in), optional :: n_points !! number of quadrature points; default: `n_element_points`
      real(dp) :: x(2, max_nodes), dx(2), dy(2), determinant
      integer :: i, first, point

      associate (kind => mesh%element_kind(element))
         if (present(n_points)) then
            call choose_reference(geometry, kind, n_points)
         else
            call choose_reference(geometry, kind, n_element_points(kind, material%is_axisymmetric))
         end if
      end associate
      first = mesh%node_start(element)
      do i = 1, geometry%n_nodes
         geometry%node(i) = mesh%node(first + i - 1)
         x(:, i) = mesh%coordinates(:, geometry%node(i))
      end do
      do point = 1, geometry%n_points
         geometry%position(:, point) = 0.0_dp
         do i = 1, geometry%n_nodes
            geometry%position(:, point) = geometry%position(:, point) + geometry%values(i, point)*x(:, i)
         end do
         if (geometry%kind /= tri3) then
            ! The derivatives of x and of y by the reference coordinates are the rows of the Jacobian.
            dx = 0.0_dp
            dy = 0.0_dp
            do i = 1, geometry%n_nodes
               dx = dx + x(1, i)*geometry%derivatives(:, i, point)
               dy = dy + x(2, i)*geometry%derivatives(:, i, point)
            end do
            determinant = dx(1)*dy(2) - dx(2)*dy(1)
            dx = dx/determinant
            dy = dy/determinant
            do i = 1, geometry%n_nodes
               associate (derivative => geometry%derivatives(:, i, point))
                  geometry%gradient(1, i, point) = dy(2)*derivative(1) - dy(1)*derivative(2)
                  geometry%gradient(2, i, point) = dx(1)*derivative(2) - dx(2)*derivative(1)
               end associate
            end do
         else if (point == 1) then
            dx = x(1, 2:3) - x(1, 1)
            dy = x(2, 2:3) - x(2, 1)
            determinant = dx(1)*dy(2) - dy(1)*dx(2)
            geometry%gradient(:, 2, 1) = [dy(2), -dx(2)]/determinant
            geometry%gradient(:, 3, 1) = [-dy(1), dx(1)]/determinant
            geometry%gradient(:, 1, 1) = -geometry%gradient(:, 2, 1) - geometry%gradient(:, 3, 1)
         else
            ! The Jacobian of a straight triangle is the same at every point.
            geometry%gradient(:, :3, point) = geometry%gradient(:, :3, 1)
         end if
         geometry%volume(point) = geometry%weight(point)*determinant*material%depth(geometry%position(1, point))
      end do
      if (material%is_twist) then
         do point = 1, geometry%n_points
            do i = 1, geometry%n_nodes
               geometry%gradient(1, i, point) = geometry%gradient(1, i, point) &
                  - geometry%values(i, point)/geometry%position(1, point)
            end do
         end do
      end if
      geometry%has_mean_dilatation = material%has_mean_dilatation .and. geometry%kind == quad4
      if (geometry%has_mean_dilatation) call average_dilatation(geometry, mesh, element, material)
   end subroutine new_element_geometry

   !> Replaces the dilatation of each unit displacement by its mean over the element, with the quadrature points of
   !> its stiffness: in a body of revolution other points give another mean, and near a Poisson's ratio of 0.5 a wrong
   !> pressure.
   pure recursive subroutine average_dilatation(geometry, mesh, element, material)
      type(element_geometry_t), intent(inout) :: geometry !! the element's shape functions; gains the means
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! number of the element
      type(material_t), intent(in) :: material !! its material
      type(element_geometry_t), allocatable :: standard
      integer :: point

      if (geometry%n_points /= n_element_points(geometry%kind, material%is_axisymmetric)) then
         allocate (standard)
         call new_element_geometry(standard, mesh, element, material)
         geometry%mean_dilatation = standard%mean_dilatation
         return
      end if
      geometry%mean_dilatation = 0.0_dp
      associate (n => geometry%n_nodes, mean => geometry%mean_dilatation)
         do point = 1, geometry%n_points
            associate (volume => geometry%volume(point))
               mean(:, :n) = mean(:, :n) + volume*geometry%gradient(:, :n, point)
               if (material%is_axisymmetric) mean(1, :n) = mean(1, :n) &
                  + volume*geometry%values(:n, point)/geometry%position(1, point)
            end associate
         end do
         mean(:, :n) = mean(:, :n)/sum(geometry%volume(:geometry%n_points))
      end associate
   end subroutine average_dilatation

   !> Sets the thermal strain at the quadrature points from that at the nodes. With a mean dilatation its volume change,
   !> too, is replaced by the mean over the element.
   pure subroutine set_thermal_strain(geometry, at_nodes)
      type(element_geometry_t), intent(inout) :: geometry !! the element's shape functions; gains the thermal strain
      real(dp), intent(in) :: at_nodes(:) !! strain of free thermal expansion at the element's nodes (nodes) [-]

      associate (n => geometry%n_points)
         geometry%thermal_strain(:n) = matmul(at_nodes, geometry%values(:geometry%n_nodes, :n))
         if (geometry%has_mean_dilatation) geometry%thermal_strain(:n) = &
            dot_product(geometry%thermal_strain(:n), geometry%volume(:n))/sum(geometry%volume(:n))
      end associate
   end subroutine set_thermal_strain

   !> Evaluates the shape functions of a kind of element at its quadrature points, unless the last element was of this
   !> kind.
   pure subroutine choose_reference(geometry, kind, n_points)
      type(element_geometry_t), intent(inout) :: geometry !! what belongs to the reference element is set
      integer, intent(in) :: kind !! kind of element
      integer, intent(in) :: n_points !! number of quadrature points
      real(dp) :: xi(2)
      integer :: point

      if (geometry%kind == kind .and. geometry%n_points == n_points) return
      geometry%kind = kind
      geometry%n_nodes = n_element_nodes(kind)
      geometry%n_points = n_points
      geometry%volume = 0.0_dp
      do point = 1, n_points
         call quadrature_point(kind, n_points, point, xi, geometry%weight(point))
         call shape_functions(kind, xi, geometry%values(:, point), geometry%derivatives(:, :, point))
      end do
   end subroutine choose_reference

   !> Stiffness of an element: sum over the points of volume times B_i^T D B_j, D the law and B the strains of unit
   !> displacements. With a mean dilatation b, D is the law of the deviatoric stress, whose lambda is -2/3 mu, and the
   !> pressure adds (lambda + 2/3 mu) volume b_i b_j^T.
   pure subroutine element_stiffness(geometry, material, stiffness)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(out) :: stiffness(2*max_nodes, 2*max_nodes) !! in the first 2 nodes rows and columns [F/L]
      real(dp) :: xx, xy, yx, yy, bulk, law(4, 4), block(2, 2)
      integer :: i, j, point

      law = material%law
      if (geometry%has_mean_dilatation) law = isotropic_law(-2.0_dp*material%mu/3.0_dp, material%mu)
      bulk = (material%lambda + 2.0_dp*material%mu/3.0_dp)*sum(geometry%volume(:geometry%n_points))
      do j = 1, geometry%n_nodes
         do i = j, geometry%n_nodes
            xx = 0.0_dp
            xy = 0.0_dp
            yx = 0.0_dp
            yy = 0.0_dp
            do point = 1, geometry%n_points
               associate (a => geometry%gradient(:, i, point), b => geometry%gradient(:, j, point), &
                  volume => geometry%volume(point))
                  xx = xx + volume*a(1)*b(1)
                  xy = xy + volume*a(1)*b(2)
                  yx = yx + volume*a(2)*b(1)
                  yy = yy + volume*a(2)*b(2)
               end associate
            end do
            block(1, 1) = law(1, 1)*xx + law(3, 3)*yy + law(3, 1)*(xy + yx)
            block(2, 1) = law(2, 1)*yx + law(3, 3)*xy + law(3, 2)*yy + law(3, 1)*xx
            block(1, 2) = law(2, 1)*xy + law(3, 3)*yx + law(3, 2)*yy + law(3, 1)*xx
            block(2, 2) = law(2, 2)*yy + law(3, 3)*xx + law(3, 2)*(xy + yx)
            if (material%is_axisymmetric) call add_hoop_stiffness(geometry, law(:, 4), i, j, block)
            if (geometry%has_mean_dilatation) then
               associate (a => geometry%mean_dilatation(:, i), b => geometry%mean_dilatation(:, j))
                  block(:, 1) = block(:, 1) + bulk*(a*b(1))
                  block(:, 2) = block(:, 2) + bulk*(a*b(2))
               end associate
            end if
            stiffness(2*i - 1:2*i, 2*j - 1:2*j) = block
            stiffness(2*j - 1:2*j, 2*i - 1:2*i) = transpose(block)
         end do
      end do
   end subroutine element_stiffness

   !> Adds the contribution of the hoop strain u_r / r to the stiffness between two nodes.
   pure subroutine add_hoop_stiffness(geometry, law, i, j, block)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      real(dp), intent(in) :: law(4) !! stresses of a unit hoop strain [F/L^2]
      integer, intent(in) :: i !! node of the rows
      integer, intent(in) :: j !! node of the columns
      real(dp), intent(inout) :: block(2, 2) !! stiffness between the nodes [F/L]
      real(dp) :: a_by_hoop(2), hoop_by_b(2), hoop_by_hoop, hoop(2)
      integer :: point

      a_by_hoop = 0.0_dp
      hoop_by_b = 0.0_dp
      hoop_by_hoop = 0.0_dp
      do point = 1, geometry%n_points
         hoop = geometry%values([i, j], point)/geometry%position(1, point)
         a_by_hoop = a_by_hoop + geometry%volume(point)*hoop(2)*geometry%gradient(:, i, point)
         hoop_by_b = hoop_by_b + geometry%volume(point)*hoop(1)*geometry%gradient(:, j, point)
         hoop_by_hoop = hoop_by_hoop + geometry%volume(point)*hoop(1)*hoop(2)
      end do
      block(1, 1) = block(1, 1) + law(1)*(a_by_hoop(1) + hoop_by_b(1)) + law(3)*(a_by_hoop(2) + hoop_by_b(2)) &
         + law(4)*hoop_by_hoop
      block(2, 1) = block(2, 1) + law(2)*a_by_hoop(2) + law(3)*a_by_hoop(1)
      block(1, 2) = block(1, 2) + law(2)*hoop_by_b(2) + law(3)*hoop_by_b(1)
   end subroutine add_hoop_stiffness

   !> Stress at a quadrature point: xx, yy, xy, zz; in a body of revolution radial, axial, shear, hoop [F/L^2].
   pure function element_stress(geometry, material, displacement, point) result(stress)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: stress(4)

      stress = material%stress(strain_at(geometry, material, nodal_values(geometry, material, displacement), point))
   end function element_stress

   !> Computes the elastic strains at all quadrature points.
   pure subroutine find_elastic_strains(geometry, material, displacement, strain)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp), intent(inout) :: strain(4, max_points) !! the strains; unchanged past the last point [-]
      real(dp) :: u(2, max_nodes)
      integer :: point

      u = nodal_values(geometry, material, displacement)
      do point = 1, geometry%n_points
         strain(:, point) = strain_at(geometry, material, u, point)
      end do
   end subroutine find_elastic_strains

   !> The displacements of the nodes of an element, followed by zeros; less those of the first node where these are a
   !> rigid motion: differences are exact where they are small [L].
   pure function nodal_values(geometry, material, displacement) result(u)
      type(element_geometry_t), intent(in) :: geometry !! the element's nodes
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp) :: u(2, max_nodes), rigid(2)
      integer :: i

      rigid = displacement(:2, geometry%node(1))
      if (material%is_axisymmetric) rigid(1) = 0.0_dp
      do i = 1, geometry%n_nodes
         u(:, i) = displacement(:2, geometry%node(i)) - rigid
      end do
   end function nodal_values

   !> Elastic strain at a quadrature point, the total strain less the thermal one: xx, yy, the engineering shear 2 xy,
   !> and zz or the hoop strain. Without thermal strain zz is 0 in the plane, except with a mean dilatation, where the
   !> trace is the element's mean. In plane stress zz is set to 0 [-].
   pure function strain_at(geometry, material, u, point) result(strain)
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: u(2, max_nodes) !! displacements of its nodes [L]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: strain(4)
      real(dp) :: mean
      integer :: i

      strain = 0.0_dp
      do i = 1, geometry%n_nodes
         associate (g => geometry%gradient(:, i, point))
            strain(1) = strain(1) + g(1)*u(1, i)
            strain(2) = strain(2) + g(2)*u(2, i)
            strain(3) = strain(3) + (g(2)*u(1, i) + g(1)*u(2, i))
         end associate
      end do
      if (material%is_axisymmetric) then
         do i = 1, geometry%n_nodes
            strain(4) = strain(4) + geometry%values(i, point)*u(1, i)/geometry%position(1, point)
         end do
      end if
      if (geometry%has_mean_dilatation) then
         mean = 0.0_dp
         do i = 1, geometry%n_nodes
            mean = mean + dot_product(geometry%mean_dilatation(:, i), u(:, i))
         end do
         mean = (mean - strain(1) - strain(2) - strain(4))/3.0_dp
         strain(1:2) = strain(1:2) + mean
         strain(4) = strain(4) + mean
      end if
      if (abs(geometry%thermal_strain(point)) > 0.0_dp) strain = strain &
         - geometry%thermal_strain(point)*material%expansion_form()
   end function strain_at

   !> Adds the nodal forces of the stress at one quadrature point: volume times B^T stress.
   pure subroutine add_point_forces(forces, geometry, material, stress, point)
      real(dp), intent(inout) :: forces(2, max_nodes) !! nodal forces of the element [F]
      type(element_geometry_t), intent(in) :: geometry !! the element's shape functions
      type(material_t), intent(in) :: material !! its material
      real(dp), intent(in) :: stress(4) !! stress at the point, from `element_stress` [F/L^2]
      integer, intent(in) :: point !! number of the quadrature point
      real(dp) :: s(4)
      integer :: i

      s = stress*geometry%volume(point)
      do i = 1, geometry%n_nodes
         associate (g => geometry%gradient(:, i, point))
            forces(1, i) = forces(1, i) + (s(1)*g(1) + s(3)*g(2))
            forces(2, i) = forces(2, i) + (s(3)*g(1) + s(2)*g(2))
         end associate
      end do
      if (.not. material%is_axisymmetric) return
      do i = 1, geometry%n_nodes
         forces(1, i) = forces(1, i) + s(4)*geometry%values(i, point)/geometry%position(1, point)
      end do
   end subroutine add_point_forces

   !> Whether an element is a four-node quadrilateral of a plane body in the standard formulation, see
   !> `plane_quadrilateral_t`.
   pure logical function is_plain_quadrilateral(kind, material)
      integer, intent(in) :: kind !! kind of element
      type(material_t), intent(in) :: material !! its material

      is_plain_quadrilateral = kind == quad4 .and. .not. (material%is_axisymmetric .or. material%has_mean_dilatation)
   end function is_plain_quadrilateral

   !> Sets coordinates, gradients and volumes to those of an element.
   pure subroutine plane_quadrilateral_set_element(self, mesh, element)
      class(plane_quadrilateral_t), intent(inout) :: self !! the quadrilateral; its strains are those of before
      type(mesh_t), intent(in) :: mesh !! the mesh
      integer, intent(in) :: element !! the element
      integer :: i

      self%node = mesh%node(mesh%node_start(element):mesh%node_start(element) + 3)
      do i = 1, 4
         self%corner(i, 1) = mesh%coordinates(1, self%node(i))
         self%corner(i, 2) = mesh%coordinates(2, self%node(i))
      end do
      call differentiate(self%corner(:, 1), self%by_xi(:, 1), self%by_eta(:, 1))
      call differentiate(self%corner(:, 2), self%by_xi(:, 2), self%by_eta(:, 2))
      !$omp simd
      do i = 1, 4
         self%area(i) = self%by_xi(i, 1)*self%by_eta(i, 2) - self%by_eta(i, 1)*self%by_xi(i, 2)
      end do
   end subroutine plane_quadrilateral_set_element

   !> Computes strains and stresses under a displacement field.
   pure subroutine plane_quadrilateral_compute_stresses(self, material, displacement)
      class(plane_quadrilateral_t), intent(inout) :: self !! the quadrilateral; gains strains and stresses
      type(material_t), intent(in) :: material !! its material
      real(dp), contiguous, intent(in) :: displacement(:, :) !! displacement of all nodes of the mesh (2, n_nodes) [L]
      real(dp), dimension(4) :: u, v, u_xi, u_eta, v_xi, v_eta
      integer :: i, k

      do i = 1, 4
         u(i) = displacement(1, self%node(i))
         v(i) = displacement(2, self%node(i))
      end do
      call differentiate(u, u_xi, u_eta)
      call differentiate(v, v_xi, v_eta)
      !$omp simd
      do i = 1, 4
         self%strain(i, 1) = (u_xi(i)*self%by_eta(i, 2) - u_eta(i)*self%by_xi(i, 2))/self%area(i)
         self%strain(i, 2) = (v_eta(i)*self%by_xi(i, 1) - v_xi(i)*self%by_eta(i, 1))/self%area(i)
         self%strain(i, 3) = (u_eta(i)*self%by_xi(i, 1) - u_xi(i)*self%by_eta(i, 1) + v_xi(i)*self%by_eta(i, 2) &
            - v_eta(i)*self%by_xi(i, 2))/self%area(i)
      end do
      do k = 1, 4
         !$omp simd
         do i = 1, 4
            self%stress(i, k) = material%law(k, 1)*self%strain(i, 1) + material%law(k, 2)*self%strain(i, 2) &
               + material%law(k, 3)*self%strain(i, 3)
         end do
      end do
   end subroutine plane_quadrilateral_compute_stresses

   !> Strain energy densities at the four points [F/L^2].
   pure function plane_quadrilateral_energy_density(self) result(density)
      class(plane_quadrilateral_t), intent(in) :: self !! the quadrilateral, deformed
      real(dp) :: density(4)
      integer :: i

      !$omp simd
      do i = 1, 4
         density(i) = 0.5_dp*(self%strain(i, 1)*self%stress(i, 1) + self%strain(i, 2)*self%stress(i, 2) &
            + self%strain(i, 3)*self%stress(i, 3))
      end do
   end function plane_quadrilateral_energy_density

   !> Nodal forces of the stresses: the work of the stresses on each derivative of the displacements, distributed to the
   !> corners whose differences form it (x and y, corner) [F].
   pure function plane_quadrilateral_forces(self, thickness) result(forces)
      class(plane_quadrilateral_t), intent(in) :: self !! the quadrilateral, deformed
      real(dp), intent(in) :: thickness !! its thickness [L]
      real(dp) :: forces(2, 4)
      ! What derivatives along the first and the third side, and along the last and the second one have to do.
      real(dp), dimension(4, 2) :: along, across
      real(dp) :: side(4), half
      integer :: i

      !$omp simd
      do i = 1, 4
         along(i, 1) = self%stress(i, 1)*self%by_eta(i, 2) - self%stress(i, 3)*self%by_eta(i, 1)
         along(i, 2) = self%stress(i, 3)*self%by_eta(i, 2) - self%stress(i, 2)*self%by_eta(i, 1)
         across(i, 1) = self%stress(i, 3)*self%by_xi(i, 1) - self%stress(i, 1)*self%by_xi(i, 2)
         across(i, 2) = self%stress(i, 2)*self%by_xi(i, 1) - self%stress(i, 3)*self%by_xi(i, 2)
      end do
      half = 0.5_dp*thickness
      do i = 1, 2
         ! The weights `first` and `last`, summed where they are alike.
         side(1:2) = half*([near, far]*(along(1, i) + along(2, i)) + [far, near]*(along(3, i) + along(4, i)))
         side(3:4) = half*([near, far]*(across(1, i) + across(4, i)) + [far, near]*(across(2, i) + across(3, i)))
         forces(i, :) = [-side(1) - side(3), side(1) - side(4), side(2) + side(4), side(3) - side(2)]
      end do
   end function plane_quadrilateral_forces

   !> Derivatives by the reference coordinates at the points, from the changes along the sides.
   pure subroutine differentiate(values, by_xi, by_eta)
      real(dp), intent(in) :: values(4) !! values at the corners
      real(dp), intent(out) :: by_xi(4) !! derivatives by the first coordinate at the points
      real(dp), intent(out) :: by_eta(4) !! by the second one
      real(dp) :: side(4)
      integer :: i

      side = 0.5_dp*[values(2) - values(1), values(3) - values(4), values(4) - values(1), values(3) - values(2)]
      !$omp simd
      do i = 1, 4
         by_xi(i) = first(i)*side(1) + (1.0_dp - first(i))*side(2)
         by_eta(i) = last(i)*side(3) + (1.0_dp - last(i))*side(4)
      end do
   end subroutine differentiate

end module amontons_elasticity
