!> Possible reasons for an ill-conditioned stiffness: flat elements, materials and springs of very different stiffness,
!> incompressibility.
module amontons_conditioning
   use amontons_constraints, only: spring_side_t
   use amontons_element, only: n_corners
   use amontons_kinds, only: dp
   use amontons_material, only: materials_t
   use amontons_mesh, only: mesh_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: conditioning_text, rounded

contains

   !> Text listing the reasons found, for the end of a sentence; empty if there are none.
   pure function conditioning_text(mesh, materials, springs) result(text)
      type(mesh_t), intent(in) :: mesh !! the mesh
      type(materials_t), intent(in) :: materials !! its materials
      type(spring_side_t), intent(in) :: springs(:) !! springs along its sides
      character(:), allocatable :: text
      ! Of more than 16 digits, a flatness of 1e3 costs 6, a ratio of Lame's coefficients of 1e3 costs 3.
      real(dp), parameter :: flat = 1.0e3_dp, incompressible = 1.0e3_dp, far_apart = 1.0e6_dp
      real(dp) :: worst, flatness, longest, area, from(2), to(2), ratio, spring, stiffness
      integer :: element, flattest, i, n

      text = ''
      worst = 0.0_dp
      flattest = 0
      do element = 1, mesh%n_elements
         ! The square of the longest side over the area: the length over the width.
         n = n_corners(mesh%element_kind(element))
         longest = 0.0_dp
         area = 0.0_dp
         associate (node => mesh%node(mesh%node_start(element):mesh%node_start(element) + n - 1))
            do i = 1, n
               ! Counted from a corner, so that the area of a small element far from the origin keeps its digits.
               from = mesh%coordinates(:, node(i)) - mesh%coordinates(:, node(1))
               to = mesh%coordinates(:, node(mod(i, n) + 1)) - mesh%coordinates(:, node(1))
               longest = max(longest, norm2(to - from))
               area = area + 0.5_dp*(from(1)*to(2) - from(2)*to(1))
            end do
         end associate
         flatness = longest*(longest/max(area, tiny(area)))
         if (.not. flatness > worst) cycle
         worst = flatness
         flattest = element
      end do
      if (worst > flat) text = text//'; element '//to_text(flattest)//' is '//rounded(worst)//' times as long as wide'
      associate (list => materials%list)
         ratio = maxval(list%lambda/list%mu)
         if (ratio > incompressible) text = text//"; Poisson's ratio of "// &
            to_text(list(maxloc(list%lambda/list%mu, dim=1))%poisson(1))//' makes a material nearly incompressible'
         ratio = maxval(list%young(1))/minval(list%young(1))
         if (ratio > far_apart) text = text//'; the stiffest material is '//rounded(ratio)// &
            ' times as stiff as the softest'
         ratio = 1.0_dp
         stiffness = maxval(list%young(1)*list%thickness)
         do i = 1, size(springs)
            spring = maxval(abs(springs(i)%stiffness))
            if (spring > 0.0_dp) ratio = max(ratio, spring/stiffness, stiffness/spring)
         end do
         if (ratio > far_apart) text = text//'; the stiffness of springs and that of the body differ by a factor of ' &
            //rounded(ratio)
      end associate
   end function conditioning_text

   !> A large number in short form: `3e12`.
   pure function rounded(value) result(text)
      real(dp), intent(in) :: value !! the number, at least 1
      character(:), allocatable :: text
      character(8) :: buffer
      integer :: exponent

      write (buffer, '(es8.0e3)') value
      read (buffer(5:), '(i4)') exponent
      text = trim(adjustl(buffer(:2)))//'e'//to_text(exponent)
   end function rounded

end module amontons_conditioning
