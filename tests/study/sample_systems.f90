!> Reduced problems for the tests of this folder.
module sample_systems
   use amontons_kinds, only: dp
   use amontons_reduced_system, only: entries_t, new_reduced_system, reduced_system_t
   implicit none (type, external)
   private

   public :: full_matrix, one_contact, system_of, three_solutions, two_contacts, two_contacts_matrix

   !> W of two contacts.
   real(dp), parameter :: two_contacts_matrix(4, 4) = reshape([2.0_dp, 0.5_dp, 0.5_dp, 0.0_dp, &
      0.5_dp, 3.0_dp, 0.0_dp, 0.25_dp, 0.5_dp, 0.0_dp, 2.0_dp, -0.5_dp, 0.0_dp, 0.25_dp, -0.5_dp, 3.0_dp], [4, 4])

contains

   !> The reduced problem of a full matrix, or what is wrong with it. The place of an entry is 10 row + column.
   subroutine system_of(system, w, q, friction, sentence, place)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      real(dp), intent(in) :: w(:, :) !! W (2m, 2m)
      real(dp), intent(in) :: q(:) !! q (2m)
      real(dp), intent(in) :: friction(:) !! mu (m)
      character(:), allocatable, intent(out) :: sentence !! what is wrong; not allocated where nothing is
      integer, intent(out) :: place !! the place of the entry that it is about
      type(entries_t) :: entries
      integer :: i, j

      allocate (entries%row(0), entries%column(0), entries%place(0), entries%value(0))
      do j = 1, size(w, 2)
         do i = 1, size(w, 1)
            if (abs(w(i, j)) > 0.0_dp) call entries%append(i, j, w(i, j), 10*i + j)
         end do
      end do
      call new_reduced_system(system, entries, q, friction, sentence, place)
      system%form = 'by hand'
   end subroutine system_of

   !> Two contacts: the first sticks, the second slides backwards.
   subroutine two_contacts(system)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      character(:), allocatable :: sentence
      integer :: place

      call system_of(system, two_contacts_matrix, [-1.0_dp, -0.5_dp, -2.0_dp, -4.0_dp], [0.75_dp, 0.5_dp], &
         sentence, place)
   end subroutine two_contacts

   !> One contact without coupling: W = diag(2, 4) times a compliance, q = (-6, 8) times a length, mu = 1/2. The
   !> solution is r = (3, -1.5) and u = (0, 2) in these units.
   subroutine one_contact(system, compliance, length)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      real(dp), intent(in) :: compliance !! unit of W
      real(dp), intent(in) :: length !! unit of q
      character(:), allocatable :: sentence
      integer :: place

      call system_of(system, compliance*reshape([2.0_dp, 0.0_dp, 0.0_dp, 4.0_dp], [2, 2]), length*[-6.0_dp, 8.0_dp], &
         [0.5_dp], sentence, place)
   end subroutine one_contact

   !> One contact with three solutions: W = [1 -0.8; -0.8 1] times a compliance, q = (0.1, -0.5) times a length,
   !> mu = 1.5.
   subroutine three_solutions(system, compliance, length, skew)
      type(reduced_system_t), intent(out) :: system !! the reduced problem
      real(dp), intent(in) :: compliance !! unit of W
      real(dp), intent(in) :: length !! unit of q
      real(dp), intent(in) :: skew !! what W_TN has more than W_NT, in units of W
      character(:), allocatable :: sentence
      integer :: place

      call system_of(system, compliance*reshape([1.0_dp, -0.8_dp + skew, -0.8_dp, 1.0_dp], [2, 2]), &
         length*[0.1_dp, -0.5_dp], [1.5_dp], sentence, place)
   end subroutine three_solutions

   !> W in full.
   pure function full_matrix(system) result(w)
      type(reduced_system_t), intent(in) :: system !! the reduced problem
      real(dp) :: w(2*system%n_contacts, 2*system%n_contacts)
      integer :: j

      w = 0.0_dp
      do j = 1, size(w, 2)
         associate (first => system%first(j), last => system%first(j + 1) - 1)
            w(system%row(first:last), j) = system%entry(first:last)
         end associate
      end do
   end function full_matrix

end module sample_systems
