#!/usr/bin/env bash
# Runs the program and some of the unit tests under valgrind's memcheck: every read of what was never written, every
# access outside of an allocation and every block that is lost is an error. Nothing is suppressed.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."

scripts/setup.sh build deep
scripts/build.sh debug
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
program=$PWD/build/debug/bin/amontons
memcheck=(valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=definite
   --errors-for-leak-kinds=definite)
status=0

# Runs a command under memcheck; its own exit status must be the expected one.
check() { # expected status, command...
   local expected=$1 found=0 words
   shift
   words=${*##*/}
   "${memcheck[@]}" "$@" &>"$work/log" || found=$?
   if ((found == expected)); then
      echo "ok    ${words::100}"
   else
      printf 'FAIL  %s: exit status %d\n' "$*" "$found"
      cat "$work/log"
      status=1
   fi
}

export OMP_NUM_THREADS=2
cat >"$work/sweep.nml" <<'DECK'
&mesh size = 4.0, 2.0  cells = 8, 4 /
&material young = 100.0  poisson = 0.25 /
&support set = 'left'  ux = 0.0  uy = 0.0 /
&load set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.3 /
&sweep friction_factor = 0.5, 1.0 /
&solver factorization = 'multifrontal' /
DECK
grep -v '^&sweep' "$work/sweep.nml" >"$work/held.nml"
check 0 "$program" --output "$work" --write-reduced --all-solutions "$work/held.nml"
check 0 "$program" --output "$work" "$work/sweep.nml"
for method in newton splitting fixed_point psor lemke; do
   sed "s|^&solver|& method = '$method'  max_iterations = 100000|" "$work/held.nml" >"$work/$method.nml"
   check 0 "$program" --output "$work" "$work/$method.nml"
done
for problem in "$work"/held.reduced.*; do
   check 0 "$program" --output "$work" --reduced "$problem"
done
check 0 "$program" --output "$work" input/hertz.nml input/long_bar_1.nml
check 1 "$program" --output "$work" tests/bad/*.nml
check 1 "$program" --output "$work" --reduced tests/reduced/bad/*
for test in base/base deck/deck mesh/mesh_file study/reduced binding/binding; do
   # Each test writes where ctest lets it write.
   folder=build/debug/tests/$test.run
   [[ -d $folder ]] || folder=build/debug/tests/${test%/*}
   cd "$folder"
   check 0 "$OLDPWD/build/debug/tests/$test"
   cd "$OLDPWD"
done
exit "$status"
