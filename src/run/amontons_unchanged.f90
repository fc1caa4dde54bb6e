!> Whether the results of a deck are there already: those of the same deck, of the same files that it names, of this
!> version of the program; solved, certified, and every file as it was written.
module amontons_unchanged
   use amontons_checksum, only: checksum_t, file_checksum
   use amontons_config, only: config_t
   use amontons_error, only: error_t
   use amontons_manifest, only: manifest_list_t, manifest_t, read_summary
   use amontons_text, only: newline
   use amontons_text_file, only: read_text_file
   use amontons_version, only: version
   implicit none (type, external)
   private

   public :: is_unchanged

contains

   !> Whether solving a deck again would write what is there already.
   logical function is_unchanged(config, directory)
      type(config_t), intent(in) :: config !! the deck
      character(*), intent(in) :: directory !! output directory
      type(manifest_t) :: manifest
      type(error_t), allocatable :: error
      character(:), allocatable :: summary, fault, deck
      integer :: i

      is_unchanged = .false.
      call read_summary(manifest, summary, directory//'/'//config%name//'.summary.json', fault)
      if (len(fault) > 0) return
      if (index(summary, newline//'  "version": "'//version//'",'//newline) == 0) return
      if (index(summary, newline//'  "converged": true,'//newline) == 0) return
      if (index(summary, '"passed": true') == 0) return
      call read_text_file(directory//'/'//config%name//'.deck.nml', deck, error)
      if (allocated(error)) return
      if (deck /= config%deck_text()) return
      do i = 1, manifest%outputs%n
         if (.not. is_as_listed(manifest%outputs, i, directory//'/')) return
      end do
      is_unchanged = has_unchanged_inputs(config, manifest%inputs)
   end function is_unchanged

   !> Whether every file that a deck names is listed and has not changed. A pipe is never listed.
   logical function has_unchanged_inputs(config, inputs)
      type(config_t), intent(in) :: config !! the deck
      type(manifest_list_t), intent(in) :: inputs !! the files that were read
      integer :: i

      has_unchanged_inputs = .true.
      if (config%reduced%is_given) then
         call check(has_unchanged_inputs, inputs, config%reduced%path)
         return
      end if
      do i = 1, size(config%meshes)
         call check(has_unchanged_inputs, inputs, config%meshes(i)%file)
      end do
      do i = 1, size(config%contacts)
         associate (contact => config%contacts(i))
            call check(has_unchanged_inputs, inputs, contact%friction%file)
            call check(has_unchanged_inputs, inputs, contact%slip_bound%file)
            call check(has_unchanged_inputs, inputs, contact%obstacle%file)
         end associate
      end do
      do i = 1, size(config%loads)
         call check(has_unchanged_inputs, inputs, config%loads(i)%temperature_file)
      end do
      if (.not. allocated(config%history%steps)) return
      do i = 1, size(config%history%steps)
         call check(has_unchanged_inputs, inputs, config%history%steps(i)%file)
      end do
   end function has_unchanged_inputs

   !> Looks for a file, if there is one, among those that are listed.
   subroutine check(is_unchanged, inputs, path)
      logical, intent(inout) :: is_unchanged !! becomes false if the file is not listed or has changed
      type(manifest_list_t), intent(in) :: inputs !! the files that were read
      character(:), allocatable, intent(in) :: path !! its name; empty or not allocated for none
      integer :: i

      if (.not. (allocated(path) .and. is_unchanged)) return
      if (len(path) == 0) return
      do i = 1, inputs%n
         if (inputs%files(i)%name /= path) cycle
         is_unchanged = is_as_listed(inputs, i, '')
         return
      end do
      is_unchanged = .false.
   end subroutine check

   !> Whether a file is the one that is listed.
   logical function is_as_listed(list, i, folder)
      type(manifest_list_t), intent(in) :: list !! the list
      integer, intent(in) :: i !! which file
      character(*), intent(in) :: folder !! what its name is to be read from, with a slash; empty for the present folder
      type(checksum_t) :: checksum
      type(error_t), allocatable :: error

      associate (file => list%files(i))
         call file_checksum(checksum, folder//file%name, error)
         is_as_listed = .not. allocated(error)
         if (is_as_listed) is_as_listed = checksum%n_bytes == file%n_bytes .and. checksum%value() == file%checksum
      end associate
   end function is_as_listed

end module amontons_unchanged
