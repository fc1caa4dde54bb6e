!> Collections as they were written, held against the files that they name.
module amontons_collection_check
   use amontons_agreement, only: fault_text_t
   use amontons_collection, only: case_entries, collection_head, collection_tail
   use amontons_error, only: error_t
   use amontons_text, only: read_integer, to_text
   use amontons_text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: check_collection, compare_collection

   !> What is said of a collection that is not in the form of the program.
   character(*), parameter :: foreign = 'not as the program writes a collection, from byte '

contains

   !> Checks cases.pvd of a directory, if it is there: its form, its steps, and that there are the files it names.
   subroutine check_collection(faults, directory)
      type(fault_text_t), intent(inout) :: faults !! gains what is wrong
      character(*), intent(in) :: directory !! the directory
      character(:), allocatable :: path, text, stem
      integer :: at, number, last_number
      logical :: is_there

      path = directory//'/cases.pvd'
      inquire (file=path, exist=is_there)
      if (.not. is_there) return
      call open_collection(faults, path, text, at)
      last_number = 0
      do while (at <= len(text))
         if (text(at:) == collection_tail) return
         call read_case(text, at, number, stem)
         if (len(stem) == 0 .or. number <= last_number) exit
         call expect_file(stem//'.vtu')
         call expect_file(stem//'.contact.vtu')
         at = at + len(case_entries(to_text(number), stem))
         last_number = number
      end do
      if (allocated(text)) call faults%add(path, foreign//to_text(at)//' on')

   contains

      !> Checks that a file is there.
      subroutine expect_file(name)
         character(*), intent(in) :: name !! its name

         inquire (file=directory//'/'//name, exist=is_there)
         if (.not. is_there) call faults%add(path, "it names '"//name//"', which is not there")
      end subroutine expect_file

   end subroutine check_collection

   !> Compares a collection with the cases that it should have.
   subroutine compare_collection(faults, path, numbers, folder)
      type(fault_text_t), intent(inout) :: faults !! gains what is wrong
      character(*), intent(in) :: path !! name of the file
      integer, intent(in) :: numbers(:) !! numbers of the cases, of which their files have their names
      character(*), intent(in) :: folder !! where these are, a slash behind it
      character(:), allocatable :: text, entries
      integer :: at, i

      call open_collection(faults, path, text, at)
      if (.not. allocated(text)) return
      do i = 1, size(numbers)
         entries = case_entries(to_text(numbers(i)), folder//to_text(numbers(i)))
         if (index(text(at:min(len(text), at + len(entries) - 1)), entries) /= 1) then
            call faults%add(path, 'files of case '//to_text(numbers(i))//' are missing or misplaced')
            return
         end if
         at = at + len(entries)
      end do
      if (text(at:) /= collection_tail .or. len(text) - at + 1 /= len(collection_tail)) call faults%add(path, &
         'unexpected text after the last of '//to_text(size(numbers))//' cases')
   end subroutine compare_collection

   !> Reads a collection and its head.
   subroutine open_collection(faults, path, text, at)
      type(fault_text_t), intent(inout) :: faults !! gains what is wrong
      character(*), intent(in) :: path !! name of the file
      character(:), allocatable, intent(out) :: text !! the collection; not allocated if it cannot be read
      integer, intent(out) :: at !! where its first case stands
      type(error_t), allocatable :: error

      at = len(collection_head) + 1
      call read_text_file(path, text, error)
      if (allocated(error)) then
         call faults%add(path, 'cannot be read')
      else if (index(text, collection_head) /= 1) then
         call faults%add(path, foreign//'1 on')
      else
         return
      end if
      if (allocated(text)) deallocate (text)
   end subroutine open_collection

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
      stem = unescaped(text(middle + len(behind_number):last - 1))
      entries = case_entries(to_text(number), stem)
      if (index(text(at:min(len(text), at + len(entries) - 1)), entries) /= 1) stem = ''
   end subroutine read_case

   !> What the value of an XML attribute stands for, of those that the program writes.
   pure function unescaped(value) result(text)
      character(*), intent(in) :: value !! the value
      character(:), allocatable :: text
      integer :: i, length

      text = ''
      i = 1
      do while (i <= len(value))
         length = 1
         if (value(i:i) == '&') length = max(1, index(value(i:), ';'))
         select case (value(i:i + length - 1))
         case ('&amp;')
            text = text//'&'
         case ('&lt;')
            text = text//'<'
         case ('&quot;')
            text = text//'"'
         case default
            text = text//value(i:i + length - 1)
         end select
         i = i + length
      end do
   end function unescaped

end module amontons_collection_check
