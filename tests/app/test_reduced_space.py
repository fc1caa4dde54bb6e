#!/usr/bin/env python3
"""Reduced problems u = W r + q in space: three unknowns of a contact, friction in a disc.

tests/reduced/space holds one problem in every form of Siconos' text files; its W is not symmetric.
"""
import csv
import json
import math
import random
import shutil
import unittest
from pathlib import Path

from harness import PROGRAM, ProgramTest

SAMPLES = Path(__file__).resolve().parents[1] / "reduced/space"
FORMS = ("dense", "blocks", "columns", "triplets")
COLUMNS = ["point", "gap", "slip_1", "slip_2", "normal_force", "tangential_force_1", "tangential_force_2",
           "direction_1", "direction_2", "status"]
# Room for addresses, in KiB: W as a dense matrix would take 650 MB.
MEMORY = 500000
# Ten times the tolerance of the methods, 1e-10; numbers are of order one.
LAW = 1e-9


def product(a, b):
    """The product of two matrices, each a list of rows."""
    return [[sum(map(float.__mul__, row, column)) for column in zip(*b)] for row in a]


def transposed(a):
    """The transpose of a matrix."""
    return [list(column) for column in zip(*a)]


def text_of(w, q, mu):
    """The text of a problem, W dense."""
    n = len(q)
    lines = [f"3 {len(mu)} 0 {n} {n} {n} {n}"]
    return "\n".join(lines + [" ".join(map(repr, numbers)) for numbers in [*transposed(w), q, mu]]) + "\n"


def random_problem(m, seed):
    """W, q and mu of m contacts without visible order, two in three of them pressed."""
    numbers = random.Random(seed)
    n = 3*m
    b = [[numbers.uniform(-1, 1) for _ in range(n)] for _ in range(n)]
    w = product(b, transposed(b))
    w = [[value/n + (i == j)*0.5 for j, value in enumerate(row)] for i, row in enumerate(w)]
    q = [numbers.uniform(-1, 1) - 0.3*(i % 3 == 0) for i in range(n)]
    return w, q, [numbers.uniform(0.1, 0.5) for _ in range(m)]


def turned(w, q, angles):
    """W and q in other tangents of the contacts."""
    n = len(q)
    turn = [[float(i == j) for j in range(n)] for i in range(n)]
    for k, angle in enumerate(angles):
        c, s = math.cos(angle), math.sin(angle)
        for i, row in ((1, (c, s)), (2, (-s, c))):
            turn[3*k + i][3*k + 1:3*k + 3] = row
    return product(product(turn, w), transposed(turn)), [row[0] for row in product(turn, [[value] for value in q])]


def tower(n_bricks, seed):
    """The problem of a tower of bricks, four contacts below each, that move at random: more forces than motions."""
    numbers = random.Random(seed)
    rows, mu = [], []
    for brick in range(n_bricks):
        shift = numbers.uniform(-0.3, 0.3)*(brick > 0)
        for x, y in ((-1, -0.5), (-1, 0.5), (1, -0.5), (1, 0.5)):
            for axis in ((0, 0, 1), (1, 0, 0), (0, 1, 0)):
                row = [0.0]*(6*n_bricks)
                for body, sign in ((brick, 1), (brick - 1, -1)):
                    if body < 0:
                        continue
                    arm = x + shift, y, -0.5*sign
                    turn = (arm[1]*axis[2] - arm[2]*axis[1], arm[2]*axis[0] - arm[0]*axis[2],
                            arm[0]*axis[1] - arm[1]*axis[0])
                    row[6*body:6*body + 6] = [float(sign*part) for part in (*axis, *turn)]
                rows.append(row)
            mu.append(numbers.choice([0.2, 0.6]))
    velocity = [numbers.gauss(0, 0.2) - (k % 6 == 2) for k in range(6*n_bricks)]
    return product(rows, transposed(rows)), [sum(map(float.__mul__, row, velocity)) for row in rows], mu


