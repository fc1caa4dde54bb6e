#!/usr/bin/env python3
"""Solids on rigid obstacles: against an independent code, the plane and equilibrium."""
import csv
import json
import math
import unittest

from harness import ProgramTest, block
from mapped_solid import mapped_solid

TOP = "support set = 'top'  ux = 0.02  uy = 0.005  uz = -0.05"
FLOOR = "contact set = 'bottom'  friction = 0.3"
ROUGH = "contact set = 'bottom'  friction = 0.5"
# Normal force, and tangential force along x, of a cube of 4 x 4 x 4 cells whose top is moved, by a code of its own; of
# tetrahedra with six in a cell.
CUBES = {"hex8": (5.3940e-2, 5.465782e-3), "hex20": (5.3376e-2, 5.183580e-3), "tet10": (5.3375e-2, 5.21992e-3)}


def solid(*groups, size="1.0, 1.0, 1.0", cells="4, 4, 4", element="hex8", material="young = 1.0  poisson = 0.3",
          refine=0):
    """The deck of a box."""
    mesh = f"kind = 'box'  size = {size}  cells = {cells}  element = '{element}'  refine = {refine}"
    return block(*groups, mesh=mesh, material=material)


class SolidContact(ProgramTest):
    """Contact of solids."""

    def solve_verified(self, deck, name="case"):
        """Solves a case, whose files must be verified."""
        result = self.solve(deck, name)
        self.run_program("--verify", ".")
        return result

    def solve_summary(self, deck):
        """The summary of a case, without a contact set or with one."""
        self.run_program("--quiet", self.write("case.nml", deck))
        return json.loads((self.directory / "case.summary.json").read_text(encoding="utf-8"))

    def rows(self, name):
        """The rows of a sweep."""
        with open(self.directory / f"{name}.sweep.csv", newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table))

    def test_cube_has_the_forces_of_another_code(self):
        for element, (normal, along) in CUBES.items():
            with self.subTest(element):
                result = self.solve_verified(solid(TOP, FLOOR, element=element))
                key = result.summary["key_results"]
                # The digits that are known.
                self.assertAlmostEqual(key["contact_force_z"], normal, delta=1e-6)
                self.assertAlmostEqual(key["contact_force_x"], -along, delta=6e-9)
                self.assertEqual(set(result["status"]), {"stick", "slip"})
                areas = result.summary["areas"]
                self.assertAlmostEqual(areas["slip_area"] + areas["stick_area"], 1.0, delta=1e-12)

    def test_multipliers_at_corners_are_near_nodal_ones_and_the_same_on_linear_faces(self):
        for element in ("tet4", *CUBES):
            with self.subTest(element):
                corners = self.solve_verified(solid(TOP, f"{FLOOR}  multipliers = 'mortar'", element=element),
                                              "corners")
                nodal = self.solve(solid(TOP, FLOOR, element=element), "nodal")
                if element in ("tet4", "hex8"):
                    self.assert_close(corners["force_x"], nodal["force_x"], 1e-12)
                    self.assert_close(corners["contact_pressure"], nodal["contact_pressure"], 1e-12)
                    continue
                self.assertEqual(len(corners["x"]), 25)
                # Both are within some 1e-3 of the limit of fine meshes.
                for name in ("contact_force_x", "contact_force_z"):
                    ratio = corners.summary["key_results"][name]/nodal.summary["key_results"][name]
                    self.assertAlmostEqual(ratio, 1.0, delta=4e-3)
                estimates = [result.summary["accuracy"]["relative_error"] for result in (corners, nodal)]
                self.assertLess(estimates[0], 1.1*estimates[1])

    def test_multipliers_at_corners_transmit_a_uniform_pressure_of_any_faces(self):
        def bent(r, s, t):
            bubble = r*(1.0 - r)*s*(1.0 - s)
            return r + bubble*math.sin(4.0*s), s - bubble*math.cos(3.0*r), t + 0.3*t*(1.0 - t)*math.sin(3.0*r + 2.0*s)

        for element in ("tet4", *CUBES):
            self.write("bent.msh", mapped_solid((3, 2, 2), element, bent))
            for rest in ("contact set = 'left'  point = 0.0, 0.0, 0.0  normal = 1.0, 0.0, 0.0", "support set = 'left'  "
                         "ux = 0.0"):
                with self.subTest(element, rest=rest):
                    result = self.solve_verified(block(
                        rest, "support set = 'front'  uy = 0.0", "load set = 'top'  pressure = 1.0",
                        "load set = 'right'  pressure = 1.0", "contact set = 'bottom'  multipliers = 'mortar'",
                        mesh="file = 'bent.msh'", material="young = 1000.0  poisson = 0.3"))
                    # Loads and multipliers have the same quadrature; rounding.
                    self.assert_close(result["contact_pressure"], [1.0]*len(result["x"]), 1e-12)
                    self.assertLess(result.summary["accuracy"]["relative_error"], 1e-11)

    def test_large_quadratic_sets_have_multipliers_at_corners(self):
        cases = (("hex20", 26, "", " 729 contact points at corners alone;"), ("hex20", 24, "", " 1825 contact points;"),
                 ("hex20", 26, "multipliers = 'nodal'", " 2133 contact points;"),
                 ("hex8", 46, "", " 2209 contact points;"))
        for element, cells, key, text in cases:
            deck = self.write("case.nml", solid(TOP, f"{FLOOR}  {key}", cells=f"{cells}, {cells}, 1", element=element))
            self.assertIn(text, self.run_program("--check", deck).stdout)

    def test_refined_box_is_that_of_more_cells(self):
        for element in CUBES:
            # Reactions, moments and extremes of one mesh, whose nodes have other numbers.
            one = self.solve_verified(solid(TOP, FLOOR, cells="2, 2, 2", element=element, refine=1), "one").summary
            other = self.solve(solid(TOP, FLOOR, element=element), "other").summary
            for key, value in other["key_results"].items():
                self.assertAlmostEqual(one["key_results"][key], value, delta=1e-10, msg=f"{element} {key}")
            for key, value in other["areas"].items():
                self.assertAlmostEqual(one["areas"][key], value, delta=1e-10, msg=f"{element} {key}")

    def test_uniform_stress_has_no_estimated_error(self):
        # The pressure of the contact points, transformed middles included, is the traction that is known there.
        for element in ("tet4", *CUBES):
            result = self.solve(solid("support set = 'left'  ux = 0.0", "support set = 'front'  uy = 0.0",
                                      "load set = 'top'  pressure = 1e-3", "contact set = 'bottom'", element=element))
            self.assertLess(result.summary["accuracy"]["relative_error"], 1e-12, element)

    def test_estimate_is_the_error_of_a_smooth_solution(self):
        # Strain energy of the block that rotates, extrapolated from hex20 with 4 and 8 cells: the square of the norm of
        # the error is twice what the energy lacks. Tetrahedra in pairs of six are known for estimates that are low.
        truth = 9.795195e-6
        held = ("support set = 'left'  ux = 0.0", "support set = 'front'  uy = 0.0", "support set = 'bottom'  uz = 0.0")
        cases = (("hex8", (2, 4), 0.95, 1.05, 0.52), ("tet4", (4, 8), 0.7, 0.85, 0.6),
                 ("hex20", (2, 4), 0.9, 1.2, 0.28), ("tet10", (2, 4), 0.85, 1.1, 0.33))
        for element, cells, least, most, fall in cases:
            norms = []
            for n in cells:
                result = self.solve_summary(solid(*held, "load angular_speed = 0.1  axis = 0.0, 0.0, 1.0",
                                                  cells=f"{n}, {n}, {n}", element=element,
                                                  material="young = 1.0  poisson = 0.3  density = 1.0"))
                norms.append(result["accuracy"]["error_norm"])
                error = math.sqrt(2.0*(truth - result["certificate"]["strain_energy"]))
                self.assertTrue(least < norms[-1]/error < most or n == 2, (element, n, norms[-1]/error))
            self.assertLess(norms[1], fall*norms[0], element)

    def test_estimate_of_a_layer_is_nearly_that_of_the_plane(self):
        # Across a layer the samples of linear elements lie in a plane, and those of quadratic ones in two. The stress
        # across is fitted by itself, and not that of plane strain.
        held, floor = "support set = 'right'  ux = 0.0", "contact set = 'bottom'  friction = 1.0"
        material = "young = 13000.0  poisson = 0.2"
        for plane, layer, limit in (("quad4", "hex8", 0.15), ("tri3", "tet4", 0.15), ("quad8", "hex20", 0.6)):
            section = self.solve_summary(block(
                held, floor, "load set = 'left'  traction = 10.0, 0.0", "load set = 'top'  traction = 0.0, -5.0",
                mesh=f"size = 40.0, 40.0  cells = 8, 8  element = '{plane}'", material=material))
            solved = self.solve_summary(solid(
                held, floor, "load set = 'left'  traction = 10.0, 0.0, 0.0",
                "load set = 'top'  traction = 0.0, 0.0, -5.0", "support set = 'front'  uy = 0.0",
                "support set = 'back'  uy = 0.0", size="40.0, 1.0, 40.0", cells="8, 1, 8", element=layer,
                material=material))
            ratio = solved["accuracy"]["error_norm"]/section["accuracy"]["error_norm"]
            self.assertLess(abs(ratio - 1.0), limit, layer)

    def test_truth_lies_within_the_error_bars(self):
        # The limits of CUBES, extrapolated from meshes of up to 40 cells and of quadratic elements.
        limits = {"contact_force_z": 5.317e-2, "contact_force_x": -5.160e-3}
        for element, cells in (("hex8", "4, 4, 4"), ("tet4", "4, 4, 4"), ("tet10", "2, 2, 2"), ("hex20", "2, 2, 2")):
            result = self.solve_verified(solid(TOP, FLOOR, "accuracy refinements = 2", cells=cells, element=element))
            for key, limit in limits.items():
                judged = result.summary["convergence"][key]
                self.assertEqual(judged["verdict"], "converging", (element, key))
                self.assertLess(abs(judged["values"][-1] - limit), judged["error_bar"], (element, key))
                self.assertLess(judged["error_bar"], 0.1*abs(limit), (element, key))

    def test_layer_is_the_plane(self):
        held, material = "support set = 'right'  ux = 0.0", "young = 13000.0  poisson = 0.2"
        for friction in (1.0, 0.4, 0.2):
            floor = f"contact set = 'bottom'  friction = {friction}"
            plane = self.solve(block(held, "load set = 'left'  traction = 10.0, 0.0", floor,
                                     "load set = 'top'  traction = 0.0, -5.0", material=material,
                                     mesh="size = 40.0, 40.0  cells = 16, 8"), "plane")
            layer = self.solve_verified(solid(
                held, "support set = 'front'  uy = 0.0", "support set = 'back'  uy = 0.0", floor,
                "load set = 'left'  traction = 10.0, 0.0, 0.0", "load set = 'top'  traction = 0.0, 0.0, -5.0",
                size="40.0, 1.0, 40.0", cells="16, 1, 8", material=material), "layer")
            rows = list(zip(layer["x"], layer["force_x"], layer["force_z"], layer["status"]))
            for x, shear, normal, status in zip(plane["x"], plane["tangential_force"], plane["normal_force"],
                                                plane["status"]):
                both = [row for row in rows if abs(row[0] - x) < 1e-9]
                self.assertEqual(len(both), 2)
                # Of forces of up to 50 two routes through different factors leave some 1e-12.
                self.assertAlmostEqual(sum(row[2] for row in both), normal, delta=5e-9)
                self.assertAlmostEqual(abs(sum(row[1] for row in both)), abs(shear), delta=5e-9)
                for row in both:
                    self.assertEqual(row[3], status.rstrip("+-"), x)

    def test_pushed_block_is_held_by_friction_along_the_push_and_no_more(self):
        angle = math.radians(37.0)
        for push, status in ((0.19, 0), (0.21, 2)):
            deck = solid(f"load set = 'top'  traction = {push*math.cos(angle)}, {push*math.sin(angle)}, -1.0",
                         "contact set = 'bottom'  friction = 0.2", size="2.0, 2.0, 1.0", cells="4, 4, 2",
                         material="young = 1000.0  poisson = 0.3")
            run = self.run_program("--quiet", self.write("case.nml", deck), status=status)
            if status:
                self.assertIn("contact and friction cannot balance the loads; the body is free to translate along"
                              " (1.0, 0.7536", run.stderr)
                continue
            key = self.result("case").summary["key_results"]
            # Forces of 4 in equilibrium to 1e-10 of them.
            self.assertAlmostEqual(key["contact_force_z"], 4.0, delta=1e-9)
            self.assertAlmostEqual(key["contact_force_x"], -4.0*push*math.cos(angle), delta=1e-9)
            self.assertAlmostEqual(key["contact_force_y"], -4.0*push*math.sin(angle), delta=1e-9)

    def test_total_moment_is_the_moment_and_no_force(self):
        push = "load set = 'top'  total_moment = 0.02, -0.03, 0.05"
        for element in CUBES:
            with self.subTest(element):
                result = self.solve_verified(solid("load set = 'top'  pressure = 1.0", push, ROUGH,
                                                   size="2.0, 1.0, 1.0", element=element))
                key = result.summary["key_results"]
                # Moments about the origin; the pressure of 1 acts in the middle of 2 x 1. To rounding of forces of 2.
                expected = {"force_x": 0.0, "force_y": 0.0, "force_z": 2.0, "moment_x": 1.0 - 0.02,
                            "moment_y": -2.0 + 0.03, "moment_z": -0.05}
                for name, exact in expected.items():
                    self.assertAlmostEqual(key[f"contact_{name}"], exact, delta=1e-12, msg=name)

    def test_rigid_sets_obey_statics_also_where_they_share_the_rim_of_the_contact(self):
        grip = "rigid name = 'grip'  set = '{}'  force = 0.1, 0.0, -1.0  moment = 0.02, -0.3, 0.01"
        for side, place in (("left", (0.0, 0.5, 0.5)), ("top", (1.0, 0.5, 1.0))):
            for element, key in ((*((name, "") for name in CUBES), ("hex20", "multipliers = 'mortar'"))):
                with self.subTest(side, element=element, key=key):
                    result = self.solve_verified(solid(
                        grip.format(side), "load set = 'right'  traction = 0.0, 0.0, -1.0", f"{ROUGH}  {key}",
                        size="2.0, 1.0, 1.0", cells="4, 2, 2", element=element))
                    key = result.summary["key_results"]
                    # On the grip, and 1 on the right end at (2, 1/2, 1/2); to rounding of moments of 2.
                    expected = {"force_x": -0.1, "force_y": 0.0, "force_z": 2.0,
                                "moment_x": -(0.02 - place[1] - 0.5),
                                "moment_y": -(-0.3 + place[2]*0.1 + place[0] + 2.0),
                                "moment_z": -(0.01 - place[1]*0.1)}
                    for name, exact in expected.items():
                        self.assertAlmostEqual(key[f"contact_{name}"], exact, delta=1e-11, msg=name)
                    self.assertAlmostEqual(key["rigid_grip_force_x"], 0.1, delta=1e-11)

    def test_aslant_body_without_friction_is_verified(self):
        # Its shears are rounding errors of forces along no axis.
        cosine, sine = math.cos(0.3), math.sin(0.3)

        def aslant(r, s, t):
            return r*cosine + t*sine, s*cosine - (t*cosine - r*sine)*sine, s*sine + (t*cosine - r*sine)*cosine
        normal = sine, -sine*cosine, cosine*cosine
        deck = block("support set = 'top'  ux = 0.001  uy = 0.001  uz = -0.002", "contact set = 'bottom'  "
                     f"normal = {normal[0]}, {normal[1]}, {normal[2]}  obstacle = 'sphere'  radius = 40.0",
                     material="young = 1.0  poisson = 0.3",
                     mesh=f"file = '{self.write('cube.msh', mapped_solid((3, 3, 3), 'hex8', aslant))}'")
        result = self.solve_verified(deck)
        self.assertLess(max(result["tangential_force"]), 1e-15)
        self.assertGreater(max(result["normal_force"]), 1e-5)

    def test_row_of_a_sweep_is_the_case(self):
        rest = ("load set = 'top'  pressure = 1.0", FLOOR)
        for element in CUBES:
            with self.subTest(element):
                sweep = solid(*rest, "load name = 'push'  set = 'top'  traction = 0.2, 0.1, 0.0",
                              "sweep load = 'push'  factor = 0.0, 0.5, 2.0", element=element)
                self.run_program("--quiet", self.write("rows.nml", sweep))
                row = self.rows("rows")[1]
                case = self.solve(solid(*rest, "load set = 'top'  traction = 0.1, 0.05, 0.0", element=element)).summary
                for name, value in {**case["key_results"], **case["areas"]}.items():
                    if name in row:
                        # Loads that are summed after their condensation differ by rounding.
                        self.assertAlmostEqual(float(row[name]), value, delta=1e-12*max(1.0, abs(value)), msg=name)
                self.assertEqual(self.rows("rows")[2]["outcome"], "no_equilibrium")
                self.run_program("--verify", ".")


if __name__ == "__main__":
    unittest.main()
