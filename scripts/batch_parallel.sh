#!/usr/bin/env bash
# Solves every deck of a folder, one process each, as many at once as there are cores, with GNU parallel.
# Usage: batch_parallel.sh FOLDER OUTPUT [PROGRAM-OPTION...]
#   FOLDER    decks, *.nml
#   OUTPUT    where the result files go, and what each run said: OUTPUT/batch/DECK.log; OUTPUT/batch/jobs.tsv has
#             start, seconds and exit status of each run
# A run that was stopped goes on with the decks that are not in jobs.tsv; remove OUTPUT/batch to begin anew. The exit
# status is the largest of all decks. Decks with one body are faster in one process, which shares the factorisation:
# amontons --output OUTPUT FOLDER/*.nml. The environment variable AMONTONS names another program than the release build.
set -euo pipefail

if (($# < 2)); then
   echo 'usage: batch_parallel.sh FOLDER OUTPUT [PROGRAM-OPTION...]' >&2
   exit 1
fi
folder=$1
output=$2
shift 2
program=${AMONTONS:-$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../build/release/bin/amontons}
command -v parallel >/dev/null || { echo 'batch_parallel.sh: GNU parallel is not installed' >&2; exit 3; }
shopt -s nullglob
decks=("$folder"/*.nml)
((${#decks[@]} > 0)) || { echo "batch_parallel.sh: no *.nml in $folder" >&2; exit 1; }

logs=$output/batch
mkdir -p "$logs"
run_deck() {
   "$program" --threads 1 --output "$output" "${@:2}" "$1" &>"$logs/$(basename "$1").log"
}
export program output logs
export -f run_deck
# parallel's own status counts failures; jobs.tsv has the status of each run.
parallel --resume --joblog "$logs/jobs.tsv" --jobs 100% run_deck {} "${@@Q}" ::: "${decks[@]}" || true
awk -F '\t' 'NR > 1 { if ($7 > worst) worst = $7; if ($8 > 0) worst = 3 } END { exit worst }' "$logs/jobs.tsv"
