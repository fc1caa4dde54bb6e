!> NAME.lst: the listing, which is complete without the other files; and the sections that the listings of decks, sweeps
!> and reduced problems share: head, model, method and outcome, uniqueness and all solutions (with NAME.solutions.csv),
!> verdict, times.
! allow(S271): gfortran 12 fails on `amontons_report`, which uses this module, if the first of its modules is not first
module amontons_listing
   use amontons_rigid_motion, only: largest_motion, resting_motions
   use amontons_body, only: body_t, find_rigid_modes
   use amontons_case_label, only: case_label_t
   use amontons_certificate, only: certificate_t
   use amontons_contact_solution, only: contact_solution_t
   use amontons_contact_table, only: column_t, contact_columns, points_text
   use amontons_document, only: document_t
   use amontons_error, only: warning_list_t
   use amontons_friction_law, only: open_point, slip_minus, slip_plus, slip_point, status_names, stick_point
   use amontons_group_text, only: group_text
   use amontons_key_results, only: interval_t, resultants
   use amontons_kinds, only: dp
   use amontons_load_family, only: load_case_t
   use amontons_loads, only: load_on_motion
   use amontons_methods, only: method_options_t
   use amontons_model_warnings, only: facing_lengths
   use amontons_mortar_pair, only: mortar_pair_t
   use amontons_quantity, only: quantity_t, scales
   use amontons_result, only: certificate_limit, has_bar, refined_quantity_t, result_t, verdict_names
   use amontons_terminal, only: phase_assemble, phase_condense, phase_factorize, phase_names, phase_read, &
      phase_recover, phase_solve, timings_t
   use amontons_text, only: append_text, as_lines, comma_separated, counted, flush_right, heading, labeled, line_end, &
      newline, place_text, vector_text, scientific, short_text, to_text, unit_of, with_unit
   use amontons_uniqueness, only: all_solutions_t, uniqueness_t
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: add_outcome, certificate_text, closed_text, factorization_text, head_text, listed_phases, method_text, &
      model_text, new_listing, quantities_text, solutions_table_text, solutions_text, status_counts, times_text, &
      uniqueness_text, violations_text, warnings_text

   !> The phases that are complete when the listing of a deck is written.
   integer, parameter :: listed_phases(*) = [phase_read, phase_assemble, phase_factorize, phase_condense, phase_solve, &
      phase_recover]

