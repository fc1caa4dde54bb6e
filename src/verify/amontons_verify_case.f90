!> Verification of the files of a solved case against each other: its result is restored from the deck, the mesh, the
!> displacements in NAME.vtu and the forces and statuses in NAME.contact.csv; all files are made again from it and
!> compared. For a reduced problem u = W r + q and the contact law are computed again from the problem as it is read and
!> the forces.
!>
!> No matrix is assembled or factorized, and no method runs: the forces of the elements follow from their displacements,
!> one by one.
module amontons_verify_case
   use amontons_body, only: body_t
   use amontons_config, only: config_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_document, only: document_t
   use amontons_error, only: error_t, fault_list_t
   use amontons_file_check, only: agree, csv_table_t, new_vtk_check, read_array, read_csv_table, verified_case_t, &
      vtk_check_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, slip_point, status_names, stick_point, &
      tangential_norm
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t, load_family_t
   use amontons_quantity, only: quantity_t
   use amontons_reduced_study, only: new_reduced_check, new_reduced_summary, prepare_reduced, reduced_documents, &
      reduced_result_t
   use amontons_report, only: case_documents, new_summary
   use amontons_result, only: certificate_limit, judge_meshes, outcome_no_equilibrium, refined_quantities, result_t, &
      word_no_equilibrium
   use amontons_result_warnings, only: add_result_warnings
   use amontons_sliding, only: take_displacement
   use amontons_solve_case, only: cache_t, evaluate, prepare_single_case, solve_case
   use amontons_text, only: read_reals, replaced, to_text
   use amontons_vtu, only: show_body, show_contact_line
   implicit none (type, external)
   private

   public :: check_grids, check_statuses, contact_state_t, follow_statuses, law_scales_t, scales_of, verify_answer, &
      verify_case, verify_reduced, verify_result

   !> Gaps, slips, forces and statuses of the contact points.
   type :: contact_state_t
      real(dp), allocatable :: gap(:) !! distance to the obstacle (m) [L]
      real(dp), allocatable :: slip(:) !! tangential displacement (m) [L]
      real(dp), allocatable :: force(:) !! normal forces, then tangential ones along the slip (2m) [F]
      integer, allocatable :: status(:) !! statuses (m)
   end type contact_state_t

   !> Lengths and forces that count as zero in a case.
   type :: law_scales_t
      real(dp) :: length = 0.0_dp !! displacements up to this count as none [L]
      real(dp) :: force = 0.0_dp !! forces up to this count as none [F]
   end type law_scales_t

   !> Names of the columns of the tangential forces: for bodies in the plane, followed by those of reduced problems in
   !> space.
   character(22), parameter :: shear_names(4) = [character(22) :: 'tangential_force', 'tangential_force_theta', &
      'tangential_force_1', 'tangential_force_2']
   !> Names of the columns of the forces on a solid.
   character(22), parameter :: force_names(3) = [character(22) :: 'force_x', 'force_y', 'force_z']

