!> The contact points of a pair of surfaces: multipliers on the slave, integrals D and M, gaps.
!>
!> The relative displacement of point p is w_p = (sum D_pj u_j - sum M_pl u_l) / D_p, D_pj the integral of the
!> multiplier's function psi_p times the shape function of the slave's node j, M_pl that times the shape function of the
!> master's node l where the ray meets it, D_p the integral of psi_p. Both are integrated at the same quadrature points,
!> so that sum D_pj = sum M_pl = D_p and the forces on both bodies cancel exactly. The multiplier is a force, stress
!> times D_p.
!>
!> On each side the functions are dual to the hats of its corners over the part that faces the master: the integral of
!> psi_p times the hat of q is 0 for q other than p (B. Wohlmuth, SIAM J. Numer. Anal. 38, 2000). Constant multipliers
!> are 1 on their cell. A bonded corner that a support guides has no multiplier along its tangent: the tangential
!> function of its neighbor on the side is 1, so that constant shear stays among the multipliers; D_p of the tangent is
!> then another one than that of the normal.
module amontons_mortar_points
   use amontons_contact_rows, only: contact_quadrature_t, contact_rows_t, turned
   use amontons_kinds, only: dp
   use amontons_mortar_segments, only: meet_side, mortar_segment_t
   use amontons_surface, only: surface_place_t, surface_t
   implicit none (type, external)
   private

   public :: cell_pieces, corner_pieces, gauss_rule, gauss_rule_t, integrate_pieces, mortar_piece_t, mortar_points_t, &
      place_on

   !> A quadrature of -1 to 1.
   type :: gauss_rule_t
      real(dp), allocatable :: xi(:) !! abscissas [-]
      real(dp), allocatable :: weight(:) !! weights [-]
   end type gauss_rule_t

   !> A part of a slave's side that faces one side of the master, and the functions of up to two points there, which are
   !> combinations of the hats of the side's corners.
   type :: mortar_piece_t
      type(mortar_segment_t) :: segment !! the part
      integer :: point(2) = 0 !! the points, 0 for none
      real(dp) :: psi(2, 2) = 0.0_dp !! hats that make up the multiplier's function of each point (point, corner) [-]
      real(dp) :: shear(2, 2) = 0.0_dp !! the same of its tangential function [-]
      real(dp) :: hat(2, 2) = 0.0_dp !! the same of the function that gaps and friction are averaged with [-]
   end type mortar_piece_t

   !> Integrals of the points of a pair.
   type :: mortar_points_t
      real(dp), allocatable :: area(:) !! D_p (n) [L^2]
      real(dp), allocatable :: shear_area(:) !! the same of the tangential functions (n) [L^2]
      real(dp), allocatable :: length(:) !! tributary length: the integral of the averaging function (n) [L]
      real(dp), allocatable :: center(:, :) !! mean position on the slave (2, n) [L]
      real(dp), allocatable :: foot(:, :) !! mean position on the master (2, n) [L]
      real(dp), allocatable :: outward(:, :) !! mean normal of the slave, not of length 1 (2, n) [-]
      real(dp), allocatable :: normal(:, :) !! unit normal of each point, after `set_normals` (2, n) [-]
      type(contact_rows_t) :: rows
         !! shares of the nodes in w; until `set_normals` its parts are the shares in the normal and the tangential one
      type(contact_quadrature_t) :: quadrature !! the quadrature points, with their gaps
   contains
      procedure :: set_normals => mortar_points_set_normals
   end type mortar_points_t

   !> Nodes that a piece adds to the row of a point: those of both sides.
   integer, parameter :: n_piece_nodes = 6

