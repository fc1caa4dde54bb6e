#!/usr/bin/env python3
"""Cycles of load histories, and what the stresses of the surface say of fretting."""
import math
import shutil
import unittest

from harness import read_vtu
from histories import HistoryTest

BAR = """&case name = 'bar' /
&mesh size = 40.0, 40.0  cells = 16, 6 /
&material young = 13000.0  poisson = 0.2  hypothesis = 'plane strain' /
&support set = 'right'  ux = 0.0 /
&load name = 'F'  set = 'left'  traction = 1.0, 0.0 /
&load name = 'f'  set = 'top'  traction = 0.0, -5.0 /
&contact set = 'bottom'  friction = 1.0 /
&history times = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0  substeps = 4  cycles = 1.0, 3.0, 5.0 /
&steps load = 'F'  factor = 0.0, 10.0, -10.0, 10.0, -10.0, 10.0 /
&steps load = 'f'  factor = 0.0, 1.0, 1.0, 1.0, 1.0, 1.0 /
&output points_every = 1  fretting = 'parameters' /
"""
# A body in uniform stress on a smooth floor: -2 along it, -3 across it.
PATCH = """&case name = 'patch' /
&mesh size = 3.0, 2.0  cells = 6, 4  element = '{element}' /
&material young = 200.0  poisson = 0.3  expansion = 1e-3  hypothesis = '{hypothesis}' /
&load set = 'right'  traction = -2.0, 0.0 /
&load set = 'top'  traction = 0.0, -3.0 /
&load temperature = 10.0 /
&contact set = 'bottom'  multipliers = '{multipliers}' /
&history times = 0.0 /
&output points_every = 1  fretting = 'parameters' /
"""
# A block that is held at its top while the floor moves under it; PRESS and SHIFT are put in.
BLOCK = """&case name = 'block' /
&mesh size = 2.0, 1.0  cells = 4, 2 /
&material young = 100.0  poisson = 0.0 /
&support set = 'top'  ux = 0.0  uy = 0.0 /
&support name = 'press'  set = 'left'  ux = 0.0 /
&contact set = 'bottom'  friction = {friction}  gap_direction = 0.0, -1.0  extra_gap = -0.01 /
&history times = 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0  substeps = 2  cycles = 0.0  period = 2.0 /
&steps obstacle = 'bottom'  shift_x = {shift} /
"""


