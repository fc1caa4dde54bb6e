#!/usr/bin/env python3
"""Wear in histories: depths, volumes and works, what a state keeps of them, and steps that are too long."""
import csv
import math
import re
import unittest

from histories import HistoryTest

# A block without lateral strain, so that what slides is the floor alone; its support holds the corner at 0, 0.
BLOCK = """&mesh size = 4.0, 2.0  cells = 8, 4  element = '{element}' /
&material young = 100.0  poisson = 0.0  hypothesis = 'plane stress'  thickness = 0.5 /
&support set = 'left'  ux = 0.0 /
&load set = 'top'  pressure = 3.0 /
&contact name = 'sole'  set = 'bottom'  wear = 1.0e-3  multipliers = '{multipliers}' /
&steps obstacle = 'sole'  shift_x = 0.0, 0.4, -0.2 /
"""
PAIR = """&mesh name = 'a'  size = 4.0, 2.0  cells = 8, 4  element = '{element}' /
&mesh name = 'b'  size = 4.0, 1.0  cells = 7, 2  element = '{element}'  origin = 0.0, -1.0 /
&material young = 100.0  poisson = 0.0  hypothesis = 'plane stress'  thickness = 0.5 /
&support name = 'drive'  set = 'a.left'  ux = 1.0 /
&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /
&load set = 'a.top'  pressure = 3.0 /
&contact name = 'sole'  set = 'a.bottom'  against = 'b.top'  gap = 'touching'  wear = 1.0e-3
         multipliers = '{multipliers}' /
&steps support = 'drive'  factor = 0.0, 0.4, -0.2 /
"""
TIMES = """&history times = 0.0, 1.0, 2.0  substeps = 3 /
&output points_every = 1  states_every = 1  fields_every = 3 /
"""
WAY = 0.4 + 0.6
# A soft block that slides on a floor with a crown, beside a wall that does not wear.
CROWNED = """&case name = 'crowned' /
&mesh size = 8.0, 4.0  cells = 16, 6 /
&material young = 100.0  poisson = 0.3 /
&support set = 'left'  ux = 0.0 /
&load name = 'press'  set = 'top'  pressure = 1.0 /
&contact name = 'floor'  set = 'bottom'  friction = 0.2  wear = 1.0e-3
         obstacle = 'parabola'  radius = 200.0  point = 4.0, 0.0 /
&contact name = 'wall'  set = 'right'  normal = -1.0, 0.0  point = 8.1, 0.0 /
&history times = {}  substeps = 6 /
&steps load = 'press'  factor = {} /
&steps obstacle = 'floor'  shift_x = {} /
"""
BODIES = """&case name = 'bodies' /
&mesh name = 'a'  size = 4.0, 2.0  cells = 8, 4  origin = 0.5, 0.0 /
&mesh name = 'b'  size = 5.0, 1.0  cells = 11, 2  origin = 0.5, -1.0 /
&material region = 'a'  young = 100.0  poisson = 0.3  hypothesis = 'axisymmetric' /
&material region = 'b'  young = 300.0  poisson = 0.2  hypothesis = 'axisymmetric' /
&support name = 'drive'  set = 'a.left'  ux = 0.02 /
&load name = 'press'  set = 'a.top'  pressure = 0.2 /
&contact name = 'sole'  set = 'a.bottom'  against = 'b.top'  gap = 'touching'  friction = 0.2  wear = 5.0e-2 /
&contact name = 'floor'  set = 'b.bottom'  normal = 0.0, 1.0  point = 0.0, -1.0  friction = 0.1  wear = 1.0e-2 /
&contact name = 'floor'  set = 'b.right'  normal = -1.0, 0.0  point = 5.5, 0.0  friction = 0.2  wear = 2.0e-3 /
&steps support = 'drive'  factor = 0.0, 1.0, -1.0, 1.0 /
&steps load = 'press'  factor = 0.0, 1.0, 1.5, 1.0 /
&history times = 0.0, 1.0, 2.0, 3.0  substeps = 20 /
&output points_every = 20  states_every = 20 /
"""
WHOLE = "0.0, 1.0, 2.0, 3.0", "1.0, 2.0, 0.5, 1.0", "0.0, 0.3, -0.3, 0.2"


def number_of_set(point):
    """Which contact set of BODIES a point of its contact table belongs to; the corner below is a point of two."""
    if float(point["normal_x"]) == 1.0:
        return 3
    return 2 if float(point["y"]) == -1.0 else 1