contains

   !> The line of the listing on whether the solution is proven to be unique.
   pure function uniqueness_text(uniqueness, friction, freedom) result(text)
      type(uniqueness_t), intent(in) :: uniqueness !! the bound
      real(dp), intent(in) :: friction(:) !! Coulomb coefficients of the problem (m) [-]
      character(*), intent(in) :: freedom !! motion that nothing holds without friction; empty for none
      character(:), allocatable :: text
      character(:), allocatable :: known

      text = ''
      if (size(friction) == 0) return
      if (uniqueness%is_unique .and. .not. uniqueness%has_bound) then
         known = 'unique, since there is no Coulomb friction'
         if (freedom /= '') known = known//', but for a rigid motion: '//freedom//'; slips are counted without it'
      else if (.not. uniqueness%has_bound) then
         known = 'no bound is known'
      else if (uniqueness%is_for_any) then
         known = 'unique for any friction'
      else
         known = 'proven below '//short_text(uniqueness%friction)
         if (uniqueness%is_exact) known = known//', the exact bound'
         if (uniqueness%is_unique) known = 'unique (friction '//short_text(maxval(friction))//'; '//known//')'
      end if
      if (.not. uniqueness%is_unique) known = 'not proven (friction '//short_text(maxval(friction))//'; '//known//')'
      text = labeled('Uniqueness', known)
   end function uniqueness_text

   !> A rigid motion that leaves all closed points closed, as a text; empty if there is none.
   function free_motion(body, status) result(text)
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: status(:) !! status of each contact point (m)
      character(:), allocatable :: text
      real(dp), allocatable :: modes(:, :), amounts(:, :)
      integer :: i

      text = ''
      if (sum(body%motions%n_free) == 0) return
      call find_rigid_modes(modes, body%zone, body%motions, body%mesh%coordinates, is_mated=.true.)
      amounts = resting_motions(modes(pack([(i, i=1, size(status))], status /= open_point), :))
      if (size(amounts, 2) > 0) text = largest_motion(body%motions, amounts(:, 1))
   end function free_motion

   !> The section of the listing that `--all-solutions` adds.
   pure function solutions_text(solutions, force) result(text)
      type(all_solutions_t), intent(in) :: solutions !! all solutions
      real(dp), intent(in) :: force(:) !! forces of the solution that the listing reports (2m) [F]
      character(:), allocatable :: text, kind
      ! Rounding, and the tolerance of the method that found the reported one.
      real(dp), parameter :: same = 1.0e-6_dp
      integer :: i, m, p

      m = size(force)/2
      text = heading('All solutions')//labeled('Found', to_text(solutions%n))
      if (solutions%has_family) text = text//labeled('Note', 'some statuses admit a continuum of solutions, of '// &
         'which only the corners are found')
      do i = 1, solutions%n
         kind = trim(merge('isolated            ', 'between two statuses', solutions%is_isolated(i)))
         if (maxval(abs(solutions%force(:, i) - force)) <= same*maxval(abs(force))) kind = kind//'; the one reported'
         text = text//labeled('Solution '//to_text(i), kind)
         do p = 1, m
            text = text//labeled('', 'point '//to_text(p)//': '//trim(status_names(solutions%status(p, i)))// &
               ', forces '//short_text(solutions%force(p, i))//', '//short_text(solutions%force(m + p, i)))
         end do
      end do
   end function solutions_text

   !> NAME.solutions.csv: one row for each point of each solution.
   pure function solutions_table_text(solutions, gap) result(text)
      type(all_solutions_t), intent(in) :: solutions !! all solutions
      real(dp), intent(in) :: gap(:) !! initial distance to the obstacle along the normal (m) [L]
      character(:), allocatable :: text
      character(150) :: rows(size(gap), solutions%n)
      integer :: i, p, m

      m = size(gap)
      do i = 1, solutions%n
         associate (v => solutions%displacement(:, i), force => solutions%force(:, i))
            do p = 1, m
               rows(p, i) = to_text(i)//','//trim(merge('yes', 'no ', solutions%is_isolated(i)))//','//to_text(p) &
                  //','//comma_separated([gap(p) - v(p), v(m + p), force(p), force(m + p)]) &
                  //','//status_names(solutions%status(p, i))
            end do
         end associate
      end do
      text = 'solution,isolated,point,gap,slip,normal_force,tangential_force,status'//newline &
         //as_lines(reshape(rows, [size(rows)]))
   end function solutions_table_text

   !> Mesh, material, supports, contact sets and loads.
   function model_text(body, load_case, units) result(text)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its supports, obstacles and loads
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      real(dp), allocatable :: lengths(:), force(:)
      integer :: first, i, last, n_dim

      n_dim = size(body%mesh%coordinates, 1)
      ! Factors of sweeps and histories are listed in other sections.
      force = body%driven_forces(load_case%loads)
      text = heading('Model')
      if (allocated(body%mesh%source)) text = text//labeled('Mesh', body%mesh%source)
      text = text//labeled('Nodes, elements', to_text(body%mesh%n_nodes)//', '//to_text(body%mesh%n_elements))// &
         labeled('Unknowns', to_text(body%dof_map%n_dofs)//', of them '//to_text(body%dof_map%n_schur)// &
         ' on the contact '//trim(merge('line ', 'faces', allocated(body%zone%line))))
      do i = 1, size(body%materials%list)
         text = text//labeled('Material', group_text(body%materials%list(i), n_dim, units)// &
            trim(merge(', B-bar formulation', '                   ', body%materials%list(i)%is_b_bar)))
      end do
      do i = 1, size(load_case%supports)
         if (load_case%supports(i)%is_driven()) then
            text = text//labeled('Support', motion_text(body, load_case, i, force, units))
         else
            text = text//labeled('Support', group_text(load_case%supports(i), n_dim, units))
         end if
      end do
      do i = 1, size(load_case%contacts)
         text = text//labeled('Contact', group_text(load_case%contacts(i), n_dim, units))
         associate (surface => load_case%contacts(i)%obstacle%surface)
            if (load_case%contacts(i)%obstacle%kind == 'surface') text = text//labeled('Triangles', &
               to_text(size(surface%corner, 2))//trim(merge(', open  ', ', closed', surface%has_ends)))
         end associate
         if (load_case%contacts(i)%partition%is_constant) then
            lengths = pack(body%zone%weight, body%zone%set == i)
            text = text//labeled('Multipliers', 'constant on '//to_text(size(lengths))//' cells of length '// &
               short_text(minval(lengths))//' to '//with_unit(short_text(maxval(lengths)), units, 'L'))// &
               labeled('Inf-sup constant', short_text(body%inf_sup(i)))
         end if
         if (body%zone%pairs(i)%is_set()) then
            text = text//labeled('Sides', roles_text(body%zone%pairs(i), units))
         else if (body%zone%pairs(i)%is_alone) then
            text = text//labeled('Multipliers', 'mortar, at '//counted(count(body%zone%set == i), 'corner')//' of '// &
               counted(size(body%zone%pairs(i)%segments), 'face'))
         end if
      end do
      do i = 1, size(body%ties)
         text = text//labeled('Tie', body%ties(i)%label//' (slave/master)')// &
            labeled('Sides', roles_text(body%ties(i), units))
      end do
      do i = 1, size(body%turning)
         associate (piece => body%turning(i))
            if (piece%rigid > 0) then
               text = text//labeled('Turns far', "the body of '"//trim(body%driven(piece%driven(1))%name)//"'")
            else
               text = text//labeled('Turns far', 'the body around '//place_text(piece%point))
            end if
         end associate
      end do
      text = text//labeled('Contact points', to_text(body%zone%n_points))
      first = 1
      do while (first <= len(body%mesh_notes))
         last = line_end(body%mesh_notes, first)
         text = text//labeled('Note', body%mesh_notes(first:last))
         first = last + 2
      end do
      text = text//notes_text(body, load_case, units)
      do i = 1, size(load_case%loads)
         ! Loads on motions are listed with the motion.
         if (load_case%loads(i)%target == load_on_motion) cycle
         text = text//labeled('Load', group_text(load_case%loads(i), n_dim, units))
      end do
   end function model_text

   !> A rigid set or preload: its position, and the prescribed part of its motion or the force that drives it.
   pure function motion_text(body, load_case, number, force, units) result(text)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its supports and what drives them
      integer, intent(in) :: number !! number of the support that it is
      real(dp), intent(in) :: force(:) !! forces of the loads on the driven motions (motions) [F, F L]
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: k

      associate (support => load_case%supports(number))
         text = support%name//trim(merge(': preload at', ': rigid set ', support%is_jump))//" '"//support%set//"'"
         if (support%rigid%has_point) text = text//', about '// &
            with_unit(vector_text(support%rigid%point(:size(body%mesh%coordinates, 1))), units, 'L')
         do k = 1, size(body%driven)
            associate (driven => body%driven(k))
               if (driven%support /= number) cycle
               text = text//', '//trim(driven%words(1))
               if (support%is_held(driven%component)) then
                  text = text//' = '//with_unit(short_text(support%displacement(driven%component)), units, &
                     trim(driven%dimensions(1)))
               else if (abs(force(k)) > 0.0_dp) then
                  text = text//' under '//trim(driven%words(2))//' = '//with_unit(short_text(force(k)), units, &
                     trim(driven%dimensions(2)))
               else
                  text = text//' free'
               end if
            end associate
         end do
         if (support%lock_time < huge(1.0_dp)) text = text//', locked from time '//short_text(support%lock_time)
      end associate
   end function motion_text

   !> Mean lengths of the sides of slave and master where they meet, on which the choice of the roles should depend.
   pure function roles_text(pair, units) result(text)
      type(mortar_pair_t), intent(in) :: pair !! the pair
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      real(dp) :: lengths(2)

      lengths = facing_lengths(pair)
      text = 'slave '//with_unit(short_text(lengths(1)), units, 'L')//', master '// &
         with_unit(short_text(lengths(2)), units, 'L')// &
         ' on average; forces are resolved on the slave, which should be the finer one'
   end function roles_text

   !> Notes on the contact points: those that supports hold, overlap, free rigid motions.
   pure function notes_text(body, load_case, units) result(text)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: load_case !! its obstacles
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: i, n_free, p, k
      integer, allocatable :: held(:), joined(:)
      logical :: is_guided(body%zone%n_points), is_aslant(body%zone%n_points)
      character(4) :: noun

      text = ''
      associate (zone => body%zone)
         n_free = sum(body%motions%n_free)
         if (n_free == 1) then
            text = labeled('Note', '1 rigid-body mode is not constrained by supports; only contact holds it')
         else if (n_free > 1) then
            text = labeled('Note', to_text(n_free)// &
               ' rigid-body modes are not constrained by supports; only contact holds them')
         end if
         held = zone%held_node
         joined = [(body%ties(i)%joined_node, i=1, size(body%ties))]
         do i = size(zone%pairs), 1, -1
            if (.not. zone%pairs(i)%is_set()) cycle
            held = [held, zone%pairs(i)%held_node]
            joined = [zone%pairs(i)%joined_node, joined]
         end do
         ! Contact points whose tangential motion supports prevent or guide.
         is_guided = all(zone%is_fixed, dim=1)
         is_aslant = .false.
         do p = 1, zone%n_points
            if (is_guided(p)) is_aslant(p) = any([(body%constraints%leaves_free(zone%rows%node(k), &
               zone%frame(:size(zone%position, 1), 2, p)), k=zone%rows%start(p), zone%rows%start(p + 1) - 1)])
         end do
         is_guided = is_guided .and. .not. is_aslant
         noun = merge('cell', 'node', any(zone%is_cell))
         associate (x => body%mesh%coordinates)
            text = text//places_text(x(:, held), 'node', 'no contact point, held by supports', units)// &
               places_text(x(:, zone%zero_area_node), 'node', &
               'no contact point: at the axis there is no area that a pressure could act on', units)// &
               places_text(x(:, zone%shared_node), 'node', &
               'of two sets, with the law of a tie, or else of the contact set named first', units)// &
               places_text(x(:, joined), 'node', 'no contact point, of slave and master', units)
         end associate
         text = text//places_text(zone%position(:, pack([(p, p=1, zone%n_points)], is_aslant)), noun, &
            'slip without friction, guided by a support that is aslant to the obstacle', units)// &
            places_text(zone%position(:, pack([(p, p=1, zone%n_points)], is_guided)), noun, &
            'no slip, since a support bears the tangential force', units)
         if (zone%n_held_cells > 0) text = text//labeled('Note', 'not contact points, since supports hold '// &
            'their nodes: '//counted(zone%n_held_cells, 'cell')//' of constant multipliers')
         p = minloc(load_case%gap, dim=1)
         if (p == 0) return
         if (body%slides_far .or. .not. load_case%gap(p) < 0.0_dp) return
         text = text//labeled('Note', trim(merge('the bodies overlap            ', 'the body overlaps the obstacle', &
            zone%pairs(zone%set(p))%is_set()))//' by up to '//with_unit(short_text(-load_case%gap(p)), units, 'L')// &
            ' at the start')
      end associate
   end function notes_text

   !> Notes on the positions where a statement holds: one for each or, if there are many, one for all.
   pure function places_text(places, noun, statement, units) result(text)
      real(dp), intent(in) :: places(:, :) !! where they are (n_dim, n) [L]
      character(*), intent(in) :: noun !! noun for one of them
      character(*), intent(in) :: statement !! the statement
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: few = 3
      integer :: i

      text = ''
      if (size(places, 2) > few) then
         text = labeled('Note', counted(size(places, 2), noun)//', the first at '// &
            with_unit(vector_text(places(:, 1)), units, 'L')//': '//statement)
         return
      end if
      do i = 1, size(places, 2)
         text = text//labeled('Note', 'the '//noun//' at '//with_unit(vector_text(places(:, i)), units, 'L')//': '// &
            statement)
      end do
   end function places_text

   !> Makes the listing.
   subroutine new_listing(listing, label, body, result)
      type(document_t), intent(out) :: listing !! the listing
      class(case_label_t), intent(in) :: label !! name, title and units of the case
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! the result
      type(column_t), allocatable :: columns(:)
      character(:), allocatable :: text
      integer :: n

      listing%ending = '.lst'
      call listing%record(head_text(label))
      associate (solution => result%solution)
         if (.not. allocated(result%answer)) then
            n = size(result%key_results)
            if (allocated(result%certificate%named)) n = n - size(result%certificate%named)
            call listing%add(heading('Key results')//quantities_text(result%key_results(:n), label%units)// &
               counts_text(solution%status, 1 + body%zone%n_tangents), [spread(0.0_dp, 1, 3), &
               result%key_results(:n)%scale, 0.0_dp], is_by_line=.true.)
            if (n < size(result%key_results)) call listing%add(heading('Forces by name')// &
               quantities_text(result%key_results(n + 1:), label%units), [spread(0.0_dp, 1, 3), &
               result%key_results(n + 1:)%scale], is_by_line=.true.)
         end if
         call listing%add(warnings_text(result%warnings))
         call listing%add(model_text(body, result%load_case, label%units))
         if (allocated(result%answer)) call listing%add(heading('Solution')//'  '//result%answer//newline)
         if (allocated(result%answer)) return
         call contact_columns(columns, body, result)
         call listing%append(result%study_listing)
         call listing%add(heading('Solution')//labeled('Method', method_text(result%method)))
         text = labeled('Factorization', factorization_text(result))
         if (allocated(result%started_from)) text = text//labeled('Started from', 'case '//result%started_from)
         call listing%record(text)
         text = ''
         if (result%method_error >= 0.0_dp) text = labeled('Error of method', scientific(result%method_error)// &
            ' of the largest contact force, against the exact solution')
         call add_outcome(listing, solution, result%method%tolerance, text)
         text = uniqueness_text(result%uniqueness, merge(0.0_dp, result%load_case%friction, &
            all(body%zone%is_fixed, dim=1)), free_motion(body, solution%status))
         if (allocated(result%all_solutions)) text = text//solutions_text(result%all_solutions, solution%force)
         call listing%record(text)
         if (allocated(result%convergence)) call listing%add(convergence_text(result%convergence, label%units))
         if (body%zone%n_points > 0) call listing%add(heading(trim(merge('Contact faces', 'Contact line ', &
            result%lengths%are_areas)))//counts_text(solution%status, &
            1 + body%zone%n_tangents)//quantities_text(result%lengths%quantities(), label%units)// &
            intervals_text('Closed zone', result%closed, label%units)// &
            intervals_text('Stick zone', result%stuck, label%units), [max(0.0_dp, maxval(abs(body%zone%position)))])
         associate (certificate => result%certificate, n_dim => size(body%mesh%coordinates, 1))
            call listing%add(heading('Resultants')// &
               labeled('Loads', with_unit(vector_text(certificate%load(:n_dim)), label%units, 'F'))// &
               labeled('Support reactions', with_unit(vector_text(certificate%reaction(:n_dim)), label%units, 'F'))// &
               labeled('Contact forces', with_unit(vector_text(certificate%contact(:n_dim)), label%units, 'F'))// &
               quantities_text(resultants(solution%force, size(solution%status), result%lengths%are_areas), &
               label%units), [force_scale(result)])
            call listing%add(quantities_text(certificate%energies(), label%units), [certificate%strain_energy])
         end associate
         call listing%add(certificate_text(result%certificate, result%method%tolerance), [1.0_dp])
         if (allocated(result%error_estimate)) call listing%add( &
            heading('Accuracy (energy norm of the stress error)')// &
            quantities_text(result%error_estimate%quantities(), label%units), &
            [spread(0.0_dp, 1, 3), scales(result%error_estimate%quantities())], is_by_line=.true.)
         if (body%zone%n_points > 0) call listing%add(points_text('Contact points (normal: compression positive; '// &
            trim(merge('force: on the body)          ', 'tangential: positive along t)', result%lengths%are_areas)), &
            columns, solution%status, label%units), &
            [0.0_dp, pack(columns%scale, columns%label /= ''), 0.0_dp])
      end associate
      call listing%record(times_text(result%timings, listed_phases))
   end subroutine new_listing

   !> The contact points by status; empty if there are none.
   pure function counts_text(status, dimension) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      integer, intent(in) :: dimension !! components of their displacements, 2 or 3
      character(:), allocatable :: text

      text = ''
      if (size(status) > 0) text = labeled('Points', to_text(size(status))//': '//status_counts(status, dimension))
   end function counts_text

   !> The scale of sums of forces and of energies, for rounding to 0.
   pure real(dp) function force_scale(result) result(scale)
      type(result_t), intent(in) :: result !! the result

      scale = max(sum(abs(result%load_case%force)), sum(abs(result%solution%force)), result%certificate%strain_energy)
   end function force_scale

   !> The factorization in use, its size, and the case for which it was made.
   pure function factorization_text(result) result(text)
      type(result_t), intent(in) :: result !! the result
      character(:), allocatable :: text

      text = ''
      if (allocated(result%factor%name)) text = result%factor%name//', '//to_text(result%factor%n_entries)//' entries'
      if (allocated(result%shared_with)) text = text//', shared with case '//result%shared_with
   end function factorization_text

   !> Parts of the contact line, one line each.
   pure function intervals_text(label, intervals, units) result(text)
      character(*), intent(in) :: label !! their kind
      type(interval_t), intent(in) :: intervals(:) !! the parts
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(intervals)
         text = text//labeled(label, vector_text(intervals(i)%ends(:, 1))//' to '// &
            vector_text(intervals(i)%ends(:, 2))// &
            with_unit(', length '//short_text(intervals(i)%length), units, 'L'))
      end do
   end function intervals_text

   !> The verdict of the certificate in words, with its largest violation.
   pure function certificate_text(certificate, tolerance) result(text)
      type(certificate_t), intent(in) :: certificate !! the certificate
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]
      character(:), allocatable :: text

      text = heading('Checks on the full model (relative errors)') &
         //violations_text(certificate%violations(), certificate_limit(tolerance))
   end function certificate_text

   !> The head of the listing: program, case and deck.
   pure function head_text(label) result(text)
      class(case_label_t), intent(in) :: label !! name, title and units of the case
      character(:), allocatable :: text

      text = 'Amontons '//version//': contact with Coulomb friction by the dual method'//newline//newline// &
         labeled('Case', label%name)//labeled('Title', label%title)
      if (allocated(label%file)) text = text//labeled('Deck', label%file)
      if (len(label%units) > 0) text = text//labeled('Units', label%units)
   end function head_text

   !> The method with the options that it uses.
   pure function method_text(method) result(text)
      type(method_options_t), intent(in) :: method !! the method and its options
      character(:), allocatable :: text

      text = trim(method%method)
      select case (text)
      case ('splitting')
         text = text//', variant '//trim(method%variant)//', quadratic programs by '//trim(method%box)
      case ('fixed_point')
         text = text//', quadratic programs by '//trim(method%box)
      case ('psor')
         text = text//', omega '//short_text(method%omega)//', '//trim(method%space)//' space, local '// &
            trim(method%local)//', acceleration '//trim(method%acceleration)
      case default
         continue
      end select
   end function method_text

   !> Adds to a listing whether a method converged, a record of the run, and how the residual decreased.
   pure subroutine add_outcome(listing, solution, tolerance, recorded)
      type(document_t), intent(inout) :: listing !! the listing
      type(contact_solution_t), intent(in) :: solution !! the solution and its record
      real(dp), intent(in) :: tolerance !! tolerance of the contact method [-]
      character(*), intent(in) :: recorded !! what else only the run knew, whole lines or empty
      character(:), allocatable :: text
      integer, parameter :: n_lines = 20
      integer :: i, stride

      text = counted(solution%n_iterations, 'iteration')
      if (.not. solution%is_converged) text = text//'; the results below are not the solution'
      call listing%add(labeled('Converged', trim(merge('yes, in          ', 'NO: stopped after', &
         solution%is_converged))//' '//text))
      text = ''
      if (solution%is_at_rest) text = &
         labeled('Note', 'iteration stagnated at a wrong answer: the forces do not satisfy the contact law')
      call listing%record(text//recorded)
      text = labeled('Residual', scientific(solution%residual)//', tolerance '//scientific(tolerance))// &
         labeled('Residual history', 'iteration, residual')
      stride = max(1, solution%n_iterations/n_lines)
      do i = 1, solution%n_iterations
         if (i /= 1 .and. i /= solution%n_iterations .and. mod(i, stride) /= 0) cycle
         text = text//labeled('', flush_right(to_text(i), len('iteration'))//'  '//scientific(solution%history(i)))
      end do
      call listing%add(text)
   end subroutine add_outcome

   !> Number of contact points of each status, as text.
   pure function status_counts(status, dimension) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      integer, intent(in) :: dimension !! components of their displacements, 2 or 3
      character(:), allocatable :: text

      text = to_text(count(status == slip_plus))//' slip+, '//to_text(count(status == slip_minus))//' slip-'
      if (dimension == 3) text = to_text(count(status == slip_point))//' slip'
      text = to_text(count(status == open_point))//' open, '//text//', '//to_text(count(status == stick_point))// &
         ' stick'
   end function status_counts

   !> Number of closed contact points, as text.
   pure function closed_text(status) result(text)
      integer, intent(in) :: status(:) !! statuses of the points
      character(:), allocatable :: text

      text = to_text(count(status /= open_point))//' of '//to_text(size(status))//' points closed'
   end function closed_text

   !> The violations of a solution, one line each, and the verdict.
   pure function violations_text(violations, limit) result(text)
      type(quantity_t), intent(in) :: violations(:) !! the violations, each over its natural scale [-]
      real(dp), intent(in) :: limit !! the limit of all violations [-]
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(violations)
         text = text//labeled(violations(i)%label(:maxval(len_trim(violations%label))), &
            scientific(violations(i)%value)//trim(merge('        ', '  FAILED', violations(i)%value <= limit)))
      end do
      text = text//labeled('Verdict', trim(merge('passed', 'FAILED', all(violations%value <= limit)))// &
         ': every violation must be at most '//scientific(limit))
   end function violations_text

   !> The warnings of the listing, one line each.
   pure function warnings_text(warnings) result(text)
      type(warning_list_t), intent(in) :: warnings !! the warnings
      character(:), allocatable :: text
      integer :: i

      text = heading('Warnings')
      if (warnings%n() == 0) text = text//labeled('Warnings', 'none')
      do i = 1, warnings%n()
         text = text//labeled('Warning', warnings%item(i))
      end do
   end function warnings_text

   !> Lines of the listing with quantities, one each: name, value, unit.
   pure function quantities_text(quantities, units) result(text)
      type(quantity_t), intent(in) :: quantities(:) !! the quantities
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text, number
      integer :: i, length, width

      text = ''
      length = 0
      width = maxval(len_trim(quantities%label))
      do i = 1, size(quantities)
         associate (quantity => quantities(i))
            number = with_unit(short_text(quantity%value), units, trim(quantity%dimension))
            if (quantity%n_dim > 0) number = number//' at '//vector_text(quantity%place(:quantity%n_dim))
            call append_text(text, length, labeled(quantity%label(:width), number))
         end associate
      end do
      text = text(:length)
   end function quantities_text

   !> The times of the phases, and the end of the listing.
   pure function times_text(timings, phases) result(text)
      type(timings_t), intent(in) :: timings !! the times
      integer, intent(in) :: phases(:) !! the phases to be listed
      character(:), allocatable :: text
      character(10) :: seconds
      integer :: i

      text = heading('Time [s]')
      do i = 1, size(phases)
         write (seconds, '(f10.4)') timings%seconds(phases(i))
         text = text//labeled(trim(phase_names(phases(i))), seconds)
      end do
      text = text//newline//'End of listing'//newline
   end function times_text

   !> The section of the listing on refined meshes: how the numbers of a case change from mesh to mesh.
   pure function convergence_text(list, units) result(text)
      type(refined_quantity_t), intent(in) :: list(:) !! the numbers
      character(*), intent(in) :: units !! names of the units of the case
      character(:), allocatable :: text
      integer, parameter :: width = 13
      character(200 + len(units)) :: rows(0:size(list))
      character(8) :: order
      character(width) :: bar
      integer :: i, first

      first = 2 + max(20, maxval([(len_trim(list(i)%quantity%label), i=1, size(list))]))
      rows(0) = repeat(' ', first)//flush_right('finest mesh', width)//flush_right('+-', width)// &
         flush_right('extrapolated', width)//flush_right('order', 8)//'  from mesh to mesh'
      if (len_trim(units) > 0) rows(0) = trim(rows(0))//'  unit'
      do i = 1, size(list)
         associate (quantity => list(i)%quantity, judged => list(i)%convergence)
            rows(i) = quantity%label
            order = '-'
            if (judged%order > 0.0_dp) write (order, '(f8.2)') min(judged%order, 99.0_dp)
            bar = '-'
            if (has_bar(judged)) bar = scientific(judged%bar)
            rows(i)(first + 1:) = flush_right(short_text(quantity%value), width)//flush_right(trim(bar), width)// &
               flush_right(short_text(judged%extrapolated), width)//adjustr(order)//'  '// &
               verdict_names(judged%verdict)//repeat(' ', 8)//unit_of(units, trim(quantity%dimension))
         end associate
      end do
      text = heading('Refined meshes ('//to_text(size(list(1)%convergence%value))// &
         ', each of half the element size)')//as_lines(rows)
   end function convergence_text

end module amontons_listing
