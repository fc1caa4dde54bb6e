#!/usr/bin/env python3
"""The Python package in python/amontons: arrays in and out, the program's sentences as exceptions.

AMONTONS_LIBRARY names the shared library. Without NumPy there is nothing to test.
"""
import copy
import gc
import json
import os
import pickle
import shutil
import subprocess
import sys
import tempfile
import unittest
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from histories import BLOCK, CLUTCH, DISC, PUSHED, TO_AND_FRO
from harness import CONTACT, PRESSURE, SOUND, SUPPORT, ProgramTest, Result, block, read_vtu, results_of
from rings import hung_ring, ring

try:
    import numpy as np
except ImportError:
    print("skipped: there is no NumPy")
    sys.exit(0)

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
import amontons  # noqa: E402  pylint: disable=wrong-import-position

# Two contacts: the first sticks, the second slides backwards.
W = np.array([[2, 0.5, 0.5, 0], [0.5, 3, 0, 0.25], [0.5, 0, 2, -0.5], [0, 0.25, -0.5, 3]])
Q = np.array([-1, -0.5, -2, -4])
MU = np.array([0.75, 0.5])
SWEEP = block("support set = 'left'  ux = 0.0", "load set = 'top'  pressure = 1.0  name = 'p'", CONTACT,
              "sweep load = 'p'  factor = 1.0, 2.0  count = 3")
# The columns of numbers of a contact table, those of one unit together.
UNITS = (("point",), ("x", "y", "weight", "gap", "slip"), ("normal_x", "normal_y"),
         ("normal_force", "tangential_force"), ("contact_pressure", "contact_shear"))


def chain(m, seed):
    """A reduced problem of m contacts that act on each other, the nearer the more, under random loads."""
    place = np.arange(m)
    near = np.exp(-0.5*np.abs(place[:, None] - place))
    w = np.kron(near, np.diag([2.0, 3.0]))
    return w, np.random.default_rng(seed).uniform(-3, 1, 2*m)


