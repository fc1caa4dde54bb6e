#!/usr/bin/env bash
# gfortran 12.2: what a full disk refuses. Expected: a status other than 0 from write, flush or close at the latest.
# Seen: 0 from all of them; the numbers are lost without a word. The file of the system that is always full shows it.
# shellcheck source=SCRIPTDIR/helpers/finding.sh
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/helpers/finding.sh"
need gfortran-12=12.2.0-14+deb12u1

cat >main.f90 <<'SOURCE'
program main
   implicit none
   integer :: unit, status(4)

   open (newunit=unit, file='/dev/full', action='write', iostat=status(1))
   write (unit, '(a)', iostat=status(2)) repeat('1.0 ', 100000)
   flush (unit, iostat=status(3))
   close (unit, iostat=status(4))
   print '(*(i0, 1x))', status
end program main
SOURCE
gfortran-12 main.f90 -o main
./main | seen '0 0 0 0'
