#!/usr/bin/env python3
"""Table 1 of Pop and Zelina (2005): the lengths of the separated, sliding and sticking parts."""
import unittest
from pathlib import Path

from long_bar import LENGTH, MESHES, ROWS, SEGMENT, TABLE, LongBarTest

INPUT = Path(__file__).resolve().parents[2] / "input"
# AB, BC and CD in mm. Row 2 is printed as 5, 20.75 and 7.5, which add up to 33.25; all other rows add up to 40, and
# 20.75 is no multiple of the segment. It must be 27.5.
LENGTHS = {1: (3.75, 20.0, 16.25), 2: (5.0, 27.5, 7.5), 3: (0.0, 40.0, 0.0), 4: (0.0, 22.5, 17.5), 5: (0.0, 5.0, 35.0)}


class Table1(LongBarTest):
    """The rows on 32 x 10 cells."""

    def assert_transitions(self, found, expected, distance, message=None):
        """Checks that the ends of the separated and the sliding part lie within a distance of others."""
        self.assertLessEqual(abs(found[0] - expected[0]), distance + 1e-9, message)
        self.assertLessEqual(abs(found[0] + found[1] - expected[0] - expected[1]), distance + 1e-9, message)
        self.assertAlmostEqual(sum(found), LENGTH, delta=1e-12)

    def test_transitions_lie_within_a_segment_on_quadrilaterals(self):
        # They move by a segment with the mesh.
        for row, result in self.solve_rows().items():
            self.assert_transitions(result.lengths, LENGTHS[row], SEGMENT, f"row {row}: {result.lengths}")

    def test_transitions_lie_within_a_segment_on_triangles_but_one(self):
        # Triangles of 1.25 mm x 4 mm are stiff: with each of the diagonals row 4 slides up to 25 mm, two segments
        # beyond the table. On 20 rows of cells that is 23.75 mm.
        for element, diagonal in MESHES[1:]:
            for row, result in self.solve_rows(element=element, diagonal=diagonal).items():
                self.assert_transitions(result.lengths, LENGTHS[row], 2*SEGMENT if row == 4 else SEGMENT,
                                        f"{diagonal}, row {row}: {result.lengths}")
            finer = self.solve_rows(rows=[4], element=element, diagonal=diagonal, cells=(32, 20))[4]
            self.assert_transitions(finer.lengths, LENGTHS[4], SEGMENT, f"{diagonal}: {finer.lengths}")

    def test_elements_tend_to_the_same_lengths(self):
        # One segment of 64: half of what the elements differ by on 32.
        expected = self.solve_rows(cells=(64, 20))
        for element, diagonal in MESHES[1:]:
            for row, result in self.solve_rows(element=element, diagonal=diagonal, cells=(64, 20)).items():
                self.assert_transitions(result.lengths, expected[row].lengths, 0.5*SEGMENT, f"{diagonal}, row {row}")

    def test_decks_of_the_input_folder_are_the_rows(self):
        self.run_program("--quiet", *(INPUT / f"long_bar_{row}.nml" for row in ROWS))
        results = self.solve_rows()
        for row in ROWS:
            self.assertEqual(self.result(f"long_bar_{row}").columns, results[row].columns)

    def test_deck_of_triangles_is_row_1(self):
        self.run_program("--quiet", INPUT / "long_bar_tri3.nml")
        expected = self.solve_rows(rows=[1], element="tri3", diagonal="alternating")[1]
        self.assertEqual(self.result("long_bar_tri3").columns, expected.columns)
        self.assert_transitions(expected.lengths, LENGTHS[1], SEGMENT)

    def test_rows_1_and_3_are_exact_on_quadrilaterals(self):
        results = self.solve_rows()
        for row in (1, 3):
            # The lengths are sums of distances between nodes.
            self.assert_close(results[row].lengths, LENGTHS[row], 1e-12)

    def test_lengths_are_those_read_from_the_nodes(self):
        # AB ends at the first closed node, BC at the first sticking node, CD at D.
        for element, diagonal in MESHES:
            for result in self.solve_rows(element=element, diagonal=diagonal).values():
                nodes = list(zip(result["x"], result["status"]))
                b = next(x for x, status in nodes if status != "open")
                c = next(x for x, status in nodes if status == "stick")
                self.assert_close(result.lengths, (b, c - b, LENGTH - c), 1e-12)
                self.assertEqual([status for x, status in nodes if b <= x < c], ["slip+"]*round((c - b)/SEGMENT))

    def test_every_row_is_certified(self):
        for element, diagonal in MESHES:
            for result in self.solve_rows(element=element, diagonal=diagonal).values():
                self.assertIs(result.summary["converged"], True)
                self.assertIs(result.summary["certificate"]["passed"], True)


class Resultants(LongBarTest):
    """What holds on any mesh."""

    def test_floor_bears_the_load_of_the_top(self):
        for element, diagonal in MESHES:
            for row, result in self.solve_rows(element=element, diagonal=diagonal).items():
                # |f| x 40 mm; the certificate allows 1e-8, rounding gives about 1e-14.
                expected = {1: 200.0, 2: 200.0, 3: 200.0, 4: 600.0, 5: 1000.0}[row]
                self.assertAlmostEqual(sum(result["normal_force"]), expected, delta=1e-10*expected)
                self.assertAlmostEqual(result.summary["resultants"]["normal_force"], expected, delta=1e-10*expected)

    def test_sliding_points_bear_their_slip_bound(self):
        for element, diagonal in MESHES:
            for row, result in self.solve_rows(element=element, diagonal=diagonal).items():
                pairs = list(zip(result["status"], result["normal_force"], result["tangential_force"]))
                normal = sum(force for status, force, _ in pairs if status == "slip+")
                tangential = sum(force for status, _, force in pairs if status == "slip+")
                self.assertAlmostEqual(tangential, TABLE[row].friction*normal, delta=1e-12*normal)
                if row == 3:
                    # Every point slides but the one on the symmetry plane, whose support bears its tangential force.
                    self.assertEqual(result["status"], ["slip+"]*32 + ["stick"])
                    self.assertEqual(result["tangential_force"][-1], 0.0)
                    self.assertAlmostEqual(sum(result["tangential_force"]), tangential, delta=1e-12*normal)

    def test_slip_is_along_the_push(self):
        for element, diagonal in MESHES:
            for result in self.solve_rows(element=element, diagonal=diagonal).values():
                self.assertGreaterEqual(min(result["slip"]), -1e-15)

    def test_pressure_is_largest_at_the_symmetry_plane(self):
        # On triangles the force on an end node depends on the diagonal of its cell.
        for result in self.solve_rows(rows=[1, 2]).values():
            self.assertEqual(max(result["contact_pressure"]), result["contact_pressure"][-1])


if __name__ == "__main__":
    unittest.main()
