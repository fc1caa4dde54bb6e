"""Runs over several ranks of MPI: the same answers, messages and exit statuses as on one, and whole files or none.

Ranks add up in another order and factorize by another program, so results agree to 1e-9 of the largest number of a
kind, not to the last bit.
"""
import csv
import os
import random
import re
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

from harness import CONTACT, PRESSURE, PROGRAM, SUPPORT, ProgramTest, block, read_vtu, results_of
from test_mechanisms import HELD, blocks, deck_of_blocks

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = (ROOT / "input", ROOT / "tests/verification/decks")
SPREAD = ("--set", "solver.factorization=distributed")
TOLERANCE = 1e-9
NUMBER = re.compile(r"-?[0-9.]+(e[-+]?[0-9]+)?")
# Decks that leave nothing to spread: all unknowns belong to contact points, or there is no body.
NOTHING_TO_SPREAD = {"cube_incline", "jenkins", "moving_floor", "one_point", "one_point_body", "step_size"}
# Columns of a sweep that tell of the way to an answer, not of the answer.
WAYS = ("iterations", "residual")
# Root may run MPI only where it says so, and each rank has one thread. Ranks that wait leave the cores to other tests,
# also where they are no more than the cores. Nor are they bound to a core each, as mpiexec binds two: where others work
# on these cores, each message would wait for its turn twice.
os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", OMP_NUM_THREADS="1",
                  OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_hwloc_base_binding_policy="none")


def launched(ranks, *arguments):
    """The command that runs the program on ranks; mpiexec's own remarks on exit statuses are left out."""
    return ["mpiexec", "--quiet", "--oversubscribe", "-n", str(ranks), PROGRAM, *map(str, arguments)]


def ranks_of(launcher):
    """The processes of the program below mpiexec, by their rank."""
    found = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and f"PPid:\t{launcher.pid}\n" in (entry / "status").read_text("utf-8"):
                rank = re.search(rb"OMPI_COMM_WORLD_RANK=(\d+)", (entry / "environ").read_bytes())
                if rank:
                    found[int(rank[1])] = int(entry.name)
        except OSError:
            pass
    return found


def is_running(process):
    """Whether a process has not ended yet; one that waits for its parent has."""
    try:
        return not re.search(r"^State:\tZ", Path(f"/proc/{process}/status").read_text("utf-8"), re.MULTILINE)
    except OSError:
        return False


class RanksTest(ProgramTest):
    """The program under mpiexec."""
    timeout = 600
    # Addresses that MPI and its libraries take before the program begins [kB].
    begun = 500000

    def assert_near(self, found, expected, what, scale=()):
        """Checks numbers against the largest of them, and of the scale's."""
        largest = max(map(abs, [*expected, *scale]), default=0.0)
        self.assert_close(found, expected, TOLERANCE*largest, what)

    def assert_same(self, name, found, expected):
        """Checks a result against that of the serial program. Statuses may differ where a point is on its bound."""
        one, other = self.result(name, expected), self.result(name, found)
        self.assert_near(other.forces, one.forces, f"{name}: forces")
        grids = [read_vtu((self.directory / folder / f"{name}.vtu").read_bytes())[0] for folder in (found, expected)]
        displacements = [[u for node in grid["displacement"] for u in node] for grid in grids]
        self.assert_near(*displacements, f"{name}: displacement")
        self.assert_near(other["slip"], one["slip"], f"{name}: slip", scale=displacements[1])
        self.assertTrue(other.summary["certificate"]["passed"], name)

    def assert_same_rows(self, name, found, expected):
        """Checks the numbers of a table of cases, column by column."""
        tables = [list(csv.DictReader((self.directory / folder / name).read_text(encoding="utf-8").splitlines()))
                  for folder in (found, expected)]
        for column in tables[1][0]:
            one, other = ([row[column] for row in table] for table in reversed(tables))
            if column not in WAYS and all(map(NUMBER.fullmatch, one)):
                self.assert_near(list(map(float, other)), list(map(float, one)), f"{name}: {column}")


