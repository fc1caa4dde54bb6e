!> The numbers of a result on successively refined meshes: their selection, and their convergence.
module amontons_refined_meshes
   use amontons_body, only: body_t
   use amontons_error, only: error_t
   use amontons_kinds, only: dp
   use amontons_loads, only: add_point_forces, load_on_nodes
   use amontons_quantity, only: quantity_t
   use amontons_result, only: has_limit, new_convergence, result_t
   use amontons_text, only: pair_text
   implicit none (type, external)
   private

   public :: judge_meshes, refined_quantities

contains

   !> The numbers of a result that are compared over refined meshes.
   pure function refined_quantities(result) result(list)
      type(result_t), intent(in) :: result !! the result on one of the meshes
      type(quantity_t), allocatable :: list(:)

      associate (energies => result%certificate%energies())
         list = [result%lengths%quantities(), result%key_results, energies(:1)]
      end associate
      if (allocated(result%history_results)) list = [list, result%history_results]
   end function refined_quantities

   !> Judges the convergence of each number over the meshes. At a point force a continuum has neither a finite stress
   !> nor a finite displacement: the largest one there grows with every mesh.
   subroutine judge_meshes(result, body, values)
      type(result_t), intent(inout) :: result !! the result on the finest mesh; gains the judgments, and a warning
      type(body_t), intent(in) :: body !! its body
      real(dp), intent(in) :: values(:, :) !! `refined_quantities` of each mesh, a column for a mesh, the coarsest first
      ! Residuals of the contact problem are at most 1e-10 of the largest force; rounding is some ten times as large.
      real(dp), parameter :: rounding = 1.0e-8_dp
      type(quantity_t), allocatable :: list(:)
      type(error_t), allocatable :: error
      character(:), allocatable :: names
      logical :: is_beside(body%mesh%n_nodes)
      real(dp) :: side, forces(2, body%mesh%n_nodes)
      integer :: i, node

      forces = 0.0_dp
      do i = 1, size(result%load_case%loads)
         if (result%load_case%loads(i)%target == load_on_nodes) call add_point_forces(forces, body%mesh, &
            body%materials, result%load_case%loads(i), error)
      end do
      is_beside = .false.
      do i = 1, body%mesh%n_elements
         associate (nodes => body%mesh%node(body%mesh%node_start(i):body%mesh%node_start(i + 1) - 1))
            if (any(abs(forces(:, nodes)) > 0.0_dp)) is_beside(nodes) = .true.
         end associate
      end do
      names = ''
      ! The longest side at an end of a zone, where the status changes; of the whole line if there is no end. A part of
      ! a quadratic side between two points counts as its share of the side.
      side = 0.0_dp
      associate (zone => body%zone, status => result%solution%status)
         do i = 1, zone%n_points
            if (zone%next(i) == 0) cycle
            if (status(i) /= status(zone%next(i))) side = max(side, zone%weight(i), zone%weight(zone%next(i)))
         end do
         if (side <= 0.0_dp .and. zone%n_points > 0) side = maxval(zone%weight)
      end associate
      list = refined_quantities(result)
      allocate (result%convergence(size(list)))
      do i = 1, size(list)
         result%convergence(i)%quantity = list(i)
         call new_convergence(result%convergence(i)%convergence, values(i, :), list(i)%resolution*side, &
            rounding*max(maxval(abs(values(i, :))), list(i)%scale), &
            list(i)%has_place .or. list(i)%resolution > 0.0_dp .or. index(list(i)%key, 'max_') > 0)
         if (.not. list(i)%has_place .or. has_limit(result%convergence(i)%convergence)) cycle
         node = body%mesh%nearest_node(list(i)%place)
         if (any(is_beside(max(1, node):node))) names = names//', '//trim(list(i)%label)//' at '// &
            pair_text(list(i)%place)
      end do
      if (len(names) > 0) call result%warnings%add('numbers that have no limit as the mesh is refined are found '// &
         'where a point force acts: '//names(3:)//'; spread it over a set, by traction or total_force')
   end subroutine judge_meshes

end module amontons_refined_meshes
