#!/usr/bin/env python3
"""Obstacles between contact points: teeth and narrow circles that no node touches fail the certificate, points behind
steep flanks are warned about; what the mesh resolves is sound."""
import json
import math
import unittest

from harness import ProgramTest, block
from verification import Verification

BETWEEN = "contact set 'bottom': a corner or apex of the obstacle penetrates the body by"
BURIED = "contact set 'bottom': left open inside the obstacle: 3 points"
HELD = "support set = 'left'  ux = 0.0"
PRESSED = "load set = 'top'  pressure = 1.0"


class ObstacleCorners(Verification, ProgramTest):
    """A block that is pressed on obstacles smaller than its sides."""

    def run_on(self, obstacle, status, cells=8, element="quad4"):
        """Presses the block on an obstacle, a polyline or words of a deck; its warnings, how far corners penetrate."""
        words = obstacle
        if not isinstance(obstacle, str):
            self.write("line.csv", "".join(f"{s}, {h}\n" for s, h in obstacle))
            words = "obstacle = 'polyline'  line = 'line.csv'"
        deck = block(HELD, PRESSED, f"contact set = 'bottom'  friction = 0.2  {words}", material="young = 1000.0  "
                     "poisson = 0.3", mesh=f"size = 4.0, 2.0  cells = {cells}, 4  element = '{element}'")
        self.run_program("--output", "results", self.write("case.nml", deck), status=status)
        self.run_program("--verify", "results", status=status)
        summary = json.loads((self.directory/"results"/"case.summary.json").read_text(encoding="utf-8"))
        return summary["warnings"], summary["certificate"]["penetration_between"]

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

    def test_what_the_mesh_resolves(self):
        profile = [(0.01*k, -0.005*(0.01*k - 2.0)**2) for k in range(-100, 501)]
        for cells in (7, 8, 17):
            for element in ("quad4", "quad8"):
                for obstacle in ("obstacle = 'circle'  point = 2.0, 0.0  radius = 100.0",
                                 "obstacle = 'parabola'  point = 2.0, 0.0  radius = 1000.0", profile,
                                 [(-10.0, -0.12), (2.0, 0.0), (14.0, -0.12)],
                                 [(-10.0, -5.0), (1.03, 0.0), (2.97, 0.0), (14.0, -5.0)],
                                 [(-10.0, 0.0), (1.9, 0.0), (1.95, -1.0), (2.05, -1.0), (2.1, 0.0), (10.0, 0.0)]):
                    with self.subTest(cells=cells, element=element, obstacle=obstacle):
                        warnings, between = self.run_on(obstacle, 0, cells, element)
                        self.assertFalse(any(warning.startswith(BETWEEN) for warning in warnings), warnings)
                        self.assertEqual(between, 0.0)

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
