#!/usr/bin/env python3
"""Loose bodies that points hold which see little of their motions: cells, two mortar points, given slip bounds."""
import csv
import unittest

from mapped_mesh import mapped_mesh
from verification import Verification

# A block on a block on a floor. A single cell does not notice that a body turns about its middle.
STACK = """&mesh name = 'low'  size = 4.0, 1.0  cells = 6, 2  element = '{element}' /
&mesh name = 'high'  size = 3.0, 1.0  cells = 4, 2  origin = 0.5, 1.0  element = '{element}' /
&material young = 100.0  poisson = 0.3 /
&load name = 'press'  set = 'high.top'  {load} /
&contact set = 'low.bottom'  friction = 0.3  multipliers = 'constant'  cells = 1 /
&contact set = 'high.bottom'  against = 'low.top'  friction = 0.3  multipliers = {multipliers} /
"""
STEP = "&history times = 0.0, 1.0 /\n&steps load = 'press'  factor = 0.0, 1.0 /\n"
ROW = "&sweep load = 'press'  factor = 0.0, 1.0 /\n"

# A body on two mortar points above cells: it has no stiffness along their normals.
ON_TWO_POINTS = """&mesh name = 'low'  size = 1.0, 0.5  cells = 5, 2  element = 'tri6' /
&mesh name = 'mid'  size = 0.7, 0.8  cells = 4, 3  element = 'tri6'  origin = 0.15, 0.5 /
&mesh name = 'high'  size = 0.76, 1.3  cells = 1, 2  element = 'tri6'  origin = 0.12, 1.3 /
&material young = 2.0e4  poisson = 0.25 /
&load set = 'high.top'  pressure = 3.0 /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&contact set = 'mid.bottom'  against = 'low.top'  friction = 0.3  multipliers = 'constant'  slip_bound = 0.1 /
&contact set = 'high.bottom'  against = 'mid.top'  friction = 0.3 /
"""

# Three blocks that overlap by wedges below a ceiling, without loads. Given slip bounds hold the highest one.
WEDGES = """&mesh name = 'low'  size = 3.0, 0.6  cells = 6, 2 /
&mesh name = 'mid'  size = 2.5, 1.0  cells = 4, 2  origin = 0.2, 0.6 /
&mesh name = 'high'  size = 2.0, 1.0  cells = 5, 2  origin = 0.5, 1.6 /
&material young = 1000.0  poisson = 0.3 /
&contact set = 'low.bottom'  gap_slope = -7e-4, 0.0  extra_gap = -1e-3 /
&contact set = 'mid.bottom'  against = 'low.top'  friction = 0.3  gap_slope = -7e-4, 0.0  extra_gap = -3e-4 /
&contact set = 'high.bottom'  against = 'mid.top'  slip_bound = 80.0  gap_slope = -7e-4, 0.0  extra_gap = -3e-4 /
&contact set = 'high.top'  slip_bound = 10.0  point = 0.0, 2.7  normal = 0.0, -1.0 /
"""

# A block that a given slip bound holds, nearly unloaded at the end.
STUCK = """&mesh name = 'low'  size = 3.0, 0.6  cells = 6, 2 /
&mesh name = 'high'  size = 2.5, 1.0  cells = 4, 2  origin = 0.2, 0.6 /
&material young = 1000.0  poisson = 0.3 /
&support set = 'low.bottom'  ux = 0.0  uy = 0.0 /
&load name = 'press'  set = 'high.top'  pressure = 1e-3 /
&contact set = 'high.bottom'  against = 'low.top'  slip_bound = 4.0 /
&history times = 0.0, 1.0, 2.0, 3.0 /
&steps load = 'press'  factor = 0.0, 0.4, 1.0, 1e-6 /
"""

# Two blocks tied across a gap: what a rotation strains holds them.
ACROSS = """&mesh name = 'low'  size = 3.0, 0.6  cells = 6, 2 /
&mesh name = 'high'  size = 2.5, 1.0  cells = 4, 2  origin = 0.2, 0.7 /
&material young = 1000.0  poisson = 0.3 /
&tie set = 'high.bottom'  to = 'low.top' /
&load name = 'weight'  set = 'high.top'  pressure = {} /
&load name = 'press'  set = 'high.top'  traction = {}, 0.0 /
&contact set = 'low.bottom'  friction = 0.5  {} /
"""

# A block on one with a crowned top, on a tilted floor, pressed and released. A given slip bound joins the two.
CROWNED = """&mesh name = 'low'  file = 'low.msh' /
&mesh name = 'high'  file = 'high.msh' /
&material young = 2500.0  poisson = 0.3 /
&load name = 'press'  set = 'high.top'  pressure = {} /
&contact set = 'low.bottom'  gap_slope = {}, 0.0  friction = {} /
&contact set = 'high.bottom'  against = 'low.top'  slip_bound = 17.0  friction = 0.1 /
&history times = 0.0, 1.0, 2.0, 3.0 /
&steps load = 'press'  factor = 0.0, {}, 1.0, 0.0 /
"""