class SameAnswers(RanksTest):
    """Every deck on 1, 2 and 4 ranks against the program on one."""

    def test_every_deck_on_one_two_and_four_ranks(self):
        for folder in FOLDERS:
            decks = sorted(folder.glob("*.nml"))
            expected = f"{folder.name}_serial"
            serial = self.run_command([PROGRAM, "--output", expected, *map(str, decks)])
            for ranks in (1, 2, 4):
                with self.subTest(folder=folder.name, ranks=ranks):
                    found = f"{folder.name}_{ranks}"
                    run = self.run_command(launched(ranks, "--output", found, *SPREAD, *decks))
                    self.assertEqual(run.stderr, serial.stderr)
                    alone = {path.stem for path in (self.directory / found).glob("*.lst")
                             if "Factorization       distributed" not in path.read_text("utf-8")}
                    self.assertLessEqual(alone, NOTHING_TO_SPREAD)
                    for grid in sorted((self.directory / expected).glob("*.contact.vtu")):
                        self.assert_same(grid.name.removesuffix(".contact.vtu"), found, expected)
                    for table in sorted((self.directory / expected).glob("*.sweep.csv")):
                        self.assert_same_rows(table.name, found, expected)

    def test_springs_whose_elements_belong_to_other_ranks(self):
        # Rank 0 has all springs, of four ranks no element.
        for element in ("quad4", "tri6"):
            springs = "support set = 'right'  spring_n = 5.0  spring_t = 1.0"
            mesh = f"size = 4.0, 2.0  cells = 12, 6  element = '{element}'"
            deck = self.write("case.nml", block(springs, PRESSURE, CONTACT, mesh=mesh))
            self.run_command([PROGRAM, "--output", "one", deck])
            for ranks in (2, 4):
                with self.subTest(element=element, ranks=ranks):
                    self.run_command(launched(ranks, "--output", f"on_{ranks}", *SPREAD, deck))
                    self.assert_same("case", f"on_{ranks}", "one")

    def test_history_refinement_and_bodies_that_decks_share(self):
        history = block(SUPPORT, "load name = 'p'  set = 'top'  pressure = 1.0", CONTACT,
                        "history times = 0.0, 1.0, 2.0  substeps = 4", "steps load = 'p'  factor = 0.0, 1.0, 0.5")
        # A rigid set and a preload that are driven by forces, then locked, and moved apart by a load.
        locked = block("mesh name = 'b'  size = 4.0, 1.0  cells = 6, 3  origin = 0.0, 2.0",
                       CONTACT.replace("bottom", "a.bottom"),
                       "preload name = 'cut'  set = 'b.bottom'  to = 'a.top'  shortening = 0.001",
                       "rigid name = 'p'  set = 'b.top'  force = 0.3, -5.0  moment = 0.4  lock_time = 1.0",
                       "load name = 'w'  set = 'a.right'  pressure = 1.0",
                       "history times = 0.0, 1.0, 2.0  substeps = 2",
                       "steps load = 'p'  factor = 0.0, 1.0, 0.0", "steps load = 'w'  factor = 0.0, 0.0, 1.0",
                       mesh="name = 'a'  size = 4.0, 2.0  cells = 8, 4")
        decks = [self.write("cycle.nml", history), self.write("locked.nml", locked),
                 self.write("finer.nml", block(SUPPORT, PRESSURE, CONTACT, "accuracy refinements = 2")),
                 *(self.write(f"pressed_{p}.nml", block(SUPPORT, f"load set = 'top'  pressure = {p}.0", CONTACT))
                   for p in (1, 2))]
        self.run_command([PROGRAM, "--output", "one", *decks])
        self.run_command(launched(3, "--output", "three", *SPREAD, *decks))
        for deck in decks:
            self.assert_same(deck.removesuffix(".nml"), "three", "one")
        self.assertIn("shared with case pressed_1", (self.directory / "three/pressed_2.lst").read_text("utf-8"))
        for verified in ([PROGRAM], launched(2)):
            self.run_command([*verified, "--verify", "three"])

    def test_histories_in_which_the_law_leaves_a_choice_are_verified(self):
        # Before the first load nothing presses: rounding chooses statuses and slips, and where a warm body hovers.
        steps = ("history times = 0.0, 1.0, 2.0  substeps = 2", "steps load = 'p'  factor = 0.0, 1.0, 0.5",
                 "output points_every = 1  states_every = 1")
        load = "load name = 'p'  set = '{}top'  pressure = 1.0"
        heat = "load temperature = -20.0  temperature_slope = 1.0, 2.0"
        material = "young = 1000.0  poisson = 0.25  expansion = 1e-5"
        groups = (SUPPORT, load.format(""), CONTACT, *steps)
        stack = block("mesh name = 'b'  size = 4.0, 1.0  cells = 5, 2  origin = 0.0, 2.0",
                      SUPPORT.replace("left", "a.left"), SUPPORT.replace("left", "b.left"), load.format("b."),
                      "contact set = 'b.bottom'  against = 'a.top'  friction = 0.3",
                      CONTACT.replace("bottom", "a.bottom"), *steps, mesh="name = 'a'  size = 4.0, 2.0  cells = 8, 4")
        decks = [self.write(f"{name}.nml", text) for name, text in
                 (("cold", block(*groups)), ("warm", block(*groups, heat, material=material)), ("stack", stack))]
        for ranks in (1, 3):
            self.run_command(launched(ranks, "--output", f"on_{ranks}", *SPREAD, *decks))
            for verified in ([PROGRAM], launched(2)):
                self.run_command([*verified, "--verify", f"on_{ranks}"])


