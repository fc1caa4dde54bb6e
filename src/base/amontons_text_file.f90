!> Whole files read into memory, byte by byte as they are.
module amontons_text_file
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: read_text_file

   !> A larger file is refused before it fills the memory [MB].
   integer, parameter :: largest_megabytes = 256

contains

   !> Reads a file as it is, without the mark some editors put before UTF-8 text; pipes work as well.
   subroutine read_text_file(file, text, error)
      character(*), intent(in) :: file !! name of the file
      character(:), allocatable, intent(out) :: text !! every byte of it
      type(error_t), allocatable, intent(out) :: error !! the file cannot be read, is empty or is too large
      character(*), parameter :: byte_order_mark = char(239)//char(187)//char(191)
      character(256) :: reason
      integer :: unit, status, at_cause

      reason = ''
      open (newunit=unit, file=file, status='old', action='read', access='stream', form='unformatted', &
         iostat=status, iomsg=reason)
      at_cause = index(reason, "': ", back=.true.)
      if (at_cause > 0) reason = reason(at_cause + 3:)
      if (status == 0) then
         call read_bytes(unit, text, status, reason)
         close (unit)
      end if
      if (status /= 0) then
         call new_error(error, input_refused, file//': cannot read this file: '//trim(reason))
      else if (len(text) == 0) then
         call new_error(error, input_refused, file//': this file is empty')
      else if (index(text, byte_order_mark) == 1) then
         text = text(4:)
      end if
   end subroutine read_text_file

   !> Reads every byte of an open file, whose size need not be known.
   subroutine read_bytes(unit, text, status, reason)
      integer, intent(in) :: unit !! the open file, at its beginning
      character(:), allocatable, intent(out) :: text !! every byte of it
      integer, intent(out) :: status !! 0 where all is well
      character(256), intent(inout) :: reason !! what went wrong otherwise
      integer, parameter :: first_length = 65536
      character(:), allocatable :: longer
      integer :: n_read, position

      allocate (character(first_length) :: text)
      n_read = 0
      do
         read (unit, iostat=status, iomsg=reason) text(n_read + 1:)
         inquire (unit=unit, pos=position)
         n_read = position - 1
         if (status /= 0) exit
         if (n_read > largest_megabytes*1000000) then
            reason = 'it is larger than '//to_text(largest_megabytes)//' MB'
            status = 1
            return
         end if
         allocate (character(2*n_read) :: longer)
         longer(:n_read) = text
         call move_alloc(longer, text)
      end do
      if (is_iostat_end(status)) status = 0
      text = text(:n_read)
   end subroutine read_bytes

end module amontons_text_file
