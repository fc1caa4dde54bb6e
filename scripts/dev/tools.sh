#!/usr/bin/env bash
# Installs the developer tools of requirements.txt into .venv, when they are not there yet.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/../.."

wanted=scripts/dev/requirements.txt
installed=.venv/requirements.txt
! cmp --silent "$wanted" "$installed" || exit 0

echo "Installing the tools of $wanted"
python=/usr/bin/python3
[[ -x $python ]] || python=python3
rm -rf .venv
"$python" -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check --requirement "$wanted" |
   scripts/helpers/progress.sh /dev/null "$wanted"
cp "$wanted" "$installed"
