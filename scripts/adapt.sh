#!/usr/bin/env bash
# Solves a deck on meshes that Gmsh makes finer where the estimated error is, until it is as small as asked for.
# Installs and builds what is missing. Usage: adapt.sh PART DECK [--error 2%] [--key NAME]... [--steps N] [--output DIR]
#   PART      the geometry for Gmsh (.geo), or a mesh beside which it is (.msh), or - for the rectangle of the deck
#   DECK      the deck; its mesh is replaced
#   --error   relative error of the stresses to reach (2%)
#   --key     reach it instead in this key result, as max_contact_pressure: what its last two changes leave, if it
#             falls with the estimated error
#   --steps   most meshes (10)
#   --output  directory of the meshes, their results and pictures, and of adapt.csv (adapt)
set -euo pipefail
scripts=$(dirname "$(realpath "${BASH_SOURCE[0]}")")

if [[ -z ${AMONTONS-} ]]; then
   "$scripts/setup.sh" build
   "$scripts/build.sh" release amontons_app
   AMONTONS=$(dirname "$scripts")/build/release/bin/amontons
fi
export AMONTONS
"$scripts/setup.sh" adapt
# No PYTHONPATH: the program may be a wheel's, whose own package it would hide.
exec /usr/bin/python3 -B -c 'import sys
sys.path.insert(0, sys.argv.pop(1))
from amontons import commands
commands.run("adapt", sys.argv[1:])' "$(dirname "$scripts")/python" "$@"
