#!/usr/bin/env bash
# Makes one page, pictures included, of a folder of solved cases. Usage: report.sh FOLDER [PAGE]
#   PAGE    the file to write, FOLDER/report.html by default
set -euo pipefail
scripts=$(dirname "$(realpath "${BASH_SOURCE[0]}")")

"$scripts/setup.sh" pictures
exec /usr/bin/python3 -B "$scripts/report.py" "$@"
