!> Builds the long bar in code, without a deck, solves it for two loads on one factorization, prints its floor and writes
!> the files of the first result.
program build_body
   use, intrinsic :: iso_fortran_env, only: error_unit
   use amontons, only: body_t, contact_problem_t, contact_t, dp, error_t, load_t, material_t, mesh_t, method_options_t, &
      new_body, new_contact, new_load, new_material, new_rectangle_mesh, new_support, rectangle_t, result_t, &
      solve_body, status_names, support_t
   use amontons_decks, only: case_label_t, new_case_label, write_report
   implicit none (type, external)
   type(mesh_t) :: mesh
   type(material_t) :: material
   type(support_t) :: supports(1)
   type(contact_t) :: contacts(1)
   type(load_t) :: loads(2)
   type(body_t) :: body
   type(case_label_t) :: label
   type(contact_problem_t) :: problem
   type(result_t) :: result
   type(error_t), allocatable :: error

   call new_rectangle_mesh(mesh, rectangle_t(size=[40.0_dp, 40.0_dp], cells=[32, 10], element='quad4', &
      diagonal='right'), error)
   call check(error)
   call new_material(material, young=13000.0_dp, poisson=0.2_dp, hypothesis='plane strain', thickness=1.0_dp, &
      error=error)
   call check(error)

   call new_support(supports(1), 'right')
   supports(1)%is_held(1) = .true. ! along x
   call new_contact(contacts(1), 'bottom', friction=1.0_dp) ! on the floor y = 0
   call new_body(body, mesh, [material], supports, contacts, error)
   call check(error)

   call new_load(loads(1), 'left')
   loads(1)%traction(:2) = [10.0_dp, 0.0_dp]
   call new_load(loads(2), 'top')
   loads(2)%traction(:2) = [0.0_dp, -5.0_dp]
   call solve_body(body, problem, supports, contacts, loads, method_options_t(), result, error)
   call check(error)
   call print_floor(body, result)
   call new_case_label(label, 'long_bar', title='Long bar, pushed by 10 daN/mm^2')
   call write_report('results', label, body, result, error)
   call check(error)

   loads(1)%traction(:2) = [15.0_dp, 0.0_dp]
   call solve_body(body, problem, supports, contacts, loads, method_options_t(), result, error)
   call check(error)
   print '(a, 3f7.2)', 'pushed harder; open, slip, stick:', result%lengths%open, &
      result%lengths%slip, result%lengths%stick

contains

   !> Ends the program if something went wrong.
   subroutine check(failure)
      type(error_t), allocatable, intent(in) :: failure !! what went wrong, if something did

      if (.not. allocated(failure)) return
      write (error_unit, '(a)') failure%message
      stop failure%kind, quiet=.true.
   end subroutine check

   !> Prints every fourth contact point: place, pressure, shear and status.
   subroutine print_floor(on, found)
      type(body_t), intent(in) :: on !! the body
      type(result_t), intent(in) :: found !! its solution
      integer :: p

      print '(a)', '       x  pressure     shear  status'
      associate (zone => on%zone, force => found%solution%force, status => found%solution%status)
         do p = 1, zone%n_points, 4
            print '(f8.3, 2f10.4, 2x, a)', on%mesh%coordinates(1, zone%node(p)), force(p)/zone%area(p), &
               force(zone%n_points + p)/zone%area(p), trim(status_names(status(p)))
         end do
      end associate
   end subroutine print_floor

end program build_body
