"""Sweeps over several ranks of MPI: the rows of one rank, whoever solved them and whatever became of a rank."""
import itertools
import math
import os
import random
import signal
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
        return {"held": block(SUPPORT, PRESSED, PUSHED, CONTACT, *QUANTITIES),
                "loose": block(PRESSED, PUSHED, CONTACT, *QUANTITIES),
                "cells": block(PRESSED, PUSHED, f"{CONTACT}  multipliers = 'constant'", *QUANTITIES, mesh=quadratic),
                "psor": block(SUPPORT, PRESSED, PUSHED, CONTACT,
                              "solver method = 'psor'  omega = 1.2  tolerance = 1e-8", *QUANTITIES),
                "stack": stack, "ring": turned}

    def test_rows_are_those_of_one_rank_to_the_last_byte(self):
        decks = [self.write(f"{name}.nml", text) for name, text in self.decks().items()]
        self.run_command([PROGRAM, "--output", "on_1", *decks])
        for name in ("loose", "ring"):
            table = (self.directory / f"on_1/{name}.sweep.csv").read_text("utf-8")
            self.assertTrue(",converged," in table and ",no_equilibrium," in table, name)
        for ranks in (2, 3, 4):
            self.run_command(launched(ranks, "--output", f"on_{ranks}", *decks))
            for deck in decks:
                with self.subTest(deck=deck, ranks=ranks):
                    table = deck.replace(".nml", ".sweep.csv")
                    self.assertEqual(*((self.directory / f"on_{n}" / table).read_bytes() for n in (1, ranks)))

    def test_rows_of_a_body_that_is_spread(self):
        deck = self.write("held.nml", self.decks()["held"])
        self.run_command([PROGRAM, "--output", "on_1", deck])
        for ranks in (2, 3):
            self.run_command(launched(ranks, "--output", f"on_{ranks}", *SPREAD, deck))
            self.assert_same_rows("held.sweep.csv", f"on_{ranks}", "on_1")

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


if __name__ == "__main__":
    unittest.main()
