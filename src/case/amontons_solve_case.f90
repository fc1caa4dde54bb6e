!> The way of a case from its configuration to its result. Cases that share a body share its factorisation.
module amontons_solve_case
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_assembly, only: from_unknowns, internal_forces, to_unknowns, uncancelled_forces
   use amontons_auto, only: auto_t
   use amontons_body, only: body_t, condense_body, new_body
   use amontons_certificate, only: new_certificate
   use amontons_config, only: config_t
   use amontons_contact_method, only: contact_method_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_contact_zone, only: contact_t, set_obstacles
   use amontons_effective_deck, only: body_text
   use amontons_equilibrium, only: check_balance
   use amontons_error, only: error_t, new_error, numerical_failure
   use amontons_kinds, only: dp
   use amontons_lengths, only: new_lengths
   use amontons_loads, only: load_vector
   use amontons_mesh, only: mesh_t
   use amontons_mesh_file, only: read_mesh_file
   use amontons_methods, only: new_contact_method
   use amontons_name_check, only: check_names
   use amontons_rectangle, only: new_rectangle_mesh
   use amontons_result, only: result_t
   use amontons_timings, only: new_timings, phase_condense, phase_recover, phase_solve, phase_write
   use amontons_uniqueness, only: new_uniqueness
   implicit none (type, external)
   private

   public :: certify, check_finite, condense_case, load_body, prepare_case, recover, solve_case, workshop_t

   !> The body at hand and what was last done with it: what one case of a run hands on to the next.
   type :: workshop_t
      type(body_t), allocatable :: body !! the body
      character(:), allocatable :: body_text !! the deck text that the body was made from
      character(:), allocatable :: first_case !! the case that the body was made for
      character(:), allocatable :: last_case !! the case solved last on this body; not allocated before the first
      logical :: is_condensed = .false. !! whether the body is factorised
      type(contact_solution_t) :: last_solution !! its solution, the start of the next case
   end type workshop_t

