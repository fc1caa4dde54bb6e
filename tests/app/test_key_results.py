#!/usr/bin/env python3
"""Key results and the ends of zones, computed again from the table and the grids."""
import math
import unittest

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block, read_vtu

PUSH = "load set = 'right'  traction = -1.5, 0.3"  # part of the floor sticks, part slides, part opens


class KeyResults(ProgramTest):
    """The member key_results of NAME.summary.json, computed again from table and grid."""

    def test_they_follow_from_table_and_grid(self):
        wall = "contact set = 'left'  friction = 0.2  obstacle = 'plane'  normal = 1.0, 0.0"
        for decks in ((SUPPORT, PRESSURE, CONTACT, PUSH),
                      (PRESSURE, "load set = 'right'  traction = -0.5, 0.0", CONTACT, wall)):
            result = self.solve(block(*decks))
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
            sets = sorted(set(line["set"]))
            for number in sets:
                suffix = f"_{number}" if len(sets) > 1 else ""
                of_set = [i for i, other in enumerate(line["set"]) if other == number]
                forces = []
                for i in of_set:
                    n, pressed, pushed = line["normal"][i], result["normal_force"][i], result["tangential_force"][i]
                    forces.append((-pressed*n[0] + pushed*n[1], -pressed*n[1] - pushed*n[0]))
                normal = math.fsum(result["normal_force"][i] for i in of_set)
                moment = math.fsum(places[i][0]*f[1] - places[i][1]*f[0] for i, f in zip(of_set, forces))
                for k, axis in enumerate("xy"):
                    self.assertAlmostEqual(key[f"contact_force_{axis}{suffix}"], math.fsum(f[k] for f in forces),
                                           delta=1e-13)
                    center = math.fsum(result["normal_force"][i]*places[i][k] for i in of_set)/normal
                    self.assertAlmostEqual(key[f"contact_centroid_{axis}{suffix}"], center, delta=1e-13)
                self.assertAlmostEqual(key[f"contact_moment{suffix}"], moment, delta=1e-12)
                for width, zones in (("contact_width", "closed_zones"), ("stick_width", "stick_zones")):
                    found = [zone for zone in result.summary[zones] if zone["set"] == number]
                    self.assertAlmostEqual(key[width + suffix], math.fsum(zone["length"] for zone in found),
                                           delta=1e-14)
                    for zone in found:
                        self.assertAlmostEqual(zone["length"], math.hypot(
                            zone["end_x"] - zone["start_x"], zone["end_y"] - zone["start_y"]), delta=1e-13)

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


if __name__ == "__main__":
    unittest.main()
