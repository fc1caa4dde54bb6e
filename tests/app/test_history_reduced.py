#!/usr/bin/env python3
"""Every step of a load history handed out as a reduced problem u = W r + q, its q_T shifted by the anchors, has the
forces of the history. The chain of anchors is computed here, from the displacements of the reduced problems."""
import csv
import math
import unittest

from harness import ProgramTest

SHIFT = (0.02, 0.05)
TURN = 0.004
PIVOT = (1.0, -0.1)
FRICTION = 0.4
TIMES = ((0.0, 0.0), (1.0, 1.0), (2.0, -0.6), (3.0, 0.8))
# A block that is held at its top, pushed at its right side, and pressed by a floor that rises, shifts and turns while
# its top moves and its friction grows. {push}: factor of the load, {top}: displacement of the top.
BODY = """&mesh size = 4.0, 2.0  cells = 12, 6 /
&material young = 100.0  poisson = 0.3  hypothesis = 'plane strain' /
&support name = 'top'  set = 'top'  ux = {top}  uy = 0.0 /
&load name = 'push'  set = 'right'  traction = {push}, 0.0 /
&contact set = 'bottom'  friction = {friction}  point = {x}, {y}  normal = {normal_x}, {normal_y} /
"""


def numbers_of(factor):
    """What changes: factors of load and top, shift and turn of the floor, factor of the friction."""
    rise = abs(factor)
    return {"push": 3.0*factor, "top": -0.03*factor, "shift": (SHIFT[0]*factor, SHIFT[1]*rise), "turn": TURN*factor,
            "friction": 1.0 + 0.5*rise}


def displacement(numbers, x, y):
    """How far a point of the floor has moved."""
    c, s = math.cos(numbers["turn"]), math.sin(numbers["turn"])
    dx, dy = x - PIVOT[0], y - PIVOT[1]
    return numbers["shift"][0] + (c - 1)*dx - s*dy, numbers["shift"][1] + s*dx + (c - 1)*dy