def row(n, push):
    """A row of blocks of side 1 on a floor with friction 0.3, pressed on it by 1 each, pushed from the right against a
    guide on the left."""
    numbers = range(n)
    return "\n".join([
        *(f"&mesh name = 'b{i}'  size = 1.0, 1.0  cells = 2, 2  origin = {i}.0, 0.0 /" for i in numbers),
        "&material young = 1000.0  poisson = 0.3 /", *(f"&load set = 'b{i}.top'  pressure = 1.0 /" for i in numbers),
        f"&load set = 'b{n - 1}.right'  traction = {-push}, 0.0 /",
        *(f"&contact name = 'floor'  set = 'b{i}.bottom'  friction = 0.3 /" for i in numbers),
        *(f"&contact set = 'b{i}.left'  against = 'b{i - 1}.right'  friction = 0.2 /" for i in numbers[1:])]) + "\n"


def stack(n, support, traction):
    """A stack of blocks of side 1, the lowest one supported, loaded by a traction on its top."""
    return "\n".join([
        *(f"&mesh name = 'b{i}'  size = 1.0, 1.0  cells = 2, 1  origin = 0.0, {i}.0 /" for i in range(n)),
        "&material young = 1000.0  poisson = 0.0 /", f"&support set = 'b0.bottom'  {support} /",
        f"&load set = 'b{n - 1}.top'  traction = {traction} /",
        *(f"&contact name = 'joint_{i}'  set = 'b{i}.bottom'  against = 'b{i - 1}.top'  friction = 0.3 /"
          for i in range(1, n))]) + "\n"