class Reduced(unittest.TestCase):
    """Reduced problems in arrays."""

    def check_law(self, w, q, mu, result, tolerance):
        """Checks every condition of the problem, each over the largest force or displacement."""
        mu = np.broadcast_to(mu, (len(q)//2,))
        r_n, r_t, u_n, u_t = result.r[::2], result.r[1::2], result.u[::2], result.u[1::2]
        force, length = np.abs(result.r).max(), np.abs(q).max()
        # u is computed from r as here, by sums in another order.
        np.testing.assert_allclose(result.u, w @ result.r + q, rtol=0, atol=1e-13*length)
        self.assertGreaterEqual(r_n.min(), -tolerance*force)
        self.assertGreaterEqual(u_n.min(), -tolerance*length)
        self.assertLessEqual(np.minimum(r_n/force, u_n/length).max(), tolerance)
        self.assertLessEqual((np.abs(r_t) - mu*r_n).max(), tolerance*force)
        slides = np.abs(u_t) > tolerance*length
        np.testing.assert_allclose(r_t[slides], -(mu*r_n*np.sign(u_t))[slides], rtol=0, atol=tolerance*force)
        for status, holds in (("open", u_n > 0), ("slip+", u_t > 0), ("slip-", u_t < 0)):
            self.assertTrue(holds[result.status == status].all(), status)

    def test_two_contacts(self):
        result = amontons.solve_reduced(W, Q, MU)
        self.assertTrue(result.is_solved)
        self.assertEqual(list(result.status), ["stick", "slip-"])
        self.check_law(W, Q, MU, result, 1e-9)  # ten times the tolerance of the method

    def test_methods_agree(self):
        w, q = chain(40, 1)
        results = [amontons.solve_reduced(w, q, 0.3, method=method, tolerance=1e-12, max_iterations=100000)
                   for method in ("psor", "fixed_point", "lemke")]
        for result in results:
            self.check_law(w, q, 0.3, result, 1e-9)
            # This W is so well conditioned that a residual of 1e-12 is an error not much larger.
            np.testing.assert_allclose(result.r, results[0].r, rtol=0, atol=1e-9)

    def test_skew_part_of_w_counts(self):
        w = W.copy()
        w[0, 1] *= 1.0005  # what is taken for rounding
        result = amontons.solve_reduced(w, Q, MU, method="psor", tolerance=1e-12)
        np.testing.assert_allclose(result.u, w @ result.r + Q, rtol=0, atol=1e-13)
        self.assertGreater(np.abs(w.T @ result.r + Q - result.u).max(), 1e-5)

    def test_arrays_of_any_kind_are_taken(self):
        expected = amontons.solve_reduced(W, Q, MU, method="psor")
        for w, q, mu in ((W.tolist(), Q.tolist(), tuple(MU)), (np.asfortranarray(W), Q, MU),
                         (np.repeat(W, 2, axis=1)[:, ::2], np.repeat(Q, 2)[::2], MU)):
            result = amontons.solve_reduced(w, q, mu, method="psor")
            self.assertEqual(result.r.tolist(), expected.r.tolist())

    def test_a_sparse_matrix_is_taken(self):
        class Sparse:
            """What a sparse matrix of SciPy can do that matters here."""
            def toarray(self):
                """The matrix, dense."""
                return W

        found, expected = (amontons.solve_reduced(matrix, Q, MU) for matrix in (Sparse(), W))
        self.assertEqual(found.r.tolist(), expected.r.tolist())

    def test_one_friction_is_for_all_contacts(self):
        self.assertEqual(amontons.solve_reduced(W, Q, 0.5, method="psor").r.tolist(),
                         amontons.solve_reduced(W, Q, [0.5, 0.5], method="psor").r.tolist())

    def test_no_contact_is_solved(self):
        result = amontons.solve_reduced(np.zeros((0, 0)), [], 0.5)
        self.assertTrue(result.is_solved)
        self.assertEqual(result.r.size, 0)

    def test_not_converged_warns(self):
        with self.assertWarnsRegex(amontons.NotConverged, "^not converged: residual "):
            result = amontons.solve_reduced(W, Q, MU, method="psor", max_iterations=1)
        self.assertFalse(result.is_solved)
        self.assertEqual(result.iterations, 1)

    def test_faults_are_told(self):
        for arguments, sentence in (
                ((W, Q[:3], MU), r"expected W of 2m x 2m numbers and q of 2m, found \(4, 4\) and \(3,\)"),
                ((W, Q, [1, 2, 3]), r"expected one mu, or one for each of 2 contacts, found \(3,\)"),
                ((W, Q, -1), r"mu\(1\) = -1.0: expected a finite number, at least 0"),
                ((W, Q*np.nan, MU), r"q\(1\) = NaN: expected a finite number"),
                ((np.triu(W), Q, MU), r"W\(.*differ by more than rounding: expected a symmetric W"),
                ((W, Q, MU, "gauss"), "unknown contact method 'gauss'"),
                ((W, Q, MU, "psor", 2.0), "tolerance must lie above 0 and below 1")):
            with self.subTest(sentence), self.assertRaisesRegex(amontons.InputRefused, sentence):
                amontons.solve_reduced(*arguments)

    def test_contacts_in_space(self):
        # Open, sticking, and sliding along its load.
        q = np.array([1, -2, 0, -1, -0.1, 0.1, -2, -3, 4])
        w = np.diag(np.tile([2.0, 1.0, 1.0], 3))
        result = amontons.solve_reduced(w, q, [0.5, 0.5, 0.5])
        self.assertEqual(list(result.status), ["open", "stick", "slip"])
        np.testing.assert_allclose(result.r, [0, 0, 0, 0.5, 0.1, -0.1, 1, 0.3, -0.4], rtol=0, atol=1e-9)
        np.testing.assert_allclose(result.u, w @ result.r + q, rtol=0, atol=1e-14)
        # Nine numbers and one mu are no contacts of the plane.
        with self.assertRaisesRegex(amontons.InputRefused, r"^expected W of 2m x 2m numbers and q of 2m, found"):
            amontons.solve_reduced(w, q, 0.5)
        self.assertEqual(amontons.solve_reduced(w, q, 0.5, dimension=3).r.tolist(), result.r.tolist())
        with self.assertRaisesRegex(amontons.InputRefused, "^expected dimension = 2 or 3, found 4"):
            amontons.solve_reduced(w, q, 0.5, dimension=4)
        with self.assertRaisesRegex(amontons.InputRefused, "^the method lemke is for the plane: "):
            amontons.solve_reduced(w, q, [0.5, 0.5, 0.5], method="lemke")

    def test_threads_do_not_disturb_each_other(self):
        problems = [chain(30, seed) for seed in range(16)]

        def solve(problem):
            return amontons.solve_reduced(*problem, 0.3, method="psor").r.tolist()

        with ThreadPoolExecutor(4) as pool:
            self.assertEqual(list(pool.map(solve, problems)), [solve(problem) for problem in problems])


class Deck(ProgramTest):
    """Decks."""

    def test_deck_is_solved_as_by_the_program(self):
        deck = self.directory / self.write("case.nml", SOUND)
        result = amontons.solve_deck(deck, self.directory / "python")
        self.run_program("--quiet", "case.nml", "--output", "program")
        self.assertTrue(result.is_solved)
        self.assertEqual((result.name, result.directory), ("case", self.directory / "python"))
        self.assertEqual(sorted(self.contents("python")), results_of("case"))
        expected = Result(self.directory / "program", "case")
        self.assertEqual(list(result.contact), list(expected.columns))
        self.assertEqual(result.contact["status"].tolist(), expected["status"])
        for unit in UNITS:
            found, wanted = (np.array([columns[column] for column in unit]) for columns in (result.contact, expected))
            # NumPy may have brought another BLAS into this process, whose sums are rounded elsewhere; the condition of
            # this small body makes 1e-15 at most a thousand times as much.
            np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12*np.abs(wanted).max(), err_msg=str(unit))
        self.assertEqual(result.contact["x"].dtype, np.float64)
        self.assertEqual(result.summary["lengths"], expected.summary["lengths"])
        self.assertEqual(result.key_results["max_contact_pressure"], result.contact["contact_pressure"].max())
        self.assertEqual(repr(result), "<DeckResult 'case': solved>")

    def test_files_are_left_only_where_asked_for(self):
        deck = self.directory / self.write("case.nml", SOUND)
        result = amontons.solve_deck(str(deck))
        self.assertIsNone(result.directory)
        self.assertEqual(self.files(), ["case.nml"])
        self.assertEqual(len(result.contact["gap"]), 9)

    def test_sweep_is_a_table_of_cases(self):
        result = amontons.solve_deck(self.directory / self.write("case.nml", SWEEP))
        self.assertIsNone(result.contact)
        self.assertEqual(len(result.sweep["case"]), 3)
        self.assertTrue(result.is_solved)

    def test_cases_without_equilibrium_leave_the_columns_of_a_sweep_numbers(self):
        deck = self.write("case.nml", block("load set = 'top'  pressure = 1.0", CONTACT,
                                            "load set = 'left'  traction = 1.0, 0.0  name = 'p'",
                                            "sweep load = 'p'  factor = 0.0, 3.0"))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", amontons.NotConverged)
            sweep = amontons.solve_deck(self.directory / deck).sweep
        self.assertEqual(sweep["outcome"].tolist(), ["solved", "no_equilibrium"])
        self.assertEqual(np.isnan(sweep["normal_force"]).tolist(), [False, True])

    def test_reduced_problem_is_a_deck_too(self):
        samples = ROOT / "tests" / "reduced"
        deck = self.write("case.nml", f"&problem kind = 'reduced'  file = '{samples / 'dense.dat'}' /\n")
        result = amontons.solve_deck(self.directory / deck)
        self.assertEqual(result.contact["status"].shape, (2,))

    def test_faulty_deck_is_refused_with_the_program_s_sentences(self):
        name = self.directory / self.write("case.nml", SOUND.replace("friction", "frction"))
        run = self.run_program(name, status=1)
        with self.assertRaises(amontons.InputRefused) as caught:
            amontons.solve_deck(name, self.directory)
        self.assertEqual(str(caught.exception), run.stderr.rstrip("\n"))

    def test_body_without_equilibrium_has_an_exception_of_its_own(self):
        name = self.directory / self.write("case.nml", block("load set = 'top'  traction = 0.0, 1.0",
                                                             "support set = 'left'  ux = 0.0", CONTACT))
        run = self.run_program(name, status=None)
        self.assertEqual(run.returncode, 2)
        with self.assertRaises(amontons.NoEquilibrium) as caught:
            amontons.solve_deck(name)
        self.assertIsInstance(caught.exception, amontons.NumericalFailure)
        self.assertEqual(str(caught.exception), run.stderr.rstrip("\n"))

    def test_whatever_has_no_equilibrium_raises_the_same_exception(self):
        loose = block("support set = 'left'  ux = 0.0", "load name = 'f'  set = 'right'  traction = 1.0, 0.0")
        lifted = block("load name = 'f'  set = 'top'  traction = 0.0, 1.0", SUPPORT, CONTACT)
        sweep = "&sweep load = 'f'  factor = 1.0, 2.0 /\n"
        history = "&history times = 0.0, 1.0 /\n&steps load = 'f'  factor = 0.0, 1.0 /\n"
        self.write("ring.msh", ring(0.02))
        for text, sentence, n_rows in (
                (loose, "the body is free to", 0), (loose + sweep, "the body is free to", 0),
                (loose + history, "the body is free to", 0), (lifted + sweep, "no case has an equilibrium", 2),
                (hung_ring(0.02, 24, 0.0, (0.0, -1e-2)), "no equilibrium but for the irregularities of the mesh", 0)):
            name = self.directory / self.write("free.nml", text)
            # The files of the sweep stay in the directory; they are no result of other decks of the name.
            with self.assertRaisesRegex(amontons.NoEquilibrium, sentence) as caught:
                amontons.solve_deck(name, self.directory / "results")
            result = caught.exception.result
            self.assertEqual(0 if result is None else len(result.sweep["outcome"]), n_rows, text)

    def test_numbers_out_of_range_are_another_failure(self):
        with self.assertRaises(amontons.NumericalFailure) as caught:
            amontons.solve_deck(block(SUPPORT, PRESSURE, CONTACT, mesh="size = 1e200, 1e200  cells = 8, 4"))
        self.assertNotIsInstance(caught.exception, amontons.NoEquilibrium)

    def test_directory_that_cannot_be_made_is_a_system_failure(self):
        name = self.directory / self.write("case.nml", SOUND)
        with self.assertRaisesRegex(amontons.SystemFailure, "cannot make this directory"):
            amontons.solve_deck(name, name / "out")

    def test_not_converged_is_a_result_and_a_warning(self):
        name = self.directory / self.write("case.nml", SOUND + "&solver method = 'psor'  max_iterations = 2 /\n")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = amontons.solve_deck(name, self.directory)
        self.assertFalse(result.is_solved)
        self.assertFalse(result.summary["converged"])
        self.assertEqual([warning.category for warning in caught], [amontons.NotConverged])
        self.assertEqual(caught[0].filename, __file__)

    def test_names_beyond_ascii_pass(self):
        name = self.directory / self.write("häuschen.nml", SOUND)
        result = amontons.solve_deck(name, self.directory / "Übung")
        self.assertEqual(result.name, "häuschen")
        self.assertTrue((self.directory / "Übung" / "häuschen.lst").exists())

    def test_decks_side_by_side_leave_the_same_files(self):
        names = [self.directory / self.write(f"case{i}.nml", SOUND.replace("0.3", f"0.{i + 1}")) for i in range(6)]
        with ThreadPoolExecutor(3) as pool:
            together = list(pool.map(lambda name: amontons.solve_deck(name, self.directory / "out"), names))
        for name, result in zip(names, together):
            alone = amontons.solve_deck(name)
            self.assertEqual({key: value.tolist() for key, value in result.contact.items()},
                             {key: value.tolist() for key, value in alone.contact.items()})


class Steps(ProgramTest):
    """Histories step by step."""
    DECK = block("support set = 'left'  ux = 0.0", "load set = 'top'  pressure = 1.0", CONTACT.replace("&", ""),
                 "load name = 'F'  set = 'right'  traction = 1.0, 0.0",
                 "history times = 0.0, 1.0, 2.0, 3.0  substeps = 5",
                 "steps load = 'F'  factor = 0.0, -1.0, 0.5, -0.8",
                 "steps obstacle = 'bottom'  shift_x = 0.0, 0.01, 0.01, -0.01",
                 "output probe = 4.0, 0.0")

    def test_steps_are_those_of_the_program(self):
        rows = amontons.solve_deck(self.DECK).history
        stepper = amontons.Stepper(self.DECK)
        self.assertEqual(stepper.changes, ["factor_F", "shift_x_bottom", "shift_y_bottom", "turn_bottom"])
        state = stepper.rest()
        for i, time in enumerate(rows["time"]):
            changes = {name: rows[name][i] for name in stepper.changes}
            # Another way first: it leaves no trace.
            stepper.step(state, time + 1, **{**changes, "factor_F": 0.3})
            state = stepper.step(state, time, **changes)
            for name, value in state.columns.items():
                self.assertEqual(value, rows[name][i], f"{name}, step {i + 1}")
        self.assertEqual(state.status.size, stepper.n_points)
        self.assertAlmostEqual(sum(state.dissipation), rows["dissipation"][-1], delta=1e-14)
        self.assertEqual(max(abs(state.slip_step)), rows["max_slip_step"][-1])

    def test_twisted_bodies_have_two_tangents(self):
        deck = CLUTCH + DISC + TO_AND_FRO
        rows = amontons.solve_deck(deck).history
        stepper = amontons.Stepper(deck)
        state = stepper.rest()
        r = stepper.points.x
        torques = []
        for i, time in enumerate(rows["time"]):
            changes = {name: rows[name][i] for name in stepper.changes}
            stepper.step(state, time + 1, factor_press=2.0, factor_turn=0.3)
            state = stepper.step(state, time, **changes)
            for name, value in state.columns.items():
                self.assertEqual(value, rows[name][i], f"{name}, step {i + 1}")
            torques.append(state.tangential_force[1] @ r)
        # The body exerts them at the radii of its nodes: their moment is that of the load. A disc is met to
        # the tolerance of the solver.
        np.testing.assert_allclose(torques, 6.0*rows["factor_turn"], rtol=0, atol=1e-8)
        self.assertEqual(state.slip_step.shape, (2, stepper.n_points))
        self.assertEqual(np.max(np.hypot(*state.slip_step)), rows["max_slip_step"][-1])
        shear = np.hypot(*state.tangential_force)
        slips = state.status == "slip"
        self.assertGreater(np.count_nonzero(slips), 1)
        np.testing.assert_allclose(shear[slips], 0.3*state.normal_force[slips], rtol=1e-8)
        self.assertTrue(np.all(shear[~slips] < 0.3*state.normal_force[~slips]))
        # Friction acts against the slip of the step.
        along = np.sum(state.tangential_force*state.slip_step, axis=0)[slips]
        np.testing.assert_allclose(along, (shear*np.hypot(*state.slip_step))[slips], rtol=1e-8)

    def test_states_of_solids_have_vectors(self):
        # A floor goes round under a block whose top is held: friction is along the slip of each step.
        deck = block("support set = 'top'  ux = 0.0  uy = 0.0", "load name = 'press'  set = 'top'  pressure = 2.0",
                     "contact name = 'floor'  set = 'bottom'  friction = 0.3",
                     "history times = 0.0, 1.0, 2.0, 3.0  substeps = 3",
                     "output points_every = 1  probe = 2.0, 2.0, 1.0",
                     "steps load = 'press'  factor = 1.0, 2.0, 1.0, 1.0",
                     "steps obstacle = 'floor'  shift_x = 0.0, 0.1, 0.1, 0.0  shift_y = 0.0, 0.0, 0.1, -0.1",
                     mesh="kind = 'box'  size = 2.0, 2.0, 1.0  cells = 4, 3, 2")
        result = amontons.solve_deck(deck)
        rows, stepper = result.history, amontons.Stepper(deck)
        self.assertEqual(stepper.changes, ["factor_press", "shift_x_floor", "shift_y_floor", "shift_z_floor"])
        for name in "x", "y", "z", "area":
            np.testing.assert_array_equal(getattr(stepper.points, name), result.contact[name], err_msg=name)
        for axis, normal in zip("xyz", stepper.points.normal, strict=True):
            np.testing.assert_array_equal(normal, result.contact[f"normal_{axis}"])
        state = stepper.rest()
        for i, time in enumerate(rows["time"]):
            changes = {name: rows[name][i] for name in stepper.changes}
            before, state = state, stepper.step(state, time, **changes)
            for name, value in state.columns.items():
                self.assertEqual(value, rows[name][i], f"{name}, step {i + 1}")
            slips = state.status == "slip"
            shear = np.linalg.norm(state.tangential_force, axis=0)
            np.testing.assert_allclose(shear[slips], 0.3*state.normal_force[slips], rtol=1e-8)
            along = np.sum(state.tangential_force*state.slip_step, axis=0)[slips]
            np.testing.assert_allclose(along, (shear*np.linalg.norm(state.slip_step, axis=0))[slips], rtol=1e-8)
            np.testing.assert_allclose(np.sum(state.tangential_force*stepper.points.normal, axis=0), 0.0, atol=1e-15)
        # The force on the body is along the normal, outwards, and along the slip, both with the opposite sign.
        forces = -(state.normal_force*stepper.points.normal + state.tangential_force)
        for axis, force in zip("xyz", forces):
            np.testing.assert_allclose(force, result.contact[f"force_{axis}"], rtol=0, atol=1e-15)
        np.testing.assert_allclose(np.linalg.norm(state.slip_step, axis=0), result.contact["slip_step"], atol=1e-15)
        self.assertEqual(before.slip_step.shape, (3, stepper.n_points))

    def test_points_are_those_of_the_contact_table(self):
        deck = self.DECK.replace("poisson = 0.25", "poisson = 0.25  thickness = 3.0")
        stepper, contact = amontons.Stepper(deck), amontons.solve_deck(deck).contact
        for name in "x", "y", "weight":
            np.testing.assert_array_equal(getattr(stepper.points, name), contact[name], err_msg=name)
        np.testing.assert_allclose(stepper.points.area, 3.0*contact["weight"], rtol=1e-15)

    def test_gaps_of_a_step_are_those_of_a_table(self):
        self.write("gaps.csv", "0.0 0.003\n4.0 -0.001\n")
        tabled = amontons.Stepper(self.DECK, contact__gap_table=self.directory/"gaps.csv")
        stepper = amontons.Stepper(self.DECK)
        gap = 0.003 - 0.001*stepper.points.x
        expected, state = tabled.rest(), stepper.rest()
        for time, push in ((0.0, 0.0), (1.0, -0.5), (2.0, -0.9), (3.0, 0.4)):
            changes = {**dict.fromkeys(stepper.changes, 0.0), "factor_F": push}
            expected = tabled.step(expected, time, **changes)
            # Another gap first: it leaves no trace.
            stepper.step(state, time, gap=0.01, **changes)
            state = stepper.step(state, time, gap=gap, **changes)
            np.testing.assert_array_equal(state.status, expected.status)
            # Gaps are the same to rounding, forces to what a stiff body makes of it.
            np.testing.assert_allclose(state.normal_force, expected.normal_force, rtol=0, atol=1e-12)
            np.testing.assert_allclose(state.slip_accumulated, expected.slip_accumulated, rtol=0, atol=1e-13)
        self.assertGreater(expected.columns["max_slip_accumulated"], 0.0)
        self.assertGreater(len(set(state.status)), 1)
        # Back where no gap is added the friction state is that of the way.
        self.assertNotEqual(stepper.step(state, 4.0, **changes).columns["tangential_force"],
                            stepper.step(stepper.rest(), 4.0, **changes).columns["tangential_force"])
        for wrong in (np.zeros(3), [[0.0]*stepper.n_points]*2):
            with self.assertRaisesRegex(amontons.InputRefused, "^expected a gap for each of 9 contact points, found"):
                stepper.step(state, 4.0, gap=wrong, **changes)
        with self.assertRaisesRegex(amontons.InputRefused, "^time, changes, gaps and state must be finite numbers"):
            stepper.step(state, 4.0, gap=np.inf, **changes)

    def test_wear_by_hand_is_that_of_the_key(self):
        wear = 2e-4
        worn, plain = amontons.Stepper(self.DECK, contact__wear=wear), amontons.Stepper(self.DECK)
        of_key, by_hand = worn.rest(), plain.rest()
        depth, before = np.zeros(plain.n_points), by_hand
        for i in range(20):
            changes = {**dict.fromkeys(plain.changes, 0.0), "shift_x_bottom": 0.2*(i % 5)}
            of_key = worn.step(of_key, float(i), **changes)
            before, by_hand = by_hand, plain.step(by_hand, float(i), gap=depth, **changes)
            slip = by_hand.slip_step.copy()
            # The node that a support holds slides on the floor, too.
            slip[0] = -changes["shift_x_bottom"] + (0.2*((i - 1) % 5) if i else 0.0)
            pressure = (by_hand.normal_force + before.normal_force)/(2*plain.points.area)
            depth = depth + wear*pressure*np.abs(slip)
            np.testing.assert_allclose(of_key.wear_depth, depth, rtol=1e-9, atol=1e-15)
            np.testing.assert_allclose(of_key.normal_force, by_hand.normal_force, rtol=0, atol=1e-10)
        self.assertGreater(depth.min(), 0.0)
        self.assertAlmostEqual(of_key.columns["wear_volume_bottom"], depth @ plain.points.area, delta=1e-12)

    def test_faults_of_steps_are_told(self):
        stepper = amontons.Stepper(self.DECK)
        rest = stepper.rest()
        with self.assertRaisesRegex(amontons.InputRefused, "^expected factor_F, shift_x_bottom, .*, found nothing"):
            stepper.step(rest, 1.0)
        changes = dict.fromkeys(stepper.changes, 0.0)
        with self.assertRaisesRegex(amontons.InputRefused, "^time, changes, gaps and state must be finite numbers"):
            stepper.step(rest, float("nan"), **changes)
        with self.assertRaisesRegex(amontons.InputRefused, "^expected 4 changes and a state of [0-9]+ numbers, found"):
            stepper.step(amontons.Stepper(self.DECK, mesh__cells=(4, 2)).rest(), 1.0, **changes)
        with self.assertRaisesRegex(amontons.NumericalFailure, "does not converge; a shorter one may"):
            amontons.Stepper(self.DECK + "&solver method = 'psor'  max_iterations = 1 /").step(
                rest, 1.0, **{**changes, "factor_F": -1.0})
        free = amontons.Stepper(BLOCK + PUSHED)
        with self.assertRaisesRegex(amontons.NoEquilibrium, "^no equilibrium: contact and friction cannot balance"):
            free.step(free.rest(), 1.0, factor_push=1.0)
        with self.assertRaisesRegex(amontons.InputRefused, "^a stepper needs a deck with &history"):
            amontons.Stepper(SOUND)
        with self.assertRaisesRegex(amontons.InputRefused, "^start is not for a stepper"):
            amontons.Stepper(self.DECK, history__start="none.csv")

    def test_states_that_are_not_in_equilibrium_with_the_body_are_refused(self):
        stepper = amontons.Stepper(self.DECK)
        changes = {**dict.fromkeys(stepper.changes, 0.0), "factor_F": -1.0}
        state = stepper.step(stepper.step(stepper.rest(), 0.5, gap=1e-4, **changes), 1.0, **changes)
        twin = amontons.Stepper(self.DECK).step(state, 2.0, **changes)
        np.testing.assert_array_equal(twin.raw, stepper.step(state, 2.0, **changes).raw)
        for setting in ({"material__young": 1500.0}, {"material__poisson": 0.26}, {"contact__friction": 0.1},
                        {"load__1__pressure": 1.01}, {"mesh__size": (4.0, 2.1)},
                        {"material__hypothesis": "plane stress"}):
            other = amontons.Stepper(self.DECK, **setting)
            self.assertEqual(other.rest().raw.size, state.raw.size)
            with self.subTest(setting), self.assertRaisesRegex(
                    amontons.InputRefused, "^this state cannot be the start of a step: it is not in equilibrium with "
                    r"the body and what acts on it at the time 1\.0 \(violation .*mesh, materials, supports"):
                other.step(state, 2.0, **changes)
            # Another body's states are its own.
            other.step(other.rest(), 2.0, **changes)

    def test_arguments_of_wrong_kinds_are_refused(self):
        stepper = amontons.Stepper(self.DECK)
        rest, changes = stepper.rest(), dict.fromkeys(stepper.changes, 0.0)
        solve, step = amontons.solve_reduced, stepper.step
        mesh = amontons.Mesh([[0, 0], [1, 0], [1j, 1]], [("triangle", [[0, 1, 2]])])
        for call, sentence in (
                (lambda: solve(W*1j, Q, MU), "W: expected real numbers, found complex128"),
                (lambda: solve(W, Q + 0j, MU), "q: expected real numbers, found complex128"),
                (lambda: solve(W, Q, [0.5, None]), "mu: expected real numbers, found list"),
                (lambda: solve(W, "abc", MU), "q: expected real numbers, found str"),
                (lambda: solve([[1, 0], [1]], Q, MU), "W: expected real numbers in rows of one length, found list"),
                (lambda: solve(W, Q, MU, method=3), "method: expected the name of a method, found int"),
                (lambda: solve(W, Q, MU, tolerance="1"), "tolerance: expected real numbers, found str"),
                (lambda: solve(W, Q, MU, max_iterations=1.5), "max_iterations: expected a whole number, found float"),
                (lambda: solve(W, Q, MU, max_iterations=2**31), "max_iterations: expected a whole number of at most"),
                (lambda: solve(W, Q, MU, dimension="2"), "dimension: expected a whole number, found str"),
                (lambda: step(rest, 1.0, gap=np.full(stepper.n_points, 1j), **changes), "gap: expected real numbers"),
                (lambda: step(rest, "1", **changes), "time: expected real numbers, found str"),
                (lambda: step(rest, 1.0, **{**changes, "factor_F": [1, 2]}), "factor_F: expected one number, found an"),
                (lambda: step(rest.raw, 1.0, **changes), "expected a state that rest or step returned, found ndarray"),
                (lambda: amontons.set_threads("2"), "n_threads: expected a whole number, found str"),
                (lambda: amontons.Stepper(5), "deck: expected the name of a file, a text or a dict of groups, fou"),
                (lambda: amontons.solve_deck(None), "deck: expected the name of a file, a text or a dict of groups"),
                (lambda: amontons.solve_deck(self.DECK, mesh=mesh), "nodes: expected real numbers, found complex128")):
            with self.subTest(sentence), self.assertRaisesRegex(amontons.InputRefused, "^" + sentence):
                call()

    def test_what_the_library_keeps_has_no_copies(self):
        stepper = amontons.Stepper(self.DECK)
        changes = dict.fromkeys(stepper.changes, 0.0)
        for copier in (copy.copy, copy.deepcopy, pickle.dumps):
            with self.assertRaisesRegex(TypeError, "a Stepper can be neither copied nor pickled"):
                copier(stepper)
        gc.collect()
        state = stepper.step(stepper.rest(), 1.0, **changes)
        for kept in (copy.copy(state), copy.deepcopy(state), pickle.loads(pickle.dumps(state))):
            np.testing.assert_array_equal(stepper.step(kept, 2.0, **changes).raw,
                                          stepper.step(state, 2.0, **changes).raw)
        result = pickle.loads(pickle.dumps(amontons.solve_deck(SOUND)))
        self.assertTrue(result.is_solved)


class Processes(ProgramTest):
    """What the library does to the process that it is in."""

    def run_script(self, *lines):
        """Runs lines of Python with two threads of OpenMP and as many of the BLAS as there are; what they print."""
        environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "OMP_NUM_THREADS": "2"}
        environment.pop("OPENBLAS_NUM_THREADS", None)
        return subprocess.run([sys.executable, "-W", "ignore", "-c", "\n".join(lines)], check=True, timeout=120,
                              capture_output=True, encoding="utf-8", cwd=self.directory, env=environment).stdout

    def test_forked_processes_solve(self):
        # So many nodes that loops are shared by two threads.
        deck = block(SUPPORT, PRESSURE, CONTACT, mesh="size = 4.0, 2.0  cells = 80, 60")
        # The second fork happens while another thread is within the library.
        self.assertEqual(self.run_script(
            "import amontons, multiprocessing, os, threading, time",
            "def solve(pressure):",
            f"    result = amontons.solve_deck({deck!r}, load__pressure=pressure)",
            "    return result.summary['key_results']",
            "expected = [solve(1.0), solve(2.0)]",
            "with multiprocessing.get_context('fork').Pool(2) as pool:",
            "    print(pool.map(solve, [1.0, 2.0]) == expected, solve(2.0) == expected[1])",
            "thread = threading.Thread(target=solve, args=[1.0])",
            "thread.start()",
            "time.sleep(0.02)",
            "child = os.fork()",
            "if not child:",
            "    os._exit(3 if solve(2.0) == expected[1] else 4)",
            "print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))",
            "thread.join()"), "True True\n3\n")

    def test_small_cases_keep_to_one_thread(self):
        # Threads that have nothing to do sleep: they are never switched to. Where the machine has more to do than it
        # has processors, each hand-over to one would wait for its turn.
        self.assertEqual(self.run_script(
            "import amontons, pathlib, re, threading, time",
            "def n_switches():",
            "    return {task.name: re.findall('ctxt_switches:.(.*)', (task/'status').read_text())",
            "            for task in pathlib.Path('/proc/self/task').iterdir()",
            "            if int(task.name) != threading.get_native_id()}",
            f"deck = {block(SUPPORT, PRESSURE, CONTACT, mesh='size = 40.0, 40.0  cells = 32, 10')!r}",
            "amontons.solve_deck(deck)",
            "time.sleep(0.5)",
            "before = n_switches()",
            "for friction in (0.1, 0.2, 0.3):",
            "    amontons.solve_deck(deck, contact__friction=friction)",
            "print(n_switches() == before)"), "True\n")


