!> Linear isotropic elasticity in the plane and in bodies of revolution.
module amontons_material
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_mesh, only: mesh_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: formulation_names, hypothesis_names, material_t, materials_t, new_material, new_materials, on_axis

   !> Hypotheses that reduce a body to the plane, as a deck writes them. Under 'axisymmetric' x is the radius and y the
   !> axis of revolution.
   character(12), parameter :: hypothesis_names(*) = [character(12) :: 'plane strain', 'plane stress', 'axisymmetric']

   !> How linear quadrilaterals integrate the change of volume, as a deck writes it: at every quadrature point, or by
   !> its mean over the element (B-bar); or the one that suits Poisson's ratio.
   character(8), parameter :: formulation_names(*) = [character(8) :: 'auto', 'standard', 'b-bar']
   !> From this Poisson's ratio on linear elements lock in plane strain and in bodies of revolution.
   real(dp), parameter :: nearly_incompressible = 0.49_dp
   !> By how much nodes on the axis may miss it in the digits of a mesh file, over the largest radius.
   real(dp), parameter :: missed_axis = 1.0e-6_dp

   !> A material. Under every hypothesis stress = lambda tr(strain) I + 2 mu strain, with a lambda of its own.
   type :: material_t
      real(dp) :: young = 1.0_dp !! Young's modulus [F/L^2]
      real(dp) :: poisson = 0.0_dp !! Poisson's ratio [-]
      real(dp) :: density = 0.0_dp !! mass per volume; 0 if it is not known [M/L^3]
      real(dp) :: expansion = 0.0_dp !! coefficient of thermal expansion [1/K]
      real(dp) :: thickness = 1.0_dp !! thickness of a plane body; multiplies stiffness and loads [L]
      character(12) :: hypothesis = 'plane strain' !! one of `hypothesis_names`
      character(8) :: formulation = 'auto' !! one of `formulation_names`
      logical :: has_mean_dilatation = .false. !! whether linear quadrilaterals of it are of the B-bar formulation
      character(:), allocatable :: region !! the region it fills; empty for all that no other material fills
      real(dp) :: lambda = 0.0_dp !! first Lame coefficient of the hypothesis [F/L^2]
      real(dp) :: mu = 0.5_dp !! shear modulus [F/L^2]
      logical :: is_plane_stress = .false. !! whether the hypothesis is 'plane stress'
      logical :: is_axisymmetric = .false. !! whether the hypothesis is 'axisymmetric'
      character(:), allocatable :: origin !! where the material was specified, for messages: 'deck.nml:12: '
   contains
      procedure :: choose_formulation => material_choose_formulation
      procedure :: depth => material_depth
      procedure :: locks => material_locks
      procedure :: squared_norm => material_squared_norm
      procedure :: squared_norms => material_squared_norms
      procedure :: stress => material_stress
   end type material_t

   !> The materials of a body, all of one hypothesis.
   type :: materials_t
      type(material_t), allocatable :: list(:) !! the materials
      integer, allocatable :: of_element(:) !! which of them each element has (n_elements)
   end type materials_t

