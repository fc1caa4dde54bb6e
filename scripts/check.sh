#!/usr/bin/env bash
# Checks every rule of the code that a machine can check: one line per check, findings where there are any.
# Usage: check.sh [PRESET]    the preset that must compile without warnings, release unless given
# shellcheck disable=SC2317 # the functions are called through check
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

scripts/setup.sh build check
scripts/dev/tools.sh

mapfile -t fortran < <(find src tests -name '*.f90' -o -name '*.f90.in' -o -name '*.pf' | sort)
mapfile -t shell < <(grep -rlE '^#!.*\b(ba)?sh\b' .ci findings scripts tests | sort; echo doc/amontons.bash)

# Two things stay as the author put them: continuation lines, and a `!!` that hangs under its declaration.
findent_changes_nothing() {
   local file found=0
   for file in "${fortran[@]}"; do
      diff --unified --ignore-matching-lines '^ *!!' --label "$file" --label findent \
         "$file" <(.venv/bin/findent -ifree -i3 -c3 -k- <"$file") || found=1
   done
   return "$found"
}

ford_has_no_warnings() {
   local output
   python3 -B scripts/dev/ford_page.py >build/ford.md
   output=$(.venv/bin/python -m ford --no-search build/ford.md 2>&1) || { echo "$output"; return 1; }
   ! grep --after-context 2 '^Warning' <<<"$output"
}

# A linter is silenced only in place and for a reason: `! allow(RULE): REASON`, `# shellcheck disable=RULE # REASON`;
# a message that no test raises likewise.
waivers_have_reasons() {
   ! grep -rnE '! *allow\([^)]*\) *:? *$|! not raised:? *$|shellcheck disable=[[:upper:]0-9,]+ *$' .ci scripts src tests
}

status=0
mkdir -p build
check() {
   local name=$1 log=build/check.log
   shift
   if "$@" 2>&1 | scripts/helpers/progress.sh "$log" "$name"; then
      echo "ok    $name"
   else
      echo "FAIL  $name"
      cat "$log"
      status=1
   fi
}

if (($# == 0)); then
   check 'release build without warnings' scripts/build.sh release amontons_app amontons_c amontons_rates
else
   check "$1 build without warnings" scripts/build.sh "$1"
fi
check rooms scripts/dev/check_layers.py
check 'lengths, comments, no stop, no print' scripts/dev/check_sources.py
check 'every test is run and asks something' scripts/dev/check_tests.py
check fortitude .venv/bin/fortitude check --quiet --output-format concise src tests
check findent findent_changes_nothing
check 'FORD without warnings' ford_has_no_warnings
check 'links and names of the pages' scripts/dev/check_links.py
check 'sentences of the pages' scripts/dev/check_sentences.py
check 'mutants fit the sources' python3 -B scripts/dev/mutants.py --list
# Its other options ask for braces around every name and for a line of its own for every command.
optional=add-default-case,avoid-nullary-conditions,check-unassigned-uppercase,deprecate-which
check shellcheck shellcheck --enable="$optional,quote-safe-variables,require-double-brackets" "${shell[@]}"
check 'waivers with reasons' waivers_have_reasons
exit "$status"
