#!/usr/bin/env bash
# Runs the findings, or those that are named, and prints a line for each. Usage: run.sh [NAME...]
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")"

if (($# == 0)); then
   mapfile -t names < <(find . -maxdepth 1 -name "*.sh" ! -name run.sh -printf "%f\n" | sort)
   set -- "${names[@]%.sh}"
fi
status=0
for name in "$@"; do
   code=0
   output=$("./$name.sh" 2>&1) || code=$?
   case $code in
      0) echo "ok       $name" ;;
      77) echo "skipped  $name: $(tail -n 1 <<<"$output")" ;;
      *)
         echo "CHANGED  $name"
         echo "$output"
         status=1
         ;;
   esac
done
exit "$status"
