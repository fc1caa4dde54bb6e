!> What an earlier run of a case left in its directory and the new one does not write again: grids of other cases of a
!> sweep or steps of a history, all solutions, a reduced problem. It is removed, so that the files of a case are
!> those of one run.
!>
!> What the earlier run left is what its manifest names. Whatever else has the name of the case is left alone, as is a
!> file that is no longer the one that was written, or that the new run has read.
module amontons_earlier_files
   use amontons_checksum, only: checksum_t, file_checksum
   use amontons_error, only: error_t
   use amontons_manifest, only: read_summary, manifest_t, manifest_file_t, manifest_list_t
   use amontons_system, only: absolute_path, file_name_t
   implicit none (type, external)
   private

   public :: find_earlier_files

contains

   !> Finds the files to remove.
   subroutine find_earlier_files(files, directory, name, manifest)
      type(file_name_t), allocatable, intent(out) :: files(:) !! the files, with their directory
      character(*), intent(in) :: directory !! output directory
      character(*), intent(in) :: name !! name of the case
      type(manifest_t), intent(in) :: manifest !! the manifest of the new results
      type(manifest_t) :: earlier
      character(:), allocatable :: summary, fault
      integer :: i, n

      ! Where it cannot be read, or it was changed, nothing is named.
      call read_summary(earlier, summary, directory//'/'//name//'.summary.json', fault)
      allocate (files(earlier%outputs%n))
      n = 0
      do i = 1, earlier%outputs%n
         associate (file => earlier%outputs%files(i))
            if (.not. is_of_case(file%name, name) .or. is_among(manifest%outputs, file%name)) cycle
            if (.not. is_removable(file, directory, manifest%inputs)) cycle
            n = n + 1
            files(n)%text = directory//'/'//file%name
         end associate
      end do
      files = files(:n)
   end subroutine find_earlier_files

   !> Whether a file is one that a case of this name may leave; a summary of another program may name any.
   pure logical function is_of_case(file, name)
      character(*), intent(in) :: file !! its name, seen from the output directory
      character(*), intent(in) :: name !! name of the case
      integer :: slash

      slash = index(file, '/', back=.true.)
      is_of_case = index(file, name//'.') == 1 .and. slash == 0 .or. file(:slash) == name//'.sweep/' .or. &
         file(:slash) == name//'.history/'
   end function is_of_case

   !> Whether a name is among those of a list.
   pure logical function is_among(list, name)
      type(manifest_list_t), intent(in) :: list !! the list
      character(*), intent(in) :: name !! the name
      integer :: i

      is_among = .true.
      do i = 1, list%n
         if (len(list%files(i)%name) == len(name) .and. list%files(i)%name == name) return
      end do
      is_among = .false.
   end function is_among

   !> Whether a file is still the one that was written, and none that the new run has read.
   logical function is_removable(file, directory, inputs)
      type(manifest_file_t), intent(in) :: file !! what is known of it
      character(*), intent(in) :: directory !! output directory
      type(manifest_list_t), intent(in) :: inputs !! the files that were read
      type(checksum_t) :: checksum
      type(error_t), allocatable :: error
      character(:), allocatable :: path
      integer :: i

      path = directory//'/'//file%name
      call file_checksum(checksum, path, error)
      is_removable = .not. allocated(error) .and. checksum%n_bytes == file%n_bytes .and. &
         checksum%value() == file%checksum
      do i = 1, inputs%n
         if (absolute_path(inputs%files(i)%name) == absolute_path(path)) is_removable = .false.
      end do
   end function is_removable

end module amontons_earlier_files
