#!/usr/bin/env bash
# Tries the tests: makes the small changes of src/ that scripts/dev/mutants.txt lists, one after the other, and runs the
# tests on each until one fails. A change that none notices survives, which is a fault of the tests.
# Usage: mutants.sh [--list | --random COUNT SEED] [WORD...]
#   --list     only checks that every change fits the sources
#   --random   tries COUNT changes made up from SEED in the place of the list: not all of them alter a result
#   WORD       only changes whose line in the list contains one of the words
# A run that was ended goes on where it stopped, as long as no source and no test has changed. On two processors the
# first build and the unchanged tests take about 8 minutes, a change 3 to 20 s if the tests of its module notice it,
# else some 3 minutes: the list takes half an hour.
# Exit status: 0 if every change was noticed.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

scripts/setup.sh build test
exec nice python3 -B scripts/dev/mutants.py "$@"
