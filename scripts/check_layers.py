#!/usr/bin/env python3
"""Checks that a file is a module, a folder of src/ is a layer, and a module uses its own layer and those below only."""
import re
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent / "src"
# From the bottom up. The facade src/amontons.f90 lies above the library; only the program may use it.
LAYERS = ["base", "linalg", "fem", "contact", "deck", "input", "case", "binding", "facade", "app"]
FACADE = "amontons"
FOREIGN_MODULES = {"hdf5", "omp_lib"}
WORDS_OF_LINALG = re.compile(r"dpbtrf|cholmod", re.IGNORECASE)
UNIT = re.compile(r"^\s*(?:module|program)\s+(?!procedure\b|subroutine\b|function\b)(\w+)\s*(?:!.*)?$", re.IGNORECASE)
# gfortran takes a module and a procedure of C that share a name for one and calls the wrong one.
BIND = re.compile(r"\bbind\s*\(\s*c\s*,\s*name\s*=\s*['\"](\w+)['\"]", re.IGNORECASE)
USE = re.compile(r"^\s*use\b(\s*,\s*intrinsic\b)?\s*(?:::)?\s*(\w+)", re.IGNORECASE)


def layer_of(path):
    """Returns the layer of a file, which is its folder's name."""
    parts = path.relative_to(SOURCE).parts
    return parts[0] if len(parts) > 1 else "facade"


def module_name(path):
    """Returns the name that the module of a file must have."""
    return path.name.split(".")[0].lower()


def faults_of_file(path, layer_of_module):
    """Yields line number and text of every fault of one file."""
    layer = layer_of(path)
    units = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        if layer != "linalg" and (word := WORDS_OF_LINALG.search(line)):
            yield number, f"only the layer linalg may say {word[0]}"
        if match := UNIT.match(line):
            units.append(match[1].lower())
        if (match := BIND.search(line)) and match[1].lower() in layer_of_module:
            yield number, f"{match[1]} is a module already; give the procedure of C another name"
        if not (match := USE.match(line)) or match[1]:
            continue
        used = match[2].lower()
        used_layer = layer_of_module.get(used)
        if used_layer is None and used not in FOREIGN_MODULES:
            yield number, f"there is no module {used} in src/"
        elif used_layer and LAYERS.index(used_layer) > LAYERS.index(layer):
            yield number, f"layer {layer} may not use {used} of layer {used_layer} above it"
    if path.suffix not in (".c", ".h") and units != [module_name(path)]:
        yield 1, f"this file must hold {module_name(path)} and nothing else, it holds: {', '.join(units) or 'nothing'}"


def main():
    """Prints the faults of all source files; returns the exit status."""
    faults = []
    files = sorted(path for path in SOURCE.rglob("*") if path.suffix in (".f90", ".in", ".c", ".h"))
    for path in files:
        if layer_of(path) not in LAYERS or layer_of(path) == "facade" and module_name(path) != FACADE:
            faults.append((path, 1, f"the layers are the folders {', '.join(LAYERS[:-2])} and app"))
    if not faults:
        layer_of_module = {module_name(path): layer_of(path) for path in files}
        faults = [(path, *fault) for path in files for fault in faults_of_file(path, layer_of_module)]
    for path, number, text in faults:
        print(f"{path.relative_to(SOURCE.parent)}:{number}: {text}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
