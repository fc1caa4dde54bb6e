#!/usr/bin/env bash
# gfortran 12.2, namelist input: a text where a number is expected, in the last group of a file, with its slash in the
# next line. Expected: a positive iostat, as for every other error. Seen: -1, "End of file", which is also what a file
# without this group gives. A program that takes -1 for "the group is absent" goes on with its defaults.
# shellcheck source=SCRIPTDIR/helpers/finding.sh
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/helpers/finding.sh"
need gfortran-12=12.2.0-14+deb12u1

cat >main.f90 <<'SOURCE'
program main
   implicit none
   character, parameter :: nl = new_line('a')

   call read_it("&other a = 1 /"//nl)
   call read_it("&material young = 'steel' /"//nl)
   call read_it("&material young = 'steel'"//nl//"/"//nl)
contains
   subroutine read_it(text)
      character(*), intent(in) :: text
      integer :: unit, status
      real :: young
      namelist /material/ young

      open (newunit=unit, file='deck', access='stream', status='replace')
      write (unit) text
      close (unit)
      open (newunit=unit, file='deck', status='old', action='read')
      read (unit, nml=material, iostat=status)
      close (unit, status='delete')
      print '(i0)', status
   end subroutine read_it
end program main
SOURCE
gfortran-12 main.f90 -o main
./main | seen -1 5010 -1
