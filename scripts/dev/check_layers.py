#!/usr/bin/env python3
"""Checks that a file is a module, a folder of src/ is a room, and a room uses all rooms that it may, and no others.

Usage: check_layers.py [ROOT]
"""
import re
import sys
from pathlib import Path

ROOT = Path(sys.argv[1]).resolve() if sys.argv[1:] else Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"
CONTACT = ["contact/problem", "contact/methods", "contact/uniqueness", "contact/geometry", "contact/model"]
# What the modules of a room may use besides their own room and `base`. The methods see the contact problem only.
MAY_USE = {
    "base": [],
    "system": [],
    "linalg": [],
    "cholesky": ["linalg", "system"],
    "mesh": ["system"],
    "mesh/io": ["elasticity", "mesh", "system"],
    "elasticity": ["mesh", "linalg"],
    "distributed": ["elasticity", "mesh", "cholesky", "linalg", "system"],
    "contact/problem": ["linalg"],
    "contact/methods": ["contact/problem", "linalg"],
    "contact/uniqueness": ["contact/problem", "linalg"],
    "contact/geometry": ["elasticity", "mesh", "linalg"],
    "contact/model": ["contact/problem", "contact/geometry", "distributed", "elasticity", "mesh", "cholesky", "linalg",
                      "system"],
    "deck": ["system"],
    "input": ["deck", "contact/model", "contact/geometry", "contact/methods", "elasticity", "mesh", "mesh/io",
              "cholesky", "system"],
    "solve": ["input", *CONTACT, "elasticity", "mesh", "mesh/io", "linalg", "system"],
    "output": ["solve", "input", *CONTACT, "elasticity", "mesh", "system"],
    "study": ["output", "solve", "input", "contact/model", "contact/problem", "elasticity"],
    "study/reduced": ["study", "output", "solve", "input", "contact/problem", "contact/methods", "contact/uniqueness",
                      "linalg", "system"],
    "study/single": ["study", "study/reduced", "output", "solve", "input", "contact/uniqueness",
                     "system"],
    "study/sweep": ["study", "output", "solve", "input", "contact/model", "contact/geometry", "contact/problem",
                    "distributed", "elasticity", "linalg", "system"],
    "study/history": ["study", "output", "solve", "input", "contact/model", "contact/problem", "contact/uniqueness",
                      "linalg", "system"],
    "run": ["study", "study/reduced", "study/single", "study/sweep", "study/history", "output", "input", "system"],
    "verify": ["study", "study/sweep", "study/history", "study/reduced", "output", "solve", "input", "contact/problem",
               "contact/model", "system"],
    "binding": ["run", "study", "study/history", "study/reduced", "solve", "input", "contact/methods", "linalg"],
}
# The modules of the facade, in src/ itself, and the program may use all; only the program may use the facade.
FACADE, APP = "facade", "app"
FACADE_MODULES = {"amontons", "amontons_decks"}
FOREIGN_MODULES = {"omp_lib"}
# Names of foreign libraries and routines, and the rooms that may say them.
FOREIGN_WORDS = [(re.compile(r"umfpack", re.IGNORECASE), ["linalg"]),
                 (re.compile(r"camd|cholmod", re.IGNORECASE), ["cholesky"]),
                 (re.compile(r"dmumps|\bmpi_(?!text)", re.IGNORECASE), ["distributed"]),
                 (re.compile(r"d[gp]btr[fs]", re.IGNORECASE), ["linalg", "cholesky"])]
UNIT = re.compile(r"^\s*(?:module|program)\s+(?!procedure\b|subroutine\b|function\b)(\w+)\s*(?:!.*)?$", re.IGNORECASE)
# gfortran takes a module and a procedure of C that share a name for one and calls the wrong one.
BIND = re.compile(r"\bbind\s*\(\s*c\s*,\s*name\s*=\s*['\"](\w+)['\"]", re.IGNORECASE)
USE = re.compile(r"^\s*use\b(\s*,\s*intrinsic\b)?\s*(?:::)?\s*(\w+)", re.IGNORECASE)


def room_of(path):
    """Returns the room of a file, which is its folder's name."""
    folder = path.relative_to(SOURCE).parent.as_posix()
    return FACADE if folder == "." else folder


def may_use(room, used):
    """Returns whether the modules of a room may use those of another."""
    if room in (FACADE, APP):
        return used != APP and (used != FACADE or room == APP)
    return used == "base" or used in MAY_USE[room]


def module_name(path):
    """Returns the name that the module of a file must have."""
    return path.name.split(".")[0].lower()


def faults_of_file(path, room_of_module, uses):
    """Yields line number and text of every fault of one file, and adds the pairs of rooms of its uses."""
    room = room_of(path)
    units = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        for words, owners in FOREIGN_WORDS:
            if room not in owners and (word := words.search(line)):
                yield number, f"only the room {' or '.join(owners)} may say {word[0]}"
        if match := UNIT.match(line):
            units.append(match[1].lower())
        if (match := BIND.search(line)) and match[1].lower() in room_of_module:
            yield number, f"{match[1]} is a module already; give the procedure of C another name"
        if not (match := USE.match(line)) or match[1]:
            continue
        used = match[2].lower()
        used_room = room_of_module.get(used)
        if used_room is None and used not in FOREIGN_MODULES:
            yield number, f"there is no module {used} in src/"
        elif used_room and used_room != room and not may_use(room, used_room):
            yield number, f"{room} may not use {used} of {used_room}"
        uses.add((room, used_room))
    if path.suffix not in (".c", ".h") and units != [module_name(path)]:
        yield 1, f"this file must hold {module_name(path)} and nothing else, it holds: {', '.join(units) or 'nothing'}"


def main():
    """Prints the faults of all source files; returns the exit status."""
    faults = []
    files = sorted(path for path in SOURCE.rglob("*") if path.suffix in (".f90", ".in", ".c", ".h"))
    for path in files:
        room = room_of(path)
        if room not in (*MAY_USE, FACADE, APP) or room == FACADE and module_name(path) not in FACADE_MODULES:
            faults.append((path, 1, f"the rooms are the folders {', '.join(MAY_USE)} and app"))
    if not faults:
        uses = set()
        room_of_module = {module_name(path): room_of(path) for path in files}
        faults = [(path, *fault) for path in files for fault in faults_of_file(path, room_of_module, uses)]
        rooms = set(room_of_module.values())
        faults += [(SOURCE / room, 1, f"no module here uses {used}: take it from the list of what {room} may use")
                   for room in MAY_USE if room in rooms
                   for used in MAY_USE[room] if used in rooms and (room, used) not in uses]
    for path, number, text in faults:
        print(f"{path.relative_to(SOURCE.parent)}:{number}: {text}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
