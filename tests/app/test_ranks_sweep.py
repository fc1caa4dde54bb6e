"""Sweeps over several ranks of MPI: the rows of one rank, whoever solved them and whatever became of a rank."""
import itertools
import json
import math
import os
import random
import re
import signal
import subprocess
import time
import unittest

from harness import CONTACT, PROGRAM, SUPPORT, block
from test_no_equilibrium import ring
from test_ranks import SPREAD, RanksTest, launched, ranks_of
from test_sweep import PRESSED, PUSHED, SweepTest, map_of_states

# A sweep of 240 cases: three chunks and a part of a fourth.
QUANTITIES = ("sweep friction = 0.0, 1.0  count = 4", "sweep load = 'push'  factor = -2.0, 3.0  count = 20",
              "sweep load = 'press'  factor = 0.0, 3.0  count = 3")


class SweepRows(RanksTest):
    """All ranks solve rows."""

    def decks(self):
        """Sweeps of many kinds of bodies and methods."""
        wave = 0.05
        self.write("ring.msh", ring(wave))

        def rim(k):
            angle = 2*math.pi*k/48 + wave*math.sin(5*k)
            return f"{2*math.cos(angle)!r}, {2*math.sin(angle)!r}"

        stack = block("mesh name = 'upper'  size = 4.0, 1.0  cells = 6, 3  origin = 0.0, 2.0",
                      SUPPORT.replace("left", "lower.left"), "support set = 'lower.bottom'  uy = 0.0",
                      PRESSED.replace("top", "upper.top"), PUSHED.replace("right", "upper.right"),
                      "contact set = 'upper.bottom'  against = 'lower.top'  friction = 0.3", *QUANTITIES,
                      mesh="name = 'lower'  size = 4.0, 2.0  cells = 8, 4")
        turned = "\n".join([
            "&mesh kind = 'file'  file = 'ring.msh' /", "&material young = 1e3  poisson = 0.3 /",
            f"&load name = 'press'  point = {rim(36)}  force = 0.0, -1.0 /",
            f"&load name = 'push'  point = {rim(0)}  force = 0.0, -0.2 /",
            "&contact set = 'hole'  obstacle = 'circle'  point = 0.0, 0.999  radius = 0.999 /",
            *(f"&{line} /" for line in QUANTITIES), ""])
        quadratic = "size = 4.0, 2.0  cells = 8, 4  element = 'quad8'"
        strip = "size = 50.0, 1.0  cells = 100, 3"
        return {"held": block(SUPPORT, PRESSED, PUSHED, CONTACT, *QUANTITIES),
                "strip": block(SUPPORT, PRESSED, PUSHED, CONTACT, *QUANTITIES, mesh=strip),
                "loose": block(PRESSED, PUSHED, CONTACT, *QUANTITIES),
                "cells": block(PRESSED, PUSHED, f"{CONTACT}  multipliers = 'constant'", *QUANTITIES, mesh=quadratic),
                "psor": block(SUPPORT, PRESSED, PUSHED, CONTACT,
                              "solver method = 'psor'  omega = 1.2  tolerance = 1e-8", *QUANTITIES),
                "stack": stack, "ring": turned}

    def write_decks(self, names=None):
        """Writes sweeps, each with and without the key results of the whole body, and returns their names."""
        decks = self.decks()
        return [self.write(f"{name}{suffix}.nml", decks[name] + output) for name in names or decks
                for suffix, output in (("", ""), ("_all", "&output key_results = 'all' /\n"))]

    def assert_equal_rows(self, deck, ranks, n_sharing):
        """Checks that the table of a sweep is that of one rank, and how many ranks have solved its cases."""
        with self.subTest(deck=deck, ranks=ranks):
            table = deck.replace(".nml", ".sweep.csv")
            self.assertEqual(*((self.directory / f"on_{n}" / table).read_bytes() for n in (1, ranks)))
            self.assert_shared(f"on_{ranks}", deck, n_sharing)

    def assert_shared(self, folder, deck, n_sharing):
        """Checks how many ranks have solved the cases of a sweep."""
        found = re.findall(r"Solved by +(\d+) ranks", (self.directory / folder / deck.replace(".nml", ".lst"))
                           .read_text("utf-8"))
        self.assertEqual(found, [str(n_sharing)] if n_sharing > 1 else [])

    def test_rows_are_those_of_one_rank_to_the_last_byte(self):
        decks = self.write_decks()
        self.run_command([PROGRAM, "--output", "on_1", *decks])
        for name in ("loose", "ring"):
            table = (self.directory / f"on_1/{name}.sweep.csv").read_text("utf-8")
            self.assertTrue(",solved," in table and ",no_equilibrium," in table, name)
        for ranks in (2, 3, 4):
            self.run_command(launched(ranks, "--output", f"on_{ranks}", *decks))
            for deck in decks:
                self.assert_equal_rows(deck, ranks, ranks)

    def test_rows_of_a_body_that_is_spread(self):
        decks = self.write_decks(("held", "cells", "stack"))
        self.run_command([PROGRAM, "--output", "on_1", *decks])
        for ranks in (2, 3):
            self.run_command(launched(ranks, "--output", f"on_{ranks}", *SPREAD, *decks))
            for deck in decks:
                self.assert_same_rows(deck.replace(".nml", ".sweep.csv"), f"on_{ranks}", "on_1")
                self.assert_shared(f"on_{ranks}", deck, 1 if "_all" in deck else ranks)

    def test_a_rank_without_room_leaves_the_cases_to_rank_0(self):
        # 6 matrices of 1802 rows for one thread, where the limit leaves about 144 MB.
        deck = self.write("strip.nml", block(SUPPORT, PRESSED, PUSHED, CONTACT, "solver condensation = 'dense'",
                                             "sweep load = 'push'  factor = 1.0, 2.0",
                                             mesh="size = 225.0, 1.0  cells = 900, 2"))
        self.run_command([PROGRAM, "--output", "on_1", deck])
        self.run_on_second_rank(f'ulimit -v {self.begun}; exec "$@"', deck)
        self.assert_equal_rows(deck, 2, 1)

    @unittest.skipIf(subprocess.run(["unshare", "--mount", "true"], check=False, capture_output=True).returncode,
                     "may not mount a mesh of its own for a rank")
    def test_a_rank_that_reads_another_mesh_or_none_leaves_the_cases_to_rank_0(self):
        deck = self.write("ring.nml", self.decks()["ring"])
        self.run_command([PROGRAM, "--output", "on_1", deck])
        for name, text, n_sharing in (("none", "", 1), ("other", ring(0.04), 1), ("same", ring(0.05), 2)):
            self.write(name, text)
            way = f"mount --bind {name} ring.msh; exec \"$@\""
            self.run_on_second_rank(f"exec unshare --mount bash -c '{way}' bash \"$@\"", deck)
            self.assert_equal_rows(deck, 2, n_sharing)

    def run_on_second_rank(self, way, *arguments):
        """Runs the program on two ranks, the second one of which is started another way, a command of the shell."""
        command = launched(1, "--output", "on_2", *arguments)
        self.run_command([*command, ":", "-n", "1", "bash", "-c", way, "bash", *command[command.index(PROGRAM):]])

    def test_key_results_of_the_whole_body_and_fields(self):
        # The displacements of a body that is spread take all ranks, whichever thread asks for them.
        text = self.decks()["held"] + "&output key_results = 'all'  fields_every = 50 /\n"
        deck = self.write("all.nml", text)
        self.run_command([PROGRAM, "--output", "on_1", deck])
        for spread in ((), SPREAD):
            self.run_command(launched(2, "--threads", 2, "--output", "on_2", *spread, deck))
            self.assert_same_rows("all.sweep.csv", "on_2", "on_1")
            self.run_command([PROGRAM, "--verify", "on_2"])


