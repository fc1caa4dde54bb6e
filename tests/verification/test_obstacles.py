#!/usr/bin/env python3
"""Obstacles, Tresca friction and mesh files from the deck on, against closed forms."""
import math
import unittest

from disc import disc_mesh
from harness import ProgramTest

YOUNG, POISSON, RADIUS = 1000.0, 0.3, 50.0

# Half of a block on a rigid cylinder that is pressed into it; 0.2 wide cells, graded towards the contact.
HERTZ = f"""\
&mesh size = 40.0, 40.0  cells = 200, 60  element = 'quad8'  grading = 20.0 /
&material young = {YOUNG}  poisson = {POISSON} /
&support set = 'left'  ux = 0.0 /
&support set = 'top'  uy = 0.0 /
&contact set = 'bottom'  obstacle = '%s'  radius = {RADIUS}  extra_gap = -0.1 /
"""

# A ball of radius 1 under its weight 1 per volume, on the apex of a rigid anvil.
BALL = """\
&mesh file = 'ball.msh' /
&material young = 1000.0  poisson = 0.3 /
&support point = 0.0, 0.0  ux = 0.0 /
&support point = 0.0, 1.0  ux = 0.0 /
&load body_force = 0.0, -1.0 /
&contact set = '%s'  friction = 0.3  point = 0.0, -1.0  %s /
"""
ANVILS = {
    "plane": "obstacle = 'plane'", "circle": "obstacle = 'circle'  radius = 3.0",
    "parabola": "obstacle = 'parabola'  radius = 3.0", "box": "obstacle = 'polyline'  line = 'box.csv'",
    "open": "obstacle = 'polyline'  line = 'open.csv'", "seat": "obstacle = 'circle'  radius = -3.0"}