class OneProgram(RanksTest):
    """Whatever the number of ranks, rank 0 alone reads, prints and writes."""

    def test_messages_of_bad_decks_are_printed_once(self):
        decks = sorted((ROOT / "tests/bad").glob("*.nml"))
        for arguments in (["--output", "out", *decks], ["--chek", "case.nml"], [], ["missing.nml"], ["--help"]):
            one, three = (self.run_command(command, None)
                          for command in ([PROGRAM, *map(str, arguments)], launched(3, *arguments)))
            self.assertEqual((three.stdout, three.stderr, three.returncode), (one.stdout, one.stderr, one.returncode))

    def test_small_bodies_stay_on_one_rank_and_large_ones_do_not(self):
        for cells, kind in ("8, 4", "band"), ("100, 60", "distributed"):
            deck = self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, mesh=f"size = 4.0, 2.0  cells = {cells}"))
            told = self.run_command(launched(2, "--check", deck)).stdout
            self.assertIn(f", {kind} factor of ", told)
            self.assertEqual(" MB of memory on each of 2 ranks at most\n" in told, kind == "distributed")

    def test_deck_on_standard_input(self):
        run = subprocess.run(launched(2, *SPREAD, "-"), input=block(SUPPORT, PRESSURE, CONTACT), cwd=self.directory,
                             capture_output=True, encoding="utf-8", timeout=self.timeout, check=True)
        self.assertTrue(run.stdout.startswith("stdin: solved"), run.stdout)


