!> Frames of directions: a normal and its tangents, orthonormal, as columns of a matrix. Tangents are made here alone.
!>
!> A frame has as many columns as a displacement has components: two in the plane, where the tangent is the normal
!> turned counterclockwise by a right angle; three in a twisted body, where the last tangent is the direction around the
!> axis; three in space, where any two tangents will do, since the law of friction knows no direction.
module amontons_frame
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: new_frame, new_frames, turned

contains

   !> A vector turned counterclockwise by a right angle.
   pure function turned(vector)
      real(dp), intent(in) :: vector(2) !! the vector
      real(dp) :: turned(2)

      turned = [-vector(2), vector(1)]
   end function turned

   !> The frame of a normal (n_components, n_components) [-].
   !>
   !> In space the tangents are the images of two axes under the Householder reflection that maps the third, the nearest
   !> to the normal, onto the normal or its opposite. The tangents of an axis are axes.
   pure function new_frame(normal, n_components) result(frame)
      real(dp), intent(in) :: normal(:) !! the normal, a unit vector (n_dim) [-]
      integer, intent(in) :: n_components !! number of components of a displacement
      real(dp) :: frame(n_components, n_components), mirror(size(normal))
      integer :: axis, k

      frame = 0.0_dp
      if (size(normal) == 2) then
         frame(3:, 3:) = 1.0_dp
         frame(:2, 1) = normal
         frame(:2, 2) = turned(normal)
         return
      end if
      axis = maxloc(abs(normal), dim=1)
      mirror = normal
      mirror(axis) = mirror(axis) + sign(1.0_dp, normal(axis))
      frame(:, 1) = normal
      do k = 2, size(normal)
         axis = 1 + modulo(axis, size(normal))
         frame(:, k) = -2.0_dp*mirror(axis)/sum(mirror**2)*mirror
         frame(axis, k) = frame(axis, k) + 1.0_dp
      end do
   end function new_frame

   !> The frames of several normals (n_components, n_components, n) [-].
   pure function new_frames(normals, n_components) result(frames)
      real(dp), intent(in) :: normals(:, :) !! the normals, unit vectors (n_dim, n) [-]
      integer, intent(in) :: n_components !! number of components of a displacement
      real(dp) :: frames(n_components, n_components, size(normals, 2))
      integer :: i

      do i = 1, size(normals, 2)
         frames(:, :, i) = new_frame(normals(:, i), n_components)
      end do
   end function new_frames

end module amontons_frame
