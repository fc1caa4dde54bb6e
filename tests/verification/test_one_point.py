#!/usr/bin/env python3
r"""One point with three solutions.

With much friction a contact problem may have several solutions. The smallest example is a single point with
$A_{NN} = A_{TT} = 1$, $A_{NT} = 0.8$, $B = (-0.1,\ -0.5)$ and $\mu = 1.5$, as a reduced problem and as one corner of a
triangle. It may be open, stick, or slip backwards. Every method must end in one of the three, and the program has to
find the bound of the friction, 1.25, below which there is one.

By hand: *open*, since $B_N < 0$; *slip* backwards, $\lambda_T = -\mu \lambda_N$, where $(1 - 0.8\mu)\,\lambda_N = B_N$
gives $\lambda = (0.5, -0.75)$ and $u_T = -0.15$; *stick*, where $A \lambda = B$ gives $\lambda = (5/6, -7/6)$, a ratio
of $1.4 < \mu$. Slip needs $1 - 0.8\mu < 0$, and its slip is backwards only for $\mu > 1.4$; stick needs $\mu \ge 1.4$:
with these loads there are three solutions above $\mu = 1.4$ and one below. With any loads there is one below $\mu =
A_{NN}/|A_{NT}| = 1.25$, the bound that the program has to find; from there on it has to warn, although these loads need
more.

The case comes in two forms. As a *reduced problem*, $W$ is $A$ but for the sign of $W_{NT}$, $q = (-B_N, B_T)$,
$r = (\lambda_N, -\lambda_T)$. As a *body* it is one corner of a triangle whose other corners are held: in plane strain
with $\nu = 7/16$ its stiffness is $A^{-1}$.

Every method must end in one of the three; which one is its own affair, and told here. All start from rest. Zero forces
are the open solution, zero displacements the sticking one: methods that work in the forces find the one, methods that
work in the displacements the other.
"""
import csv
import json
import shutil

from benchmark import DECKS, Benchmark, main
from convergence import ValueTable
from harness import words_of

METHODS = words_of("solver", "method")
# What is not zero in each solution, by its status; the tangential force is lambda_T.
SOLUTIONS = {"open": {"gap": 0.1, "slip": -0.5},
             "slip-": {"slip": -0.15, "normal_force": 0.5, "tangential_force": -0.75},
             "stick": {"normal_force": 5/6, "tangential_force": -7/6}}
QUANTITIES = {"gap": "gap", "slip": "slip", "normal_force": r"$\lambda_N$", "tangential_force": r"$\lambda_T$"}
# Each form with its deck.
FORMS = {"reduced": "one_point", "body": "one_point_body"}
WARNING = "not proven (friction"
# Numbers of order one, a condition number of 9.
ROUNDING = 1e-12


class OnePoint(Benchmark):
    """Which solution is found, that all are, and the bound."""

    def solve_point(self, form, *options, **values):
        """Solves a deck with other values; the rows of its table or, with --all-solutions, of that of all solutions."""
        shutil.copy(DECKS/"one_point.dat", self.directory)
        self.run_program(*options, self.write("case.nml", self.deck(FORMS[form], **values)))
        table = "solutions" if options else "contact"
        with open(self.directory/f"case.{table}.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def summary(self):
        """The summary of the last run."""
        return json.loads((self.directory/"case.summary.json").read_text(encoding="utf-8"))

    def listing(self):
        """The listing of the last run."""
        return (self.directory/"case.lst").read_text(encoding="utf-8")

    def add(self, table, form, label, row):
        """Adds what is not zero in a solution to a table, and checks that the rest is."""
        exact = SOLUTIONS[row["status"]]
        for quantity, name in QUANTITIES.items():
            value = float(row[quantity])
            if quantity == "tangential_force" and form == "reduced":
                value = -value
            if quantity in exact:
                table.add(form, label, row["status"], name, computed=value, reference=exact[quantity],
                          allowed=ROUNDING)
            else:
                self.assertAlmostEqual(value, 0.0, delta=ROUNDING)

    def test_every_method_finds_a_solution(self):
        table = ValueTable("Which solution each method finds", ["form", "method", "solution", "quantity"])
        runs = [("reduced", {"method": method}) for method in METHODS]
        runs += [("body", {"method": method}) for method in METHODS]
        runs += [("body", {"method": "psor", "space": "primal"})]
        for form, options in runs:
            row, = self.solve_point(form, **options)
            self.assertIs(self.summary()["certificate"]["passed"], True)
            self.assertIn(WARNING, self.listing())
            self.add(table, form, f"`{' '.join(options.values())}`", row)
        self.assert_table(table)

    def test_all_solutions_are_found(self):
        table = ValueTable("All solutions, by `--all-solutions`", ["form", "number", "solution", "quantity"])
        for form in FORMS:
            rows = self.solve_point(form, "--all-solutions")
            self.assertEqual(sorted(row["status"] for row in rows), sorted(SOLUTIONS))
            for row in rows:
                self.assertEqual(row["isolated"], "yes")
                self.add(table, form, row["solution"], row)
            self.assertRegex(self.listing(), r"\n  Found +3\n")
            self.assertEqual(self.listing().count("; the one reported"), 1)
        self.assert_table(table)

    def test_bound_is_exact(self):
        table = ValueTable("The friction below which the solution is unique, as found from any friction, and the "
                           "number of solutions with these loads", ["form", "friction", "warning", "quantity"])
        for form in FORMS:
            for friction, number in ((0.0, 1), (1.249, 1), (1.251, 1), (1.399, 1), (1.401, 3), (1.5, 3)):
                rows = self.solve_point(form, "--all-solutions", friction=friction)
                uniqueness, listing = self.summary()["uniqueness"], self.listing()
                self.assertIs(uniqueness["exact"], True)
                self.assertIs(uniqueness["guaranteed"], friction < 1.25)
                self.assertIs(WARNING in listing, friction > 1.25)
                self.assertRegex(listing, r"\n  Uniqueness +.*; proven below 1\.25, the exact bound\)\n")
                labels = (form, f"{friction:g}", "yes" if WARNING in listing else "no")
                # Fifty halvings.
                table.add(*labels, "bound", computed=uniqueness["friction_below"], reference=1.25, allowed=ROUNDING)
                table.add(*labels, "solutions", computed=len(rows), reference=number, allowed=ROUNDING)
        self.assert_table(table)


if __name__ == "__main__":
    main()
