!> HDF5 files: whole data sets of integers, reals and texts, read and written by their paths.
!>
!> The only module that knows the HDF5 library; a build without that library leaves it out. The library writes into
!> memory only: HDF5 1.10 crashes at the end of a program that could not write a file.
module amontons_hdf5_file
   use, intrinsic :: iso_c_binding, only: c_loc, c_null_ptr, c_ptr
   use amontons_error, only: error_t, input_refused, new_error, system_failure
   use amontons_kinds, only: dp, int64
   use amontons_output_file, only: new_output_file, output_file_t
   use amontons_text, only: to_text
   use hdf5, only: h5dclose_f, h5dcreate_f, h5dget_space_f, h5dget_type_f, h5dopen_f, h5dread_f, h5dwrite_f, &
      h5eset_auto_f, h5f_acc_rdonly_f, h5f_acc_trunc_f, h5f_scope_local_f, h5fclose_f, h5fcreate_f, h5fflush_f, &
      h5fget_file_image_f, h5fget_filesize_f, h5fopen_f, h5gclose_f, h5gcreate_f, h5lexists_f, h5open_f, &
      h5p_file_access_f, h5pclose_f, h5pcreate_f, h5pset_fapl_core_f, h5s_scalar_f, h5sclose_f, h5screate_f, &
      h5screate_simple_f, &
      h5sget_simple_extent_npoints_f, h5t_float_f, h5t_integer_f, h5t_native_character, h5t_native_double, &
      h5t_native_integer, h5tclose_f, h5tcopy_f, h5tget_class_f, h5tget_size_f, h5tset_size_f, &
      hid_t, hsize_t, size_t
   implicit none (type, external)
   private

   public :: create_hdf5_file, hdf5_file_t, open_hdf5_file

   !> An open HDF5 file. The first fault stays with it, and nothing is read or written after it.
   type :: hdf5_file_t
      private
      character(:), allocatable :: name !! name of the file
      integer(hid_t) :: id = -1 !! the library's number of it
      type(error_t), allocatable, public :: error !! the first fault, once there is one
   contains
      procedure :: check_type => hdf5_file_check_type
      procedure, public :: close => hdf5_file_close
      procedure, public :: has => hdf5_file_has
      procedure, public :: make_group => hdf5_file_make_group
      procedure :: open_data => hdf5_file_open_data
      procedure :: create_data => hdf5_file_create_data
      procedure, public :: read_integers => hdf5_file_read_integers
      procedure, public :: read_reals => hdf5_file_read_reals
      procedure, public :: refuse => hdf5_file_refuse
      procedure, public :: save => hdf5_file_save
      procedure, public :: write_integers => hdf5_file_write_integers
      procedure, public :: write_reals => hdf5_file_write_reals
      procedure, public :: write_text => hdf5_file_write_text
   end type hdf5_file_t

