!> The rigid motion that moves a body which only contact holds onto its obstacles.
!>
!> Rigid motions cause no elastic forces, so that the displacements of such a body may be counted from any of them.
!> Displacements that do cause forces may be millions of times smaller than the distance to the obstacle: counted from
!> the body's position on the obstacle, they keep their digits. If the gaps do not determine this position, as for a
!> hollow body that rests on its ends, it is found from the loads, which press a rigid body onto its obstacles, or from
!> the displacements found.
module amontons_rigid_fit
   use amontons_body, only: body_t
   use amontons_dense, only: bounded_remainder, symmetric_eigenvectors
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t, recover_displacement
   use amontons_rigid_motion, only: rigid_motions_t
   implicit none (type, external)
   private

   ! Gaps are differences of coordinates: some tens of their rounding errors.
   real(dp), parameter :: rounding = 1.0e-14_dp

   public :: find_resting_motion, fit_rigid_motion, fit_travel, least_squares_amounts, recover_with_travel, &
      travel_of_nodes

contains

   !> Finds the free rigid motion that comes closest to the gaps of the points in reach, without a slip; none if much of
   !> the gaps remains. For pieces without loads the result is the gaps themselves if only rounding errors remain: these
   !> would otherwise be the only loads. A small load on a stiff body, however, needs an exact rigid motion, since any
   !> other would disturb its equilibrium.
   subroutine fit_rigid_motion(motion, body, load_case, load)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and anchors
      real(dp), intent(in) :: load(:) !! condensed load (n_rows) [F]
      real(dp), parameter :: much = 0.1_dp
      real(dp) :: aim(body%zone%n_rows)
      logical :: counts(body%zone%n_rows)

      counts = counted(body, load_case)
      aim = merge([load_case%free_gap, load_case%anchor], 0.0_dp, counts)
      motion = 0.0_dp*aim
      if (size(body%rigid_modes, 2) > 0) motion = matmul(body%rigid_modes, least_squares_amounts( &
         merge(body%rigid_modes, 0.0_dp, spread(counts, 2, size(body%rigid_modes, 2))), aim))
      if (maxval(abs(aim - motion), mask=counts) > max(much*maxval(abs(aim)), &
         rounding*maxval(abs(body%zone%position)))) motion = 0.0_dp
      associate (lengths => max(maxval(abs(aim)), maxval(abs(body%zone%position))))
         if (maxval(abs(aim - motion), mask=counts) <= rounding*lengths) then
            motion = merge(aim, motion, counts .and. &
               is_unloaded(body%rigid_modes, load, body%zone%n_points))
         end if
      end associate
   end subroutine fit_rigid_motion

   !> Finds the free rigid motion by which loads press a rigid body onto its obstacles, with the least possible slip: of
   !> all positions without overlap the one nearest to a distant point in the direction of the loads. Without loads it
   !> is the least motion from the closest fit to the gaps that removes all overlaps. None if there is no such position,
   !> or if the motion is much longer than the gaps.
   subroutine find_resting_motion(motion, body, load_case, load)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles and anchors
      real(dp), intent(in) :: load(:) !! condensed load (n_rows) [F]
      ! Length of the way without obstacles, and a gap that remains open without loads, both over the largest gap.
      real(dp), parameter :: far = 100.0_dp, apart = 1.0e-6_dp
      ! The Gram matrix of the modes has half of their digits.
      real(dp), parameter :: longest = 10.0_dp, impossible = 1.0e-10_dp, negligible = 1.0e-12_dp
      real(dp), allocatable :: in_modes(:, :), way(:, :), columns(:, :), remainder(:), slip(:, :)
      real(dp), dimension(size(body%rigid_modes, 2), size(body%rigid_modes, 2)) :: vector
      real(dp) :: value(size(body%rigid_modes, 2))
      real(dp) :: aim(body%zone%n_rows), drive(size(body%rigid_modes, 2)), amounts(size(body%rigid_modes, 2)), unit
      logical :: counts(body%zone%n_rows)
      integer :: info, k, m, n, n_slips

      m = body%zone%n_points
      counts = counted(body, load_case)
      aim = merge([load_case%free_gap, load_case%anchor], 0.0_dp, counts)
      allocate (motion(size(aim)), source=0.0_dp)
      unit = maxval(abs(aim(:m)))
      if (size(body%rigid_modes, 2) == 0 .or. .not. unit > 0.0_dp) return
      ! The motions with normal displacements of the points, each with the least slip and with the mean square 1 along
      ! the normals.
      associate (normal => merge(body%rigid_modes(:m, :), 0.0_dp, spread(counts(:m), 2, size(value))))
         vector = matmul(transpose(normal), normal)
      end associate
      call symmetric_eigenvectors(vector, value, info)
      n_slips = size(value)
      if (info == 0) n_slips = count(value <= negligible*maxval(value))
      slip = matmul(body%rigid_modes, vector)
      slip = merge(slip, 0.0_dp, spread(counts .and. [(k > m, k=1, size(counts))], 2, size(value)))
      do k = n_slips + 1, size(value)
         vector(:, k) = (vector(:, k) - matmul(vector(:, :n_slips), least_squares_amounts(slip(:, :n_slips), slip(:, &
            k)))) *sqrt(real(count(counts(:m)), dp)/value(k))
      end do
      in_modes = vector(:, n_slips + 1:)
      way = matmul(body%rigid_modes, in_modes)
      n = size(way, 2)
      amounts = least_squares_amounts(merge(body%rigid_modes, 0.0_dp, spread(counts, 2, size(body%rigid_modes, 2))), &
         aim)
      drive(:n) = matmul(load, way)
      if (any(abs(load) > 0.0_dp)) amounts = amounts + far*unit*matmul(in_modes, &
         drive(:n)/max(norm2(drive(:n)), tiny(1.0_dp)))
      motion = matmul(body%rigid_modes, amounts)
      ! The least distance under inequalities, G x >= h, from least squares (Lawson and Hanson, chapter 23).
      allocate (columns(n + 1, count(counts(:m))))
      do k = 1, n
         columns(k, :) = -pack(way(:m, k), counts(:m))
      end do
      columns(n + 1, :) = pack(motion(:m) - aim(:m), counts(:m))/unit
      if (.not. any(abs(load) > 0.0_dp)) columns(n + 1, :) = columns(n + 1, :) + apart
      remainder = bounded_remainder(columns, spread(huge(1.0_dp), 1, size(columns, 2)), [spread(0.0_dp, 1, n), 1.0_dp])
      if (remainder(n + 1) <= impossible) then
         motion = 0.0_dp
      else
         ! The amounts are summed, not the displacements: a difference of long displacements has their rounding errors,
         ! and would be no rigid motion.
         motion = matmul(body%rigid_modes, amounts - unit/remainder(n + 1)*matmul(in_modes, remainder(:n)))
         if (maxval(abs(motion)) > longest*unit) motion = 0.0_dp
      end if
   end subroutine find_resting_motion

   !> Finds the free rigid motion that makes up nearly all of the displacements of the points; 0 if there is none.
   subroutine fit_travel(motion, body, displacement)
      real(dp), allocatable, intent(out) :: motion(:) !! its displacements (u_N; u_T) of the points (n_rows) [L]
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: displacement(:) !! displacements (u_N; u_T) of the points (n_rows) [L]
      real(dp), parameter :: much = 0.01_dp

      motion = matmul(body%travel, matmul(displacement, body%travel))
      if (maxval(abs(displacement - motion)) > max(much*maxval(abs(displacement)), &
         rounding*maxval(abs(body%zone%position)))) motion = 0.0_dp
   end subroutine fit_travel

   !> Computes the displacements of all nodes from the solution of the contact problem. The free rigid motion in it is
   !> recovered apart from the rest, which so keeps its digits.
   subroutine recover_with_travel(displacement, body, load_case, solution)
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacements of all nodes (components, n_nodes) [L]
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! the load case, condensed
      real(dp), intent(in) :: solution(:) !! displacements v of the contact problem (n_rows) [L]
      real(dp) :: amounts(size(body%rigid_modes, 2))
      real(dp), allocatable :: unit_amounts(:)
      integer :: first, i, j

      if (size(amounts) == 0 .or. body%is_rotation_strained) then
         call recover_displacement(displacement, body, load_case, solution)
         return
      end if
      amounts = least_squares_amounts(body%rigid_modes, solution)
      call recover_displacement(displacement, body, load_case, solution - matmul(body%rigid_modes, amounts))
      first = 0
      do j = 1, size(body%motions)
         associate (motions => body%motions(j))
            if (motions%n_free == 0) cycle
            unit_amounts = matmul(motions%mode, amounts(first + 1:first + motions%n_free))
            do i = 1, size(motions%node)
               displacement(:, motions%node(i)) = displacement(:, motions%node(i)) + matmul(motions%unit_motions( &
                  body%mesh%coordinates(:, motions%node(i)), motions%node(i)), unit_amounts)
            end do
            first = first + motions%n_free
         end associate
      end do
   end subroutine recover_with_travel

   !> The rigid motion of each piece that is closest to the displacements of its nodes, by least squares (components,
   !> n_nodes) [L].
   function travel_of_nodes(free, coordinates, displacement) result(travel)
      type(rigid_motions_t), intent(in) :: free(:) !! the motions of each piece that are free
      real(dp), intent(in) :: coordinates(:, :) !! coordinates of the nodes (2, n_nodes) [L]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (components, n_nodes) [L]
      real(dp), allocatable :: travel(:, :)
      real(dp), allocatable :: modes(:, :)
      integer :: i, j, n

      allocate (travel, source=0.0_dp*displacement)
      do j = 1, size(free)
         associate (motions => free(j))
            if (motions%n_free == 0) cycle
            n = size(displacement, 1)
            allocate (modes(n*size(motions%node), motions%n_free))
            do i = 1, size(motions%node)
               modes(n*(i - 1) + 1:n*i, :) = motions%displacement(coordinates(:, motions%node(i)), &
                  motions%node(i))
            end do
            travel(:, motions%node) = reshape(matmul(modes, least_squares_amounts(modes, &
               reshape(displacement(:, motions%node), [size(modes, 1)]))), [n, size(motions%node)])
            deallocate (modes)
         end associate
      end do
   end function travel_of_nodes

   !> The displacements of the points for which gaps and slips give a target value (n_rows).
   pure function counted(body, load_case) result(counts)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles
      logical :: counts(body%zone%n_rows)
      integer :: k

      counts(:body%zone%n_points) = load_case%is_in_reach
      counts(body%zone%n_points + 1:) = .not. body%zone%is_slip_fixed .and. [load_case%is_in_reach, &
         (load_case%is_in_reach, k=2, body%zone%n_tangents)]
   end function counted

   !> The displacements of loose pieces without loads, including those that no motion of the piece changes (n_rows).
   pure function is_unloaded(modes, load, n_points)
      real(dp), intent(in) :: modes(:, :) !! displacements under the free motions, each of one piece (n_rows, k) [-]
      real(dp), intent(in) :: load(:) !! condensed load (n_rows) [F]
      integer, intent(in) :: n_points !! number m of contact points
      logical, dimension(size(load)) :: is_unloaded, is_loaded, is_of_piece
      integer :: i, k

      is_unloaded = .false.
      is_loaded = .false.
      do k = 1, size(modes, 2)
         is_of_piece = [(any(abs(modes(1 + modulo(i - 1, n_points)::n_points, k)) > 0.0_dp), i=1, size(load))]
         is_unloaded = is_unloaded .or. is_of_piece
         is_loaded = is_loaded .or. (is_of_piece .and. any(is_of_piece .and. abs(load) > 0.0_dp))
      end do
      is_unloaded = is_unloaded .and. .not. is_loaded
   end function is_unloaded

   !> The coefficients of some modes whose sum is closest to a target, by least squares; of several solutions the
   !> smallest.
   function least_squares_amounts(modes, aim) result(amounts)
      real(dp), intent(in) :: modes(:, :) !! displacements under each mode, 0 where they do not count (n_rows, k) [-]
      real(dp), intent(in) :: aim(:) !! displacements to come close to, 0 where they do not count (n_rows) [L]
      real(dp) :: amounts(size(modes, 2))
      ! The Gram matrix of the modes has half of their digits.
      real(dp), parameter :: negligible = 1.0e-12_dp
      real(dp) :: gram(size(modes, 2), size(modes, 2)), values(size(modes, 2))
      integer :: info, k

      gram = matmul(transpose(modes), modes)
      call symmetric_eigenvectors(gram, values, info)
      amounts = 0.0_dp
      if (info /= 0) return
      do k = 1, size(values)
         if (values(k) > negligible*maxval(values)) amounts = amounts &
            + gram(:, k)*dot_product(matmul(aim, modes), gram(:, k))/values(k)
      end do
   end function least_squares_amounts

end module amontons_rigid_fit
