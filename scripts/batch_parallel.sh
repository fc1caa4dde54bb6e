#!/usr/bin/env bash
# Solves every deck of a folder, one process each, as many at once as there are cores, with GNU parallel.
# Usage: batch_parallel.sh FOLDER OUTPUT [PROGRAM-OPTION...]
#   FOLDER    decks, *.nml
#   OUTPUT    where the result files go; batch.csv has a row for each deck, batch/DECK.log what its run printed
# Decks whose results are there already, from the same deck, mesh, tables and version of the program, are not solved
# again; a deck that was changed or that failed is. At the end the failures are printed, and how many decks were solved.
# The exit status is the largest of all decks. Decks with one body are faster in one process, which shares the
# factorization: amontons --output OUTPUT FOLDER/*.nml. AMONTONS names another program than the release build.
set -euo pipefail

if (($# < 2)); then
   echo 'usage: batch_parallel.sh FOLDER OUTPUT [PROGRAM-OPTION...]' >&2
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
printf '%s\0' "${decks[@]}" | parallel --null --jobs 100% run_deck {} "${@@Q}"

counts=(0 0 0 0 0 0) worst=0 skipped=0
labels=('solved' 'refused' 'without equilibrium or failed numerically' 'failed' 'not converged or not certified'
   'interrupted')
for deck in "${decks[@]}"; do
   log=$logs/$(basename "$deck")
   status=$(cat "$log.status" 2>/dev/null || echo 5)
   ((status <= 5)) || status=3
   ((status <= worst)) || worst=$status
   if grep -qs ': unchanged, not solved again$' "$log.log"; then
      skipped=$((skipped + 1))
   else
      counts[status]=$((counts[status] + 1))
   fi
done
tally=
for status in "${!counts[@]}"; do
   ((counts[status] == 0)) || tally+=", ${counts[status]} ${labels[status]}"
   ((status != 0 || skipped == 0)) || tally+=", $skipped unchanged"
done
echo "${#decks[@]} decks: ${tally#, }"
exit "$worst"