class Refusals(RanksTest):
    """What no factorization gets over is said once, with status 2 or 3, and leaves no files."""

    def assert_refused(self, run, status, message):
        """Checks the end of a run."""
        self.assertRegex(run.stderr, message)
        self.assertEqual((run.stderr.count("\n"), run.returncode), (1, status))
        self.assertFalse((self.directory / "out").exists())

    def run_limited(self, cells, limits):
        """Solves a square on ranks whose addresses are limited [kB]; 0 for no limit."""
        mesh = f"size = 4.0, 4.0  cells = {cells}, {cells}"
        deck = self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, mesh=mesh))
        limited = f'limits=({" ".join(map(str, limits))}); limit=${{limits[$OMPI_COMM_WORLD_RANK]}}; ' \
                  '[[ $limit == 0 ]] || ulimit -v "$limit"; exec "$@"'
        command = launched(len(limits), "--output", "out", deck)
        at = command.index(PROGRAM)
        return self.run_command([*command[:at], "bash", "-c", limited, "bash", *command[at:]], None)

    def test_memory_of_one_rank_does_not_suffice(self):
        for cells, ranks, what in ((300, 2, "the distributed factor"), (800, 2, "the assembly of the stiffness"),
                                   (300, 3, "the distributed factor")):
            for limited in range(1, ranks):
                with self.subTest(cells=cells, ranks=ranks, limited=limited):
                    run = self.run_limited(cells, [self.begun if rank == limited else 0 for rank in range(ranks)])
                    self.assert_refused(run, 3, rf"^case\.nml: memory does not suffice: {what} needs \d+ MB on the "
                                        rf"machine of rank {limited}, and \d+ MB are available; use more machines\n$")

    def test_memory_that_just_suffices_or_just_does_not(self):
        # Whichever step it is that lacks memory: a sentence, or all files.
        ended = set()
        for limit in range(self.begun, self.begun*3//2, self.begun//16):
            with self.subTest(limit=limit):
                run = self.run_limited(260, [0, limit])
                ended.add(run.returncode)
                if run.returncode == 0:
                    self.assertEqual(sorted(path.name for path in (self.directory / "out").iterdir()),
                                     sorted(results_of("case")))
                    shutil.rmtree(self.directory / "out")
                else:
                    self.assert_refused(run, 3, r"^case\.nml: memory ")
        self.assertEqual(ended, {0, 3})

    def test_singular_stiffness_is_refused_or_marked(self):
        # Which of them depends on rounding, and on what it leaves of the loads, which may drive the body on.
        for height in (1e14, 1e16):
            deck = self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, mesh=f"size = 1.0, {height}  cells = 8, 4"))
            run = self.run_command(launched(3, "--quiet", "--output", "out", *SPREAD, deck), None)
            if run.returncode == 4:
                self.assertIn("the stiffness is ill-conditioned", (self.directory / "out/case.lst").read_text("utf-8"))
            elif "no equilibrium: " in run.stderr:
                self.assertEqual(run.returncode, 2)
            else:
                self.assert_refused(run, 2, r"^case\.nml: the stiffness is singular to rounding(: the distributed "
                                    r"factorization met a pivot that is not positive| at the node .* times as long "
                                    r"as wide)\n$")
            shutil.rmtree(self.directory / "out", ignore_errors=True)

    def test_factor_of_rounding_errors_is_refused(self):
        # MUMPS takes any pivot but 0. A spring below the rounding errors is all that keeps the block from turning.
        groups = ("support point = 0.0, 0.0  ux = 0.0  uy = 0.0", "support set = 'left'  spring_n = 1e-16", PRESSURE)
        for cells in ("8, 4", "30, 15", "60, 40"):
            deck = self.write("case.nml", block(*groups, mesh=f"size = 4.0, 2.0  cells = {cells}"))
            for command in ([PROGRAM], launched(2), launched(3)):
                run = self.run_command([*command, "--quiet", "--output", "out", *SPREAD*(len(command) > 1), deck], None)
                self.assert_refused(run, 2, "^case\\.nml: the stiffness is singular to rounding at the node .*; the "
                                    "stiffness of springs and that of the body differ by a factor of \\de1\\d\n$")

    def test_hinges_are_free_motions(self):
        for name, places, groups in (("held", ((0, -1), (1, 0)), HELD), ("free", ((0, 0), (1, 1)), (
                "load set = 'LID1'  pressure = 10.0", "contact set = 'FLOOR1'  friction = 0.3"))):
            self.write("blocks.inp", blocks(8, places))
            deck = self.write(f"{name}.nml", deck_of_blocks(*groups))
            one = self.run_command([PROGRAM, "--quiet", "--output", "one", deck], None)
            two = self.run_command(launched(2, "--quiet", "--output", "two", *SPREAD, deck), None)
            self.assertEqual((two.returncode, two.stderr), (one.returncode, one.stderr))
            if name == "held":
                self.assert_same(name, "two", "one")