class Fretting(HistoryTest):
    """Decks with cycles."""

    def table(self, name):
        """The rows of a table, its numbers as such."""
        def value(text):
            try:
                return float(text)
            except ValueError:
                return text
        return [{key: value(text) for key, text in row.items()} for row in super().table(name)]

    def load_history(self):
        """What the summary says of the bar's history."""
        return self.summary("bar")["load_history"]

    def points(self, first, last, name="bar"):
        """For each contact point its rows from one step to another."""
        rows = [row for row in self.table(f"{name}.points.csv") if first <= row["step"] <= last]
        return [[row for row in rows if row["point"] == point] for point in sorted({row["point"] for row in rows})]

    def test_uniform_stress_is_exact(self):
        for element in ("quad4", "tri6"):
            for hypothesis in ("plane strain", "plane stress", "axisymmetric"):
                for multipliers in ("nodal", "constant"):
                    with self.subTest(element=element, hypothesis=hypothesis, multipliers=multipliers):
                        text = PATCH.format(element=element, hypothesis=hypothesis, multipliers=multipliers)
                        if hypothesis != "axisymmetric":
                            text += "&support set = 'left'  ux = 0.0 /\n"
                        self.walk(text)
                        for row in self.table("patch.points.csv"):
                            # Rounding.
                            self.assertAlmostEqual(row["surface_stress"], -2.0, delta=1e-11)

    def test_slave_of_a_pair_has_its_own_stress(self):
        bodies = [f"&mesh name = '{name}'  size = 3.0, 2.0  cells = {cells}, 4  origin = 0.0, {y} /\n"
                  f"&material region = '{name}'  young = {young}  poisson = {poisson} /\n"
                  f"&support set = '{name}.left'  ux = 0.0 /\n&load set = '{name}.right'  traction = {q}, 0.0 /\n"
                  for name, cells, y, young, poisson, q in (("a", 6, 0.0, 200.0, 0.3, -1.0),
                                                            ("b", 5, 2.0, 500.0, 0.2, 2.0))]
        for multipliers in ("mortar", "constant"):
            self.walk("&case name = 'pair' /\n" + "".join(bodies) + "&support set = 'a.bottom'  uy = 0.0 /\n"
                      "&load set = 'b.top'  traction = 0.0, -3.0 /\n&history times = 0.0 /\n"
                      f"&contact set = 'b.bottom'  against = 'a.top'  multipliers = '{multipliers}' /\n"
                      "&output points_every = 1  fretting = 'parameters' /\n")
            for row in self.table("pair.points.csv"):
                # Rounding.
                self.assertAlmostEqual(row["surface_stress"], 2.0, delta=1e-11)

    def test_stress_along_the_surface_converges_to_that_of_the_nodes(self):
        differences = []
        for cells in (16, 32):
            self.walk(BAR.replace("cells = 16, 6", f"cells = {cells}, {cells//2}  element = 'quad8'"))
            arrays, _, _ = read_vtu((self.results / "bar.vtu").read_bytes())
            stress = {(round(x, 6), round(y, 6)): s[0]
                      for (x, y, _), s in zip(arrays["points"], arrays["nodal_stress"])}
            rows = self.table("bar.contact.csv")
            differences.append(sum(abs(row["surface_stress"] - stress[round(row["x"], 6), round(row["y"], 6)])
                                   for row in rows)/len(rows))
        # Means over the line; stresses are about 10. At the ends of zones stresses have kinks, where the order is 1.
        self.assertLess(differences[1], 0.1)
        self.assertLess(differences[1], 0.55*differences[0])

    def test_parameters_are_those_of_the_steps(self):
        self.walk(BAR)
        # The second cycle, from the end of step 13 to that of step 21.
        for rows in self.points(13, 21):
            area = next(row["weight"] for row in self.table("bar.contact.csv") if row["point"] == rows[0]["point"])
            young, poisson = 13000.0, 0.2
            stresses = []
            for row in rows:
                normal, shear, along = -row["normal_force"]/area, -row["tangential_force"]/area, row["surface_stress"]
                stresses.append((normal, shear, along, poisson*(normal + along)))
            slips = [row["slip"] for row in rows]
            ruiz = max(abs(s[1]) for s in stresses)*(max(slips) - min(slips))
            tension = max(0.0, max(s[2] for s in stresses))
            best = 0.0
            for k in range(-44, 46):
                c, s = math.cos(math.radians(2*k)), math.sin(math.radians(2*k))
                on_plane = [t*c*c + 2*q*s*c + n*s*s for n, q, t, _ in stresses]
                strain = [((1 + poisson)*p - poisson*(n + t + z))/young for p, (n, _, t, z) in zip(on_plane, stresses)]
                best = max(best, max(0.0, max(on_plane))*(max(strain) - min(strain))/2)
            last = rows[-1]
            # The same sums in another order.
            self.assertAlmostEqual(last["ruiz_1"], ruiz, delta=1e-9)
            self.assertAlmostEqual(last["ruiz_2"], tension*ruiz, delta=1e-8)
            self.assertAlmostEqual(last["swt"], best, delta=1e-9)
        self.assertGreater(max(row["swt"] for row in self.table("bar.contact.csv")), 1e-3)

    def test_mirrored_and_in_other_units_the_parameters_are_the_same(self):
        self.walk(BAR)
        here = self.table("bar.contact.csv")
        mirrored = (BAR.replace("set = 'right'", "set = 'aside'").replace("set = 'left'", "set = 'right'")
                    .replace("'aside'", "'left'").replace("traction = 1.0", "traction = -1.0"))
        self.walk(mirrored)
        for one, other in zip(here, reversed(self.table("bar.contact.csv"))):
            for column in ("surface_stress", "ruiz_1", "ruiz_2", "swt"):
                # Two solutions to a residual of 1e-10.
                self.assertAlmostEqual(one[column], other[column], delta=1e-6)
            self.assertAlmostEqual(abs(one["swt_angle"]), abs(other["swt_angle"]), delta=1e-9)
        # Lengths in m instead of mm, forces in N instead of daN.
        self.walk(BAR.replace("40.0, 40.0", "0.04, 0.04").replace("13000.0", "1.3e11")
                  .replace("traction = 1.0", "traction = 1.0e7").replace("-5.0 /", "-5.0e7 /")
                  .replace("expansion", "thickness = 1.0"))
        for one, other in zip(here, self.table("bar.contact.csv")):
            for column, factor in (("surface_stress", 1e7), ("ruiz_1", 1e4), ("ruiz_2", 1e11), ("swt", 1e7)):
                self.assertAlmostEqual(one[column], other[column]/factor, delta=1e-6)

    def test_cycles_add_up_to_the_history(self):
        self.walk(BAR)
        rows, cycles = self.table("bar.history.csv"), self.table("bar.cycles.csv")
        self.assertEqual([(cycle["begin"], cycle["end"], cycle["steps"]) for cycle in cycles],
                         [(1.0, 3.0, 8.0), (3.0, 5.0, 8.0)])
        for cycle, first, last in zip(cycles, (4, 12), (12, 20)):
            for name, columns in (("dissipation", ("dissipation",)), ("strain_energy_change", ("strain_energy",)),
                                  ("work", ("work_loads", "work_supports", "work_obstacles"))):
                change = sum(rows[last][column] - rows[first][column] for column in columns)
                # The same numbers, summed in another way.
                self.assertAlmostEqual(cycle[name], change, delta=1e-12)
        self.assertEqual([cycle["outcome"] for cycle in cycles], ["first", "steady"])
        summary = self.load_history()
        self.assertEqual([summary[f"cycle{name}"] for name in ("s", "_outcome", "_outcome_since")], [2, "steady", 2])
        self.assertEqual(summary["cycle_dissipation"], cycles[-1]["dissipation"])
        self.assertEqual(summary["max_swt"], cycles[-1]["max_swt"])
        end = [rows[-1] for rows in self.points(13, 21)]
        for column in ("ruiz_1", "ruiz_2", "swt"):
            self.assertEqual(cycles[-1][f"max_{column}"], max(row[column] for row in end))
        listing = (self.results / "bar.lst").read_text(encoding="utf-8")
        self.assertRegex(listing, r"\n +2 +5\.0 .* steady\n")
        self.assertIn("Fretting, last cycle", listing)
        self.assertEqual(self.run_program("--verify", "out").stdout, "bar: verified\n")

    def test_period_marks_the_cycles_that_a_list_does(self):
        self.walk(BAR)
        cycles = (self.results / "bar.cycles.csv").read_text(encoding="utf-8")
        self.walk(BAR.replace("cycles = 1.0, 3.0, 5.0", "cycles = 1.0  period = 2.0"))
        self.assertEqual((self.results / "bar.cycles.csv").read_text(encoding="utf-8"), cycles)

    def test_halved_steps_end_where_cycles_do(self):
        self.walk(BAR.replace("substeps = 4", "step_tolerance = 1e-3"))
        self.assertGreater(self.load_history()["steps_given_up"], 5)
        self.assertEqual([cycle["end"] for cycle in self.table("bar.cycles.csv")], [3.0, 5.0])
        self.assertEqual(self.run_program("--verify", "out").stdout, "bar: verified\n")

    def test_outcomes_of_cycles(self):
        for name, friction, shift, expected in (
                # The floor goes back and forth under the block.
                ("steady", 0.1, "0.0, 0.2, 0.0, 0.2, 0.0, 0.2, 0.0", ["first", "changing", "steady"]),
                # It goes on and on.
                ("ratcheting", 0.1, "0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2", ["first", "changing", "ratcheting"]),
                # It goes farther each time.
                ("changing", 0.1, "0.0, 0.2, 0.0, 0.3, 0.0, 0.4, 0.0", ["first", "changing", "changing"]),
                # Friction holds everything.
                ("shakedown", 50.0, "0.0, 0.001, 0.0, 0.001, 0.0, 0.001, 0.0", ["shakedown"]*3)):
            with self.subTest(name=name):
                self.walk(BLOCK.format(friction=friction, shift=shift))
                self.assertEqual([cycle["outcome"] for cycle in self.table("block.cycles.csv")], expected)
                self.run_program("--quiet", "--verify", "out")

    def test_restart_within_a_cycle_has_the_same_bytes(self):
        text = BAR.replace("points_every", "states_every = 5  points_every")
        self.walk(text)
        names = ("bar.contact.csv", "bar.history.csv", "bar.cycles.csv", "bar.points.csv")
        whole = {name: (self.results / name).read_text(encoding="utf-8").splitlines() for name in names}
        shutil.copy(self.results / "bar.states.csv", self.directory)
        for step in (1, 6, 11, 16):
            self.walk(text.replace("&history", f"&history start = 'bar.states.csv'  start_step = {step}"))
            for name in names:
                rows = (self.results / name).read_text(encoding="utf-8").splitlines()
                self.assertEqual(rows, whole[name][:1] + whole[name][len(whole[name]) - len(rows) + 1:])
            self.assertEqual(len((self.results / "bar.cycles.csv").read_text(encoding="utf-8").splitlines()),
                             3 if step < 13 else 2)
        # A history with other cycles passes over what is noted of them.
        self.walk(text.replace("&history", "&history start = 'bar.states.csv'  start_step = 6")
                  .replace("  cycles = 1.0, 3.0, 5.0", "").replace("  fretting = 'parameters'", ""))
        self.assertEqual([row["dissipation"] for row in self.table("bar.history.csv")],
                         [float(row.split(",")[whole["bar.history.csv"][0].split(",").index("dissipation")])
                          for row in whole["bar.history.csv"][7:]])

    def test_states_without_what_they_should_note_are_refused(self):
        self.write("bad.csv", "step,x\n1,2.0\n")
        run = self.walk(BAR.replace("&history", "&history start = 'bad.csv'"), status=1)
        self.assertIn("bad.csv: this state cannot be the start: it is of 2 numbers", run.stderr)

    def test_forged_cycle_is_found(self):
        self.walk(BAR)
        path = self.results / "bar.cycles.csv"
        text = path.read_text(encoding="utf-8")
        for forged, expected in ((text.replace("steady", "ratcheting"), "follows from the other files"),
                                 (text + text.splitlines(keepends=True)[-1], "nothing follows here from"),
                                 (text.splitlines(keepends=True)[0], "bar.cycles.csv: it ends before the line '1,")):
            path.write_text(forged, encoding="utf-8")
            self.renew_manifest("bar")
            self.assertIn(expected, self.run_program("--verify", "out", status=4).stderr)


if __name__ == "__main__":
    unittest.main()
