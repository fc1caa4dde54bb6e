!> The files of a solved reduced problem: all of them, each whole, or none.
module amontons_reduced_report
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_friction_law, only: status_names
   use amontons_kinds, only: dp
   use amontons_output_file, only: commit_files, new_output_file, output_file_t
   use amontons_reduced_listing, only: write_reduced_listing
   use amontons_reduced_summary, only: write_reduced_summary
   use amontons_report, only: write_deck
   use amontons_solutions_report, only: write_solutions
   use amontons_solve_reduced, only: reduced_result_t
   use amontons_system, only: make_directory
   use amontons_text, only: to_text, to_text_17
   use amontons_timings, only: phase_write
   implicit none (type, external)
   private

   public :: write_reduced_report

   !> Number of files that every reduced problem leaves.
   integer, parameter :: n_files = 4

contains

   !> Writes NAME.lst, NAME.contact.csv, NAME.deck.nml and NAME.summary.json, and NAME.solutions.csv if all solutions
   !> are known. Names change hands only after every file is complete.
   subroutine write_reduced_report(directory, config, result, error)
      character(*), intent(in) :: directory !! output directory, made if it is not there
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written
      type(output_file_t) :: files(n_files + merge(1, 0, allocated(result%all_solutions)))

      call make_directory(directory, error)
      if (allocated(error)) return
      call write_files(files, directory//'/'//config%name, config, result, error)
      call commit_files(files, error)
   end subroutine write_reduced_report

   !> Writes all files under their temporary names; the summary last, since it tells the time of writing.
   subroutine write_files(files, stem, config, result, error)
      type(output_file_t), intent(inout) :: files(:) !! the finished files
      character(*), intent(in) :: stem !! directory and name of the case
      type(config_t), intent(in) :: config !! the case
      type(reduced_result_t), intent(inout) :: result !! the result; gains the time of writing
      type(error_t), allocatable, intent(out) :: error !! a file cannot be written

      call write_reduced_listing(files(1), stem//'.lst', config, result, error)
      if (allocated(error)) return
      call write_table(files(2), stem//'.contact.csv', result, error)
      if (allocated(error)) return
      call write_deck(files(3), stem//'.deck.nml', config, error)
      if (allocated(error)) return
      if (allocated(result%all_solutions)) then
         call write_solutions(files(n_files + 1), stem//'.solutions.csv', result%all_solutions, &
            spread(0.0_dp, 1, result%system%n_contacts), error)
         if (allocated(error)) return
      end if
      call result%timings%lap(phase_write)
      call write_reduced_summary(files(4), stem//'.summary.json', config, result, error)
   end subroutine write_files

   !> Writes the table under its temporary name: one row per contact, 17 significant digits.
   subroutine write_table(file, path, result, error)
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! name of the file
      type(reduced_result_t), intent(in) :: result !! the result
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written
      integer :: p, status

      call new_output_file(file, path, .false., error)
      if (allocated(error)) return
      write (file%unit, '(a)', iostat=status) 'point,gap,slip,normal_force,tangential_force,status'
      associate (u => result%system%u, r => result%system%r)
         do p = 1, result%system%n_contacts
            if (status == 0) write (file%unit, '(a)', iostat=status) to_text(p)//','//to_text_17(u(2*p - 1))//','// &
               to_text_17(u(2*p))//','//to_text_17(r(2*p - 1))//','//to_text_17(r(2*p))//','// &
               trim(status_names(result%solution%status(p)))
         end do
      end associate
      call file%finish(status, error)
   end subroutine write_table

end module amontons_reduced_report
