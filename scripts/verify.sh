#!/usr/bin/env bash
# Runs the benchmarks of tests/verification/benchmarks.txt on fine meshes and prints their tables with every row, in
# Markdown; they stay in build/verification/all.md. Installs and builds what is missing.
# Usage: verify.sh [--update] [BENCHMARK...]
#   --update    writes the tables, shortened, into doc/verification.md, between the markers
# Exit status: 0 if every row keeps its tolerance.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

is_update=false
if [[ ${1-} == --update ]]; then
   is_update=true
   shift
fi
mapfile -t benchmarks <tests/verification/benchmarks.txt
if (($# > 0)); then
   ! $is_update || { echo 'verify.sh: --update takes all benchmarks' >&2; exit 1; }
   benchmarks=("$@")
fi
for benchmark in "${benchmarks[@]}"; do
   [[ $benchmark =~ ^[[:alnum:]_]+$ && -e tests/verification/test_$benchmark.py ]] ||
      { echo "verify.sh: unknown benchmark '$benchmark'" >&2; exit 1; }
done

scripts/setup.sh build adapt >&2
scripts/build.sh release amontons_app

tables=build/verification
rm -rf "$tables"
mkdir -p "$tables"
export AMONTONS=$PWD/build/release/bin/amontons PYTHONPATH=$PWD/tests/app OMP_NUM_THREADS=1 tables
export n_benchmarks=${#benchmarks[@]}
# shellcheck disable=SC2016 # expanded by the shell that xargs starts
printf '%s\n' "${benchmarks[@]}" | xargs -P "$(nproc)" -n 1 bash -c '
   scripts/python.sh "tests/verification/test_$1.py" --print --digest="$tables/$1.digest" \
      >"$tables/$1.md" 2>"$tables/$1.log" ||
      touch "$tables/$1.failed"
   touch "$tables/$1.done"
   echo "[$(find "$tables" -name "*.done" | wc -l)/$n_benchmarks] $1"' verify |
   scripts/helpers/progress.sh "$tables/log" "$n_benchmarks benchmarks"

status=0
for benchmark in "${benchmarks[@]}"; do
   echo
   cat "$tables/$benchmark.md"
   # Without Gmsh or NumPy a test is skipped, and its page would be empty.
   if [[ -e $tables/$benchmark.failed ]] || ! grep -q '^|' "$tables/$benchmark.md"; then
      echo "verify.sh: $benchmark:" >&2
      cat "$tables/$benchmark.log" >&2
      status=1
   fi
done >"$tables/all.md"
cat "$tables/all.md"
((status == 0)) || { echo 'FAILED: a row misses its tolerance, or a page has no table' >&2; exit 1; }

document=doc/verification.md
if $is_update; then
   for benchmark in "${benchmarks[@]}"; do
      echo
      cat "$tables/$benchmark.digest"
   done >"$tables/digest.md"
   echo >>"$tables/digest.md"
   # Everything after the first marker and before the second is replaced.
   sed -i -e "/<!-- verify.sh -->/r $tables/digest.md" -e '/<!-- verify.sh -->/,/<!-- end -->/{/<!--/!d}' "$document"
fi
