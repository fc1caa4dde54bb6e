!> The kinds of Cholesky factorization that this build has.
module sample_kinds
   use amontons_suitesparse, only: has_suitesparse
   implicit none (type, external)
   private

   public :: kinds

   !> Their words in a deck; without SuiteSparse there is no `sparse`.
   character(12), parameter :: kinds(*) = pack([character(12) :: 'band', 'multifrontal', 'sparse'], &
      [.true., .true., has_suitesparse])

end module sample_kinds
