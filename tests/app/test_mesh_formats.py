#!/usr/bin/env python3
"""One body through every format of a mesh file, moved at random: the same solution. Files that include others, and
parts of Abaqus in several instances."""
import math
import random
import struct
import unittest

from harness import ProgramTest

NX, NY, WIDTH, HEIGHT = 6, 3, 3.0, 1.5
CELLS = [[i + j*(NX + 1) + k for k in (0, 1, NX + 2, NX + 1)] for j in range(NY) for i in range(NX)]
EDGES = {"left": [[(j + 1)*(NX + 1), j*(NX + 1)] for j in range(NY)],
         "bottom": [[i, i + 1] for i in range(NX)],
         "top": [[(NX + 1)*NY + i + 1, (NX + 1)*NY + i] for i in range(NX)]}
BODY = """&material young = 100.0  poisson = 0.25 /
&support set = 'left'  ux = 0.0 /
&load set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.3 /
"""


def places(dx, dy):
    """Coordinates of the nodes of a block that is moved; its columns are not of one width."""
    return [(dx + WIDTH*(i/NX)**1.5, dy + HEIGHT*j/NY) for j in range(NY + 1) for i in range(NX + 1)]


def names():
    """The names of the physical groups: dimension, number, name."""
    return [(1, 5 + i, name) for i, name in enumerate(EDGES)] + [(2, 4, "body")]


def elements():
    """The elements, entity by entity: dimension and number of the entity, which is its physical group; type; nodes."""
    return [(1, 5 + i, 1, lines) for i, lines in enumerate(EDGES.values())] + [(2, 4, 3, CELLS)]


def head(version, is_binary=False):
    """How a file of Gmsh begins."""
    return [f"$MeshFormat\n{version} {int(is_binary)} 8\n", b"\1\0\0\0\n" if is_binary else "",
            "$EndMeshFormat\n$PhysicalNames\n4\n", *(f'{d} {tag} "{name}"\n' for d, tag, name in names()),
            "$EndPhysicalNames\n"]


def joined(parts):
    """The bytes of a file."""
    return b"".join(part if isinstance(part, bytes) else part.encode() for part in parts)


def gmsh_22(nodes):
    """Version 2.2."""
    rows = [(kind, group, members) for _, group, kind, rows in elements() for members in rows]
    return joined([*head("2.2"), f"$Nodes\n{len(nodes)}\n", 
                   *(f"{i} {x!r} {y!r} 0\n" for i, (x, y) in enumerate(nodes, 1)),
                   f"$EndNodes\n$Elements\n{len(rows)}\n",
                   *(f"{i} {kind} 2 {group} {group} {' '.join(str(n + 1) for n in members)}\n"
                     for i, (kind, group, members) in enumerate(rows, 1)), "$EndElements\n"])


def gmsh_4(nodes, version, is_binary):
    """Versions 4.0 and 4.1: numbers are ints, doubles or sizes, in text or as they are in memory."""
    def record(form, *numbers):
        """Numbers, with i, d or N for the kind of each."""
        if is_binary:
            return struct.pack("<" + form.replace("N", "Q"), *numbers)
        return " ".join(map(repr, numbers)) + "\n"

    old = version == "4.0"
    tag = "i" if old else "N"
    parts = [*head(version, is_binary), "$Entities\n", record("NNNN", 0, 3, 1, 0)]
    for dimension, group, _, _ in elements():
        bounds = [] if dimension == 1 else [5, 6, 7]
        parts.append(record(f"i6dNiN{len(bounds)}i", group, *map(float, range(6)), 1, group, len(bounds), *bounds))
    n = len(nodes)
    parts += ["\n$EndEntities\n$Nodes\n", record("NN", 1, n) if old else record("NNNN", 1, n, 1, n),
              record("iiiN", *((4, 2) if old else (2, 4)), 0, n)]
    if old:
        parts += [record("iddd", i, x, y, 0.0) for i, (x, y) in enumerate(nodes, 1)]
    else:
        parts += [record("N", i) for i in range(1, n + 1)] + [record("ddd", x, y, 0.0) for x, y in nodes]
    total = sum(len(rows) for *_, rows in elements())
    parts += ["\n$EndNodes\n$Elements\n", record("NN", 4, total) if old else record("NNNN", 4, total, 1, total)]
    element = 0
    for dimension, group, kind, rows in elements():
        parts.append(record("iiiN", *((group, dimension) if old else (dimension, group)), kind, len(rows)))
        for members in rows:
            element += 1
            parts.append(record(tag*(1 + len(members)), element, *(node + 1 for node in members)))
    return joined([*parts, "\n$EndElements\n"])


