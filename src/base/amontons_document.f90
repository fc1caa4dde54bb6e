!> A text file of a result as the parts that it is written in. `--verify` makes the same parts from what the other files
!> hold and compares: a part states what follows from those, unless it is a record of the run that wrote it.
module amontons_document
   use amontons_kinds, only: dp
   implicit none (type, external)
   private

   public :: document_t, part_t

   !> A part of a text: whole lines.
   type :: part_t
      character(:), allocatable :: text !! the lines, with their ends
      real(dp), allocatable :: scales(:)
         !! what the first, second ... number of a line is measured by besides itself; the last one holds for the rest
      logical :: is_recorded = .false. !! whether only the run that wrote it knows it
   end type part_t

   !> A text file.
   type :: document_t
      character(:), allocatable :: ending !! what its name ends with, behind the name of the case
      integer :: n = 0 !! number of its parts
      type(part_t), allocatable :: parts(:) !! the parts, and room for more
   contains
      procedure :: add => document_add
      procedure :: append => document_append
      procedure :: record => document_record
      procedure :: text => document_text
   end type document_t

contains

   !> Appends what follows from deck, mesh, displacements, contact forces and statuses.
   pure subroutine document_add(self, text, scales)
      class(document_t), intent(inout) :: self !! the document
      character(*), intent(in) :: text !! whole lines
      real(dp), intent(in), optional :: scales(:)
         !! what the first, second ... number of a line is measured by besides itself, the last for the rest; default 0

      if (len(text) == 0) return
      call append(self, text, .false.)
      self%parts(self%n)%scales = [0.0_dp]
      if (present(scales)) self%parts(self%n)%scales = scales
   end subroutine document_add

   !> Appends what only the run that solved the case knows: iterations, times.
   pure subroutine document_record(self, text)
      class(document_t), intent(inout) :: self !! the document
      character(*), intent(in) :: text !! whole lines

      call append(self, text, .true.)
   end subroutine document_record

   !> Appends the parts of another document.
   pure subroutine document_append(self, other)
      class(document_t), intent(inout) :: self !! the document
      type(document_t), intent(in) :: other !! the other one
      integer :: i

      do i = 1, other%n
         call append(self, other%parts(i)%text, other%parts(i)%is_recorded)
         if (allocated(other%parts(i)%scales)) self%parts(self%n)%scales = other%parts(i)%scales
      end do
   end subroutine document_append

   !> Appends a part.
   pure subroutine append(document, text, is_recorded)
      class(document_t), intent(inout) :: document !! the document
      character(*), intent(in) :: text !! its lines
      logical, intent(in) :: is_recorded !! whether only the run that wrote it knows it

      if (.not. allocated(document%parts)) allocate (document%parts(16))
      if (document%n == size(document%parts)) document%parts = [document%parts, document%parts]
      document%n = document%n + 1
      document%parts(document%n)%text = text
      document%parts(document%n)%is_recorded = is_recorded
   end subroutine append

   !> The whole text.
   pure function document_text(self) result(text)
      class(document_t), intent(in) :: self !! the document
      character(:), allocatable :: text
      integer :: i, length

      length = 0
      do i = 1, self%n
         length = length + len(self%parts(i)%text)
      end do
      allocate (character(length) :: text)
      length = 0
      do i = 1, self%n
         associate (part => self%parts(i)%text)
            text(length + 1:length + len(part)) = part
            length = length + len(part)
         end associate
      end do
   end function document_text

end module amontons_document
