#!/usr/bin/env python3
"""The files of a solved case, read as other programs read them."""
import math
import re
import unittest
from decimal import Decimal
from pathlib import Path

from harness import COLUMNS, CONTACT, PRESSURE, SUPPORT, ProgramTest, block, read_vtu

try:
    import meshio
except ImportError:
    meshio = None
try:
    import vtk
except ImportError:
    vtk = None

MESHES = Path(__file__).resolve().parents[1] / "meshes"
MESH = "size = 4.0, 2.0  cells = 8, 4"
PUSH = "load set = 'right'  traction = -1.5, 0.3"  # part of the floor sticks, part slides, part opens
NUMBER = re.compile(r"-?\d+\.\d+(e-?\d+)?")
MEMBERS = {
    "case": str, "title": str, "units": str, "version": str, "method": str, "outcome": str,
    "converged": bool, "warnings": list,
    "iterations": int, "products": float,
    "factorizations": int, "residual": float, "residual_history": list,
    "certificate": {"passed": bool, "limit": float, "equilibrium": float, "penetration": float,
                    "penetration_outside": float, "penetration_between": float, "tension": float,
                    "friction_excess": float, "complementarity": float,
                    "slip_below_bound": float, "wrong_dissipation": float,
                    "resultant": float, "moment": float, "energy": float, "strain_energy": float,
                    "work_of_friction": float},
    "uniqueness": {"guaranteed": bool, "friction_below": float, "exact": bool},
    "key_results": dict.fromkeys((
        "max_contact_pressure", "max_contact_shear", "max_slip", "max_von_mises", "max_displacement", "contact_width",
        "stick_width",
        "contact_centroid_x", "contact_centroid_y", "contact_force_x", "contact_force_y", "contact_moment",
        *(f"reaction_{component}_left" for component in ("x", "y", "moment")),
        *(f"force_{component}_bottom" for component in ("normal", "tangential", "x", "y", "moment")),
        *(f"max_{name}_{axis}" for name in ("contact_pressure", "contact_shear", "slip", "von_mises", "displacement")
          for axis in "xy")), float),
    "counts": dict.fromkeys(("nodes", "elements", "dofs", "contact_points", "open", "stick", "slip"), int),
    "factor": {"entries": int, "flops": int},
    "lengths": dict.fromkeys(("open_length", "slip_length", "stick_length"), float),
    "closed_zones": list, "stick_zones": list,
    "resultants": dict.fromkeys(("normal_force", "tangential_force"), float),
    "accuracy": {"error_norm": float, "relative_error": float},
    "seconds": dict.fromkeys(("read", "assemble", "factorize", "condense", "solve", "recover", "write", "total"),
                             float),
    "peak_memory_mb": float, "files": list, "inputs": list, "checksum": int,
}


class Summary(ProgramTest):
    """NAME.summary.json"""

    def assert_members(self, value, members, name):
        """Checks that a value has these members, of these types, and no others."""
        if isinstance(members, dict):
            self.assertEqual(list(value), list(members), name)
            for key in members:
                self.assert_members(value[key], members[key], f"{name}.{key}")
        else:
            self.assertIs(type(value), members, name)

    def test_members_and_their_types(self):
        summary = self.solve(block(SUPPORT, PRESSURE, CONTACT, PUSH)).summary
        self.assert_members(summary, MEMBERS, "summary")

    def test_error_of_a_method_that_came_to_rest(self):
        result = self.solve(block(SUPPORT, PRESSURE, CONTACT, PUSH, "solver method = 'splitting'  variant = 'printed'"),
                            status=4)
        error = result.summary.pop("method_error")
        self.assert_members(result.summary, MEMBERS, "summary")
        self.run_program("--output", "exact", self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, PUSH)))
        exact = self.result("case", "exact").forces
        largest = max(map(abs, exact))
        # Both differences are of numbers known to 1e-10.
        self.assertAlmostEqual(error, max(abs(a - b) for a, b in zip(result.forces, exact))/largest, delta=1e-9)
        self.assertGreater(error, 0.01)

    def test_numbers_are_those_of_the_table(self):
        result = self.solve(block(SUPPORT, PRESSURE, CONTACT, PUSH,
                                  material="young = 1.0  poisson = 0.0  thickness = 3.0"))
        summary = result.summary
        status = [name.strip("+-") for name in result["status"]]
        self.assertEqual([summary["counts"][name] for name in ("open", "stick", "slip")],
                         [status.count(name) for name in ("open", "stick", "slip")])
        self.assertEqual([summary["counts"][name] for name in ("nodes", "elements", "dofs", "contact_points")],
                         [45, 32, 85, 9])
        for name in ("normal_force", "tangential_force"):
            self.assertAlmostEqual(summary["resultants"][name], math.fsum(result[name]), delta=1e-12)
        self.assertAlmostEqual(math.fsum(result.lengths), 4.0, delta=1e-14)
        work = math.fsum(map(lambda force, slip: force*slip, result["tangential_force"], result["slip"]))
        self.assertAlmostEqual(summary["certificate"]["work_of_friction"], work, delta=1e-12)
        self.assertIs(summary["certificate"]["passed"], True)
        self.assertAlmostEqual(math.fsum(value for key, value in summary["seconds"].items() if key != "total"),
                               summary["seconds"]["total"], delta=1e-9)


