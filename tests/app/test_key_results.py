#!/usr/bin/env python3
"""Key results and the ends of zones, computed again from the table and the grids."""
import csv
import math
import re
import unittest

from harness import CONTACT, PRESSURE, SUPPORT, TWO_BODIES, ProgramTest, block, read_vtu

PUSH = "load set = 'right'  traction = -1.5, 0.3"  # part of the floor sticks, part slides, part opens


class KeyResults(ProgramTest):
    """The member key_results of NAME.summary.json, computed again from table and grid."""

    def test_they_follow_from_table_and_grid(self):
        wall = "contact set = 'left'  friction = 0.2  obstacle = 'plane'  normal = 1.0, 0.0"
        pushed = (SUPPORT, PRESSURE, CONTACT, PUSH)
        decks = {
            "one set": block(*pushed),
            "two sets": block(PRESSURE, "load set = 'right'  traction = -0.5, 0.0", CONTACT, wall),
            "constant multipliers": block(SUPPORT, PRESSURE, CONTACT + "  multipliers = 'constant'  cells = 4", PUSH),
            "round obstacle": block(SUPPORT, PRESSURE, "contact set = 'bottom'  friction = 0.4  obstacle = 'parabola'"
                                    "  radius = 30.0  point = 2.3, -0.01"),
            "body of revolution": block("support set = 'right'  ux = 0.0", PRESSURE, CONTACT,
                                        material="young = 100.0  poisson = 0.3  hypothesis = 'axisymmetric'",
                                        mesh="size = 4.0, 2.0  cells = 8, 4  origin = 1.0, 0.0"),
            "two bodies": TWO_BODIES, "history": block(*pushed, "history times = 0.0")}
        for element in ("tri3", "tri6", "quad8", "quad9"):
            decks[element] = block(*pushed, mesh=f"size = 4.0, 2.0  cells = 8, 4  element = '{element}'")
        for name, deck in decks.items():
            with self.subTest(name):
                self.assert_key_results(self.solve(deck), name == "body of revolution", name == "two sets")

    def assert_key_results(self, result, is_axisymmetric, has_corner):
        """Computes the key results of the deck again."""
        arrays, _, _ = read_vtu(self.contents()["case.vtu"])
        line, _, _ = read_vtu(self.contents()["case.contact.vtu"])
        key = result.summary["key_results"]
        places = list(zip(result["x"], result["y"]))
        nodes = [point[:2] for point in arrays["points"]]
        closed = [status != "open" for status in result["status"]]
        for name, values, at in (
                ("contact_pressure", result["contact_pressure"], places),
                ("contact_shear", list(map(abs, result["contact_shear"])), places),
                ("slip", [abs(slip)*is_closed for slip, is_closed in zip(result["slip"], closed)], places),
                ("von_mises", list(arrays["nodal_von_mises"]), nodes),
                ("displacement", [math.hypot(*u) for u in arrays["displacement"]], nodes)):
            # The first of what is equal but for rounding.
            largest = max(values)
            place = next(p for p, value in zip(at, values) if value >= (1 - 1e-9)*largest)
            self.assertAlmostEqual(key[f"max_{name}"], largest, delta=1e-14*max(1.0, largest), msg=name)
            self.assertEqual((key[f"max_{name}_x"], key[f"max_{name}_y"]), place, name)
        sets = sorted(set(line["set"][:len(places)]))  # masters follow behind the contact points
        for number in sets:
            suffix = f"_{number}" if len(sets) > 1 else ""
            of_set = [i for i, other in enumerate(line["set"][:len(places)]) if other == number]
            forces = []
            for i in of_set:
                n, pressed, pushed = line["normal"][i], result["normal_force"][i], result["tangential_force"][i]
                forces.append((-pressed*n[0] + pushed*n[1], -pressed*n[1] - pushed*n[0]))
            normal = math.fsum(result["normal_force"][i] for i in of_set)
            acting = list(places)
            if has_corner and number == sets[1]:
                # The lowest point of the wall stands for the corner, too, of half its area.
                lowest = min(of_set, key=lambda i: places[i][1])
                acting[lowest] = (places[lowest][0], places[lowest][1]*2/3)
            moment = math.fsum(acting[i][0]*f[1] - acting[i][1]*f[0] for i, f in zip(of_set, forces))
            for k, axis in enumerate("xy"):
                self.assertAlmostEqual(key[f"contact_force_{axis}{suffix}"], math.fsum(f[k] for f in forces),
                                       delta=1e-13)
                center = math.fsum(result["normal_force"][i]*acting[i][k] for i in of_set)/normal
                self.assertAlmostEqual(key[f"contact_centroid_{axis}{suffix}"], center, delta=1e-13)
            if is_axisymmetric:
                self.assertNotIn(f"contact_moment{suffix}", key)
            else:
                self.assertAlmostEqual(key[f"contact_moment{suffix}"], moment, delta=1e-12)
            for width, zones in (("contact_width", "closed_zones"), ("stick_width", "stick_zones")):
                found = [zone for zone in result.summary[zones] if zone["set"] == number]
                self.assertAlmostEqual(key[width + suffix], math.fsum(zone["length"] for zone in found),
                                       delta=1e-14)
                for zone in found:
                    self.assertAlmostEqual(zone["length"], math.hypot(
                        zone["end_x"] - zone["start_x"], zone["end_y"] - zone["start_y"]), delta=1e-13)

    def test_rows_of_a_sweep_are_those_of_decks(self):
        groups = (SUPPORT, PRESSURE, CONTACT, PUSH.replace("load", "load name = 'p'"))
        self.run_program("--quiet", self.write("sweep.nml", block(
            *groups, "sweep load = 'p'  factor = 0.5, 1.0, -1.0", "output key_results = 'all'")))
        with open(self.directory / "sweep.sweep.csv", newline="", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        for row in rows:
            factor = float(row["factor_p"])
            single = self.solve(block(*groups[:3], f"load set = 'right'  traction = {-1.5*factor}, {0.3*factor}"))
            for name, value in single.summary["key_results"].items():
                # Two solutions to a residual of 1e-10 each; a slip of 1e-12 is none.
                self.assertAlmostEqual(float(row[name]), value, delta=1e-7*max(1.0, abs(value)), msg=name)

    def test_ends_between_nodes(self):
        # The middle of the contact anywhere between two nodes; a mesh that is eight times as fine has the true ends to
        # about a tenth of its distance of nodes. That of both ends on the coarse one is at most 0.15 in Hertz' contact,
        # where the nodes miss them by up to 0.9.
        for middle in (1.87, 1.96, 2.09):
            ends = {}
            for element, cells in (("quad8", 160), ("quad8", 20), ("tri6", 20), ("tri3", 40), ("quad4", 40)):
                zone, = self.solve(block(
                    "support set = 'top'  ux = 0.0  uy = -0.02", "contact set = 'bottom'  obstacle = 'circle'  "
                    f"radius = 5.0  point = {middle}, 0.0", mesh=f"size = 4.0, 2.0  cells = {cells}, {cells//2}  "
                    f"element = '{element}'")).summary["closed_zones"]
                ends.setdefault("true", (zone["start_x"], zone["end_x"]))
                for found, true in zip((zone["start_x"], zone["end_x"]), ends["true"]):
                    self.assertLess(abs(found - true), 0.15*0.1, (middle, element))

    def test_ends_on_a_line_of_unequal_sides(self):
        # Supports hold the first and the last node of a line whose sides are half as long from one to the next: zones
        # end beside the nodes that are closed, wherever the tributary lengths begin.
        for element in ("tri3", "quad4", "tri6", "quad8"):
            result = self.solve(block(
                "support set = 'bottom'  ux = 0.02  uy = 0.0", "support set = 'top'  ux = 0.02  uy = 0.0",
                "contact set = 'right'  obstacle = 'circle'  radius = 1.0  friction = 0.1  "
                "normal = -1.0, 0.0  point = 4.0, 1.75",
                mesh=f"size = 4.0, 2.0  cells = 8, 10  grading = 0.01  element = '{element}'"))
            places, zone = result["y"], result.summary["closed_zones"][0]
            closed = [place for place, status in zip(places, result["status"]) if status != "open"]
            self.assertEqual(len(result.summary["closed_zones"]), 1, element)
            least = max((place for place in places if place < min(closed)), default=0.0)
            most = min((place for place in places if place > max(closed)), default=2.0)
            self.assertTrue(least <= zone["start_y"] <= min(closed), element)
            self.assertTrue(max(closed) <= zone["end_y"] <= most, element)

    def test_one_closed_point(self):
        run = self.run_program(self.write("case.nml", block(
            "support set = 'left'  ux = 0.0", "support set = 'right'  ux = 0.0", "load set = 'top'  pressure = 1e-9",
            "contact set = 'bottom'  obstacle = 'circle'  radius = 0.01")), status=0)
        self.assertIn("; 1 of 9 points closed, peak pressure ", run.stdout)
        result = self.result("case")
        summary = result.summary
        self.assertEqual([summary["lengths"][name] for name in ("slip_length", "stick_length")], [0.0, 0.0])
        # Its tributary length.
        self.assertEqual(summary["key_results"]["contact_width"], result["weight"][result["status"].index("stick")])

    def test_nothing_sticks_without_friction(self):
        # Slips of 1e-18 and of 0: rounding decides which, and made a zone of points that stick of the latter.
        sides = "support set = 'left'  ux = 0.0", "support set = 'right'  ux = 0.0"
        for width in (5.157, 4.0, 3.3):
            result = self.solve(block(*sides, PRESSURE, "contact set = 'bottom'",
                                      mesh=f"size = {width}, 2.556  cells = 15, 5  element = 'quad9'"))
            self.assertEqual(result.summary["key_results"]["stick_width"], 0.0)

    def test_body_without_contact(self):
        run = self.run_program(self.write("case.nml", block("support set = 'bottom'  ux = 0.0  uy = 0.0", PRESSURE)))
        self.assertRegex(run.stdout, r"; no contact set, largest von Mises stress \d\S*, displacement \d\S*\n$")
        summary = self.result("case").summary
        self.assertEqual(set(summary["key_results"]), {name + ending for name in ("max_von_mises", "max_displacement")
                                                       for ending in ("", "_x", "_y")}
                         | {f"reaction_{component}_bottom" for component in ("x", "y", "moment")})
        listing = (self.directory / "case.lst").read_text(encoding="utf-8")
        for heading in ("Contact line\n", "Contact points (", "Max. pressure"):
            self.assertNotIn(heading, listing)


class Units(ProgramTest):
    """The units that a deck names, wherever the listing has a number."""

    UNITS = "case units = 'µm, kilonewton, kN/µm²'"

    def listing(self, *groups):
        """The listing of a deck with units."""
        self.screen = self.run_program(self.write("case.nml", block(*groups, self.UNITS))).stdout
        return (self.directory / "case.lst").read_text(encoding="utf-8")

    def test_columns_are_as_wide_as_their_units(self):
        text = self.listing(SUPPORT, PRESSURE, CONTACT)
        table = text[text.index("\nContact points ("):].splitlines()[3:7]
        ends = [[match.end() for match in re.finditer(r"\S+(?: \S+)*", line[:len(table[1])])] for line in table[1:]]
        self.assertEqual(ends[0], ends[1][1:9])
        self.assertEqual(table[1].split()[-1], "kN/µm²")

    def test_model(self):
        push = "load set = 'right'  traction = -1.5, 0.3"
        text = self.listing(SUPPORT, PRESSURE, push, CONTACT + "  extra_gap = 0.01")
        for part in ("young 100.0 kN/µm²", "ux 0.0 µm", "traction -1.5, 0.3 kN/µm²",
                     "extra_gap 0.01 µm"):
            self.assertIn(part, text)

    def test_screen_and_warnings(self):
        run = self.run_program(self.write("case.nml", block(SUPPORT, "load set = 'top'  pressure = 10.0", CONTACT,
                                                            self.UNITS)))
        self.assertRegex(run.stdout, r"; open \S+ µm, slip \S+ µm, stick \S+ µm; 9 of 9 points closed, peak pressure "
                         r"\S+ kN/µm²\n")
        self.assertRegex(run.stdout, r"\ncase: warning: strain of \S+ % at \(\S+, \S+\) µm; ")
        self.run_program("--verify", ".")
        run = self.run_program(self.write("case.nml", block("support set = 'bottom'  ux = 0.0  uy = 0.0", PRESSURE,
                                                            self.UNITS)))
        self.assertRegex(run.stdout, r"; no contact set, largest von Mises stress \S+ kN/µm², displacement \S+ µm\n")

    def test_overlap_by_rounding_is_no_note(self):
        for depth, count in ((1e-15, 0), (1e-6, 1)):
            text = self.listing(SUPPORT, PRESSURE, CONTACT + f"  extra_gap = {-depth}")
            self.assertEqual(text.count("the body overlaps the obstacle by up to"), count)

    def test_extremes_of_a_sweep(self):
        text = self.listing(SUPPORT, "load name = 'p'  set = 'top'  pressure = 1.0", CONTACT,
                            "sweep load = 'p'  factor = 1.0, 2.0")
        self.assertRegex(text, "  max_contact_pressure +\\S+ +1 +\\S+ +2 kN/µm²\n")
        self.assertRegex(text, "  contact_moment +\\S+ +\\d +\\S+ +\\d kilonewton µm\n")

    def test_history(self):
        text = self.listing(SUPPORT, "load name = 'p'  set = 'top'  pressure = 1.0", CONTACT,
                            "history times = 0.0, 1.0", "steps load = 'p'  factor = 0.0, 1.0")
        self.assertRegex(self.screen, r"; dissipation \S+ kilonewton µm, energy error \S+ kilonewton µm\n")
        self.assertRegex(text, "Work of loads +\\S+ kilonewton µm\n")
        table = text[text.index("\nStates at the times"):].splitlines()
        self.assertEqual(table[4].split(), ["µm"]*3 + ["kilonewton"]*2 + ["kilonewton", "µm"]*3)
        self.assertEqual({len(line) for line in table[3:7]}, {len(table[3])})


if __name__ == "__main__":
    unittest.main()
