!> Reduced problems from arrays: `u = W r + q` with a full W.
module amontons_dense_system
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use amontons_error, only: error_t, input_refused, new_error
   use amontons_kinds, only: dp
   use amontons_reduced_system, only: entries_t, new_reduced_system, reduced_system_t
   use amontons_text, only: to_text
   implicit none (type, external)
   private

   public :: new_dense_system

contains

   !> Makes a reduced problem from arrays. The unknowns of a contact stand together, the normal one first.
   pure subroutine new_dense_system(system, w, q, friction, error)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      real(dp), intent(in) :: w(:, :) !! W, symmetric and positive semidefinite (2m, 2m) [L/F]
      real(dp), intent(in) :: q(:) !! u without forces (2m) [L]
      real(dp), intent(in) :: friction(:) !! mu, at least 0 (m) [-]
      type(error_t), allocatable, intent(out) :: error !! sizes or numbers that cannot be
      type(entries_t) :: entries
      character(:), allocatable :: sentence
      integer :: i, j, k, place

      if (any([shape(w), size(q)] /= 2*size(friction))) then
         call new_error(error, input_refused, 'expected W of '//to_text(2*size(friction))//' rows and columns and '// &
            'as many numbers q for the '//to_text(size(friction))//' contacts of mu, found W of '// &
            to_text(size(w, 1))//' x '//to_text(size(w, 2))//' and '//to_text(size(q))//' numbers q')
         return
      end if
      call check_numbers(w, q, friction, error)
      if (allocated(error)) return
      entries%n = count(abs(w) > 0.0_dp)
      allocate (entries%row(entries%n), entries%column(entries%n), entries%value(entries%n))
      k = 0
      do j = 1, size(w, 2)
         do i = 1, size(w, 1)
            if (.not. abs(w(i, j)) > 0.0_dp) cycle
            k = k + 1
            entries%row(k) = i
            entries%column(k) = j
            entries%value(k) = w(i, j)
         end do
      end do
      entries%place = spread(0, 1, entries%n)
      call new_reduced_system(system, entries, q, friction, sentence, place)
      if (allocated(sentence)) call new_error(error, input_refused, sentence)
      system%form = 'arrays'
   end subroutine new_dense_system

   !> Refuses numbers that are not finite, and negative friction.
   pure subroutine check_numbers(w, q, friction, error)
      real(dp), intent(in) :: w(:, :) !! W (2m, 2m) [L/F]
      real(dp), intent(in) :: q(:) !! u without forces (2m) [L]
      real(dp), intent(in) :: friction(:) !! mu (m) [-]
      type(error_t), allocatable, intent(out) :: error !! which number it is
      integer :: place(2)

      place = findloc(ieee_is_finite(w), .false.)
      if (all(place > 0)) then
         call refuse('W('//to_text(place(1))//', '//to_text(place(2))//')', w(place(1), place(2)), 'a finite number', &
            error)
         return
      end if
      place = findloc(ieee_is_finite(q), .false., dim=1)
      if (place(1) > 0) then
         call refuse('q('//to_text(place(1))//')', q(place(1)), 'a finite number', error)
         return
      end if
      place = findloc(ieee_is_finite(friction) .and. friction >= 0.0_dp, .false., dim=1)
      if (place(1) > 0) call refuse('mu('//to_text(place(1))//')', friction(place(1)), 'a finite number, at least 0', &
         error)
   end subroutine check_numbers

   !> Names a number and what was expected in its place.
   pure subroutine refuse(name, value, expected, error)
      character(*), intent(in) :: name !! the number's name, counted from 1
      real(dp), intent(in) :: value !! the number
      character(*), intent(in) :: expected !! what was expected
      type(error_t), allocatable, intent(out) :: error !! says so

      call new_error(error, input_refused, name//' = '//to_text(value)//': expected '//expected)
   end subroutine refuse

end module amontons_dense_system