class Grids(ProgramTest):
    """The grids."""

    def test_arrays_are_those_of_the_file(self):
        mixed = f"kind = 'file'  file = '{ROOT / 'tests' / 'meshes' / 'mixed-41.msh'}'"
        self.write("mixed.nml", block("load body_force = 0.0, -1.0", "support set = 'right end'  ux = 0.0", CONTACT,
                                      mesh=mixed))
        self.write("none.nml", block("support set = 'left'  ux = 0.0  uy = 0.0"))
        self.run_program("--quiet", "mixed.nml", "none.nml")
        n_kinds = {"mixed.vtu": 2, "mixed.contact.vtu": 1, "none.vtu": 1, "none.contact.vtu": 0}
        for name, n in n_kinds.items():
            expected, n_points, n_cells = read_vtu(self.contents()[name])
            grid = amontons.read_grid(self.directory / name)
            self.assertEqual(grid.points.shape, (n_points, 3))
            self.assertEqual([len(grid.cells), sum(len(nodes) for _, nodes in grid.cells)], [n, n_cells])
            self.assertEqual([node for _, nodes in grid.cells for node in nodes.flatten()],
                             list(expected["connectivity"]))
            for key, values in {**grid.point_data, **grid.cell_data, "points": grid.points}.items():
                self.assertEqual(values.tolist(), [list(x) if isinstance(x, tuple) else x for x in expected[key]], key)
        self.assertEqual({*grid.point_data} | {*grid.cell_data} | {"points", "connectivity", "offsets", "types"},
                         {*expected})
        self.assertEqual([kind for kind, _ in amontons.read_grid(self.directory / "mixed.vtu").cells],
                         ["triangle6", "quad8"])

    def test_solids_have_kinds_of_their_own(self):
        kinds = {"tet4": "tetra", "tet10": "tetra10", "hex8": "hexahedron", "hex20": "hexahedron20"}
        for element, kind in kinds.items():
            self.write(f"{element}.nml", block(
                "support set = 'top'  ux = 0.0  uy = 0.0  uz = -0.01", CONTACT,
                mesh=f"kind = 'box'  size = 1.0, 1.0, 1.0  cells = 2, 2, 2  element = '{element}'",
                material="young = 1.0  poisson = 0.3"))
            self.run_program("--quiet", f"{element}.nml")
            expected, n_points, n_cells = read_vtu(self.contents()[f"{element}.vtu"])
            grid = amontons.read_grid(self.directory / f"{element}.vtu")
            self.assertEqual(([name for name, _ in grid.cells], grid.points.shape, len(grid.cells[0][1])),
                             ([kind], (n_points, 3), n_cells))
            self.assertEqual(grid.cells[0][1].flatten().tolist(), list(expected["connectivity"]))


