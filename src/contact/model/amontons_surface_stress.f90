!> Stresses at the surface of the body at the contact points, from contact displacements and forces alone.
!>
!> The tangential strain of the line is the derivative of the displacements along it, the traction on it is the contact
!> force; the law of the material gives the stress along the surface and the one out of the plane. Everything is linear
!> in the factors of the parts and in the contact displacements, so that a step needs no displacements of other nodes.
module amontons_surface_stress
   use amontons_body, only: body_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_element, only: side_abscissa, side_shapes
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_face, only: face_t, set_faces
   use amontons_frame, only: turned
   use amontons_kinds, only: dp
   use amontons_load_family, only: condensed_force, load_case_t
   use amontons_material, only: axes_at_angle, in_plane, material_t, n_strains, turned_compliance
   use amontons_rounding, only: input_rounding
   implicit none (type, external)
   private

   public :: new_surface_stress, surface_stress_t

   !> The stresses along the surface and out of the plane at each point, as sums over nodal displacements.
   type :: surface_stress_t
      integer, allocatable, private :: start(:) !! first term of each sum, and one beyond the last (2m + 1)
      integer, allocatable, private :: column(:) !! contact displacement of each term (terms)
      real(dp), allocatable, private :: row(:) !! its factor (terms) [F/L^3]
      real(dp), allocatable, private :: part(:, :) !! contribution of each part to the sums (2m, parts) [F/L^2]
      real(dp), allocatable, private :: share(:, :) !! contributions of normal stress and shear to each sum (2, 2m) [-]
      real(dp), allocatable, private :: outward(:, :) !! outward normal of the surface in the frame (n; t) (2, m) [-]
      real(dp), allocatable, private :: area(:) !! area of each point (m) [L^2]
      real(dp), allocatable :: compliance(:, :, :)
         !! strains of stresses, both in the order of `stress`, the shear strain the engineering one (4, 4, m) [L^2/F]
   contains
      procedure :: stress => surface_stress_stress
   end type surface_stress_t

   !> A quadrature point on a face.
   type :: place_t
      integer :: face = 0 !! number of the face
      real(dp) :: xi = 0.0_dp !! local coordinate, from -1 to 1 [-]
      real(dp) :: weight = 0.0_dp !! weight in the mean over the point's part of the line
   end type place_t