class SpaceTest(ProgramTest):
    """Reads what a reduced problem in space leaves."""

    def table(self, name, directory="."):
        """The rows of the contact table, numbers as numbers."""
        with open(self.directory / directory / f"{name}.contact.csv", newline="", encoding="utf-8") as table:
            header, *rows = csv.reader(table)
        self.assertEqual(header, COLUMNS)
        return [(int(row[0]), *map(float, row[1:-1]), row[-1]) for row in rows]

    def summary(self, name):
        """The summary."""
        return json.loads((self.directory / f"{name}.summary.json").read_text(encoding="utf-8"))

    def check_law(self, w, q, mu, rows, tolerance=LAW):
        """Checks every condition of the problem in its own words."""
        r = [force for row in rows for force in row[4:7]]
        u = [sum(a*b for a, b in zip(line, r)) + free for line, free in zip(w, q)]
        self.assert_close([number for row in rows for number in row[1:4]], u, 1e-13)
        for (_, gap, *slip, normal, force_1, force_2, direction_1, direction_2, status), friction in zip(rows, mu):
            length, force = math.hypot(*slip), math.hypot(force_1, force_2)
            self.assertGreaterEqual(min(gap, normal), -tolerance)
            self.assertLessEqual(min(gap, normal), tolerance)
            self.assertLessEqual(force, friction*normal + tolerance)
            # r_T |u_T| = -mu r_N u_T
            self.assert_close([force_1*length, force_2*length], [-friction*normal*s for s in slip], tolerance)
            direction = [s/length for s in slip] if status == "slip" else [0.0, 0.0]
            self.assert_close([direction_1, direction_2], direction, 1e-15)
            if status == "open":
                self.assertLessEqual(normal, tolerance)
            else:
                self.assertLessEqual(gap, tolerance)
                self.assertTrue(status == "slip" or length <= tolerance, status)


