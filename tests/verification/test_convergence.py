#!/usr/bin/env python3
"""The tools of the benchmarks: tables that tell faults, shape functions of the error norm."""
import unittest

from convergence import ConvergenceTable, RoundoffTable, Table, ValueTable, digest, observed_order
from field_error import ELEMENT_OF_VTK, biquadratic, bilinear, reference_points, serendipity, triangle

NAN = float("nan")


class Tables(unittest.TestCase):
    """What a table prints and which rows it faults."""

    def test_order_is_the_exponent(self):
        self.assertAlmostEqual(observed_order((0.5, 8*0.5**3), (0.25, 8*0.25**3)), 3.0)

    def test_low_order_of_the_finest_pair_is_a_fault(self):
        for errors, is_right in (((8.0, 5.0, 1.0), True), ((8.0, 1.0, 0.5), False), ((8.0, 2.0, NAN), False)):
            table = ConvergenceTable("Caption", ["quantity"], {"quad4": (2,)})
            for step, error in enumerate(errors):
                table.add("quad4", 0.5**step, error)
            table.close()
            self.assertEqual(len(table.rows), 3)
            self.assertEqual(not table.faults, is_right)
            self.assertEqual("FAILED" not in table.markdown(), is_right)

    def test_deviation_beyond_what_is_allowed_is_a_fault(self):
        for computed, allowed, is_right in ((1.004, 0.005, True), (1.006, 0.005, False), (0.99, 0.005, False),
                                            (1.0 + 1e-9, 1e-8, True), (1.0 + 1e-7, 1e-8, False), (NAN, 0.1, False)):
            table = ValueTable("Caption", ["case"])
            table.add("one", computed=computed, reference=1.0, allowed=allowed)
            self.assertEqual(not table.faults, is_right, computed)
            self.assertEqual("FAILED" not in table.markdown(), is_right, computed)

    def test_error_beyond_rounding_is_a_fault(self):
        for error, is_right in ((1e-12, True), (1e-10, False), (NAN, False)):
            table = RoundoffTable("Caption", ["case"], ["quantity"], 1e-11)
            table.add("one", errors=[error])
            self.assertEqual(not table.faults, is_right)

    def test_table_is_markdown(self):
        table = RoundoffTable("Caption", ["case"], ["quantity"], 1e-11)
        table.add("one", errors=[0.0])
        self.assertEqual(table.markdown(), "Caption\n\n| case | error of quantity |\n| --- | --- |\n| one | < 1e-11 |")

    def test_digest_keeps_the_largest_error_of_equal_theory_on_the_finest_mesh(self):
        tables = []
        for caption, factor in (("Small", 1.0), ("Large", 10.0)):
            tables.append(ConvergenceTable(caption, ["quantity"], {"tri3": (2,), "quad4": (2,), "quad8": (3,)}))
            for kind, scale, ratio in (("tri3", 1.0, 4.0), ("quad4", 2.0, 4.0), ("quad8", 0.1, 8.0)):
                for h, error in ((0.5, factor*scale), (0.25, factor*scale/ratio)):
                    tables[-1].add(kind, h, error)
            tables[-1].close()
        self.assertEqual([" ".join(item.split()) for item in digest(tables)[0].split("* ")[1:]], [
            "Large, quad4, h 0.25: error of quantity 5.000e+00 of order 2.00 (theory 2). "
            "The largest error of quantity of 4 studies.",
            "Large, quad8, h 0.25: error of quantity 1.250e-01 of order 3.00 (theory 3). "
            "The largest error of quantity of 2 studies."])

    def test_digest_of_convergence_hides_no_fault(self):
        table = ConvergenceTable("Caption", ["quantity"], {"quad4": (2,)})
        for h, error in ((0.5, 1.0), (0.25, 0.5)):
            table.add("quad4", h, error)
        table.close()
        self.assertIn("FAILED", digest([table])[0])

    def test_digest_keeps_the_last_rows_of_a_long_table(self):
        table = Table("Caption", ["case", "number"])
        table.rows = [[case, number] for case in ("a", "b") for number in range(6)]
        self.assertEqual(digest([table]), ["Caption: the last rows of 12\n\n| case | number |\n| --- | --- |\n"
                                           "| a | 4 |\n| a | 5 |\n| b | 4 |\n| b | 5 |"])

    def test_digest_keeps_the_value_nearest_to_its_limit(self):
        table = ValueTable("Caption", ["case", "number"])
        for number in range(4):
            table.add("loose", number, computed=1.0 + 0.01*number, reference=1.0, allowed=1.0)
            table.add("tight", number, computed=1.0 - 0.001*number, reference=1.0, allowed=0.01)
        self.assertEqual(table.digest(), "Caption, tight, number 3: 0.997 for 1, -0.30% where 1.00% is allowed. "
                                         "The nearest to its limit of 8 rows.")
        table.add("tight", 4, computed=0.9, reference=1.0, allowed=0.01)
        self.assertIn("FAILED", table.digest())

    def test_digest_of_exact_values_is_a_sentence(self):
        table = ValueTable("Caption", ["case"])
        for case in range(7):
            table.add(case, computed=1.0, reference=1.0, allowed=1e-9)
        self.assertEqual(table.digest(),
                         "Caption: within 1e-09 of the references in all 7 rows. Rows: case 0, 1, 2, 3, 4, 5, 6.")

    def test_digest_of_rounding_errors_hides_no_fault(self):
        table = RoundoffTable("Caption", ["case"], ["quantity"], 1e-11)
        table.add("one", errors=[0.0])
        self.assertEqual(digest([table]),
                         ["* Caption: the errors of quantity are below 1e-11 in all 1 rows. Rows: case one."])
        table.add("two", errors=[1.0])
        self.assertIn("FAILED", table.digest())


class ShapeFunctions(unittest.TestCase):
    """The functions that the error norm interpolates with."""

    def test_functions_are_one_at_their_node_and_zero_at_the_others(self):
        square = [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0)]
        corner = [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)]
        for functions, nodes in ((bilinear, square[:4]), (serendipity, square[:8]), (biquadratic, square),
                                 (lambda r, s: triangle(r, s, 1), corner[:3]),
                                 (lambda r, s: triangle(r, s, 2), corner)):
            for node, (r, s) in enumerate(nodes):
                values = [value for value, _, _ in functions(r, s)]
                self.assertEqual(values, [float(other == node) for other in range(len(nodes))])

    def test_derivatives_are_central_differences(self):
        # The functions are quadratic along either axis at the most.
        for functions in (bilinear, serendipity, biquadratic, lambda r, s: triangle(r, s, 2)):
            r, s = 0.3, -0.2
            for (_, by_r, by_s), *ends in zip(functions(r, s), functions(r + 0.5, s), functions(r - 0.5, s),
                                              functions(r, s + 0.5), functions(r, s - 0.5)):
                self.assertAlmostEqual(ends[0][0] - ends[1][0], by_r)
                self.assertAlmostEqual(ends[2][0] - ends[3][0], by_s)

    def test_weights_sum_to_the_area(self):
        for element in ELEMENT_OF_VTK.values():
            self.assertAlmostEqual(sum(row[0] for row in reference_points(element)),
                                   0.5 if element.startswith("tri") else 4.0)


if __name__ == "__main__":
    unittest.main()
