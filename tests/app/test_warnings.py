#!/usr/bin/env python3
"""Warnings: what a deck can describe and a result cannot carry is said on screen, in the listing and in the summary,
and checked by --verify."""
import csv
import json
import re
import unittest

from disc import disc_mesh
from harness import CONTACT, PRESSURE, SOUND, SUPPORT, ProgramTest, block
from verification import ROOT, Verification

LOCKED = "young = 100.0  poisson = 0.4999"

# A box beside the block that the upper part of its side passes over, and one that its side is inside of.
SQUARES = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "left"
1 2 "right"
2 3 "body"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 1 0 0
6 2 0 0
7 2 1 0
8 1 1 0
$EndNodes
$Elements
4
1 1 2 1 1 4 1
2 1 2 2 2 6 7
3 3 2 3 3 1 2 3 4
4 3 2 3 3 5 6 7 8
$EndElements
"""
FILES = {"squares.msh": SQUARES, "box.csv": "4.05, 1.0\n6.0, 1.0\n6.0, -1.0\n4.05, -1.0\n4.05, 1.0\n",
         "loop.csv": "-5.0, 0.0\n9.0, 0.0\n9.0, -3.0\n2.0, 1.0\n-5.0, -3.0\n-5.0, 0.0\n",
         "far.csv": "10.0, 0.3\n20.0, 0.9\n", "off.csv": "10.0, 0.0\n20.0, 0.0\n", "ball.msh": disc_mesh()}
BALL = "mesh kind = 'file'  file = 'ball.msh'", "material young = 1000.0  poisson = 0.3"

# Groups of a deck, what else is different about its block, and how each warning of it begins.
CASES = {
    "tri3": ((SUPPORT, PRESSURE, CONTACT),
             {"mesh": "size = 4.0, 2.0  cells = 8, 4  element = 'tri3'", "material": LOCKED},
             ["64 linear elements (tri3) of a nearly incompressible material (Poisson's ratio 0.4999) lock"]),
    "tet4": ((SUPPORT, PRESSURE, CONTACT),
             {"mesh": "kind = 'box'  size = 4.0, 1.0, 2.0  cells = 2, 1, 1  element = 'tet4'",
              "material": "young = 100.0  poisson = 0.4999"},
             ["12 linear elements (tet4) of a nearly incompressible material (Poisson's ratio 0.4999) lock"]),
    "stiff": ((SUPPORT, PRESSURE, CONTACT),
              {"mesh": "kind = 'box'  size = 4.0, 1.0, 2.0  cells = 2, 1, 1  element = 'tet4'",
               "material": "young = 100.0  poisson = 0.3"},
              ["12 linear elements (tet4): far too stiff in bending"]),
    "standard": ((SUPPORT, PRESSURE, CONTACT), {"material": LOCKED + "  formulation = 'standard'"},
                 ["32 elements of a nearly incompressible material (Poisson's ratio 0.4999) are of the standard "]),
    "b_bar": ((SUPPORT, PRESSURE, CONTACT),
              {"mesh": "size = 4.0, 2.0  cells = 8, 4  element = 'tri3'", "material":
               "young = 100.0  poisson = 0.25  formulation = 'b-bar'"},
              ["formulation = 'b-bar' has no effect: all elements of the mesh are tri3"]),
    "overlap": ((SUPPORT, PRESSURE, CONTACT + "  point = 0.0, 0.05"), {},
                ["contact set 'bottom': initial overlap of 0.05, 1.25 % of the body's size"]),
    "friction": ((SUPPORT, PRESSURE, "contact set = 'bottom'  friction = 2.5"), {},
                 ["contact set 'bottom': friction of 2.5; coefficients above 2.0 are rare"]),
    "guided": ((PRESSURE, CONTACT, "support set = 'bottom'  ux = 0.0"), {},
               ["contact set 'bottom': friction has no effect: supports hold all its points tangentially"]),
    "dragged": ((PRESSURE, "contact set = 'bottom'  friction = 0.3", "support set = 'left'  ux = 0.01"), {},
                ["contact set 'bottom': 4.95 % of the normal force slides without friction: supports hold the body at "
                 "(0.0, 0.0); their reactions lack this friction"]),
    "drawn": ((PRESSURE, "contact set = 'bottom'  friction = 0.3", SUPPORT,
               "history times = 0.0, 1.0", "steps obstacle = 'bottom'  shift_x = 0.0, 0.01"), {},
              ["contact set 'bottom': 7.26 % of the normal force slides without friction: supports hold the body at "]),
    "cells": ((SUPPORT, PRESSURE, CONTACT + "  multipliers = 'constant'  cells = 8"), {},
              ["contact set 'bottom': the inf-sup constant ", "the largest pressure "]),
    "short": ((SUPPORT, "load set = 'top'  pressure = 0.15", "contact set = 'bottom'  obstacle = 'circle'  "
               "radius = 40.0"), {}, ["the contact zone from (0.0, 0.0) to (1.0, 0.0) has fewer than 4 sides"]),
    "lifted": (("support set = 'top'  ux = 0.0  uy = 0.1", CONTACT), {},
               ["nothing touches the obstacle; the smallest gap is 0.1 at (0.0, 0.0)"]),
    "at_rest": ((SUPPORT, CONTACT), {}, ["nothing touches the obstacle with a force"]),
    "auxetic": ((SUPPORT, PRESSURE, CONTACT), {"material": "young = 100.0  poisson = -0.2"},
                ["Poisson's ratio of -0.2; negative ratios are rare"]),
    "heated": ((SUPPORT, PRESSURE, CONTACT, "load temperature = 20.0"),
               {"material": "young = 100.0  poisson = 0.25  expansion = 0.0"},
               ["temperature has no effect: no material has a coefficient of thermal expansion"]),
    "corner": (("support set = 'top'  ux = 0.0  uy = -0.01", "contact set = 'bottom'  normal = 0.1, 1.0"), {},
               ["only 1 contact point closed: the mesh is too coarse for the pressure there"]),
    "aslant": (("support set = 'top'  ux = 0.0  uy = -0.02", "contact set = 'bottom'  normal = 1.0, 1.0"), {},
               ["only 1 contact point closed", "1 closed contact point, the first at (0.0, 0.0), more than 30 "]),
    "far": (("support set = 'top'  ux = 0.25  uy = 0.0", CONTACT), {},
            ["displacement of 0.25, 6.25 % of the body's size; the theory is for small displacements (up to 5.0 %)",
             "nothing touches the obstacle with a force"]),
    # A block between two others that no force presses: its forces are rounding.
    "loose": (("mesh name = 'base'  size = 1.05, 0.5  cells = 8, 3  origin = 0.23, -0.5", "support set = 'base.bottom' "
               "ux = 0.0  uy = 0.0", "mesh name = 'lid'  size = 5.0, 0.5  cells = 3, 3  origin = 0.1, 2.0",
               "support set = 'lid.top'  ux = 0.001  uy = -0.001", "contact set = 'base.top'  against = 'body.bottom' "
               "friction = 0.5  extra_gap = 0.001", "contact set = 'body.top'  against = 'lid.bottom'  friction = 0.5"),
              {"mesh": "name = 'body'  size = 4.0, 2.0  cells = 3, 3"},
              ["the bodies do not touch each other with a force"]),
    "strained": ((SUPPORT, "load set = 'top'  pressure = 3.0", "contact set = 'bottom'"), {},
                 ["strain of 2.81 % at (0.5, 0.5); the theory is for small strains (up to 2.0 %)"]),
    "ring": (("support set = 'top'  uy = 0.0", "load set = 'right'  pressure = 4.0", "contact set = 'bottom'"),
             {"mesh": "size = 1.0, 1.0  cells = 4, 4", "material": "young = 100.0  poisson = 0.25  "
              "hypothesis = 'axisymmetric'"},
             ["5 nodes on the axis of revolution are not held radially; add a support with ux = 0.0",
              "strain of 2.5 % at "]),
    "looped": ((SUPPORT, PRESSURE, CONTACT + "  obstacle = 'polyline'  line = 'loop.csv'"), {},
               ["contact set 'bottom': the polyline of the obstacle crosses itself at (3.75, 0.0) of its file"]),
    "table": ((SUPPORT, PRESSURE, "contact set = 'bottom'  friction_table = 'far.csv'  gap_table = 'off.csv'"), {},
              ["contact set 'bottom': friction_table has no station on the contact line, whose length is 4.0",
               "contact set 'bottom': gap_table has no station on the contact line, whose length is 4.0"]),
    "axis": ((PRESSURE, CONTACT, "contact set = 'left'  normal = 1.0, 0.0"),
             {"material": "young = 100.0  poisson = 0.25  hypothesis = 'axisymmetric'"},
             ["contact set 'left': no contact points", "5 nodes on the axis of revolution are not held radially",
              "68.8 % of the estimated error "]),
    "passed": (("support set = 'top'  ux = 0.1  uy = -0.6", "contact set = 'right'  obstacle = 'polyline'  "
                "line = 'box.csv'"), {},
               ["displacement of ", "strain of ", "the largest pressure ",
                "the body moves into the obstacle unhindered at 1 contact point out of reach"]),
}


class Warnings(ProgramTest):
    """Each warning, raised by a deck."""

    def setUp(self):
        super().setUp()
        for name, text in FILES.items():
            self.write(name, text)

    def warnings_of(self, text, name="case", status=0):
        """The warnings of a deck: those of its summary, which screen, listing and --verify must know as well."""
        run = self.run_program("--output", "results", self.write(f"{name}.nml", text), status=status)
        summary = json.loads((self.directory/"results"/f"{name}.summary.json").read_text(encoding="utf-8"))
        listing = (self.directory/"results"/f"{name}.lst").read_text(encoding="utf-8")
        self.assertEqual([f"{name}: warning: {warning}" for warning in summary["warnings"]],
                         run.stdout.splitlines()[1:])
        self.assertEqual([f"  Warning             {warning}" for warning in summary["warnings"]],
                         [line for line in listing.splitlines() if line.startswith("  Warning ")])
        self.run_program("--verify", "results", status=status)
        return summary["warnings"]

    def assert_warnings(self, text, *expected, name="case", status=0):
        """Checks how each warning of a deck begins."""
        found = self.warnings_of(text, name, status)
        self.assertEqual(len(found), len(expected), found)
        for sentence, beginning in zip(found, expected):
            self.assertTrue(sentence.startswith(beginning), sentence)

    def test_sound_deck_has_none(self):
        self.assert_warnings(SOUND)
        self.assertIn("  Warnings            none\n", (self.directory/"results"/"case.lst").read_text(encoding="utf-8"))

    def test_every_warning_of_a_block(self):
        for name, (groups, changes, expected) in CASES.items():
            with self.subTest(name=name):
                self.assert_warnings(block(*groups, **changes), *expected, name=name)

    def test_coarse_places_come_with_their_error(self):
        clause = r"; ([0-9.]+) % of the estimated error, ([0-9.]+) %, is in the elements there; refine "
        for name in ("short", "corner"):
            groups, changes, _ = CASES[name]
            sentence, = self.warnings_of(block(*groups, **changes), name, 0)
            share, error = map(float, re.search(clause, sentence).groups())
            summary = json.loads((self.directory/"results"/f"{name}.summary.json").read_text(encoding="utf-8"))
            # Three digits of it are printed.
            self.assertAlmostEqual(error, 100*summary["accuracy"]["relative_error"], delta=0.006*error)
            self.assertGreater(share, 0.0)
            self.assertLessEqual(share, 100.0)
            sentence, = self.warnings_of(block(*groups, "accuracy estimate = 'none'", **changes), name, 0)
            self.assertNotIn("estimated error", sentence)
            self.assertIn("; refine ", sentence)

    def test_points_inside_that_face_away(self):
        # The floor is just above the middle of the ball: the nodes beside the middle are below it and face along it.
        deck = "".join(f"&{group} /\n" for group in (
            *BALL, "support point = 0.0, 0.0  ux = 0.0  uy = 0.0", "support point = 0.0, 1.0  ux = 0.0",
            "contact set = 'rim'  point = 0.0, 0.02"))
        found = self.warnings_of(deck)
        self.assertIn("contact set 'rim': left open inside the obstacle: 2 points; their normals do not meet its "
                      "surface, or at more than 84 degrees; check set and obstacle", found)

    def test_peak_of_the_pressure(self):
        deck = block("support set = 'top'  ux = 0.0  uy = -0.017", "contact set = 'bottom'  obstacle = 'parabola'  "
                     "radius = 5.0  point = 2.0, 0.0", mesh="size = 4.0, 2.0  cells = 16, 8")
        self.assert_warnings(deck, "strain of ", "the largest pressure ")

    def test_pieces_that_share_no_node(self):
        self.assert_warnings("".join(f"&{group} /\n" for group in (
            "mesh kind = 'file'  file = 'squares.msh'", "material young = 100.0  poisson = 0.3",
            "support set = 'left'  ux = 0.0  uy = 0.0", "support set = 'right'  ux = 0.0  uy = 0.0",
            "load body_force = 0.0, -1e-2")), "the body consists of 2 pieces that share no nodes and that no pair")

    def test_pieces_that_contact_or_a_tie_joins(self):
        # The sides where the squares touch are sets, too.
        mesh = SQUARES.replace('$PhysicalNames\n3\n', '$PhysicalNames\n5\n1 4 "inner"\n1 5 "outer"\n').replace(
            "$Elements\n4\n", "$Elements\n6\n5 1 2 4 4 2 3\n6 1 2 5 5 8 5\n")
        groups = ("mesh kind = 'file'  file = 'joined.msh'", "material young = 100.0  poisson = 0.3",
                  "support set = 'left'  ux = 0.0  uy = 0.0", "support set = 'right'  ux = -0.001  uy = 0.0")
        for joint in ("contact set = 'inner'  against = 'outer'  friction = 0.3", "tie set = 'inner'  to = 'outer'"):
            with self.subTest(joint):
                self.write("joined.msh", mesh)
                found = self.warnings_of("".join(f"&{group} /\n" for group in (*groups, joint)))
                self.assertFalse([sentence for sentence in found if "pieces" in sentence], found)

    def test_force_on_every_node_of_a_boundary_set(self):
        self.assert_warnings(block(SUPPORT, "load set = 'top'  force = 0.0, -0.1", CONTACT),
                             "the force on set 'top' acts on each of its 9 nodes, (0.0, -0.9) in all; "
                              "total_force gives")
        self.assert_warnings(block(SUPPORT, "load set = 'top'  total_force = 0.0, -0.9", CONTACT))

    def test_mesh_file_of_another_hypothesis(self):
        mesh = (ROOT/"tests"/"meshes"/"quad8.inp").read_text(encoding="utf-8")
        for stated, hypothesis in (("CPS8", "plane stress"), ("CAX8", "axisymmetric"), ("CPE8", "plane strain")):
            self.write("part.inp", mesh.replace("CPS8", stated))
            for chosen in ("plane stress", "plane strain", "axisymmetric"):
                deck = "".join(f"&{group} /\n" for group in (
                    "mesh kind = 'file'  file = 'part.inp'",
                    f"material young = 100.0  poisson = 0.3  hypothesis = '{chosen}'",
                    "support set = 'bottom'  ux = 0.0  uy = 0.0", "load body_force = 0.0, -1e-3"))
                expected = [f"the elements of the mesh file are of type {hypothesis}, the deck computes {chosen}"]
                free_axis = ["4 nodes on the axis of revolution are not held radially"]
                self.assert_warnings(deck, *(expected if chosen != hypothesis else []),
                                     *(free_axis if chosen == "axisymmetric" else []))

    def test_sweep(self):
        load = PRESSURE + "  name = 'press'"
        self.assert_warnings(block(
            SUPPORT, load, "contact set = 'bottom'", "sweep load = 'press'  factor = 1.0, 0.5, 1.0",
            "sweep friction_factor = 1.0, 3.0"),
            "sweep of factor_press: the value 1.0 is given twice",
            "sweep of friction_factor: no effect: the friction is 0")
        self.assert_warnings(block(SUPPORT, load, CONTACT, "sweep friction = 0.5, 2.5"),
                             "sweep of friction: friction of 2.5; coefficients above 2.0 are rare")
        self.assert_warnings(block(SUPPORT, load, CONTACT, "sweep friction_factor = 0.5, 10.0"),
                             "sweep of friction_factor: friction of 3.0; coefficients above 2.0 are rare")
        self.assert_warnings(block(SUPPORT, load, CONTACT, "sweep friction = 0.5, 0.5  count = 3"),
                             "sweep of friction: the value 0.5 is given twice")

    def test_cases_of_a_sweep(self):
        # A spring lets the block slide; it touches the floor below it where the pressure bends it down.
        self.assert_warnings(
            block("support set = 'left'  uy = 0.0  spring_n = 2.0", PRESSURE + "  name = 'press'", CONTACT,
                  "load name = 'push'  set = 'right'  traction = 1.0, 0.0",
                  "sweep load = 'press'  factor = 0.0, 3.0", "sweep load = 'push'  factor = 0.0, 1.0").replace(
                      CONTACT, "contact set = 'bottom'  friction = 0.1  extra_gap = 0.02"),
            "2 of 4 cases, case 2 the first: displacement of contact points above 5 % of the body",
            "2 of 4 cases, case 1 the first: nothing touches the obstacle",
            "2 of 4 cases, case 3 the first: contact pressure above 2 % of Young's modulus")
        self.assertEqual(self.row_warnings(), ["warnings", "no_contact", "large_displacement no_contact",
                                               "large_strain", "large_displacement large_strain"])
        self.assert_warnings(
            block("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE + "  name = 'press'",
                  "contact set = 'bottom'  friction = 0.2  extra_gap = 0.05",
                  "sweep load = 'press'  factor = 0.1, 0.4, 1.0"),
            "2 of 3 cases, case 1 the first: fewer than 3 contact points closed")
        self.assertEqual(self.row_warnings(), ["warnings", "few_points", "few_points", ""])

    def test_surface_that_nothing_presses_has_no_zone(self):
        # The upper block lies on the arch of a pressed one: what its points bear is none to the tolerance.
        groups = ("mesh name = 'b'  size = 4.0, 2.0  cells = 7, 3  origin = 3.0, 3.0",
                  "material region = 'b'  young = 3e4  poisson = 0.3", "contact set = 'a.bottom'  friction = 0.3",
                  "contact set = 'b.bottom'  against = 'a.top'  friction = 0.3",
                  "load name = 'press'  set = 'a.top'  pressure = 100.0")
        changes = {"mesh": "name = 'a'  size = 10.0, 3.0  cells = 10, 3",
                   "material": "region = 'a'  young = 1e5  poisson = 0.3"}
        self.assert_warnings(block(*groups, **changes), "70.2 % of the estimated error")
        summary = json.loads((self.directory/"results"/"case.summary.json").read_text(encoding="utf-8"))
        self.assertEqual([summary["key_results"][f"contact_width_{i}"] for i in (1, 2)], [10.0, 0.0])
        self.assert_warnings(block(*groups, "sweep load = 'press'  factor = 1.0, 2.0", **changes))
        with open(self.directory/"results"/"case.sweep.csv", encoding="utf-8") as table:
            rows = list(csv.DictReader(line for line in table if not line.startswith("#")))
        self.assertEqual([row["contact_width_2"] for row in rows], ["0.0", "0.0"])

    def test_steps_of_a_history(self):
        # The last step is small, the one before it is not.
        groups = (SUPPORT, PRESSURE + "  name = 'press'", CONTACT, "history times = 0.0, 1.0, 2.0",
                  "steps load = 'press'  factor = 0.0, 50.0, 1.0", "steps contact = 'bottom'  "
                  "friction_factor = 1.0, 10.0, 1.0")
        self.assert_warnings(block(*groups), "friction_factor_bottom: friction of 3.0; coefficients above 2.0 are rare",
                             "1 of 3 steps, step 2 the first: contact pressure above 2 % of Young's modulus")

    def row_warnings(self):
        """The warnings in the rows of the sweep, below their heading."""
        table = (self.directory/"results"/"case.sweep.csv").read_text(encoding="utf-8")
        return [row.split(",")[-2] for row in table.splitlines()]

    def test_check_warns_of_the_model(self):
        groups, changes, expected = CASES["tri3"]
        run = self.run_program("--check", self.write("case.nml", block(*groups, **changes)))
        self.assertTrue(run.stdout.splitlines()[1].startswith(f"case: warning: {expected[0]}"))

    def test_quiet_run_warns_in_the_files_only(self):
        groups, changes, _ = CASES["tri3"]
        self.assertEqual(len(self.solve(block(*groups, **changes)).summary["warnings"]), 1)

    def test_case_that_did_not_converge_has_the_warnings_of_its_model(self):
        groups, changes, expected = CASES["friction"]
        self.assert_warnings(block(*groups, "solver method = 'psor'  max_iterations = 1", **changes), *expected,
                             status=4)

    def test_reduced_problem_that_is_not_symmetric(self):
        problem = (ROOT/"tests"/"reduced"/"dense.dat").read_text(encoding="utf-8")
        self.write("off.dat", problem.replace("0.5 3 0 0.25", "0.50001 3 0 0.25"))
        self.assert_warnings("&problem kind = 'reduced'  file = 'off.dat' /\n",
                             "W is not symmetric: it differs from its transpose by up to 1.0e-5, beside a diagonal of")


class Forged(Verification):
    """Warnings taken out of the files by somebody who made the seal fit."""

    def test_warning_taken_out(self):
        groups, changes, _ = CASES["friction"]
        self.solve_into_results(block(*groups, **changes))
        self.assert_forgery_is_found("case_0.lst", lambda content: content.replace(b"friction of 2.5;", b"friction;"),
                                     "but 'Warning             contact set 'bottom': friction of 2.5;")

        def without(content):
            summary = content.decode()
            first = summary.index('"warnings": [') + len('"warnings": [')
            return (summary[:first] + summary[summary.index("]", first):]).encode()
        self.solve_into_results(block(*groups, **changes))
        self.assert_forgery_is_found("case_0.summary.json", without, "warnings is \\[\\], but ")


if __name__ == "__main__":
    unittest.main()
