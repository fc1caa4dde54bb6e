!> Two scalars or arrays to compare, flattened: one way of comparing then serves every type and shape.
module funit_pair
   use, intrinsic :: iso_fortran_env, only: real64
   use funit_exception, only: fail, SourceLocation
   use funit_text, only: list, to_text
   implicit none (type, external)
   private

   public :: new_pair, pair_t

   !> The expected and the actual values in array order. Integers become reals, which is exact.
   type :: pair_t
      real(real64), allocatable :: expected(:) !! as many as there are actual values
      real(real64), allocatable :: actual(:) !! the actual values
      integer, allocatable :: extents(:) !! shape of the actual values; empty: a scalar
      logical :: is_integer = .false. !! whether the values were integers
      character(:), allocatable :: defect !! allocated if the shapes do not fit; the values are then empty
   contains
      procedure :: judge => pair_judge
      procedure, private :: line => pair_line
      procedure, private :: set_defect => pair_set_defect
      procedure, private :: set_values => pair_set_values
   end type pair_t

   !> Makes a pair of two scalars, two arrays of one shape, or an expected scalar and an array.
   interface new_pair
      procedure :: new_integer_pair, new_real_pair
   end interface new_pair

contains

   !> Makes a pair of integers.
   subroutine new_integer_pair(pair, expected, actual)
      type(pair_t), intent(out) :: pair !! the pair
      integer, intent(in) :: expected(..) !! scalar, or of the shape of `actual`
      integer, intent(in) :: actual(..) !! scalar, rank 1 or rank 2

      pair%is_integer = .true.
      call pair%set_defect(shape(expected), shape(actual))
      call pair%set_values(real(integers(expected), real64), real(integers(actual), real64))
   end subroutine new_integer_pair

   !> Makes a pair of reals.
   subroutine new_real_pair(pair, expected, actual)
      type(pair_t), intent(out) :: pair !! the pair
      real(real64), intent(in) :: expected(..) !! scalar, or of the shape of `actual`
      real(real64), intent(in) :: actual(..) !! scalar, rank 1 or rank 2

      call pair%set_defect(shape(expected), shape(actual))
      call pair%set_values(reals(expected), reals(actual))
   end subroutine new_real_pair

   !> Integers of any shape in array order; none where the rank is too high.
   pure function integers(array) result(values)
      integer, intent(in) :: array(..) !! scalar, rank 1 or rank 2
      integer, allocatable :: values(:)

      select rank (array)
      rank (0)
         values = [array]
      rank (1)
         values = array
      rank (2)
         values = [array]
      rank default
         allocate (values(0))
      end select
   end function integers

   !> Reals of any shape in array order; none where the rank is too high.
   pure function reals(array) result(values)
      real(real64), intent(in) :: array(..) !! scalar, rank 1 or rank 2
      real(real64), allocatable :: values(:)

      select rank (array)
      rank (0)
         values = [array]
      rank (1)
         values = array
      rank (2)
         values = [array]
      rank default
         allocate (values(0))
      end select
   end function reals

   !> Says what is wrong with the shapes, if anything.
   subroutine pair_set_defect(self, expected, actual)
      class(pair_t), intent(inout) :: self !! the pair
      integer, intent(in) :: expected(:) !! shape of the expected values
      integer, intent(in) :: actual(:) !! shape of the actual values

      character(:), allocatable :: reason

      allocate (self%extents, source=actual)
      if (size(expected) == 0 .and. size(actual) <= 2) return
      if (size(actual) > 2) then
         reason = 'Rank outside the subset: compare shape(x) and [x].'
      else if (size(expected) /= size(actual)) then
         reason = 'Ranks outside the subset: both alike, or an expected scalar and an array.'
      else if (any(expected /= actual)) then
         reason = 'Arrays not conformable failure:'
      end if
      if (.not. allocated(reason)) return
      self%defect = reason//labeled('Expected shape', list(expected))//labeled('Actual shape', list(actual))
   end subroutine pair_set_defect

   !> Fills in the values, a single expected one as often as there are actual ones.
   subroutine pair_set_values(self, expected, actual)
      class(pair_t), intent(inout) :: self !! the pair; its defect is known
      real(real64), intent(in) :: expected(:) !! the expected values in array order
      real(real64), intent(in) :: actual(:) !! the actual values in array order

      if (allocated(self%defect)) then
         allocate (self%expected(0), self%actual(0))
      else if (size(expected) == 1) then
         self%expected = spread(expected(1), 1, size(actual))
         self%actual = actual
      else
         self%expected = expected
         self%actual = actual
      end if
   end subroutine pair_set_values

   !> Fails at the first place where the relation does not hold.
   subroutine pair_judge(self, holds, assertion, labels, tolerance, message, location)
      class(pair_t), intent(in) :: self !! the pair
      logical, intent(in) :: holds(:) !! whether the relation holds, for every place
      character(*), intent(in) :: assertion !! name of the assertion
      character(*), intent(in) :: labels(2) !! what to call the two values
      real(real64), intent(in), optional :: tolerance !! the tolerance of the relation
      character(*), intent(in), optional :: message !! the user's message
      type(SourceLocation), intent(in), optional :: location !! place of the assertion
      character(:), allocatable :: text
      integer :: place

      if (allocated(self%defect)) then
         call fail(self%defect, message, location)
         return
      end if
      place = findloc(holds, .false., dim=1)
      if (place == 0) return
      text = assertion//' failure:'//self%line(labels(1), self%expected(place))// &
         self%line(labels(2), self%actual(place))
      if (present(tolerance)) text = text//self%line('Difference', self%actual(place) - self%expected(place))// &
         ' (greater than tolerance of '//to_text(tolerance)//')'
      if (size(self%extents) > 0) text = text//labeled('at index', list(subscripts(place, self%extents)))
      call fail(text, message, location)
   end subroutine pair_judge

   !> A value on a line of its own, after its label.
   pure function pair_line(self, label, value) result(text)
      class(pair_t), intent(in) :: self !! the pair, which knows whether its values are integers
      character(*), intent(in) :: label !! what to call the value
      real(real64), intent(in) :: value !! the value
      character(:), allocatable :: text

      if (self%is_integer) then
         text = labeled(label, '<'//to_text(nint(value))//'>')
      else
         text = labeled(label, '<'//to_text(value)//'>')
      end if
   end function pair_line

   !> Text on a line of its own, after its label.
   pure function labeled(label, text) result(line)
      character(*), intent(in) :: label !! what to call it
      character(*), intent(in) :: text !! the text
      character(:), allocatable :: line

      line = new_line('a')//repeat(' ', max(0, 18 - len_trim(label)))//trim(label)//': '//text
   end function labeled

   !> Subscripts of a place, counted from 1.
   pure function subscripts(place, extents)
      integer, intent(in) :: place !! number of the place in array order
      integer, intent(in) :: extents(:) !! shape of the array
      integer :: subscripts(size(extents))
      integer :: axis, rest

      rest = place - 1
      do axis = 1, size(extents)
         subscripts(axis) = 1 + mod(rest, extents(axis))
         rest = rest/extents(axis)
      end do
   end function subscripts

end module funit_pair