class Problems(SpaceTest):
    """Solutions of sound problems."""

    def test_every_storage_gives_the_same_solution(self):
        for name in FORMS:
            shutil.copy(SAMPLES / f"{name}.dat", self.directory)
        self.run_program("--reduced", *(f"{name}.dat" for name in FORMS))
        tables = [self.table(name) for name in FORMS]
        self.assertEqual({row[-1] for row in tables[0]}, {"open", "stick", "slip"})
        self.assertTrue(all(table == tables[0] for table in tables))
        words = (SAMPLES / "dense.dat").read_text(encoding="utf-8").split()
        numbers = [float(word) for word in words[7:]]
        w = transposed([numbers[9*j:9*j + 9] for j in range(9)])
        self.assertNotEqual(w, transposed(w))
        self.check_law(w, numbers[81:90], numbers[90:93], tables[0])
        problem = self.summary("dense")["problem"]
        self.assertEqual((problem["dimension"], problem["asymmetry"]), (3, 0.0625))
        listing = (self.directory / "dense.lst").read_text(encoding="utf-8")
        self.assertRegex(listing, r"\n  Contacts +3 in space\n")
        self.assertRegex(listing, r"\n  Contacts +1 open, 1 slip, 1 stick\n")
        self.assertEqual(self.run_program("--verify", ".").stdout.count(": verified\n"), 4)

    def test_ball_between_walls_that_approach_each_other(self):
        # Of unit mass, inertia 0.4 and radius 1, between walls whose normals are x and -x; the first wall moves in.
        sides = [[[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, -1], [0, 0, 1, 0, 1, 0]],
                 [[-1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 1], [0, 0, 1, 0, -1, 0]]]
        free = [0.3, -0.2, 0.1, 0.5, 0.4, -0.6]
        for unknowns in (3, 2):
            rows = [row for side in sides for row in side[:unknowns]]
            w = [[sum(a*b/(1.0 if k < 3 else 0.4) for k, (a, b) in enumerate(zip(one, other))) for other in rows]
                 for one in rows]
            q = [float(sum(map(float.__mul__, map(float, row), free))) for row in rows]
            for unit, inwards, status in ((1.0, 0.1, 2), (1e-6, 1e-3, 2), (1.0, 0.0, 0), (1.0, -0.1, 0)):
                text = text_of(w, [unit*(value - inwards*(i == 0)) for i, value in enumerate(q)], [0.3, 0.0])
                self.write("ball.dat", str(unknowns) + text[1:])
                run = self.run_program("--reduced", "ball.dat", status=status)
                self.assertEqual("no motion keeps the contacts apart" in run.stderr, status == 2, run.stderr)

    def test_methods_fulfill_the_law(self):
        for seed in range(12):
            w, q, mu = random_problem(2 + seed % 5, seed)
            self.write("case.dat", text_of(w, q, mu))
            for method in ("auto", "newton", "splitting", "fixed_point", "psor", "extragradient"):
                with self.subTest(method=method, seed=seed):
                    self.run_program(self.write("case.nml", "&problem kind = 'reduced'  file = 'case.dat' /\n"
                                                f"&solver method = '{method}'  max_iterations = 100000 /\n"))
                    self.check_law(w, q, mu, self.table("case"))

    def test_points_that_hardly_slide_converge_quadratically(self):
        for n_bricks, seed in ((2, 109), (3, 34), (4, 68)):
            w, q, mu = tower(n_bricks, seed)
            self.write("case.dat", text_of(w, q, mu))
            self.run_program("--reduced", "case.dat")
            self.check_law(w, q, mu, self.table("case"))
            summary = json.loads((self.directory/"case.summary.json").read_text(encoding="utf-8"))
            self.assertLess(summary["iterations"], 60)

    def test_turned_tangents_change_no_number(self):
        # Contacts have scales of their own: in the first and the last problem the first residual within the tolerance
        # leaves errors of up to 1.5e-9.
        for seed in range(0, 64, 8):
            w, q, mu = random_problem(6, 100 + seed)
            scale = [10.0**random.Random(1000*seed + i//3).uniform(-3, 3) for i in range(len(q))]
            w = [[value*(a*b) for value, b in zip(row, scale, strict=True)] for row, a in zip(w, scale, strict=True)]
            q = [value*a for value, a in zip(q, scale, strict=True)]
            angles = [random.Random(seed + k).uniform(0, 6) for k in range(len(mu))]
            self.write("plain.dat", text_of(w, q, mu))
            self.write("turned.dat", text_of(*turned(w, q, angles), mu))
            self.run_program("--reduced", "plain.dat", "turned.dat")
            plain = self.table("plain")
            length, force = (max(abs(row[i]) for row in plain for i in columns) for columns in ((1, 2, 3), (4, 5, 6)))
            size = [length]*3 + [force]*3 + [1.0]*2
            for one, other, angle in zip(plain, self.table("turned"), angles, strict=True):
                self.assertEqual(one[-1], other[-1])
                c, s = math.cos(angle), math.sin(angle)
                back = [other[1], c*other[2] - s*other[3], s*other[2] + c*other[3], other[4],
                        c*other[5] - s*other[6], s*other[5] + c*other[6], c*other[7] - s*other[8],
                        s*other[7] + c*other[8]]
                self.assert_close([value/one_of for value, one_of in zip(one[1:9], size)],
                                  [value/one_of for value, one_of in zip(back, size)], 1e-12)

    def test_file_is_written_the_same_again(self):
        shutil.copy(SAMPLES / "columns.dat", self.directory / "case.dat")
        self.run_program("--write-reduced", "--reduced", "case.dat")
        first = self.contents()["case.reduced.dat"]
        self.assertTrue(first.startswith(b"3\n3\n0\n9\n9\n"))
        self.run_program("--write-reduced", "--reduced", "case.reduced.dat")
        self.assertEqual(self.contents()["case.reduced.reduced.dat"], first)
        self.assertEqual(self.table("case.reduced"), self.table("case"))

    def test_problem_without_contacts(self):
        self.write("none.dat", "3\n0\n0\n0\n0\n0 0\n")
        self.run_program("--reduced", "none.dat")
        self.assertEqual(self.table("none"), [])
        self.run_program("--verify", ".")

    def test_many_contacts_in_a_row_stay_sparse(self):
        m = 3000
        lines = ["3", str(m), "2", str(3*m), str(3*m), "1", "CSparse Version 3.1.9, May 4, 2016."]
        entries = [(i, i, 2.0) for i in range(3*m)]
        entries += [pair for i in range(3*m - 3) for pair in ((i, i + 3, -0.7), (i + 3, i, -0.7))]
        lines.append(f"triplet: {3*m}-by-{3*m}, nzmax: {len(entries)} nnz: {len(entries)}")
        lines += [f"    {i} {j} : {value}" for i, j, value in entries]
        numbers = random.Random(1)
        lines += [str(numbers.uniform(-1, 0.5)) for _ in range(3*m)] + ["0.3"]*m
        self.write("row.dat", "\n".join(lines) + "\n")
        run = self.run_command(["bash", "-c", f"ulimit -v {MEMORY}; exec {PROGRAM} --reduced row.dat"])
        self.assertIn("row: solved", run.stdout)
        self.assertIn("used as sparse", (self.directory / "row.lst").read_text(encoding="utf-8"))


class Refusals(SpaceTest):
    """What is for the plane, and what is no problem."""

    def refuse(self, options, sentence, *arguments):
        """Checks that a solver is refused with a sentence and leaves nothing."""
        shutil.copy(SAMPLES / "dense.dat", self.directory)
        deck = self.write("case.nml", f"&problem kind = 'reduced'  file = 'dense.dat' /\n&solver {options} /\n")
        run = self.run_program("--output", "results", *arguments, deck, status=1)
        self.assertEqual(run.stderr, f"case.nml: {sentence}\n")
        self.assertEqual(self.files(), ["case.nml", "dense.dat"])

    def test_what_is_for_the_plane(self):
        self.refuse("method = 'lemke'", "the method lemke is for the plane: friction in space is no linear "
                    "complementarity problem")
        for variant in ("clip", "printed"):
            self.refuse(f"method = 'splitting'  variant = '{variant}'", f"variant = '{variant}' is for the plane: the "
                        "paper prints its algorithm for one tangential direction; take 'exact'")
        self.refuse("method = 'fixed_point'  box = 'mprgp'", "box = 'mprgp' is for the plane: it solves programs on "
                    "intervals, not on discs; take 'newton'")
        self.refuse("method = 'auto'", "all solutions can be found in the plane only: friction in space is no linear "
                    "complementarity problem", "--all-solutions")

    def test_w_that_is_far_from_its_transpose(self):
        w, q, mu = random_problem(1, 1)
        scale = math.sqrt(w[0][0]*w[1][1])
        for share, status in ((0.049, 0), (0.051, 1)):
            w[0][1] = w[1][0] + share*scale
            run = self.run_program("--reduced", self.write("case.dat", text_of(w, q, mu)), status=status)
        self.assertRegex(run.stderr, r"^case\.dat:\d+: W\(.* differ by more than rounding: expected a symmetric W\n$")

    def test_forged_tables_are_found(self):
        shutil.copy(SAMPLES / "dense.dat", self.directory)
        self.run_program("--reduced", "--output", "results", "dense.dat")
        path = self.directory / "results/dense.contact.csv"
        text = path.read_text(encoding="utf-8")
        lines = text.splitlines()
        slipping = next(k for k, line in enumerate(lines) if line.endswith(",slip"))
        for column in range(1, 9):
            row = lines[slipping].split(",")
            row[column] = repr(float(row[column]) + 1e-3)
            path.write_text("\n".join([*lines[:slipping], ",".join(row), *lines[slipping + 1:]]) + "\n",
                            encoding="utf-8")
            self.run_program("--verify", "results", status=4)
        for word in ("stick", "slip+", "open"):
            path.write_text(text.replace(",slip\n", f",{word}\n"), encoding="utf-8")
            self.run_program("--verify", "results", status=4)
        path.write_text(text, encoding="utf-8")
        self.run_program("--verify", "results")


if __name__ == "__main__":
    unittest.main()
