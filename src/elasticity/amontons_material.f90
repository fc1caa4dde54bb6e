!> Linear elasticity in the plane, in bodies of revolution and in solids, isotropic or orthotropic.
module amontons_material
   use amontons_dense, only: cholesky_factor, cholesky_solve, vector_product
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_rounding, only: input_rounding
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: axes_at_angle, formulation_names, hypothesis_names, isotropic_law, material_t, materials_t, new_material, &
      new_materials, on_axis, stresses_in, turned_compliance

   !> Hypotheses that reduce a body to the plane, as a deck writes them. Under 'axisymmetric' x is the radius and y the
   !> axis of revolution.
   character(12), parameter :: hypothesis_names(*) = [character(12) :: 'plane strain', 'plane stress', 'axisymmetric']
   !> In the place of a hypothesis: the body is not reduced, its mesh has three coordinates.
   character(*), parameter, public :: no_hypothesis = 'solid'

   !> Integration of the volume change, as a deck writes it: at every quadrature point, or projected to few polynomials
   !> in each element (B-bar); the first word chooses the one that suits Poisson's ratio.
   character(8), parameter :: formulation_names(*) = [character(8) :: 'auto', 'standard', 'b-bar']
   !> From this Poisson's ratio on the standard formulation locks, or has alternating pressures, in plane strain and in
   !> bodies of revolution.
   real(dp), parameter :: nearly_incompressible = 0.49_dp
   !> A degree, in radians.
   real(dp), parameter :: degree = acos(-1.0_dp)/180.0_dp
   !> Largest radius of nodes that count as lying on the axis, over the largest radius of the mesh: mesh files round
   !> coordinates.
   real(dp), parameter :: missed_axis = 1.0e-6_dp

   !> Most components of displacements.
   integer, parameter, public :: max_components = 3
   !> Components of strains and stresses, in the plane and in space alike: what a body has not is 0.
   integer, parameter, public :: n_strains = 6
   !> Those in the plane: xx, yy, xy.
   integer, parameter, public :: in_plane(3) = [1, 2, 4]

   !> A material. Stresses are `law` times strains, in the order xx, yy, zz, xy, yz, xz; the last three of strains are
   !> the engineering shears 2 xy, 2 yz, 2 xz. In a body of revolution z is the direction around the axis: radial,
   !> axial, hoop, then the shears. For an isotropic one, stress = lambda tr(strain) I + 2 mu strain, with lambda
   !> adapted to the hypothesis.
   type :: material_t
      real(dp) :: young(3) = 0.0_dp !! Young's modulus; along the three axes of an orthotropic material [F/L^2]
      real(dp) :: poisson(3) = 0.0_dp
         !! Poisson's ratio; of an orthotropic material nu12, nu13, nu23: how axis 2 contracts when 1 is pulled, ... [-]
      real(dp) :: shear(3) = 0.0_dp
         !! shear moduli G12, G13, G23, of which the plane has the first; 0 if the material is isotropic [F/L^2]
      real(dp) :: axis1(3) = [1.0_dp, 0.0_dp, 0.0_dp] !! direction of axis 1 in a solid, but for the angle [-]
      real(dp) :: axis2(3) = [0.0_dp, 1.0_dp, 0.0_dp] !! direction in the plane of axes 1 and 2, on the side of 2 [-]
      real(dp) :: angle = 0.0_dp
         !! angle by which axes 1 and 2 are turned about axis 3, which is that of z but in a solid [degrees]
      real(dp) :: axes(3, 3) = 0.0_dp !! the three axes as columns [-]
      real(dp) :: density = 0.0_dp !! mass per volume; 0 if it is not known [M/L^3]
      real(dp) :: expansion(3) = 0.0_dp !! coefficient of thermal expansion, along the three axes [1/K]
      real(dp) :: thickness = 1.0_dp !! thickness of a plane body; multiplies stiffness and loads [L]
      character(12) :: hypothesis = ''
         !! one of `hypothesis_names`, or `no_hypothesis`; where it is empty, the mesh decides between it and the first
      character(8) :: formulation = 'auto' !! one of `formulation_names`
      logical :: is_b_bar = .false. !! whether its elements are of the B-bar formulation, but for linear triangles
      character(:), allocatable :: region !! the region it fills; empty for all that no other material fills
      real(dp) :: lambda = 0.0_dp !! first Lame coefficient of the hypothesis, if the material is isotropic [F/L^2]
      real(dp) :: mu = 0.5_dp !! then the shear modulus [F/L^2]
      integer :: n_components = 2 !! components of a displacement: x, y and z or, with twist, the one around the axis
      real(dp) :: law(n_strains, n_strains) = 0.0_dp !! stresses of strains under the hypothesis [F/L^2]
      real(dp) :: compliance(n_strains, n_strains) = 0.0_dp !! strains of stresses in space [L^2/F]
      real(dp) :: plane_compliance(3, 3) = 0.0_dp
         !! the same in a plane body, where the stress zz follows from the hypothesis [L^2/F]
      logical :: is_plane_stress = .false. !! whether the hypothesis is 'plane stress'
      logical :: is_axisymmetric = .false. !! whether the hypothesis is 'axisymmetric'
      logical :: is_solid = .false. !! whether the body is not reduced to the plane
      logical :: is_twisted = .false. !! whether its body may twist about the axis of revolution
      character(:), allocatable :: origin !! where the material was specified, for messages: 'deck.nml:12: '
   contains
      procedure :: bulk => material_bulk
      procedure :: choose_formulation => material_choose_formulation
      procedure :: depth => material_depth
      procedure :: derive => material_derive
      procedure :: expansion_form => material_expansion_form
      procedure :: largest_expansion => material_largest_expansion
      procedure :: locks => material_locks
      procedure :: squared_norm => material_squared_norm
      procedure :: squared_norms => material_squared_norms
      procedure :: stress => material_stress
   end type material_t

   !> The materials of a body, all of one hypothesis.
   type :: materials_t
      type(material_t), allocatable :: list(:) !! the materials
      integer, allocatable :: of_element(:) !! which of them each element has (n_elements)
   contains
      procedure :: is_twisted => materials_is_twisted
      procedure :: n_components => materials_n_components
   end type materials_t

