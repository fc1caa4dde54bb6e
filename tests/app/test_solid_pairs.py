#!/usr/bin/env python3
"""Solids on solids: pairs and ties of any two kinds of elements, against the plane, equilibrium and another code."""
import itertools
import math
import random
import unittest

from harness import ProgramTest
from mapped_solid import mapped_solid
from solid_blocks import block_of_hexahedra, distorted, mesh_text, rotation, turned

KINDS = ("tet4", "hex8", "tet10", "hex20")
PLANES = "".join(f"&support set = '{name}'  {key} = 0.0 /\n" for name, key in (
    ("low.left", "ux"), ("low.front", "uy"), ("high.left", "ux"), ("high.front", "uy")))
PUSHED = """&support set = 'low.bottom'  ux = 0.0  uy = 0.0  uz = 0.0 /
&support set = 'high.top'  ux = {}  uy = {}  uz = -0.01 /
&contact set = {}  against = {}  friction = 0.1 /
"""
BLOCKS = {"cells": ("12, 12, 4", "6, 6, 6"), "sizes": ("3.0, 3.0, 1.0", "1.0, 1.0, 1.0"),
          "origins": ("-1.0, -1.0, -1.0", "0.0, 0.0, 0.0"), "young": 1000.0}


def boxes(low, high, *, cells=("3, 2, 2", "4, 3, 2"), sizes=("1.0, 1.0, 1.0", "1.0, 1.0, 1.0"),
          origins=("0.0, 0.0, -1.0", "0.0, 0.0, 0.0"), young=100.0):
    """The meshes of a low and a high block of given elements, and their material."""
    parts = zip(("low", "high"), sizes, cells, origins, (low, high))
    return "".join(f"&mesh name = '{name}'  kind = 'box'  size = {size}  cells = {cell}  origin = {origin}"
                   f"  element = '{element}' /\n" for name, size, cell, origin, element in parts) + (
                       f"&material young = {young}  poisson = 0.3 /\n")


