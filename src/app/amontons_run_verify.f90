!> Verification of the results of earlier runs.
module amontons_run_verify
   use amontons_command_line, only: command_line_t
   use amontons_error, only: error_t, fault_list_t
   use amontons_file_check, only: check_collection
   use amontons_messages, only: print_error, print_info
   use amontons_result, only: status_not_converged
   use amontons_solve_case, only: cache_t
   use amontons_system, only: file_name_t
   use amontons_text, only: newline
   use amontons_verify, only: find_cases, verdict_t, verify_files
   implicit none (type, external)
   private

   public :: verify_directories

contains

   !> Verifies every case in every directory; the largest exit status counts.
   subroutine verify_directories(command_line, status)
      type(command_line_t), intent(in) :: command_line !! the directories, and the options
      integer, intent(out) :: status !! 0 if all are verified and certified
      type(file_name_t), allocatable :: names(:)
      type(verdict_t) :: verdict
      type(cache_t) :: cache
      type(error_t), allocatable :: error
      type(fault_list_t) :: faults
      integer :: i, k

      status = 0
      do i = 1, size(command_line%decks)
         associate (directory => command_line%decks(i)%text)
            call find_cases(names, directory, error)
            if (.not. allocated(error)) then
               do k = 1, size(names)
                  call verify_files(verdict, cache, directory, names(k)%text)
                  if (verdict%is_verified .and. verdict%is_certified) then
                     call print_info(command_line, names(k)%text//': verified'//verdict%remark, error)
                     if (allocated(error)) exit
                  else
                     status = max(status, status_not_converged)
                     if (verdict%is_verified) then
                        call print_error(names(k)%text//': as it was written, but not converged or not certified')
                     else
                        call print_error(names(k)%text//': NOT VERIFIED'//newline//verdict%faults)
                     end if
                  end if
               end do
               call check_collection(faults, directory)
               if (faults%n > 0) then
                  status = max(status, status_not_converged)
                  call print_error('cases.pvd: NOT VERIFIED'//newline//faults%text())
               end if
            end if
         end associate
         if (.not. allocated(error)) cycle
         call print_error(error%message)
         status = max(status, error%kind)
      end do
   end subroutine verify_directories

end module amontons_run_verify
