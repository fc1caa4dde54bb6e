!> A table of comma-separated fields, read from a file of the program: a header, then one row per line.
module amontons_csv_table
   use amontons_error, only: error_t
   use amontons_input_file, only: read_text_file
   use amontons_integer_list, only: integer_list_t
   use amontons_kinds, only: dp
   use amontons_text, only: newline, read_real, to_text
   implicit none (type, external)
   private

   public :: csv_table_t, read_csv_table

   !> A table. Only the header may have fields with commas.
   type :: csv_table_t
      private
      integer, public :: n_rows = 0 !! number of rows, the header not counted
      character(:), allocatable, public :: header !! its first line
      character(:), allocatable :: text !! the whole file
      type(integer_list_t) :: start !! where each row begins in it, and where the file ends (n_rows + 1)
   contains
      procedure, public :: field => csv_table_field
      procedure, public :: column => csv_table_column
      procedure, public :: get_number => csv_table_get_number
      procedure, public :: row => csv_table_row
   end type csv_table_t

contains

   !> Reads a table.
   subroutine read_csv_table(table, path, header, n_columns, fault)
      type(csv_table_t), intent(out) :: table !! the table
      character(*), intent(in) :: path !! name of the file
      character(*), intent(in), optional :: header !! the first line that it should have; default any
      integer, intent(in), optional :: n_columns !! number of fields of a row; default that of the first line
      character(:), allocatable, intent(out) :: fault !! why it is no such table; empty if it is
      type(error_t), allocatable :: error
      integer :: i, n_commas, n

      fault = ''
      table%header = ''
      call read_text_file(path, table%text, error)
      if (allocated(error)) then
         fault = error%message(len(path) + 3:)
      else if (len(table%text) == 0) then
         fault = 'it is empty'
      else if (table%text(len(table%text):) /= newline) then
         fault = 'the last line does not end'
      else
         table%header = table%text(:index(table%text, newline) - 1)
         if (present(header)) then
            if (table%header /= header) fault = 'the first line is not the header of this table'
         end if
      end if
      if (len(fault) > 0) return
      n = count_commas(table%header) + 1
      if (present(n_columns)) n = n_columns
      do i = len(table%header) + 1, len(table%text)
         if (table%text(i:i) == newline) call table%start%append(i + 1)
      end do
      table%n_rows = table%start%n - 1
      do i = 1, table%n_rows
         n_commas = count_commas(table%row(i))
         if (n_commas == n - 1) cycle
         fault = 'line '//to_text(i + 1)//' has '//to_text(n_commas + 1)//' fields, expected '//to_text(n)
         return
      end do
   end subroutine read_csv_table

   !> Number of commas in a text.
   pure integer function count_commas(text) result(n)
      character(*), intent(in) :: text !! the text
      integer :: i

      n = 0
      do i = 1, len(text)
         if (text(i:i) == ',') n = n + 1
      end do
   end function count_commas

   !> Number of the column with a given name; 0 if there is none. No name before it may contain a comma.
   pure integer function csv_table_column(self, name) result(column)
      class(csv_table_t), intent(in) :: self !! the table
      character(*), intent(in) :: name !! the name

      column = index(','//self%header//',', ','//name//',')
      if (column > 0) column = count_commas(self%header(:column - 1)) + 1
   end function csv_table_column

   !> The text of a row, without the end of its line.
   pure function csv_table_row(self, row) result(text)
      class(csv_table_t), intent(in) :: self !! the table
      integer, intent(in) :: row !! number of the row
      character(:), allocatable :: text

      text = self%text(self%start%item(row):self%start%item(row + 1) - 2)
   end function csv_table_row

   !> The text of a field.
   pure function csv_table_field(self, row, column) result(text)
      class(csv_table_t), intent(in) :: self !! the table
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      character(:), allocatable :: text
      integer :: first, i

      first = self%start%item(row)
      do i = 2, column
         first = first + index(self%text(first:), ',')
      end do
      text = self%text(first:first + scan(self%text(first:), ','//newline) - 2)
   end function csv_table_field

   !> A field as a number.
   pure subroutine csv_table_get_number(self, row, column, value, fault)
      class(csv_table_t), intent(in) :: self !! the table
      integer, intent(in) :: row !! its row
      integer, intent(in) :: column !! its column
      real(dp), intent(out) :: value !! the number, 0 if there is none
      character(:), allocatable, intent(inout) :: fault !! gains why it is no number, unless it has a fault already
      logical :: ok

      call read_real(self%field(row, column), value, ok)
      if (ok .or. len(fault) > 0) return
      fault = 'line '//to_text(row + 1)//', field '//to_text(column)//": expected a number, found '"// &
         self%field(row, column)//"'"
   end subroutine csv_table_get_number

end module amontons_csv_table
