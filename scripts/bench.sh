#!/usr/bin/env bash
# Measures the program on the long bar, alone and beside GetFEM, CalculiX and Siconos where their Debian packages are
# installed (scripts/setup.sh peers installs them), and prints Markdown tables. felupe is measured in an environment of
# its own: python3 -m venv build/felupe && build/felupe/bin/pip install felupe==11.3.0
# Usage: bench.sh [--ranks] [--full] [--update]
#   --ranks     instead: over 1 to 16 ranks of MPI
#   --full      up to 1024 x 1024 cells: about 5 minutes with all peers, and 4 GB of memory
#   --update    writes what it prints into doc/performance.md, between the markers; takes --full with it
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

is_full=false
is_over_ranks=false
is_update=false
for argument in "$@"; do
   case $argument in
      --ranks) is_over_ranks=true ;;
      --full) is_full=true ;;
      --update) is_full=true is_update=true ;;
      *)
         echo "bench.sh: unknown option '$argument' (options: --ranks, --full, --update)" >&2
         exit 1
         ;;
   esac
done

work=build/bench
mkdir -p "$work"

if $is_over_ranks; then
   scripts/build.sh mpi
   sizes=(256 512)
   ! $is_full || sizes+=(1024)
   python3 -B bench/bench_ranks.py build/mpi/bin/amontons "$work" "${sizes[@]}" | tee "$work/ranks.md"
      # The page has the largest body alone.
   awk -v n="${sizes[-1]}" '/^Models/ { exit } !/^\| [0-9]/ || $2 == n' "$work/ranks.md" >"$work/largest.md"
   ! $is_update || sed -i -e "/<!-- bench.sh --ranks -->/r $work/largest.md" \
      -e '/<!-- bench.sh --ranks -->/,/<!-- end of ranks -->/{/<!--/!d}' doc/performance.md
   exit
fi

scripts/setup.sh build
scripts/build.sh release amontons_app amontons_rates
arguments=(build/release "$work")
! $is_full || arguments+=(--full)
# What it measures is said on standard error.
python3 -B bench/bench.py "${arguments[@]}" 2>&1 >"$work/tables.md" |
   scripts/helpers/progress.sh "$work/log" 'the machine' || { cat "$work/log" >&2; exit 1; }
cat "$work/tables.md"

if $is_update; then
   # The page leaves out what follows from other tables. Everything between the markers is replaced.
   awk '/^### / { is_left_out = /^### (Growth|Steps beside)/ } !is_left_out' "$work/tables.md" >"$work/digest.md"
   sed -i -e "/<!-- bench.sh -->/r $work/digest.md" -e '/<!-- bench.sh -->/,/<!-- end -->/{/<!--/!d}' doc/performance.md
fi
