#!/usr/bin/env python3
"""What a terminal shows of a run: a line that tells what it is at, gone before anything else is printed."""
import fcntl
import os
import pty
import re
import resource
import select
import signal
import struct
import subprocess
import termios
import time
import unittest

from harness import CONTACT, PRESSURE, PROGRAM, SOUND, SUPPORT, ProgramTest, block
from test_sweep import map_of_states

# No iteration gets there, and there are more of them than anybody waits for.
ENDLESS = block(SUPPORT, PRESSURE, CONTACT,
                "solver method = 'psor'  omega = 0.001  tolerance = 1.0e-16  max_iterations = 2000000000")

# What the line shows from two seconds on; on a busy machine a second may be left out.
SECONDS = r"([2-9]|[1-9]\d+) s"


def no_cores():
    """Has a signal that would leave a core leave none."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def screen_after(data):
    """The lines of a screen after what a terminal was sent, as far as it has characters, ends of lines and returns."""
    lines = [[]]
    column = 0
    for character in data.decode():
        if character == "\r":
            column = 0
        elif character == "\n":
            lines.append([])
        else:
            lines[-1] += " "*(column + 1 - len(lines[-1]))
            lines[-1][column] = character
            column += 1
    return ["".join(line).rstrip() for line in lines]


class Terminal:
    """A terminal that a program runs on, which sees both of its standard streams there."""

    def __init__(self, test, *command, columns=80, before=None, **options):
        self.test = test
        self.keyboard, screen = pty.openpty()
        test.addCleanup(os.close, self.keyboard)
        fcntl.ioctl(screen, termios.TIOCSWINSZ, struct.pack("4H", 24, columns, 0, 0))
        if before:
            before(screen)
        self.run = subprocess.Popen(command, **{"cwd": test.directory, "stdin": subprocess.DEVNULL, "stdout": screen,
                                                "stderr": screen, "preexec_fn": no_cores} | options)
        os.close(screen)
        test.addCleanup(self.run.wait)
        test.addCleanup(self.run.kill)
        self.shown = b""

    def read(self, seconds):
        """Reads what is shown, if anything is in so many seconds. Returns whether more can come."""
        if select.select([self.keyboard], [], [], seconds)[0]:
            try:
                self.shown += os.read(self.keyboard, 65536)
            except OSError:
                return False
        return True

    def wait_for(self, pattern):
        """Waits until a text is shown."""
        deadline = time.monotonic() + self.test.timeout
        while not re.search(pattern.encode(), self.shown):
            self.test.assertLess(time.monotonic(), deadline, f"{pattern} in {self.shown}")
            self.test.assertTrue(self.read(1.0), f"{pattern} in {self.shown}")

    def end(self, status):
        """Waits for the end, checks the exit status and returns the lines that are on the screen then."""
        while self.read(self.test.timeout):
            pass
        self.test.assertEqual(self.run.wait(self.test.timeout), status, self.shown)
        return screen_after(self.shown)


class Progress(ProgramTest):
    """Work of more than a second is shown on a terminal, and on nothing else."""

    def start(self, text, *arguments, name="case", **options):
        """Writes a deck and starts the program on it."""
        # One that an earlier start is about to read is not written again.
        path = self.directory / f"{name}.nml"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            self.write(path.name, text)
        return Terminal(self, PROGRAM, *arguments, path.name, **options)

    def locked(self, name):
        """Has a directory that somebody else has locked: the program waits for it for a while, two seconds and more.
        Returns what ends the lock."""
        (self.directory / name).mkdir()
        file = os.open(self.directory / name, os.O_RDONLY)
        fcntl.flock(file, fcntl.LOCK_EX)
        return lambda: os.close(file)

    def test_phase_and_seconds_are_shown_until_a_signal_ends_the_work(self):
        terminals = [self.start(ENDLESS) for _ in range(2)]
        for terminal, number in zip(terminals, (signal.SIGINT, signal.SIGTERM)):
            terminal.wait_for(r"^\rcase: \w+, [1-9]\d* s")
            terminal.wait_for(r"\rcase: solve, " + SECONDS)
            terminal.run.send_signal(number)
            self.assertEqual(terminal.end(-number), [""])

    def test_fault_is_told_on_a_line_of_its_own(self):
        terminal = self.start(ENDLESS)
        terminal.wait_for(r"solve, \d+ s")
        terminal.run.send_signal(signal.SIGSEGV)
        while terminal.read(self.timeout):
            pass
        self.assertNotEqual(terminal.run.wait(self.timeout), 0)
        self.assertNotIn("case: solve", "\n".join(screen_after(terminal.shown)))

    def test_line_is_gone_before_the_result(self):
        unlock = self.locked("results")
        terminal = self.start(SOUND, "--output", "results")
        terminal.wait_for(r"case: write, \d+ s")
        unlock()
        result, rest = terminal.end(0)
        self.assertRegex(result, r"^case: solved, \d+ iterations, .*; 9 of 9 points closed, .*$")
        self.assertEqual(rest, "")
        # And does not come back behind it.
        self.assertTrue(terminal.shown.endswith(b"\r\n"), terminal.shown)

    def test_line_is_gone_before_an_error(self):
        unlock = self.locked("results")
        (self.directory / "results" / "case.lst").mkdir()
        terminal = self.start(SOUND, "--output", "results")
        terminal.wait_for(r"case: write, \d+ s")
        unlock()
        message, rest = terminal.end(3)
        self.assertEqual(message, "case.nml: results/case.lst: cannot put this file in place: Is a directory")
        self.assertEqual(rest, "")

    def test_every_case_of_a_run_has_its_own_seconds(self):
        unlock = self.locked("results")
        self.write("first.nml", SOUND)
        terminal = self.start(SOUND, "--output", "results", "first.nml", name="second")
        terminal.wait_for(r"first: write, \d+ s")
        terminal.wait_for(r"second: write, \d+ s")
        unlock()
        self.assertEqual([line.partition(",")[0] for line in terminal.end(0)], ["first: solved", "second: solved",
                                                                                     "2 decks: 2 solved", ""])

    def test_nothing_is_shown_of_short_work(self):
        # With the second support, the body is held without contact.
        self.write("case.nml", SOUND.replace("ux = 0.0", "ux = 0.0  uy = 0.0"))
        self.run_program("--quiet", "--write-reduced", "case.nml")
        names = [name for name in self.files() if name.startswith("case.reduced.")]
        # Solved again, the case removes its reduced problems.
        for arguments in (*(["--reduced", name] for name in names), ["--check", "case.nml"], ["case.nml"]):
            seconds = 1.0
            # Where the machine has other things to do, a second may pass.
            while seconds >= 1.0:
                begin = time.monotonic()
                terminal = Terminal(self, PROGRAM, *arguments)
                terminal.end(0)
                seconds = time.monotonic() - begin
            self.assertRegex(terminal.shown.decode(), r"^case(\.reduced)?: [^\r]*\r\n$")

    def test_nothing_is_shown_without_a_terminal_or_quietly(self):
        terminal = self.start(ENDLESS, "--quiet")
        piped = self.start(ENDLESS, stderr=subprocess.PIPE)
        shown = self.start(ENDLESS)
        shown.wait_for("solve, " + SECONDS)
        for each in (terminal, piped):
            each.run.terminate()
            each.end(-signal.SIGTERM)
            self.assertEqual(each.shown, b"")
        self.assertEqual(piped.run.communicate(), (None, b""))

    def test_log_gets_lines_where_it_is_asked_for(self):
        log = self.start(ENDLESS, "--quiet", "--progress", stderr=subprocess.PIPE)
        # After 1, 2, 4 seconds; a machine that has other things to do may come late.
        shown = 0
        for due in (1, 2, 4):
            line = log.run.stderr.readline().decode()
            self.assertRegex(line, r"^case: \w+, \d+ s\n$")
            before, shown = shown, int(line.split()[-2])
            self.assertGreaterEqual(shown, max(due, before + 1))
        log.run.terminate()
        self.assertEqual(log.run.communicate(), (None, b""))
        self.assertEqual(log.run.wait(self.timeout), -signal.SIGTERM)

    def test_log_of_a_sweep_has_cases_and_seconds(self):
        log = self.start(map_of_states(20000), "--progress", stderr=subprocess.PIPE)
        # On a busy machine the first case takes more than a second.
        line = "case: solve, 1 s\n"
        while re.fullmatch(r"case: \w+, \d+ s\n", line):
            line = log.run.stderr.readline().decode()
        self.assertRegex(line, r"^case: \d+ of 4000000 cases, \d+ per second, \d+:\d\d:\d\d left, \d+ s\n$")
        for _ in range(2):
            log.run.terminate()
        log.run.communicate()

    def test_terminal_has_its_line_where_a_log_is_asked_for(self):
        terminal = self.start(ENDLESS, "--progress")
        terminal.wait_for(r"\rcase: solve, " + SECONDS + "$")
        terminal.run.terminate()
        self.assertEqual(terminal.end(-signal.SIGTERM), [""])

    def test_line_is_cut_to_the_terminal_between_two_characters(self):
        # Two bytes each, so that one of two widths ends between the bytes of one.
        narrow = {columns: self.start(ENDLESS, name="\u00e4"*20, columns=columns) for columns in (21, 22)}
        for columns, terminal in narrow.items():
            terminal.wait_for(r"\r[^\r]+\r +\r[^\r]+$")
            # The echo of Ctrl-C fits behind it.
            self.assertEqual(screen_after(terminal.shown), ["\u00e4"*((columns - 3)//2)])

    def test_terminal_that_takes_nothing_keeps_nobody(self):
        terminal = self.start(ENDLESS, before=lambda screen: termios.tcflow(screen, termios.TCOOFF))
        shown = self.start(ENDLESS)
        shown.wait_for("solve, " + SECONDS)
        terminal.run.terminate()
        self.assertEqual(terminal.run.wait(self.timeout), -signal.SIGTERM)

    def test_nothing_is_shown_in_the_background(self):
        # A shell with job control, whose terminal this is, starts the program and goes on itself.
        self.write("case.nml", ENDLESS)
        terminal = Terminal(self, "sh", "-c", 'set -m; "$0" case.nml & echo started; read line; kill -INT %1; wait; '
                            "echo ended", PROGRAM, start_new_session=True, stdin=None,
                            preexec_fn=lambda: fcntl.ioctl(1, termios.TIOCSCTTY, 0))
        terminal.wait_for("started")
        shown = self.start(ENDLESS)
        shown.wait_for("solve, " + SECONDS)
        os.write(terminal.keyboard, b"\n")
        terminal.wait_for("ended")
        self.assertNotIn(b"solve", terminal.shown)

    def test_sweep_shows_its_cases(self):
        terminal = self.start(map_of_states(20000))
        terminal.wait_for(r"\rcase: \d+ of 4000000 cases, \d+ per second, \d:\d\d:\d\d left$")
        terminal.run.send_signal(signal.SIGINT)
        self.assertRegex("\n".join(terminal.end(5)), r"^case\.nml: interrupted after \d+ of 4000000 cases; the same "
                         "command goes on from there\n$")

    def test_second_signal_ends_a_sweep_at_once(self):
        terminal = self.start(map_of_states(20000))
        terminal.wait_for(" left$")
        for number in (signal.SIGSTOP, signal.SIGINT, signal.SIGTERM, signal.SIGCONT):
            terminal.run.send_signal(number)
        self.assertEqual(terminal.end(-signal.SIGTERM), [""])

    def test_sweep_shows_its_fields(self):
        unlock = self.locked("case.sweep")
        terminal = self.start(map_of_states(3) + "&output fields_every = 200 /\n")
        terminal.wait_for(r"\rcase: [12] of 3 fields(, .* left)?$")
        unlock()
        self.assertEqual(terminal.end(0)[0].partition(",")[0], "case: 600 cases")


if __name__ == "__main__":
    unittest.main()