class SolidPairs(ProgramTest):
    """Pairs and ties of solids."""

    def solve_verified(self, deck, name="case"):
        """Solves a case, whose files must be verified."""
        result = self.solve(deck, name)
        self.run_program("--verify", ".")
        return result

    def test_pressure_is_uniform_between_any_two_kinds_of_elements(self):
        for high, low in itertools.product(KINDS, KINDS):
            for relation in ("contact set = 'high.bottom'  against = 'low.top'  friction = 0.2",
                             "tie set = 'high.bottom'  to = 'low.top'"):
                with self.subTest(high=high, low=low, relation=relation):
                    base = "support set = 'low.bottom'  uz = 0.0"
                    if relation.startswith("tie"):
                        base = "contact set = 'low.bottom'"
                    result = self.solve_verified(boxes(low, high) + PLANES + f"&{base} /\n&{relation} /\n"
                                                 "&load set = 'high.top'  pressure = 1.0 /\n")
                    # Rounding of two bodies that are factorized together.
                    self.assert_close(result["contact_pressure"], [1.0]*len(result["x"]), 1e-12)

    def test_patch_test_of_distorted_blocks_in_any_position(self):
        rng = random.Random(5)
        for element in ("hex8", "hex20"):
            axes = rotation(rng)
            blocks = [block_of_hexahedra(name, cells, distorted(rng, cells, 0.12, lambda point, z=z: turned(
                axes, [point[0], point[1], point[2] + z])), element, is_straight=True)
                for name, cells, z in (("low", (3, 6, 3), -1.0), ("high", (5, 4, 3), 0.0))]
            self.write("blocks.msh", mesh_text(*blocks))
            down = ", ".join(str(-row[2]) for row in axes)
            up = ", ".join(str(row[2]) for row in axes)
            planes = "".join(f"&support set = '{name}'  un = 0.0 /\n"
                             for name in ("low.left", "low.front", "high.left", "high.front"))
            for relation in ("support set = 'low.bottom'  un = 0.0 /\n"
                             "&contact set = 'high.bottom'  against = 'low.top'  friction = 0.2",
                             f"contact set = 'low.bottom'  point = {down}  normal = {up} /\n"
                             "&tie set = 'high.bottom'  to = 'low.top'"):
                with self.subTest(element, relation=relation):
                    result = self.solve_verified("&mesh file = 'blocks.msh' /\n&material young = 100.0  poisson = 0.3 "
                                                 f"/\n{planes}&load set = 'high.top'  pressure = 1.0 /\n&{relation} "
                                                 "/\n")
                    # The rule of degree 8 for faces whose shape functions are not polynomials in their plane.
                    self.assert_close(result["contact_pressure"], [1.0]*len(result["x"]), 1e-9)

    def test_tie_between_moving_planes_leaves_the_strain_uniform(self):
        for high, low in itertools.product(KINDS, KINDS):
            with self.subTest(high=high, low=low):
                result = self.solve_verified(
                    boxes(low, high) + PLANES + "&support set = 'low.bottom'  uz = 0.0 /\n"
                    "&support set = 'low.right'  ux = 0.01 /\n&support set = 'high.right'  ux = 0.01 /\n"
                    "&tie set = 'high.bottom'  to = 'low.top' /\n")
                # Rounding, as above: of shear stresses of 1e-12 the root of a sum of squares shows nothing.
                self.assertAlmostEqual(result.summary["key_results"]["max_von_mises"], 1.0, delta=1e-11)

    def test_rings_in_each_other_have_the_pressure_of_lame(self):
        # A quarter of a tube of radii 0.5, 1 and 1.5 with an inner pressure of 10, held along its axis.
        def quarter(inner, outer, cells, element):
            def place(r, s, t):
                radius, angle = inner + (outer - inner)*r, 0.5*math.pi*s
                return radius*math.cos(angle), radius*math.sin(angle), 0.4*t
            return mapped_solid(cells, element, place)

        for inner, outer in (("tet10", "hex20"), ("hex20", "tet10"), ("tet10", "tet10")):
            self.write("inner.msh", quarter(0.5, 1.0, (4, 6, 2), inner))
            self.write("outer.msh", quarter(1.0, 1.5, (4, 5, 1), outer))
            body = "".join(
                f"&mesh name = '{name}'  file = '{name}.msh' /\n&support set = '{name}.front'  uy = 0.0 /\n"
                f"&support set = '{name}.back'  ux = 0.0 /\n&support set = '{name}.bottom'  uz = 0.0 /\n"
                f"&support set = '{name}.top'  uz = 0.0 /\n" for name in ("inner", "outer"))
            for relation in ("tie set = 'inner.right'  to = 'outer.left'",
                             "contact set = 'inner.right'  against = 'outer.left'  friction = 0.3",
                             "contact set = 'outer.left'  against = 'inner.right'"):
                with self.subTest(inner=inner, outer=outer, relation=relation):
                    result = self.solve_verified(body + "&material young = 1000.0  poisson = 0.3 /\n"
                                                 f"&load set = 'inner.left'  pressure = 10.0 /\n&{relation} /\n")
                    # Six quadratic elements in 90 degrees.
                    self.assertAlmostEqual(result.summary["key_results"]["max_displacement"]/0.0076375, 1.0, delta=1e-3)
                    if relation.startswith("contact"):
                        self.assert_close([p/1.5625 for p in result["contact_pressure"]], [1.0]*len(result["x"]), 0.012)

    def solve_layer_and_plane(self, conditions, delta):
        """Solves two blocks in the plane and as a layer of hexahedra, whose forces must agree."""
        conditions = ("&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /\n" + conditions
                      + "&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /\n")
        plane = self.solve(
            "&mesh name = 'low'  size = 3.0, 1.0  cells = 12, 4  origin = -1.0, -1.0 /\n"
            "&mesh name = 'high'  size = 1.0, 1.0  cells = 6, 6 /\n&material young = 1000.0  poisson = 0.3 /\n"
            + conditions, "plane")
        layer = self.solve_verified(
            boxes("hex8", "hex8", cells=("12, 1, 4", "6, 1, 6"), sizes=("3.0, 0.5, 1.0", "1.0, 0.5, 1.0"),
                  origins=("-1.0, 0.0, -1.0", "0.0, 0.0, 0.0"), young=1000.0)
            + "".join(f"&support set = '{name}.{side}'  uy = 0.0 /\n" for name in ("low", "high")
                      for side in ("front", "back")) + conditions.replace("uy", "uz"), "layer")
        rows = list(zip(layer["x"], layer["normal_force"], layer["tangential_force"], layer["status"]))
        for x, normal, shear, status in zip(plane["x"], plane["normal_force"], plane["tangential_force"],
                                            plane["status"]):
            both = [row for row in rows if abs(row[0] - x) < 1e-9]
            self.assertEqual(len(both), 2)
            self.assertAlmostEqual(2.0*sum(row[1] for row in both), normal, delta=delta)
            self.assertAlmostEqual(2.0*sum(row[2] for row in both), abs(shear), delta=delta)
            self.assertEqual({row[3] for row in both}, {status.rstrip("+-")})
        return plane

    def test_layer_is_the_plane(self):
        for push in (0.0, 0.002, 0.02):
            # Of forces of up to 3 two routes through different factors leave some 1e-14.
            self.solve_layer_and_plane(f"&support set = 'high.top'  ux = {push}  uy = -0.01 /\n", 1e-11)

    def test_slave_that_a_support_guides_slips_on_a_master_that_goes_on(self):
        for pressure in (0.0, -10.0):
            plane = self.solve_layer_and_plane(
                "&support set = 'high.left'  ux = 0.0 /\n&support set = 'high.top'  uy = -0.01 /\n"
                # The slip of a guided point is a sum over unknowns of the master: Newton's last residual shows more.
                f"&load set = 'high.right'  pressure = {pressure} /\n", 1e-10)
            # The guided edge slips, too.
            self.assertGreater(abs(plane["tangential_force"][0]), 0.01)

    def test_sets_with_common_faces_are_named_as_such(self):
        # A box around the top of the lower body holds the bottom of the upper one, too.
        low = block_of_hexahedra("low", (2, 2, 1), lambda point: [2.0*x - 0.5 for x in point[:2]] + [point[2] - 1.0])
        high = block_of_hexahedra("high", (2, 2, 1), list)
        both = [("low.top", kind, points) for name, kind, points in high if name == "high.bottom"]
        self.write("blocks.msh", mesh_text(low, high + both))
        deck = self.write("case.nml", "&mesh file = 'blocks.msh' /\n&material young = 100.0  poisson = 0.3 /\n"
                          "&support set = 'low.bottom'  uz = 0.0 /\n&load set = 'high.top'  pressure = 1.0 /\n"
                          "&contact set = 'high.bottom'  against = 'low.top' /\n")
        run = self.run_program(deck, status=1)
        self.assertIn("'high.bottom' and 'low.top' share nodes, as at 0.0, 0.0, 0.0: these bodies are joined there, or "
                      "both sets have a side\n", run.stderr)

    def test_plane_of_symmetry_through_both_bodies_loses_no_friction(self):
        # Corners of the master beside the plane are nearer than those on it, which they were mistaken for.
        self.write("low.msh", mapped_solid((3, 6, 2), "hex8", lambda r, s, t: (
            3.0*r - 0.5 + 0.5*(round(6.0*s) % 2), 1.2*s, t - 1.0)))
        for held, slides in ((0.0, False), (0.003, True)):
            result = self.solve_verified(
                "&mesh name = 'low'  file = 'low.msh' /\n&mesh name = 'high'  kind = 'box'  size = 1.5, 1.0, 1.0  "
                "cells = 6, 4, 3 /\n&material young = 100.0  poisson = 0.3 /\n"
                f"&support set = 'low.bottom'  ux = 0.0  uy = {held}  uz = 0.0 /\n"
                f"&support set = 'low.front'  uy = {held} /\n&support set = 'high.front'  uy = 0.0 /\n"
                "&load set = 'high.top'  traction = 0.1, 0.0, -1.0 /\n"
                "&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3 /\n")
            found = [text for text in result.summary["warnings"] if "slides without friction" in text]
            self.assertEqual(len(found), slides)

    def test_corner_that_the_master_hardly_covers_is_no_point(self):
        # The master ends just beyond corners of the slave: pressures there were six to nine times the mean.
        for element, origin, size in (("tet10", "0.48, -0.03", "0.7, 0.8"), ("hex8", "0.5, 0.04", "0.85, 0.93"),
                                      ("tet4", "0.16, -0.02", "0.7, 0.98")):
            with self.subTest(element):
                result = self.solve_verified(
                    boxes("hex8", element, cells=("3, 3, 3", "4, 5, 3"), sizes=(f"{size}, 1.0", "1.6, 1.5, 1.0"),
                          origins=(f"{origin}, -1.0", "0.1, -0.2, 0.0"), young=1000.0)
                    + "&support set = 'low.bottom'  ux = 0.0  uy = 0.0  uz = 0.0 /\n"
                    "&support set = 'high.top'  ux = 0.0  uy = 0.0  uz = -0.01 /\n"
                    "&contact set = 'high.bottom'  against = 'low.top'  friction = 0.2 /\n")
                covered = math.prod(map(float, size.split(",")))
                self.assertAlmostEqual(sum(result["area"]), covered, delta=1e-12)
                # The edges of the block that presses are singular, by a power of less than a half.
                self.assertLess(max(result["contact_pressure"]), 2.5*sum(result["normal_force"])/covered)

    def test_block_on_block_has_the_forces_of_another_code(self):
        # CalculiX with incompatible modes: N and T of a block that is pressed, then pushed.
        for push, normal, shear in (((0.02, 0.0), 7.0058, (0.6983, 0.0)), ((0.015, 0.01), 7.0064, (0.5809, 0.3872))):
            for element, digits in (("hex8", 0.014), ("hex20", 0.020)):
                found = []
                for sets in (("'high.bottom'", "'low.top'"), ("'low.top'", "'high.bottom'")):
                    with self.subTest(element, push=push, slave=sets[0]):
                        result = self.solve_verified(boxes(element, element, **BLOCKS) + PUSHED.format(*push, *sets))
                        sign = -1.0 if sets[0] == "'high.bottom'" else 1.0
                        key = result.summary["key_results"]
                        forces = [sign*key[f"contact_force_{axis}"] for axis in "xyz"]
                        # Other elements on the same mesh, their edges singular; one way finer than the other.
                        self.assertAlmostEqual(-forces[2]/normal, 1.0, delta=digits)
                        self.assert_close([forces[0], forces[1]], [t*(-forces[2])/normal for t in shear], 2e-3)
                        # All slip, nearly along the push: the resultant is a little less than the sum.
                        self.assertAlmostEqual(sum(result["tangential_force"]), 0.1*sum(result["normal_force"]),
                                               delta=1e-10)
                        found.append(forces[2])
                # Roles exchanged.
                self.assertAlmostEqual(found[0]/found[1], 1.0, delta=2e-3)

    def test_overlap_of_two_cubes_is_pressed_away_evenly(self):
        for high, low in (("hex8", "hex8"), ("tet10", "hex20"), ("hex20", "tet4")):
            with self.subTest(high=high, low=low):
                for z, gap in ((-0.01, ""), (0.0, "extra_gap = -0.01"),
                               (0.3, "gap = 'touching'  extra_gap = -0.01  search = 0.4")):
                    result = self.solve_verified(
                        boxes(low, high, cells=("4, 3, 3", "3, 5, 3"), origins=("0.0, 0.0, -1.0", f"0.0, 0.0, {z}"))
                        + PLANES + "&support set = 'low.bottom'  uz = 0.0 /\n&support set = 'high.top'  uz = 0.0 /\n"
                        f"&contact set = 'high.bottom'  against = 'low.top'  {gap} /\n")
                    self.assert_close(result["contact_pressure"], [0.5]*len(result["x"]), 1e-11)


if __name__ == "__main__":
    unittest.main()
