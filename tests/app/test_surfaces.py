#!/usr/bin/env python3
"""Rigid obstacles of triangles under solids: their files, and what they give beside planes, spheres and polylines."""
import math
import shutil
import struct
import unittest
from pathlib import Path

from harness import ProgramTest, block

MESHES = Path(__file__).resolve().parents[1] / "meshes"
PUSH = "support set = 'top'  ux = 0.02  uy = 0.005  uz = -0.05"
# A floor of two triangles.
FLOOR = [((-9, -9, 0), (9, -9, 0), (9, 9, 0)), ((-9, -9, 0), (9, 9, 0), (-9, 9, 0))]
KEYS = ("contact_force_x", "contact_force_y", "contact_force_z")


def solid(*groups, size="1.0, 1.0, 1.0", cells="4, 4, 4", element="hex8", material="young = 1.0  poisson = 0.3"):
    """The deck of a box."""
    return block(*groups, mesh=f"kind = 'box'  size = {size}  cells = {cells}  element = '{element}'",
                 material=material)


def stl(triangles):
    """The text of an STL file."""
    return "solid die\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {!r} {!r} {!r}\n".format(*corner) for corner in triangle)
        + "endloop\nendfacet\n" for triangle in triangles) + "endsolid die\n"


def binary_stl(triangles):
    """The bytes of an STL file."""
    return b"solid in name only".ljust(80) + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<12fH", 0, 0, 0, *sum(triangle, ()), 0) for triangle in triangles)


def gmsh(triangles, version):
    """A Gmsh mesh whose physical surface 'floor' has these triangles, beside one that it has not."""
    corners = [corner for triangle in (*triangles, ((0, 0, 3), (1, 0, 3), (0, 1, 3))) for corner in triangle]
    n, nodes = len(triangles), ["{!r} {!r} {!r}".format(*corner) for corner in corners]
    cells = [" ".join(str(3*t + k) for k in (1, 2, 3)) for t in range(n + 1)]
    text = [f"$MeshFormat\n{version} 0 8\n$EndMeshFormat",
            '$PhysicalNames\n2\n2 1 "floor"\n2 2 "lid"\n$EndPhysicalNames']
    if version == 2.2:
        text += ["$Nodes", str(len(nodes)), *(f"{i} {node}" for i, node in enumerate(nodes, start=1)), "$EndNodes",
                 "$Elements", str(n + 1), *(f"{t} 2 2 {1 + t//(n + 1)} 1 {cell}" for t, cell in enumerate(
                     cells, start=1)), "$EndElements", ""]
    else:
        text += ["$Entities\n0 0 2 0\n1 -9 -9 -9 9 9 9 1 1 0\n2 -9 -9 -9 9 9 9 1 2 0\n$EndEntities",
                 f"$Nodes\n1 {len(nodes)} 1 {len(nodes)}\n2 1 0 {len(nodes)}",
                 *map(str, range(1, len(nodes) + 1)), *nodes,
                 f"$EndNodes\n$Elements\n2 {n + 1} 1 {n + 1}\n2 1 2 {n}",
                 *(f"{t} {cell}" for t, cell in enumerate(cells[:n], start=1)), f"2 2 2 1\n{n + 1} {cells[n]}",
                 "$EndElements", ""]
    return "\n".join(text)


def swept(line, stations):
    """The triangles between copies of a polyline at places along y."""
    triangles = []
    for y, z in zip(stations, stations[1:]):
        for a, b in zip(line, line[1:]):
            p = (a[0], y, a[1]), (b[0], y, b[1]), (a[0], z, a[1]), (b[0], z, b[1])
            triangles += [(p[0], p[1], p[3]), (p[0], p[3], p[2])]
    return triangles


