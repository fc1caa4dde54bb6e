"""Solves random bodies as they are, turned, mirrored, in other units and renumbered, and fails where answers differ.

Usage: fuzz_frames.py PROGRAM COUNT [FIRST]

Bodies are of all elements, on obstacles, in contact with or bonded to another body, plane or of revolution, under
loads of all kinds, some with a history. Forces and motion of all contact points, key results and the estimated error
must be the same in each frame. Body number k is the same in every run. What goes wrong is kept in build/fuzz and
printed.
"""

import csv
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Residuals of 1e-10 of the largest force, some hundred times as much in soft modes; histories add them up.
TOLERANCE = 1e-5
# Type of a cell and of its sides in a Gmsh file, and how many nodes are corners.
ELEMENTS = {"quad4": (3, 1, 4), "tri3": (2, 1, 3), "quad8": (16, 8, 4), "tri6": (9, 8, 3), "quad9": (10, 8, 4)}
LENGTHS = ("max_slip", "max_displacement", "contact_width")
POINT = ("normal force", "shear force", "gap", "slip")
STRESSES = ("max_contact_pressure", "max_contact_shear", "max_von_mises")


class Frame:
    """Where a body is described: turned by an angle, mirrored before, in other units, with other numbers."""

    def __init__(self, angle=0.0, mirrored=False, length=1.0, force=1.0, shuffled=False):
        self.turn = complex(math.cos(angle), math.sin(angle))
        self.mirrored, self.length, self.force, self.shuffled = mirrored, length, force, shuffled
        self.stress = force/length**2

    def vector(self, vector, unit=1.0):
        """A vector in the frame."""
        place = unit*self.turn*complex(-vector[0] if self.mirrored else vector[0], vector[1])
        return place.real, place.imag

    def home(self, place):
        """A place of the frame as the body has it."""
        place = complex(*place)/(self.turn*self.length)
        return (-place.real if self.mirrored else place.real), place.imag


