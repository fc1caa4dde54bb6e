"""Blocks of a deck in CalculiX, whose forces tests/verification/test_solid_blocks.py has. Usage: calculix_blocks.py DECK

The deck has boxes of hexahedra, materials, supports of their sides and contact sets with friction, and nothing else. It is
written as an input file with mortar contact, solved by `ccx`, and the sum of the reactions of each support is printed.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

# Stiffness of the penalty over Young's modulus of the softest body, and slope of sticking over that.
PENALTY, STICKING = 1e6, 1e5
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
# Axis and end of each side, and its face in CalculiX.
SIDES = {"left": (0, 0, "S6"), "right": (0, 1, "S4"), "front": (1, 0, "S3"), "back": (1, 1, "S5"),
         "bottom": (2, 0, "S1"), "top": (2, 1, "S2")}


def groups_of(text, name):
    """The groups of a name, each its keys with their numbers or words."""
    text = re.sub("!.*", "", text)
    for group in re.findall(rf"&{name}\b([^/]*)/", text):
        pairs = re.findall(r"(\w+)\s*=\s*((?:'[^']*'|[-+.\dEe]+)(?:\s*,\s*[-+.\dEe]+)*)", group)
        yield {key: value.strip("'") if value.startswith("'") else [float(x) for x in value.split(",")]
               for key, value in pairs}


def side_nodes(node, cells, side):
    """The numbers of the nodes of a side of a box, and those of the elements there."""
    axis, end, _ = SIDES[side]
    ranges = [range(n + 1) for n in cells]
    ranges[axis] = [end * cells[axis]]
    return [node(i, j, k) for k in ranges[2] for j in ranges[1] for i in ranges[0]]


def input_file(text):
    """The lines of an input file, and the names of the sets of its supports."""
    lines, boxes, first = [], {}, 1
    for mesh in groups_of(text, "mesh"):
        cells = [int(n) for n in mesh["cells"]]
        origin = mesh.get("origin", [0.0] * 3)
        node = lambda i, j, k, first=first, cells=cells: first + (k * (cells[1] + 1) + j) * (cells[0] + 1) + i
        boxes[mesh["name"]] = node, cells
        lines += ["*NODE"] + [f"{node(i, j, k)}, " + ", ".join(
            repr(o + s * a / n) for o, s, a, n in zip(origin, mesh["size"], (i, j, k), cells))
            for k in range(cells[2] + 1) for j in range(cells[1] + 1) for i in range(cells[0] + 1)]
        lines += [f"*ELEMENT, TYPE=C3D8, ELSET={mesh['name']}"] + [
            f"{node(i, j, k)}, " + ", ".join(str(node(i + x, j + y, k + z)) for x, y, z in CORNERS)
            for k in range(cells[2]) for j in range(cells[1]) for i in range(cells[0])]
        first = node(*cells) + 1
    young = {group.get("region"): group for group in groups_of(text, "material")}
    for name in boxes:
        material = young.get(name, young.get(None))
        lines += [f"*MATERIAL, NAME=OF_{name}", "*ELASTIC", f"{material['young'][0]}, {material['poisson'][0]}",
                  f"*SOLID SECTION, ELSET={name}, MATERIAL=OF_{name}"]
    softest = min(group["young"][0] for group in young.values())
    for count, contact in enumerate(groups_of(text, "contact")):
        for role in ("set", "against"):
            box, side = contact[role].split(".")
            node, cells = boxes[box]
            axis, end, face = SIDES[side]
            ranges = [range(n) for n in cells]
            ranges[axis] = [end * (cells[axis] - 1)]
            lines += [f"*SURFACE, NAME={role}_{count}"] + [
                f"{node(i, j, k)}, {face}" for k in ranges[2] for j in ranges[1] for i in ranges[0]]
        lines += [f"*SURFACE INTERACTION, NAME=TOUCH_{count}", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
                  f"{PENALTY * softest}", "*FRICTION", f"{contact['friction'][0]}, {STICKING * softest}",
                  f"*CONTACT PAIR, INTERACTION=TOUCH_{count}, TYPE=MORTAR", f"set_{count}, against_{count}"]
    supports = [(group["set"], [group.get(key, [None])[0] for key in ("ux", "uy", "uz")])
                for group in groups_of(text, "support")]
    for name, _ in supports:
        box, side = name.split(".")
        lines += [f"*NSET, NSET={name.replace('.', '_')}"] + [f"{n}," for n in side_nodes(*boxes[box], side)]
    lines += ["*STEP, INC=200", "*STATIC", "1., 1.", "*BOUNDARY"]
    lines += [f"{name.replace('.', '_')}, {axis}, {axis}, {value!r}" for name, values in supports
              for axis, value in enumerate(values, start=1) if value is not None]
    for name, _ in supports:
        lines += [f"*NODE PRINT, NSET={name.replace('.', '_')}, TOTALS=ONLY", "RF"]
    return lines + ["*END STEP"], [name for name, _ in supports]


def main(deck):
    lines, names = input_file(pathlib.Path(deck).read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "blocks.inp").write_text("\n".join(lines) + "\n")
        run = subprocess.run(["ccx", "blocks"], cwd=folder, capture_output=True, text=True, check=False,
                             env={**os.environ, "OMP_NUM_THREADS": "1"})
        text = pathlib.Path(folder, "blocks.dat").read_text()
    if run.returncode:
        sys.exit(run.stdout[-2000:])
    blocks = re.findall(r"set (\S+) and time\s+(\S+)\s+([-+.\dE]+)\s+([-+.\dE]+)\s+([-+.\dE]+)", text)
    for name in names:
        last = [b for b in blocks if b[0] == name.replace(".", "_").upper()][-1]
        print(name, f"at {float(last[1]):g}:", *last[2:])


main(*sys.argv[1:])
