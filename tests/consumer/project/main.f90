!> A program outside of the project that uses the library.
program consumer
   use amontons_version, only: version
   implicit none (type, external)

   print '(a)', 'Amontons '//version
end program consumer
