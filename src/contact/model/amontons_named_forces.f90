!> Forces by name: the force that each contact set, support, elastic foundation and tie exerts on the body, by
!> components.
!>
!> Listing, summary, tables of sweeps and histories use the same definition: a component is the work on a rigid motion
!> of the nodes in question, of the reactions on a field of displacements, and of contact forces and springs on vectors
!> of their own. So it follows from displacements and contact forces of all nodes or, without the displacements of the
!> nodes, from the factors of the parts of a family and the contact displacements (section 10 of doc/theory.md).
module amontons_named_forces
   use amontons_assembly, only: spring_forces
   use amontons_body, only: body_t
   use amontons_equilibrium, only: recover_with_travel
   use amontons_frame, only: turned
   use amontons_kinds, only: dp
   use amontons_load_family, only: condensed_force, load_case_t, recover_displacement
   use amontons_mortar_pair, only: integrate_pair, mortar_points_t
   use amontons_named_set, only: named_forces_t, of_contact, of_support, of_tie
   use amontons_pose, only: pose_t
   use amontons_quantity, only: quantity_t
   implicit none (type, external)
   private

   public :: contact_values, find_responses, force_form_t, force_test_t, force_values, named_quantities, named_tests, &
      new_force_form, set_named_values, set_posed_values

   !> Components of a force: along the normal and the tangent of a contact line, along x, y and z, the moment about the
   !> origin, counter-clockwise, that about the axis of a twisted body, and those about the origin in space. A contact
   !> face has no tangent of its own.
   integer, parameter :: normal = 1, tangential = 2, along_x = 3, along_y = 4, along_z = 5, moment = 6, torque = 7, &
      moment_x = 8, moment_z = 10
   !> Their names in files.
   character(10), parameter :: component_names(*) = [character(10) :: 'normal', 'tangential', 'x', 'y', 'z', 'moment', &
      'torque', 'moment_x', 'moment_y', 'moment_z']
   !> Names of the kinds in files, in the order of `of_contact`, `of_support`, `of_tie`.
   character(8), parameter :: kind_names(*) = [character(8) :: 'force', 'reaction', 'tie']

   !> The coefficients of a force in reactions, displacements and contact forces; those that are not allocated are 0.
   type :: force_test_t
      real(dp), allocatable :: held(:, :)
         !! displacements that the reactions of the nodes do work on (components, n_nodes) [L]
      real(dp), allocatable :: pulled(:, :)
         !! forces that do work on the displacements of the nodes (components, n_nodes) [F]
      real(dp), allocatable :: contact(:) !! factors of (lambda_N; lambda_T) (n_rows)
      integer :: driven = 0 !! the driven motion whose given force counts, too; 0 for none
   end type force_test_t

   !> Named forces as functions of the factors of the parts of a family, contact displacements and contact forces.
   type :: force_form_t
      real(dp), allocatable, private :: of_part(:, :)
         !! contribution of each part with contact displacements 0 (any, parts)
      real(dp), allocatable, private :: of_displacement(:, :) !! factors of the contact displacements (n_rows, any)
      real(dp), allocatable, private :: of_contact(:, :) !! factors of the contact forces (n_rows, any)
   contains
      procedure :: values => force_form_values
   end type force_form_t

