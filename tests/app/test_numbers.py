#!/usr/bin/env python3
"""Numbers at their limits: near-singular bodies and numbers out of range are solved with a certificate, or refused with
the reason; results have the same bits in every run."""
import math
import re
import shutil
import unittest

from harness import CONTACT, HAS_SUITESPARSE, PRESSURE, PROGRAM, SUPPORT, ProgramTest, block, read_vtu

SINGULAR = re.compile(r"^case\.nml: the stiffness is singular to rounding at the node \S+, [^\s;]+(; .+)?\n$")
UNCERTAIN = re.compile(r"^case\.nml: the certificate FAILED: largest violation \S+, limit \S+; see the listing; the "
                       r"condition number of the stiffness is about \de\d+\n$")
NOT_FINITE = re.compile(r"\b(nan|inf|infinity|null)\b|\*\*", re.IGNORECASE)


class NumbersTest(ProgramTest):
    """Runs a deck that may be refused for its numbers."""

    def attempt(self, text):
        """Runs a deck and returns its exit status and what was printed on standard error."""
        self.write("case.nml", text)
        shutil.rmtree(self.directory / "results", ignore_errors=True)
        run = self.run_command([PROGRAM, "--quiet", "--output", "results", "case.nml"], None)
        return run.returncode, run.stderr

    def is_solved(self, text):
        """Whether a deck is solved with a true certificate. Otherwise it must be refused, or marked, with an estimate
        of the condition number."""
        status, message = self.attempt(text)
        if status == 2:
            self.assertRegex(message, SINGULAR)
            self.assertFalse((self.directory / "results").exists())
            return False
        summary = self.result("case", "results").summary
        self.assertIs(summary["certificate"]["passed"] and summary["converged"], status == 0, text)
        if status == 4:
            self.assertIn("  Warning             the stiffness is ill-conditioned, condition number about ",
                          (self.directory / "results/case.lst").read_text())
            self.assertGreater(summary["condition"], 1e8)
            if summary["converged"]:
                self.assertRegex(message, UNCERTAIN)
        return status == 0