def grid(choice, element, size, origin, cells, bulge):
    """Nodes by their half steps along both sides, cells as lists of them, and sides of each set."""
    step = 1 if element in ("quad4", "tri3") else 2
    columns, rows = step*cells[0], step*cells[1]
    nodes = {}
    for j in range(0, rows + 1, step):
        for i in range(0, columns + 1, step):
            inside = 0.2*(0 < i < columns)*(0 < j < rows)
            x, y = (i + step*choice.uniform(-inside, inside))/columns, (j + step*choice.uniform(-inside, inside))/rows
            nodes[i, j] = origin[0] + size[0]*x, origin[1] + size[1]*(y + bulge*(1 - y)*(x - 0.5)**2)

    def mean(*keys):
        return tuple(sum(nodes[key][k] for key in keys)/len(keys) for k in (0, 1))

    parts = []
    for j in range(0, rows, step):
        for i in range(0, columns, step):
            corners = (i, j), (i + step, j), (i + step, j + step), (i, j + step)
            groups = (corners[:3], (corners[0], *corners[2:])) if "tri" in element else (corners, )
            for group in groups:
                cell = list(group)
                for near, far in zip(group, group[1:] + group[:1]):
                    if step == 2:
                        cell.append(((near[0] + far[0])//2, (near[1] + far[1])//2))
                        nodes[cell[-1]] = mean(near, far)
                if element == "quad9":
                    cell.append((i + 1, j + 1))
                    nodes[cell[-1]] = mean(*corners)
                parts.append(cell)
    lines = {"bottom": [(i, 0) for i in range(columns + 1)], "right": [(columns, j) for j in range(rows + 1)],
             "top": [(i, rows) for i in range(columns, -1, -1)], "left": [(0, j) for j in range(rows, -1, -1)]}
    sides = {name: [line[k:k + step + 1] for k in range(0, len(line) - 1, step)] for name, line in lines.items()}
    return nodes, parts, sides


class Body:
    """A random body, described without a frame."""

    def __init__(self, number):
        choice = random.Random(number)
        self.number = number
        self.is_round = choice.random() < 0.2
        width = 10**choice.uniform(-1, 1)
        height = width*choice.uniform(0.3, 1)
        inner = choice.choice((0.0, 0.4*width)) if self.is_round else choice.uniform(-1, 1)*width
        on_axis = self.is_round and inner == 0.0
        bulge = choice.choice((0.0, 0.0, 0.02, 0.1))
        names = choice.choices(list(ELEMENTS), k=2)
        self.parts = [("a", names[0], grid(choice, names[0], (width, height), (inner, 0.0),
                                           (choice.randint(3, 10), choice.randint(2, 4)), bulge))]
        beside = 0.0 if on_axis else 0.2*width
        if choice.random() < 0.5:
            self.parts.append(("b", names[1], grid(choice, names[1], (1.5*width, height), (inner - beside, -height),
                                                   (choice.randint(3, 10), choice.randint(2, 4)), 0.0)))
        self.is_tied = len(self.parts) == 2 and bulge == 0.0 and choice.random() < 0.2
        self.size = width
        young = 10**choice.uniform(2, 5)
        pressure = 1e-3*young*choice.uniform(0.3, 2)
        self.has_history = choice.random() < 0.25 and not self.is_tied
        self.numbers = {
            "young": young, "poisson": choice.choice((0.0, 0.25, 0.3, 0.45)), "pressure": pressure,
            "shear": choice.uniform(-0.2, 0.2)*pressure*(not self.is_round),
            "thickness": choice.choice((1.0, 0.5)), "friction": choice.choice((0.0, 0.1, 0.3)),
            "bound": choice.choice((0.0, 0.0, 0.1))*pressure, "gap": choice.choice((0.0, 0.0, 1e-3, -1e-3))*width,
            "warmth": choice.choice((0.0, choice.uniform(-20, 20))),
            "weight": choice.choice((0.0, 0.1))*pressure/height,
            "slope": choice.choice(((0.0, 0.0), (choice.uniform(-2, 2)/width, choice.uniform(-2, 2)/width))),
            "apex": (0.0 if self.is_round else inner + 0.4*width, 0.0), "radius": width*choice.uniform(1.5, 5)
        }
        self.words = {
            "hypothesis": "axisymmetric" if self.is_round else choice.choice(("plane strain", "plane stress")),
            "hold": "" if on_axis else "un" if self.is_round else choice.choice(("un", "", "spring")),
            "obstacle": "plane" if self.is_round else choice.choice(("plane", "circle", "parabola"))
        }

    def frames(self):
        """The frames of the body, the first as it is; one of revolution has its axis."""
        choice = random.Random(-1 - self.number)
        frames = {"as it is": Frame(), "in other units": Frame(length=10**choice.uniform(-4, 4),
                                                               force=10**choice.uniform(-4, 4)),
                  "renumbered": Frame(shuffled=True)}
        if not self.is_round:
            frames["turned"] = Frame(angle=choice.uniform(0, 6.28))
            frames["mirrored"] = Frame(mirrored=True, angle=choice.uniform(0, 6.28), shuffled=True)
        return frames

    def mesh(self, frame):
        """The Gmsh file of the body."""
        choice = random.Random(self.number)
        places, cells, sides = [], [], []
        for name, element, (nodes, parts, sets) in self.parts:
            number = {key: len(places) + k for k, key in enumerate(nodes)}
            places += [frame.vector(place, frame.length) for place in nodes.values()]
            cell_type, side_type, n = ELEMENTS[element]
            for part in parts:
                cell = [number[key] for key in part]
                corners, middles, rest = cell[:n], cell[n:2*n], cell[2*n:]
                if frame.mirrored:
                    corners, middles = corners[:1] + corners[:0:-1], middles[::-1]
                first = choice.randrange(n) if frame.shuffled else 0
                cells.append((cell_type, name, [*corners[first:], *corners[:first], *middles[first:], *middles[:first],
                                                *rest]))
            for side, lines in sets.items():
                sides += [(side_type, name + side, [number[key] for key in (line[0], line[-1], *line[1:-1])])
                          for line in lines]
        order = list(range(len(places)))
        if frame.shuffled:
            for items in (order, cells, sides):
                choice.shuffle(items)
        node = {k: i for i, k in enumerate(order, 1)}
        names = sorted({name for _, name, _ in cells + sides})
        dimension = {name: 1 + (name in "ab") for name in names}
        elements = [f"{i} {kind} 2 {names.index(name) + 1} {names.index(name) + 1} {' '.join(str(node[k]) for k in of)}"
                    for i, (kind, name, of) in enumerate(sides + cells, 1)]
        return "\n".join([
            "$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names)),
            *(f'{dimension[name]} {i} "{name}"' for i, name in enumerate(names, 1)), "$EndPhysicalNames", "$Nodes",
             str(len(places)), *(f"{i} {places[k][0]!r} {places[k][1]!r} 0" for i, k in enumerate(order, 1)),
             "$EndNodes", "$Elements", str(len(elements)), *elements, "$EndElements", ""])

    def deck(self, frame, mesh):
        """The deck of the body."""
        of, words = self.numbers, self.words
        length, stress = frame.length, frame.stress

        def pair(vector, unit):
            return ", ".join(map(repr, frame.vector(vector, unit)))

        thickness = "" if self.is_round else f"  thickness = {of['thickness']*length!r}"
        lines = [
            f"&mesh kind = 'file'  file = '{mesh}' /",
            f"&material young = {of['young']*stress!r}  poisson = {of['poisson']}  expansion = 1e-5  density = 1.0"
            f"  hypothesis = '{words['hypothesis']}'{thickness} /",
            f"&load name = 'p'  set = 'atop'  pressure = {of['pressure']*stress!r} /",
            f"&load name = 'q'  set = 'atop'  traction = {pair((of['shear'], 0.0), stress)} /",
            f"&load temperature = {of['warmth']!r}  temperature_slope = {pair(of['slope'], 1/length)} /",
            f"&load gravity = {pair((0.0, -of['weight']), stress/length)} /"
        ]
        soft = 1e-2*of["young"]/self.size*stress/length
        lines += {"": [], "un": ["&support set = 'aright'  un = 0.0 /"],
                  "spring": [f"&support set = 'aright'  spring_n = {soft!r}  spring_t = {0.1*soft!r} /"]}[words["hold"]]
        law = f"friction = {of['friction']}  slip_bound = {of['bound']*stress!r}  extra_gap = {of['gap']*length!r}"
        if len(self.parts) == 2:
            lines.append("&support set = 'bbottom'  un = 0.0  ut = 0.0 /")
            lines.append("&tie set = 'abottom'  to = 'btop' /" if self.is_tied else
                         f"&contact set = 'abottom'  against = 'btop'  {law} /")
        else:
            radius = "" if words["obstacle"] == "plane" else f"  radius = {of['radius']*length!r}"
            lines.append(f"&contact set = 'abottom'  obstacle = '{words['obstacle']}'{radius}  {law}  point = "
                         f"{pair(of['apex'], length)}  normal = {pair((0.0, 1.0), 1.0)} /")
        if self.has_history:
            lines += ["&history times = 0.0, 1.0, 2.0, 3.0  substeps = 3 /",
                      "&steps load = 'q'  factor = 0.0, 1.0, -1.0, 0.5 /",
                      "&steps load = 'p'  factor = 0.3, 1.0, 1.0, 0.7 /"]
        return "\n".join(lines) + "\n"


def answer(folder, name, frame, size):
    """Contact points by their places, and single numbers, without a frame; None if there is no solution. A gap larger
    than the body is none."""
    path = folder/f"{name}.summary.json"
    if not path.exists():
        return None
    summary = json.loads(path.read_text(encoding="utf-8"))
    if not summary["converged"] or not summary["certificate"]["passed"]:
        return None
    points = {}
    table = folder/f"{name}.contact.csv"
    side = -1 if frame.mirrored else 1
    for row in csv.DictReader(table.read_text(encoding="utf-8").splitlines()) if table.exists() else ():
        points[frame.home((float(row["x"]), float(row["y"])))] = (
            float(row["normal_force"])/frame.force, side*float(row["tangential_force"])/frame.force,
            min(float(row["gap"])/frame.length, size), side*float(row["slip"])/frame.length)
    results = summary["key_results"]
    single = {key: results[key]/unit for keys, unit in ((LENGTHS, frame.length), (STRESSES, frame.stress))
              for key in keys if key in results}
    single["relative_error"] = summary.get("accuracy", {}).get("relative_error", 0.0)
    return points, single


def difference(one, other, size):
    """What differs between two answers, as a text; empty if nothing does."""
    if (one is None) != (other is None):
        return "one is not solved"
    if one is None:
        return ""
    if len(one[0]) != len(other[0]):
        return "other contact points"
    forces = max((abs(force) for values in one[0].values() for force in values[:2]), default=0.0)
    ways = max([1e-6*size, *(abs(way) for values in one[0].values() for way in values[2:])])
    places = list(other[0])
    for place, values in one[0].items():
        near = min(places, key=lambda found, at=place: math.dist(found, at))
        for quantity, left, right, scale in zip(POINT, values, other[0][near], (forces, forces, ways, ways)):
            if abs(left - right) > TOLERANCE*scale:
                return f"{quantity} {left} and {right}"
    for key, value in one[1].items():
        least = 1e-6*size if key in LENGTHS else 1e-6 if key == "relative_error" else 0.0
        if abs(other[1][key] - value) > TOLERANCE*max(abs(value), least):
            return f"{key} {value} and {other[1][key]}"
    return ""


def check(program, number):
    """Solves a body in all frames; returns a fault or an empty text, and whether it has a solution."""
    body = Body(number)
    frames = body.frames()
    with tempfile.TemporaryDirectory(prefix="fuzz_") as name:
        folder = pathlib.Path(name)
        for k, frame in enumerate(frames.values()):
            (folder/f"body_{number}_{k}.msh").write_text(body.mesh(frame), encoding="ascii")
            (folder/f"body_{number}_{k}.nml").write_text(body.deck(frame, f"body_{number}_{k}.msh"), encoding="ascii")
        decks = [f"body_{number}_{k}.nml" for k in range(len(frames))]
        run = subprocess.run([program, "--quiet", "--output", "out", *decks], cwd=folder, capture_output=True,
                             text=True, timeout=600, check=False)
        answers = [answer(folder/"out", f"body_{number}_{k}", frame, body.size)
                   for k, frame in enumerate(frames.values())]
        fault = "" if run.returncode in (0, 2, 4) else run.stderr.strip()
        for frame, other in zip(list(frames)[1:], answers[1:]):
            differs = difference(answers[0], other, body.size)
            if differs:
                fault = f"{frame}: {differs}"
                keep = ROOT/"build"/"fuzz"
                keep.mkdir(parents=True, exist_ok=True)
                for path in folder.glob("body_*"):
                    shutil.copy(path, keep)
                break
        return fault, answers[0] is not None


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    count, first = int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 0
    n_faults = n_solved = 0
    for number in range(first, first + count):
        fault, is_solved = check(program, number)
        n_solved += is_solved
        if fault:
            n_faults += 1
            print(f"body {number}: {fault}; build/fuzz/body_{number}_*", flush=True)
    print(f"frames: {count} bodies from number {first} on, {n_solved} of them solved, {n_faults} faults")
    sys.exit(1 if n_faults else 0)


if __name__ == "__main__":
    main()
