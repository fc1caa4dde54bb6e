!> Collections as they were written, held against the files that they name.
module amontons_collection_check
   use amontons_error, only: error_t, fault_list_t
   use amontons_input_file, only: read_text_file
   use amontons_manifest, only: case_entries, collection_head, collection_tail
   use amontons_text, only: read_integer, replaced, to_text
   implicit none (type, external)
   private

   public :: check_collection, compare_collection

contains

   !> Checks cases.pvd of a directory, if it is there: its form, its steps, and that there are the files it names.
   subroutine check_collection(faults, directory)
      type(fault_list_t), intent(inout) :: faults !! gains what is wrong
      character(*), intent(in) :: directory !! the directory
      character(:), allocatable :: path, text, stem
      type(error_t), allocatable :: error
      integer :: at, number, last_number
      logical :: is_there

      path = directory//'/cases.pvd'
      inquire (file=path, exist=is_there)
      if (.not. is_there) return
      call read_text_file(path, text, error)
      if (allocated(error)) text = ''
      at = 1
      if (index(text, collection_head) == 1) at = len(collection_head) + 1
      last_number = 0
      do while (at > 1 .and. at <= len(text))
         if (text(at:) == collection_tail) return
         call read_case(text, at, number, stem)
         if (len(stem) == 0 .or. number <= last_number) exit
         call expect_file(stem//'.vtu')
         call expect_file(stem//'.contact.vtu')
         at = at + len(case_entries(to_text(number), stem))
         last_number = number
      end do
      call faults%add(path, 'not as the program writes a collection, from byte '//to_text(at)//' on')

   contains

      !> Checks that a file is there.
      subroutine expect_file(name)
         character(*), intent(in) :: name !! name of the file, without its directory

         inquire (file=directory//'/'//name, exist=is_there)
         if (.not. is_there) call faults%add(path, "it names '"//name//"', which is not there")
      end subroutine expect_file

   end subroutine check_collection

   !> Compares a collection with the entries that it should have.
   subroutine compare_collection(faults, path, entries)
      type(fault_list_t), intent(inout) :: faults !! gains what is wrong
      character(*), intent(in) :: path !! name of the collection
      character(*), intent(in) :: entries !! the entries of its cases or steps, in their order
      character(:), allocatable :: text
      type(error_t), allocatable :: error
      logical :: is_same

      call read_text_file(path, text, error)
      is_same = .not. allocated(error)
      if (is_same) is_same = text == collection_head//entries//collection_tail
      if (.not. is_same) call faults%add(path, 'it does not list the grids that it should, in their order')
   end subroutine compare_collection

   !> Reads the number and the files of the next case.
   pure subroutine read_case(text, at, number, stem)
      character(*), intent(in) :: text !! the collection
      integer, intent(in) :: at !! where the case stands
      integer, intent(out) :: number !! its number
      character(:), allocatable, intent(out) :: stem !! name of its files without endings; empty if there is no case
      character(*), parameter :: before_number = '<DataSet timestep="', &
         behind_number = '" part="0" name="body" file="', behind_stem = '.vtu"/>'
      character(:), allocatable :: entries
      integer :: first, middle, last
      logical :: ok

      stem = ''
      first = at + index(text(at:), before_number) + len(before_number) - 1
      middle = first + index(text(first:), behind_number) - 1
      last = middle + index(text(middle + 1:), behind_stem)
      call read_integer(text(first:middle - 1), number, ok)
      if (.not. ok .or. last <= middle) return
      stem = text(middle + len(behind_number):last - 1)
      stem = replaced(replaced(replaced(stem, '&quot;', '"'), '&lt;', '<'), '&amp;', '&')
      entries = case_entries(to_text(number), stem)
      if (index(text(at:min(len(text), at + len(entries) - 1)), entries) /= 1) stem = ''
   end subroutine read_case

end module amontons_collection_check
