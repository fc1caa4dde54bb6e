#!/usr/bin/env python3
"""Every method finds the same forces; the two that do not solve the problem say so."""
import unittest
from dataclasses import replace

from harness import HAS_SUITESPARSE, words_of
from long_bar import MESHES, TABLE, LongBarTest

# Residuals of 1e-10 are differences of forces of up to 1e-9 here: the compliance turns one into the other.
TOLERANCE = 1e-8
METHODS = (
    "method = 'newton'",
    "method = 'splitting'",
    "method = 'fixed_point'",
    "method = 'psor'",
    "method = 'psor'  space = 'primal'  omega = 1.6",
    "method = 'splitting'  box = 'mprgp'",
    "method = 'fixed_point'  box = 'mprgp'",
    "method = 'psor'  local = 'block'",
    "method = 'psor'  acceleration = 'aitken'",
    "method = 'psor'  acceleration = 'anderson'",
    "method = 'psor'  space = 'primal'  local = 'block'  acceleration = 'anderson'",
    "method = 'extragradient'  max_iterations = 10000",
    "method = 'lemke'",
)


class Methods(LongBarTest):
    """All rows, on quadrilaterals and triangles."""

    def test_no_method_is_forgotten(self):
        for name in words_of("solver", "method"):
            self.assertTrue(name == "auto" or any(f"method = '{name}'" in method for method in METHODS), name)

    def test_methods_agree(self):
        for element, diagonal in MESHES:
            expected = self.solve_rows(element=element, diagonal=diagonal)
            for method in METHODS:
                results = self.solve_rows(element=element, diagonal=diagonal, solver=method)
                for row, result in results.items():
                    label = f"{element} {diagonal}, row {row}, {method}"
                    self.assert_forces(result, expected[row], TOLERANCE, message=label)
                    self.assertEqual(result["status"], expected[row]["status"], label)
                    self.assertIs(result.summary["certificate"]["passed"], True, label)

    def test_methods_agree_from_rest(self):
        # Rows of one run start from the row before; here each starts from rest.
        for row, expected in self.solve_rows().items():
            for method in METHODS:
                result = self.solve_rows(rows=[row], solver=method)[row]
                self.assert_forces(result, expected, TOLERANCE, message=f"row {row}, {method}")

    def test_over_relaxed_dual_sweeps_are_right_or_say_that_they_are_not(self):
        # At friction 1 relaxation of 1.6 need not converge in the dual space.
        for element in ("quad4", "tri3"):
            expected = self.solve_rows(element=element)
            for row in expected:
                bar = replace(TABLE[row], element=element, solver="method = 'psor'  omega = 1.6")
                run = self.run_program(self.write("bar.nml", bar.deck()), status=None)
                result = self.result("bar")
                self.assertEqual(run.returncode, 0 if result.summary["converged"] else 4)
                if row in (3, 4, 5):
                    self.assertIs(result.summary["converged"], True)
                if result.summary["converged"]:
                    self.assert_forces(result, expected[row], TOLERANCE, message=f"{element}, row {row}")

    def test_multifrontal_factorization_agrees_with_the_band(self):
        self.compare_with_the_band("multifrontal")

    @unittest.skipUnless(HAS_SUITESPARSE, "this build has no SuiteSparse")
    def test_sparse_factorization_agrees_with_the_band(self):
        self.compare_with_the_band("sparse")

    def compare_with_the_band(self, factorization):
        """Checks that a factorization gives the forces and statuses of the band."""
        for element in ("quad4", "tri3"):
            band = self.solve_rows(element=element, solver="factorization = 'band'")
            other = self.solve_rows(element=element, solver=f"factorization = '{factorization}'")
            for row, result in band.items():
                # Rounding of two orders of elimination, 1e-16 times a condition number of about 1e4.
                self.assert_forces(result, other[row], 1e-10)
                self.assertEqual(result["status"], other[row]["status"])


class GivenBound(LongBarTest):
    """Tresca friction: one convex program, whose energies from both sides meet."""

    DECK = """\
&mesh size = 4.0, 2.0  cells = 16, 8 /
&material young = 100.0  poisson = 0.25 /
&support set = 'left'  ux = 0.0  uy = 0.0 /
&load set = 'top'  pressure = 1.0 /
&load set = 'right'  traction = -2.0, 0.5 /
&contact set = 'bottom'  slip_bound = 0.5 /
&solver {} /
"""

    def test_methods_agree_and_close_the_duality_gap(self):
        expected = self.solve(self.DECK.format(""))
        self.assertEqual(set(expected["status"]), {"open", "stick", "slip-"})
        for method in METHODS:
            result = self.solve(self.DECK.format(method))
            self.assert_forces(result, expected, TOLERANCE, message=method)
            # Forces and displacements are right to about 1e-9, and the gap is a sum of their products.
            self.assertLess(result.summary["certificate"]["duality_gap"], 1e-9, method)

    def test_active_sets_and_products_solve_it_in_one_go(self):
        for box in ("newton", "mprgp"):
            result = self.solve(self.DECK.format(f"method = 'fixed_point'  box = '{box}'"))
            self.assertEqual(result.summary["iterations"], 1, box)

    def test_coulomb_friction_has_no_dual_energy(self):
        self.assertNotIn("duality_gap", self.solve_rows(rows=[1])[1].summary["certificate"])


class InexactVariants(LongBarTest):
    """The splitting as printed and with clipped normal forces: wrong answers are measured and marked."""

    def assert_wrong(self, result, exact, least, message):
        """Checks that a result is marked as wrong, by how much it is."""
        largest = max(map(abs, exact.forces))
        error = max(abs(a - b) for a, b in zip(result.forces, exact.forces))/largest
        self.assertIs(result.summary["converged"], False, message)
        self.assertIs(result.summary["certificate"]["passed"], False, message)
        self.assertGreater(error, least, message)
        self.assertAlmostEqual(result.summary["method_error"], error, delta=TOLERANCE*error, msg=message)

    def test_clipped_variant_is_wrong_where_something_separates(self):
        for element in ("quad4", "tri3"):
            exact = self.solve_rows(element=element)
            results = self.solve_rows(element=element, solver="method = 'splitting'  variant = 'clip'", status=4)
            for row in (1, 2):
                self.assert_wrong(results[row], exact[row], 0.01, f"{element}, row {row}")
            for row in (3, 4, 5):
                self.assert_forces(results[row], exact[row], TOLERANCE)
                self.assertIs(results[row].summary["converged"], True)
                self.assertNotIn("method_error", results[row].summary)

    def test_printed_variant_is_wrong_everywhere(self):
        for element in ("quad4", "tri3"):
            exact = self.solve_rows(element=element)
            results = self.solve_rows(element=element, solver="method = 'splitting'  variant = 'printed'", status=4)
            for row, result in results.items():
                self.assert_wrong(result, exact[row], 0.1, f"{element}, row {row}")

    def test_rows_that_are_right_end_with_status_0(self):
        self.solve_rows(rows=[3, 4, 5], solver="method = 'splitting'  variant = 'clip'")


if __name__ == "__main__":
    unittest.main()
