!> The contact problem of every case of a sweep: load and friction are sums over the quantities, value times effect.
!>
!> The condensed load is linear in the loads, q = q_0 + sum f_k q_k, so that one forward substitution for each quantity
!> serves all cases; friction is linear in what a sweep varies of it as well.
module amontons_sweep_model
   use amontons_body, only: body_t
   use amontons_checksum, only: checksum_t
   use amontons_condensation, only: condensed_load_t
   use amontons_config, only: config_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_case, only: condense_load_case, free_expansion, load_case_t, pose_problem
   use amontons_loads, only: load_t, load_vector, sum_thermal_strain
   use amontons_model_warnings, only: body_size
   use amontons_sweep, only: sweep_axis_t, swept_friction, swept_load
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: new_sweep_loads, sweep_model_t

   !> What all cases share, and the effect of each quantity.
   type :: sweep_model_t
      type(contact_problem_t) :: problem !! with load and friction of what does not vary, its compliance prepared
      real(dp), allocatable :: load(:, :) !! condensed load of each quantity at 1 (2m, quantities) [F]
      real(dp), allocatable :: expansion(:) !! free thermal expansion by each quantity at 1 (quantities) [L]
      real(dp), allocatable :: friction(:, :) !! friction of each quantity at 1 (m, quantities) [-]
      logical, allocatable :: is_tangent_fixed(:) !! whether a support bears the shear of a point (m)
      type(load_case_t) :: fixed !! the load case of what does not vary
      real(dp) :: size_of_body = 0.0_dp !! the larger side of the box around the mesh [L]
      integer, allocatable :: axis(:) !! the quantity that multiplies each load of the deck, 0 for none (loads)
      type(load_case_t), allocatable :: parts(:)
         !! what each quantity adds to it at 1: forces and thermal strain, of loads only (quantities)
   contains
      procedure :: condense => sweep_model_condense
      procedure :: largest_force => sweep_model_largest_force
      procedure :: load_case => sweep_model_load_case
      procedure :: prepare => sweep_model_prepare
      procedure :: fingerprint => sweep_model_fingerprint
      procedure :: set_case => sweep_model_set_case
      procedure :: sum_thermal_strain => sweep_model_sum_thermal_strain
   end type sweep_model_t

