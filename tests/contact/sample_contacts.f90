!> Contact sets in one line each, and bodies made ready to be solved.
module sample_contacts
   use amontons_auto, only: auto_t
   use amontons_body, only: body_t, condense_body, new_body
   use amontons_condensation, only: condensation_options_t
   use amontons_constraints, only: support_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_set, only: contact_t
   use amontons_contact_solution, only: contact_solution_t, new_contact_solution
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_family, only: acting_t, load_case_t, load_family_t, new_load_case, new_load_family, one_part, &
      recover_displacement
   use amontons_loads, only: load_t
   use amontons_mesh, only: mesh_t
   use amontons_methods, only: solve_components
   use amontons_terminal, only: new_timings, timings_t
   use sample_bodies, only: sample_material
   implicit none (type, external)
   private

   public :: contact_on_floor, contact_on_set, pose_load_case, ready_body, solve_loaded_body

contains

   !> A contact set that faces the floor y = 0.
   pure function contact_on_floor(set, friction) result(contact)
      character(*), intent(in) :: set !! name of the set
      real(dp), intent(in) :: friction !! Coulomb coefficient
      type(contact_t) :: contact

      contact = contact_on_set(set, friction, [0.0_dp, 0.0_dp], [0.0_dp, 1.0_dp])
   end function contact_on_floor

   !> A contact set that faces a plane.
   pure function contact_on_set(set, friction, point, normal) result(contact)
      character(*), intent(in) :: set !! name of the set
      real(dp), intent(in) :: friction !! Coulomb coefficient
      real(dp), intent(in) :: point(2) !! a point of the plane [L]
      real(dp), intent(in) :: normal(2) !! its normal, towards the body
      type(contact_t) :: contact

      contact%set = set
      contact%friction%value = friction
      contact%obstacle%kind = 'plane'
      contact%obstacle%point(:2) = point
      contact%obstacle%normal(:2) = normal
      contact%origin = 'deck.nml:12: '
   end function contact_on_set

   !> Makes a body of the sample material in plane strain with a load case without loads, factorizes and condenses it.
   subroutine ready_body(body, problem, load_case, mesh, supports, contacts, error)
      type(body_t), intent(out) :: body !! the body
      type(contact_problem_t), intent(out) :: problem !! its contact problem
      type(load_case_t), intent(out) :: load_case !! the load case
      type(mesh_t), intent(in) :: mesh !! its mesh
      type(support_t), intent(in) :: supports(:) !! its supports
      type(contact_t), intent(in) :: contacts(:) !! its contact sets
      type(error_t), allocatable, intent(out) :: error !! whatever failed
      type(load_t) :: no_loads(0)
      type(timings_t) :: timings

      call new_timings(timings)
      call new_body(body, mesh, [sample_material('plane strain')], supports, contacts, error)
      if (allocated(error)) return
      call new_load_case(load_case, body, supports, contacts, no_loads, error)
      if (allocated(error)) return
      call condense_body(body, problem, condensation_options_t(), timings, error)
   end subroutine ready_body

   !> Sets a contact problem to a load case of a ready body.
   subroutine pose_load_case(problem, body, load_case, error)
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(inout) :: load_case !! the load case; gains its condensed load
      type(error_t), allocatable, intent(out) :: error !! whatever failed
      type(load_family_t) :: loads
      type(acting_t) :: acting

      call new_load_family(loads, body, load_case, one_part(load_case), error)
      if (allocated(error)) return
      call loads%condense(body, problem)
      call loads%at_rest(acting)
      call loads%pose(body, acting, problem)
      load_case%condensed = loads%parts(1)%condensed
   end subroutine pose_load_case

   !> Solves a load case of a ready body.
   subroutine solve_loaded_body(body, problem, load_case, displacement, solution, error)
      type(body_t), intent(in) :: body !! the body
      type(contact_problem_t), intent(inout) :: problem !! its contact problem
      type(load_case_t), intent(inout) :: load_case !! the load case
      real(dp), allocatable, intent(out) :: displacement(:, :) !! displacement of the nodes (2, n_nodes) [L]
      type(contact_solution_t), intent(out) :: solution !! solution of the contact problem
      type(error_t), allocatable, intent(out) :: error !! whatever failed
      type(auto_t) :: method

      call pose_load_case(problem, body, load_case, error)
      if (allocated(error)) return
      call new_contact_solution(solution, body%zone%n_points, 1)
      method%tolerance = 1.0e-12_dp
      call solve_components(method, problem, solution, error)
      if (allocated(error)) return
      call recover_displacement(displacement, body, load_case, solution%displacement, solution%force)
   end subroutine solve_loaded_body

end module sample_contacts