contains

   !> The components of all forces by name: number in `body%named`, and component (2, any). In a body of revolution
   !> there are no forces across the axis and no moments. The normal force of a preload is the force of its jump.
   pure function components_of(body) result(list)
      type(body_t), intent(in) :: body !! the body
      integer, allocatable :: list(:, :)
      integer :: component, i
      logical :: is_cut, in_space

      in_space = size(body%mesh%coordinates, 1) == 3
      allocate (list(2, 0))
      do i = 1, size(body%named)
         is_cut = body%named(i)%kind == of_tie
         if (is_cut) is_cut = body%ties(body%named(i)%member(1))%lead > 0
         do component = normal, moment_z
            if (in_space .and. any(component == [tangential, moment, torque])) cycle
            if (.not. in_space .and. (component == along_z .or. component >= moment_x)) cycle
            if (body%named(i)%kind /= of_contact .and. component <= merge(normal, tangential, is_cut)) cycle
            if (is_cut .and. .not. in_space .and. any(component == [along_x, along_y])) cycle
            if (body%is_axisymmetric .and. (any(component == [along_x, moment]) .or. is_cut .and. component &
               == tangential)) cycle
            if (component == torque .and. .not. body%materials%is_twisted()) cycle
            list = reshape([list, i, component], [2, size(list, 2) + 1])
         end do
      end do
   end function components_of

   !> Forces by name as quantities of value 0, in the order of `named_tests`; then the driven motions and their forces.
   !> The scale of each is that of its errors where those of forces are 1.
   pure function named_quantities(body) result(list)
      type(body_t), intent(in) :: body !! the body
      type(quantity_t), allocatable :: list(:)
      integer, allocatable :: components(:, :)
      integer :: i, j, k

      components = components_of(body)
      allocate (list(size(components, 2) + 2*size(body%driven)))
      do k = 1, size(components, 2)
         associate (named => body%named(components(1, k)), component => components(2, k))
            list(k)%key = trim(kind_names(named%kind))//'_'//trim(component_names(component))//'_'//named%name
            list(k)%label = list(k)%key
            list(k)%label(:1) = achar(iachar(list(k)%key(:1)) - iachar('a') + iachar('A'))
            list(k)%label(len_trim(kind_names(named%kind)) + 1:) = ' '//trim(component_names(component))//' '// &
               named%name
            list(k)%scale = 1.0_dp
            list(k)%dimension = 'F'
            if (component >= moment) then
               list(k)%scale = maxval(abs(body%mesh%coordinates))
               list(k)%dimension = 'F L'
            end if
         end associate
      end do
      do i = 1, size(body%driven)
         do j = 1, 2
            associate (quantity => list(size(components, 2) + 2*(i - 1) + j), driven => body%driven(i))
               quantity%key = trim(driven%kind)//'_'//trim(driven%name)//'_'//driven%words(j)
               quantity%label = trim(driven%name)//' '//driven%words(j)
               quantity%dimension = driven%dimensions(j)
               quantity%scale = driven%length
            end associate
         end do
      end do
   end function named_quantities

   !> Sets the values of forces by name and of driven motions, with the scales of their errors.
   pure subroutine set_named_values(list, body, values, force, displacement)
      type(quantity_t), intent(inout) :: list(:) !! the quantities, from `named_quantities`
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: values(:) !! the values
      real(dp), intent(in) :: force !! scale of the errors of forces [F]
      real(dp), intent(in) :: displacement !! scale of the errors of displacements [L]

      list%value = values
      list%scale = force*list%scale
      associate (first => size(list) - 2*size(body%driven) + 1, length => body%driven%length)
         list(first::2)%scale = max(displacement, maxval(abs(values(first::2))*length))/length
      end associate
   end subroutine set_named_values

   !> The coefficients of all forces by name.
   pure function named_tests(body) result(tests)
      type(body_t), intent(in) :: body !! the body
      type(force_test_t), allocatable :: tests(:)
      integer, allocatable :: components(:, :)
      integer :: k

      components = components_of(body)
      allocate (tests(size(components, 2) + 2*size(body%driven)))
      do k = 1, size(tests)
         call new_test(tests(k), body, components, k)
      end do
   end function named_tests

   !> Finds the coefficients of one of the named numbers.
   pure subroutine new_test(test, body, components, number)
      type(force_test_t), intent(out) :: test !! its coefficients
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: components(:, :) !! components of the forces by name, from `components_of`
      integer, intent(in) :: number !! index of the number, in the order of `named_quantities`
      integer :: of_motion

      of_motion = number - size(components, 2)
      if (of_motion <= 0) then
         call new_named_test(test, body, body%named(components(1, number)), components(2, number))
         return
      end if
      associate (driven => body%driven((of_motion + 1)/2))
         if (modulo(of_motion, 2) == 1) then
            allocate (test%pulled(size(body%constraints%is_free, 1), body%mesh%n_nodes), source=0.0_dp)
            test%pulled(:, driven%node) = driven%force
         else
            test%driven = of_motion/2
            test%held = body%driven_field(test%driven)
         end if
      end associate
   end subroutine new_test

   !> Finds the coefficients of a component of a force by name.
   pure subroutine new_named_test(test, body, named, component)
      type(force_test_t), intent(out) :: test !! its coefficients
      type(body_t), intent(in) :: body !! the body
      type(named_forces_t), intent(in) :: named !! the contact sets, supports or ties that exert the force
      integer, intent(in) :: component !! the component
      type(mortar_points_t) :: points
      real(dp), allocatable :: motion(:, :)
      real(dp) :: middle(size(body%mesh%coordinates, 1)), jump(size(body%constraints%is_free, 1))
      logical, allocatable :: is_meant(:)
      integer :: i, p

      motion = rigid_motion(component, body%mesh%coordinates, size(body%constraints%is_free, 1))
      if (named%kind == of_contact) then
         test%contact = contact_factors(body, named%member, component, motion)
         return
      end if
      if (named%kind == of_support) then
         motion = body%constraints%supported_part(named%member, motion)
         test%held = body%dof_map%substitution%displacement(motion)
         ! The motion of rigid sets is that of their nodes already.
         do i = 1, size(body%constraints%rigid)
            test%held(:, body%constraints%rigid(i)%node) = motion(:, body%constraints%rigid(i)%node)
         end do
         is_meant = [(any(named%member == body%springs(i)%support), i=1, size(body%springs))]
         if (any(is_meant)) test%pulled = -spring_forces(body%mesh%n_nodes, pack(body%springs, is_meant), &
            rigid_motion(component, body%mesh%coordinates, size(motion, 1)))
      else
         test%held = 0.0_dp*motion
         do i = 1, size(named%member)
            associate (tie => body%ties(named%member(i)))
               call integrate_pair(points, tie, tie%segments, is_again=.false.)
               ! Of a preload the shear along the cut, and the moment about its middle.
               middle = merge(1.0_dp, 0.0_dp, tie%lead > 0 .and. component /= torque)* &
                  matmul(points%center, points%area)/sum(points%area)
               motion(:, tie%node) = rigid_motion(component, points%center - spread(middle, 2, size(tie%node)), &
                  size(motion, 1))
               jump = tie%jump(:size(jump))
               if (tie%lead > 0 .and. component <= along_z) motion = motion - spread(jump, 2, size(motion, 2)) &
                  *spread(matmul(jump, motion), 1, size(jump))
               if (component == tangential) motion = spread(turned(jump(:2)), 2, size(motion, 2))
               do p = 1, size(tie%node)
                  test%held(:, tie%node(p)) = matmul(body%constraints%free_projector(tie%node(p)), &
                     motion(:, tie%node(p)))
                  ! The jump moves all corners.
                  if (tie%lead > 0 .and. tie%node(p) /= tie%lead) test%held(:, tie%node(p)) = &
                     test%held(:, tie%node(p)) - dot_product(motion(:, tie%lead), jump)*jump
               end do
            end associate
         end do
         test%held = body%dof_map%substitution%displacement(test%held)
      end if
   end subroutine new_named_test

   !> The rigid motion on which the work is a component of the force (components, nodes).
   pure function rigid_motion(component, positions, n_components) result(motion)
      integer, intent(in) :: component !! the component
      real(dp), intent(in) :: positions(:, :) !! where (n_dim, any) [L]
      integer, intent(in) :: n_components !! number of components of a displacement
      real(dp) :: motion(n_components, size(positions, 2))
      integer :: next, last

      motion = 0.0_dp
      select case (component)
      case (along_x:along_z)
         motion(1 + component - along_x, :) = 1.0_dp
      case (torque)
         motion(3, :) = positions(1, :)
      case (moment)
         motion(1, :) = -positions(2, :)
         motion(2, :) = positions(1, :)
      case (moment_x:moment_z)
         next = 1 + modulo(component - moment_x + 1, 3)
         last = 1 + modulo(next, 3)
         motion(next, :) = -positions(last, :)
         motion(last, :) = positions(next, :)
      case default
         ! Sums of normal and tangential forces are no work on a motion.
      end select
   end function rigid_motion

   !> Coefficients of the contact forces in a component of the force that some contact sets exert on the body, for pairs
   !> on the slave.
   pure function contact_factors(body, sets, component, motion) result(factors)
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: sets(:) !! numbers of the sets
      integer, intent(in) :: component !! the component
      real(dp), intent(in) :: motion(:, :) !! the motion that it does work on (components, n_nodes)
      real(dp), allocatable :: factors(:)
      real(dp) :: at_points(size(motion, 1), body%zone%n_points)
      integer :: m, p

      m = body%zone%n_points
      factors = -body%zone%rows%displacement(motion)
      at_points = rigid_motion(component, body%zone%acting, size(motion, 1))
      do p = 1, m
         if (component <= tangential) then
            factors(p::m) = 0.0_dp
            factors(p + merge(0, m, component == normal)) = 1.0_dp
         else if (body%zone%pairs(body%zone%set(p))%is_set()) then
            factors(p::m) = -matmul(at_points(:, p), body%zone%frame(:, :, p))
         end if
         if (all(sets /= body%zone%set(p))) factors(p::m) = 0.0_dp
      end do
   end function contact_factors

   !> The parts of contact sets in all forces by name, from the contact forces at the present places of the points.
   pure function contact_values(body, force) result(values)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), allocatable :: values(:)
      type(force_test_t) :: test
      integer, allocatable :: components(:, :)
      integer :: k

      components = components_of(body)
      allocate (values(size(components, 2) + 2*size(body%driven)), source=0.0_dp)
      do k = 1, size(components, 2)
         if (body%named(components(1, k))%kind /= of_contact) cycle
         call new_test(test, body, components, k)
         values(k) = dot_product(test%contact, force)
      end do
   end function contact_values

   !> The values of all forces by name, in the order of their names.
   pure function force_values(body, reaction, displacement, force, driven) result(values)
      type(body_t), intent(in) :: body !! the body
      real(dp), intent(in) :: reaction(:, :) !! forces on the nodes besides loads and contact (components, n_nodes) [F]
      real(dp), intent(in) :: displacement(:, :) !! displacements of the nodes (components, n_nodes) [L]
      real(dp), intent(in) :: force(:) !! contact forces (lambda_N; lambda_T) (n_rows) [F]
      real(dp), intent(in) :: driven(:) !! forces that loads give the driven motions (motions) [F, F L]
      real(dp), allocatable :: values(:)
      type(force_test_t) :: test
      integer, allocatable :: components(:, :)
      integer :: k

      components = components_of(body)
      allocate (values(size(components, 2) + 2*size(body%driven)), source=0.0_dp)
      do k = 1, size(values)
         call new_test(test, body, components, k)
         if (test%driven > 0) values(k) = driven(test%driven)
         if (allocated(test%held)) values(k) = values(k) + sum(test%held*reaction)
         if (allocated(test%pulled)) values(k) = values(k) + sum(test%pulled*displacement)
         if (allocated(test%contact)) values(k) = values(k) + dot_product(test%contact, force)
      end do
   end function force_values

   !> Replaces the motions and forces of rigid sets whose pieces turn far, and the reactions of their supports, whose
   !> moment is about the origin.
   pure subroutine set_posed_values(values, body, poses, driven, thrust)
      real(dp), intent(inout) :: values(:) !! the values of all forces by name, in the order of their names
      type(body_t), intent(in) :: body !! the body
      type(pose_t), intent(in) :: poses(:) !! the poses of the pieces that turn
      real(dp), intent(in) :: driven(:) !! forces that loads give the driven motions (motions) [F, F L]
      real(dp), intent(in) :: thrust(:, :)
         !! force, and moment about its point, of each rigid set on its piece (3, pieces) [F], [F L]
      integer, allocatable :: components(:, :)
      real(dp) :: reaction(3)
      integer :: i, k

      components = components_of(body)
      do k = 1, count(body%turning%rigid > 0)
         associate (piece => body%turning(k))
            do i = 1, 3
               values(size(components, 2) + 2*piece%driven(i) - 1) = merge(poses(k)%turn, poses(k)%shift(i), i == 3)
               values(size(components, 2) + 2*piece%driven(i)) = thrust(i, k)
            end do
            reaction = thrust(:, k) - driven(piece%driven)
            reaction(3) = reaction(3) + dot_product(turned(piece%point + poses(k)%shift(:2)), reaction(:2))
            do i = 1, size(components, 2)
               associate (named => body%named(components(1, i)), component => components(2, i))
                  if (named%kind /= of_support) cycle
                  if (any(named%member /= body%driven(piece%driven(1))%support)) cycle
                  values(i) = reaction(merge(3, component - along_x + 1, component == moment))
               end associate
            end do
         end associate
      end do
   end subroutine set_posed_values

   !> Computes the displacements of the nodes under each part of a family, contact displacements held, and the nodal
   !> forces of each part; of temperatures those that cause the same strain.
   subroutine find_responses(fields, loads, body, parts)
      real(dp), allocatable, intent(out) :: fields(:, :, :)
         !! displacements of the nodes (components, n_nodes, parts) [L]
      real(dp), allocatable, intent(out) :: loads(:, :, :) !! nodal forces (components, n_nodes, parts) [F]
      type(body_t), intent(in) :: body !! the body, condensed
      type(load_case_t), intent(in) :: parts(:) !! the parts, condensed
      real(dp), allocatable :: field(:, :), at_rest(:)
      integer :: i

      associate (n_components => size(body%constraints%is_free, 1))
         allocate (fields(n_components, body%mesh%n_nodes, size(parts)), loads(n_components, body%mesh%n_nodes, &
            size(parts)))
      end associate
      do i = 1, size(parts)
         at_rest = 0.0_dp*parts(i)%condensed%load
         if (allocated(body%condensation%softness)) then
            ! Springs between points and body hold it where forces are not those of equilibrium: no refinement.
            call recover_displacement(field, body, parts(i), at_rest, at_rest)
         else
            call recover_with_travel(field, body, parts(i), at_rest, parts(i)%condensed%load)
         end if
         fields(:, :, i) = field
         loads(:, :, i) = parts(i)%force
         if (.not. allocated(parts(i)%element_load)) cycle
         call body%internal_forces(field, 0.0_dp*parts(i)%prescribed, parts(i)%element_load)
         loads(:, :, i) = loads(:, :, i) - field
      end do
   end subroutine find_responses

   !> Computes the coefficients of named forces over the parts, contact displacements and contact forces. The work of
   !> reactions r = K u - f - contact on displacements g is a product of g with K u_j - f_j for each part, and with K
   !> times the extension E v, condensed.
   subroutine new_force_form(form, body, tests, parts, fields, loads)
      type(force_form_t), intent(out) :: form !! the form
      type(body_t), intent(in) :: body !! the body, condensed
      type(force_test_t), intent(in) :: tests(:) !! coefficients of the numbers
      type(load_case_t), intent(in) :: parts(:) !! the parts
      real(dp), intent(in) :: fields(:, :, :) !! displacements under each part, from `find_responses` [L]
      real(dp), intent(in) :: loads(:, :, :) !! nodal forces of each part [F]
      real(dp), allocatable :: forces(:, :)
      integer :: i, j

      allocate (form%of_part(size(tests), size(fields, 3)), form%of_displacement(body%retained%n_rows, size(tests)), &
         form%of_contact(body%retained%n_rows, size(tests)), source=0.0_dp)
      do i = 1, size(tests)
         associate (test => tests(i))
            ! Where points slide far their forces are no fixed sums of those on the retained points: `contact_values`.
            if (allocated(test%contact) .and. .not. body%slides_far) form%of_contact(:, i) = test%contact
            if (.not. (allocated(test%held) .or. allocated(test%pulled))) cycle
            forces = 0.0_dp*fields(:, :, 1)
            if (allocated(test%held)) then
               call body%internal_forces(forces, test%held)
               do j = 1, size(fields, 3)
                  form%of_part(i, j) = -sum(test%held*loads(:, :, j))
                  if (test%driven > 0) form%of_part(i, j) = form%of_part(i, j) + parts(j)%driven(test%driven)
               end do
               form%of_contact(:, i) = form%of_contact(:, i) + body%retained%rows%displacement(test%held)
            end if
            if (allocated(test%pulled)) forces = forces + test%pulled
            do j = 1, size(fields, 3)
               form%of_part(i, j) = form%of_part(i, j) + sum(forces*fields(:, :, j))
            end do
            form%of_displacement(:, i) = condensed_force(body, forces)
            if (allocated(body%condensation%softness)) form%of_contact(:, i) = form%of_contact(:, i) &
               - body%condensation%softness*form%of_displacement(:, i)
         end associate
      end do
   end subroutine new_force_form

   !> The values of the forces of a member.
   pure function force_form_values(self, factor, v, force) result(values)
      class(force_form_t), intent(in) :: self !! the form
      real(dp), intent(in) :: factor(:) !! factors of the parts [-]
      real(dp), intent(in) :: v(:) !! contact displacements (n_rows) [L]
      real(dp), intent(in) :: force(:) !! contact forces (n_rows) [F]
      real(dp), allocatable :: values(:)

      values = matmul(self%of_part, factor) + matmul(v, self%of_displacement) + matmul(force, self%of_contact)
   end function force_form_values

end module amontons_named_forces