class Kills(RanksTest):
    """A rank that is killed ends all; files are whole or absent."""
    least_ended, most_attempts = 8, 60

    def test_killed_ranks_leave_whole_files_or_none(self):
        deck = self.write("case.nml", block(SUPPORT, PRESSURE, CONTACT, mesh="size = 4.0, 4.0  cells = 150, 150"))
        begin = time.monotonic()
        self.run_command(launched(3, "--output", "out", deck))
        duration = time.monotonic() - begin
        whole = self.measures()
        shutil.rmtree(self.directory / "out")
        choice = random.Random(19)
        n_ended = 0
        for attempt in range(self.most_attempts):
            number = choice.randrange(3)
            with self.subTest(attempt=attempt, number=number):
                # How long a run takes is what the last one that came to its end took: a machine has other work, too.
                begin = time.monotonic()
                is_ended = self.end_rank(deck, number, duration*choice.uniform(0.1, 1.0))
                if not is_ended:
                    duration = time.monotonic() - begin
                n_ended += is_ended
                self.check_files(whole, not is_ended)
            shutil.rmtree(self.directory / "out", ignore_errors=True)
            if n_ended == self.least_ended:
                break
        self.assertEqual(n_ended, self.least_ended, "kills came too late")

    def end_rank(self, deck, number, delay):
        """Kills a rank of a run after a while. Returns whether that has ended the run."""
        command = [word for word in launched(3, "--output", "out", deck) if word != "--quiet"]
        with subprocess.Popen(command, cwd=self.directory, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            time.sleep(delay)
            ranks = ranks_of(run)
            if number in ranks:
                os.kill(ranks[number], signal.SIGKILL)
            try:
                told = b"".join(run.communicate(timeout=self.timeout))
            except subprocess.TimeoutExpired:
                run.kill()
                raise
        if run.returncode != 0:
            # Where the job is ending already, mpiexec has a shorter sentence.
            self.assertRegex(told, rb"process rank %d .* exited on signal 9|1 process returned\na non-zero exit code"
                             % number)
        # The kernel may still be taking down what mpiexec has killed.
        deadline = time.monotonic() + self.timeout
        while any(is_running(process) for process in ranks.values()):
            self.assertLess(time.monotonic(), deadline, "ranks that outlive mpiexec")
            time.sleep(0.01)
        return run.returncode != 0

    def measures(self):
        """What is the same of whole files of all runs: sizes of grids, numbers of lines of tables, the rest's ends."""
        found = {}
        for path in sorted(self.directory.glob("out/case.*")):
            content = path.read_bytes()
            found[path.name] = len(content) if path.suffix == ".vtu" else \
                content.count(b"\n") if path.suffix == ".csv" else content[-2:]
        return found

    def check_files(self, whole, are_all):
        """Checks that files are whole. Files are renamed one after the other, and nobody cleans up behind a rank that
        is killed: temporary files may be left, and where the rank that writes is the killed one, some of the files. It
        may be any: mpiexec kills rank 0 for another's sake where that has not ended a second after it was asked to."""
        found = {name: measure for name, measure in self.measures().items() if not name.endswith(".tmp")}
        self.assertEqual(found, {name: whole[name] for name in found})
        if are_all:
            self.assertEqual(sorted(found), sorted(whole))
        if found.keys() == whole.keys():
            self.run_command([PROGRAM, "--verify", "out"])


if __name__ == "__main__":
    unittest.main()
