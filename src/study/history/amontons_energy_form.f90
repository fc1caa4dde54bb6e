!> Energies and works of a body in terms of its contact displacements, without the displacements of its nodes.
!>
!> Loads and prescribed displacements are sums of parts, f = sum c_i f_i and u_p = sum c_i u_pi. The field of all nodes
!> is then u = sum c_i u_i + E v: u_i answers part i with v = 0, E extends the contact displacements v by equilibrium.
!> Any force field G does the work `v . condense(G)` on E v, so that a few vectors and small matrices, computed once,
!> give every energy of a step in O(m^2) operations (section 10 of doc/theory.md).
module amontons_energy_form
   use amontons_body, only: body_t
   use amontons_contact_problem, only: contact_problem_t
   use amontons_kinds, only: dp
   use amontons_load_case, only: condensed_force, load_case_t, recover_displacement
   implicit none (type, external)
   private

   public :: energy_form_t, new_energy_form

   !> Matrices over the parts, and vectors on the contact displacements for each part.
   type :: energy_form_t
      real(dp), allocatable :: field(:, :, :) !! displacements u_i of the nodes (2, n_nodes, parts) [L]
      real(dp), allocatable, private :: strain(:, :) !! u_i . K u_j (parts, parts) [F L]
      real(dp), allocatable, private :: strain_row(:, :) !! condensed K u_i (2m, parts) [F]
      real(dp), allocatable, private :: load(:, :) !! f_i . u_j (parts, parts) [F L]
      real(dp), allocatable, private :: load_row(:, :) !! condensed f_i (2m, parts) [F]
      real(dp), allocatable, private :: reaction(:, :) !! u_pi . (K u_j - f_j) (parts, parts) [F L]
      real(dp), allocatable, private :: reaction_row(:, :) !! condensed K u_pi (2m, parts) [F]
      real(dp) :: stiffness = 0.0_dp !! norm of the body's K [F/L]
      real(dp), allocatable :: prescribed(:, :) !! what the parts prescribe of the contact displacements (2m, parts) [L]
   contains
      procedure :: load_work => energy_form_load_work
      procedure :: reactions => energy_form_reactions
      procedure :: strain_energy => energy_form_strain_energy
   end type energy_form_t

contains

   !> Computes the form from the load cases of the parts.
   subroutine new_energy_form(form, body, parts)
      type(energy_form_t), intent(out) :: form !! the form
      type(body_t), intent(in) :: body !! the body, condensed
      type(load_case_t), intent(in) :: parts(:) !! force and prescribed displacement of each part, condensed
      real(dp), allocatable :: field(:, :), forces(:, :), at_rest(:), loads(:, :, :)
      integer :: i, j, m, n

      m = body%zone%n_points
      n = size(parts)
      form%stiffness = body%condensation%condenser%matrix_norm
      allocate (form%field(2, body%mesh%n_nodes, n), form%strain(n, n), form%load(n, n), form%reaction(n, n))
      allocate (form%strain_row(2*m, n), form%load_row(2*m, n), form%reaction_row(2*m, n), form%prescribed(2*m, n))
      allocate (at_rest(2*m), source=0.0_dp)
      do j = 1, n
         call recover_displacement(field, body, parts(j), at_rest)
         form%field(:, :, j) = field
      end do
      loads = load_forces(body, parts)
      do j = 1, n
         call body%internal_forces(forces, form%field(:, :, j))
         do i = 1, n
            form%strain(i, j) = sum(form%field(:, :, i)*forces)
            form%load(i, j) = sum(loads(:, :, i)*form%field(:, :, j))
            form%reaction(i, j) = sum(parts(i)%prescribed*(forces - loads(:, :, j)))
         end do
         form%strain_row(:, j) = condensed_force(body, forces)
         form%load_row(:, j) = condensed_force(body, loads(:, :, j))
         call body%internal_forces(forces, parts(j)%prescribed)
         form%reaction_row(:, j) = condensed_force(body, forces)
         form%prescribed(:, j) = body%zone%rows%displacement(parts(j)%prescribed)
      end do
   end subroutine new_energy_form

   !> The nodal forces of each part; of temperatures those that cause the same strain (2, n_nodes, parts) [F].
   function load_forces(body, parts) result(loads)
      type(body_t), intent(in) :: body !! the body
      type(load_case_t), intent(in) :: parts(:) !! the parts
      real(dp), allocatable :: loads(:, :, :)
      real(dp), allocatable :: forces(:, :)
      integer :: i

      allocate (loads(2, body%mesh%n_nodes, size(parts)))
      do i = 1, size(parts)
         call body%internal_forces(forces, 0.0_dp*parts(i)%prescribed, parts(i)%thermal_strain)
         loads(:, :, i) = parts(i)%force - forces
      end do
   end function load_forces

   !> Strain energy u . K u / 2 [F L].
   pure real(dp) function energy_form_strain_energy(self, problem, factor, v) result(energy)
      class(energy_form_t), intent(in) :: self !! the form
      type(contact_problem_t), intent(in) :: problem !! the contact problem, for its stiffness
      real(dp), intent(in) :: factor(:) !! factors c of the parts [-]
      real(dp), contiguous, intent(in) :: v(:) !! contact displacements (2m) [L]
      real(dp) :: force(size(v))

      call problem%matrix%multiply_stiffness(v, force)
      energy = dot_product(v, 0.5_dp*force + matmul(self%strain_row, factor)) &
         + 0.5_dp*dot_product(factor, matmul(self%strain, factor))
   end function energy_form_strain_energy

   !> Work of the loads at given factors while the field changes [F L].
   pure real(dp) function energy_form_load_work(self, factor, change, v_change) result(work)
      class(energy_form_t), intent(in) :: self !! the form
      real(dp), intent(in) :: factor(:) !! factors c of the parts [-]
      real(dp), intent(in) :: change(:) !! by how much the factors change [-]
      real(dp), intent(in) :: v_change(:) !! by how much the contact displacements change (2m) [L]

      work = dot_product(factor, matmul(self%load, change) + matmul(v_change, self%load_row))
   end function energy_form_load_work

   !> What the reactions of the supports do on the displacements that each part prescribes: their work while factor i
   !> grows by 1 (parts) [F L].
   pure function energy_form_reactions(self, factor, v, force) result(reactions)
      class(energy_form_t), intent(in) :: self !! the form
      real(dp), intent(in) :: factor(:) !! factors c of the parts [-]
      real(dp), intent(in) :: v(:) !! contact displacements (2m) [L]
      real(dp), intent(in) :: force(:) !! contact forces (2m) [F]
      real(dp) :: reactions(size(factor))

      reactions = matmul(self%reaction, factor) + matmul(v, self%reaction_row) + matmul(force, self%prescribed)
   end function energy_form_reactions

end module amontons_energy_form
