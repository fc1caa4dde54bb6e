#!/usr/bin/env bash
# Draws solved cases, each as CASE.png and CASE.svg beside its files. Usage: plot.sh CASE...
#   CASE    a folder of cases, any file of a case, or the path of its files without their endings
set -euo pipefail
exec "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/python.sh" -m amontons plot "$@"
