#!/usr/bin/env bash
# Runs Python with the package amontons of the sources, for pictures. Usage: python.sh ARGUMENT...
# It is the python3 of the search path, where that has Matplotlib and NumPy, else Debian's, and they are installed.
set -euo pipefail
scripts=$(dirname "$(realpath "${BASH_SOURCE[0]}")")

python=python3
has_packages='import importlib.util as u, sys; sys.exit(not (u.find_spec("matplotlib") and u.find_spec("numpy")))'
if ! "$python" -c "$has_packages" 2>/dev/null; then
   "$scripts/setup.sh" pictures
   python=/usr/bin/python3
fi
PYTHONPATH=$(dirname "$scripts")/python${PYTHONPATH:+:$PYTHONPATH} exec "$python" -B "$@"