class Wear(HistoryTest):
    """Histories of what wears."""

    def test_uniform_pressure_wears_by_archard_exactly(self):
        disc = BLOCK.replace("'plane stress'  thickness = 0.5", "'axisymmetric'")
        for name, text in (("block", BLOCK), ("pair", PAIR), ("disc", disc)):
            area = math.pi*4.0**2 if name == "disc" else 4.0*0.5
            for element, multipliers in (("quad4", "nodal"), ("quad8", "nodal"), ("tri3", "constant")):
                if name == "pair" and multipliers == "nodal":
                    multipliers = "mortar"
                with self.subTest(name=name, element=element, multipliers=multipliers):
                    self.walk(text.format(element=element, multipliers=multipliers) + TIMES)
                    last = self.table("deck.history.csv")[-1]
                    points = [row for row in self.table("deck.points.csv") if row["step"] == last["step"]]
                    depth = 1.0e-3*3.0*WAY
                    # Sums of seven steps of solutions that are exact but for rounding.
                    self.assert_close([float(row["wear_depth"]) for row in points], [depth]*len(points), 1e-11*depth)
                    self.assert_close([float(row["wear_integral"]) for row in points], [3.0*WAY]*len(points), 1e-11)
                    self.assertAlmostEqual(float(last["wear_volume_sole"]), depth*area, delta=1e-11*depth*area)
                    key = self.summary("deck")["key_results"]
                    self.assertAlmostEqual(key["wear_volume_sole"], depth*area, delta=1e-11*depth*area)
                    self.assertAlmostEqual(key["max_wear_depth"], depth, delta=1e-11*depth)
                    self.run_program("--verify", "out")

    def test_volume_is_wear_times_force_times_way(self):
        self.walk(CROWNED.format(*WHOLE))
        rows = self.table("crowned.history.csv")
        self.assertNotIn("wear_volume_wall", rows[0])
        with open(self.results / "crowned.contact.csv", newline="", encoding="utf-8") as table:
            points = [row for row in csv.DictReader(table) if float(row["y"]) == 0.0]
        volume = sum(float(row["wear_depth"])*float(row["weight"]) for row in points)
        self.assertAlmostEqual(volume, float(rows[-1]["wear_volume_floor"]), delta=1e-13)
        # Where all points slide all the way, the volume of a step is k times force times way.
        dissipation = float(rows[-1]["dissipation"])
        self.assertAlmostEqual(volume, 1.0e-3*dissipation/0.2, delta=1e-3*volume)
        # What wear takes of the energy is work of the floor: the identities hold, and nothing is missing.
        history = self.summary("crowned")["load_history"]
        self.assertLess(history["energy_identities"], 1e-10)
        self.run_program("--verify", "out")

    def test_history_in_two_parts_is_the_whole_one(self):
        self.walk(CROWNED.format(*WHOLE))
        whole = self.table("crowned.history.csv")
        self.walk(CROWNED.format("0.0, 1.0, 2.0", "1.0, 2.0, 0.5", "0.0, 0.3, -0.3").replace("'crowned'", "'first'")
                  + "&output states_every = 6 /\n")
        second = CROWNED.format(*WHOLE).replace("'crowned'", "'second'").replace(
            "substeps = 6", "substeps = 6  start = 'out/first.states.csv'")
        self.walk(second)
        rows = self.table("second.history.csv")
        self.assertEqual([row["wear_volume_floor"] for row in rows], [row["wear_volume_floor"] for row in whole[13:]])
        self.assertEqual(rows[-1]["energy_error"], whole[-1]["energy_error"])
        self.run_program("--verify", "out")
        # Another coefficient is that of further wear: what was worn before stays.
        self.walk(second.replace("wear = 1.0e-3", "wear = 0.0").replace("'second'", "'third'"))
        with open(self.results / "third.contact.csv", newline="", encoding="utf-8") as table:
            depth = max(float(row["wear_depth"]) for row in csv.DictReader(table))
        self.assertAlmostEqual(depth, float(whole[12]["max_wear_depth"]), delta=1e-15)

    def test_volumes_of_contacts_by_name(self):
        # Two bodies around an axis on a floor and in a wall, three coefficients: what one name has is a sum.
        self.walk(BODIES)
        last = self.table("bodies.history.csv")[-1]
        points = [row for row in self.table("bodies.points.csv") if row["step"] == last["step"]]
        numbers = {row["point"]: number_of_set(row) for row in self.table("bodies.contact.csv")}
        for name, coefficients in (("sole", {1: 5.0e-2}), ("floor", {2: 1.0e-2, 3: 2.0e-3})):
            volume = 0.0
            for number, wear in coefficients.items():
                mine = [row for row in points if numbers[row["point"]] == number]
                depths = [float(row["wear_depth"]) for row in mine]
                self.assertGreater(max(depths), 0.0)
                self.assert_close(depths, [wear*float(row["wear_integral"]) for row in mine], 1e-14*max(depths))
                volume += sum(depth*float(row["area"]) for depth, row in zip(depths, mine))
            self.assertAlmostEqual(float(last[f"wear_volume_{name}"]), volume, delta=1e-13*volume)
        self.assertLess(self.summary("bodies")["load_history"]["energy_identities"], 1e-10)
        self.run_program("--verify", "out")
        states = self.results / "bodies.states.csv"
        sound = states.read_text(encoding="utf-8")
        lines = sound.splitlines(keepends=True)
        names, last = lines[0].rstrip().split(","), lines[-1].split(",")
        for label in "wear_depth", "added_gap":
            with self.subTest(label=label):
                # The largest of the numbers, by a thousandth more.
                place = max((place for place, name in enumerate(names) if re.fullmatch(label + "_[0-9]+", name)),
                            key=lambda place: float(last[place]))
                forged = [*last[:place], repr(1.001*float(last[place])), *last[place + 1:]]
                states.write_text("".join([*lines[:-1], ",".join(forged)]), encoding="utf-8")
                self.assertIn(f"{names[place]} is ", self.run_program("--verify", "out", status=4).stderr)

    def test_steps_that_are_too_long_are_warned_of(self):
        deck = BLOCK.format(element="quad4", multipliers="nodal").replace("= 100.0", "= 1000.0") + \
            "&history times = 0.0, 1.0, 2.0  substeps = {} /\n"
        self.walk(deck.format(1))
        sentence, = self.summary("deck")["warnings"]
        found = re.fullmatch(r"the depth worn in step 3 would relieve a contact point of ([0-9.]+) times its pressure: "
                             r"from 0.25 on pressures may swing from step to step; take ([0-9]+) times as many "
                             r"substeps there", sentence)
        self.assertTrue(found, sentence)
        share, times = float(found[1]), int(found[2])
        self.assertEqual(times, math.ceil(share/0.25))
        self.run_program("--verify", "out")
        self.walk(deck.format(times))
        self.assertEqual(self.summary("deck")["warnings"], [])
        self.walk(deck.format(times - 1))
        self.assertIn(" 2 times as many", self.summary("deck")["warnings"][0])


if __name__ == "__main__":
    unittest.main()