contains

   !> Opens a file to read it.
   subroutine open_hdf5_file(file, name)
      type(hdf5_file_t), intent(out) :: file !! the file; its error is allocated where it cannot be opened
      character(*), intent(in) :: name !! name of the file
      integer :: status

      call start(file, name, status)
      if (status == 0) call h5fopen_f(name, h5f_acc_rdonly_f, file%id, status)
      if (status /= 0) call file%refuse('this HDF5 file is damaged or cut short')
   end subroutine open_hdf5_file

   !> Begins a file in memory.
   subroutine create_hdf5_file(file)
      type(hdf5_file_t), intent(out) :: file !! the file; its error is allocated where memory ran out
      integer(size_t), parameter :: increment = 65536
      integer(hid_t) :: access
      integer :: status

      call start(file, '', status)
      if (status == 0) call h5pcreate_f(h5p_file_access_f, access, status)
      if (status == 0) call h5pset_fapl_core_f(access, increment, .false., status)
      if (status == 0) call h5fcreate_f('in memory', h5f_acc_trunc_f, file%id, status, access_prp=access)
      if (status == 0) call h5pclose_f(access, status)
      call note_failure(file, status)
   end subroutine create_hdf5_file

   !> Starts the library, which stays silent about its faults: they are told here.
   subroutine start(file, name, status)
      type(hdf5_file_t), intent(inout) :: file !! gains its name
      character(*), intent(in) :: name !! name of the file
      integer, intent(out) :: status !! 0 where all is well

      file%name = name
      call h5open_f(status)
      if (status == 0) call h5eset_auto_f(0, status)
   end subroutine start

   !> Notes a fault of the file's contents, if it is the first.
   subroutine hdf5_file_refuse(self, sentence)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: sentence !! what is wrong

      if (.not. allocated(self%error)) call new_error(self%error, input_refused, self%name//': '//sentence)
   end subroutine hdf5_file_refuse

   !> Notes that memory ran out.
   subroutine note_failure(file, status)
      type(hdf5_file_t), intent(inout) :: file !! the file
      integer, intent(in) :: status !! status of the library, 0 where all is well

      ! not raised: what is written in memory fails only for want of some
      if (status /= 0 .and. .not. allocated(file%error)) call new_error(file%error, system_failure, &
         'memory ran out for an HDF5 file')
   end subroutine note_failure

   !> Closes the file.
   subroutine hdf5_file_close(self)
      class(hdf5_file_t), intent(inout) :: self !! the file
      integer :: status

      if (self%id < 0) return
      call h5fclose_f(self%id, status)
      self%id = -1
      call note_failure(self, status)
   end subroutine hdf5_file_close

   !> Puts a file from memory on the disk, under a temporary name beside the final one, and closes it.
   subroutine hdf5_file_save(self, file, path, error)
      class(hdf5_file_t), intent(inout) :: self !! the file in memory
      type(output_file_t), intent(out) :: file !! the finished file
      character(*), intent(in) :: path !! final name
      type(error_t), allocatable, intent(out) :: error !! the file cannot be written, or something did not get into it
      character, allocatable, target :: bytes(:)
      type(c_ptr) :: address
      integer(size_t) :: n_bytes
      integer :: status

      status = 0
      n_bytes = 0
      address = c_null_ptr
      if (self%id >= 0) call h5fflush_f(self%id, h5f_scope_local_f, status)
      if (self%id >= 0 .and. status == 0) call h5fget_file_image_f(self%id, address, 0_size_t, status, n_bytes)
      allocate (bytes(n_bytes))
      address = c_loc(bytes)
      if (self%id >= 0 .and. status == 0) call h5fget_file_image_f(self%id, address, n_bytes, status)
      call note_failure(self, status)
      call self%close()
      call move_alloc(self%error, error)
      if (allocated(error)) return
      call new_output_file(file, path, .true., error)
      if (allocated(error)) return
      write (file%unit, iostat=status) bytes
      call file%finish(status, error)
   end subroutine hdf5_file_save

   !> Whether the file has a group or data set of a path.
   function hdf5_file_has(self, path) result(has)
      class(hdf5_file_t), intent(in) :: self !! the file
      character(*), intent(in) :: path !! the path, such as '/fclib_local/W'
      logical :: has
      integer :: last, status

      has = .not. allocated(self%error)
      last = 1
      ! The library asks after one step of a path at a time.
      do while (has .and. last <= len(path))
         last = last + index(path(last + 1:)//'/', '/')
         call h5lexists_f(self%id, path(:last - 1), has, status)
         has = has .and. status == 0
      end do
   end function hdf5_file_has

   !> Opens a data set to read it.
   subroutine hdf5_file_open_data(self, path, id, n)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set
      integer(hid_t), intent(out) :: id !! the library's number of it
      integer, intent(out) :: n !! number of its values
      integer(hid_t) :: space
      integer(hsize_t) :: n_values, n_bytes
      integer :: status

      id = -1
      n = 0
      if (allocated(self%error)) return
      if (.not. self%has(path)) then
         call self%refuse('expected the data set '//path//', found none')
         return
      end if
      call h5dopen_f(self%id, path, id, status)
      if (status == 0) call h5dget_space_f(id, space, status)
      if (status == 0) call h5sget_simple_extent_npoints_f(space, n_values, status)
      if (status < 0) then
         call self%refuse(path//': expected a data set of numbers')
         return
      end if
      call h5sclose_f(space, status)
      ! A value takes a byte at the least, so that a damaged file cannot ask for all memory.
      call h5fget_filesize_f(self%id, n_bytes, status)
      if (n_values < 0 .or. n_values > min(n_bytes, int(huge(n), hsize_t))) then
         call self%refuse(path//' announces '//to_text(int(n_values, int64))//' values, more than the file can hold')
      else
         n = int(n_values)
      end if
   end subroutine hdf5_file_open_data

   !> Refuses a data set of another type.
   subroutine hdf5_file_check_type(self, path, id, classes, expected)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set
      integer(hid_t), intent(in) :: id !! the library's number of it
      integer, intent(in) :: classes(:) !! classes of the types that are right
      character(*), intent(in) :: expected !! what they are, for the message
      integer(hid_t) :: kind
      integer(size_t) :: n_bytes
      integer(size_t), parameter :: most_bytes = 16
      integer :: class, status

      if (allocated(self%error)) return
      call h5dget_type_f(id, kind, status)
      if (status == 0) call h5tget_class_f(kind, class, status)
      if (status == 0) call h5tget_size_f(kind, n_bytes, status)
      ! The library takes memory for numbers of any size.
      if (status /= 0 .or. n_bytes > most_bytes) class = -1
      call h5tclose_f(kind, status)
      if (.not. any(classes == class)) call self%refuse(path//': expected '//expected)
   end subroutine hdf5_file_check_type

   !> Reads a data set of integers.
   subroutine hdf5_file_read_integers(self, path, values)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set
      integer, allocatable, intent(out) :: values(:) !! its values
      integer(hid_t) :: id
      integer :: n, status

      call self%open_data(path, id, n)
      if (id >= 0) call self%check_type(path, id, [h5t_integer_f], 'integers')
      allocate (values(n), source=0)
      if (id < 0) return
      if (.not. allocated(self%error) .and. n > 0) then
         call h5dread_f(id, h5t_native_integer, values, int([n], hsize_t), status)
         if (status /= 0) call self%refuse(path//': this data set is damaged')
      end if
      call h5dclose_f(id, status)
   end subroutine hdf5_file_read_integers

   !> Reads a data set of reals; whole numbers will do.
   subroutine hdf5_file_read_reals(self, path, values)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set
      real(dp), allocatable, intent(out) :: values(:) !! its values
      integer(hid_t) :: id
      integer :: n, status

      call self%open_data(path, id, n)
      if (id >= 0) call self%check_type(path, id, [h5t_integer_f, h5t_float_f], 'numbers')
      allocate (values(n), source=0.0_dp)
      if (id < 0) return
      if (.not. allocated(self%error) .and. n > 0) then
         call h5dread_f(id, h5t_native_double, values, int([n], hsize_t), status)
         if (status /= 0) call self%refuse(path//': this data set is damaged')
      end if
      call h5dclose_f(id, status)
   end subroutine hdf5_file_read_reals

   !> Makes a group.
   subroutine hdf5_file_make_group(self, path)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the group, whose parent is there
      integer(hid_t) :: id
      integer :: status

      if (allocated(self%error)) return
      call h5gcreate_f(self%id, path, id, status)
      if (status == 0) call h5gclose_f(id, status)
      call note_failure(self, status)
   end subroutine hdf5_file_make_group

   !> Creates a data set of one dimension to write it.
   subroutine hdf5_file_create_data(self, path, kind, n, id, status)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set, whose group is there
      integer(hid_t), intent(in) :: kind !! type of its values
      integer, intent(in) :: n !! number of its values
      integer(hid_t), intent(out) :: id !! the library's number of it
      integer, intent(out) :: status !! 0 where all is well
      integer(hid_t) :: space
      integer :: closed

      id = -1
      status = 1
      if (allocated(self%error)) return
      call h5screate_simple_f(1, int([n], hsize_t), space, status)
      if (status == 0) call h5dcreate_f(self%id, path, kind, space, id, status)
      call h5sclose_f(space, closed)
   end subroutine hdf5_file_create_data

   !> Writes a data set of integers.
   subroutine hdf5_file_write_integers(self, path, values)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set, whose group is there
      integer, intent(in) :: values(:) !! its values
      integer(hid_t) :: id
      integer :: status

      call self%create_data(path, h5t_native_integer, size(values), id, status)
      if (status == 0 .and. size(values) > 0) call h5dwrite_f(id, h5t_native_integer, values, &
         int([size(values)], hsize_t), status)
      if (status == 0) call h5dclose_f(id, status)
      call note_failure(self, status)
   end subroutine hdf5_file_write_integers

   !> Writes a data set of reals.
   subroutine hdf5_file_write_reals(self, path, values)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set, whose group is there
      real(dp), intent(in) :: values(:) !! its values
      integer(hid_t) :: id
      integer :: status

      call self%create_data(path, h5t_native_double, size(values), id, status)
      if (status == 0 .and. size(values) > 0) call h5dwrite_f(id, h5t_native_double, values, &
         int([size(values)], hsize_t), status)
      if (status == 0) call h5dclose_f(id, status)
      call note_failure(self, status)
   end subroutine hdf5_file_write_reals

   !> Writes a text as a data set of its own.
   subroutine hdf5_file_write_text(self, path, text)
      class(hdf5_file_t), intent(inout) :: self !! the file
      character(*), intent(in) :: path !! path of the data set, whose group is there
      character(*), intent(in) :: text !! the text, not empty
      integer(hid_t) :: id, kind, space
      integer :: status

      if (allocated(self%error)) return
      call h5tcopy_f(h5t_native_character, kind, status)
      if (status == 0) call h5tset_size_f(kind, int(len(text), size_t), status)
      if (status == 0) call h5screate_f(h5s_scalar_f, space, status)
      if (status == 0) call h5dcreate_f(self%id, path, kind, space, id, status)
      if (status == 0) call h5dwrite_f(id, kind, text, int([1], hsize_t), status)
      if (status == 0) call h5dclose_f(id, status)
      if (status == 0) call h5sclose_f(space, status)
      if (status == 0) call h5tclose_f(kind, status)
      call note_failure(self, status)
   end subroutine hdf5_file_write_text

end module amontons_hdf5_file
