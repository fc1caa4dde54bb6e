#!/usr/bin/env python3
"""Load histories of all kinds of bodies, laws and obstacles: solved, certified, verified, and cut in two."""
import shutil
import unittest

from histories import HistoryTest
from mapped_mesh import mapped_mesh

TIMES = "&history times = 0.0, 1.0, 2.0, 3.0  substeps = 4"
BLOCK = """&mesh size = 4.0, 2.0  cells = 12, 6  element = '{element}' /
&material young = 100.0  poisson = 0.3  expansion = 1e-3  hypothesis = '{hypothesis}' /
"""
PRESSED = """&support name = 'top'  set = 'top'  uy = -0.05 /
&support set = 'left'  ux = 0.0 /
&load name = 'push'  set = 'right'  traction = 5.0, 0.0 /
&steps load = 'push'  factor = 0.0, 1.0, -0.7, 0.9 /
&steps support = 'top'  factor = 1.0, 1.5, 0.5, 1.2 /
&steps contact = 'bottom'  friction_factor = 1.0, 0.5, 1.5, 1.0 /
"""
# On an elastic block on springs, above a floor that rises, shifts and turns while its friction goes to nothing.
STACK = """&mesh name = 'a'  size = 4.0, 2.0  cells = 10, 4 /
&mesh name = 'b'  size = 6.0, 2.0  cells = 9, 3  origin = -1.0, -2.0 /
&material young = 100.0  poisson = 0.25 /
&support set = 'a.top'  spring_n = 50.0  spring_t = 50.0 /
&load set = 'a.top'  pressure = 1.0 /
&load name = 'push'  set = 'a.right'  traction = 3.0, 0.0 /
&contact set = 'a.bottom'  against = 'b.top'  {law} /
&contact name = 'floor'  set = 'b.bottom'  friction = 0.4  point = 0.0, -2.0 /
&steps load = 'push'  factor = 0.0, 1.0, -0.7, 0.9 /
&steps obstacle = 'floor'  shift_x = 0.0, 0.02, -0.03, 0.01  shift_y = 0.0, 0.02, 0.01, 0.04
       turn = 0.0, 0.003, -0.002, 0.001  pivot = 2.0, -2.0 /
&steps contact = 'floor'  friction_factor = 1.0, 0.5, 1.5, 0.0 /
"""
RELEASED = """&case name = 'released' /
&mesh size = 4.0, 2.0  cells = 8, 4 /
&mesh name = 'high'  size = 2.0, 1.0  cells = 5, 3  origin = 1.0, 2.0 /
&material young = 1000.0  poisson = 0.3 /
&contact name = 'floor'  set = 'bottom'  friction = 0.5 /
&contact set = 'high.bottom'  against = 'top'  friction = 0.3 /
&load name = 'press'  set = 'high.top'  traction = 0.2, -1.0 /
&history times = 0.0, 1.0, 2.0, 3.0  substeps = 4 /
&steps load = 'press'  factor = 0.0, 1.0, 0.0, 0.0 /
&steps obstacle = 'floor'  shift_y = 0.0, 0.0, 0.0, -0.01 /
&output probe = 0.0, 2.0, 3.0, 3.0 /
"""
WEDGE = """&case name = 'wedge' /
&mesh file = 'wedge.msh' /
&material young = 1000.0  poisson = 0.3 /
&contact set = 'left'  friction = {friction}  point = -1.0, 0.0  normal = 1.0, 0.2 /
&contact set = 'right'  friction = {friction}  point = 1.0, 0.0  normal = -1.0, 0.2 /
&load name = 'press'  set = 'top'  traction = 0.0, -1.0 /
&history times = 0.0, 1.0, 2.0, 3.0  substeps = 4 /
&steps load = 'press'  factor = 0.0, 1.0, 0.0, 0.0 /
"""
PLANE = BLOCK.format(element="quad4", hypothesis="plane strain")
DECKS = {
    "axisymmetric, given bound": BLOCK.format(element="quad8", hypothesis="axisymmetric") + PRESSED
    + "&contact set = 'bottom'  slip_bound = 0.5 /\n",
    "both bounds": BLOCK.format(element="tri6", hypothesis="plane stress") + PRESSED
    + "&contact set = 'bottom'  friction = 0.2  slip_bound = 0.1 /\n",
    "cells": PLANE + PRESSED + "&contact set = 'bottom'  friction = 0.3  multipliers = 'constant' /\n",
    "pair": STACK.format(law="friction = 0.3"),
    "pair with interference": STACK.format(law="friction = 0.3  gap = 'touching'  extra_gap = -0.01"),
    "pair of cells": STACK.format(law="friction = 0.3  multipliers = 'constant'"),
    "pair with a given bound": STACK.format(law="slip_bound = 0.3"),
    "rolled ball": PLANE + """&support set = 'top'  ux = 0.0  uy = 0.0 /
&contact set = 'bottom'  friction = 0.3  obstacle = 'circle'  point = 2.0, 0.0  radius = 5.0 /
&steps obstacle = 'bottom'  shift_x = 0.0, 0.0, 0.2, -0.2  shift_y = 0.0, 0.1, 0.1, 0.05  turn = 0.0, 0.0, 0.1, -0.1
       pivot = 2.0, -5.0 /
""",
    "heated": PLANE + """&support set = 'left'  ux = 0.0 /
&load name = 'hot'  temperature = 20.0 /
&load set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.3 /
&steps load = 'hot'  factor = 0.0, 1.0, 0.0, -1.0 /
""",
    "dragged": PLANE + """&support set = 'right'  spring_n = 5.0 /
&load set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = 0.3 /
&steps obstacle = 'bottom'  shift_x = 0.0, 1.0, -1.0, 2.0 /
""",
    "between two moving plates": PLANE + """&contact name = 'low'  set = 'bottom'  friction = 0.3 /
&contact name = 'high'  set = 'top'  friction = 0.2  point = 0.0, 2.0  normal = 0.0, -1.0 /
&steps obstacle = 'high'  shift_x = 0.0, 0.05, -0.05, 0.0  shift_y = -0.05, -0.05, -0.06, -0.02 /
&steps obstacle = 'low'  shift_x = 0.0, -0.03, 0.03, 0.05 /
""",
}
# Bodies that nothing loads at first, in or near an obstacle, and that contact alone holds: some lie flat on it then,
# some stand on their ends, far from the gaps of their middle.
LOADED_FROM_NOTHING = (
    """&mesh size = 1.65247, 0.496711  cells = 5, 2  element = 'quad8' /
&material young = 191.598  poisson = 0.03868  hypothesis = 'plane stress' /
&load name = 'push'  set = 'left'  traction = -0.0238662, 0.0 /
&load name = 'press'  set = 'top'  pressure = 0.0157156  pressure_slope = -0.00163633, 0.0 /
&contact set = 'bottom'  friction = 1.0  extra_gap = -0.000794864 /
""",
    """&mesh size = 6.07297, 3.31425  cells = 35, 2  element = 'tri3' /
&material young = 1515.67  poisson = 0.2677 /
&load name = 'push'  set = 'left'  traction = 1.08858, 0.0 /
&load name = 'press'  set = 'top'  pressure = 14.6113  pressure_slope = -0.230551, 0.0 /
&contact set = 'bottom'  friction = 0.3  extra_gap = -0.24684  point = 3.03649, 0.0  obstacle = 'parabola'
         radius = -3441.0 /
""",
    """&mesh size = 2.71148, 0.336884  cells = 32, 1  element = 'tri3' /
&material young = 259.334  poisson = 0.4301 /
&load name = 'push'  set = 'left'  traction = -1.53818e-5, 0.0 /
&load name = 'press'  set = 'top'  pressure = 2.8606e-5  pressure_slope = 4.67461e-7, 0.0 /
&contact set = 'bottom'  friction = 0.2  extra_gap = 0.000163993  point = 1.35574, 0.0  obstacle = 'circle'
         normal = 0.00793818103, 0.999968493  radius = -212.183 /
""",
    """&mesh size = 4.97328, 2.91288  cells = 35, 1  element = 'quad8' /
&material young = 21275.3  poisson = 0.05094  hypothesis = 'plane stress' /
&load name = 'push'  set = 'left'  traction = 0.00409841, 0.0 /
&load name = 'press'  set = 'top'  pressure = 0.037423  pressure_slope = 0.00110899, 0.0 /
&contact set = 'bottom'  friction = 0.1  extra_gap = -0.0043588  point = 2.48664, 0.0  obstacle = 'circle'
         normal = -0.00566540399, 0.999983952  radius = -92.7685 /
""")
LOADING = """&history times = 0.0, 1.0, 2.0 /
&steps load = 'push'  factor = {start}, 0.4, -0.1 /
&steps load = 'press'  factor = {start}, 1.0, 0.8 /
"""
# In its obstacle at first and loaded by next to nothing at the end: the work of the forces' rounding errors on the way
# out is larger than that of the forces on the strains.
NEARLY_UNLOADED = """&case name = 'body' /
&mesh size = 2.63954, 0.635586  cells = 7, 2  element = 'quad8' /
&material young = 653.784  poisson = 0.1263  hypothesis = 'plane stress' /
&support set = 'right'  ux = 0.0 /
&load name = 'push'  set = 'left'  traction = 2.6e-5, 0.0 /
&load name = 'press'  set = 'top'  pressure = 0.3  pressure_slope = -0.01, 0.0 /
&contact set = 'bottom'  friction = 0.1  extra_gap = -3e-4 /
&history times = 0.0, 1.0, 2.0 /
&steps load = 'push'  factor = 0.0, 4.0, 1.0 /
&steps load = 'press'  factor = 0.0, 1.0, 0.0 /
"""
# A block on a block, pressed and unloaded to nothing again and again.
UNLOADED = ("""&case name = 'body' /
&mesh name = 'a'  size = 20.0, 5.0  cells = 6, 6  element = 'tri6' /
&mesh name = 'b'  size = 20.0, 2.0  cells = 4, 3  element = 'tri6'  origin = 0.0, 5.0 /
&material region = 'a'  young = 5934.513893009139  poisson = 0.3  thickness = 5.0 /
&material region = 'b'  young = 20547.686298206838  poisson = 0.3  thickness = 5.0 /
&contact set = 'a.bottom'  friction = 0.1 /
&contact set = 'b.bottom'  against = 'a.top'  friction = 0.1 /
&support set = 'b.left'  ux = 0.0 /
&load name = 'p'  set = 'b.top'  pressure = 11.339952413412208 /
&load name = 't'  set = 'b.left'  traction = 0.04747611114407312, 0.0 /
&history times = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0 /
&steps load = 'p'  factor = 0.0, 1.0, 0.0, 0.0, 1.0, 7e-7, 1.0, 0.0, 0.0 /
&steps load = 't'  factor = 0.0, 0.0, 0.0, 0.0, 1.0, 7e-7, 0.0, 0.0, 0.0 /
&output fields_every = 1 /
""", """&case name = 'body' /
&mesh name = 'a'  size = 24.0, 5.0  cells = 5, 2  element = 'tri6'  origin = -2.0, 0.0 /
&mesh name = 'b'  size = 20.0, 2.0  cells = 11, 4  origin = 0.0, 5.0 /
&material region = 'a'  young = 24098.43794772085  poisson = 0.3 /
&material region = 'b'  young = 15231.463206888788  poisson = 0.3 /
&contact set = 'a.bottom'  friction = 0.2 /
&contact set = 'b.bottom'  against = 'a.top'  friction = 0.3 /
&support set = 'b.left'  ux = 0.0 /
&load name = 'p'  set = 'b.top'  pressure = 8.011734623290353 /
&load name = 't'  set = 'b.left'  traction = 0.5783625107453004, 0.0 /
&history times = 0.0, 1.0, 2.0, 3.0, 4.0 /
&steps load = 'p'  factor = 0.0, 1e-6, 7e-7, 0.7, 0.0 /
&steps load = 't'  factor = 0.0, 1e-6, 7e-7, 0.7, 0.0 /
&output fields_every = 1 /
""")

