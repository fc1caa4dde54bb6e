!> Stresses at the surface of the body at the contact points, from contact displacements and forces alone.
!>
!> The tangential strain of the line is the derivative of the displacements along it, the traction on it is the contact
!> force; the law of the material gives the stress along the surface and the one out of the plane. In space the surface
!> has three strains, and the law gives the three stresses that act in it. Everything is linear
!> in the factors of the parts and in the contact displacements, so that a step needs no displacements of other nodes.
module amontons_surface_stress
   use amontons_body, only: body_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_dense, only: cholesky_factor, cholesky_inverse, vector_product
   use amontons_element, only: max_nodes, quadrature_point, shape_functions, side_abscissa, side_shapes
   use amontons_error, only: error_t
   use amontons_face, only: face_kind, face_t, set_faces
   use amontons_kinds, only: dp
   use amontons_load_family, only: condensed_force, load_case_t
   use amontons_material, only: material_t, n_strains, stresses_in, turned_compliance
   use amontons_rounding, only: input_rounding
   implicit none (type, external)
   private

   public :: new_surface_stress, surface_stress_t

   !> The stresses that do not act on the surface, as sums over nodal displacements: two in the plane, along the surface
   !> and out of the plane, three in space.
   type :: surface_stress_t
      integer, allocatable, private :: start(:) !! first term of each sum, and one beyond the last (n_dim m + 1)
      integer, allocatable, private :: column(:) !! contact displacement of each term (terms)
      real(dp), allocatable, private :: row(:) !! its factor (terms) [F/L^3]
      real(dp), allocatable, private :: part(:, :) !! contribution of each part to the sums (n_dim m, parts) [F/L^2]
      real(dp), allocatable, private :: share(:, :)
         !! contributions of normal stress and shears to each sum (n_dim, n_dim m) [-]
      real(dp), allocatable, private :: axes(:, :, :)
         !! outward normal and tangents of the surface, as columns in the frame of each point (n_dim, n_dim, m) [-]
      real(dp), allocatable, private :: area(:) !! area of each point (m) [L^2]
      real(dp), allocatable :: compliance(:, :, :)
         !! strains of stresses, both in the order of `stress`, shear strains the engineering ones (2 n_dim, 2 n_dim, m)
         !! [L^2/F]
   contains
      procedure :: stress => surface_stress_stress
   end type surface_stress_t

   !> A quadrature point on a face.
   type :: place_t
      integer :: face = 0 !! number of the face
      real(dp) :: xi(2) = 0.0_dp !! local coordinates, in the plane one, from -1 to 1 [-]
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
      real(dp), intent(in) :: fields(:, :, :) !! displacements that each part causes (n_dim, n_nodes, parts) [L]
      type(error_t), allocatable, intent(out) :: error !! a set is missing
      type(place_t), allocatable :: places(:)
      type(face_t), allocatable :: faces(:)
      integer :: n, p, set

      n = size(body%zone%position, 1)
      associate (zone => body%zone, m => body%zone%n_points)
         allocate (surface%part(n*m, size(parts)), surface%share(n, n*m), surface%axes(n, n, m), &
            surface%compliance(2*n, 2*n, m), surface%column(1), surface%row(1))
         allocate (surface%start(n*m + 1), source=1)
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
      real(dp), intent(in) :: position(:) !! coordinates of the node (n_dim) [L]
      type(face_t), intent(in) :: faces(:) !! the faces of the set
      type(body_t), intent(in) :: body !! the body
      real(dp) :: xi(2), weight
      integer :: i, k, point

      allocate (places(0))
      do i = 1, size(faces)
         do k = 1, faces(i)%n_nodes
            associate (face => faces(i))
               if (any(abs(body%mesh%coordinates(:, body%partner(face%node(k))) - position) > 0.0_dp)) cycle
               do point = 1, size(face%area)
                  if (size(position) == 3) then
                     call quadrature_point(face_kind(face%n_nodes), size(face%area), point, xi, weight)
                     ! A corner of a quadratic face has no weight of its own: the square of its function is one.
                     weight = face%values(k, point)**merge(1, 2, face%n_nodes <= 4)*face%area(point)
                     places = [places, place_t(i, xi, weight)]
                     cycle
                  end if
                  ! With the depth a corner of a quadratic side on the axis of revolution would have no weight.
                  places = [places, place_t(i, [side_abscissa(point), 0.0_dp], face%values(k, point) &
                     *merge(face%area(point), face%length(point), face%n_nodes == 2 .or. .not. body%is_axisymmetric &
                     .or. position(1) > input_rounding*face%position(1, point)))]
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
               places(q) = place_t(i, [xi, 0.0_dp], zone%quadrature%share(at))
            end do
         end associate
      end do
   end subroutine find_cell_places

   !> Makes the sums of a point. Strains in the surface and out of the plane are the compliance times all stresses:
   !> the part that does not come from the traction comes from the unknown stresses.
   subroutine add_point(surface, p, places, faces, body, parts, fields)
      type(surface_stress_t), intent(inout) :: surface !! gains the point
      integer, intent(in) :: p !! the point
      type(place_t), intent(in) :: places(:) !! places on its part of the line or surface
      type(face_t), intent(in) :: faces(:) !! the faces of its set
      type(body_t), intent(in) :: body !! the body, condensed
      type(load_case_t), intent(in) :: parts(:) !! the parts, for their thermal strain
      real(dp), intent(in) :: fields(:, :, :) !! displacements that each part causes (n_dim, n_nodes, parts) [L]
      type(material_t) :: material
      real(dp), allocatable :: field(:, :, :)
      real(dp), dimension(size(fields, 1), size(fields, 1)) :: share, law
      real(dp), dimension(3) :: outward, along
      real(dp), dimension(3, 3) :: axes, push
      real(dp) :: thermal(size(fields, 1), size(parts)), row(size(fields, 1)*body%zone%n_points)
      real(dp) :: compliance(2*size(fields, 1), 2*size(fields, 1)), gradients(3, max_nodes), values(max_nodes)
      real(dp) :: form(n_strains), weight, expansion
      integer, parameter :: inner(3) = [1, 2, 4] ! places of the strains in the surface among all
      integer :: d, i, j, k

      d = size(fields, 1)
      allocate (field(d, body%mesh%n_nodes, d), source=0.0_dp)
      thermal = 0.0_dp
      share = 0.0_dp
      outward = 0.0_dp
      along = 0.0_dp
      along(:d) = body%zone%frame(:, 2, p)
      do j = 1, size(places)
         associate (n => faces(places(j)%face)%n_nodes, nodes => faces(places(j)%face)%node, &
            element => faces(places(j)%face)%element)
            weight = places(j)%weight/sum(places%weight)
            material = body%materials%list(body%materials%of_element(element))
            call measure_face(axes, values, gradients, places(j)%xi, body%mesh%coordinates(:, nodes(:n)), along)
            compliance = surface_compliance(material, axes, d)
            law = inner_law(compliance, material%is_plane_stress)
            share = share - weight*matmul(law, compliance(d + 1:, :d))
            outward = outward + weight*axes(:, 1)
            do k = 1, n
               ! How the strains along both tangents and their shear follow from the node's displacement.
               associate (slope => matmul(gradients(:, k), axes(:, 2:)), factors => field(:, nodes(k), :))
                  push(:, 1) = slope(1)*axes(:, 2)
                  push(:, 2) = slope(2)*axes(:, 3)
                  push(:, 3) = slope(2)*axes(:, 2) + slope(1)*axes(:, 3)
                  if (material%is_axisymmetric) push(1, 2) = values(k) &
                     /dot_product(body%mesh%coordinates(1, nodes(:n)), values(:n))
                  factors = factors + weight*matmul(push(:d, :d), law)
               end associate
            end do
            if (.not. allocated(parts(1)%element_load)) cycle
            associate (first => body%mesh%node_start(element), last => body%mesh%node_start(element + 1) - 1)
               form = matmul(material%expansion_form(), stresses_in(axes(:, [2, 3, 1])))
               do i = 1, size(parts)
                  expansion = 0.0_dp
                  do k = 1, n
                     expansion = expansion + values(k)*parts(i)%element_load(first - 1 &
                        + findloc(body%mesh%node(first:last), nodes(k), dim=1))
                  end do
                  thermal(:, i) = thermal(:, i) + weight*expansion*matmul(law, form(inner(:d)))
               end do
            end associate
         end associate
      end do
      material = body%materials%list(body%materials%of_element(faces(places(1)%face)%element))
      axes = tangent_axes(outward, along)
      surface%axes(:, :, p) = matmul(transpose(body%zone%frame(:, :, p)), axes(:d, :d))
      surface%compliance(:, :, p) = surface_compliance(material, axes, d)
      do k = 1, d
         associate (sum_number => d*(p - 1) + k)
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

   !> The axes of a surface: its normal, a tangent as near to a direction as can be, and the other (3, 3) [-].
   pure function tangent_axes(normal, along) result(axes)
      real(dp), intent(in) :: normal(3) !! the normal, of any length
      real(dp), intent(in) :: along(3) !! the direction, across the normal or nearly so [-]
      real(dp) :: axes(3, 3)

      axes(:, 1) = normal/norm2(normal)
      axes(:, 2) = along - dot_product(along, axes(:, 1))*axes(:, 1)
      axes(:, 2) = axes(:, 2)/norm2(axes(:, 2))
      axes(:, 3) = vector_product(axes(:, 1), axes(:, 2))
   end function tangent_axes

   !> The axes of a face at a place, and the shape functions there with their gradients in the face. A side of a plane
   !> body is a strip along z.
   pure subroutine measure_face(axes, values, gradients, xi, x, along)
      real(dp), intent(out) :: axes(3, 3) !! outward normal and tangents, as columns [-]
      real(dp), intent(out) :: values(:) !! value of each node's function (max_nodes) [-]
      real(dp), intent(out) :: gradients(:, :) !! their gradients (3, max_nodes) [1/L]
      real(dp), intent(in) :: xi(2) !! the place
      real(dp), intent(in) :: x(:, :) !! coordinates of the face's nodes (n_dim, nodes) [L]
      real(dp), intent(in) :: along(3) !! the direction of the first tangent [-]
      real(dp) :: derivatives(2, max_nodes), tangents(3, 2), normal(3), dual(3, 2)

      derivatives = 0.0_dp
      if (size(x, 1) == 2) then
         call side_shapes(size(x, 2) > 2, xi(1), values(:3), derivatives(1, :3))
      else
         call shape_functions(face_kind(size(x, 2)), xi, values, derivatives)
      end if
      tangents = reshape([0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [3, 2])
      associate (n_dim => size(x, 1))
         tangents(:n_dim, :n_dim - 1) = matmul(x, transpose(derivatives(:n_dim - 1, :size(x, 2))))
      end associate
      normal = vector_product(tangents(:, 1), tangents(:, 2))
      axes = tangent_axes(normal, along)
      dual(:, 1) = vector_product(tangents(:, 2), normal)/sum(normal**2)
      dual(:, 2) = vector_product(normal, tangents(:, 1))/sum(normal**2)
      gradients = matmul(dual, derivatives)
   end subroutine measure_face

   !> The unknown stresses of the strains that they cause, where the surface bears nothing (n_dim, n_dim) [F/L^2].
   pure function inner_law(compliance, is_plane_stress) result(law)
      real(dp), intent(in) :: compliance(:, :) !! strains of stresses, from `surface_compliance` (2 n_dim, 2 n_dim)
      logical, intent(in) :: is_plane_stress !! whether nothing acts out of the plane
      real(dp) :: law(size(compliance, 1)/2, size(compliance, 1)/2)
      integer :: info, d, n

      d = size(law, 1)
      n = merge(1, d, is_plane_stress)
      law = 0.0_dp
      law(:n, :n) = compliance(d + 1:d + n, d + 1:d + n)
      call cholesky_factor(law(:n, :n), info)
      call cholesky_inverse(law(:n, :n))
   end function inner_law

   !> The compliance in the axes of the surface: strains from stresses, both in the order of `surface_stress_stress`
   !> (2 n_dim, 2 n_dim) [L^2/F].
   pure function surface_compliance(material, axes, n_dim) result(compliance)
      type(material_t), intent(in) :: material !! the material
      real(dp), intent(in) :: axes(3, 3) !! outward normal and tangents of the surface [-]
      integer, intent(in) :: n_dim !! number of dimensions
      real(dp) :: compliance(2*n_dim, 2*n_dim), turned(n_strains, n_strains)
      integer, parameter :: order(n_strains, 2:3) = reshape([1, 4, 2, 3, 5, 6, 1, 4, 6, 2, 3, 5], [n_strains, 2])

      turned = turned_compliance(material%compliance, axes)
      compliance = turned(order(:2*n_dim, n_dim), order(:2*n_dim, n_dim))
   end function surface_compliance

   !> Stresses of each point in the frame of the surface: normal, shear (positive where the traction is along the
   !> tangent), along the surface, out of the plane (4, m); in space normal, both shears, along both tangents, and their
   !> shear (6, m) [F/L^2].
   pure function surface_stress_stress(self, factor, v, force) result(stress)
      class(surface_stress_t), intent(in) :: self !! the sums
      real(dp), intent(in) :: factor(:) !! factors of the parts [-]
      real(dp), intent(in) :: v(:) !! contact displacements (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces (n_rows) [F]
      real(dp) :: stress(2*size(self%axes, 1), size(self%area))
      real(dp) :: sums(size(self%part, 1))
      integer :: p, k, i, m, d

      m = size(self%area)
      sums = matmul(self%part, factor)
      d = size(self%axes, 1)
      do i = 1, d*m
         do k = self%start(i), self%start(i + 1) - 1
            sums(i) = sums(i) + self%row(k)*v(self%column(k))
         end do
      end do
      do p = 1, m
         stress(:d, p) = matmul(-force(p::m)/self%area(p), self%axes(:, :, p))
         stress(d + 1:, p) = sums(d*(p - 1) + 1:d*p) + matmul(stress(:d, p), self%share(:, d*(p - 1) + 1:d*p))
      end do
   end function surface_stress_stress

end module amontons_surface_stress