contains

   !> Makes the sums of all points. Strains are averaged with the weight of the contact force: by the shape function of
   !> the node, or over the quadrature points of a cell.
   subroutine new_surface_stress(surface, body, contacts, parts, fields, error)
      type(surface_stress_t), intent(out) :: surface !! the stresses
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      type(load_case_t), intent(in) :: parts(:) !! the parts, for their thermal strain
      real(dp), intent(in) :: fields(:, :, :) !! displacements that each part causes (2, n_nodes, parts) [L]
      type(error_t), allocatable, intent(out) :: error !! a set is missing, or the body is twisted
      type(place_t), allocatable :: places(:)
      type(face_t), allocatable :: faces(:)
      integer :: p, set

      if (body%materials%is_twisted()) then
         call new_error(error, input_refused, "fretting = 'parameters' does not go with twist = .true.")
         return
      end if
      associate (zone => body%zone, m => body%zone%n_points)
         allocate (surface%part(2*m, size(parts)), surface%share(2, 2*m), surface%outward(2, m), &
            surface%compliance(4, 4, m), surface%column(1), surface%row(1))
         allocate (surface%start(2*m + 1), source=1)
         surface%area = zone%area
         set = 0
         do p = 1, m
            if (zone%set(p) /= set) then
               set = zone%set(p)
               call set_faces(faces, body%mesh, contacts(set)%set, error, body%materials)
               ! not raised: the zone has points of this set
               if (allocated(error)) return
            end if
            if (zone%is_cell(p)) then
               call find_cell_places(places, zone, p, faces, body%mesh%coordinates)
            else
               call find_node_places(places, zone%position(:, p), faces, body)
            end if
            call add_point(surface, p, places, faces, body, parts, fields)
         end do
      end associate
   end subroutine new_surface_stress

   !> The quadrature points of the faces at a node, weighted by its shape function and the depth.
   pure subroutine find_node_places(places, position, faces, body)
      type(place_t), allocatable, intent(out) :: places(:) !! the places
      real(dp), intent(in) :: position(2) !! coordinates of the node [L]
      type(face_t), intent(in) :: faces(:) !! the faces of the set
      type(body_t), intent(in) :: body !! the body
      integer :: i, k, point

      allocate (places(0))
      do i = 1, size(faces)
         do k = 1, faces(i)%n_nodes
            associate (face => faces(i))
               if (any(abs(body%mesh%coordinates(:, body%partner(face%node(k))) - position) > 0.0_dp)) cycle
               do point = 1, size(face%area)
                  ! With the depth a corner of a quadratic side on the axis of revolution would have no weight.
                  places = [places, place_t(i, side_abscissa(point), face%values(k, point)*merge(face%area(point), &
                     face%length(point), face%n_nodes == 2 .or. .not. body%is_axisymmetric .or. &
                     position(1) > input_rounding*face%position(1, point)))]
               end do
            end associate
         end do
      end do
   end subroutine find_node_places

   !> The quadrature points of a cell, each on the face that is nearest to it.
   pure subroutine find_cell_places(places, zone, p, faces, coordinates)
      type(place_t), allocatable, intent(out) :: places(:) !! the places
      type(contact_zone_t), intent(in) :: zone !! the contact points
      integer, intent(in) :: p !! the cell
      type(face_t), intent(in) :: faces(:) !! the faces of the set
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the mesh's nodes (2, n_nodes) [L]
      real(dp) :: values(3), slopes(3), xi, distance, least
      integer :: q, i

      allocate (places(zone%quadrature%start(p + 1) - zone%quadrature%start(p)))
      do q = 1, size(places)
         least = huge(least)
         associate (at => zone%quadrature%start(p) + q - 1)
            do i = 1, size(faces)
               associate (x => coordinates(:, faces(i)%node(:faces(i)%n_nodes)), &
                  position => zone%quadrature%position(:, at))
                  xi = 2.0_dp*dot_product(position - x(:, 1), x(:, 2) - x(:, 1))/sum((x(:, 2) - x(:, 1))**2) - 1.0_dp
                  xi = min(1.0_dp, max(-1.0_dp, xi))
                  call side_shapes(faces(i)%n_nodes > 2, xi, values, slopes)
                  distance = norm2(matmul(x, values(:faces(i)%n_nodes)) - position)
               end associate
               if (.not. distance < least) cycle
               least = distance
               places(q) = place_t(i, xi, zone%quadrature%share(at))
            end do
         end associate
      end do
   end subroutine find_cell_places

   !> Makes the sums of a point. Strains along the surface and out of the plane are the compliance times all stresses:
   !> the part that does not come from the traction comes from the two unknown stresses.
   subroutine add_point(surface, p, places, faces, body, parts, fields)
      type(surface_stress_t), intent(inout) :: surface !! gains the point
      integer, intent(in) :: p !! the point
      type(place_t), intent(in) :: places(:) !! places on its part of the line
      type(face_t), intent(in) :: faces(:) !! the faces of its set
      type(body_t), intent(in) :: body !! the body, condensed
      type(load_case_t), intent(in) :: parts(:) !! the parts, for their thermal strain
      real(dp), intent(in) :: fields(:, :, :) !! displacements that each part causes (2, n_nodes, parts) [L]
      type(material_t) :: material
      real(dp), allocatable :: field(:, :, :)
      real(dp) :: thermal(2, size(parts)), share(2, 2), outward(2), tangent(2), row(2*body%zone%n_points)
      real(dp) :: weight, values(3), slopes(3), along(2), position(2), compliance(4, 4), law(2, 2)
      real(dp) :: form(n_strains), strain(2), expansion
      integer :: i, j, k

      allocate (field(2, body%mesh%n_nodes, 2), source=0.0_dp)
      thermal = 0.0_dp
      share = 0.0_dp
      outward = 0.0_dp
      do j = 1, size(places)
         associate (n => faces(places(j)%face)%n_nodes, nodes => faces(places(j)%face)%node, &
            element => faces(places(j)%face)%element)
            weight = places(j)%weight/sum(places%weight)
            material = body%materials%list(body%materials%of_element(element))
            call side_shapes(n > 2, places(j)%xi, values, slopes)
            position = matmul(body%mesh%coordinates(:, nodes(:n)), values(:n))
            along = matmul(body%mesh%coordinates(:, nodes(:n)), slopes(:n))
            tangent = along/norm2(along)
            compliance = surface_compliance(material, tangent)
            if (material%is_plane_stress) then
               law = reshape([1.0_dp/compliance(3, 3), 0.0_dp, 0.0_dp, 0.0_dp], [2, 2])
            else
               law = reshape([compliance(4, 4), -compliance(4, 3), -compliance(3, 4), compliance(3, 3)], [2, 2]) &
                  /(compliance(3, 3)*compliance(4, 4) - compliance(3, 4)**2)
            end if
            share = share - weight*matmul(law, compliance(3:, :2))
            outward = outward + weight*[tangent(2), -tangent(1)]
            do k = 1, n
               associate (factors => field(:, nodes(k), :))
                  do i = 1, 2
                     factors(:, i) = factors(:, i) + weight*law(i, 1)*slopes(k)*along/sum(along**2)
                     if (material%is_axisymmetric) factors(1, i) = factors(1, i) &
                        + weight*law(i, 2)*values(k)/position(1)
                  end do
               end associate
            end do
            if (.not. allocated(parts(1)%element_load)) cycle
            associate (first => body%mesh%node_start(element), last => body%mesh%node_start(element + 1) - 1)
               form = material%expansion_form()
               strain = [dot_product(form(in_plane), [tangent**2, product(tangent)]), form(3)]
               do i = 1, size(parts)
                  expansion = 0.0_dp
                  do k = 1, n
                     expansion = expansion + values(k)*parts(i)%element_load(first - 1 &
                        + findloc(body%mesh%node(first:last), nodes(k), dim=1))
                  end do
                  thermal(:, i) = thermal(:, i) + weight*expansion*matmul(law, strain)
               end do
            end associate
         end associate
      end do
      material = body%materials%list(body%materials%of_element(faces(places(1)%face)%element))
      surface%outward(:, p) = matmul(outward, body%zone%frame(:, :, p))/norm2(outward)
      surface%compliance(:, :, p) = surface_compliance(material, turned(outward)/norm2(outward))
      do k = 1, 2
         associate (sum_number => 2*(p - 1) + k)
            row = condensed_force(body, field(:, :, k))
            surface%start(sum_number + 1) = surface%start(sum_number)
            do j = 1, size(row)
               if (.not. abs(row(j)) > 0.0_dp) cycle
               ! A full list doubles its length; the second half is overwritten later.
               if (surface%start(sum_number + 1) > size(surface%row)) then
                  surface%column = [surface%column, surface%column]
                  surface%row = [surface%row, surface%row]
               end if
               surface%column(surface%start(sum_number + 1)) = j
               surface%row(surface%start(sum_number + 1)) = row(j)
               surface%start(sum_number + 1) = surface%start(sum_number + 1) + 1
            end do
            surface%share(:, sum_number) = share(k, :)
            surface%part(sum_number, :) = [(sum(field(:, :, k)*fields(:, :, j)), j=1, size(parts))] - thermal(k, :)
         end associate
      end do
   end subroutine add_point

   !> The compliance in the frame of the surface: strains from stresses, both in the order of `surface_stress_stress`
   !> (4, 4) [L^2/F].
   pure function surface_compliance(material, tangent) result(compliance)
      type(material_t), intent(in) :: material !! the material
      real(dp), intent(in) :: tangent(2) !! unit vector along the surface, the outward normal on its right [-]
      real(dp) :: compliance(4, 4), turned(n_strains, n_strains)
      integer, parameter :: order(4) = [1, 4, 2, 3]

      turned = turned_compliance(material%compliance, axes_at_angle(atan2(-tangent(1), tangent(2))))
      compliance = turned(order, order)
   end function surface_compliance

   !> Stresses of each point in the frame of the surface: normal, shear (positive where the traction is along the
   !> tangent), along the surface, out of the plane (4, m) [F/L^2].
   pure function surface_stress_stress(self, factor, v, force) result(stress)
      class(surface_stress_t), intent(in) :: self !! the sums
      real(dp), intent(in) :: factor(:) !! factors of the parts [-]
      real(dp), intent(in) :: v(:) !! contact displacements (2m) [L]
      real(dp), intent(in) :: force(:) !! contact forces (2m) [F]
      real(dp) :: stress(4, size(self%area))
      real(dp) :: traction(2), sums(2*size(self%area))
      integer :: p, k, i, m

      m = size(self%area)
      sums = matmul(self%part, factor)
      do i = 1, 2*m
         do k = self%start(i), self%start(i + 1) - 1
            sums(i) = sums(i) + self%row(k)*v(self%column(k))
         end do
      end do
      do p = 1, m
         traction = -force([p, p + m])/self%area(p)
         stress(1, p) = dot_product(traction, self%outward(:, p))
         stress(2, p) = traction(2)*self%outward(1, p) - traction(1)*self%outward(2, p)
         stress(3:4, p) = sums(2*p - 1:2*p) + matmul(stress(:2, p), self%share(:, 2*p - 1:2*p))
      end do
   end function surface_stress_stress

end module amontons_surface_stress
