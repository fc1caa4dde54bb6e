#!/usr/bin/env bash
# Makes one page, pictures included, of a folder of solved cases. Usage: report.sh FOLDER [PAGE]
#   PAGE    the file to write, FOLDER/report.html by default
set -euo pipefail
exec "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/python.sh" -m amontons report "$@"