def node_lines(nodes):
    """Data lines of *NODE."""
    return "".join(f"{i}, {x!r}, {y!r}\n" for i, (x, y) in enumerate(nodes, 1))


def cell_lines():
    """Data lines of *ELEMENT."""
    return "".join(f"{i}, {', '.join(str(n + 1) for n in cell)}\n" for i, cell in enumerate(CELLS, 1))


def set_lines():
    """Sets of nodes."""
    return "".join(f"*NSET, NSET={name}\n" + "".join(f"{n + 1},\n" for n in sorted({n for side in sides for n in side}))
                   for name, sides in EDGES.items())


def abaqus(nodes):
    """A file of Abaqus without parts."""
    return f"*NODE\n{node_lines(nodes)}*ELEMENT, TYPE=CPE4, ELSET=body\n{cell_lines()}{set_lines()}".encode()


def moved_instance(dx, dy, angle, z):
    """A file of Abaqus whose part is turned back, and turned about the origin in its instance, behind a translation."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    turned = [(c*x + s*y, c*y - s*x) for x, y in places(0.0, 0.0)]
    return (f"*Part, name=block\n*Node\n{node_lines(turned)}*Element, type=CPE4, elset=body\n{cell_lines()}"
            f"{set_lines()}*End Part\n*Assembly, name=all\n*Instance, name=block-1, part=block\n{dx!r}, {dy!r}, 0.\n"
            f"{dx!r}, {dy!r}, 1., {dx!r}, {dy!r}, {1.0 + z!r}, {math.copysign(1.0, z)*angle!r}\n*End Instance\n"
            "*End Assembly\n").encode()


class MeshFormats(ProgramTest):
    """Formats of mesh files."""

    def file(self, name, content):
        """Writes a file of bytes and returns its name."""
        (self.directory / name).parent.mkdir(exist_ok=True)
        (self.directory / name).write_bytes(content)
        return name

    def block(self, name, dx=0.0, dy=0.0):
        """What a block on the floor says whose file has been moved."""
        return self.solve(f"&mesh file = '{name}'  origin = {-dx!r}, {-dy!r} /\n{BODY}",
                          name.replace(".", "_").replace("/", "_"))

    def test_every_format_gives_the_same_solution(self):
        chance = random.Random(7)
        expected = self.block(self.file("start.msh", gmsh_22(places(0.0, 0.0))))
        self.assertGreater(len(set(expected["status"])), 1)
        for trial in range(3):
            dx, dy = chance.uniform(-9.0, 9.0), chance.uniform(-9.0, 9.0)
            nodes = places(dx, dy)
            files = {"22.msh": gmsh_22(nodes), "flat.inp": abaqus(nodes),
                     "part.inp": moved_instance(dx, dy, chance.uniform(-180.0, 180.0), chance.choice([2.0, -3.0])),
                     **{f"{version}_{kind}.msh": gmsh_4(nodes, version, kind == "binary")
                        for version in ("4.0", "4.1") for kind in ("text", "binary")}}
            for name, content in files.items():
                with self.subTest(name, dx=dx, dy=dy):
                    found = self.block(self.file(name, content), dx, dy)
                    # Coordinates of 10 have lost a digit beside those of 1, sums of forces of 3 another.
                    self.assert_close(found.forces, expected.forces, 1e-12)
                    self.assert_close(found["slip"], expected["slip"], 1e-13)
                    self.assertEqual(found["status"], expected["status"], trial)

    def test_included_files(self):
        nodes = places(0.0, 0.0)
        expected = self.block(self.file("flat.inp", abaqus(nodes)))
        self.file("parts/nodes.inc", node_lines(nodes)[:-1].encode())
        self.file("parts/cells.inc", cell_lines().replace("\n", "\r\n").encode())
        self.file("parts/body.inc", b"*NODE\n*INCLUDE, INPUT=nodes.inc\n** *INCLUDE, INPUT=none.inc\n"
                                    b"*ELEMENT, TYPE=CPE4, ELSET=body\n*include,\ninput=\"cells.inc\"\n")
        self.file("whole.inp", b"*INCLUDE, INPUT=parts/body.inc\n" + set_lines().encode())
        found = self.block("whole.inp")
        self.assertEqual(found.forces, expected.forces)
        # All of them are inputs of the case.
        inputs = [file["name"] for file in found.summary["inputs"]]
        self.assertEqual(inputs, [str(self.directory / name) for name in ("whole.inp", "parts/body.inc",
                                                                          "parts/nodes.inc", "parts/cells.inc")])
        self.run_program("--verify", ".")
        self.file("parts/nodes.inc", node_lines(nodes).replace("3.0", "3.5").encode())
        self.assertIn("parts/nodes.inc", self.run_program("--verify", ".", status=4).stderr)

    def test_faults_of_included_files_name_their_line(self):
        self.file("parts/body.inc", abaqus(places(0.0, 0.0)) + b"*NSET, NSET=bad\n1, 999\n")
        line = 1 + abaqus(places(0.0, 0.0)).count(b"\n")
        for text, message in (
                ("\n*INCLUDE, INPUT=parts/body.inc\n", f"parts/body.inc:{line}: the set 'bad' names node 999, "),
                ("*INCLUDE, INPUT=parts/none.inc\n",
                 f"whole.inp:1: {self.directory}/parts/none.inc: cannot read this file: No such file"),
                ("*NODE\n1, 0., 0.\n*INCLUDE, INPUT=parts/body.inc\n*NSET, NSET=n\n1, up\n",
                 "whole.inp:5: there is no set 'up' above")):
            self.file("whole.inp", text.encode())
            deck = self.write("deck.nml", "&mesh file = 'whole.inp' /\n" + BODY)
            run = self.run_program("--check", deck, status=1)
            self.assertIn(message, run.stderr)

    def test_names_and_lines_of_what_an_included_file_holds(self):
        # Forces on single nodes are sets named by their line; the same line of two files is not the same set.
        self.file("flat.inp", abaqus(places(0.0, 0.0)) + b"*INCLUDE, INPUT=one.inc\n*INCLUDE, INPUT=two.inc\n")
        self.file("one.inc", b"*CLOAD\n22, 2, -1.\n")
        self.file("two.inc", b"*CLOAD\n28, 2, -2.\n")
        body = BODY.replace("&load set = 'top'  pressure = 1.0 /\n", "")
        used = self.solve("&mesh file = 'flat.inp'  use = 'loads' /\n" + body, "used")
        plain = self.solve("&mesh file = 'flat.inp' /\n" + body
                           + f"&load point = 0.0, {HEIGHT}  force = 0.0, -1.0 /\n"
                           f"&load point = {WIDTH}, {HEIGHT}  force = 0.0, -2.0 /\n", "plain")
        self.assert_close(used.forces, plain.forces, 1e-13)

    def test_two_instances_are_two_bodies(self):
        # A block on another one, of one part; the upper one is pressed.
        text = moved_instance(0.0, 0.0, 0.0, 1.0).decode().replace(
            "*End Assembly\n", f"*Instance, name=Upper, part=block\n0.25, {HEIGHT}, 0.\n*End Instance\n"
            "*Nset, nset=floor, instance=block-1\n1, 2, 3, 4, 5, 6, 7\n*End Assembly\n"
            "*Boundary\nblock-1.bottom, 1, 2\nUpper.left, 1\n*Step\n*Cload\nUpper.28, 2, -0.5\n*End Step\n")
        self.file("pair.inp", text.encode())
        self.file("one.inp", abaqus(places(0.0, 0.0)))
        contact = "&contact set = '{}.bottom'  against = '{}.top'  friction = 0.2 /\n&material young = 100.0  " \
            "poisson = 0.25 /\n&load set = '{}.top'  pressure = 1.0 /\n"
        pair = self.solve("&mesh file = 'pair.inp'  use = 'supports', 'loads' /\n"
                          + contact.format("Upper", "block-1", "Upper"), "pair")
        joined_parts = self.solve(
            "&mesh name = 'lower'  file = 'one.inp' /\n"
            f"&mesh name = 'upper'  file = 'one.inp'  origin = 0.25, {HEIGHT} /\n"
            "&support set = 'lower.bottom'  ux = 0.0  uy = 0.0 /\n&support set = 'upper.left'  ux = 0.0 /\n"
            f"&load point = {0.25 + WIDTH}, {2*HEIGHT}  force = 0.0, -0.5 /\n"
            + contact.format("upper", "lower", "upper"), "parts")
        self.assert_close(pair.forces, joined_parts.forces, 1e-12)
        self.assertEqual(pair["status"], joined_parts["status"])
        deck = "&mesh file = 'pair.inp' /\n&material young = 1.0  poisson = 0.0 /\n" \
            "&support set = 'none'  ux = 0.0 /\n"
        self.assertRegex(self.run_program("--check", self.write("deck.nml", deck), status=1).stderr,
                         r"the mesh has no set 'none'; its sets are: .*block-1\.left.*Upper\.top.* floor\n")

    def test_materials_of_turned_instances_turn(self):
        # Axis 1 of the part is turned with it: along x again, as the deck's own.
        part = moved_instance(0.0, 0.0, 90.0, 1.0).decode()
        section = ("*Orientation, name=grain\n0., -1., 0., 1., 0., 0.\n3, 20.\n"
                   "*Solid Section, elset=body, orientation=Grain, material=wood\n1.,\n*End Part\n")
        constants = ("*Material, name=wood\n*Elastic, type=ENGINEERING CONSTANTS\n140e3, 10e3, 8e3, 0.3, 0.25, 0.45, "
                     "5e3, 4e3\n3e3,\n")
        self.file("wood.inp", (part.replace("*End Part\n", section) + constants).encode())
        used = self.solve("&mesh file = 'wood.inp'  use = 'materials' /\n" + "".join(
            line for line in BODY.splitlines(True) if "material" not in line), "used")
        plain = self.solve("&mesh file = 'wood.inp' /\n" + BODY.replace(
            "young = 100.0  poisson = 0.25", "young = 140e3, 10e3, 8e3  poisson = 0.3, 0.25, 0.45  shear = 5e3  "
            "angle = 20.0"), "plain")
        self.assert_close(used.forces, plain.forces, 1e-12)
        self.assert_close(used["slip"], plain["slip"], 1e-15)

    def test_axes_of_materials_that_cannot_be_used(self):
        flat = abaqus(places(0.0, 0.0)).decode()
        deck = self.write("deck.nml", "&mesh file = 'bad.inp'  use = 'materials' /\n")
        section = ("*MATERIAL, NAME=m\n*ELASTIC\n1., 0.2\n"
                   "*SOLID SECTION, ELSET=body, MATERIAL=m, ORIENTATION=o\n")
        for lines, message in (
                ("*ORIENTATION, NAME=o, SYSTEM=CYLINDRICAL\n", "*ORIENTATION with SYSTEM=CYLINDRICAL cannot be used"),
                ("*ORIENTATION, NAME=o, DEFINITION=NODES\n", "*ORIENTATION with DEFINITION=NODES cannot be used"),
                ("*ORIENTATION, NAME=o\n1., 0., 0., 0., 0., 1.\n" + section,
                 "*ORIENTATION: the third axis must be that of z"),
                ("*ORIENTATION, NAME=o\n1., 0., 0., 0., 1., 0.\n2, 30.\n" + section,
                 "*ORIENTATION: the third axis must be that of z"),
                ("*ORIENTATION, NAME=o\n0., 0., 0., 0., 1., 0.\n",
                 "*ORIENTATION: expected two points other than the origin"),
                ("*SOLID SECTION, ELSET=body, MATERIAL=m, ORIENTATION=o\n",
                 "*SOLID SECTION: there is no *ORIENTATION 'o' above"),
                ("*MATERIAL, NAME=m\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1., 1., 1., 0., 0., 0., 1.\n",
                 "*elastic: expected 9 numbers"),
                ("*MATERIAL, NAME=m\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1., 1., 1., 2., 0., 0., 1., 1.\n1.\n"
                 "*SOLID SECTION, ELSET=body, MATERIAL=m\n", "the elastic constants are not positive definite")):
            with self.subTest(message):
                self.file("bad.inp", (flat + lines).encode())
                self.assertIn(message, self.run_program("--check", deck, status=1).stderr)


if __name__ == "__main__":
    unittest.main()
