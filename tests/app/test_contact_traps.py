#!/usr/bin/env python3
"""Traps that contact programs of solids have fallen into: uniform states at edges and corners where supports, symmetry
planes and obstacles meet; units; the order of groups; what goes in at the top comes out at the floor."""
import math
import shutil
import unittest
from pathlib import Path

from harness import ProgramTest, block

MESHES = Path(__file__).resolve().parents[1] / "meshes"
ELEMENTS = ("hex8", "hex20", "tet4", "tet10")
FORCES = ("force_x", "force_y", "force_z")


def solid(*groups, size="1.0, 1.0, 1.0", cells="3, 3, 3", element="hex8", material="young = 1.0  poisson = 0.3",
          origin="0.0, 0.0, 0.0"):
    """The deck of a box."""
    return block(*groups, material=material,
                 mesh=f"kind = 'box'  size = {size}  cells = {cells}  element = '{element}'  origin = {origin}")


class ContactTraps(ProgramTest):
    """Small decks with known answers."""

    def solve_verified(self, deck, name="case"):
        """Solves a case, whose files must be verified."""
        result = self.solve(deck, name)
        self.run_program("--verify", ".")
        return result

    def expect_pressures(self, result, expected, message):
        """Asserts the pressure at every contact point by the direction of its normal."""
        for normal, pressure in zip(zip(*(result[f"normal_{axis}"] for axis in "xyz")), result["contact_pressure"]):
            axis = max(range(3), key=lambda k: abs(normal[k]))
            # Some thousand operations on numbers of 1.
            self.assertAlmostEqual(pressure, expected[axis], delta=1e-11, msg=message)

    def test_uniform_pressure_where_contact_nodes_carry_supports(self):
        # Two symmetry planes through edges of the contact, which meet in its corner.
        planes = "support set = 'left'  ux = 0.0", "support set = 'front'  uy = 0.0"
        for element in ELEMENTS:
            for friction in (0.0, 0.3):
                result = self.solve_verified(solid(
                    *planes, "load set = 'top'  pressure = 1.0", f"contact set = 'bottom'  friction = {friction}",
                    material="young = 10.0  poisson = 0.0", element=element))
                self.expect_pressures(result, (None, None, 1.0), element)
                self.assertAlmostEqual(sum(result["area"]), 1.0, delta=1e-12)
            # With Poisson's effect the frictionless floor lets it spread.
            result = self.solve_verified(solid(*planes, "load set = 'top'  pressure = 1.0", "contact set = 'bottom'",
                                               element=element))
            self.expect_pressures(result, (None, None, 1.0), element)
            for axis in "xy":
                for place, slip in zip(result[axis], result[f"slip_{axis}"]):
                    self.assertAlmostEqual(slip, 0.3*place, delta=1e-11, msg=element)

    def test_uniform_pressure_where_two_and_three_obstacles_meet(self):
        # A floor and two walls; the nodes of the edges are points of both sets, the corner of three.
        self.write("wall.stl", "solid wall\n" + "".join(
            "facet normal 1 0 0\nouter loop\n" + "".join(f"vertex 0 {y} {z}\n" for y, z in corners)
            + "endloop\nendfacet\n" for corners in (((-9, -9), (9, -9), (9, 9)), ((-9, -9), (9, 9), (-9, 9)))) +
            "endsolid wall\n")
        for element in ELEMENTS:
            for wall in ("normal = 1.0, 0.0, 0.0", "obstacle = 'surface'  file = 'wall.stl'"):
                deck = solid("load set = 'top'  pressure = 1.0", "load set = 'right'  pressure = 0.5",
                             "load set = 'back'  pressure = 0.25", "contact set = 'bottom'",
                             f"contact set = 'left'  {wall}", "contact set = 'front'  normal = 0.0, 1.0, 0.0",
                             element=element)
                self.expect_pressures(self.solve_verified(deck), (0.5, 0.25, 1.0), element)

    def test_floor_of_one_facet_and_of_a_fan_about_a_node(self):
        # One triangle larger than the body; twelve about a corner, an edge or the middle of the sole.
        def floor(name, corners):
            self.write(f"{name}.stl", "solid floor\n" + "".join(
                "facet normal 0 0 1\nouter loop\n" + "".join(f"vertex {x!r} {y!r} 0\n" for x, y in triangle)
                + "endloop\nendfacet\n" for triangle in corners) + "endsolid floor\n")
        floor("facet", [((-9.0, -9.0), (21.0, -9.0), (-9.0, 21.0))])
        rim = [(9.0*math.cos(k*math.pi/6 + 0.1), 9.0*math.sin(k*math.pi/6 + 0.1)) for k in range(13)]
        for name, (x, y) in (("corner", (0.0, 0.0)), ("edge", (0.5, 0.0)), ("middle", (0.5, 0.5))):
            floor(name, [((x, y), one, other) for one, other in zip(rim, rim[1:])])
        for element in ELEMENTS:
            for name in ("facet", "corner", "edge", "middle"):
                result = self.solve_verified(solid(
                    "support set = 'left'  ux = 0.0", "support set = 'front'  uy = 0.0",
                    "load set = 'top'  pressure = 1.0",
                    f"contact set = 'bottom'  obstacle = 'surface'  file = '{name}.stl'", cells="4, 4, 2",
                    element=element))
                self.expect_pressures(result, (None, None, 1.0), f"{element} {name}")

    def test_master_of_one_face_and_masters_that_are_finer(self):
        planes = [f"support set = '{name}'  {key} = 0.0" for body in ("low", "high") for name, key in (
            (f"{body}.left", "ux"), (f"{body}.front", "uy"))]
        for element in ELEMENTS:
            for cells in ("1, 1, 1", "4, 4, 2", "7, 5, 2"):
                deck = "".join(f"&{group} /\n" for group in (
                    f"mesh name = 'low'  kind = 'box'  size = 1.0, 1.0, 1.0  cells = {cells}  element = '{element}'  "
                    "origin = 0.0, 0.0, -1.0",
                    f"mesh name = 'high'  kind = 'box'  size = 1.0, 1.0, 1.0  cells = 2, 2, 2  element = '{element}'",
                    "material young = 10.0  poisson = 0.3", "support set = 'low.bottom'  uz = 0.0", *planes,
                    "load set = 'high.top'  pressure = 1.0",
                    "contact set = 'high.bottom'  against = 'low.top'  friction = 0.2"))
                self.expect_pressures(self.solve_verified(deck), (None, None, 1.0), f"{element} {cells}")

    def test_quarter_between_symmetry_planes_is_a_quarter_of_the_whole(self):
        floor, push = "contact set = 'bottom'  friction = 0.2", "support set = 'top'  ux = 0.0  uy = 0.0  uz = -0.1"
        for element in ("hex8", "hex20"):
            whole = self.solve_verified(solid(push, floor, cells="4, 4, 3", size="2.0, 2.0, 1.0", element=element,
                                              origin="-1.0, -1.0, 0.0"))
            quarter = self.solve_verified(solid(push, floor, "support set = 'left'  ux = 0.0", "support set = 'front'  "
                                                "uy = 0.0", cells="2, 2, 3", element=element))
            self.assertAlmostEqual(whole.summary["key_results"]["contact_force_z"],
                                   4.0*quarter.summary["key_results"]["contact_force_z"], delta=1e-10)
            pressures = {(round(x, 6), round(y, 6)): p for x, y, p in zip(whole["x"], whole["y"],
                                                                          whole["contact_pressure"])}
            for x, y, pressure in zip(quarter["x"], quarter["y"], quarter["contact_pressure"]):
                # Pressures of up to 1; two factorizations.
                self.assertAlmostEqual(pressure, pressures[round(x, 6), round(y, 6)], delta=1e-9, msg=element)
            self.assertIn("slip", quarter["status"])

    def test_support_moves_a_middle_as_its_corners(self):
        # Without Poisson's effect and friction the body moves as one.
        for element in ELEMENTS:
            result = self.solve_verified(solid(
                "support set = 'left'  ux = 0.01", "support set = 'front'  uy = -0.02",
                "support set = 'top'  uz = -0.05", "contact set = 'bottom'",
                material="young = 1.0  poisson = 0.0", element=element))
            for axis, slip in (("x", 0.01), ("y", -0.02)):
                for found in result[f"slip_{axis}"]:
                    self.assertAlmostEqual(found, slip, delta=1e-13, msg=element)
            self.expect_pressures(result, (None, None, 0.05), element)

    def test_forces_are_the_same_in_mm_and_m(self):
        def deck(unit, element):
            def vector(*numbers):
                return ", ".join(repr(number*unit) for number in numbers)
            return solid(f"support set = 'top'  ux = {0.02*unit!r}  uy = {0.005*unit!r}  uz = {-0.05*unit!r}",
                         "contact set = 'bottom'  friction = 0.3  obstacle = 'sphere'  "
                         f"radius = {-40.0*unit!r}  point = {vector(6.0, 4.0, 0.0)}",
                         f"load set = 'right'  pressure = {20.0/unit**2!r}", size=vector(12.0, 8.0, 10.0),
                         material=f"young = {2.1e5/unit**2!r}  poisson = 0.3", element=element)
        for element in ELEMENTS:
            both = [self.solve_verified(deck(unit, element)) for unit in (1.0, 1e-3)]
            self.assertEqual(both[0]["status"], both[1]["status"])
            largest = max(both[0]["normal_force"])
            self.assertGreater(largest, 100.0)
            for axis in FORCES:
                for one, other in zip(both[0][axis], both[1][axis]):
                    # Solved to 1e-10.
                    self.assertAlmostEqual(one, other, delta=1e-9*largest, msg=element)

    def test_order_of_materials_and_of_other_groups_is_of_no_matter(self):
        groups = ["material young = 100.0  poisson = 0.3",
                  "material region = 'left half'  young = 300.0  poisson = 0.2",
                  "contact set = 'bottom'  friction = 0.3",
                  "load set = '40'  pressure = 1.0",
                  "support set = 'right end'  ux = 0.01", "load set = '40'  traction = 0.1, 0.2, 0.0"]
        for file in ("tet4-41.msh", "hex8-41.msh", "tet10-22.msh", "hex20-22.msh"):
            shutil.copy(MESHES / file, self.directory)
            forces = []
            for order in (groups, groups[1::-1] + groups[2:], groups[::-1]):
                deck = "".join(f"&{group} /\n" for group in (f"mesh kind = 'file'  file = '{file}'", *order))
                result = self.solve_verified(deck)
                forces.append([result[axis] for axis in FORCES])
            for other in forces[1:]:
                for one, two in zip(sum(forces[0], []), sum(other, [])):
                    # Loads are summed in another order.
                    self.assertAlmostEqual(one, two, delta=1e-10, msg=file)

    def test_what_goes_in_at_the_top_comes_out_at_the_floor(self):
        for element in ELEMENTS:
            for obstacle in ("", "obstacle = 'cylinder'  radius = 9.0  axis = 0.3, 1.0, 0.0"):
                result = self.solve_verified(solid("support set = 'top'  ux = 0.02  uy = 0.005  uz = -0.05",
                                                   f"contact set = 'bottom'  friction = 0.3  {obstacle}",
                                                   element=element, material="young = 2.1e5  poisson = 0.35"))
                key = result.summary["key_results"]
                scale = math.hypot(*(key[f"contact_{name}"] for name in FORCES))
                for axis in "xyz":
                    force, moment = key[f"contact_force_{axis}"], key[f"contact_moment_{axis}"]
                    self.assertAlmostEqual(force, -key[f"reaction_{axis}_top"], delta=1e-10*scale)
                    self.assertAlmostEqual(moment, -key[f"reaction_moment_{axis}_top"], delta=1e-10*scale)
                    self.assertAlmostEqual(sum(result[f"force_{axis}"]), force, delta=1e-12*scale)


if __name__ == "__main__":
    unittest.main()