class Bodies(HistoryTest):
    """Each history as a whole, and from a state in its middle."""

    def test_histories_are_solved_verified_and_cut_in_two(self):
        for adaptive in ("", "  step_tolerance = 0.05"):
            for name, deck in DECKS.items():
                with self.subTest(name, adaptive=adaptive):
                    self.check("&case name = 'body' /\n" + deck, adaptive)

    def check(self, deck, adaptive):
        """Solves a history, verifies it, and goes on from its middle."""
        wanted = "&output points_every = 1  states_every = 1  fields_every = 9 /\n"
        self.walk(deck + f"{TIMES}{adaptive} /\n" + wanted)
        self.assertEqual(self.run_program("--verify", "out").stdout, "body: verified\n")
        history = self.summary("body")["load_history"]
        # Residuals of 1e-10; friction takes energy and gives none.
        self.assertLess(history["energy_identities"], 1e-8)
        rows = self.text("body.history.csv").splitlines()
        taken = [float(row["dissipation_step"]) for row in self.table("body.history.csv")]
        self.assertGreaterEqual(min(taken), 0.0)
        self.assertGreater(sum(taken), 0.0)
        middle = len(taken)//2
        shutil.copy(self.results / "body.states.csv", self.directory)
        self.walk(deck + f"{TIMES}{adaptive}  start = 'body.states.csv'  start_step = {middle} /\n" + wanted)
        self.assertEqual(self.text("body.history.csv").splitlines(), [rows[0], *rows[middle + 1:]])

    def test_loose_bodies_are_loaded_from_nothing_by_every_exact_method(self):
        for number, body in enumerate(LOADED_FROM_NOTHING):
            for start in (0.0, 1e-3):
                expected = None
                for method in ("auto", "newton", "lemke"):
                    with self.subTest(number, start=start, method=method):
                        self.walk(f"&case name = 'body' /\n{body}{LOADING.format(start=start)}"
                                  f"&solver method = '{method}' /\n")
                        found = [float(row["normal_force"]) for row in self.table("body.contact.csv")]
                        expected = expected or found
                        # Residuals of 1e-10, times what soft modes make of them.
                        for force, other in zip(found, expected):
                            self.assertAlmostEqual(force, other, delta=1e-7*max(expected))

    def test_unloaded_body_stays_where_it_was_drawn(self):
        above = PLANE + "&contact set = 'bottom'  friction = 0.3  extra_gap = 0.1 /\n{rest}"
        pressed = "&load name = 'press'  set = 'top'  pressure = 1.0 /\n"
        self.walk("&case name = 'body' /\n" + above.format(rest=""))
        alone = self.table("body.contact.csv")
        self.assertEqual({(row["gap"], row["slip"], row["status"]) for row in alone}, {("0.1", "0.0", "open")})
        # Nor does it stay where a deck before, or a step, has pressed it.
        self.write("first.nml", "&case name = 'first' /\n" + above.format(rest=pressed))
        self.run_program("--output", "out", "first.nml", self.write("deck.nml", "&case name = 'body' /\n"
                                                                   + above.format(rest="")))
        self.assertEqual(self.table("body.contact.csv"), alone)
        self.assertNotIn("Started from", self.text("body.lst"))
        self.walk("&case name = 'body' /\n" + above.format(rest=pressed + "&history times = 0.0, 1.0 /\n"
                                                            "&steps load = 'press'  factor = 0.0, 1.0 /\n"))
        self.assertAlmostEqual(sum(float(row["normal_force"]) for row in self.table("body.contact.csv")), 4.0)
        self.assertEqual(self.table("body.history.csv")[0]["normal_force"], "0.0")

    def test_work_on_a_long_way_is_measured_by_this_way(self):
        self.walk(NEARLY_UNLOADED)
        self.assertTrue(self.summary("body")["certificate"]["passed"])

    def test_what_unloading_leaves_is_measured_by_the_forces_before(self):
        for number, deck in enumerate(UNLOADED):
            with self.subTest(number):
                self.walk(deck)
                self.assertEqual(self.run_program("--verify", "out").stdout, "body: verified\n")

    def test_a_state_knows_what_was_carried_before(self):
        for number, deck in enumerate(UNLOADED):
            self.walk(deck.replace("fields_every", "states_every"))
            shutil.copy(self.results / "body.states.csv", self.directory)
            rows, states = self.text("body.history.csv").splitlines(), self.text("body.states.csv").splitlines()
            for step in range(1, len(rows) - 1):
                with self.subTest(number, step=step):
                    self.walk(deck.replace("&history", f"&history start = 'body.states.csv'  start_step = {step} ")
                              .replace("fields_every", "states_every"))
                    self.assertEqual(self.run_program("--verify", "out").stdout, "body: verified\n")
                    self.assertEqual(self.text("body.history.csv").splitlines(), [rows[0], *rows[step + 1:]])
                    self.assertEqual(self.text("body.states.csv").splitlines(), [states[0], *states[step + 1:]])
                    # Of energies that are rounding nothing is missing, not only less than 1e-8 of them.
                    self.assertLess(self.summary("body")["load_history"]["energy_identities"], 1e-10)

    def test_unloaded_body_has_no_forces_and_no_strain(self):
        # Nothing is left of the solution with loads but where it has moved the bodies to.
        self.walk(UNLOADED[0])
        # Rounding may leave some 1e-16 of the forces before, 1134 in all.
        self.assertLess(max(abs(float(row["normal_force"])) for row in self.table("body.contact.csv")), 1e-15*1134.0)
        # The same of the energies, 5.04 before, where the bodies have moved: with the kernels of some processors.
        self.assertLess(abs(self.summary("body")["load_history"]["strain_energy"]), 1e-15*5.04)

    def test_unloaded_bodies_stay_while_their_floor_moves_away(self):
        # They were solved from the slips of the step before, and moved on by what rounding made of these.
        self.walk(RELEASED)
        for probe in ("ux_1", "uy_1", "ux_2", "uy_2"):
            places = [float(row[probe]) for row in self.table("released.history.csv")][8:]
            self.assertLess(max(places) - min(places), 1e-15)
            if probe.startswith("uy"):
                self.assertLess(max(map(abs, places)), 1e-15, msg="points that were pressed keep touching")

    def test_given_slip_bound_takes_an_unloaded_body_along_with_its_floor(self):
        # Above the floor, without a normal force; a method sought the place in a thousand iterations.
        self.walk("""&case name = 'body' /
&mesh size = 6.34, 1.0  cells = 4, 3  element = 'tri6' /
&material young = 1000.0  poisson = 0.3  hypothesis = 'plane stress' /
&load name = 'press'  set = 'top'  pressure = 0.2 /
&contact name = 'floor'  set = 'bottom'  friction = 0.9  slip_bound = 0.03  point = 6.34, 0.0  normal = -0.03, 1.0 /
&history times = 0.0, 1.0, 2.0  substeps = 2 /
&steps load = 'press'  factor = 0.0, 0.0, 1.0 /
&steps obstacle = 'floor'  shift_x = 0.0, 0.0004, -0.0004 /
&output probe = 0.0, 0.0 /
""")
        for row, way in zip(self.table("body.history.csv"), (0.0, 2e-4, 4e-4)):
            self.assertAlmostEqual(float(row["ux_1"]), way, delta=1e-15)
            self.assertAlmostEqual(float(row["uy_1"]), 0.0, delta=1e-15)
            self.assertEqual((row["normal_force"], row["tangential_force"], row["iterations"]), ("0.0", "0.0", "0"))

    def test_wedged_body_keeps_its_forces_without_loads(self):
        # Friction holds a trapezoid in a groove steeper than its angle; without friction it comes loose.
        groove = mapped_mesh((8, 4), "quad4", lambda s, t: ((2.0*s - 1.0)*(1.0 + 0.2*t), t))
        (self.directory / "wedge.msh").write_text(groove, encoding="utf-8")
        for friction, is_wedged in ((0.5, True), (0.1, False)):
            self.walk(WEDGE.format(friction=friction))
            pressed, *released = [float(row["normal_force"]) for row in self.table("wedge.history.csv")][4:]
            self.assertGreater(pressed, 3.0)
            # The load went in four equal steps: the forces go on as in those before.
            self.assertEqual([force > 0.6*pressed for force in released[3:]], [is_wedged]*5)
            self.assertEqual(len(set(released[3:])), 1)
            if not is_wedged:
                self.assertEqual(released[3], 0.0)


if __name__ == "__main__":
    unittest.main()
