!> Collections for ParaView: the grids of several cases in one file, to be stepped through.
!>
!> A case is a step of the collection, its time the number of the case, or the pseudo-time of a history;
!> body and contact line are parts of the step.
module amontons_collection
   use amontons_error, only: error_t
   use amontons_manifest, only: manifest_t
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_text, only: newline, xml_escaped
   implicit none (type, external)
   private

   public :: case_entries, collection_head, collection_t, collection_tail, new_collection

   !> The lines before the cases.
   character(*), parameter :: collection_head = '<?xml version="1.0"?>'//newline// &
      '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">'//newline//'  <Collection>'//newline
   !> The lines behind them.
   character(*), parameter :: collection_tail = '  </Collection>'//newline//'</VTKFile>'//newline

   !> A collection being written.
   type :: collection_t
      private
      type(output_file_t) :: file !! the file
      integer :: state = 0 !! status of the last write statement; nothing is written after a failure
      character(:), allocatable, public :: units !! names of the units of its cases
      integer, public :: n_cases = 0 !! number of its cases
      type(manifest_t), public :: grids !! the manifest of their files, for those who keep one
   contains
      procedure, public :: add => collection_add
      procedure, public :: discard => collection_discard
      procedure, public :: finish => collection_finish
   end type collection_t

contains

   !> Opens a collection under a temporary name.
   subroutine new_collection(collection, path, units, error)
      type(collection_t), intent(out) :: collection !! the collection, without cases
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in) :: units !! names of the units of its cases
      type(error_t), allocatable, intent(out) :: error !! the file cannot be opened

      collection%units = units
      call new_output_file(collection%file, path, .true., error)
      if (allocated(error)) return
      ! allow(C181): `finish` checks the state
      write (collection%file%unit, iostat=collection%state) collection_head
   end subroutine new_collection

   !> Adds a case: STEM.vtu and STEM.contact.vtu.
   subroutine collection_add(self, time, stem)
      class(collection_t), intent(inout) :: self !! the collection
      character(*), intent(in) :: time !! its time: the number of the case, or the pseudo-time of a step
      character(*), intent(in) :: stem !! name of its files without endings, seen from the folder of the collection

      self%n_cases = self%n_cases + 1
      ! allow(C181): `finish` checks the state
      if (self%state == 0) write (self%file%unit, iostat=self%state) case_entries(time, stem)
   end subroutine collection_add

   !> The lines of a case.
   pure function case_entries(time, stem) result(lines)
      character(*), intent(in) :: time !! its time
      character(*), intent(in) :: stem !! name of its files without endings, seen from the folder of the collection
      character(:), allocatable :: lines, head

      head = '    <DataSet timestep="'//time//'" part="'
      lines = head//'0" name="body" file="'//xml_escaped(stem)//'.vtu"/>'//newline// &
         head//'1" name="contact line" file="'//xml_escaped(stem)//'.contact.vtu"/>'//newline
   end function case_entries

   !> Closes the collection; it still has its temporary name.
   subroutine collection_finish(self, file, error)
      class(collection_t), intent(inout) :: self !! the collection
      type(output_file_t), intent(out) :: file !! the finished file
      type(error_t), allocatable, intent(out) :: error !! not everything could be written

      ! allow(C181): the output file's own `finish` checks the state
      if (self%state == 0) write (self%file%unit, iostat=self%state) collection_tail
      call self%file%finish(self%state, error)
      file = self%file
   end subroutine collection_finish

   !> Removes what was written.
   subroutine collection_discard(self)
      class(collection_t), intent(inout) :: self !! the collection

      call self%file%discard()
   end subroutine collection_discard

end module amontons_collection
