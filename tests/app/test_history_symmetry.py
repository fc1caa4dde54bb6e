#!/usr/bin/env python3
"""Load histories that must be the same: with signs reversed, mirrored, in other units, on any number of threads; and
the long bar's history in the digits of another program."""
import re
import unittest

from histories import BAR, HistoryTest

# The bar, its symmetry plane on the left.
MIRRORED = (BAR.replace("'right'", "'middle'").replace("'left'", "'right'").replace("'middle'", "'left'")
            .replace("traction = 1.0, 0.0", "traction = -1.0, 0.0"))
# An independent program (doc/guide.md): after all five legs, by steps per leg, what friction took and what the work
# done left behind besides strain energy.
DISSIPATED = {"1.0": {1: (6.018874, 3.0506), 4: (6.004551, 5.8909), 20: (6.019907, 6.010977), 80: (6.015675, 6.015146),
                      320: (6.015285, 6.015257)},
              "0.2": {1: (3.3152, None), 4: (3.2509, None), 20: (3.238117, None), 80: (3.237480, None),
                      320: (3.237433, 3.237413)}}
# Zones and u_x at 0, 0 behind the first, the second and the last leg with friction 1.
REACHED = {1: ("3.75", "20.0", "16.25", 0.014488876), 2: ("3.75", "27.5", "8.75", 0.02845943843),
           5: ("3.75", "25.0", "11.25", 0.013855954)}


def digits(number):
    """Half of the last digit of a number as it is written here."""
    return 0.5*10.0**-len(repr(number).partition(".")[2])


