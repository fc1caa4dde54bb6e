#!/usr/bin/env bash
# Converts a reduced problem between FCLIB's HDF5 and the text that amontons --reduced reads; the first bytes of SOURCE
# show which it is. Usage: fclib.sh [--solution TABLE] SOURCE TARGET
#   TABLE    NAME.contact.csv of amontons --reduced: its forces go to /solution of the FCLIB file
set -euo pipefail
scripts=$(dirname "$(realpath "${BASH_SOURCE[0]}")")

"$scripts/setup.sh" fclib
PYTHONPATH="$scripts/../python" exec /usr/bin/python3 -B -m amontons fclib "$@"
