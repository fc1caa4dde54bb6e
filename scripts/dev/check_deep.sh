#!/usr/bin/env bash
# Everything that is too slow for every change, with a line for each: coverage, the tests under the sanitizers, as
# optimized code, with every set of kernels of the BLAS and without SuiteSparse, spoiled input, valgrind, whether a
# build can be repeated, and whether the tests notice small changes of the sources.
# shellcheck disable=SC2317 # the function is called through check
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."

scripts/setup.sh build test deep

run_tests() { # preset
   scripts/build.sh "$1" && ctest --preset "$1" --parallel 2 --no-tests=error
}

# Unit and program tests of the optimized code with every set of kernels of OpenBLAS that the processor can run, and
# with the reference BLAS: they round differently, and no verdict may depend on it.
run_tests_of_kernels() {
   local kernels directory failed=0
   for kernels in $(runnable_kernels); do
      echo "kernels $kernels"
      OPENBLAS_CORETYPE=$kernels ctest --preset release --parallel 2 --no-tests=error --label-regex '^(unit|program)$' \
         --exclude-regex '^program_kernels$' || failed=1
   done
   directory=$(reference_blas) || return 1
   echo "reference BLAS in $directory"
   LD_LIBRARY_PATH=$directory ctest --preset release --parallel 2 --no-tests=error --label-regex '^(unit|program)$' \
      --exclude-regex '^program_kernels$' || failed=1
   return "$failed"
}

# The sets of kernels for what /proc/cpuinfo says that the processor has.
runnable_kernels() {
   local has
   has=" $(sed -n '/^flags/{s/.*: //p;q}' /proc/cpuinfo) "
   echo Prescott Nehalem
   [[ $has != *' avx '* ]] || echo Sandybridge
   [[ $has != *' avx2 '* || $has != *' fma '* ]] || echo Haswell Zen
   [[ $has != *' avx512f '* || $has != *' avx512dq '* ]] || echo SkylakeX
}

# Unpacks Debian's reference BLAS and LAPACK beside the build, without installing them; prints their folder.
reference_blas() {
   local folder=$PWD/build/reference_blas
   mkdir -p "$folder"
   (cd "$folder" && apt-get download --quiet=2 libblas3 liblapack3 && for package in *.deb; do
      dpkg-deb --extract "$package" .
   done) >&2 || return 1
   # One folder on the search path; the program names OpenBLAS itself.
   ln -sf "$folder"/usr/lib/*/blas/libblas.so.3 "$folder"/usr/lib/*/lapack/liblapack.so.3 "$folder"
   ln -sf "$folder"/usr/lib/*/blas/libblas.so.3 "$folder/libopenblas.so.0"
   echo "$folder"
}

status=0
mkdir -p build
check() { # name, command...
   local log=build/deep_$1.log
   echo "begun $1: $log"
   if "${@:2}" &>"$log"; then
      echo "ok    $1"
   else
      echo "FAIL  $1"
      status=1
   fi
}

check release run_tests release
check kernels run_tests_of_kernels
check bsd run_tests bsd
check sanitize run_tests sanitize
check coverage scripts/dev/coverage.sh
check fuzz scripts/fuzz.sh
check valgrind scripts/dev/valgrind.sh
check reproducible scripts/dev/reproducible.sh
check mutants scripts/mutants.sh
exit "$status"
