#!/usr/bin/env python3
"""What must not change the long bar: units, stiffness, scale of the loads, position in the plane, threads."""
import unittest
from dataclasses import replace

from harness import HAS_SUITESPARSE, read_vtu
from long_bar import MESHES, ROWS, TABLE, LongBarTest

# Newton's method ends each case exactly, so that two ways to the same forces differ by rounding only, 1e-16 times
# condition numbers of about 1e4 for the forces and of 1e3 more for displacements and for the free rigid motion.
TOLERANCE = 1e-9
MIRRORED = {"open": "open", "stick": "stick", "slip+": "slip-", "slip-": "slip+"}


class Invariance(LongBarTest):
    """Each row against itself in another form."""

    def assert_same(self, found, expected, force_scale=1.0, length_scale=1.0):
        """Checks statuses, forces, gaps and slips, the latter two with their own scales."""
        self.assertEqual(found["status"], expected["status"])
        self.assert_forces(found, expected, TOLERANCE, force_scale)
        lengths = [length_scale*length for length in expected["gap"] + expected["slip"]]
        self.assert_close(found["gap"] + found["slip"], lengths, TOLERANCE*max(map(abs, lengths)))

    def test_si_units(self):
        # 1 mm = 1e-3 m, 1 daN/mm^2 = 1e7 Pa, and a force per thickness of 1 daN/mm = 1e4 N/m.
        for element, diagonal in MESHES:
            expected = self.solve_rows(element=element, diagonal=diagonal)
            results = self.solve_rows(element=element, diagonal=diagonal, length_unit=1e-3, stress_unit=1e7)
            for row in ROWS:
                self.assert_same(results[row], expected[row], 1e4, 1e-3)
                self.assert_close(results[row].lengths, [1e-3*length for length in expected[row].lengths], 1e-14)

    def test_young_scales_displacements_only(self):
        expected = self.solve_rows()
        for factor in (1e-5, 3.0, 1e6):
            for row, result in self.solve_rows(young=13000.0*factor).items():
                self.assert_same(result, expected[row], 1.0, 1.0/factor)

    def test_loads_scale_everything(self):
        expected = self.solve_rows()
        for factor in (1e-6, 7.0, 1e6):
            for row in ROWS:
                bar = replace(TABLE[row], push=TABLE[row].push*factor, pressure=TABLE[row].pressure*factor)
                self.assert_same(self.solve(bar.deck()), expected[row], factor, factor)

    def test_quarter_turns(self):
        # The points follow the line with the body on its left: turned, but in the same order.
        for element, diagonal in MESHES:
            expected = self.solve_rows(element=element, diagonal=diagonal)
            for turns in (1, 2, 3):
                turned = turned_diagonal(diagonal, turns)
                for row, result in self.solve_rows(element=element, diagonal=turned, turns=turns).items():
                    self.assert_same(result, expected[row])

    def test_mirror_images(self):
        # The points come in the opposite order, and slip along the tangent becomes slip against it.
        for element, diagonal in MESHES:
            expected = self.solve_rows(element=element, diagonal=diagonal)
            for turns in (0, 1, 2, 3):
                turned = turned_diagonal(diagonal, turns + 1)
                results = self.solve_rows(element=element, diagonal=turned, is_mirrored=True, turns=turns)
                for row, result in results.items():
                    for column in ("slip", "tangential_force"):
                        result.columns[column] = [-value for value in result[column]]
                    result.columns["status"] = [MIRRORED[status] for status in result["status"]]
                    for values in result.columns.values():
                        values.reverse()
                    self.assert_same(result, expected[row])

    def test_pinned_corner(self):
        for element, diagonal in MESHES:
            expected = {}
            for row in self.solve_rows(element=element, diagonal=diagonal):
                expected[row] = self.displacements(row)
            self.solve_rows(element=element, diagonal=diagonal,
                            further_groups="&support point = 40.0, 0.0  uy = 0.0 /")
            for row in ROWS:
                largest = max(map(abs, expected[row]))
                self.assert_close(self.displacements(row), expected[row], TOLERANCE*largest)

    def displacements(self, row):
        """The displacements of all nodes, one component after the other."""
        arrays, *_ = read_vtu((self.directory / f"row_{row}.vtu").read_bytes())
        return [component for displacement in arrays["displacement"] for component in displacement]

    def test_start_from_another_row(self):
        for row, expected in self.solve_rows(rows=(5, 4, 3, 2, 1)).items():
            self.assert_same(self.solve_rows(rows=[row])[row], expected)

    def test_threads_change_no_bit(self):
        solvers = [("quad4", ""), ("quad4", "factorization = 'multifrontal'"), ("tri3", "method = 'psor'")]
        if HAS_SUITESPARSE:
            solvers.append(("quad4", "factorization = 'sparse'"))
        for element, solver in solvers:
            tables = []
            for n_threads in ("1", "2", "2"):
                self.solve_rows(options=["--threads", n_threads], element=element, solver=solver)
                # The table of the run has times.
                tables.append({name: text for name, text in self.contents().items()
                               if name.endswith((".csv", ".vtu")) and name != "batch.csv"})
            self.assertEqual(len(tables[0]), 15)
            self.assertEqual(tables[0], tables[1])
            self.assertEqual(tables[1], tables[2])


def turned_diagonal(diagonal, turns):
    """What the diagonals of the cells become by quarter turns, or by a mirror image, which counts as one."""
    if turns % 2 == 0:
        return diagonal
    return {"right": "left", "left": "right", "alternating": "alternating"}[diagonal]


if __name__ == "__main__":
    unittest.main()
