!> The grids of the cases of a sweep checked as those of a single case are: from the displacements of the one and the
!> stresses of the other equilibrium, contact law, and all that they show are computed again.
module amontons_verify_fields
   use amontons_agreement, only: agree, contradiction, first_disagreement
   use amontons_certificate, only: new_certificate
   use amontons_collection_check, only: compare_collection
   use amontons_config, only: config_t
   use amontons_contact_check, only: check_statuses, contact_table_t, new_law_scales
   use amontons_directory, only: file_name_t, list_directory
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_load_case, only: load_case_t
   use amontons_result, only: certificate_limit, result_t
   use amontons_solve_case, only: cache_t
   use amontons_summary_check, only: summary_check_t
   use amontons_sweep_model, only: new_sweep_loads, sweep_model_t
   use amontons_sweep_statistics, only: case_result_t
   use amontons_text, only: read_integer, to_text
   use amontons_verify_case, only: check_grids
   use amontons_vtk_check, only: read_array, read_displacement
   implicit none (type, external)
   private

   public :: field_case_t, verify_fields

   !> A case whose fields are kept, as its row tells of it.
   type :: field_case_t
      integer :: number = 0 !! its number
      integer, allocatable :: status(:) !! statuses of the contact points (m)
      type(case_result_t) :: result !! lengths, resultants and residual
   end type field_case_t