contains

   !> Verifies the files of a single case.
   subroutine verify_case(case, cache)
      type(verified_case_t), intent(inout) :: case !! the case; gains the faults of all files, and the verdict
      type(cache_t), intent(inout) :: cache !! the last body, replaced if the case needs another
      type(result_t) :: result
      type(error_t), allocatable :: error
      logical :: is_done

      ! That friction does not hold a body follows from a solution alone.
      if (case%value('', 'outcome') == '"'//word_no_equilibrium//'"') then
         call solve_case(cache, case%solved, result, error)
      else
         call prepare_single_case(cache, case%solved, result, error)
      end if
      call verify_answer(case, cache, result, error, is_done)
      if (is_done) return
      if (cache%body%slides_far) call place_as_stated(case, cache%body, result)
      call verify_result(case, cache%body, result)
   end subroutine verify_case

   !> Puts contact points that slide far where the displacements in the grid have them.
   subroutine place_as_stated(case, body, result)
      type(verified_case_t), intent(inout) :: case !! the case; gains the fault of its grid
      type(body_t), intent(inout) :: body !! the body
      type(result_t), intent(inout) :: result !! the load case; gains gaps and anchors
      character(:), allocatable :: fault

      call restore_displacement(result, body, case%stem//'.vtu', fault)
      call case%fault('.vtu', fault)
      if (len(fault) == 0) call take_displacement(result%load_case, body, result%displacement)
   end subroutine place_as_stated

   !> Verifies the files of a case without a solution, and reports a deck that cannot be solved again.
   subroutine verify_answer(case, cache, result, error, is_done)
      type(verified_case_t), intent(inout) :: case !! the case; gains the faults of all files, and the verdict
      type(cache_t), intent(in) :: cache !! the body
      type(result_t), intent(in) :: result !! the load case, and why there is no solution if there is none
      type(error_t), allocatable, intent(in) :: error !! why the deck cannot be solved again, if it cannot
      logical, intent(out) :: is_done !! whether it is one of them

      is_done = allocated(error) .or. allocated(result%answer)
      if (allocated(error)) then
         call case%fault('.deck.nml', error%message)
      else if (is_done) then
         call check_texts(case, cache%body, result)
         case%is_certified = result%outcome == outcome_no_equilibrium
      end if
   end subroutine verify_answer

   !> Verifies the files of a load case, which may be a step of a history.
   subroutine verify_result(case, body, result)
      type(verified_case_t), intent(inout) :: case !! the case; gains the faults of all files, and the verdict
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the load case; gains what the files state, and what follows
      character(:), allocatable :: fault
      character(len(shear_names)), allocatable :: names(:)
      integer :: m

      call new_contact_solution(result%solution, body%zone%n_points, body%zone%n_tangents)
      names = shear_names(:body%zone%n_tangents)
      if (size(body%mesh%coordinates, 1) == 3) names = force_names
      call read_points(case%stem//'.contact.csv', body%zone%n_points, names, result%solution%force, &
         result%solution%status, fault)
      call case%fault('.contact.csv', fault)
      if (len(fault) > 0) return
      if (size(names) > body%zone%n_tangents) result%solution%force = along_frames(body, result%solution%force)
      call restore_displacement(result, body, case%stem//'.vtu', fault)
      call case%fault('.vtu', fault)
      if (len(fault) > 0) return
      ! The last step of a history that ended early has converged.
      call restore_outcome(case, result%solution)
      result%solution%is_converged = result%solution%is_converged .or. .not. result%is_complete
      result%condition = case%number('', 'condition')
      call evaluate(result, body)
      call add_result_warnings(result, body)
      if (len(case%value('', 'convergence')) > 0) then
         call restore_convergence(case, body, result, fault)
         call case%fault('.convergence.csv', fault)
      end if
      m = body%zone%n_points
      if (result%solution%is_converged .and. m > 0) then
         associate (load_case => result%load_case, solution => result%solution, certificate => result%certificate, &
            limit => certificate_limit(case%config%method%tolerance))
            call check_statuses(case%faults, case%stem//'.contact.csv', .true., state_of(load_case%free_gap &
               - solution%displacement(:m), body%zone%free_slips(solution%displacement(m + 1:) - load_case%anchor), &
               solution%force, solution%status), load_case%friction, load_case%slip_bound, &
               all(body%zone%is_fixed, dim=1), &
               law_scales_t(limit*certificate%length_scale, limit*certificate%force_scale))
         end associate
      end if
      call check_texts(case, body, result)
      call check_grids(case%faults, case%config%units, body, result, case%stem)
      case%is_certified = result%solution%is_converged .and. &
         max(result%certificate%largest(), result%earlier_violation) <= certificate_limit(case%config%method%tolerance)
   end subroutine verify_result

   !> Contact forces along normals and tangents, from the normal forces and the vectors of the forces on the body
   !> (n_rows) [F].
   pure function along_frames(body, stated) result(force)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: stated(:) !! normal forces, then each component of the vectors (any) [F]
      real(dp) :: force(body%zone%n_rows)
      integer :: p

      associate (m => body%zone%n_points)
         force(:m) = stated(:m)
         do p = 1, m
            force(m + p::m) = -matmul(stated(m + p::m), body%zone%frame(:, 2:, p))
         end do
      end associate
   end function along_frames

   !> Reads what only the run knew of how its method ended.
   subroutine restore_outcome(case, solution)
      type(verified_case_t), intent(inout) :: case !! the case; gains the fault
      type(contact_solution_t), intent(inout) :: solution !! the solution; gains its record
      character(:), allocatable :: list
      logical :: ok

      solution%is_converged = case%value('', 'converged') == 'true'
      solution%residual = case%number('', 'residual')
      list = case%value('', 'residual_history')
      call read_reals(replaced(list(2:len(list) - 1), ' ', ''), solution%history, ok)
      if (.not. ok) solution%history = spread(0.0_dp, 1, 0)
      solution%n_iterations = size(solution%history)
      if (nint(case%number('', 'iterations')) /= solution%n_iterations) call case%fault('.summary.json', &
         'iterations is '//case%value('', 'iterations')//', but residual_history has '// &
         to_text(solution%n_iterations)//' numbers')
   end subroutine restore_outcome

   !> Reads forces and statuses from a table of contact points.
   subroutine read_points(path, n_points, shears, force, status, fault)
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: n_points !! number of contact points
      character(*), intent(in) :: shears(:) !! names of the columns of the tangential forces, or forces, 1 to 3
      real(dp), allocatable, intent(out) :: force(:) !! normal forces, then tangential ones (any) [F]
      integer, allocatable, intent(out) :: status(:) !! the statuses (n_points)
      character(:), allocatable, intent(out) :: fault !! why it cannot be read; empty if it can
      type(csv_table_t) :: rows
      integer :: p, k, columns(0:1 + size(shears))

      allocate (force((1 + size(shears))*n_points), status(n_points))
      call read_csv_table(rows, path, fault=fault)
      if (len(fault) == 0 .and. rows%n_rows /= n_points) fault = to_text(rows%n_rows)//' rows, but there are '// &
         to_text(n_points)//' contact points'
      if (len(fault) > 0) return
      columns = [rows%column('status'), rows%column('normal_force'), (rows%column(trim(shears(k))), k=1, size(shears))]
      if (any(columns == 0)) fault = 'the first line is not the header of this table'
      do p = 1, n_points
         if (len(fault) > 0) return
         do k = 1, 1 + size(shears)
            call rows%get_number(p, columns(k), force((k - 1)*n_points + p), fault)
         end do
         ! Each status is one of the known names, those of the plane or those of space.
         status(p) = findloc(status_names == rows%field(p, columns(0)), .true., dim=1)
         if (status(p) > stick_point .and. (status(p) == slip_point .neqv. size(shears) > 1)) status(p) = 0
         if (status(p) == 0 .and. len(fault) == 0) fault = 'line '//to_text(p + 1)//": expected a status, found '"// &
            rows%field(p, columns(0))//"'"
      end do
   end subroutine read_points

   !> Reads the displacements of the nodes, and finds those of the contact points.
   subroutine restore_displacement(result, body, path, fault)
      type(result_t), intent(inout) :: result !! the load case; gains the displacements
      type(body_t), intent(in) :: body !! the body
      character(*), intent(in) :: path !! name of the grid of the body
      character(:), allocatable, intent(out) :: fault !! why they cannot be read; empty if they can
      integer, parameter :: n_space = 3
      real(dp), allocatable :: vectors(:)
      integer :: m

      allocate (vectors(n_space*body%mesh%n_nodes))
      call read_array(path, 'displacement', n_space, vectors, fault)
      if (len(fault) > 0) return
      result%displacement = reshape(vectors, [n_space, body%mesh%n_nodes])
      result%displacement = result%displacement(:1 + body%zone%n_tangents, :)
      m = body%zone%n_points
      result%solution%displacement = body%zone%rows%displacement(result%displacement)
      ! Displacements that supports prescribe are not among the unknowns of the contact problem.
      result%solution%displacement(:m) = result%solution%displacement(:m) + &
         (result%load_case%free_gap - result%load_case%gap)
   end subroutine restore_displacement

   !> Judges the convergence over refined meshes again. A case is solved again on the coarser ones; the numbers of a
   !> history on these are those of the table.
   subroutine restore_convergence(case, body, result, fault)
      type(verified_case_t), intent(in) :: case !! the case
      type(body_t), intent(in) :: body !! the body on the finest mesh
      type(result_t), intent(inout) :: result !! its result; gains the judgments
      character(:), allocatable, intent(out) :: fault !! why there are none; empty if there are
      type(csv_table_t) :: table
      type(quantity_t), allocatable :: list(:)
      type(config_t) :: coarse
      type(cache_t) :: cache
      type(result_t) :: other
      type(error_t), allocatable :: error
      real(dp), allocatable :: values(:, :)
      integer :: i, level, n_levels

      call read_csv_table(table, case%stem//'.convergence.csv', fault=fault)
      if (len(fault) > 0) return
      list = refined_quantities(result)
      n_levels = table%column('verdict') - 2
      if (table%n_rows /= size(list) .or. n_levels < 3) then
         fault = 'it is not a table of '//to_text(size(list))//' numbers on three meshes or more'
         return
      end if
      coarse = case%solved
      cache%is_refining = .true.
      allocate (values(size(list), n_levels))
      do level = 1, n_levels
         if (level < n_levels .and. .not. case%config%history%is_given) then
            coarse%meshes%n_refinements = max(0, case%config%meshes%n_refinements - n_levels + level)
            call solve_case(cache, coarse, other, error)
            if (allocated(error)) fault = error%message
            if (allocated(error)) return
            list = refined_quantities(other)
         else if (level == n_levels) then
            list = refined_quantities(result)
         end if
         do i = 1, size(list)
            call table%get_number(i, 1 + level, values(i, level), fault)
            ! The last digits of what is computed again may be others; differences of mesh to mesh magnify them.
            if (level < n_levels .and. case%config%history%is_given) cycle
            if (.not. agree(values(i, level), list(i)%value, max(abs(list(i)%value), list(i)%scale))) then
               values(i, level) = list(i)%value
            end if
         end do
      end do
      if (len(fault) == 0) call judge_meshes(result, body, values)
   end subroutine restore_convergence

   !> Makes the texts again and compares them.
   subroutine check_texts(case, body, result)
      type(verified_case_t), intent(inout) :: case !! the case; gains what does not agree
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result as it was restored
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary

      call new_summary(summary, case%config, body, result)
      call case_documents(documents, case%config, body, result)
      call case%compare(documents, summary)
   end subroutine check_texts

   !> Compares everything that two grids show: mesh, stresses, contact quantities.
   subroutine check_grids(faults, units, body, result, stem)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: units !! names of the units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result as it was restored
      character(*), intent(in) :: stem !! name of the grids without endings, with their directory
      type(vtk_check_t) :: check

      call new_vtk_check(check, stem//'.vtu', units)
      call show_body(check, body, result)
      call check%close()
      call faults%append(check%faults)
      call new_vtk_check(check, stem//'.contact.vtu', units)
      call show_contact_line(check, body, result)
      call check%close()
      call faults%append(check%faults)
   end subroutine check_grids

   !> Checks the statuses of a converged case with the contact law, point by point.
   subroutine check_statuses(faults, path, has_rows, points, friction, slip_bound, is_tangent_fixed, scales)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      character(*), intent(in) :: path !! name of the file
      logical, intent(in) :: has_rows !! whether it has a line for each point, behind one of names
      type(contact_state_t), intent(in) :: points !! gaps, slips, forces and statuses
      real(dp), intent(in) :: friction(:) !! Coulomb coefficients (m) [-]
      real(dp), intent(in) :: slip_bound(:) !! given bounds of the tangential force (m) [F]
      logical, intent(in) :: is_tangent_fixed(:) !! whether a support bears the shear (m)
      type(law_scales_t), intent(in) :: scales !! lengths and forces that count as zero
      character(:), allocatable :: place, wrong
      real(dp) :: bound, direction
      integer :: p

      do p = 1, size(points%status)
         associate (status => points%status(p), gap => points%gap(p), slip => points%slip(p), &
            normal => points%force(p), tangential => points%force(size(points%status) + p))
            bound = merge(0.0_dp, slip_bound(p) + friction(p)*max(0.0_dp, normal), is_tangent_fixed(p))
            ! A bound of 0 asks for no direction.
            direction = merge(0.0_dp, merge(1.0_dp, merge(-1.0_dp, 0.0_dp, status == slip_minus), &
               status == slip_plus .or. status == slip_point), bound <= scales%force)
            ! Conditions on the gap and the normal force come before those on the slip.
            wrong = ''
            if (abs(tangential) > bound + scales%force) wrong = 'the tangential force is above its bound'
            if (status == stick_point .and. abs(slip) > scales%length) wrong = 'it moves along the obstacle'
            if (direction*slip < -scales%length) wrong = 'it moves the other way'
            if (abs(direction) > 0.0_dp .and. direction*tangential < bound - scales%force) wrong = &
               'the tangential force is not at its bound'
            if (normal < -scales%force) wrong = 'the normal force pulls'
            if (gap < -scales%length) wrong = 'it is behind the obstacle'
            if (status == open_point .and. normal > scales%force) wrong = 'it bears a normal force'
            if (status /= open_point .and. gap > scales%length) wrong = 'there is a gap'
            if (len(wrong) == 0) cycle
            place = path
            if (has_rows) place = path//':'//to_text(p + 1)
            call faults%add(place, 'point '//to_text(p)//" is '"//trim(status_names(status))//"', but "//wrong)
         end associate
      end do
   end subroutine check_statuses

   !> Gaps, slips and forces for the check of the law: in space the lengths of tangential vectors, for a sliding point
   !> the slip along its force.
   pure function state_of(gap, slip, force, status) result(state)
      real(dp), intent(in) :: gap(:) !! distances to the obstacle (m) [L]
      real(dp), intent(in) :: slip(:) !! slips (n_tangents m) [L]
      real(dp), intent(in) :: force(:) !! forces (n) [F]
      integer, intent(in) :: status(:) !! statuses (m)
      type(contact_state_t) :: state

      state%gap = gap
      state%slip = slip
      state%force = force
      state%status = status
      associate (m => size(gap), tangential => force(size(gap) + 1:))
         if (size(slip) == m) return
         state%force = [force(:m), tangential_norm(tangential, m)]
         state%slip = merge((slip(:m)*tangential(:m) + slip(m + 1:)*tangential(m + 1:)) &
            /max(state%force(m + 1:), tiny(1.0_dp)), tangential_norm(slip, m), status == slip_point)
      end associate
   end function state_of

   !> Takes the statuses that a row states for those of the solution found again: of a point on a bound of the contact
   !> law rounding decides the status. Reports those that the law does not allow.
   subroutine follow_statuses(faults, solution, path, stated, body, loads, acting, scales)
      type(fault_list_t), intent(inout) :: faults !! gains what does not agree
      type(contact_solution_t), intent(inout) :: solution !! the solution; gains the statuses
      character(*), intent(in) :: path !! name of the file, with the line of the row
      integer, intent(in) :: stated(:) !! the statuses of the row (m)
      type(body_t), intent(in) :: body !! the body
      type(load_family_t), intent(in) :: loads !! loads and friction of the study
      class(acting_t), intent(in) :: acting !! what acts in the case or at the end of the step
      type(law_scales_t), intent(in) :: scales !! lengths and forces that count as zero
      integer :: m

      if (all(stated == solution%status)) return
      m = size(stated)
      call check_statuses(faults, path, .false., state_of(loads%gap_of(acting) - solution%displacement(:m), &
         body%zone%free_slips(solution%displacement(m + 1:) - acting%anchor), solution%force, stated), &
         loads%friction_of(acting), loads%base%slip_bound, all(body%zone%is_fixed, dim=1), scales)
      solution%status = stated
   end subroutine follow_statuses

   !> Lengths and forces that count as zero in a study: the limit of the certificate times its largest force, shared by
   !> the points, and the displacement that it causes.
   pure type(law_scales_t) function scales_of(tolerance, normal_force, stiffness) result(scales)
      real(dp), intent(in) :: tolerance !! tolerance of the method [-]
      real(dp), intent(in) :: normal_force !! largest sum of the normal forces [F]
      real(dp), intent(in) :: stiffness(:) !! stiffness of the points, normal and tangential (n_rows) [F/L]

      scales%force = certificate_limit(tolerance)*normal_force/max(1, size(stiffness))
      scales%length = certificate_limit(tolerance)*normal_force/max(sum(stiffness), tiny(1.0_dp))
   end function scales_of

   !> Checks the files of a reduced problem.
   subroutine verify_reduced(case)
      type(verified_case_t), intent(inout) :: case !! the case; gains the faults of all files, and the verdict
      type(reduced_result_t) :: result
      type(contact_state_t) :: points
      type(document_t), allocatable :: documents(:)
      type(document_t) :: summary
      type(error_t), allocatable :: error
      character(:), allocatable :: fault

      call prepare_reduced(case%config, result, error)
      if (allocated(error)) then
         call case%fault('.deck.nml', error%message)
         return
      end if
      associate (system => result%system, solution => result%solution, limit => certificate_limit( &
         case%config%method%tolerance))
         call new_contact_solution(solution, system%n_contacts, system%dimension - 1)
         call read_points(case%stem//'.contact.csv', system%n_contacts, shear_names(2*system%dimension - 3: &
            3*system%dimension - 5), solution%force, solution%status, fault)
         call case%fault('.contact.csv', fault)
         if (len(fault) > 0) return
         ! The tangential forces turn to the direction of the slip.
         solution%force(system%n_contacts + 1:) = -solution%force(system%n_contacts + 1:)
         call restore_outcome(case, solution)
         call system%set_solution(solution%force, 1.0_dp)
         call new_reduced_check(result%check, system)
         associate (m => system%n_contacts, v => system%by_component(system%u))
            points = state_of(-v(:m), v(m + 1:), solution%force, solution%status)
         end associate
         if (solution%is_converged .and. system%n_contacts > 0) call check_statuses(case%faults, &
            case%stem//'.contact.csv', .true., points, system%friction, spread(0.0_dp, 1, system%n_contacts), &
            spread(.false., 1, system%n_contacts), law_scales_t(limit*max(system%largest_part(system%u), &
            system%largest_part(system%q)), limit*system%largest_part(system%r)))
         call new_reduced_summary(summary, case%config, result)
         call reduced_documents(documents, case%config, result)
         call case%compare(documents, summary)
         case%is_certified = solution%is_converged .and. result%check%largest() <= limit
      end associate
   end subroutine verify_reduced

end module amontons_verify_case