class Symmetry(HistoryTest):
    """The same history, written in another way."""

    def histories(self, *decks):
        """The rows of the histories of some decks."""
        found = []
        for deck in decks:
            self.walk(deck + "&output points_every = 1  probe = 0.0, 0.0,  40.0, 0.0 /\n")
            found.append((self.table("bar.history.csv"), self.table("bar.points.csv")))
        return found

    def test_signs_of_load_and_factors_reversed_leave_the_same_bytes(self):
        reverse = (BAR.replace("traction = 1.0, 0.0", "traction = -1.0, 0.0")
                   .replace("0.0, 10.0, 15.0, 5.0, -15.0, 10.0", "0.0, -10.0, -15.0, -5.0, 15.0, -10.0"))
        (_, points), (rows, reversed_points) = self.histories(BAR, reverse)
        self.assertEqual(float(rows[4]["factor_F"]), -10.0)
        self.assertEqual(reversed_points, points)

    def test_mirrored_history_has_the_same_numbers(self):
        (rows, points), (mirrored_rows, mirrored_points) = self.histories(BAR, MIRRORED)
        for row, mirrored in zip(rows, mirrored_rows):
            for column in ("open_length", "slip_length", "stick_length", "normal_force", "strain_energy", "work_loads",
                           "dissipation", "max_slip_step", "energy_error"):
                # Two solutions to residuals of 1e-10 of forces near 200 and displacements near 0.03.
                self.assertAlmostEqual(float(row[column]), float(mirrored[column]), delta=1e-7, msg=column)
            self.assertAlmostEqual(float(row["ux_1"]), -float(mirrored["ux_2"]), delta=1e-11)
        m = 33
        for k in range(0, len(points), m):
            for point, mirrored in zip(points[k:k + m], reversed(mirrored_points[k:k + m])):
                self.assertAlmostEqual(float(point["normal_force"]), float(mirrored["normal_force"]), delta=1e-7)
                self.assertAlmostEqual(float(point["tangential_force"]), -float(mirrored["tangential_force"]),
                                       delta=1e-7)
                self.assertEqual(point["status"], mirrored["status"].translate(str.maketrans("+-", "-+")))

    def test_other_units_scale_the_same_digits(self):
        # Meters and newtons instead of millimeters and decanewtons.
        length, force = 1e-3, 10.0
        stress = force/length**2
        other = re.sub(r"size = 40.0, 40.0", f"size = {40*length!r}, {40*length!r}", BAR)
        # Forces per thickness: the depth of the body is another, too.
        other = other.replace("13000.0", repr(13000*stress)).replace("poisson", f"thickness = {length!r}  poisson")
        other = other.replace("traction = 1.0, 0.0", f"traction = {stress!r}, 0.0")
        other = other.replace("traction = 0.0, -5.0", f"traction = 0.0, {-5*stress!r}")
        self.walk(BAR + "&output points_every = 1 /\n")
        rows, points = self.table("bar.history.csv"), self.table("bar.points.csv")
        self.walk(other + "&output points_every = 1 /\n")
        units = {"open_length": length, "slip_length": length, "stick_length": length, "normal_force": force,
                 "tangential_force": force, "work_loads": force*length, "strain_energy": force*length,
                 "dissipation": force*length, "max_slip_step": length, "step_indicator": 1.0}
        self.assert_scaled(rows, self.table("bar.history.csv"), units)
        units = {"x": length, "area": length**2, "contact_pressure": stress, "contact_shear": stress,
                 "normal_force": force, "tangential_force": force, "gap": length, "slip": length, "slip_step": length,
                 "dissipation": force*length, "wear_integral": force/length}
        scaled = self.table("bar.points.csv")
        self.assert_scaled(points, scaled, units)
        self.assertEqual([point["status"] for point in points], [point["status"] for point in scaled])

    def assert_scaled(self, rows, scaled, units):
        """Checks that the columns of a table are those of another one in other units."""
        self.assertEqual(len(rows), len(scaled))
        for column, unit in units.items():
            numbers = [float(row[column])*unit for row in rows]
            # Residuals of 1e-10 on both sides, over the largest of the column.
            self.assert_close([float(row[column]) for row in scaled], numbers, 1e-9*max(map(abs, numbers)), column)

    def test_history_has_the_digits_of_another_program(self):
        for friction, table in DISSIPATED.items():
            for substeps, (dissipated, left) in table.items():
                self.walk(BAR.replace("friction = 1.0", f"friction = {friction}").replace(
                    "substeps = 4", f"substeps = {substeps}") + "&output probe = 0.0, 0.0 /\n")
                rows = self.table("bar.history.csv")
                last = rows[-1]
                with self.subTest(friction=friction, substeps=substeps):
                    self.assertAlmostEqual(float(last["dissipation"]), dissipated, delta=digits(dissipated))
                    works = sum(float(last[f"work_{what}"]) for what in ("loads", "supports", "obstacles"))
                    if left:
                        self.assertAlmostEqual(works - float(last["strain_energy"]), left, delta=digits(left))
                    # Monotone legs end in the same state however many steps they are taken in; the last one does not.
                    for time, (*zones, moved) in REACHED.items():
                        if friction != "1.0" or time > 2 and substeps > 1:
                            continue
                        row = rows[time*substeps]
                        self.assertEqual([row[f"{zone}_length"] for zone in ("open", "slip", "stick")], zones)
                        self.assertAlmostEqual(float(row["ux_1"]), moved, delta=digits(moved))

    def test_files_do_not_depend_on_the_number_of_threads(self):
        # Enough points that the threads share the work on matrices; halved steps too.
        text = (BAR.replace("cells = 32, 10", "cells = 160, 60").replace("substeps = 4", "step_tolerance = 0.05")
                + "&output points_every = 1  states_every = 1  fields_every = 10  probe = 0.0, 0.0 /\n")
        self.write("deck.nml", text)
        found = []
        for threads in (1, 4):
            self.run_program("--quiet", "--threads", threads, "--output", "out", "deck.nml")
            found.append({path.relative_to(self.results): path.read_bytes() for path in self.results.rglob("*")
                          if path.is_file() and path.suffix not in (".json", ".lst")})
        self.assertGreater(self.summary("bar")["load_history"]["steps_given_up"], 0)
        self.assertEqual(sorted(found[0]), sorted(found[1]))
        for name, content in found[0].items():
            self.assertTrue(content == found[1][name], name)


if __name__ == "__main__":
    unittest.main()