def sphere(n, radius, center):
    """The triangles of a sphere: each side of an octahedron in n rows."""
    triangles = []
    for signs in range(8):
        a, b, c = ([(1 - 2*(signs >> axis & 1))*(axis == k) for k in range(3)] for axis in range(3))
        if bin(signs).count("1") % 2:
            a, b = b, a

        def place(i, j, a=a, b=b, c=c):
            way = [i*x + j*y + (n - i - j)*z for x, y, z in zip(a, b, c)]
            return tuple(middle + radius*x/math.hypot(*way) for middle, x in zip(center, way))
        for i in range(n):
            for j in range(n - i):
                triangles.append((place(i, j), place(i + 1, j), place(i, j + 1)))
                if i + j < n - 1:
                    triangles.append((place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)))
    return triangles


class Surfaces(ProgramTest):
    """Decks with `obstacle = 'surface'`."""

    def contact(self, name, triangles=None, words=""):
        """The group of a contact on a file, which is written if there are triangles."""
        if triangles:
            self.write(name, stl(triangles))
        return f"contact set = 'bottom'  friction = 0.3  obstacle = 'surface'  file = '{name}'  {words}"

    def solve_verified(self, deck, name="case"):
        """Solves a case, whose files must be verified."""
        result = self.solve(deck, name)
        self.run_program("--verify", ".")
        return result

    def test_two_triangles_are_the_plane(self):
        (self.directory / "binary.stl").write_bytes(binary_stl(FLOOR))
        for version in (2.2, 4.1):
            self.write(f"{version}.msh", gmsh(FLOOR, version))
        for element in ("hex8", "hex20", "tet4", "tet10"):
            plane = self.solve(solid(PUSH, "contact set = 'bottom'  friction = 0.3", element=element), "plane")
            turned = [triangle[::-1] for triangle in FLOOR]
            for contact in (self.contact("floor.stl", FLOOR), self.contact("binary.stl"),
                            self.contact("turned.stl", turned, "inside = 0.5, 0.5, -0.1"),
                            self.contact("half.stl", FLOOR[:1] + turned[1:], "inside = 0.2, 0.4, -3.0"),
                            self.contact("low.stl", [tuple((x, y, -2) for x, y, z in triangle) for triangle in FLOOR],
                                         "point = 0.0, 0.0, 2.0  inside = 0.0, 0.0, -0.1"),
                            self.contact("2.2.msh", None, "part = 'floor'"),
                            self.contact("4.1.msh", None, "part = 'floor'")):
                with self.subTest(contact, element=element):
                    surface = self.solve_verified(solid(PUSH, contact, element=element))
                    self.assertEqual(surface.columns, plane.columns)

    def test_face_of_a_mesh_of_solids_is_an_obstacle(self):
        # The top of a block, z = 1, of which Gmsh has faces of either sense; the body stands on it.
        for file in ("tet4-22.msh", "tet4-41.msh", "tet4-22-binary.msh", "tet4-41-binary.msh"):
            shutil.copy(MESHES / file, self.directory)
            mesh = "kind = 'box'  size = 1.0, 0.5, 1.0  cells = 4, 2, 4  origin = 0.6, 0.2, 1.0"
            both = [self.solve(block(PUSH, contact, mesh=mesh, material="young = 1.0  poisson = 0.3"))
                    for contact in ("contact set = 'bottom'  friction = 0.3  point = 0.0, 0.0, 1.0",
                                    self.contact(file, None, "part = '40'  inside = 1.0, 0.5, 0.5"))]
            self.assertEqual(both[0].columns, both[1].columns)

    def test_surface_swept_from_a_polyline_is_the_polyline(self):
        # The block is pushed down and along. Ridge and valley; a pad that ends below it; a step with a gap before it.
        lines = {"wedge": [(-9.0, -1.8), (2.1, 0.06), (9.0, -1.2)], "groove": [(-9.0, 1.5), (1.9, -0.06), (9.0, 1.0)],
                 "pad": [(0.9, -1.0), (0.9, 0.0), (2.6, 0.0), (2.6, -1.0)], "facet": [(1.1, 0.0), (9.0, 0.0)],
                 "step": [(-9.0, -0.02), (1.6, -0.02), (1.6, 0.0), (9.0, 0.0)]}
        material = "young = 100.0  poisson = 0.2"
        for name, line in lines.items():
            self.write("line.csv", "".join(f"{s}, {h}\n" for s, h in line))
            plane = self.solve(block("support set = 'top'  ux = 0.02  uy = -0.1", "contact set = 'bottom'  "
                                     "friction = 0.3  obstacle = 'polyline'  line = 'line.csv'", material=material,
                                     mesh="size = 4.0, 2.0  cells = 20, 6"), "plane")
            layer = self.solve_verified(solid(
                "support set = 'top'  ux = 0.02  uz = -0.1", "support set = 'front'  uy = 0.0",
                "support set = 'back'  uy = 0.0", self.contact("swept.stl", swept(line, (-2.0, 0.0, 0.3, 1.0, 2.0))),
                size="4.0, 1.0, 2.0", cells="20, 1, 6", material=material), "layer")
            with self.subTest(name):
                self.assertGreater(sum(plane["normal_force"]), 0.1)
                rows = {round(x, 6): row for x, *row in zip(plane["x"], plane["gap"], plane["normal_force"],
                                                            plane["status"])}
                for x, *row in zip(layer["x"], layer["gap"], layer["normal_force"], layer["status"]):
                    gap, force, status = rows[round(x, 6)]
                    # Gaps out of reach are 1000 times the body's size. Forces of up to 10 and two factorizations.
                    self.assertAlmostEqual(min(row[0], 1.0), min(gap, 1.0), delta=1e-12)
                    self.assertAlmostEqual(row[1], 0.5*force, delta=1e-9)
                    self.assertEqual(row[2], status.rstrip("+-"))

    def test_forces_on_finer_triangles_approach_those_on_the_sphere(self):
        deck = block("support set = 'top'  ux = 0.01  uy = 0.005  uz = -0.1", "{}",
                     material="young = 1.0  poisson = 0.3",
                     mesh="kind = 'box'  size = 2.0, 2.0, 1.0  cells = 8, 8, 3  origin = -0.9, -0.93, 0.0")
        # A ball below the block, and a bowl around its bottom.
        for radius, words in ((4.0, ""), (-4.0, "inside = 0.0, 0.0, -1.0")):
            exact = self.solve(deck.format("contact set = 'bottom'  friction = 0.3  obstacle = 'sphere'  "
                                           f"radius = {radius}"))
            errors = []
            for n in (16, 32, 64):
                case = self.solve(deck.format(self.contact("ball.stl", sphere(n, abs(radius), (0.0, 0.0, -radius)),
                                                           words)))
                errors.append([case.summary["key_results"][key] - exact.summary["key_results"][key] for key in KEYS])
            # Chords are as far from the arc as their squares: a quarter each time, where nodes do not jump.
            self.assertLess(abs(errors[1][2]), 0.3*abs(errors[0][2]))
            self.assertLess(abs(errors[2][2]), 0.3*abs(errors[1][2]))
            self.assertLess(abs(errors[2][2]), 0.01*exact.summary["key_results"]["contact_force_z"])

    def test_turned_and_mirrored_decks_have_turned_and_mirrored_forces(self):
        # The axes in turn: what is below comes to the left; and x reversed.
        bumps = swept([(-9.0, -1.8), (0.4, 0.06), (9.0, -1.2)], (-9.0, 0.3, 9.0))
        push = "support set = '{}'  ux = {}  uy = {}  uz = {}"
        upright = self.solve(solid(push.format("top", 0.02, 0.005, -0.05), self.contact("bumps.stl", bumps)))
        turned = self.solve(solid(push.format("right", -0.05, 0.02, 0.005), self.contact(
            "turned.stl", [tuple((z, x, y) for x, y, z in triangle) for triangle in bumps]).replace("bottom", "left")))
        mirrored = self.solve(solid(push.format("top", -0.02, 0.005, -0.05), self.contact(
            "mirrored.stl", [tuple((1.0 - x, y, z) for x, y, z in triangle[::-1]) for triangle in bumps])))
        force = [[case.summary["key_results"][key] for key in KEYS] for case in (upright, turned, mirrored)]
        self.assertGreater(force[0][2], 0.01)
        for axis in range(3):
            # Forces of 0.05, solved to 1e-10.
            self.assertAlmostEqual(force[0][axis], force[1][(axis + 1) % 3], delta=1e-11)
            self.assertAlmostEqual(force[0][axis], force[2][axis]*(-1 if axis == 0 else 1), delta=1e-11)

    def test_sweep_and_changed_file(self):
        sweep = solid(PUSH, self.contact("floor.stl", FLOOR), "sweep friction = 0.0, 0.2, 0.4")
        self.run_program("--quiet", self.write("rows.nml", sweep))
        self.run_program("--verify", ".")
        self.assertIn("floor.stl", (self.directory / "rows.summary.json").read_text(encoding="utf-8"))
        self.write("floor.stl", stl(FLOOR[::-1]))
        run = self.run_program("--verify", ".", status=4)
        self.assertIn("floor.stl: it was changed", run.stdout + run.stderr)

    def test_history_and_refined_meshes(self):
        way = ("history times = 0.0, 1.0, 2.0, 3.0", "steps obstacle = 'floor'  shift_x = 0.0, 0.01, -0.01, 0.0  "
               "shift_y = 0.0, 0.0, 0.005, 0.0  shift_z = 0.0, 0.01, 0.01, 0.02")
        floors = "contact set = 'bottom'  friction = 0.3", self.contact("floor.stl", FLOOR)
        tables = []
        for floor in floors:
            push = "support set = 'top'  ux = 0.0  uy = 0.0  uz = 0.0"
            self.run_program("--quiet", self.write("walk.nml", solid(push, floor + "  name = 'floor'", *way)))
            self.run_program("--verify", ".")
            table = (self.directory / "walk.history.csv").read_text(encoding="utf-8")
            fine = self.solve(solid(PUSH, floor, "accuracy refinements = 2", cells="1, 1, 1"), "fine")
            tables.append((table, fine.columns, fine.summary["key_results"]))
        self.assertGreater(len(tables[0][0].splitlines()), 3)
        self.assertEqual(tables[0], tables[1])

    def test_listing_tells_the_triangles(self):
        self.solve(solid(PUSH, self.contact("floor.stl", FLOOR)))
        text = " ".join((self.directory / "case.lst").read_text(encoding="utf-8").split())
        self.assertRegex(text, f"obstacle 'surface'.* file '{self.directory}/floor.stl'")
        self.assertIn("Triangles 2, open", text)

    def test_a_hundred_thousand_triangles_take_as_long_as_a_plane(self):
        ball = binary_stl(sphere(112, 30.0, (0.0, 0.0, -30.0)))
        (self.directory / "ball.stl").write_bytes(ball)
        deck = block("support set = 'top'  uz = -0.01", self.contact("ball.stl"), material="young = 1.0  poisson = 0.3",
                     mesh="kind = 'box'  size = 2.0, 2.0, 0.1  cells = 99, 99, 1  origin = -1.0, -1.0, 0.0")
        run = self.run_program("--check", self.write("case.nml", deck))
        self.assertIn("10000 contact points", run.stdout)