class HistoryAsReducedProblems(ProgramTest):
    """A history with everything that can change."""

    def deck(self, numbers):
        """The body with the floor where it has moved to, as a static case."""
        dx, dy = displacement(numbers, 0.0, -0.01)
        return BODY.format(push=numbers["push"], top=numbers["top"], friction=FRICTION*numbers["friction"], x=dx,
                           y=-0.01 + dy, normal_x=-math.sin(numbers["turn"]), normal_y=math.cos(numbers["turn"]))

    def reduced(self, numbers):
        """W and q as words, and mu, of the static case."""
        self.write("step.nml", "&case name = 'step' /\n" + self.deck(numbers))
        self.run_program("--quiet", "--write-reduced", "step.nml")
        words = (self.directory / "step.reduced.dat").read_text(encoding="utf-8").split()
        m = int(words[1])
        behind = 2*m + m
        self.assertEqual(int(words[2]), 0)
        return words[:7 + 4*m*m], [float(word) for word in words[7 + 4*m*m:7 + 4*m*m + 2*m]], words[-behind + 2*m:]

    def solve_shifted(self, numbers, anchors):
        """Forces and displacements of the reduced problem whose slips count from the anchors."""
        matrix, q, friction = self.reduced(numbers)
        for p, anchor in enumerate(anchors):
            q[2*p + 1] -= anchor
        self.write("shifted.dat", " ".join([*matrix, *map(repr, q), *friction]) + "\n")
        self.write("shifted.nml", "&problem kind = 'reduced'  file = 'shifted.dat' /\n&solver tolerance = 1e-12 /\n")
        self.run_program("--quiet", "shifted.nml")
        with open(self.directory / "shifted.contact.csv", encoding="utf-8") as table:
            rows = list(csv.reader(table))[1:]
        gap, slip, normal, tangential = ([float(row[k]) for row in rows] for k in range(1, 5))
        self.assertEqual(len(gap), len(anchors))
        return [s + a for s, a in zip(slip, anchors)], normal, [-t for t in tangential]

    def test_every_step_has_the_forces_of_its_reduced_problem(self):
        n_substeps = 3
        ends = [numbers_of(factor) for _, factor in TIMES]

        def values(pick):
            return ", ".join(repr(pick(numbers)) for numbers in ends)

        self.write("way.nml", "&case name = 'way' /\n" + self.deck(numbers_of(0.0))
                   .replace("traction = 0.0", "traction = 1.0").replace("ux = -0.0", "ux = 1.0")
                   .replace("ux = 0.0", "ux = 1.0") +
                   f"&history times = {', '.join(repr(t) for t, _ in TIMES)}  substeps = {n_substeps} /\n"
                   f"&steps load = 'push'  factor = {values(lambda n: n['push'])} /\n"
                   f"&steps support = 'top'  factor = {values(lambda n: n['top'])} /\n"
                   f"&steps obstacle = 'bottom'  shift_x = {values(lambda n: n['shift'][0])}"
                   f"  shift_y = {values(lambda n: n['shift'][1])}  turn = {values(lambda n: n['turn'])}"
                   f"  pivot = {PIVOT[0]}, {PIVOT[1]} /\n"
                   f"&steps contact = 'bottom'  friction_factor = {values(lambda n: n['friction'])} /\n"
                   "&output points_every = 1 /\n&solver tolerance = 1e-12 /\n")
        self.run_program("--quiet", "way.nml")
        with open(self.directory / "way.points.csv", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        with open(self.directory / "way.contact.csv", encoding="utf-8") as table:
            places = [(float(row["x"]), float(row["y"])) for row in csv.DictReader(table)]
        before = [0.0]*len(places)
        motion_before = [0.0]*len(places)
        largest = max(abs(float(row["normal_force"])) for row in rows)
        statuses = set()
        for step in range(1, int(rows[-1]["step"]) + 1):
            own = [row for row in rows if int(row["step"]) == step]
            numbers = self.between(ends, float(own[0]["time"]))
            # The floor at rest is level, its feet below the points; the tangent is along x.
            motion = [displacement(numbers, x, -0.01)[0] for x, _ in places]
            anchors = [u + now - then for u, now, then in zip(before, motion, motion_before)]
            before, normal, tangential = self.solve_shifted(numbers, anchors)
            motion_before = motion
            statuses |= {row["status"] for row in own}
            self.assert_close([float(row["normal_force"]) for row in own], normal, 1e-9*largest, f"step {step}")
            self.assert_close([float(row["tangential_force"]) for row in own], tangential, 1e-9*largest, f"step {step}")
        self.assertEqual(statuses, {"open", "stick", "slip+", "slip-"})

    def between(self, ends, time):
        """What acts at a time: numbers linear between the given times."""
        k = min(int(time), len(ends) - 2)
        share = time - k

        def mean(first, second):
            if isinstance(first, tuple):
                return tuple(mean(a, b) for a, b in zip(first, second))
            return (1 - share)*first + share*second
        return {name: mean(ends[k][name], ends[k + 1][name]) for name in ends[k]}


# Bodies whose load, and with it the friction, goes up and down; what is not proportional to the load presses them on.
PLANE = """&mesh size = 4.0, 2.0  cells = 12, 6  element = '{element}' /
&material young = 100.0  poisson = 0.3  hypothesis = '{hypothesis}' /
&support set = 'top'  uy = -0.05 /
&support set = '{side}'  ux = 0.0 /
&load name = 'push'  set = 'right'  traction = {push}, 0.0 /
&contact set = 'bottom'  {law} = {bound} /
"""
PAIR = """&mesh name = 'a'  size = 4.0, 2.0  cells = 10, 4 /
&mesh name = 'b'  size = 6.0, 2.0  cells = 9, 3  origin = -1.0, -2.0 /
&material young = 100.0  poisson = 0.25 /
&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'a.left'  ux = 0.0 /
&support set = 'a.top'  uy = -0.05 /
&load name = 'push'  set = 'a.right'  traction = {push}, 0.0 /
&contact set = 'a.bottom'  against = 'b.top'  friction = {bound}  multipliers = '{multipliers}' /
"""
PLANE_STRAIN = {"element": "quad4", "hypothesis": "plane strain", "side": "left", "law": "friction"}
BODIES = {
    "axisymmetric": (PLANE, PLANE_STRAIN | {"hypothesis": "axisymmetric"}),
    "quadratic": (PLANE, PLANE_STRAIN | {"element": "quad8"}),
    "mortar pair": (PAIR, {"multipliers": "mortar"}),
    "pair of cells": (PAIR, {"multipliers": "constant"}),
}
FACTORS = (0.0, 6.0, -4.0, 5.0)


class OtherBodies(HistoryAsReducedProblems):
    """Histories of one load, on other bodies and with a given slip bound."""

    def history(self, text, keys):
        """The rows of the contact points, step by step."""
        self.write("way.nml", "&case name = 'way' /\n" + text.format(push=1.0, **keys) +
                   f"&history times = {', '.join(str(float(k)) for k in range(len(FACTORS)))}  substeps = 4 /\n"
                   f"&steps load = 'push'  factor = {', '.join(map(str, FACTORS))} /\n"
                   "&output points_every = 1 /\n&solver tolerance = 1e-12 /\n")
        self.run_program("--quiet", "way.nml")
        self.assertIn("way: verified\n", self.run_program("--verify", ".").stdout)
        with open(self.directory / "way.points.csv", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        return [[row for row in rows if int(row["step"]) == step] for step in range(1, int(rows[-1]["step"]) + 1)]

    @staticmethod
    def push(time):
        """The factor of the load at a time."""
        k = min(int(time), len(FACTORS) - 2)
        return FACTORS[k] + (time - k)*(FACTORS[k + 1] - FACTORS[k])

    def test_every_step_has_the_forces_of_its_reduced_problem(self):
        for name, (text, keys) in BODIES.items():
            with self.subTest(name):
                keys = keys | {"bound": 0.3}
                steps = self.history(text, keys)
                largest = max(abs(float(row["normal_force"])) for rows in steps for row in rows)
                self.deck = lambda numbers, text=text, keys=keys: text.format(push=numbers, **keys)
                before = [0.0]*len(steps[0])
                for rows in steps:
                    push = self.push(float(rows[0]["time"]))
                    before, normal, tangential = self.solve_shifted(push, before)
                    for column, expected in (("normal_force", normal), ("tangential_force", tangential)):
                        self.assert_close([float(row[column]) for row in rows], expected, 1e-9*largest,
                                          f"{name}, push {push}")
                self.assertLessEqual({"stick", "slip+", "slip-"}, {row["status"] for rows in steps for row in rows})

    def test_given_bounds_hold_in_every_step(self):
        # Files of reduced problems know no given bound: W and q are those of the body with friction, and the law is
        # asked of u = W r + q. It has one solution whatever the anchors are (theory.md, 6).
        bound = 1.0
        for hypothesis in ("plane strain", "axisymmetric"):
            keys = PLANE_STRAIN | {"hypothesis": hypothesis, "bound": bound}
            steps = self.history(PLANE, keys | {"law": "slip_bound"})
            self.deck = lambda numbers, keys=keys: PLANE.format(push=numbers, **keys)
            with open(self.directory / "way.contact.csv", encoding="utf-8") as table:
                # What a support guides bears no shear.
                bounds = [float(row["shear_bound"])*float(row["tangential_force"])/(float(row["contact_shear"]) or 1.0)
                          for row in csv.DictReader(table)]
            before = [0.0]*len(steps[0])
            statuses = set()
            for rows in steps:
                with self.subTest(hypothesis=hypothesis, step=rows[0]["step"]):
                    before = self.check_law(rows, before, bounds)
                    statuses |= {row["status"] for row in rows}
            self.assertLessEqual({"stick", "slip+", "slip-"}, statuses)

    def check_law(self, rows, anchors, bounds):
        """Checks a step against W and q of its load; returns its tangential displacements."""
        matrix, q, _ = self.reduced(self.push(float(rows[0]["time"])))
        n = len(q)
        entries = list(map(float, matrix[7:]))
        # The file has the force on the body against its slip.
        r = [sign*float(row[column]) for row in rows
             for column, sign in (("normal_force", 1), ("tangential_force", -1))]
        u = [q[i] + sum(entries[i + n*k]*r[k] for k in range(n)) for i in range(n)]
        far, strong = 1e-9*max(map(abs, q)), 1e-9*max(map(abs, r))
        for p, (anchor, bound) in enumerate(zip(anchors, bounds)):
            gap, slip, normal, shear = u[2*p], u[2*p + 1] - anchor, r[2*p], r[2*p + 1]
            self.assertGreaterEqual(min(gap/far, normal/strong), -1.0)
            self.assertLess(min(abs(gap)/far, abs(normal)/strong), 1.0)
            self.assertLess(abs(shear), bound + strong)
            self.assertTrue(abs(slip) < far or abs(shear + math.copysign(bound, slip)) < strong, (slip, shear, bound))
        return u[1::2]


if __name__ == "__main__":
    unittest.main()