class Table(ProgramTest):
    """NAME.contact.csv"""

    def test_header_and_digits(self):
        self.solve(block(SUPPORT, PRESSURE, CONTACT, PUSH))
        header, *rows, rest = self.contents()["case.contact.csv"].decode().split("\n")
        self.assertEqual(header, ",".join(COLUMNS))
        self.assertEqual(rest, "")
        self.assertEqual(len(rows), 9)
        for number, row in enumerate(rows, start=1):
            point, *numbers, status = row.split(",")
            self.assertEqual(point, str(number))
            self.assertIn(status, ("open", "stick", "slip+", "slip-"))
            self.assertEqual(len(numbers), len(COLUMNS) - 2)
            for text in numbers:
                self.assertRegex(text, NUMBER)
                # Python's repr has the fewest digits, too, that read back as the same number.
                self.assertEqual(Decimal(text).normalize().as_tuple(),
                                 Decimal(repr(float(text))).normalize().as_tuple())

    def test_columns_fit_together(self):
        result = self.solve(block(SUPPORT, PRESSURE, CONTACT, PUSH,
                                  material="young = 1.0  poisson = 0.25  thickness = 3.0"))
        self.assert_close(result["weight"], [0.25, *[0.5]*7, 0.25], 1e-15)
        for force_name, stress_name in (("normal_force", "contact_pressure"), ("tangential_force", "contact_shear")):
            stress = [force/(3.0*weight) for force, weight in zip(result[force_name], result["weight"])]
            self.assert_close(result[stress_name], stress, 1e-14)
        for status, gap, slip, normal, tangential in zip(*map(result.__getitem__, (
                "status", "gap", "slip", "normal_force", "tangential_force"))):
            # Closed and stick are exact where Newton's method ends; the bound is a product of two rounded numbers.
            if status == "open":
                self.assertEqual((normal, tangential), (0.0, 0.0))
                self.assertGreater(gap, 0.0)
            else:
                self.assertAlmostEqual(gap, 0.0, delta=1e-13)
                self.assertGreater(normal, 0.0)
                self.assertLessEqual(abs(tangential), 0.3*normal*(1.0 + 1e-12))
            if status.startswith("slip"):
                self.assertGreater(slip*float(status[-1] + "1"), 0.0)
                self.assertAlmostEqual(tangential, math.copysign(0.3*normal, slip), delta=1e-13)
            elif status == "stick":
                self.assertAlmostEqual(slip, 0.0, delta=1e-13)

    def test_slip_of_a_cell_is_the_mean_of_its_nodes(self):
        # Where a support moves a node of the first cell, too.
        for friction in (0.3, 100.0):
            result = self.solve(block("support set = 'left'  ux = 0.02", "load set = 'top'  pressure = 20.0",
                                      f"contact set = 'bottom'  friction = {friction}  multipliers = 'constant'"))
            slip = [x for x, _, _ in read_vtu((self.directory / "case.vtu").read_bytes())[0]["displacement"][:9]]
            means = [(slip[2*k] + 2*slip[2*k + 1] + slip[2*k + 2])/4 for k in range(4)]
            self.assert_close(result["slip"], means, 1e-14)
            # What sticks does not move, however the support moves its node.
            for status, x in zip(result["status"], result["slip"]):
                self.assertTrue(abs(x) < 1e-14 if status == "stick" else x*float(status[-1] + "1") > 0.0)
            self.run_program("--verify", ".")

    def test_body_without_contact_has_no_rows(self):
        result = self.solve(block("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE))
        self.assertEqual(self.contents()["case.contact.csv"].decode(), ",".join(COLUMNS) + "\n")
        self.assertEqual(result.summary["counts"]["contact_points"], 0)
        self.assertEqual(result.lengths, [0.0, 0.0, 0.0])
        self.assertIs(result.summary["certificate"]["passed"], True)

    def test_points_follow_the_line_with_the_body_on_the_left(self):
        expected = {"bottom": [(0.5*i, 0.0) for i in range(9)], "right": [(4.0, 0.5*i) for i in range(5)],
                    "top": [(4.0 - 0.5*i, 2.0) for i in range(9)], "left": [(0.0, 2.0 - 0.5*i) for i in range(5)]}
        normals = {"bottom": (0.0, -1.0), "right": (1.0, 0.0), "top": (0.0, 1.0), "left": (-1.0, 0.0)}
        for side, points in expected.items():
            normal = normals[side]
            contact = (f"contact set = '{side}'  friction = 1.0  point = {points[0][0]}, {points[0][1]}"
                       f"  normal = {-normal[0]}, {-normal[1]}")
            result = self.solve(block(f"load body_force = {normal[0]}, {normal[1]}", contact))
            self.assertEqual(list(zip(result["x"], result["y"])), points)
            self.assertEqual(list(zip(result["normal_x"], result["normal_y"])), [normal]*len(points))
            # The body's weight, 1 x 4 x 2.
            self.assertAlmostEqual(sum(result["normal_force"]), 8.0, delta=1e-11)


class Picture(ProgramTest):
    """NAME.vtu"""

    def solve_and_read(self, *groups, **parts):
        """Solves a block; returns its result, its arrays, and the numbers of points and cells."""
        result = self.solve(block(*groups, **parts))
        return (result, *read_vtu(self.contents()["case.vtu"]))

    def test_mesh_of_quadrilaterals(self):
        _, arrays, n_points, n_cells = self.solve_and_read(SUPPORT, PRESSURE, CONTACT)
        self.assertEqual((n_points, n_cells), (45, 32))
        self.assertEqual(list(arrays["types"]), [9]*32)
        self.assertEqual(list(arrays["offsets"]), list(range(4, 129, 4)))
        self.assertEqual(self.areas(arrays), [0.25]*32)

    def test_mesh_of_triangles(self):
        for diagonal in ("right", "left", "alternating"):
            _, arrays, n_points, n_cells = self.solve_and_read(
                SUPPORT, PRESSURE, CONTACT, mesh=f"{MESH}  element = 'tri3'  diagonal = '{diagonal}'")
            self.assertEqual((n_points, n_cells), (45, 64))
            self.assertEqual(list(arrays["types"]), [5]*64)
            self.assertEqual(list(arrays["offsets"]), list(range(3, 193, 3)))
            self.assertEqual(self.areas(arrays), [0.125]*64)

    @staticmethod
    def areas(arrays):
        """The areas of the cells, positive where their nodes go counter-clockwise."""
        areas, start = [], 0
        for end in arrays["offsets"]:
            corners = [arrays["points"][node] for node in arrays["connectivity"][start:end]]
            start = end
            areas.append(0.5*sum(a[0]*b[1] - a[1]*b[0] for a, b in zip(corners, corners[1:] + corners[:1])))
        return areas

    def test_contact_line_is_that_of_the_table(self):
        result, arrays, *_ = self.solve_and_read(SUPPORT, PRESSURE, CONTACT, PUSH)
        codes = {"open": 1, "stick": 2, "slip+": 3, "slip-": 4}
        for i in range(9):
            self.assertEqual(arrays["points"][i], (result["x"][i], result["y"][i], 0.0))
            self.assertEqual(arrays["gap"][i], result["gap"][i])
            self.assertEqual(arrays["slip"][i], result["slip"][i])
            self.assertEqual(arrays["contact_pressure"][i], result["contact_pressure"][i])
            self.assertEqual(arrays["contact_shear"][i], result["contact_shear"][i])
            self.assertEqual(arrays["status"][i], codes[result["status"][i]])
            # The floor is y = 0: the displacement is (slip, gap) but for rounding.
            self.assert_close(arrays["displacement"][i], (result["slip"][i], result["gap"][i], 0.0), 1e-15)
        for name in ("gap", "slip", "contact_pressure", "contact_shear", "status"):
            self.assertEqual(set(arrays[name][9:]), {0})

    def test_uniform_stress(self):
        # Pressure 1 on a smooth floor in plane strain: yy = -1, xx = 0, zz = nu yy.
        _, arrays, *_ = self.solve_and_read(SUPPORT, PRESSURE, "contact set = 'bottom'")
        for stress, mises in zip(arrays["stress"], arrays["von_mises"]):
            self.assert_close(stress, (0.0, -1.0, -0.25, 0.0, 0.0, 0.0), 1e-13)
            self.assertAlmostEqual(mises, math.sqrt(0.5*(1.0 + 0.75**2 + 0.25**2)), delta=1e-13)
        for stress, mises in zip(arrays["nodal_stress"], arrays["nodal_von_mises"]):
            self.assert_close(stress, (0.0, -1.0, -0.25, 0.0, 0.0, 0.0), 1e-13)
            self.assertAlmostEqual(mises, math.sqrt(0.5*(1.0 + 0.75**2 + 0.25**2)), delta=1e-13)
        # Half of the stress times the strain (1 - nu^2)/E.
        for density in arrays["strain_energy_density"]:
            self.assertAlmostEqual(density, 0.5*(1.0 - 0.25**2)/100.0, delta=1e-15)
        self.assertEqual(set(arrays["material"]), {1})

    def test_contact_line_as_a_grid_of_its_own(self):
        result = self.solve(block(SUPPORT, PRESSURE, CONTACT, PUSH))
        arrays, n_points, n_cells = read_vtu(self.contents()["case.contact.vtu"])
        self.assertEqual((n_points, n_cells), (9, 8))
        self.assertEqual(list(arrays["connectivity"]), [node for i in range(8) for node in (i, i + 1)])
        self.assertEqual(list(arrays["offsets"]), list(range(2, 17, 2)))
        self.assertEqual(list(arrays["types"]), [3]*8)
        self.assertEqual([point[0] for point in arrays["points"]], result["x"])
        for name in ("gap", "slip", "contact_pressure", "contact_shear"):
            self.assertEqual(list(arrays[name]), result[name])
        for bound, shear, pressure, status in zip(arrays["shear_bound"], arrays["contact_shear"],
                                                  arrays["contact_pressure"], result["status"]):
            self.assertAlmostEqual(bound, 0.3*pressure, delta=1e-15)
            if status.startswith("slip"):
                self.assertAlmostEqual(abs(shear), bound, delta=1e-13)
        self.assertEqual(set(arrays["set"]), {1})
        self.assertEqual(list(arrays["normal"]), [(0.0, -1.0, 0.0)]*9)

    def grids(self):
        """Grids of every kind of element and of a mesh of two kinds, of its contact line each, of one contact point and
        of none: their names and what is in them."""
        for element in ("tri3", "quad4", "tri6", "quad8", "quad9"):
            self.solve(block(SUPPORT, PRESSURE, CONTACT, mesh=f"{MESH}  element = '{element}'"), element)
        mixed = f"kind = 'file'  file = '{MESHES / 'mixed-41.msh'}'"
        self.solve(block("load body_force = 0.0, -1.0", "support set = 'right end'  ux = 0.0", CONTACT, mesh=mixed),
                   "mixed")
        held = "support set = 'left'  ux = 0.0  uy = 0.0"
        self.solve(block(held, PRESSURE, CONTACT, mesh="size = 4.0, 2.0  cells = 1, 1"), "one")
        self.solve(block(held, PRESSURE), "none")
        for name, content in self.contents().items():
            if name.endswith(".vtu"):
                yield name, *read_vtu(content)

    def assert_same(self, found, expected, message):
        """Checks an array of another reader against ours."""
        self.assertEqual(found.tolist(), [list(x) if isinstance(x, tuple) else x for x in expected], message)

    @unittest.skipIf(meshio is None, "meshio is not installed")
    def test_meshio_reads_the_same(self):
        kinds = {"vertex": 1, "line": 3, "triangle": 5, "quad": 9, "triangle6": 22, "quad8": 23, "quad9": 28}
        for name, arrays, n_points, n_cells in self.grids():
            if n_points == 0:  # more than meshio can read
                continue
            mesh = meshio.read(self.directory / name)
            self.assert_same(mesh.points, arrays["points"], name)
            self.assertEqual(sum(len(cells.data) for cells in mesh.cells), n_cells)
            self.assertEqual([kinds[cells.type] for cells in mesh.cells for _ in cells.data], list(arrays["types"]))
            self.assertEqual([node for cells in mesh.cells for node in cells.data.flatten()],
                             list(arrays["connectivity"]))
            for key, values in mesh.point_data.items():
                self.assert_same(values, arrays[key], (name, key))
            for key, parts in mesh.cell_data.items():
                self.assertEqual([x for part in parts for x in part.tolist()],
                                 [list(x) if isinstance(x, tuple) else x for x in arrays[key]], (name, key))
            self.assertEqual({*mesh.point_data, *mesh.cell_data, "points", "connectivity", "offsets", "types"},
                             set(arrays))

    @unittest.skipIf(vtk is None, "VTK is not installed")
    def test_vtk_reads_the_same(self):
        for name, arrays, n_points, n_cells in self.grids():
            reader = vtk.vtkXMLUnstructuredGridReader()
            complaints = []
            reader.AddObserver("ErrorEvent", lambda *_, found=complaints: found.append("error"))
            reader.AddObserver("WarningEvent", lambda *_, found=complaints: found.append("warning"))
            reader.SetFileName(str(self.directory / name))
            reader.Update()
            grid = reader.GetOutput()
            self.assertEqual(complaints, [], name)
            self.assertEqual((grid.GetNumberOfPoints(), grid.GetNumberOfCells()), (n_points, n_cells), name)
            self.assertEqual([grid.GetPoint(i) for i in range(n_points)], list(arrays["points"]), name)
            self.assertEqual([grid.GetCellType(i) for i in range(n_cells)], list(arrays["types"]), name)
            nodes = [grid.GetCell(i).GetPointId(j) for i in range(n_cells)
                     for j in range(grid.GetCell(i).GetNumberOfPoints())]
            self.assertEqual(nodes, list(arrays["connectivity"]), name)
            for data in (grid.GetPointData(), grid.GetCellData()):
                for i in range(data.GetNumberOfArrays()):
                    array = data.GetArray(i)
                    tuples = [array.GetTuple(j) for j in range(array.GetNumberOfTuples())]
                    self.assertEqual(tuples, [x if isinstance(x, tuple) else (x,) for x in arrays[array.GetName()]],
                                     (name, array.GetName()))


class Listing(ProgramTest):
    """NAME.lst"""

    def test_sections_and_points(self):
        result = self.solve(block(SUPPORT, PRESSURE, CONTACT, PUSH))
        listing = self.contents()["case.lst"].decode()
        places = [listing.index(f"\n{title}") for title in ("Model\n", "Solution\n", "Contact line\n", "Resultants\n",
                                                            "Checks on the full model (", "Contact points (",
                                                            "Time [s]\n")]
        self.assertEqual(places, sorted(places))
        self.assertTrue(listing.endswith("\nEnd of listing\n"))
        rows = [line.split() for line in listing[places[5]:places[6]].splitlines() if re.match(r" +\d+ ", line)]
        self.assertEqual(len(rows), 9)
        for i, row in enumerate(rows):
            # Six digits are printed.
            for text, column in zip(row[1:9], ("x", "y", "gap", "slip", "normal_force", "tangential_force",
                                               "contact_pressure", "contact_shear")):
                self.assertAlmostEqual(float(text), result[column][i], delta=1e-5*max(abs(result[column][i]), 1e-99))
            self.assertEqual(row[9], result["status"][i])

    def test_node_that_a_support_guides_aslant_is_noted(self):
        for direction, effect in (("0.0, -1.0", "no slip, since a support bears the tangential force"),
                                  ("0.5, -1.0", "slip without friction, guided by a support that is aslant to")):
            self.solve(block(SUPPORT, PRESSURE, f"{CONTACT}  gap_direction = {direction}"))
            self.assertIn(f"the node at (0.0, 0.0): {effect}", self.contents()["case.lst"].decode())

    def test_a_body_that_touches_nothing_is_noted(self):
        self.solve(block("support set = 'left'  ux = 0.0  uy = 1.0", CONTACT,
                         "load set = 'right'  traction = 0.0, 1.0"))
        self.assertIn("nothing touches the obstacle; the smallest gap is 1.03", self.contents()["case.lst"].decode())
        self.solve(block(SUPPORT, PRESSURE, CONTACT))
        self.assertNotIn("nothing touches", self.contents()["case.lst"].decode())

    def test_a_body_that_is_only_moved_is_certified(self):
        # No force acts: what rounding leaves of forces is not to be held against them.
        result = self.solve(block("support set = 'right'  ux = 0.013  uy = 0.7", CONTACT,
                                  material="young = 70000.0  poisson = 0.25"))
        self.assertIs(result.summary["certificate"]["passed"], True)
        self.assertEqual(set(result["status"]), {"open"})

    def test_no_line_ends_in_blanks_or_is_empty_twice(self):
        self.solve(block(SUPPORT, PRESSURE, CONTACT))
        listing = self.contents()["case.lst"].decode()
        self.assertNotRegex(listing, r"[ \t]\n")
        self.assertNotIn("\n\n\n", listing)


if __name__ == "__main__":
    unittest.main()