class Files(ProgramTest):
    """Files that are refused, each with one sentence."""

    def refused(self, contents, words="", name="die.stl"):
        """What the program says of a file."""
        (self.directory / name).write_bytes(contents if isinstance(contents, bytes) else contents.encode())
        deck = solid(PUSH, f"contact set = 'bottom'  obstacle = 'surface'  file = '{name}'  {words}")
        run = self.run_program("--check", self.write("case.nml", deck), status=1)
        place = f"case.nml:4: file: {self.directory}/{name}"
        self.assertTrue(run.stderr.startswith(place), run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1)
        return run.stderr.removeprefix(place).strip()

    def test_faults_of_text(self):
        text = stl(FLOOR)
        for old, new, sentence in (
                ("vertex 9 -9 0", "vertex 9 nan 0", ":5: expected a coordinate, found 'nan'"),
                ("vertex 9 -9 0", "vertex 9 1e999 0", ":5: expected a coordinate, found '1e999'"),
                ("vertex 9 -9 0", "vertex 9 -9", ":5: expected a coordinate, found the end of the line"),
                ("endloop", "vertex 1 1 1\nendloop", ":7: expected 'endloop', found 'vertex'"),
                ("endsolid die\n", "", ":16: expected 'facet', found the end of the file"),
                ("facet normal", "face normal", ":2: expected 'facet', found 'face'"),
                (text, "solid die\nendsolid die\n", ": no triangle has three corners at different places"),
                (text, "mesh 1\n", ":1: neither an STL file, whose text begins with solid, nor a Gmsh mesh, which "
                 "begins with $MeshFormat"),
                (text, stl([FLOOR[0], FLOOR[1][::-1]]), ": the triangles at the edge from 9.0, 9.0, 0.0 to -9.0, -9.0,"
                 " 0.0 are turned against each other; give inside, a point behind"),
                (text, stl([*FLOOR, ((-9, -9, 0), (9, 9, 0), (0, 0, 9))]), ": more than two triangles have the edge"
                 " from -9.0, -9.0, 0.0 to 9.0, 9.0, 0.0")):
            with self.subTest(sentence):
                self.assertEqual(self.refused(text.replace(old, new)), sentence)
        self.assertEqual(self.refused(text, "part = 'die'"), ":1: part is only for the surfaces of a Gmsh mesh")
        self.assertEqual(self.refused(""), ": this file is empty, or no plain file")

    def test_faults_of_bytes(self):
        whole = binary_stl(FLOOR)
        self.assertEqual(self.refused(whole[:-1]), ": 2 triangles are announced, but the file ends after 99 more bytes"
                         " (byte 85)")
        self.assertEqual(self.refused(whole[:83] + b"\x80"), ": the number of triangles is out of range (byte 81)")
        self.assertEqual(self.refused(b"\0" + whole[1:82]), ": expected the number of triangles, found the end of the"
                         " file (byte 81)")
        nan = whole[:96] + struct.pack("<f", math.nan) + whole[100:]
        self.assertEqual(self.refused(nan), ": a coordinate is not finite (byte 97)")
        self.assertEqual(self.refused(binary_stl([])), ": no triangle has three corners at different places")

    def test_faults_of_meshes(self):
        mesh = gmsh(FLOOR, 2.2)
        self.assertEqual(self.refused(mesh, "part = 'roof'"), ":27: there is no physical surface 'roof'")
        self.assertEqual(self.refused(mesh.replace("2 2 2 1 1 4 5 6", "2 3 2 1 1 4 5 6 7")),
                         ":24: expected triangles of 3 nodes alone on the surface of an obstacle")
        self.assertEqual(self.refused(mesh.replace("2 2 2 1 1 4 5 6", "2 2 2 1 1 4 5 60")),
                         ":24: a triangle has a node that is not there")

    def test_surface_that_faces_away(self):
        self.write("floor.stl", stl([triangle[::-1] for triangle in FLOOR]))
        deck = solid(PUSH, "contact set = 'bottom'  obstacle = 'surface'  file = 'floor.stl'")
        run = self.run_program("--check", self.write("case.nml", deck), status=1)
        self.assertIn("the boundary does not face its obstacle", run.stderr)
        self.assertIn("its triangles counterclockwise seen from the free side", run.stderr)


if __name__ == "__main__":
    unittest.main()
