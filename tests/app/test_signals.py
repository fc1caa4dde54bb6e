#!/usr/bin/env python3
"""Signals, kills and other runs at any moment: every file is the whole old one or the whole new one."""
import itertools
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

from harness import CONTACT, PROGRAM, SUPPORT, ProgramTest, block

# Every signal that ends a process and that it can be told of, the two that only end a write left out.
ENDS = [number for number in (*signal.valid_signals(), signal.SIGTERM, signal.SIGINT) if number not in (
    signal.SIGKILL, signal.SIGSTOP, signal.SIGTSTP, signal.SIGTTIN, signal.SIGTTOU, signal.SIGCONT, signal.SIGCHLD,
    signal.SIGURG, signal.SIGWINCH, signal.SIGPIPE, signal.SIGXFSZ)]


def no_cores():
    """Has a signal that would leave a core leave none."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Signals(ProgramTest):
    """A signal ends the program as usual, and each result is the whole old one or the whole new one."""

    def solved(self, pressure, cells):
        """A deck of a size that takes a while, and what it leaves, the times aside."""
        deck = block(SUPPORT, f"load set = 'top'  pressure = {pressure}", CONTACT,
                     mesh=f"size = 4.0, 2.0  cells = {cells}, {cells//2}")
        self.run_program("--quiet", "--output", f"at {pressure}", self.write("case.nml", deck))
        return self.found(f"at {pressure}")

    def found(self, directory="results"):
        """What a run left, the times aside."""
        return {name: self.key(name, content) for name, content in self.contents(directory).items()}

    @staticmethod
    def key(name, content):
        """What of a file is the same in every run."""
        if name.endswith("summary.json"):
            return content.partition(b'"seconds"')[0]
        return content.partition(b"Time [s]")[0] if name.endswith(".lst") else content

    def test_signals_at_any_moment(self):
        choice = random.Random(1785)
        cells = 48
        old = self.solved(1.0, cells)
        begin = time.monotonic()
        new = self.solved(2.0, cells)
        duration = time.monotonic() - begin
        for name in old:
            self.assertNotEqual(old[name], new[name], name)
        ended = set()
        # Until the program has begun, the address sanitizer would have these signals end in its reports.
        environment = dict(os.environ, ASAN_OPTIONS="handle_segv=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill=0")
        # Until these have ended the program before its end, however fast the machine is from one run to the next.
        for i in itertools.count():
            if i >= 200 and ended > {-signal.SIGTERM, -signal.SIGINT, -signal.SIGQUIT}:
                break
            shutil.rmtree(self.directory / "results", ignore_errors=True)
            shutil.copytree(self.directory / "at 1.0", self.directory / "results")
            number = ENDS[i//2 % len(ENDS)]
            run = subprocess.Popen([PROGRAM, "--quiet", "--output", "results", "case.nml"], cwd=self.directory,
                                   stderr=subprocess.DEVNULL, preexec_fn=no_cores, env=environment)
            self.addCleanup(run.kill)
            if i % 2:
                # While the files are written.
                deadline = time.monotonic() + self.timeout
                while run.poll() is None and time.monotonic() < deadline:
                    if len(os.listdir(self.directory / "results")) > len(old):
                        break
                    time.sleep(0.0002)
                time.sleep(0.1*duration*10.0**choice.uniform(-2.0, 0.0))
            else:
                # Before the program has begun it cannot be asked: there a signal is not yet as arranged.
                time.sleep(duration*10.0**choice.uniform(-2.0, 0.0))
            run.send_signal(number)
            ended.add(run.wait(self.timeout))
            found = self.found()
            self.assertTrue(found in (old, new), f"{number}: {sorted(found)}")
            self.assertIn(run.returncode, (0, -number))

    def test_signals_that_only_end_a_write_leave_the_program_alone(self):
        # And a child that ended, a window that changed, a stop that goes on again.
        expected = self.solved(1.0, 48)
        run = subprocess.Popen([PROGRAM, "--quiet", "--output", "results", "case.nml"], cwd=self.directory)
        self.addCleanup(run.kill)
        numbers = (signal.SIGPIPE, signal.SIGXFSZ, signal.SIGCHLD, signal.SIGWINCH, signal.SIGURG, signal.SIGSTOP,
                   signal.SIGCONT)
        # Before the program has begun a closed pipe is still the end of it.
        while run.poll() is None and not self.ignores(run, signal.SIGPIPE):
            time.sleep(0.0002)
        while run.poll() is None:
            for number in numbers:
                run.send_signal(number)
            time.sleep(0.002)
        self.assertEqual(run.returncode, 0)
        self.assertTrue(self.found() == expected)

    @staticmethod
    def ignores(run, number):
        """Whether a process ignores a signal by now."""
        status = Path(f"/proc/{run.pid}/status").read_text(encoding="utf-8")
        return int(re.search(r"^SigIgn:\s*(\w+)", status, re.MULTILINE)[1], 16) >> number - 1 & 1

    def test_killed_while_it_writes(self):
        # Nobody cleans up behind SIGKILL. Every file is whole; what is left under temporary names harms no later run.
        choice = random.Random(1699)
        old = self.solved(1.0, 48)
        new = self.solved(2.0, 48)
        shutil.copytree(self.directory / "at 1.0", self.directory / "results")
        left = set()
        # Until a temporary file was left, however late the kills come.
        for i in itertools.count():
            if i >= 20 and left:
                break
            run = subprocess.Popen([PROGRAM, "--quiet", "--output", "results", "case.nml"], cwd=self.directory)
            self.addCleanup(run.kill)
            while run.poll() is None and set(os.listdir(self.directory / "results")) <= set(old) | left:
                time.sleep(0.0002)
            time.sleep(10.0**choice.uniform(-5.0, -2.3))
            run.kill()
            run.wait()
            for name, content in self.contents("results").items():
                if name.endswith(".tmp"):
                    left.add(name)
                else:
                    self.assertTrue(self.key(name, content) in (old[name], new[name]), name)
        self.run_program("--quiet", "--output", "results", "case.nml")
        self.assertTrue({name: content for name, content in self.found().items() if name not in left} == new)

    def test_two_runs_of_a_case_leave_the_files_of_one(self):
        decks = {}
        sets = []
        for pressure in (1.0, 2.0):
            sets.append(self.solved(pressure, 16))
            (self.directory / f"deck at {pressure}").mkdir()
            decks[pressure] = f"deck at {pressure}/case.nml"
            (self.directory / "case.nml").rename(self.directory / decks[pressure])
        for _ in range(20):
            runs = [subprocess.Popen([PROGRAM, "--quiet", "--output", "results", deck], cwd=self.directory)
                    for deck in decks.values()]
            self.assertEqual([run.wait(self.timeout) for run in runs], [0, 0])
            found = self.found()
            for name in found:
                if name.endswith(".lst"):
                    found[name] = found[name].replace(b"deck at 1.0/", b"").replace(b"deck at 2.0/", b"")
            self.assertTrue(found in sets, "the files are of both runs")

    def test_signal_that_is_ignored_stays_so(self):
        self.solved(1.0, 80)
        with subprocess.Popen(["sh", "-c", 'trap "" INT HUP; echo; exec "$0" --quiet case.nml', PROGRAM],
                              cwd=self.directory, stdout=subprocess.PIPE) as run:
            self.addCleanup(run.kill)
            run.stdout.readline()
            while run.poll() is None:
                run.send_signal(signal.SIGINT)
                time.sleep(0.01)
            self.assertEqual(run.returncode, 0)


if __name__ == "__main__":
    unittest.main()
