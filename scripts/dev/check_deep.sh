#!/usr/bin/env bash
# Everything that is too slow for every change, with a line for each: coverage, the tests under the sanitizers, as
# optimized code and without SuiteSparse, spoiled input, valgrind, whether a build can be repeated, and whether the
# tests notice small changes of the sources.
# shellcheck disable=SC2317 # the function is called through check
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."

scripts/setup.sh build test deep

run_tests() { # preset
   scripts/build.sh "$1" && ctest --preset "$1" --parallel 2 --no-tests=error
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
check bsd run_tests bsd
check sanitize run_tests sanitize
check coverage scripts/dev/coverage.sh
check fuzz scripts/fuzz.sh
check valgrind scripts/dev/valgrind.sh
check reproducible scripts/dev/reproducible.sh
check mutants scripts/mutants.sh
exit "$status"