class Interruption(SweepTest, RanksTest):
    """A sweep over ranks goes on where it was, on any number of ranks."""

    def test_killed_ranks_lose_no_byte(self):
        choice = random.Random(1988)
        self.write("sweep.nml", map_of_states(40))
        self.run_command([PROGRAM, "--quiet", "--output", "reference", "sweep.nml"])
        victims = itertools.cycle((1, 0, 2))
        n_killed = n_resumed = 0
        while n_killed < 5 or n_resumed == 0 or self.n_done() == 0:
            done = self.n_done()
            victim = next(victims)
            run = self.start_command(launched(3, "--quiet", "sweep.nml"))
            self.wait_for_rows(run, done + choice.randint(1, 500))
            ranks = ranks_of(run)
            if victim in ranks:
                os.kill(ranks[victim], signal.SIGKILL)
            run.communicate(timeout=self.timeout)
            if run.returncode == 0:
                # The kill came too late; the sweep begins anew.
                (self.directory / "sweep.sweep.csv").unlink()
                continue
            self.assertGreaterEqual(self.n_done(), done)
            n_killed += 1
            n_resumed += done > 0
        self.run_command(launched(2, "--quiet", "sweep.nml"))
        self.assertGreater(self.summary()["sweep"]["done_earlier"], 0)
        self.assertEqual(self.contents()["sweep.sweep.csv"], self.contents("reference")["sweep.sweep.csv"])

    def test_signal_to_rank_0_stops_after_the_cases_under_way(self):
        self.write("sweep.nml", map_of_states(20000))
        run = self.start_command(launched(3, "--quiet", "sweep.nml"))
        self.wait_for_rows(run, 1)
        os.kill(ranks_of(run)[0], signal.SIGINT)
        _, message = run.communicate(timeout=self.timeout)
        self.assertEqual(run.returncode, 5)
        self.assertEqual(message, f"sweep.nml: interrupted after {self.n_done()} of 4000000 cases; the same command "
                                  "goes on from there\n")

    def test_another_factorization_goes_on_with_what_is_done(self):
        # Condensed stiffnesses of one rank and of two differ in their last digits; deck and mesh are the same.
        groups = (SUPPORT, PRESSED, PUSHED, CONTACT)
        mesh = "size = 4.0, 2.0  cells = 104, 52"
        self.write("sweep.nml", block(*groups, "sweep load = 'push'  factor = -1.0, 1.0  count = 60000", mesh=mesh))
        self.write("history.nml", block(*groups, "history times = 0.0, 1.0, 2.0, 3.0  substeps = 3000",
                                        "steps load = 'press'  factor = 0.0, 1.0, 0.5, 1.0",
                                        "steps load = 'push'  factor = 0.0, 1.0, -1.0, 1.0", mesh=mesh))
        for name, grown in (("sweep", "sweep.sweep.part"), ("history", "history.history.csv.part")):
            run = self.start_command([PROGRAM, "--quiet", f"{name}.nml"])
            while run.poll() is None:
                rows = self.directory / grown
                if rows.exists() and rows.read_bytes().count(b"\n") > 3:
                    run.send_signal(signal.SIGINT)
                    break
                time.sleep(0.005)
            run.communicate(timeout=self.timeout)
            self.assertEqual(run.returncode, 5, "it was stopped")
            self.run_command(launched(2, "--quiet", f"{name}.nml"))
            self.assertIn("distributed", (self.directory / f"{name}.lst").read_text("utf-8"))
        self.assertGreater(self.summary()["sweep"]["done_earlier"], 0)
        self.assertGreater(json.loads((self.directory / "history.summary.json").read_text("utf-8"))
                           ["load_history"]["steps_done_earlier"], 0)


if __name__ == "__main__":
    unittest.main()
