#!/usr/bin/env bash
# Solves every deck of a folder, one process each, as many at once as there are cores, with GNU parallel.
# Usage: batch_parallel.sh FOLDER OUTPUT [PROGRAM-OPTION...]
#   FOLDER    decks, *.nml
#   OUTPUT    where the result files go; what each run said and its exit status are OUTPUT/batch/DECK.log and .status
# A batch that was stopped goes on with the decks that have no status yet; remove OUTPUT/batch to begin anew. The exit
# status is the largest of all decks. Decks with one body are faster in one process, which shares the factorisation:
# amontons --output OUTPUT FOLDER/*.nml. The environment variable AMONTONS names another program than the release build.
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
command -v parallel >/dev/null || { echo 'batch_parallel.sh: GNU parallel is not installed' >&2; exit 3; }
shopt -s nullglob
decks=("$folder"/*.nml)
((${#decks[@]} > 0)) || { echo "batch_parallel.sh: no *.nml in $folder" >&2; exit 1; }

logs=$output/batch
mkdir -p "$logs"
status_of() { cat "$logs/$(basename "$1").status" 2>/dev/null; }
# shellcheck disable=SC2317 # called by parallel
run_deck() {
   local log status=0
   log=$logs/$(basename "$1")
   "$program" --threads 1 --output "$output" "${@:2}" "$1" &>"$log.log" || status=$?
   echo "$status" >"$log.status"
}
export program output logs
export -f run_deck
left=()
for deck in "${decks[@]}"; do
   status_of "$deck" >/dev/null || left+=("$deck")
done
((${#left[@]} == 0)) || printf '%s\0' "${left[@]}" | parallel --null --jobs 100% run_deck {} "${@@Q}"
worst=0
for deck in "${decks[@]}"; do
   status=$(status_of "$deck")
   ((status <= worst)) || worst=$status
done
exit "$worst"