contains

   !> Makes a material that fills the whole body; for a part of the body set its region afterwards.
   pure subroutine new_material(material, young, poisson, hypothesis, thickness, error)
      type(material_t), intent(out) :: material !! the material
      real(dp), intent(in) :: young !! Young's modulus, positive [F/L^2]
      real(dp), intent(in) :: poisson !! Poisson's ratio, above -1 and below 0.5 [-]
      character(*), intent(in) :: hypothesis !! one of `hypothesis_names`, or `no_hypothesis`
      real(dp), intent(in) :: thickness !! thickness, positive; 1 for a solid [L]
      type(error_t), allocatable, intent(out) :: error !! a value out of its range; the message begins with its name

      if (.not. young > 0.0_dp) then
         call new_error(error, input_refused, 'young must be positive, found '//to_text(young))
      else if (.not. (poisson > -1.0_dp .and. poisson < 0.5_dp)) then
         call new_error(error, input_refused, 'poisson must lie above -1 and below 0.5, found '//to_text(poisson))
      else if (.not. thickness > 0.0_dp) then
         call new_error(error, input_refused, 'thickness must be positive, found '//to_text(thickness))
      else if (all([character(12) :: hypothesis_names, no_hypothesis] /= hypothesis)) then
         call new_error(error, input_refused, "hypothesis must be 'plane strain', 'plane stress' or "// &
            "'axisymmetric', found '"//hypothesis//"'")
      end if
      if (allocated(error)) return
      material%young = young
      material%poisson = poisson
      material%thickness = thickness
      material%hypothesis = hypothesis
      material%region = ''
      material%origin = ''
      call material%derive(error)
   end subroutine new_material

   !> Derives the law from constants and hypothesis. An orthotropic material is one that has `shear`.
   pure subroutine material_derive(self, error)
      class(material_t), intent(inout) :: self !! the material
      type(error_t), allocatable, intent(out) :: error !! an orthotropic material that would gain energy when strained
      ! Least eigenvalue of the compliance in units of its diagonal: below it rounding spoils stresses.
      real(dp), parameter :: least = 1.0e-10_dp
      ! Stresses that are not 0 in plane stress, zz, and those that only a solid couples with them.
      integer, parameter :: stressed(n_strains) = [in_plane, 3, 5, 6]
      real(dp) :: law(n_strains, n_strains), root(3), stiffness(n_strains, n_strains)
      integer :: i, info, n

      self%is_plane_stress = self%hypothesis == 'plane stress'
      self%is_axisymmetric = self%hypothesis == 'axisymmetric'
      self%is_solid = self%hypothesis == no_hypothesis
      if (self%is_twisted .and. (self%shear(1) > 0.0_dp .or. .not. self%is_axisymmetric)) then
         call new_error(error, input_refused, "twist needs hypothesis = 'axisymmetric' and an isotropic material")
      else if (.not. norm2(vector_product(self%axis1, self%axis2)) &
         > input_rounding*norm2(self%axis1)*norm2(self%axis2)) then
         call new_error(error, input_refused, 'axis1 and axis2 must have different directions')
      end if
      if (allocated(error)) return
      self%n_components = merge(3, 2, self%is_twisted .or. self%is_solid)
      self%axes(:, 1) = self%axis1/norm2(self%axis1)
      self%axes(:, 3) = vector_product(self%axes(:, 1), self%axis2)
      self%axes(:, 3) = self%axes(:, 3)/norm2(self%axes(:, 3))
      self%axes(:, 2) = vector_product(self%axes(:, 3), self%axes(:, 1))
      self%axes = matmul(self%axes, axes_at_angle(self%angle*degree))
      associate (young => self%young, poisson => self%poisson)
         self%compliance = 0.0_dp
         do i = 1, 3
            self%compliance(i, i) = 1.0_dp/young(i)
            self%compliance(i + 3, i + 3) = 2.0_dp*(1.0_dp + poisson(1))/young(1)
         end do
         self%compliance(2, 1) = -poisson(1)/young(1)
         self%compliance(3, 1) = -poisson(2)/young(1)
         self%compliance(3, 2) = -poisson(3)/young(2)
         self%compliance(1, 2) = self%compliance(2, 1)
         self%compliance(1, 3) = self%compliance(3, 1)
         self%compliance(2, 3) = self%compliance(3, 2)
      end associate
      if (self%shear(1) > 0.0_dp) then
         root = sqrt([(self%compliance(i, i), i=1, 3)])
         law(:3, :3) = self%compliance(:3, :3)/(spread(root, 1, 3)*spread(root, 2, 3))
         do i = 1, 3
            law(i, i) = 1.0_dp - least
         end do
         call cholesky_factor(law(:3, :3), info)
         if (info /= 0) then
            call new_error(error, input_refused, 'the elastic constants are not positive definite: nu12**2 E2/E1, '// &
               'nu13**2 E3/E1 and nu23**2 E3/E2 must be below 1, and so must their sum and 2 nu12 nu13 nu23 E3/E1')
            return
         end if
         ! In the order of the strains: xy, yz, xz.
         do i = 1, 3
            self%compliance(i + 3, i + 3) = 1.0_dp/self%shear(merge(i, 5 - i, i == 1))
         end do
         self%compliance = turned_compliance(self%compliance, transpose(self%axes))
         ! In plane stress the strain zz is not known, and makes no stress.
         n = merge(6, merge(3, 4, self%is_plane_stress), self%is_solid)
         law = self%compliance(stressed, stressed)
         stiffness = 0.0_dp
         do i = 1, n
            stiffness(i, i) = 1.0_dp
         end do
         call cholesky_factor(law(:n, :n), info)
         call cholesky_solve(law(:n, :n), stiffness(:n, :n))
         self%law(stressed, stressed) = stiffness
         self%lambda = self%law(1, 2)
         self%mu = self%shear(1)
      else
         associate (young => self%young(1), poisson => self%poisson(1))
            self%mu = young/(2.0_dp*(1.0_dp + poisson))
            self%lambda = young*poisson/((1.0_dp + poisson) &
               *(1.0_dp - merge(1.0_dp, 2.0_dp, self%is_plane_stress)*poisson))
         end associate
         self%law = isotropic_law(self%lambda, self%mu)
         if (self%is_plane_stress) self%law(:, 3) = 0.0_dp
         if (self%is_plane_stress) self%law(3, :) = 0.0_dp
      end if
      associate (s => self%compliance)
         self%plane_compliance = s(in_plane, in_plane)
         if (.not. self%is_plane_stress) self%plane_compliance = self%plane_compliance &
            - spread(s(in_plane, 3), 2, 3)*spread(s(3, in_plane), 1, 3)/s(3, 3)
      end associate
      call self%choose_formulation((self%formulation))
   end subroutine material_derive

   !> The stiffness matrix of an isotropic material [F/L^2].
   pure function isotropic_law(lambda, mu) result(law)
      real(dp), intent(in) :: lambda !! first Lame coefficient [F/L^2]
      real(dp), intent(in) :: mu !! shear modulus [F/L^2]
      real(dp) :: law(n_strains, n_strains)
      integer :: i

      law = 0.0_dp
      law(:3, :3) = lambda
      do i = 1, n_strains
         law(i, i) = law(i, i) + merge(mu, 2.0_dp*mu, i > 3)
      end do
   end function isotropic_law

   !> The bulk modulus of an isotropic material in plane strain or a body of revolution [F/L^2].
   elemental real(dp) function material_bulk(self) result(bulk)
      class(material_t), intent(in) :: self !! the material

      bulk = self%lambda + 2.0_dp*self%mu/3.0_dp
   end function material_bulk

   !> A compliance matrix in other axes [L^2/F].
   pure function turned_compliance(compliance, axes) result(turned)
      real(dp), intent(in) :: compliance(n_strains, n_strains) !! the compliance [L^2/F]
      real(dp), intent(in) :: axes(3, 3) !! the other axes, orthonormal, as columns [-]
      real(dp) :: turned(n_strains, n_strains), stress(n_strains, n_strains)

      stress = stresses_in(axes)
      turned = matmul(transpose(stress), matmul(compliance, stress))
   end function turned_compliance

   !> The stresses in the old axes that unit stresses in other axes are. Strains in the other axes are its transpose
   !> times those in the old ones [-].
   pure function stresses_in(axes) result(stress)
      real(dp), intent(in) :: axes(3, 3) !! the other axes, orthonormal, as columns [-]
      real(dp) :: stress(n_strains, n_strains)
      integer, parameter :: first(n_strains) = [1, 2, 3, 1, 2, 1], second(n_strains) = [1, 2, 3, 2, 3, 3]
      integer :: i, k

      do k = 1, n_strains
         do i = 1, n_strains
            stress(i, k) = axes(first(i), first(k))*axes(second(i), second(k))
            if (k > 3) stress(i, k) = stress(i, k) + axes(first(i), second(k))*axes(second(i), first(k))
         end do
      end do
   end function stresses_in

   !> The axes that are turned about z by an angle, counterclockwise, as columns [-].
   pure function axes_at_angle(angle) result(axes)
      real(dp), intent(in) :: angle !! the angle [rad]
      real(dp) :: axes(3, 3)

      axes = reshape([cos(angle), sin(angle), 0.0_dp, -sin(angle), cos(angle), 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 3])
   end function axes_at_angle

   !> Chooses the integration of the volume change. In plane stress there is no locking.
   pure subroutine material_choose_formulation(self, formulation)
      class(material_t), intent(inout) :: self !! the material
      character(*), intent(in) :: formulation !! one of `formulation_names`

      self%formulation = formulation
      self%is_b_bar = formulation == 'b-bar' .or. (formulation == 'auto' .and. self%locks())
   end subroutine material_choose_formulation

   !> Whether the standard formulation fails with this material: linear elements lock, pressures of others alternate.
   elemental logical function material_locks(self) result(locks)
      class(material_t), intent(in) :: self !! the material

      locks = self%poisson(1) >= nearly_incompressible .and. .not. (self%is_plane_stress .or. self%shear(1) > 0.0_dp)
   end function material_locks

   !> Assigns a material to every element of a mesh: that of its region, or the one without a region.
   pure subroutine new_materials(materials, list, mesh, error)
      type(materials_t), intent(out) :: materials !! the materials of the elements
      type(material_t), intent(in) :: list(:) !! the materials
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(error_t), allocatable, intent(out) :: error
         !! no such region, two materials for an element or none, different hypotheses or others than the mesh has, or a
         !! negative radius
      integer, allocatable :: elements(:)
      integer :: i, node, rest

      rest = 0
      materials%list = list
      allocate (materials%of_element(mesh%n_elements), source=0)
      do i = 1, size(list)
         call settle_hypothesis(materials%list(i), size(mesh%coordinates, 1), error)
         if (allocated(error)) error%message = list(i)%origin//error%message
         if (allocated(error)) return
      end do
      do i = 1, size(list)
         if (materials%list(i)%hypothesis /= materials%list(1)%hypothesis) then
            call new_error(error, input_refused, list(i)%origin// &
               'all materials of a body must have the same hypothesis')
         else if (list(i)%is_twisted .neqv. list(1)%is_twisted) then
            call new_error(error, input_refused, list(i)%origin//'all materials of a body must have the same twist')
         end if
         if (allocated(error)) return
         if (len(list(i)%region) == 0) then
            if (rest > 0) call new_error(error, input_refused, list(i)%origin// &
               'two materials without a region; at most one can fill the rest of the body')
            if (allocated(error)) return
            rest = i
            cycle
         end if
         call mesh%region_elements(list(i)%region, elements, error)
         if (allocated(error)) then
            error%message = list(i)%origin//error%message
         else if (any(materials%of_element(elements) /= 0)) then
            call new_error(error, input_refused, list(i)%origin//"an element of the region '"//list(i)%region// &
               "' has another material already")
         else
            materials%of_element(elements) = i
         end if
         if (allocated(error)) return
      end do
      if (rest == 0 .and. any(materials%of_element == 0)) then
         call new_error(error, input_refused, 'element '//to_text(findloc(materials%of_element, 0, dim=1))// &
            ' has no material: no region that a material names contains it')
         return
      end if
      where (materials%of_element == 0) materials%of_element = rest
      if (.not. any(materials%list%is_axisymmetric)) return
      node = minloc(mesh%coordinates(1, :), dim=1)
      if (mesh%coordinates(1, node) < -missed_axis*maxval(abs(mesh%coordinates(1, :)))) call new_error(error, &
         input_refused, 'node '//to_text(node)//' has the negative radius '//to_text(mesh%coordinates(1, node))// &
         "; under 'axisymmetric' x is the radius")
   end subroutine new_materials

   !> Chooses the hypothesis of a material that has none by the mesh, derives its law, checks that the mesh suits it.
   pure subroutine settle_hypothesis(material, n_dim, error)
      type(material_t), intent(inout) :: material !! the material
      integer, intent(in) :: n_dim !! number of coordinates of the mesh
      type(error_t), allocatable, intent(out) :: error !! the mesh does not suit it, or as of `derive`

      if (material%hypothesis == '' .and. n_dim == 3) material%hypothesis = no_hypothesis
      if (material%hypothesis == '') material%hypothesis = hypothesis_names(1)
      call material%derive(error)
      if (allocated(error)) return
      if (material%is_solid .neqv. n_dim == 3) then
         call new_error(error, input_refused, 'the mesh has '//to_text(n_dim)// &
            " coordinates and does not suit hypothesis '"//trim(material%hypothesis)//"'")
      else if (material%is_solid .and. abs(material%thickness - 1.0_dp) > 0.0_dp) then
         call new_error(error, input_refused, 'thickness is only for plane bodies')
      end if
   end subroutine settle_hypothesis

   !> Whether the body may twist about its axis of revolution: displacements then have a component around it.
   pure logical function materials_is_twisted(self) result(is_twisted)
      class(materials_t), intent(in) :: self !! the materials

      is_twisted = self%list(1)%is_twisted
   end function materials_is_twisted

   !> Number of displacement components: x and y, and z in a solid or in a twisted body the one around the axis.
   pure integer function materials_n_components(self) result(n_components)
      class(materials_t), intent(in) :: self !! the materials

      n_components = self%list(1)%n_components
   end function materials_n_components

   !> Whether each node lies on the axis of a body of revolution (n_nodes).
   pure function on_axis(mesh, materials)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials; they record whether it is a body of revolution
      logical :: on_axis(mesh%n_nodes)

      on_axis = .false.
      if (any(materials%list%is_axisymmetric)) on_axis = abs(mesh%coordinates(1, :)) &
         <= missed_axis*maxval(abs(mesh%coordinates(1, :)))
   end function on_axis

   !> Stress from strain under the hypothesis of the material; in the plane zz is 0 without heat [F/L^2].
   pure function material_stress(self, strain) result(stress)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: strain(n_strains) !! the strain, shears the engineering ones [-]
      real(dp) :: stress(n_strains)
      integer :: i

      if (self%is_solid) then
         stress = matmul(self%law, strain)
         return
      end if
      do i = 1, 4
         stress(i) = self%law(i, 1)*strain(1) + self%law(i, 2)*strain(2) + self%law(i, 3)*strain(3) &
            + self%law(i, 4)*strain(4)
      end do
      ! No material of a body of revolution couples these shears with anything.
      stress(5) = self%law(5, 5)*strain(5)
      stress(6) = self%law(6, 6)*strain(6)
   end function material_stress

   !> The coefficient of thermal expansion with the largest magnitude [1/K].
   elemental real(dp) function material_largest_expansion(self) result(expansion)
      class(material_t), intent(in) :: self !! the material

      expansion = self%expansion(maxloc(abs(self%expansion), dim=1))
   end function material_largest_expansion

   !> Free thermal strain over that in the direction of the largest coefficient; zz is 0 in plane stress [-].
   pure function material_expansion_form(self) result(form)
      class(material_t), intent(in) :: self !! the material
      real(dp) :: form(n_strains)
      real(dp) :: along(3)
      integer :: i

      along = 1.0_dp
      if (abs(self%largest_expansion()) > 0.0_dp) along = self%expansion/self%largest_expansion()
      associate (axes => self%axes)
         form(:3) = [(sum(along*axes(i, :)**2), i=1, 3)]
         form(4:) = 2.0_dp*[(sum(along*axes(i, :)*axes(modulo(i, 3) + 1, :)), i=1, 3)]
      end associate
      if (self%is_plane_stress) form(3) = 0.0_dp
   end function material_expansion_form

   !> Stress times its strain, which is twice the strain energy density [F/L^2].
   pure real(dp) function material_squared_norm(self, stress) result(product)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: stress(n_strains) !! the stress; zz counts in solids and bodies of revolution [F/L^2]

      if (self%is_solid .or. self%is_axisymmetric) then
         product = dot_product(stress, matmul(self%compliance, stress))
      else
         product = dot_product(stress(in_plane), matmul(self%plane_compliance, stress(in_plane)))
      end if
   end function material_squared_norm

   !> Stress times its strain in a plane body, at four points at once [F/L^2].
   pure function material_squared_norms(self, stress) result(products)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: stress(4, 3) !! stresses (point; xx, yy, xy) [F/L^2]
      real(dp) :: products(4)

      associate (s => self%plane_compliance)
         products = s(1, 1)*stress(:, 1)**2 + s(2, 2)*stress(:, 2)**2 + s(3, 3)*stress(:, 3)**2 &
            + 2.0_dp*(s(2, 1)*stress(:, 1)*stress(:, 2) + stress(:, 3)*(s(3, 1)*stress(:, 1) + s(3, 2)*stress(:, 2)))
      end associate
   end function material_squared_norms

   !> Factor from areas of the plane to volumes: the thickness, or the circumference at a radius [L].
   elemental real(dp) function material_depth(self, x) result(depth)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: x !! the radius; without effect but in a body of revolution [L]
      real(dp), parameter :: pi = acos(-1.0_dp)

      depth = merge(2.0_dp*pi*x, self%thickness, self%is_axisymmetric)
   end function material_depth

end module amontons_material
