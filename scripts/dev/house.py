#!/usr/bin/env python3
"""Prints measures of the sources: code lines and tolerances of src/, and modules that the smallest run enters.

A code line is a line of a Fortran file that is neither blank nor only a comment; a tolerance is a constant that is a
small number, counted by declarations. The run is that of
input/long_bar_1.nml on one thread, watched by `valgrind --tool=callgrind`; a module is entered where any of its
procedures is called. The program is that of a release build, build/release/bin/amontons unless another is given.

Usage: house.py [PROGRAM]

Without valgrind or a program only the lines are counted.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from check_sources import tolerances_of

ROOT = Path(__file__).resolve().parents[2]
DECK = ROOT/"input"/"long_bar_1.nml"
MODULE = re.compile(r"\b__(amontons_\w+?)_MOD_")


def count_lines():
    """Returns the code lines of src/, the number of its modules and that of its declarations of tolerances."""
    files = sorted((ROOT/"src").rglob("*.f90"))
    texts = [file.read_text(encoding="utf-8").splitlines() for file in files]
    lines = [line.strip() for text in texts for line in text]
    modules = {file.name.split(".")[0] for file in files if file.name.startswith("amontons_")}
    return sum(1 for line in lines if line and not line.startswith("!")), len(modules), \
        sum(len(list(tolerances_of(text))) for text in texts)


def entered_modules(program):
    """Returns the names of the modules that the smallest run enters."""
    with tempfile.TemporaryDirectory() as folder:
        profile = Path(folder)/"callgrind.out"
        subprocess.run(["valgrind", "--quiet", "--tool=callgrind", f"--callgrind-out-file={profile}", str(program),
                        "--quiet", "--output", folder, str(DECK)], check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "OMP_NUM_THREADS": "1"})
        return sorted(set(MODULE.findall(profile.read_text(encoding="utf-8", errors="replace"))))


def main(arguments):
    """Prints the numbers; returns the exit status."""
    program = Path(arguments[0] if arguments else ROOT/"build"/"release"/"bin"/"amontons")
    n_lines, n_modules, n_tolerances = count_lines()
    print(f"{n_lines} lines of code in {n_modules} modules; {n_tolerances} declarations of tolerances")
    if not (program.is_file() and shutil.which("valgrind")):
        print("the modules of the smallest run need valgrind and a release build", file=sys.stderr)
        return 1
    entered = entered_modules(program)
    print(f"{len(entered)} modules entered by the smallest run: " + ", ".join(
        name.removeprefix("amontons_") for name in entered))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
