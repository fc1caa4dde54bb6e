!> Linear isotropic elasticity in the plane.
module amontons_material
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: hypothesis_names, material_t, new_material

   !> Hypotheses of plane elasticity, as a deck writes them.
   character(12), parameter :: hypothesis_names(2) = [character(12) :: 'plane strain', 'plane stress']

   !> A material. In the plane both hypotheses read stress = lambda tr(strain) I + 2 mu strain, with a lambda of
   !> their own.
   type :: material_t
      real(dp) :: young = 1.0_dp !! Young's modulus [F/L^2]
      real(dp) :: poisson = 0.0_dp !! Poisson's ratio [-]
      real(dp) :: thickness = 1.0_dp !! thickness of the body; multiplies stiffness and loads [L]
      character(:), allocatable :: hypothesis !! 'plane strain' or 'plane stress'
      real(dp) :: lambda = 0.0_dp !! first Lame coefficient of the hypothesis [F/L^2]
      real(dp) :: mu = 0.5_dp !! shear modulus [F/L^2]
   contains
      procedure :: axial_stress => material_axial_stress
      procedure :: stress => material_stress
   end type material_t

contains

   !> Makes a material.
   pure subroutine new_material(material, young, poisson, hypothesis, thickness, error)
      type(material_t), intent(out) :: material !! the material
      real(dp), intent(in) :: young !! Young's modulus, positive [F/L^2]
      real(dp), intent(in) :: poisson !! Poisson's ratio, above -1 and below 0.5 [-]
      character(*), intent(in) :: hypothesis !! 'plane strain' or 'plane stress'
      real(dp), intent(in) :: thickness !! thickness, positive [L]
      type(error_t), allocatable, intent(out) :: error !! a value out of its range

      if (.not. young > 0.0_dp) then
         call new_error(error, input_refused, 'young must be positive, found '//to_text(young))
      else if (.not. (poisson > -1.0_dp .and. poisson < 0.5_dp)) then
         call new_error(error, input_refused, 'poisson must lie above -1 and below 0.5, found '//to_text(poisson))
      else if (.not. thickness > 0.0_dp) then
         call new_error(error, input_refused, 'thickness must be positive, found '//to_text(thickness))
      else if (all(hypothesis_names /= hypothesis)) then
         call new_error(error, input_refused, "hypothesis must be 'plane strain' or 'plane stress', found '"// &
            hypothesis//"'")
      end if
      if (allocated(error)) return
      material%young = young
      material%poisson = poisson
      material%thickness = thickness
      material%hypothesis = hypothesis
      material%mu = young/(2.0_dp*(1.0_dp + poisson))
      if (hypothesis == 'plane strain') then
         material%lambda = young*poisson/((1.0_dp + poisson)*(1.0_dp - 2.0_dp*poisson))
      else
         material%lambda = young*poisson/(1.0_dp - poisson**2)
      end if
   end subroutine new_material

   !> Stress in the plane: xx, yy, xy [F/L^2].
   pure function material_stress(self, strain) result(stress)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: strain(3) !! strain xx, yy and the engineering shear 2 xy [-]
      real(dp) :: stress(3)

      stress = [self%lambda*(strain(1) + strain(2)) + 2.0_dp*self%mu*strain(1:2), self%mu*strain(3)]
   end function material_stress

   !> Stress across the plane, zz [F/L^2].
   pure real(dp) function material_axial_stress(self, stress) result(axial)
      class(material_t), intent(in) :: self !! the material
      real(dp), intent(in) :: stress(3) !! stress in the plane: xx, yy, xy [F/L^2]

      axial = 0.0_dp
      if (self%hypothesis == 'plane strain') axial = self%poisson*(stress(1) + stress(2))
   end function material_axial_stress

end module amontons_material