class LooseBodies(Verification):
    """Bodies whose equilibrium is plain, however little their contact points see of them."""

    def forces_of(self, deck):
        """Solves and verifies a deck; the normal forces of its points."""
        self.solve_into_results(deck)
        self.verify()
        return list(self.result("case_0", "results")["normal_force"])

    def test_bodies_without_friction_are_unique_up_to_a_motion(self):
        # Nothing holds the upper block along the other one, whose left side is guided.
        deck = """&mesh name = 'low'  size = 4.0, 1.0  cells = 4, 1 /
&mesh name = 'high'  size = 2.0, 1.0  cells = 2, 1  origin = 1.0, 1.0 /
&material young = 100.0  poisson = 0.3 /
&load set = 'high.top'  pressure = 1.0 /
&support set = 'low.left'  ux = 0.0 /
&contact set = 'low.bottom' /
&contact set = 'high.bottom'  against = 'low.top' /
"""
        for text, known in ((deck, ", since there is no Coulomb friction, but for a rigid motion: the piece around "
                             "2.0, 1.5 is free to translate along (1.0, 0.0); slips are counted without it\n"),
                            (deck + "&support set = 'high.left'  ux = 0.0 /\n", " (friction 0.0; proven below ")):
            self.solve(text, "free")
            self.assertIn(f"  Uniqueness          unique{known}",
                          (self.directory/"free.lst").read_text(encoding="utf-8"))

    def test_motion_that_no_cell_of_a_stack_notices(self):
        for element in ("quad4", "quad8", "tri6"):
            for multipliers in ("'constant'  cells = 1", "'mortar'"):
                deck = STACK.format(element=element, multipliers=multipliers, load="pressure = 1.0")
                for study in ("", STEP):
                    with self.subTest(element=element, multipliers=multipliers, study=study):
                        forces = self.forces_of(deck + study)
                        self.assertAlmostEqual(forces[0], 3.0, delta=1e-9)
                        self.assertAlmostEqual(sum(forces[1:]), 3.0, delta=1e-9)
                        self.solve_into_results(deck + ROW)
                        self.verify()

    def test_motion_that_no_cell_of_a_stack_notices_and_loads_drive(self):
        # Their moment about the middle of the cell is not 0.
        for study in ("", STEP, ROW.replace("0.0, ", "")):
            with self.subTest(study=study):
                deck = STACK.format(element="quad4", multipliers="'mortar'", load="pressure = 1.0")
                run = self.run_program(self.write("case.nml", deck.replace("0.5, 1.0", "0.6, 1.0") + study), status=2)
                self.assertRegex(run.stderr, "no equilibrium.*rotate|no case has an equilibrium")

    def test_body_on_two_mortar_points_above_cells(self):
        # The verdict hung on the sign of a pivot, and forces on rounding.
        forces = self.forces_of(ON_TWO_POINTS)
        self.assertAlmostEqual(sum(forces[:-2]), 3.0*0.76, delta=1e-9)
        self.assertAlmostEqual(forces[-1], forces[-2], delta=1e-9)

    def test_body_that_a_given_slip_bound_holds_leaves_an_overlap_without_slip(self):
        for study in ("", "&load name = 'press'  set = 'low.left'  pressure = 0.0 /\n" + STEP):
            with self.subTest(study=study):
                self.assertEqual(set(self.forces_of(WEDGES + study)), {0.0})

    def test_bodies_tied_across_a_gap_leave_a_tilted_overlap_without_forces(self):
        for study in ("", STEP):
            with self.subTest(study=study):
                forces = self.forces_of(ACROSS.format(0.0, 0.0, "gap_slope = -7e-4, 0.0") + study)
                self.assertEqual(set(forces), {0.0})

    def test_bodies_tied_across_a_gap_tip_in_steps_where_they_do_in_cases(self):
        # About the right corner of the floor.
        tips = 0.1*(3.0 - 1.45)/(0.1*1.7)
        deck = ACROSS.format(0.1, 0.1, "slip_bound = 9.0")
        self.run_program("--quiet", self.write("case.nml", deck + STEP), status=2)
        with open(self.directory / "case.history.csv", newline="", encoding="utf-8") as table:
            last = float(list(csv.DictReader(table))[-1]["factor_press"])
        self.assertAlmostEqual(last, tips, delta=1.0/512.0)
        for factor, status in ((0.999*tips, 0), (1.001*tips, 2)):
            for study in ("", f"&sweep load = 'press'  factor = {factor} /\n"):
                with self.subTest(factor=factor, study=study):
                    load = 0.1 if study else 0.1*factor
                    self.solve_into_results(ACROSS.format(0.1, load, "slip_bound = 9.0") + study, status=status)

    def test_body_that_is_released_rests_where_no_forces_balance_each_other(self):
        def crown(x):
            return 0.713 + 0.092*(x/4.76 - 0.5)**2

        def low(s, t):
            return 4.76*s, t*crown(4.76*s)

        def high(s, t):
            return 0.748 + 3.437*s, (1.0 - t)*crown(0.748 + 3.437*s) + 1.548*t

        self.write("low.msh", mapped_mesh((7, 3), "quad4", low))
        self.write("high.msh", mapped_mesh((4, 3), "quad4", high))
        for numbers in ((0.0771, -0.00094, 0.0, 0.16), (0.0126, -0.00085, 0.3, 0.61), (0.0219, -0.00098, 0.0, 0.18),
                        (0.001, -0.00092, 0.3, 0.98), (0.0671, -0.00087, 0.5, 0.97), (0.0056, -0.00085, 0.5, 0.82)):
            with self.subTest(numbers=numbers):
                self.assertEqual(set(self.forces_of(CROWNED.format(*numbers))), {0.0})

    def test_row_of_many_blocks_slides_where_all_friction_is_used(self):
        # A row of n blocks bears 0.3 n.
        for n in (3, 40):
            for share, status in ((0.5, 0), (0.999, 0), (1.0 + 1e-8, 2), (1.5, 2)):
                with self.subTest(n=n, share=share):
                    self.write("case.nml", row(n, 0.3*n*share))
                    run = self.run_program("--quiet", "--output", "results", "case.nml", status=status)
                    if status:
                        # Up the edge of the friction cone of the floor.
                        self.assertRegex(run.stderr, r"no equilibrium: .* is free to translate along \(-")
                        continue
                    sums = self.result("case", "results").summary["key_results"]
                    self.assertAlmostEqual(sums["force_normal_floor"], n, delta=1e-9*n)
                    self.assertAlmostEqual(abs(sums["force_tangential_floor"]), 0.3*n*share, delta=1e-9*n)

    def test_stack_of_many_blocks_stands(self):
        # Its softest motion, a bend, moves the contact points by 1/n^2 of its way: it was taken for a free one.
        for n in (2, 30, 400):
            with self.subTest(n=n):
                self.write("case.nml", stack(n, "ux = 0.0  uy = 0.0", "0.0, -1.0"))
                self.run_program("--quiet", "--output", "results", "case.nml")
                summary = self.result("case", "results").summary
                for i in range(1, n):
                    self.assertAlmostEqual(summary["key_results"][f"force_normal_joint_{i}"], 1.0, delta=1e-9)
                # Each block is pressed by 1/1000 of its height.
                self.assertAlmostEqual(summary["key_results"]["max_displacement"], 1e-3*n, delta=1e-9*n)

    def test_stack_of_many_blocks_without_equilibrium(self):
        for n in (2, 30):
            for support, traction, words in (("ux = 0.0  uy = 0.0", "0.31, -1.0", "cannot balance the loads"),
                                             ("ux = 0.0  uy = 0.0", "0.0, 1.0", "cannot balance the loads"),
                                             ("uy = 0.0", "0.0, -1.0", "nothing holds the bodies together")):
                with self.subTest(n=n, words=words):
                    self.write("case.nml", stack(n, support, traction))
                    run = self.run_program("--quiet", "--output", "results", "case.nml", status=2)
                    self.assertIn(words, run.stderr)

    def test_forces_before_count_along_tangents_too(self):
        # What the load before leaves of the slip and of the force by rounding, times the bound.
        self.solve_into_results(STUCK)
        self.verify()


if __name__ == "__main__":
    unittest.main()
