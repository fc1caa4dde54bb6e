#!/usr/bin/env bash
# Solves every deck of a folder, one process each, as many at once as there are cores, with GNU parallel.
# Usage: batch_parallel.sh [--jobs N] FOLDER OUTPUT [PROGRAM-OPTION...]
#   --jobs N  N decks at once in the place of one for each core
#   FOLDER    decks, *.nml
#   OUTPUT    where the result files go; batch.csv has a row for each deck, batch/DECK.log what its run printed
# Decks whose results are there already, from the same deck, mesh, tables and version of the program, are not solved
# again; a deck that was changed or that failed is. At the end the failures are printed, and how many decks were solved.
# The exit status is the largest of all decks. Decks with one body are faster in one process, which shares the
# factorization: amontons --output OUTPUT FOLDER/*.nml. AMONTONS names another program than the release build.
set -euo pipefail

jobs=100%
if [[ ${1-} == --jobs ]]; then
   jobs=${2-}
   shift $(($# > 1 ? 2 : 1))
   if [[ ! $jobs =~ ^[1-9][0-9]*$ ]]; then
      echo "batch_parallel.sh: --jobs: expected a whole number, at least 1, found '$jobs'" >&2
      exit 1
   fi
fi
if (($# < 2)); then
   echo 'usage: batch_parallel.sh [--jobs N] FOLDER OUTPUT [PROGRAM-OPTION...]' >&2
   exit 1
fi
# A name that begins with a dash would be taken for an option.
folder=$1 output=$2
[[ $folder != -* ]] || folder=./$folder
[[ $output != -* ]] || output=./$output
shift 2
program=${AMONTONS:-$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../build/release/bin/amontons}
command -v parallel >/dev/null || { echo 'batch_parallel.sh: GNU parallel is missing (Debian: parallel)' >&2; exit 3; }
[[ -x $program ]] || { echo "batch_parallel.sh: no program $program; build it, or set AMONTONS" >&2; exit 3; }
[[ -d $folder ]] || { echo "batch_parallel.sh: $folder: not a folder" >&2; exit 1; }
shopt -s nullglob
decks=("$folder"/*.nml)
((${#decks[@]} > 0)) || { echo "batch_parallel.sh: no *.nml in $folder" >&2; exit 1; }

logs=$output/batch
mkdir -p "$logs"
rm -f "$logs"/*.status
# shellcheck disable=SC2317 # called by parallel
run_deck() {
   local log status=0
   log=$logs/$(basename "$1")
   "$program" --threads 1 --skip-unchanged --output "$output" "${@:2}" "$1" >"$log.log" 2>"$log.error" || status=$?
   cat "$log.error" >&2
   cat "$log.error" >>"$log.log"
   rm "$log.error"
   echo "$status" >"$log.status"
}
export program output logs
export -f run_deck
# Ctrl-C ends the programs; the tally is printed all the same.
trap : INT
printf '%s\0' "${decks[@]}" | parallel --null --jobs "$jobs" run_deck {} "${@@Q}" || true

# Prints the outcomes of decks, a line each, from a table whose first fields are deck, case and outcome. GNU parallel
# brings Perl along.
# shellcheck disable=SC2016 # the program is Perl's
outcomes=$(perl -e 'open my $table, "<", shift;
   while (<$table>) {
      my ($deck, $case, $outcome) = /\G("(?:[^"]|"")*"|[^,]*),/g;
      $deck =~ s/^"(.*)"$/$1/ and $deck =~ s/""/"/g;
      $outcomes{$deck} = $outcome;
   }
   print "$outcomes{$_}\n" for @ARGV' "$output/batch.csv" "${decks[@]//$'\n'/; }")
mapfile -t outcomes <<<"$outcomes"

order=(solved unchanged no_equilibrium not_converged not_certified refused numerical_failure system_failure replaced
   interrupted)
declare -A counts=() labels=([no_equilibrium]='without equilibrium' [not_converged]='not converged'
   [not_certified]='not certified' [numerical_failure]='failed numerically' [system_failure]='failed'
   [replaced]='replaced by another deck of the same case name')
worst=0
for i in "${!decks[@]}"; do
   log=$logs/$(basename "${decks[i]}")
   status=$(cat "$log.status" 2>/dev/null || echo 5)
   # The row of a deck goes where another deck of its case name writes over its files.
   outcome=${outcomes[i]:-replaced}
   ((status != 5)) || outcome=interrupted
   ((status <= 5)) || status=3 outcome=system_failure
   ((status <= worst)) || worst=$status
   ! grep -qs ': unchanged, not solved again$' "$log.log" || outcome=unchanged
   counts[$outcome]=$((${counts[$outcome]:-0} + 1))
done
tally=
for outcome in "${order[@]}"; do
   [[ -z ${counts[$outcome]:-} ]] || tally+=", ${counts[$outcome]} ${labels[$outcome]:-$outcome}"
done
echo "${#decks[@]} decks: ${tally#, }"
exit "$worst"