class Commands(ProgramTest):
    """`python -m amontons`, as far as it goes without pictures."""

    def test_what_is_no_command_is_refused(self):
        package = f"PYTHONPATH={ROOT / 'python'}"
        for words in ([], ["bar.nml"]):
            run = self.run_command(["env", package, sys.executable, "-B", "-m", "amontons", *words], status=1)
            self.assertEqual(run.stderr, "usage: python -m amontons plot|report|adapt|fclib ...\n")

    def test_a_missing_package_is_named(self):
        code = "import sys; sys.modules['matplotlib'] = None; from amontons import commands; commands.plot()"
        run = self.run_command(["env", f"PYTHONPATH={ROOT / 'python'}", sys.executable, "-B", "-c", code], status=1)
        self.assertEqual(run.stderr, f"plot: {sys.executable} has no package 'matplotlib'; install it (Debian: "
                         "python3-matplotlib)\n")


class Module(unittest.TestCase):
    """The module itself."""

    def test_version_is_the_program_s(self):
        self.assertRegex(amontons.version(), r"^\d+\.\d+\.\d+$")
        self.assertEqual(amontons.__version__, amontons.version())

    def test_every_public_name_is_there(self):
        for name in amontons.__all__:
            self.assertEqual(getattr(amontons, name).__name__, name)
        self.assertLessEqual({*amontons.__all__, "__version__"}, {*dir(amontons)})
        with self.assertRaisesRegex(AttributeError, "'amontons' has no attribute 'solve_dek'"):
            amontons.solve_dek  # pylint: disable=no-member,pointless-statement

    def test_library_of_the_build_tree_is_found(self):
        folder = Path(os.environ["AMONTONS_LIBRARY"]).parent
        found = self.run_python(folder / "amontons", "import amontons.solve as s; print(s._library_path())")
        self.assertEqual(found, f"{folder / 'libamontons_c.so'}\n")

    def test_library_beside_the_package_and_of_the_system(self):
        # In a wheel the library lies in the package; a package that lies alone leaves the search to the system.
        with tempfile.TemporaryDirectory(prefix="amontons_") as scratch:
            package = Path(scratch) / "lib" / "site-packages" / "amontons"
            shutil.copytree(ROOT / "python" / "amontons", package)
            look = "import amontons.solve as s; print(s._library_path())"
            alone = look.replace("import", "import ctypes; ctypes.CDLL = lambda name: print(name) or exit(); import")
            self.assertRegex(self.run_python(package.parent, alone), r"^libamontons_c\.so[.0-9]*\n$")
            library = package / "libamontons_c.so"
            library.symlink_to(Path(os.environ["AMONTONS_LIBRARY"]).resolve())
            self.assertEqual(self.run_python(package.parent, look), f"{library}\n")

    @staticmethod
    def run_python(folder, code):
        """What Python prints, with a folder on its path and no library named."""
        environment = {key: value for key, value in os.environ.items() if key != "AMONTONS_LIBRARY"}
        return subprocess.run([sys.executable, "-B", "-c", code], env={**environment, "PYTHONPATH": str(folder)},
                              capture_output=True, encoding="utf-8", check=True, timeout=300).stdout

    def test_library_shows_its_interface_only(self):
        import ctypes  # pylint: disable=import-outside-toplevel
        library = ctypes.CDLL(os.environ["AMONTONS_LIBRARY"])
        self.assertTrue(hasattr(library, "amontons_solve_deck"))
        self.assertFalse(hasattr(library, "amontons_make_directory"))


if __name__ == "__main__":
    unittest.main()