contains

   !> Makes the body, the obstacles and the loads of a case ready, everything that its deck can get wrong.
   subroutine prepare_case(workshop, config, result, error)
      type(workshop_t), intent(inout) :: workshop !! the body at hand, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! gains the loads
      type(error_t), allocatable, intent(out) :: error !! mesh, sets, supports, contacts or loads are at fault
      type(contact_t), allocatable :: contacts(:)

      call new_timings(result%timings)
      if (has_body(workshop, config)) then
         call check_names(config, workshop%body%mesh, error)
      else
         call make_body(workshop, config, error)
      end if
      if (allocated(error)) return
      associate (body => workshop%body)
         ! No case of a sweep may have a negative friction.
         contacts = config%contacts
         call config%sweep%lower_friction(contacts)
         call set_obstacles(body%zone, body%mesh, contacts, error)
         if (allocated(error)) return
         call load_vector(result%loads, body%mesh, body%materials, config%loads, error)
         if (allocated(error)) return
         ! Loads and friction that a sweep varies need not balance as they stand.
         if (.not. config%sweep%is_given()) call check_balance(body%motions, body%mesh, body%zone, result%loads, error)
      end associate
   end subroutine prepare_case

   !> Makes the body of a case.
   subroutine make_body(workshop, config, error)
      type(workshop_t), intent(inout) :: workshop !! gains the body
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(out) :: error !! mesh, sets, supports or contacts are at fault
      type(mesh_t) :: mesh
      character(:), allocatable :: notes

      if (allocated(workshop%body)) deallocate (workshop%body)
      ! A body that cannot be made must not pass for the one before it.
      workshop%body_text = ''
      workshop%is_condensed = .false.
      allocate (workshop%body)
      call new_mesh(mesh, notes, config, error)
      if (.not. allocated(error)) call check_names(config, mesh, error)
      if (allocated(error)) return
      call new_body(workshop%body, mesh, config%materials, config%supports, config%contacts, error)
      if (allocated(error)) return
      workshop%body%mesh_notes = notes
      workshop%body_text = body_text(config)
      workshop%first_case = config%name
      if (allocated(workshop%last_case)) deallocate (workshop%last_case)
   end subroutine make_body

   !> Makes or reads the mesh of a case.
   subroutine new_mesh(mesh, notes, config, error)
      type(mesh_t), intent(out) :: mesh !! the mesh
      character(:), allocatable, intent(out) :: notes !! what was put right in a file, a line of text for each
      type(config_t), intent(in) :: config !! the case
      type(error_t), allocatable, intent(out) :: error !! the file or the rectangle is at fault

      notes = ''
      if (len(config%mesh_file) > 0) then
         call read_mesh_file(mesh, config%mesh_file, notes, error)
      else
         call new_rectangle_mesh(mesh, config%rectangle, error)
      end if
      if (allocated(error)) error%message = config%mesh_origin//error%message
   end subroutine new_mesh

   !> Whether the body at hand is that of a case.
   pure logical function has_body(workshop, config)
      type(workshop_t), intent(in) :: workshop !! the body at hand
      type(config_t), intent(in) :: config !! the case

      has_body = allocated(workshop%body) .and. allocated(workshop%body_text)
      if (has_body) has_body = workshop%body_text == body_text(config)
   end function has_body

   !> Solves a case. The cases of a sweep are solved by `solve_sweep`.
   subroutine solve_case(workshop, config, result, error)
      type(workshop_t), intent(inout) :: workshop !! the body at hand, replaced if the case needs another
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(out) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the deck or the numbers are at fault
      class(contact_method_t), allocatable :: method

      call prepare_case(workshop, config, result, error)
      if (allocated(error)) return
      call new_contact_method(method, config%method, error)
      if (allocated(error)) return
      call condense_case(workshop, config, result, error)
      if (allocated(error)) return
      associate (body => workshop%body, solution => result%solution)
         call load_body(body, result%loads)

         call result%timings%begin(phase_solve)
         call start_solution(workshop, result)
         call method%solve(body%problem, solution, error)
         if (allocated(error)) return
         call check_finite(solution, error)
         if (allocated(error)) return
         if (solution%is_at_rest) call compare_with_exact(body, config, result, error)
         if (allocated(error)) return

         call result%timings%begin(phase_recover)
         call certify(body, result, error)
         if (allocated(error)) return
         call new_uniqueness(result%uniqueness, body%problem)
         ! What the caller does with the result is to write it.
         call result%timings%begin(phase_write)
      end associate
      if (.not. result%solution%is_converged) return
      workshop%last_case = config%name
      workshop%last_solution = result%solution
   end subroutine solve_case

   !> Factorises and condenses the body, unless an earlier case has done so.
   subroutine condense_case(workshop, config, result, error)
      type(workshop_t), intent(inout) :: workshop !! the body at hand
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(inout) :: result !! gains the times, and the case whose factorisation it shares
      type(error_t), allocatable, intent(out) :: error !! the body is not held, or its stiffness is degenerate

      if (workshop%is_condensed) then
         result%shared_with = workshop%first_case
         call result%timings%begin(phase_condense)
      else
         call condense_body(workshop%body, config%factorization, config%condensation, result%timings, error)
         workshop%is_condensed = .not. allocated(error)
      end if
   end subroutine condense_case

   !> Condenses the loads, prescribed displacements included, and hands gap and friction to the contact problem.
   subroutine load_body(body, loads)
      type(body_t), intent(inout) :: body !! the body
      real(dp), intent(in) :: loads(:, :) !! nodal forces of the loads (2, n_nodes) [F]
      real(dp), allocatable :: forces(:, :), prescribed(:), from_slip(:)
      real(dp) :: slip(body%zone%n_points)

      if (any(abs(body%constraints%prescribed) > 0.0_dp)) then
         call internal_forces(forces, body%mesh, body%materials, body%springs, body%coloring, &
            body%constraints%prescribed)
         forces = loads - forces
      else
         forces = loads
      end if
      call body%condensation%condense_load(to_unknowns(forces, body%constraints, body%dof_map), body%problem%load)
      body%problem%prescribed = maxval(abs(body%constraints%prescribed))
      ! The contact problem counts normal displacements from the prescribed ones; slips are whole, since friction is
      ! against all of a slip: what is prescribed of them, as at one node of a cell, becomes a load.
      allocate (prescribed, source=body%zone%rows%displacement(body%constraints%prescribed))
      body%problem%gap = body%zone%gap - prescribed(:body%zone%n_points)
      slip = prescribed_slip(body)
      if (any(abs(slip) > 0.0_dp)) then
         allocate (from_slip(2*size(slip)))
         call body%problem%multiply_stiffness([0.0_dp*slip, slip], from_slip)
         body%problem%load = body%problem%load + from_slip
      end if
      body%problem%friction = merge(0.0_dp, body%zone%friction, body%zone%is_guided)
      body%problem%slip_bound = merge(0.0_dp, body%zone%slip_bound, body%zone%is_guided)
   end subroutine load_body

   !> The part of every slip that supports prescribe; 0 for a guided point, whose slip the contact problem does not know
   !> (m) [L].
   pure function prescribed_slip(body) result(slip)
      type(body_t), intent(in) :: body !! the body
      real(dp) :: slip(body%zone%n_points), prescribed(2*body%zone%n_points)

      prescribed = body%zone%rows%displacement(body%constraints%prescribed)
      slip = merge(0.0_dp, prescribed(body%zone%n_points + 1:), body%zone%is_guided)
   end function prescribed_slip

   !> Starts from the last solution of the same body, or from rest.
   subroutine start_solution(workshop, result)
      type(workshop_t), intent(in) :: workshop !! the body at hand and its last solution
      type(result_t), intent(inout) :: result !! the result, its solution set to the start

      if (allocated(workshop%last_case)) then
         result%solution = workshop%last_solution
         result%started_from = workshop%last_case
      else
         call new_contact_solution(result%solution, workshop%body%zone%n_points)
      end if
   end subroutine start_solution

   !> Refuses a solution whose numbers have left the finite range.
   pure subroutine check_finite(solution, error)
      type(contact_solution_t), intent(in) :: solution !! the solution
      type(error_t), allocatable, intent(out) :: error !! it is not finite

      ! A residual still at its first value, the largest number, means that no iteration gave a finite one.
      if (solution%residual < huge(solution%residual) .and. all(ieee_is_finite(solution%force)) &
         .and. all(ieee_is_finite(solution%displacement))) return
      call new_error(error, numerical_failure, 'the contact method left the range of finite numbers: '// &
         'stiffness, load and friction differ by more than the arithmetic can hold')
   end subroutine check_finite

   !> Computes the displacements of all nodes, the certificate and the lengths, and refuses numbers that are not finite.
   subroutine certify(body, result, error)
      type(body_t), intent(in) :: body !! the body, loaded
      type(result_t), intent(inout) :: result !! the result, its contact problem solved
      type(error_t), allocatable, intent(out) :: error !! the results left the range of numbers
      ! A condition number that leaves more than half of the digits explains nothing.
      real(dp), parameter :: explaining = 1.0e8_dp
      real(dp) :: condition

      call recover(body, result)
      call new_certificate(result%certificate, body, result%loads, result%displacement, result%solution%force)
      call new_lengths(result%lengths, body%zone, result%solution%status)
      if (.not. (all(ieee_is_finite(result%displacement)) .and. result%certificate%is_finite())) then
         call new_error(error, numerical_failure, 'displacements, forces or energies leave the range of double '// &
            'precision (1.8e308): choose other units')
         return
      end if
      if (.not. shows_rounding(result)) return
      condition = max(body%condensation%factorization%condition(), cancellation(body, result))
      if (condition > explaining) result%condition = min(condition, huge(1.0_dp))
   end subroutine certify

   !> How far the forces of the elements cancel, |K| |u| / |f|: of a body that its supports hold still, a bound from
   !> below of the condition number. It sees what the shift in the factor of a body held by contact alone hides.
   real(dp) function cancellation(body, result)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(in) :: result !! its displacements and forces
      real(dp) :: forces

      cancellation = 0.0_dp
      ! Prescribed displacements are loads that no force tells.
      if (any(abs(body%constraints%prescribed) > 0.0_dp)) return
      forces = max(norm2(result%loads), norm2(result%solution%force))
      if (forces > 0.0_dp) cancellation = uncancelled_forces(body%mesh, body%materials, result%displacement)/forces
   end function cancellation

   !> Whether what the certificate finds may come from the rounding errors of an ill-conditioned stiffness: of what
   !> depends on the whole model, something is well above rounding.
   pure logical function shows_rounding(result)
      type(result_t), intent(in) :: result !! the result
      real(dp), parameter :: suspicious = 1.0e-9_dp

      associate (certificate => result%certificate)
         shows_rounding = max(certificate%equilibrium, certificate%resultant, certificate%moment, &
            certificate%energy) > suspicious
      end associate
   end function shows_rounding

   !> Measures the forces of a method that came to rest against the exact ones.
   subroutine compare_with_exact(body, config, result, error)
      type(body_t), intent(inout) :: body !! the body, loaded
      type(config_t), intent(in) :: config !! the case
      type(result_t), intent(inout) :: result !! the result, gains the error of the method
      type(error_t), allocatable, intent(out) :: error !! the exact solution cannot be computed
      type(contact_solution_t) :: exact
      type(auto_t) :: method

      method%tolerance = config%method%tolerance
      call new_contact_solution(exact, body%zone%n_points)
      call method%solve(body%problem, exact, error)
      if (allocated(error) .or. .not. exact%is_converged) return
      result%method_error = maxval(abs(result%solution%force - exact%force))/max(maxval(abs(exact%force)), tiny(1.0_dp))
   end subroutine compare_with_exact

   !> Computes the displacements of all nodes from those of the contact points.
   subroutine recover(body, result)
      type(body_t), intent(in) :: body !! the body
      type(result_t), intent(inout) :: result !! the result, gains the displacement
      real(dp), allocatable :: unknowns(:), displacement(:)

      displacement = result%solution%displacement
      displacement(body%zone%n_points + 1:) = displacement(body%zone%n_points + 1:) - prescribed_slip(body)
      call body%condensation%recover(displacement, unknowns)
      result%displacement = from_unknowns(unknowns, body%constraints, body%dof_map)
   end subroutine recover

end module amontons_solve_case