class NearSingular(NumbersTest):
    """Bodies whose stiffness has few digits."""

    def test_slivers(self):
        for groups, limit in (((SUPPORT, PRESSURE, CONTACT), 1e4), ((PRESSURE, CONTACT), 1e4),
                              (("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE, CONTACT), 1e4)):
            for height in (1e1, 1e3, 1e4, 1e5, 1e6, 1e8, 1e12):
                is_solved = self.is_solved(block(*groups, mesh=f"size = 1.0, {height}  cells = 8, 4"))
                if height < limit:
                    self.assertTrue(is_solved, f"{groups} {height}")

    def test_flat_bodies_on_their_obstacle(self):
        # What is short across the line of contact is stiff, not soft: no digit is lost.
        for width in (1e3, 1e6, 1e12):
            mesh = f"size = {width}, 1.0  cells = 8, 4"
            self.assertTrue(self.is_solved(block(SUPPORT, PRESSURE, CONTACT, mesh=mesh)))

    def test_rows_of_cells_far_thinner_than_others(self):
        for grading in (1e6, 1e-6, 1e9, 1e-9, 1e12, 1e-12):
            is_solved = self.is_solved(block(SUPPORT, PRESSURE, CONTACT,
                                             mesh=f"size = 4.0, 2.0  cells = 8, 4  grading = {grading}"))
            self.assertTrue(is_solved or not 1e-6 <= grading <= 1e6, grading)

    def test_all_but_incompressible(self):
        for element in ("quad4", "quad8", "tri3", "tri6"):
            for poisson in (0.4999, 0.499999, 0.4999999999, 0.49999999999999, 0.4999999999999999):
                is_solved = self.is_solved(block(
                    SUPPORT, PRESSURE, CONTACT, mesh=f"size = 4.0, 2.0  cells = 8, 4  element = '{element}'",
                    material=f"young = 100.0  poisson = {poisson}"))
                self.assertTrue(is_solved or poisson > 0.4999999, f"{element} {poisson}")

    def test_hardly_held(self):
        for spring in (1.0, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-300):
            is_solved = self.is_solved(block(f"support set = 'left'  spring_n = {spring}  spring_t = {spring}",
                                             "load set = 'right'  traction = 1.0, 0.5"))
            self.assertTrue(is_solved or spring < 1e-3, spring)

    def test_springs_that_only_help_may_be_as_soft_as_they_like(self):
        for spring in (1e-6, 1e-15, 1e-300):
            self.assertTrue(self.is_solved(block(f"support set = 'left'  spring_n = {spring}", PRESSURE, CONTACT)))

    def test_reason_is_named(self):
        for text, reason in (
                (block(SUPPORT, PRESSURE, CONTACT, mesh="size = 1.0, 1e8  cells = 8, 4"),
                 "; element 1 is 2e8 times as long as wide"),
                (block(SUPPORT, PRESSURE, CONTACT, material="young = 1.0  poisson = 0.4999999999999999",
                       mesh="size = 4.0, 2.0  cells = 8, 4  element = 'tri3'"),
                 "; Poisson's ratio of 0.4999999999999999 makes a material nearly incompressible"),
                (block("support set = 'left'  spring_n = 1e-15  spring_t = 1e-15", PRESSURE),
                 "; the stiffness of springs and that of the body differ by a factor of ")):
            status, message = self.attempt(text)
            self.assertEqual(status, 2)
            self.assertIn(reason, message)

    def test_materials_twelve_powers_of_ten_apart(self):
        # Two halves, one upon the other.
        self.write("halves.inp", halves(8, 8))
        forces = []
        for ratio in ("1e6", "1e9", "1e12"):
            for hard, soft in (("upper", "lower"), ("lower", "upper")):
                is_solved = self.is_solved(block(
                    f"material region = '{hard}'  young = 100{ratio[1:]}  poisson = 0.3",
                    "support set = 'top'  ux = 0.0  uy = -1e-3", CONTACT, mesh="kind = 'file'  file = 'halves.inp'",
                    material=f"region = '{soft}'  young = 100.0  poisson = 0.3"))
                # Moved as a whole, the stiff half loses as many digits as it is stiffer.
                self.assertTrue(is_solved or (hard == "upper" and ratio != "1e6"), f"{ratio} {hard}")
            forces.append(self.result("case", "results").forces)
        # The stiff half bends by 1e-9 of the soft one's displacements at the most.
        self.assert_close(forces[1], forces[2], 1e-7*max(map(abs, forces[1])))


def halves(n_columns, n_rows):
    """An Abaqus file of a square: the lower half is the set lower, the upper one upper; sides are bottom and top."""
    lines = ["*NODE"]
    for j in range(n_rows + 1):
        for i in range(n_columns + 1):
            lines.append(f"{1 + i + j*(n_columns + 1)}, {i/n_columns}, {j/n_rows}")
    for name, rows in (("lower", range(n_rows//2)), ("upper", range(n_rows//2, n_rows))):
        lines.append(f"*ELEMENT, TYPE=CPE4, ELSET={name}")
        for j in rows:
            for i in range(n_columns):
                first = 1 + i + j*(n_columns + 1)
                lines.append(f"{1 + i + j*n_columns}, {first}, {first + 1}, {first + n_columns + 2}, "
                             f"{first + n_columns + 1}")
    for name, side, row in (("bottom", "S1", 0), ("top", "S3", n_rows - 1)):
        lines.append(f"*SURFACE, NAME={name}")
        lines += [f"{1 + i + row*n_columns}, {side}" for i in range(n_columns)]
    return "\n".join(lines) + "\n"


class Range(NumbersTest):
    """Numbers near the largest and the smallest: no file has one that is not finite."""

    def assert_finite(self):
        """Checks every number in every file of the case."""
        for name, content in self.contents("results").items():
            if name.endswith(".vtu"):
                for array, values in read_vtu(content)[0].items():
                    flat = [x for value in values for x in (value if isinstance(value, tuple) else (value,))]
                    self.assertTrue(all(map(math.isfinite, flat)), f"{name} {array}")
            else:
                text = content.decode("utf-8").replace('"friction_below": null', "")
                self.assertIsNone(NOT_FINITE.search(text), name)

    def assert_solved_or_refused(self, text):
        """A deck is solved, with numbers that are all finite, or refused for its range; returns whether it is."""
        status, message = self.attempt(text)
        if status in (1, 2):
            self.assertFalse(list((self.directory / "results").glob("*")), text)
            self.assertRegex(message, "range of double precision|floating-point overflow|too little for its areas|"
                             "singular to rounding")
            self.assertEqual(message.count("\n"), 1)
            return False
        self.assert_finite()
        if status != 0:
            self.assertIn("certificate FAILED", message)
        return status == 0

    def test_every_quantity_far_from_one(self):
        forms = {
            "length": lambda x: block(SUPPORT, PRESSURE, CONTACT, mesh=f"size = 4{x}, 2{x}  cells = 8, 4"),
            "young": lambda x: block(SUPPORT, PRESSURE, CONTACT, material=f"young = 1{x}  poisson = 0.25"),
            "thickness": lambda x: block(SUPPORT, PRESSURE, CONTACT,
                                         material=f"young = 100.0  poisson = 0.25  thickness = 1{x}"),
            "load": lambda x: block(SUPPORT, CONTACT, f"load set = 'top'  pressure = 1{x}"),
            "young and load": lambda x: block(SUPPORT, CONTACT, f"load set = 'top'  pressure = 1{x}",
                                              material=f"young = 1{x}  poisson = 0.25"),
            "body force": lambda x: block(SUPPORT, CONTACT, f"load body_force = 0.0, -1{x}"),
            "friction": lambda x: block(SUPPORT, PRESSURE, f"contact set = 'bottom'  friction = 1{x}"),
            "slip bound": lambda x: block(SUPPORT, PRESSURE, f"contact set = 'bottom'  slip_bound = 1{x}"),
            "displacement": lambda x: block(f"support set = 'left'  ux = 1{x}", PRESSURE, CONTACT),
            "spring": lambda x: block(f"support set = 'left'  spring_n = 1{x}", PRESSURE, CONTACT)}
        for name, form in forms.items():
            for exponent in (-300, -200, -150, -12, 12, 150, 200, 300):
                with self.subTest(quantity=name, exponent=exponent):
                    is_solved = self.assert_solved_or_refused(form(f"e{exponent}"))
                    if abs(exponent) == 12 and name not in ("displacement", "spring"):
                        self.assertTrue(is_solved)

    def test_every_method_far_from_one(self):
        for method in ("newton", "splitting", "fixed_point", "psor"):
            for material, load in (("1e-310", "1.0"), ("1e306", "1.0"), ("100.0", "1e-310"), ("100.0", "1e306")):
                with self.subTest(method=method, young=material, load=load):
                    self.assert_solved_or_refused(block(
                        SUPPORT, CONTACT, f"load set = 'top'  pressure = {load}", f"solver method = '{method}'",
                        material=f"young = {material}  poisson = 0.25"))

    def test_obstacle_beyond_all_numbers(self):
        for distance in ("1e100", "1e200", "1e300"):
            self.assert_solved_or_refused(block(
                "support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE,
                f"contact set = 'bottom'  obstacle = 'plane'  point = 0.0, -{distance}  normal = 0.0, 1.0"))


class IllPosed(NumbersTest):
    """Contact problems that make no sense, as they are made by mistake: one sentence each, and no numbers."""

    def refuse(self, status, message, *groups):
        text = block(*groups)
        self.assertEqual(self.attempt(text), (status, f"case.nml:{message}\n"), text)
        self.assertEqual([name for name in self.files() if name.endswith((".vtu", ".csv"))], [])

    def test_nothing_holds_the_body(self):
        nothing = " no equilibrium: nothing balances the loads; the body is free to "
        advice = "; add a support or a contact set"
        self.refuse(2, nothing + "translate along (0.0, -1.0)" + advice, PRESSURE)
        self.refuse(2, nothing + "translate along (0.4472, -0.8944) and rotate clockwise" + advice, PRESSURE,
                    "support point = 0.0, 0.0  ux = 0.0  uy = 0.0")

    def test_obstacle_that_cannot_hold_the_body(self):
        free, advice = " no equilibrium: contact and friction cannot balance the loads; the body is free to ", \
            "; add a support, or a load that presses the body on its obstacle"
        self.refuse(2, free + "translate along (0.0, 1.0)" + advice, SUPPORT, CONTACT,
                    "load set = 'top'  traction = 0.0, 1.0")
        self.refuse(2, free + "translate along (1.0, 0.3)" + advice, PRESSURE, CONTACT,
                    "load set = 'left'  traction = 2.0, 0.0")
        self.refuse(2, free + "translate along (-0.4472, 0.8944) and rotate counter-clockwise" + advice, CONTACT,
                    "support point = 0.0, 0.0  ux = 0.0  uy = 0.0", "load set = 'right'  traction = 0.0, 1.0")

    def test_supports_that_contradict_each_other(self):
        self.refuse(1, "4: the support contradicts an earlier one at the node 0.0, 2.0", SUPPORT,
                    "support set = 'left'  ux = 1.0", PRESSURE, CONTACT)
        self.refuse(1, "4: the support contradicts an earlier one at the node 0.0, 0.0",
                    "support set = 'left'  uy = 0.0", "support set = 'bottom'  uy = 1.0", PRESSURE, CONTACT)

    def test_contact_set_that_supports_hold(self):
        message = "5: supports hold every contact node; nothing is left that could come into contact"
        for held in ("ux = 0.0  uy = 0.0", "uy = 0.0", "uy = 0.1", "un = 0.0"):
            self.refuse(1, message, f"support set = 'bottom'  {held}", PRESSURE, CONTACT)

    def test_obstacle_on_the_wrong_side(self):
        message = "5: the boundary does not face its obstacle; check the place of the obstacle, and that its normal "
        for normal in ("0.0, -1.0", "1.0, 0.0"):
            self.refuse(1, message + "points to the body", SUPPORT, PRESSURE, f"{CONTACT}  normal = {normal}")

    def test_line_that_slides_away_from_one_of_311_points_is_solved(self):
        self.assertEqual(self.attempt(block(
            "load set = 'left'  traction = 8.1061e-4, 0.0", "load set = 'top'  pressure = 9.34368e-3"
            "  pressure_slope = 2.77136e-4, 0.0", "contact set = 'bottom'  friction = 0.1  point = 2.75675, 0.0"
            "  obstacle = 'circle'  radius = -93938.4", mesh="size = 5.51349, 1.83371  cells = 310, 12",
            material="young = 1000.0  poisson = 0.45")), (0, ""))

    def test_friction_that_locks_is_a_solution(self):
        # Held along x at the bottom, or with friction that no load exceeds, every point sticks.
        for groups in ((SUPPORT, PRESSURE, "contact set = 'bottom'  friction = 1e6"),
                       ("support set = 'bottom'  ux = 0.0", PRESSURE, CONTACT)):
            self.assertEqual(self.attempt(block(*groups)), (0, ""))
            self.assertEqual(set(self.result("case", "results")["status"]), {"stick"})

    def test_body_that_nothing_loads_is_at_rest(self):
        for groups in ((SUPPORT, CONTACT), (CONTACT,), ("support set = 'left'  ux = 0.0  uy = 0.0",)):
            self.assertEqual(self.attempt(block(*groups)), (0, ""))
            self.assertEqual(max(map(abs, self.result("case", "results").forces), default=0.0), 0.0)

    def test_body_at_rest_may_stand_off_in_any_units(self):
        # What would close the gaps is far below 1 in these units.
        for unit in (1e-9, 1.0, 1e9):
            for groups in (("support set = 'top'  ux = 0.0  uy = 0.0", f"load set = 'top'  pressure = {unit}"), ()):
                self.assertEqual(self.attempt(block(
                    *groups, CONTACT + "  slip_bound = 1e-9  extra_gap = 1e-3  obstacle = 'circle'  radius = 5.0",
                    material=f"young = {unit}  poisson = 0.25")), (0, ""))
                result = self.result("case", "results")
                self.assertEqual(set(map(abs, result["slip"] + result.forces)), {0.0})
                self.assertEqual(set(result["status"]), {"open"})

    def test_body_that_is_moved_without_strain_is_certified(self):
        # All forces, those of the guided node included, are rounding; or a load or a spring acts on what a
        # support holds and moves.
        for support, groups in (("set = 'left'  ux = 0.00323", ("gap_direction = 0.074, -1.0",)),
                                ("set = 'top'  ux = -0.7  uy = 0.3", ("", "load point = 4.0, 2.0  force = 1.0, 3.0")),
                                ("set = 'right'  un = -0.01  spring_n = 7.0", ("extra_gap = 0.1",))):
            self.assertEqual(self.attempt(block(f"support {support}", f"{CONTACT}  {groups[0]}", *groups[1:])), (0, ""))
            self.run_program("--verify", "results")

    def test_body_that_turns_far_beyond_its_strain_keeps_its_digits(self):
        # A hollow obstacle carries it at its corners: forces of what is turned alone would do wrong work by 1e-8.
        self.assertEqual(self.attempt("""&mesh size = 0.679851, 3.49091  cells = 7, 5  element = 'quad8' /
            &material young = 1304.53  poisson = 0.3  hypothesis = 'plane stress' /
            &load set = 'top'  pressure = 1.04891e-3  pressure_slope = 1.73477e-4, 0.0 /
            &contact set = 'bottom'  friction = 0.1  extra_gap = 2.2703e-3  point = 0.3399255, 0.0  radius = -34.0025
                     normal = -7.7318565e-3, 1.0  obstacle = 'circle' /"""), (0, ""))
        self.assertLess(self.result("case", "results").summary["certificate"]["energy"], 1e-10)

    def test_body_that_soft_springs_let_go_a_long_way_is_certified(self):
        # A way of 6.7 that strains nothing: rounding errors of the forces did work on it, 2e-8 of all.
        self.assertEqual(self.attempt(block(
            "support set = 'top'  spring_n = 9e5  spring_t = 3e-4", "load set = 'top'  pressure = 0.17",
            "load set = 'left'  traction = 0.0137, 0.0", "contact set = 'bottom'  friction = 0.5",
            mesh="size = 4.0, 1.0  cells = 31, 5  element = 'quad9'", material="young = 1000.0  poisson = 0.3")),
            (0, ""))

    def test_forces_that_are_rounding_errors_are_solved(self):
        # An overlap is let go of by a rigid motion, or all that is held moves alike: what is left is rounding.
        overlap = CONTACT + "  extra_gap = -0.2"
        moved = [f"support set = '{side}'  ux = 0.1  uy = 0.2" for side in ("left", "right", "top")]
        for groups, hypothesis in (((SUPPORT, overlap), "plane strain"), ((overlap,), "axisymmetric"),
                                   (("support set = 'bottom'  ux = 0.1", *moved, overlap), "plane strain")):
            for element in ("quad4", "tri6"):
                deck = block(*groups, mesh=f"size = 4.0, 2.0  cells = 12, 6  element = '{element}'",
                             material=f"young = 100.0  poisson = 0.25  hypothesis = '{hypothesis}'")
                self.assertEqual(self.attempt(deck), (0, ""), deck)
                self.run_program("--verify", "results")

    def test_forces_of_a_soft_part_are_none(self):
        # Beside the stiff part, which a support moves, they are rounding errors: the certificate must not pass unseen.
        self.write("layers.msh", two_layers())
        for power in (11, 14, 17):
            status, message = self.attempt(block(
                "material young = 1.0  poisson = 0.25  region = 'soft'", "support set = 'top'  ux = 0.1  uy = -0.01",
                CONTACT, mesh="kind = 'file'  file = 'layers.msh'",
                material=f"young = 1e{power}  poisson = 0.25  region = 'stiff'"))
            self.assertEqual(status, 4, power)
            self.assertIn("the certificate FAILED", message)


def two_layers():
    """A Gmsh file of 4 x 4 squares, the lower half of them the region soft, the upper one stiff."""
    corners = [(i, i + 1, i + 6, i + 5) for i in range(1, 20) if i % 5]
    elements = [f"1 2 1 1 {i} {i + 1}" for i in range(1, 5)] + [f"1 2 2 2 {i} {i + 1}" for i in range(21, 25)]
    elements += [f"3 2 {3 + k//8} 1 {' '.join(map(str, nodes))}" for k, nodes in enumerate(corners)]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "4", '1 1 "bottom"', '1 2 "top"',
             '2 3 "soft"', '2 4 "stiff"', "$EndPhysicalNames", "$Nodes", "25",
             *(f"{1 + i + 5*j} {i} {j} 0" for j in range(5) for i in range(5)), "$EndNodes", "$Elements",
             str(len(elements)), *(f"{k} {element}" for k, element in enumerate(elements, 1)), "$EndElements"]
    return "\n".join(lines) + "\n"


def two_blocks():
    """An Abaqus file of two blocks of 3 x 2 elements that stand apart on one floor; sides are bottom, left, top, other
    (the top of the right block)."""
    lines = ["*NODE"]
    lines += [f"{1 + i + 4*j + 12*block}, {i + 5*block}, {j}" for block in (0, 1) for j in range(3) for i in range(4)]
    lines.append("*ELEMENT, TYPE=CPE4")
    for block in (0, 1):
        for j in (0, 1):
            for i in range(3):
                first = 1 + i + 4*j + 12*block
                lines.append(f"{1 + i + 3*j + 6*block}, {first}, {first + 1}, {first + 5}, {first + 4}")
    for name, side, elements in (("bottom", "S1", (1, 2, 3, 7, 8, 9)), ("left", "S4", (1, 4)), ("top", "S3", (4, 5, 6)),
                                 ("other", "S3", (10, 11, 12))):
        lines.append(f"*SURFACE, NAME={name}")
        lines += [f"{element}, {side}" for element in elements]
    return "\n".join(lines) + "\n"


class Pieces(NumbersTest):
    """Bodies of two pieces, of which supports hold one only."""

    def setUp(self):
        super().setUp()
        self.write("blocks.inp", two_blocks())

    def attempt_blocks(self, *groups):
        return self.attempt(block("support set = 'left'  ux = 0.0  uy = 0.0", PRESSURE, *groups,
                                  mesh="kind = 'file'  file = 'blocks.inp'"))

    def test_contact_holds_the_other_piece(self):
        for friction in (0.0, 0.3, 1e6):
            self.assertEqual(self.attempt_blocks("load set = 'other'  pressure = 1.0",
                                                 f"contact set = 'bottom'  friction = {friction}"), (0, ""))
            result = self.result("case", "results")
            # The floor bears all of the load, to the limit of the certificate.
            forces = [force for x, force in zip(result["x"], result["normal_force"]) if x > 4.0]
            self.assertAlmostEqual(sum(forces), 3.0, delta=3e-8)
            self.run_program("--verify", "results")

    def test_other_piece_is_named(self):
        free = "case.nml: no equilibrium: contact and friction cannot balance the loads; the piece around 6.5, 1.0 " \
            "is free to translate"
        advice = "; add a support, or a load that presses the body on its obstacle\n"
        self.assertEqual(self.attempt_blocks("load set = 'other'  pressure = -1.0", CONTACT),
                         (2, f"{free} along (0.0, 1.0){advice}"))
        self.assertEqual(self.attempt_blocks("load set = 'other'  traction = 0.4, -1.0", CONTACT),
                         (2, f"{free} along (1.0, 0.3){advice}"))
        self.assertEqual(self.attempt_blocks("load set = 'other'  pressure = 1.0"), (
            2, "case.nml: no equilibrium: nothing balances the loads; the piece around 6.5, 1.0 is free to translate "
               "along (0.0, -1.0); add a support or a contact set\n"))


class Bits(ProgramTest):
    """The same bits in every run and with any number of threads, on meshes large enough for threads to be used."""

    def test_runs_and_threads(self):
        # From 10 000 elements on elements are shared among threads, and a cut factor is made on two.
        push = "load set = 'right'  traction = -0.2, 0.1"
        other = "sparse" if HAS_SUITESPARSE else "band"
        for name, mesh, solver in (("cut", "cells = 128, 80", "factorization = 'multifrontal'"),
                                   ("other", "cells = 72, 72  element = 'tri6'", f"factorization = '{other}'")):
            self.write(f"{name}.nml", block(SUPPORT, PRESSURE, push, CONTACT, f"solver {solver}",
                                            mesh=f"size = 4.0, 2.0  {mesh}"))
        files = []
        for i, n_threads in enumerate(("1", "2", "2")):
            self.run_program("--quiet", "--output", f"run{i}", "--threads", n_threads, "cut.nml", "other.nml")
            files.append({name: content for name, content in self.contents(f"run{i}").items()
                          if name.endswith((".csv", ".vtu")) and name != "batch.csv"})
        self.assertEqual(len(files[0]), 6)
        self.assertTrue(files[0] == files[1], "one thread and two differ")
        self.assertTrue(files[1] == files[2], "two runs differ")


if __name__ == "__main__":
    unittest.main()
