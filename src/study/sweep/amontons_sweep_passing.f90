!> What ranks pass to each other of a sweep: to all ranks what its cases need, from each the chunks that it solved.
!>
!> Of the body the cases need the contact points, the nodes that loads act on and the rigid motions; mesh and factor
!> stay where they are.
module amontons_sweep_passing
   use amontons_body, only: body_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_contact_zone, only: contact_zone_t
   use amontons_distributed, only: all_ranks, line_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_methods, only: method_options_t
   use amontons_rigid_motion, only: rigid_motions_t
   use amontons_sweep, only: sweep_t
   use amontons_sweep_chunk, only: chunk_t, set_method, sweep_task_t
   use amontons_sweep_model, only: sweep_model_t
   implicit none (type, external)
   private

   public :: pass_chunk, receive_sweep, send_sweep

contains

   !> Sends a sweep from rank 0 to all others.
   subroutine send_sweep(task, body)
      type(sweep_task_t), intent(inout) :: task !! the sweep; unchanged
      type(body_t), intent(in) :: body !! the body
      integer, allocatable :: nodes(:)
      type(body_t) :: part

      call find_nodes(nodes, task%model, body)
      call take_part(part, body, nodes)
      call pass_sweep(line_t(all_ranks, .true.), task, part, nodes)
   end subroutine send_sweep

   !> Receives a sweep.
   subroutine receive_sweep(task, part)
      type(sweep_task_t), intent(out) :: task !! the sweep
      type(body_t), intent(out) :: part !! what its cases need of the body
      integer, allocatable :: nodes(:)

      call pass_sweep(line_t(all_ranks, .false.), task, part, nodes)
   end subroutine receive_sweep

   !> Passes a sweep.
   subroutine pass_sweep(line, task, part, nodes)
      type(line_t), intent(in) :: line !! the line
      type(sweep_task_t), intent(inout) :: task !! the sweep
      type(body_t), intent(inout) :: part !! what the cases need of the body
      integer, allocatable, intent(in) :: nodes(:) !! its nodes in the body; of the sender

      call pass_cases(line, task%sweep)
      call pass_method(line, task)
      call line%pass(task%n_quantities)
      call pass_problem(line, task%model%problem)
      call pass_model(line, task%model, nodes, size(task%sweep%axes))
      call pass_part(line, part)
   end subroutine pass_sweep

   !> Finds the nodes that loads act on or that contact points are made of.
   pure subroutine find_nodes(nodes, model, body)
      integer, allocatable, intent(out) :: nodes(:) !! the nodes, ascending
      type(sweep_model_t), intent(in) :: model !! the contact problems of the sweep
      type(body_t), intent(in) :: body !! the body
      logical, allocatable :: is_needed(:)
      integer :: i

      is_needed = any(abs(model%fixed%force) > 0.0_dp, dim=1)
      do i = 1, size(model%parts)
         if (allocated(model%parts(i)%force)) is_needed = is_needed .or. &
            any(abs(model%parts(i)%force) > 0.0_dp, dim=1)
      end do
      is_needed(body%zone%rows%node) = .true.
      nodes = pack([(i, i=1, body%mesh%n_nodes)], is_needed)
   end subroutine find_nodes

   !> Takes what the cases need of a body, its nodes numbered anew.
   subroutine take_part(part, body, nodes)
      type(body_t), intent(out) :: part !! the part
      type(body_t), intent(in) :: body !! the body
      integer, intent(in) :: nodes(:) !! the nodes that are needed
      integer, allocatable :: number(:)
      integer :: i

      allocate (number(body%mesh%n_nodes), source=0)
      number(nodes) = [(i, i=1, size(nodes))]
      part%zone = body%zone
      part%zone%rows%node = number(body%zone%rows%node)
      part%mesh%n_nodes = size(nodes)
      part%mesh%coordinates = body%mesh%coordinates(:, nodes)
      part%mesh%element_kind = pack([(i, i=1, maxval(body%mesh%element_kind))], &
         [(any(body%mesh%element_kind == i), i=1, maxval(body%mesh%element_kind))])
      part%materials = body%materials
      part%is_axisymmetric = body%is_axisymmetric
      part%rigid_modes = body%rigid_modes
      part%motions = body%motions
      do i = 1, size(part%motions)
         associate (motion => part%motions(i))
            motion%node = pack(number(motion%node), number(motion%node) > 0)
         end associate
      end do
   end subroutine take_part

   !> Passes the values of the quantities.
   subroutine pass_cases(line, sweep)
      type(line_t), intent(in) :: line !! the line
      type(sweep_t), intent(inout) :: sweep !! the cases
      logical, allocatable :: is_paired(:)
      integer :: i

      if (line%is_sender) is_paired = sweep%axes%is_paired
      call line%pass(is_paired)
      if (.not. line%is_sender) then
         allocate (sweep%axes(size(is_paired)))
         sweep%axes%is_paired = is_paired
      end if
      do i = 1, size(sweep%axes)
         call line%pass(sweep%axes(i)%values)
      end do
   end subroutine pass_cases

   !> Passes the choice of a method.
   subroutine pass_method(line, task)
      type(line_t), intent(in) :: line !! the line
      type(sweep_task_t), intent(inout) :: task !! the sweep; the receiver's gains the method
      integer, allocatable :: words(:)
      type(error_t), allocatable :: error

      if (line%is_sender) words = transfer(task%options, [0])
      call line%pass(words)
      if (line%is_sender) return
      ! The sender has made this method already.
      call set_method(task, transfer(words, method_options_t()), error)
   end subroutine pass_method

   !> Passes a contact problem, its compliance prepared.
   subroutine pass_problem(line, problem)
      type(line_t), intent(in) :: line !! the line
      type(contact_problem_t), intent(inout) :: problem !! the problem

      call line%pass(problem%n_points)
      call line%pass(problem%is_held)
      call line%pass(problem%prescribed)
      call line%pass(problem%proximal_parameter)
      call line%pass(problem%stiffness)
      if (.not. allocated(problem%compliance)) allocate (problem%compliance)
      call line%pass(problem%compliance%n)
      call line%pass(problem%compliance%values)
      call line%pass(problem%load)
      call line%pass(problem%gap)
      call line%pass(problem%anchor)
      call line%pass(problem%friction)
      call line%pass(problem%slip_bound)
   end subroutine pass_problem

   !> Passes the effects of the quantities.
   subroutine pass_model(line, model, nodes, n_axes)
      type(line_t), intent(in) :: line !! the line
      type(sweep_model_t), intent(inout) :: model !! the model
      integer, allocatable, intent(in) :: nodes(:) !! the nodes whose forces are passed; of the sender
      integer, intent(in) :: n_axes !! number of quantities
      integer :: k

      call line%pass(model%load)
      call line%pass(model%expansion)
      call line%pass(model%friction)
      call line%pass(model%is_tangent_fixed)
      call line%pass(model%axis)
      call line%pass(model%size_of_body)
      call line%pass(model%fixed%friction)
      call line%pass(model%fixed%slip_bound)
      call line%pass(model%fixed%is_in_reach)
      call pass_forces(line, model%fixed%force, nodes)
      if (.not. line%is_sender) allocate (model%parts(n_axes))
      do k = 1, n_axes
         call pass_forces(line, model%parts(k)%force, nodes)
      end do
   end subroutine pass_model

   !> Passes nodal forces, if there are any.
   subroutine pass_forces(line, force, nodes)
      type(line_t), intent(in) :: line !! the line
      real(dp), allocatable, intent(inout) :: force(:, :) !! the forces (2, nodes) [F]
      integer, allocatable, intent(in) :: nodes(:) !! the nodes whose forces are passed; of the sender
      real(dp), allocatable :: part(:, :)
      logical :: is_there

      is_there = allocated(force)
      call line%pass(is_there)
      if (.not. is_there) return
      if (line%is_sender) part = force(:, nodes)
      call line%pass(part)
      if (.not. line%is_sender) call move_alloc(part, force)
   end subroutine pass_forces

   !> Passes what the cases need of a body.
   subroutine pass_part(line, part)
      type(line_t), intent(in) :: line !! the line
      type(body_t), intent(inout) :: part !! the part
      real(dp), allocatable :: young(:)
      integer :: n_motions, i

      call pass_zone(line, part%zone)
      call line%pass(part%mesh%n_nodes)
      call line%pass(part%mesh%coordinates)
      call line%pass(part%mesh%element_kind)
      call line%pass(part%rigid_modes)
      call line%pass(part%is_axisymmetric)
      if (line%is_sender) young = part%materials%list%young
      call line%pass(young)
      if (line%is_sender) n_motions = size(part%motions)
      call line%pass(n_motions)
      if (.not. line%is_sender) then
         allocate (part%materials%list(size(young)), part%motions(n_motions))
         part%materials%list%young = young
      end if
      do i = 1, n_motions
         call pass_motions(line, part%motions(i))
      end do
   end subroutine pass_part

   !> Passes contact points: where they are and what they are made of. Gaps and friction are measured already, and no
   !> set is paired.
   subroutine pass_zone(line, zone)
      type(line_t), intent(in) :: line !! the line
      type(contact_zone_t), intent(inout) :: zone !! the contact points
      integer :: n_sets

      if (line%is_sender) n_sets = size(zone%pairs)
      call line%pass(n_sets)
      if (.not. line%is_sender) allocate (zone%pairs(n_sets))
      call line%pass(zone%n_points)
      call line%pass(zone%is_cell)
      call line%pass(zone%rows%start)
      call line%pass(zone%rows%node)
      call line%pass(zone%rows%part)
      call line%pass(zone%position)
      call line%pass(zone%set)
      call line%pass(zone%next)
      call line%pass(zone%normal)
      call line%pass(zone%weight)
      call line%pass(zone%area)
      call line%pass(zone%is_tangent_fixed)
   end subroutine pass_zone

   !> Passes the free rigid motions of a piece.
   subroutine pass_motions(line, motions)
      type(line_t), intent(in) :: line !! the line
      type(rigid_motions_t), intent(inout) :: motions !! the motions

      call line%pass(motions%n_free)
      call line%pass(motions%mode)
      call line%pass(motions%center(1))
      call line%pass(motions%center(2))
      call line%pass(motions%radius)
      call line%pass(motions%node)
   end subroutine pass_motions

   !> Passes the rows of a chunk, and what is kept of its cases.
   subroutine pass_chunk(line, chunk)
      type(line_t), intent(in) :: line !! the line
      type(chunk_t), intent(inout) :: chunk !! the chunk, solved; of the receiver, not yet
      integer, allocatable :: whole(:, :)
      real(dp), allocatable :: numbers(:, :)
      integer :: i, n

      n = chunk%last - chunk%first + 1
      if (line%is_sender) then
         allocate (whole(3 + size(chunk%results(1)%is_warned), n), numbers(2 + size(chunk%results(1)%quantity), n))
         do i = 1, n
            associate (kept => chunk%results(i))
               whole(:, i) = [kept%outcome, merge(1, 0, kept%has_solution), kept%n_iterations, &
                  merge(1, 0, kept%is_warned)]
               numbers(:, i) = [kept%residual, kept%error_estimate, kept%quantity]
            end associate
         end do
      end if
      call line%pass(chunk%rows)
      call line%pass(whole)
      call line%pass(numbers)
      if (line%is_sender) return
      do i = 1, n
         associate (kept => chunk%results(i))
            kept%outcome = whole(1, i)
            kept%has_solution = whole(2, i) > 0
            kept%n_iterations = whole(3, i)
            kept%is_warned = whole(4:, i) > 0
            kept%residual = numbers(1, i)
            kept%error_estimate = numbers(2, i)
            kept%quantity = numbers(3:, i)
         end associate
      end do
      chunk%is_done = .true.
   end subroutine pass_chunk

end module amontons_sweep_passing
