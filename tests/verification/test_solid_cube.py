#!/usr/bin/env python3
r"""Cube on a rough floor, and on an incline.

The top of a cube is moved down and aslant; some of its base slips in directions that turn from point to point, the rest
sticks. An independent code, with its own elements, factorization and active set, gave normal and tangential force on
each of the meshes. On an incline of slope $\tan a$ a block that is pushed sideways by $H$ rests while $(V\sin a)^2 +
H^2 \le (\mu V \cos a)^2$; the largest $H$ is found by bisection. A reduced problem of four points on an incline has
unique sums of forces.

`auto` needs at most 8 steps of Newton's method on the cubes. Tolerances: the digits of the references; 3e-5 of the
limit on the incline: of round cones the program takes 1e-6 of the works of the loads for rounding (doc/theory.md,
section 4), and $H$ is an unfavorable part of these.
"""
import csv
import math
import shutil

from benchmark import DECKS, Benchmark, main
from convergence import ValueTable

# Cells on an edge, normal and tangential force, and how far they may be off.
CUBES = {"hex8": ((4, 5.3940e-2, 5.465782e-3), (8, 5.346e-2, 5.2560e-3), (12, 5.333e-2, 5.2030e-3),
                  (16, 5.328e-2, 5.1825e-3)),
         "hex20": ((4, 5.3376e-2, 5.183580e-3), (8, 5.3243e-2, 5.164911e-3)),
         "tet10": ((4, 5.3375e-2, 5.21992e-3), (8, 5.3242e-2, 5.172245e-3))}
NORMAL_DIGITS, TANGENTIAL_DIGITS = 1e-4, 1e-5
MOST_STEPS = 8
WEIGHT = 4.0
# Normal and tangential forces of the reduced problem, sums over its points.
INCLINE_FORCE = (0.004387165, -0.001139820, -0.000658075)


class SolidCube(Benchmark):
    """Cubes beside an independent code, and the limit of friction in space."""

    def test_cubes(self):
        table = ValueTable("Forces of the cube", ["element", "cells", "quantity"])
        for element, meshes in CUBES.items():
            for cells, normal, along in meshes[:self.meshes(2 if element == "hex8" else 1, 4)]:
                result = self.solve(self.deck("solid_cube", element=element, cells=(cells,)*3))
                self.assert_sound(result)
                self.assertLessEqual(result.summary["iterations"], MOST_STEPS)
                self.assertNotIn("open", result["status"])
                key = result.summary["key_results"]
                table.add(element, cells, "normal", computed=key["contact_force_z"], reference=normal,
                          allowed=NORMAL_DIGITS)
                table.add(element, cells, "tangential", computed=-key["contact_force_x"], reference=along,
                          allowed=TANGENTIAL_DIGITS)
        self.assert_table(table)

    def test_reduced_problem_on_an_incline(self):
        shutil.copy(DECKS/"cube_incline.dat", self.directory)
        self.run_program("--quiet", self.write("case.nml", self.deck("cube_incline")))
        with open(self.directory/"case.contact.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 4)
        table = ValueTable("Reduced problem on an incline: sums of its forces", ["component"])
        names = ("normal_force", "tangential_force_1", "tangential_force_2")
        for name, force in zip(names, INCLINE_FORCE):
            table.add(name, computed=sum(float(row[name]) for row in rows), reference=force, allowed=1e-6)
        self.assert_table(table)

    def test_limit_on_an_incline(self):
        values = ValueTable("Sideways push on an incline that friction bears", ["slope", "friction", "downhill"])
        for slope, friction, angle in self.meshes(((0.25, 0.3, 0.0), (0.1, 0.2, 0.7)),
                                                  ((0.25, 0.3, 0.0), (0.1, 0.2, 0.7), (0.0, 0.4, 2.0),
                                                   (0.5, 0.6, 4.0))):
            low, high = 0.0, WEIGHT
            exact = WEIGHT*math.sqrt((friction**2 - slope**2)/(1 + slope**2))
            while high - low > 1e-8:
                middle = 0.5*(low + high)
                low, high = (middle, high) if self.rests(slope, friction, angle, middle) else (low, middle)
            values.add(f"{slope:g}", f"{friction:g}", f"{angle:g}", computed=low, reference=exact, allowed=3e-5)
            self.assertTrue(self.rests(slope, friction, angle, 0.999*exact, is_solved=True))
        self.assert_table(values)

    def rests(self, slope, friction, angle, push, is_solved=False):
        """Whether friction holds the block: the weight leans downhill, the push is along the level line."""
        along, across = WEIGHT*slope/math.hypot(1, slope)/4, push/4
        force = (along*math.cos(angle) - across*math.sin(angle), along*math.sin(angle) + across*math.cos(angle),
                 -WEIGHT/math.hypot(1, slope)/4)
        deck = self.write("case.nml", self.deck("solid_incline", body_force=force, friction=friction))
        run = self.run_program("--quiet", *([] if is_solved else ["--check"]), deck, status=None)
        self.assertIn(run.returncode, (0, 2), run.stderr)
        return run.returncode == 0


if __name__ == "__main__":
    main()