contains

   !> Makes a material that fills the whole body; name its region afterwards if it does not.
   pure subroutine new_material(material, young, poisson, hypothesis, thickness, error)
      type(material_t), intent(out) :: material !! the material
      real(dp), intent(in) :: young !! Young's modulus, positive [F/L^2]
      real(dp), intent(in) :: poisson !! Poisson's ratio, above -1 and below 0.5 [-]
      character(*), intent(in) :: hypothesis !! one of `hypothesis_names`
      real(dp), intent(in) :: thickness !! thickness, positive [L]
      type(error_t), allocatable, intent(out) :: error !! a value out of its range; the message begins with its name

      if (.not. young > 0.0_dp) then
         call new_error(error, input_refused, 'young must be positive, found '//to_text(young))
      else if (.not. (poisson > -1.0_dp .and. poisson < 0.5_dp)) then
         call new_error(error, input_refused, 'poisson must lie above -1 and below 0.5, found '//to_text(poisson))
      else if (.not. thickness > 0.0_dp) then
         call new_error(error, input_refused, 'thickness must be positive, found '//to_text(thickness))
      else if (all(hypothesis_names /= hypothesis)) then
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
      material%is_plane_stress = hypothesis == 'plane stress'
      material%is_axisymmetric = hypothesis == 'axisymmetric'
      material%mu = young/(2.0_dp*(1.0_dp + poisson))
      if (material%is_plane_stress) then
         material%lambda = young*poisson/(1.0_dp - poisson**2)
      else
         material%lambda = young*poisson/((1.0_dp + poisson)*(1.0_dp - 2.0_dp*poisson))
      end if
      call material%choose_formulation(formulation_names(1))
   end subroutine new_material

   !> Chooses how linear quadrilaterals integrate the change of volume. In plane stress nothing locks.
   pure subroutine material_choose_formulation(self, formulation)
      class(material_t), intent(inout) :: self !! the material
      character(*), intent(in) :: formulation !! one of `formulation_names`

      self%formulation = formulation
      self%has_mean_dilatation = formulation == 'b-bar' .or. (formulation == 'auto' .and. self%locks())
   end subroutine material_choose_formulation

   !> Whether linear elements of the standard formulation lock with this material.
   elemental logical function material_locks(self) result(locks)
      class(material_t), intent(in) :: self !! the material

      locks = self%poisson >= nearly_incompressible .and. .not. self%is_plane_stress
   end function material_locks

   !> Gives every element of a mesh its material: that of its region, or the one without a region.
   pure subroutine new_materials(materials, list, mesh, error)
      type(materials_t), intent(out) :: materials !! the materials of the elements
      type(material_t), intent(in) :: list(:) !! the materials
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(error_t), allocatable, intent(out) :: error
         !! no such region, two materials for an element or none, different hypotheses, or a negative radius
      integer, allocatable :: elements(:)
      integer :: i, node, rest

      rest = 0
      materials%list = list
      allocate (materials%of_element(mesh%n_elements), source=0)
      do i = 1, size(list)
         if (list(i)%hypothesis /= list(1)%hypothesis) call new_error(error, input_refused, list(i)%origin// &
            'all materials of a body must have the same hypothesis')
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
      if (.not. any(list%is_axisymmetric)) return
      node = minloc(mesh%coordinates(1, :), dim=1)
      if (mesh%coordinates(1, node) < -missed_axis*maxval(abs(mesh%coordinates(1, :)))) call new_error(error, &
         input_refused, 'node '//to_text(node)//' has the negative radius '//to_text(mesh%coordinates(1, node))// &
         "; under 'axisymmetric' x is the radius")
   end subroutine new_materials

   !> Whether a node of a body of revolution lies on the axis (n_nodes).
   pure function on_axis(mesh, materials)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! the materials, which say whether it is a body of revolution
      logical :: on_axis(mesh%n_nodes)

      on_axis = .false.
      if (any(materials%list%is_axisymmetric)) on_axis = abs(mesh%coordinates(1, :)) &
         <= missed_axis*maxval(abs(mesh%coordinates(1, :)))
   end function on_axis

   !> Stress under the hypothesis: xx, yy, xy, and zz as far as the strain zz makes it [F/L^2].
   pure function material_stress(self, strain) result(stress)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: strain(4) !! strain xx, yy, the engineering shear 2 xy, and zz (hoop; 0 in the plane) [-]
      real(dp) :: stress(4)
      real(dp) :: mean

      mean = self%lambda*(strain(1) + strain(2) + strain(4))
      stress(1:2) = mean + 2.0_dp*self%mu*strain(1:2)
      stress(3) = self%mu*strain(3)
      stress(4) = mean + 2.0_dp*self%mu*strain(4)
      if (self%is_plane_stress) stress(4) = 0.0_dp
   end function material_stress

   !> Stress times the strain that makes it, twice the density of the strain energy [F/L^2].
   pure real(dp) function material_squared_norm(self, stress) result(product)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: stress(4) !! stress xx, yy, xy, zz; zz counts in a body of revolution alone [F/L^2]
      real(dp) :: across

      across = stress(4)
      if (self%is_plane_stress) across = 0.0_dp
      if (.not. (self%is_plane_stress .or. self%is_axisymmetric)) across = self%poisson*(stress(1) + stress(2))
      product = ((1.0_dp + self%poisson)*(stress(1)**2 + stress(2)**2 + across**2 + 2.0_dp*stress(3)**2) &
         - self%poisson*(stress(1) + stress(2) + across)**2)/self%young
   end function material_squared_norm

   !> The same of stresses in a plane body, at several points side by side. There both hypotheses have one formula: in
   !> two dimensions the stress leaves no choice of its own lambda [F/L^2].
   pure function material_squared_norms(self, stress) result(products)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: stress(4, 3) !! stresses (point; xx, yy, xy) [F/L^2]
      real(dp) :: products(4)

      products = (stress(:, 1)**2 + stress(:, 2)**2 + 2.0_dp*stress(:, 3)**2 &
         - self%lambda/(2.0_dp*(self%lambda + self%mu))*(stress(:, 1) + stress(:, 2))**2)/(2.0_dp*self%mu)
   end function material_squared_norms

   !> What an area of the plane is multiplied by: the thickness, or the circumference at a radius [L].
   pure real(dp) function material_depth(self, x) result(depth)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: x !! the radius; without effect on a plane body [L]
      real(dp), parameter :: pi = acos(-1.0_dp)

      depth = merge(2.0_dp*pi*x, self%thickness, self%is_axisymmetric)
   end function material_depth

end module amontons_material
