#!/usr/bin/env python3
"""Obstacles between contact points: teeth, narrow circles and edges that no node touches fail the certificate, points
behind steep flanks and edges near a node are warned about; what the mesh resolves is sound."""
import json
import math
import unittest

from harness import ProgramTest, block
from mapped_mesh import mapped_mesh, turned
from verification import Verification

BETWEEN = "contact set 'bottom': a corner or apex of the obstacle penetrates the body by"
BURIED = "contact set 'bottom': left open inside the obstacle: 3 points"
HELD = "support set = 'left'  ux = 0.0"
PRESSED = "load set = 'top'  pressure = 1.0"


class ObstacleCorners(Verification, ProgramTest):
    """A block that is pressed on obstacles smaller than its sides."""

    def run_on(self, obstacle, status, cells=8, element="quad4", pressed=PRESSED):
        """Presses the block on an obstacle, a polyline or words of a deck; its warnings, how far corners penetrate."""
        words = obstacle
        if not isinstance(obstacle, str):
            self.write("line.csv", "".join(f"{s}, {h}\n" for s, h in obstacle))
            words = "obstacle = 'polyline'  line = 'line.csv'"
        deck = block(HELD, pressed, f"contact set = 'bottom'  friction = 0.2  {words}", material="young = 1000.0  "
                     "poisson = 0.3", mesh=f"size = 4.0, 2.0  cells = {cells}, 4  element = '{element}'")
        self.run_program("--output", "results", self.write("case.nml", deck), status=status)
        self.run_program("--verify", "results", status=status)
        summary = json.loads((self.directory/"results"/"case.summary.json").read_text(encoding="utf-8"))
        return summary["warnings"], summary["certificate"]["penetration_between"]

    def test_step_ahead_of_a_sliding_block(self):
        # Lower than the first cell, so that no node of the free side is opposite to it.
        self.write("step.csv", "-10.0, 0.0\n4.2, 0.0\n4.25, 0.3\n10.0, 0.3\n")
        for element in ("tri3", "quad4", "quad8"):
            for way, status in ((0.1, 0), (0.24, 0), (0.27, 4), (0.35, 4)):
                with self.subTest(element=element, way=way):
                    self.run_program("--output", "results", self.write("case.nml", block(
                        f"support set = 'left'  ux = {way}", PRESSED, "contact set = 'bottom'  friction = 0.2  "
                        "obstacle = 'polyline'  line = 'step.csv'", material="young = 1000.0  poisson = 0.3",
                        mesh=f"size = 4.0, 2.0  cells = 8, 4  element = '{element}'")), status=status)
                    summary = json.loads((self.directory/"results"/"case.summary.json").read_text(encoding="utf-8"))
                    depth = summary["certificate"]["penetration_between"]*summary["key_results"]["max_displacement"]
                    # The side moves a little more by the strain of the block.
                    self.assertAlmostEqual(depth, max(0.0, way - 0.25), delta=2e-3)
                    self.assertEqual(status == 4, any(text.startswith(BETWEEN) for text in summary["warnings"]))

    def test_tooth_between_two_nodes(self):
        for element in ("quad4", "quad8"):
            for height in (0.001, 0.1, 0.3):
                for foot in (-10.0, -1.0):
                    with self.subTest(element=element, height=height, foot=foot):
                        warnings, between = self.run_on(
                            [(foot, 0.0), (1.62, 0.0), (1.63, height), (1.67, height), (1.68, 0.0), (10.0, 0.0)],
                            4, element=element)
                        self.assertTrue(any(warning.startswith(BETWEEN) for warning in warnings), warnings)
                        self.assertGreater(between, 0.1)

    def test_narrow_spike_with_steep_flanks(self):
        floor = [(-10.0, 0.0), (2.1, 0.0), (2.125, 0.5), (2.15, 0.0), (10.0, 0.0)]
        for line in (floor, [*floor, (10.0, -5.0), (-10.0, -5.0), (-10.0, 0.0)]):
            warnings, between = self.run_on(line, 4, cells=256)
            self.assertTrue(any(warning.startswith(BURIED) for warning in warnings), warnings)
            self.assertTrue(any(warning.startswith(BETWEEN) for warning in warnings), warnings)
            self.assertGreater(between, 10.0)

    def test_what_meets_steep_flanks_resolves_no_apex(self):
        # The node that stands on a flank of about 45 degrees does not hold the body off the apex beside it.
        for cells in (7, 9):
            for obstacle in ("obstacle = 'parabola'  point = 2.117, 0.5  radius = 0.1",
                             [(-10.0, 0.0), (1.617, 0.0), (2.117, 0.5), (2.617, 0.0), (10.0, 0.0)]):
                with self.subTest(cells=cells, obstacle=obstacle):
                    warnings, _ = self.run_on(obstacle, 4, cells)
                    self.assertTrue(any(warning.startswith(BETWEEN) for warning in warnings), warnings)

    def test_circle_out_of_reach_of_a_node_beside_its_apex(self):
        # One of the nodes beside the apex is near it, nothing lies opposite to the other one: the mesh resolves no
        # surface there, and the circle goes into the body as deep as the top is pressed down.
        for element, place in (("quad4", 2.02), ("quad8", 2.27), ("quad9", 1.98)):
            for radius in (0.07, 0.15):
                with self.subTest(element=element, radius=radius):
                    warnings, between = self.run_on(f"obstacle = 'circle'  point = {place}, 0.0  radius = {radius}", 4,
                                                    element=element, pressed="support set = 'top'  uy = -0.001")
                    self.assertTrue(any(warning.startswith(BETWEEN) for warning in warnings), warnings)
                    self.assertAlmostEqual(between, 1.0, delta=1e-9)

    def test_what_the_mesh_resolves(self):
        profile = [(0.01*k, -0.005*(0.01*k - 2.0)**2) for k in range(-100, 501)]
        # Edges just beyond a node, which stays open, and a wedge between two nodes need more sides, or they are named.
        for cells in (7, 8, 17):
            for element in ("quad4", "quad8"):
                for obstacle, enough in (
                        ("obstacle = 'circle'  point = 2.0, 0.0  radius = 100.0", 7),
                        ("obstacle = 'parabola'  point = 2.0, 0.0  radius = 1000.0", 7), (profile, 7),
                        ([(-10.0, -0.12), (2.0, 0.0), (14.0, -0.12)], 8),
                        ([(-10.0, -5.0), (1.03, 0.0), (2.97, 0.0), (14.0, -5.0)], 17),
                        ([(-10.0, 0.0), (1.9, 0.0), (1.95, -1.0), (2.05, -1.0), (2.1, 0.0), (10.0, 0.0)], 17)):
                    with self.subTest(cells=cells, element=element, obstacle=obstacle):
                        warnings, between = self.run_on(obstacle, 0, cells, element)
                        if cells >= enough:
                            self.assertFalse(any(warning.startswith(BETWEEN) for warning in warnings), warnings)
                        self.assertEqual(between, 0.0)

    def test_edge_within_a_side(self):
        # The top is held: a step as high as 0.002 displaces the body by no more.
        for height in (0.002, 0.01):
            for edge, cells, element, status, is_warned in (
                    (1.0465, 8, "quad4", 4, True), (1.25, 8, "quad4", 0, True), (1.0465, 8, "quad8", 0, True),
                    (1.4, 8, "quad4", 0, False), (1.0465, 128, "quad4", 0, False), (1.0465, 128, "quad8", 0, False)):
                with self.subTest(height=height, edge=edge, cells=cells, element=element):
                    line = [(-10.0, 0.0), (edge - 0.08*height, 0.0), (edge, height), (14.0, height)]
                    warnings, between = self.run_on(line, status, cells, element, "support set = 'top'  uy = 0.0")
                    self.assertEqual(any(warning.startswith(BETWEEN) for warning in warnings), is_warned, warnings)
                    self.assertEqual(between > 0.5, status == 4, between)

    def test_edge_opposite_to_a_node(self):
        # The node lies at the end of the top of the step, not on its steep flank, whatever rounding says.
        for height in (0.002, 0.01):
            for cells, element in ((128, "quad4"), (8, "quad8"), (128, "quad8")):
                with self.subTest(height=height, cells=cells, element=element):
                    line = [(-10.0, 0.0), (1.25 - height/math.tan(math.radians(85.0)), 0.0), (1.25, height),
                            (14.0, height)]
                    warnings, between = self.run_on(line, 0, cells, element, "support set = 'top'  uy = 0.0")
                    self.assertFalse(any("corner" in warning or "inside" in warning for warning in warnings), warnings)
                    self.assertEqual(between, 0.0)

    def test_nothing_touches_between_the_nodes_of_a_coarse_mesh(self):
        # The apex lies between two nodes, and both are higher above it than the top is pressed down.
        warnings, _ = self.run_on("obstacle = 'circle'  point = 1.75, 0.0  radius = 5.0", 0,
                                  pressed="support set = 'top'  uy = -0.004")
        self.assertTrue(any(warning.startswith(f"{BETWEEN} 0.004 at") for warning in warnings), warnings)

    def test_body_that_rests_on_edges(self):
        # Unloaded it lies on the top of a punch, or its nodes on both sides of an apex, and next to nothing moves.
        turn = 0.74
        self.write("block.msh", mapped_mesh((7, 4), "quad4", turned(lambda s, t: (120.0 + 4.0*s, 2.0*t), turn)))
        for line in ([(-10.0, -0.1), (0.6, 0.0), (2.6, 0.0), (14.0, -0.1)],
                     [(-10.0, -0.1), (1.1, 0.0), (14.0, -0.1)]):
            with self.subTest(line=line):
                self.write("line.csv", "".join(f"{s + 120.0}, {h}\n" for s, h in line))
                self.run_program("--quiet", "--output", "results", self.write("rest.nml", f"""&mesh file = 'block.msh' /
&material young = 1000.0  poisson = 0.3 /
&support set = 'left'  un = 0.0 /
&load name = 'p'  set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.2  obstacle = 'polyline'  line = 'line.csv'
         normal = {-math.sin(turn)!r}, {math.cos(turn)!r} /
&history times = 0.0, 1.0, 2.0 /
&steps load = 'p'  factor = 0.0, 1.0, 0.0 /
"""))

    def test_fronts_pass_the_edges_of_a_long_profile(self):
        # Longer than the methods that need S as a dense matrix: Newton's method is all there is.
        for length, height, wave in ((302.0, 0.004, 9.0), (302.0, 0.02, 30.0), (604.0, 0.001, 9.0)):
            with self.subTest(length=length, height=height, wave=wave):
                places = [-10.0 + i*(length + 20.0)/600 for i in range(601)]
                self.write("line.csv", "".join(f"{s}, {height*math.sin(2*math.pi*s/wave)}\n" for s in places))
                deck = block(HELD, "load set = 'top'  pressure = 0.1",
                             "contact set = 'bottom'  friction = 0.3  obstacle = 'polyline'  line = 'line.csv'",
                             material="young = 1000.0  poisson = 0.3", mesh=f"size = {length}, 1.0  cells = 1510, 1")
                self.run_program("--quiet", "--output", "results", self.write("case.nml", deck))


if __name__ == "__main__":
    unittest.main()