contains

   !> Separates loads and friction that vary from what does not, which takes no condensed body; the contact problems
   !> stay undefined.
   subroutine new_sweep_loads(model, body, prepared, config, error)
      type(sweep_model_t), intent(out) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: prepared !! the load case of the deck as it stands
      type(config_t), intent(in) :: config !! the deck
      type(error_t), allocatable, intent(out) :: error !! a load does not fit the mesh
      integer :: k, n

      n = size(config%sweep%axes)
      allocate (model%friction(body%zone%n_points, n), source=0.0_dp)
      allocate (model%parts(n))
      model%fixed = prepared
      model%size_of_body = body_size(body)
      model%axis = [(axis_of(config%loads(k), config%sweep%axes), k=1, size(config%loads))]
      call sum_loads(model%fixed, body, config, 0, error)
      if (allocated(error)) return
      model%is_tangent_fixed = body%zone%is_tangent_fixed
      do k = 1, n
         if (config%sweep%axes(k)%target == swept_load) then
            model%parts(k)%prescribed = 0.0_dp*prepared%prescribed
            call sum_loads(model%parts(k), body, config, k, error)
            if (allocated(error)) return
         else
            call separate_friction(model, body, config, k)
         end if
      end do
   end subroutine new_sweep_loads

   !> Condenses the loads and makes the contact problem of what does not vary. Where a body is spread over ranks, all
   !> that share the sweep do so at the same time.
   subroutine sweep_model_prepare(self, body, problem, error)
      class(sweep_model_t), intent(inout) :: self !! the model, from `new_sweep_loads`
      type(body_t), intent(in) :: body !! the body, condensed
      type(contact_problem_t), intent(in) :: problem !! its contact problem
      type(error_t), allocatable, intent(out) :: error !! S is not positive definite
      integer :: k

      call condense_load_case(self%fixed, body)
      self%problem = problem
      call pose_problem(self%problem, body, self%fixed)
      allocate (self%load(2*body%zone%n_points, size(self%parts)), self%expansion(size(self%parts)), source=0.0_dp)
      do k = 1, size(self%parts)
         if (.not. allocated(self%parts(k)%force)) cycle
         call condense_load_case(self%parts(k), body)
         self%load(:, k) = self%parts(k)%condensed%load
         self%expansion(k) = free_expansion(self%parts(k), body%mesh)
      end do
   end subroutine sweep_model_prepare

   !> Sums nodal forces and thermal strains of all loads that a quantity multiplies, or of those that none does.
   subroutine sum_loads(load_case, body, config, axis, error)
      type(load_case_t), intent(inout) :: load_case !! the load case; gains forces and thermal strain
      type(body_t), intent(in) :: body !! the body
      type(config_t), intent(in) :: config !! the deck
      integer, intent(in) :: axis !! number of the quantity, or 0
      type(error_t), allocatable, intent(out) :: error !! a load does not fit the mesh
      logical :: is_of_axis(size(config%loads))
      type(load_t), allocatable :: loads(:)
      integer :: i

      do i = 1, size(config%loads)
         is_of_axis(i) = axis_of(config%loads(i), config%sweep%axes) == axis
      end do
      loads = pack(config%loads, is_of_axis)
      call load_vector(load_case%force, body%mesh, body%materials, loads, error)
      if (.not. allocated(error)) call sum_thermal_strain(load_case%thermal_strain, body%mesh, body%materials, loads, &
         error)
   end subroutine sum_loads

   !> The quantity that multiplies a load, 0 for none.
   pure integer function axis_of(load, axes) result(axis)
      type(load_t), intent(in) :: load !! the load
      type(sweep_axis_t), intent(in) :: axes(:) !! the quantities

      do axis = 1, size(axes)
         if (axes(axis)%target == swept_load .and. axes(axis)%name == load%name) return
      end do
      axis = 0
   end function axis_of

   !> Moves the friction that a quantity stands for from what does not vary to the quantity.
   pure subroutine separate_friction(model, body, config, axis)
      type(sweep_model_t), intent(inout) :: model !! the model
      type(body_t), intent(in) :: body !! the body
      type(config_t), intent(in) :: config !! the deck
      integer, intent(in) :: axis !! number of the quantity
      integer :: p

      do p = 1, body%zone%n_points
         associate (contact => config%contacts(body%zone%set(p)), quantity => config%sweep%axes(axis), &
            fixed => model%fixed%friction(p))
            if (.not. quantity%acts_on(contact%set)) cycle
            if (quantity%target == swept_friction) then
               model%friction(p, axis) = 1.0_dp
               fixed = dot_product(contact%friction%slope, body%zone%position(:, p))
            else
               model%friction(p, axis) = fixed
               fixed = 0.0_dp
            end if
         end associate
      end do
   end subroutine separate_friction

   !> Sets load and friction of a contact problem to those of a case.
   pure subroutine sweep_model_set_case(self, problem, values)
      class(sweep_model_t), intent(in) :: self !! the model
      type(contact_problem_t), intent(inout) :: problem !! a copy of the model's problem
      real(dp), intent(in) :: values(:) !! value of each quantity [-]

      problem%load = self%problem%load + matmul(self%load, values)
      problem%prescribed = self%problem%prescribed + dot_product(self%expansion, abs(values))
      problem%friction = merge(0.0_dp, self%fixed%friction + matmul(self%friction, values), self%is_tangent_fixed)
   end subroutine sweep_model_set_case

   !> The load case of a case of the sweep, condensed if the model's loads are.
   pure subroutine sweep_model_load_case(self, values, load_case)
      class(sweep_model_t), intent(in) :: self !! the model
      real(dp), intent(in) :: values(:) !! value of each quantity [-]
      type(load_case_t), intent(out) :: load_case !! the load case
      integer :: k

      load_case = self%fixed
      load_case%force = case_forces(self, values, 1, size(self%fixed%force, 2))
      load_case%factor = [(merge(1.0_dp, values(max(1, self%axis(k))), self%axis(k) == 0), k=1, size(self%axis))]
      load_case%friction = self%fixed%friction + matmul(self%friction, values)
      call self%condense(values, load_case%condensed)
      call self%sum_thermal_strain(values, load_case%thermal_strain)
   end subroutine sweep_model_load_case

   !> The condensed load of a case, if the model's loads are condensed.
   pure subroutine sweep_model_condense(self, values, condensed)
      class(sweep_model_t), intent(in) :: self !! the model
      real(dp), intent(in) :: values(:) !! value of each quantity [-]
      type(condensed_load_t), intent(out) :: condensed !! the condensed load
      integer :: k

      condensed = self%fixed%condensed
      do k = 1, size(values)
         if (allocated(self%parts(k)%condensed%load)) call condensed%add(values(k), self%parts(k)%condensed)
      end do
   end subroutine sweep_model_condense

   !> The thermal strain of a case, if there is any.
   pure subroutine sweep_model_sum_thermal_strain(self, values, strain)
      class(sweep_model_t), intent(in) :: self !! the model
      real(dp), intent(in) :: values(:) !! value of each quantity [-]
      real(dp), allocatable, intent(out) :: strain(:)
         !! strain of free thermal expansion at the nodes of each element, as in `load_case_t` [-]
      integer :: k

      if (allocated(self%fixed%thermal_strain)) strain = self%fixed%thermal_strain
      do k = 1, size(values)
         if (.not. allocated(self%parts(k)%thermal_strain)) cycle
         if (allocated(strain)) then
            strain = strain + values(k)*self%parts(k)%thermal_strain
         else
            strain = values(k)*self%parts(k)%thermal_strain
         end if
      end do
   end subroutine sweep_model_sum_thermal_strain

   !> The nodal forces of a case on some nodes that follow each other (2, nodes) [F].
   pure function case_forces(model, values, first, last) result(forces)
      class(sweep_model_t), intent(in) :: model !! the model
      real(dp), intent(in) :: values(:) !! value of each quantity [-]
      integer, intent(in) :: first !! the first node
      integer, intent(in) :: last !! the last node
      real(dp) :: forces(2, last - first + 1)
      integer :: k

      forces = model%fixed%force(:, first:last)
      do k = 1, size(values)
         if (allocated(model%parts(k)%force)) forces = forces + values(k)*model%parts(k)%force(:, first:last)
      end do
   end function case_forces

   !> The largest component of the nodal forces of a case, of some nodes at a time, which stay in the cache [F].
   pure real(dp) function sweep_model_largest_force(self, values) result(largest)
      class(sweep_model_t), intent(in) :: self !! the model
      real(dp), intent(in) :: values(:) !! value of each quantity [-]
      integer, parameter :: n_together = 512
      integer :: first

      largest = 0.0_dp
      associate (n => size(self%fixed%force, 2))
         do first = 1, n, n_together
            largest = max(largest, maxval(abs(case_forces(self, values, first, min(n, first + n_together - 1)))))
         end do
      end associate
   end function sweep_model_largest_force

   !> A text that tells whether two models are the same to the last bit: files that a deck names may have changed
   !> although the deck has not.
   pure function sweep_model_fingerprint(self) result(text)
      class(sweep_model_t), intent(in) :: self !! the model
      character(:), allocatable :: text
      type(checksum_t) :: checksum
      integer :: j

      associate (problem => self%problem)
         if (allocated(problem%matrix%band)) then
            call checksum%add(reshape(problem%matrix%band%whole%entry, [size(problem%matrix%band%whole%entry)]))
         else
            do j = 1, problem%matrix%n
               call checksum%add(problem%matrix%stiffness%values(:, j))
            end do
         end if
         call checksum%add([problem%load, problem%gap, self%fixed%friction, problem%slip_bound])
      end associate
      do j = 1, size(self%load, 2)
         call checksum%add([self%load(:, j), self%friction(:, j), self%expansion(j)])
      end do
      text = to_text(checksum%value())
   end function sweep_model_fingerprint

end module amontons_sweep_model