contains

   !> Abscissas and weights of Gauss's rule on -1 to 1: zeros of the Legendre polynomial by Newton's method.
   pure type(gauss_rule_t) function gauss_rule(n) result(rule)
      integer, intent(in) :: n !! number of points
      real(dp), parameter :: pi = acos(-1.0_dp)
      integer, parameter :: n_steps = 10
      real(dp) :: p(0:n), slope
      integer :: i, k, step

      allocate (rule%xi(n), rule%weight(n))
      do i = 1, n
         associate (xi => rule%xi(i))
            xi = cos(pi*(i - 0.25_dp)/(n + 0.5_dp))
            do step = 1, n_steps
               p(0) = 1.0_dp
               p(1) = xi
               do k = 2, n
                  p(k) = ((2*k - 1)*xi*p(k - 1) - (k - 1)*p(k - 2))/k
               end do
               slope = n*(xi*p(n) - p(n - 1))/(xi**2 - 1.0_dp)
               xi = xi - p(n)/slope
            end do
            rule%weight(i) = 2.0_dp/((1.0_dp - xi**2)*slope**2)
         end associate
      end do
   end function gauss_rule

   !> The hats of the corners of a side [-].
   pure function hats(xi)
      real(dp), intent(in) :: xi !! the place, from -1 to 1 [-]
      real(dp) :: hats(2)

      hats = 0.5_dp*[1.0_dp - xi, 1.0_dp + xi]
   end function hats

   !> Gives the segments the dual functions of the corners that are points. Where one corner of a side is none, the
   !> other one's function is 1, so that constants stay among the multipliers.
   pure subroutine corner_pieces(pieces, segments, point_of, gives_shear, slave, n_points)
      type(mortar_piece_t), allocatable, intent(out) :: pieces(:) !! the pieces
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments, side by side
      integer, intent(in) :: point_of(:, :) !! point of each corner of each side of the slave, 0 for none (2, sides)
      logical, intent(in) :: gives_shear(:) !! whether a point has no shear of its own, and its neighbors take it (n)
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: n_points !! number of points of the quadrature
      type(mortar_piece_t) :: piece
      integer :: first, last, i, k

      allocate (pieces(size(segments)))
      first = 1
      do while (first <= size(segments))
         last = first
         do while (last < size(segments))
            if (segments(last + 1)%slave /= segments(first)%slave) exit
            last = last + 1
         end do
         piece%point = point_of(:, segments(first)%slave)
         if (all(piece%point > 0)) then
            piece%psi = dual_functions(segments(first:last), slave, n_points)
            piece%shear = piece%psi
            piece%hat = reshape([1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp], [2, 2])
            do k = 1, 2
               if (gives_shear(piece%point(3 - k)) .and. .not. gives_shear(piece%point(k))) piece%shear(k, :) = 1.0_dp
            end do
         else
            piece%psi = 1.0_dp
            piece%shear = 1.0_dp
            piece%hat = 1.0_dp
         end if
         do i = first, last
            piece%segment = segments(i)
            pieces(i) = piece
         end do
         first = last + 1
      end do
   end subroutine corner_pieces

   !> Cuts segments by cells of constant multipliers.
   pure subroutine cell_pieces(pieces, segments, cells)
      type(mortar_piece_t), allocatable, intent(out) :: pieces(:) !! the pieces
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments
      type(mortar_segment_t), intent(in) :: cells(:)
         !! parts of the slave's sides; in the place of the master the point that their cell is, 0 for none
      type(mortar_piece_t) :: piece
      real(dp) :: range(2)
      integer :: i, k

      allocate (pieces(0))
      piece%psi = 1.0_dp
      piece%shear = 1.0_dp
      piece%hat = 1.0_dp
      do k = 1, size(cells)
         do i = 1, size(segments)
            if (segments(i)%slave /= cells(k)%slave) cycle
            range = [max(segments(i)%range(1), cells(k)%range(1)), min(segments(i)%range(2), cells(k)%range(2))]
            if (.not. range(1) < range(2)) cycle
            piece%segment = mortar_segment_t(segments(i)%slave, segments(i)%master, range)
            piece%point = [cells(k)%master, 0]
            pieces = [pieces, piece]
         end do
      end do
   end subroutine cell_pieces

   !> The functions dual to the hats of the corners over some segments of one side, as combinations of these hats.
   !>
   !> A = diag(d) M^-1 with d and M the integrals of the hats and of their products. Where the segments cover little of
   !> the side, M is nearly singular: it is inverted in hats of the covered part.
   pure function dual_functions(segments, slave, n_points) result(dual)
      type(mortar_segment_t), intent(in) :: segments(:) !! the segments of the side
      type(surface_t), intent(in) :: slave !! the slave
      integer, intent(in) :: n_points !! number of points of the quadrature
      real(dp) :: dual(2, 2)
      type(gauss_rule_t) :: rule
      real(dp) :: mean(2), mass(2, 2), to_part(2, 2), local(2), at, area
      type(surface_place_t) :: place
      integer :: i, k

      rule = gauss_rule(n_points)
      mean = 0.0_dp
      mass = 0.0_dp
      associate (first => segments(1)%range(1), last => segments(size(segments))%range(2))
         do i = 1, size(segments)
            do k = 1, n_points
               associate (range => segments(i)%range)
                  at = 0.5_dp*(sum(range) + (range(2) - range(1))*rule%xi(k))
                  place = slave%place(segments(i)%slave, at)
                  area = 0.5_dp*(range(2) - range(1))*rule%weight(k)*norm2(place%along)*place%depth
               end associate
               mean = mean + area*hats(at)
               local = hats((2.0_dp*at - first - last)/(last - first))
               mass(:, 1) = mass(:, 1) + area*local*local(1)
               mass(:, 2) = mass(:, 2) + area*local*local(2)
            end do
         end do
         to_part = inverse(reshape([hats(first), hats(last)], [2, 2]))
      end associate
      dual = matmul(transpose(to_part), matmul(inverse(mass), to_part))
      dual = spread(mean, 2, 2)*dual
   end function dual_functions

   !> The inverse of a matrix of two rows.
   pure function inverse(matrix)
      real(dp), intent(in) :: matrix(2, 2) !! the matrix, not singular
      real(dp) :: inverse(2, 2)

      inverse = reshape([matrix(2, 2), -matrix(2, 1), -matrix(1, 2), matrix(1, 1)], [2, 2]) &
         /(matrix(1, 1)*matrix(2, 2) - matrix(1, 2)*matrix(2, 1))
   end function inverse

   !> Integrates over the pieces.
   pure subroutine integrate_pieces(points, pieces, n, slave, master, n_points)
      type(mortar_points_t), intent(out) :: points !! the points
      type(mortar_piece_t), intent(in) :: pieces(:) !! the pieces
      integer, intent(in) :: n !! number of points
      type(surface_t), intent(in) :: slave !! the slave
      type(surface_t), intent(in) :: master !! the master
      integer, intent(in) :: n_points !! number of points of the quadrature
      type(gauss_rule_t) :: rule
      real(dp) :: hat_area(n)
      integer :: n_pieces(n), filled(n), i, k, p, first_node, l, j, q
      type(surface_place_t) :: place, foot
      real(dp) :: at, area, psi(2), hat, normal(2)

      n_pieces = 0
      do i = 1, size(pieces)
         do k = 1, 2
            p = pieces(i)%point(k)
            if (p > 0) n_pieces(p) = n_pieces(p) + 1
         end do
      end do
      allocate (points%area(n), points%shear_area(n), points%length(n), points%center(2, n), points%foot(2, n), &
         points%outward(2, n), source=0.0_dp)
      call points%rows%begin(n_piece_nodes*n_pieces)
      call points%quadrature%begin(n_points*n_pieces)
      rule = gauss_rule(n_points)
      hat_area = 0.0_dp
      filled = 0
      do i = 1, size(pieces)
         do k = 1, 2
            p = pieces(i)%point(k)
            if (p == 0) cycle
            first_node = points%rows%start(p) + n_piece_nodes*filled(p) - 1
            associate (segment => pieces(i)%segment, node => points%rows%node, part => points%rows%part, &
               quadrature => points%quadrature)
               ! A straight side has no middle node; its part there is 0.
               node(first_node + 1:first_node + 3) = used_nodes(slave%side(:3, segment%slave))
               node(first_node + 4:first_node + 6) = used_nodes(master%side(:3, segment%master))
               do l = 1, size(rule%xi)
                  at = 0.5_dp*(sum(segment%range) + (segment%range(2) - segment%range(1))*rule%xi(l))
                  place = slave%place(segment%slave, at)
                  normal = place%normal/norm2(place%normal)
                  foot = master%place(segment%master, place_on(meet_side(master%corner(:, :, segment%master), &
                     place%position, normal)))
                  area = 0.5_dp*(segment%range(2) - segment%range(1))*rule%weight(l)*norm2(place%along)*place%depth
                  psi = [dot_product(pieces(i)%psi(k, :), hats(at)), dot_product(pieces(i)%shear(k, :), hats(at))]*area
                  hat = dot_product(pieces(i)%hat(k, :), hats(at))*area
                  do j = 1, 3
                     part(:, first_node + j) = part(:, first_node + j) + psi*place%values(j)
                     part(:, first_node + 3 + j) = part(:, first_node + 3 + j) - psi*foot%values(j)
                  end do
                  points%area(p) = points%area(p) + psi(1)
                  points%shear_area(p) = points%shear_area(p) + psi(2)
                  points%length(p) = points%length(p) + hat/place%depth
                  points%center(:, p) = points%center(:, p) + hat*place%position
                  points%foot(:, p) = points%foot(:, p) + hat*foot%position
                  points%outward(:, p) = points%outward(:, p) + hat*normal
                  hat_area(p) = hat_area(p) + hat
                  q = quadrature%start(p) + size(rule%xi)*filled(p) + l - 1
                  quadrature%position(:, q) = place%position
                  quadrature%normal(:, q) = normal
                  quadrature%outward(q) = 1.0_dp
                  quadrature%arc_length(q) = slave%arc_length(segment%slave) &
                     + norm2(place%position - slave%corner(:, 1, segment%slave))
                  quadrature%share(q) = hat
                  quadrature%gap(q) = dot_product(foot%position - place%position, normal)
               end do
            end associate
            filled(p) = filled(p) + 1
         end do
      end do
      do p = 1, n
         points%center(:, p) = points%center(:, p)/hat_area(p)
         points%foot(:, p) = points%foot(:, p)/hat_area(p)
         points%outward(:, p) = points%outward(:, p)/hat_area(p)
         associate (first => points%quadrature%start(p), last => points%quadrature%start(p + 1) - 1)
            points%quadrature%share(first:last) = points%quadrature%share(first:last)/hat_area(p)
         end associate
         associate (first => points%rows%start(p), last => points%rows%start(p + 1) - 1)
            points%rows%part(1, first:last) = points%rows%part(1, first:last)/points%area(p)
            points%rows%part(2, first:last) = points%rows%part(2, first:last)/points%shear_area(p)
         end associate
      end do
      call points%rows%merge_nodes()
   end subroutine integrate_pieces

   !> The nodes of a side; in the place of a middle node that it has not its first corner.
   pure function used_nodes(side) result(nodes)
      integer, intent(in) :: side(3) !! first corner, second corner, middle node or 0
      integer :: nodes(3)

      nodes = merge(side, side(1), side > 0)
   end function used_nodes

   !> Of two places on a side the one that is on it.
   pure real(dp) function place_on(xi)
      real(dp), intent(in) :: xi(2) !! the places [-]

      place_on = xi(minloc(abs(xi), dim=1))
   end function place_on

   !> Gives the rows of the points their normals.
   pure subroutine mortar_points_set_normals(self, normal)
      class(mortar_points_t), intent(inout) :: self !! the points
      real(dp), intent(in) :: normal(:, :) !! unit normal of each point (2, n) [-]
      integer :: p, i

      self%normal = normal
      self%rows%tangent = self%rows%part
      do p = 1, size(self%area)
         do i = self%rows%start(p), self%rows%start(p + 1) - 1
            self%rows%tangent(:, i) = self%rows%part(2, i)*turned(normal(:, p))
            self%rows%part(:, i) = self%rows%part(1, i)*normal(:, p)
         end do
      end do
   end subroutine mortar_points_set_normals

end module amontons_mortar_points