# A square meshed as four cells, its sides named; written as MSH 2.2.
SQUARE = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
1 1 "floor"
1 2 "side"
1 3 "roof"
2 4 "body"
$EndPhysicalNames
$Nodes
9
%s
$EndNodes
$Elements
10
1 1 2 1 1 1 2
2 1 2 1 1 2 3
3 1 2 2 2 3 6
4 1 2 2 2 6 9
5 1 2 3 3 9 8
6 1 2 3 3 8 7
7 3 2 4 4 1 2 5 4
8 3 2 4 4 2 3 6 5
9 3 2 4 4 4 5 8 7
10 3 2 4 4 5 6 9 8
$EndElements
"""


class Obstacles(ProgramTest):
    """Decks that use more than a plane and Coulomb's law."""

    def test_pressure_of_a_cylinder_is_that_of_hertz(self):
        for obstacle in ("circle", "parabola"):
            bar = self.solve(HERTZ % obstacle, obstacle)
            load = 2*sum(bar["normal_force"])
            modulus = YOUNG/(1 - POISSON**2)
            half_width = math.sqrt(4*load*RADIUS/(math.pi*modulus))
            peak = 2*load/(math.pi*half_width)
            # The half width is 8 cells; block and half plane differ by about (half width / width)^2 = 0.15 %.
            self.assertAlmostEqual(max(bar["contact_pressure"]), peak, delta=0.01*peak, msg=obstacle)
            closed = [x for x, status in zip(bar["x"], bar["status"]) if status != "open"]
            self.assertAlmostEqual(max(closed), half_width, delta=0.2, msg=obstacle)

    def test_whole_rim_of_a_ball_is_as_good_as_its_lower_half(self):
        self.write("ball.msh", disc_mesh())
        self.write("box.csv", "-2, 0\n2, 0\n2, -4\n-2, -4\n-2, 0\n")
        self.write("open.csv", "-2, -4\n-2, 0\n2, 0\n2, -4\n")
        weight = 24*math.sin(2*math.pi/48)
        for name, anvil in ANVILS.items():
            for cells in ("", "  multipliers = 'constant'"):
                rim, lower = (self.solve(BALL % (part, anvil + cells), f"{name}_{part}") for part in ("rim", "lower"))
                with self.subTest(anvil=name, cells=cells):
                    for ball in (rim, lower):
                        # A cell is bent by 7.5 degrees; the mean of its normals is 0.1 % shorter than they are.
                        self.assertAlmostEqual(-sum(normal*y + tangential*x for normal, tangential, x, y in zip(
                            ball["normal_force"], ball["tangential_force"], ball["normal_x"], ball["normal_y"])),
                                               weight, delta=3e-3*weight if cells else 1e-9)
                    # Conditions of the small matrices: the other half of the rim is condensed in one, not the other.
                    self.assertAlmostEqual(sum(rim["normal_force"]), sum(lower["normal_force"]), delta=1e-9)
                    self.assertEqual([status for status in rim["status"] if status != "open"],
                                     [status for status in lower["status"] if status != "open"])

    def test_sloping_floor_is_the_same_as_plane_and_polyline(self):
        for slope in (0.0, 0.5, 2.0, 5.0, 9.0, 11.0, 1000.0):
            floor = f"&contact set = 'bottom'  normal = {slope}, 1.0  obstacle = "
            self.write("line.csv", "-100, 0\n100, 0\n")
            deck = ("&mesh size = 4.0, 40.0  cells = 4, 10 /\n&material young = 1000.0  poisson = 0.3 /\n"
                    "&support set = 'top'  ux = 0.0  uy = -0.01 /\n")
            if slope > 9.9:
                # More than 84.3 degrees: neither is in reach.
                for obstacle in ("'plane'", "'polyline'  line = 'line.csv'"):
                    self.run_program(self.write("far.nml", deck + floor + obstacle + " /\n"), status=1)
                continue
            plane = self.solve(deck + floor + "'plane' /\n", "plane")
            line = self.solve(deck + floor + "'polyline'  line = 'line.csv' /\n", "line")
            self.assertLess(abs(sum(plane["normal_force"]) - sum(line["normal_force"])), 1e-9)
            self.assertGreater(sum(plane["normal_force"]), 0.0)
            self.assert_close(plane["gap"], line["gap"], 1e-12)

    def test_given_bound_is_the_shear_of_a_block_that_slides(self):
        block = self.solve("""\
&mesh size = 4.0, 2.0  cells = 8, 4 /
&material young = 100.0  poisson = 0.25 /
&support set = 'left'  ux = 0.0 /
&load set = 'top'  pressure = 1.0 /
&load set = 'right'  pressure = 60.0 /
&contact set = 'bottom'  slip_bound = 0.125 /
""")
        sliding = [s for s, status in zip(block["contact_shear"], block["status"]) if status == "slip-"]
        self.assertGreater(len(sliding), 4)
        # The bound is put in exactly; the division by the area rounds.
        self.assert_close(sliding, [-0.125]*len(sliding), 1e-15)

    def test_turned_mesh_file_gives_the_forces_of_the_straight_one(self):
        straight = self.solve_square(0.0)
        # Pressed on its floor, the square widens to its free side.
        self.assertEqual(set(straight["status"]), {"slip-", "stick"})
        for angle in (0.3, 1.0, 2.5, 4.0):
            turned = self.solve_square(angle)
            self.assertEqual(turned["status"], straight["status"], msg=angle)
            for column in ("normal_force", "tangential_force", "slip", "gap"):
                # Coordinates of the turned mesh are rounded to about 1e-16 of its size.
                self.assert_close(turned[column], straight[column], 1e-11, f"{column} at {angle}")

    def solve_square(self, angle):
        """The square pressed on its floor, everything turned by an angle."""
        cosine, sine = math.cos(angle), math.sin(angle)

        def turn(x, y):
            return cosine*x - sine*y, sine*x + cosine*y

        def vector(x, y):
            return "{!r}, {!r}".format(*turn(x, y))

        nodes = (turn(i % 3, i//3) for i in range(9))
        self.write("square.msh", SQUARE % "\n".join(f"{i} {x!r} {y!r} 0" for i, (x, y) in enumerate(nodes, start=1)))
        return self.solve(f"""\
&mesh file = 'square.msh' /
&material young = 100.0  poisson = 0.2  region = 'body' /
&support set = 'side'  un = 0.0 /
&load set = 'roof'  traction = {vector(4.0, -10.0)} /
&contact set = 'floor'  friction = 0.1  normal = {vector(0.0, 1.0)} /
""", f"turned_{angle}")


if __name__ == "__main__":
    unittest.main()
