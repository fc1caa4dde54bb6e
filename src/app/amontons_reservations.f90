!> The files that the decks of one run write: no two may write the same.
module amontons_reservations
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_study, only: study_t
   implicit none (type, external)
   private

   public :: reservation_t, reserve_files

   !> The files that a deck of the run may write.
   type :: reservation_t
      character(:), allocatable :: name !! name of its case; not allocated if it was refused
      logical :: has_grids = .false. !! whether NAME.vtu and NAME.contact.vtu are among them
   end type reservation_t

contains

   !> Refuses a study that would write over the files of an earlier one of this run.
   subroutine reserve_files(reservations, study, error)
      type(reservation_t), intent(inout) :: reservations(:) !! of the decks so far; the last becomes the study's
      class(study_t), intent(in) :: study !! the study
      type(error_t), allocatable, intent(out) :: error !! the name is taken
      character(:), allocatable :: grid
      integer :: i

      associate (reservation => reservations(size(reservations)), config => study%config)
         reservation%has_grids = study%has_grids()
         do i = 1, size(reservations) - 1
            if (.not. allocated(reservations(i)%name)) cycle
            if (reservations(i)%name == config%name) then
               call new_error(error, input_refused, config%file//": an earlier deck of this run has the case name '" &
                  //config%name//"' too; give each its own &case name")
               return
            end if
            grid = shared_grid(reservations(i)%name, config%name)
            if (len(grid) == 0 .or. .not. (reservation%has_grids .and. reservations(i)%has_grids)) cycle
            call new_error(error, input_refused, config%file//": an earlier deck of this run, with the case name '"// &
               reservations(i)%name//"', leaves a file '"//grid//"' as the case '"//config%name// &
               "' does; give this one another &case name")
            return
         end do
         reservation%name = config%name
      end associate
   end subroutine reserve_files

   !> The grid that two cases of different names would both write; empty if there is none.
   pure function shared_grid(first, second) result(grid)
      character(*), intent(in) :: first !! name of a case
      character(*), intent(in) :: second !! name of another one
      character(:), allocatable :: grid

      grid = ''
      if (first == second//'.contact') grid = first//'.vtu'
      if (second == first//'.contact') grid = second//'.vtu'
   end function shared_grid

end module amontons_reservations