contains

   !> Checks the fields of a sweep: every grid, the collection, and that no other grids are among them.
   subroutine verify_fields(summary, cache, prepared, config, stem, cases, certified_case)
      type(summary_check_t), intent(inout) :: summary !! the summary; gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(load_case_t), intent(in) :: prepared !! the load case of the deck as it stands
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! directory and name of the case
      type(field_case_t), intent(in) :: cases(:) !! the cases that converged
      integer, intent(in) :: certified_case !! number of the case whose certificate the summary has
      type(sweep_model_t) :: model
      type(error_t), allocatable :: error
      integer :: i

      call check_surplus(summary, stem//'.sweep', cases%number)
      if (size(cases) == 0) return
      call new_sweep_loads(model, cache%body, prepared, config, error)
      if (allocated(error)) then
         ! not raised: the same loads were made when the case was prepared
         call summary%faults%add(stem//'.deck.nml', error%message)
         return
      end if
      do i = 1, size(cases)
         call check_case(summary, cache, model, config, stem//'.sweep/'//to_text(cases(i)%number), cases(i), &
            cases(i)%number == certified_case)
      end do
      call compare_collection(summary%faults, stem//'.sweep.pvd', cases%number, &
         stem(index(stem, '/', back=.true.) + 1:)//'.sweep/')
   end subroutine verify_fields

   !> Tells of grids that are none of this sweep, as an interrupted one of the same name may leave them.
   subroutine check_surplus(summary, folder, numbers)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      character(*), intent(in) :: folder !! the folder of the grids
      integer, intent(in) :: numbers(:) !! numbers of the cases whose grids should be there
      type(file_name_t), allocatable :: files(:)
      type(error_t), allocatable :: error
      logical, allocatable :: has_grids(:)
      integer :: i, number
      logical :: ok

      ! What is missing is told when it is read.
      call list_directory(files, folder, error)
      if (allocated(error)) return
      allocate (has_grids(0:maxval([0, numbers])), source=.false.)
      has_grids(numbers) = .true.
      do i = 1, size(files)
         associate (name => files(i)%text)
            if (index(name//'/', '.vtu/') == 0) cycle
            call read_integer(name(:index(name, '.') - 1), number, ok)
            if (ok) ok = number >= 0 .and. number < size(has_grids)
            if (ok) ok = has_grids(number) .and. (name == to_text(number)//'.vtu' .or. &
               name == to_text(number)//'.contact.vtu')
            if (.not. ok) call summary%faults%add(folder//'/'//name, 'it is no grid of this sweep')
         end associate
      end do
   end subroutine check_surplus

   !> Checks the two grids of a case.
   subroutine check_case(summary, cache, model, config, stem, case, is_certified)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(sweep_model_t), intent(in) :: model !! loads and friction of all cases
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: stem !! name of the grids without endings
      type(field_case_t), intent(in) :: case !! the case
      logical, intent(in) :: is_certified !! whether the certificate of the summary is its
      type(result_t) :: result
      character(:), allocatable :: fault

      call model%load_case(config%sweep%values(case%number), result%load_case)
      call read_displacement(stem//'.vtu', cache%body%mesh%n_nodes, result%displacement, fault)
      if (len(fault) > 0) call summary%faults%add(stem//'.vtu', fault)
      if (len(fault) > 0) return
      call read_solution(cache, stem//'.contact.vtu', result, fault)
      if (len(fault) > 0) call summary%faults%add(stem//'.contact.vtu', fault)
      if (.not. allocated(result%solution%force)) return
      result%solution%status = case%status
      call check_grids(summary, cache, result, stem)
      call check_law(summary, cache, config, result, stem)
      if (is_certified) call summary%expect_certificate(result%certificate)
      call check_resultants(summary, result, case, stem//'.contact.vtu')
   end subroutine check_case

   !> Reads the contact line: gap and slip, which must follow from the displacements, and the forces, from the stresses.
   subroutine read_solution(cache, path, result, fault)
      type(cache_t), intent(in) :: cache !! the body
      character(*), intent(in) :: path !! name of the grid of the contact line
      type(result_t), intent(inout) :: result !! the displacements; gains the solution
      character(:), allocatable, intent(out) :: fault !! what is wrong with them; empty if nothing is
      character(16), parameter :: names(4) = [character(16) :: 'gap', 'slip', 'contact_pressure', 'contact_shear']
      real(dp) :: stated(cache%body%zone%n_points, size(names)), followed(2*cache%body%zone%n_points)
      integer :: i, p

      associate (zone => cache%body%zone)
         do i = 1, size(names)
            call read_array(path, trim(names(i)), 1, stated(:, i), fault)
            if (len(fault) > 0) return
         end do
         followed = zone%rows%displacement(result%displacement)
         followed(:zone%n_points) = result%load_case%gap - followed(:zone%n_points)
         ! A gap is the difference of the initial gap and a displacement.
         p = first_disagreement([stated(:, 1), stated(:, 2)], followed, max(maxval(abs(result%load_case%gap)), &
            maxval(abs(result%displacement))))
         if (p > 0) fault = contradiction(trim(names((p - 1)/zone%n_points + 1))//' of point '// &
            to_text(modulo(p - 1, zone%n_points) + 1), stated(modulo(p - 1, zone%n_points) + 1, &
            (p - 1)/zone%n_points + 1), followed(p))
         result%solution%force = [stated(:, 3)*zone%area, stated(:, 4)*zone%area]
         result%solution%displacement = [result%load_case%free_gap - stated(:, 1), stated(:, 2)]
      end associate
   end subroutine read_solution

   !> Computes the certificate, and holds it and the statuses against the contact law.
   subroutine check_law(summary, cache, config, result, stem)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      type(cache_t), intent(in) :: cache !! the body
      type(config_t), intent(in) :: config !! the deck
      type(result_t), intent(inout) :: result !! what the grids state; gains the certificate
      character(*), intent(in) :: stem !! name of the grids without endings
      type(contact_table_t) :: table
      real(dp) :: limit
      integer :: m

      limit = certificate_limit(config%method%tolerance)
      associate (body => cache%body, zone => cache%body%zone, solution => result%solution)
         call new_certificate(result%certificate, body, result%load_case, result%displacement, solution%force)
         if (.not. result%certificate%largest() <= limit) call summary%faults%add(stem//'.vtu', &
            'equilibrium or contact law is violated by '//to_text(result%certificate%largest())// &
            ', more than the limit of '//to_text(limit))
         m = zone%n_points
         if (m == 0) return
         table%force = solution%force
         table%gap = result%load_case%free_gap - solution%displacement(:m)
         table%slip = solution%displacement(m + 1:)
         table%status = solution%status
         call check_statuses(summary%faults, stem//'.contact.vtu', .false., table, result%load_case%friction, &
            result%load_case%slip_bound, zone%is_tangent_fixed, new_law_scales(limit, result%displacement, &
            result%certificate%force_scale))
      end associate
   end subroutine check_law

   !> Compares the sums of the contact forces with those of the row.
   subroutine check_resultants(summary, result, case, path)
      type(summary_check_t), intent(inout) :: summary !! gains the faults
      type(result_t), intent(in) :: result !! what the grids state
      type(field_case_t), intent(in) :: case !! what the row states
      character(*), intent(in) :: path !! name of the grid of the contact line
      character(10), parameter :: direction(2) = [character(10) :: 'normal', 'tangential']
      real(dp) :: sums(2)
      integer :: i, m

      associate (force => result%solution%force)
         m = size(force)/2
         sums = [sum(force(:m)), sum(force(m + 1:))]
         do i = 1, 2
            if (agree(sums(i), case%result%quantity(3 + i), sum(abs(force)))) cycle
            call summary%faults%add(path, contradiction('the sum of its '//trim(direction(i))//' forces', sums(i), &
               case%result%quantity(3 + i)))
         end do
      end associate
   end subroutine check_resultants

end module amontons_verify_fields
