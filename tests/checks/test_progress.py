"""What helpers/progress.sh and count_tests.py show of commands that print nothing for a while."""
import subprocess
import sys
import unittest

from checker import SCRIPTS, CheckerTest

HELPER = SCRIPTS.parent / "helpers/progress.sh"
CTEST = "      Start  7: slow\n"


class Progress(CheckerTest):
    """Commands that are silent for longer than ten seconds."""

    def test_silence_is_broken_every_ten_seconds(self):
        shown = []
        for command, text in (([HELPER, self.root / "log", "checking"], "other words, not"),
                              ([HELPER, self.root / "log_2"], "  [ 37/240] Building src/room/module.f90.o\n"),
                              ([sys.executable, "-B", SCRIPTS / "count_tests.py", "--follow"], CTEST)):
            run = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   encoding="utf-8")
            run.stdin.write(text)
            run.stdin.flush()
            shown.append((run, text))
        lines = [run.stdout.readline() for run, _ in shown]
        for run, _ in shown:
            run.communicate(" all\n")
            self.assertEqual(run.returncode, 0)
        self.assertRegex(lines[0], r"^checking, 1\d s$")
        self.assertRegex(lines[1], r"^\[ 37/240\] module.f90.o(, 1\d s)?$")
        self.assertRegex(lines[2], r"^0 passed so far; running: slow$")
        self.assertEqual((self.root / "log").read_text(encoding="utf-8"), "other words, not all\n")


if __name__ == "__main__":
    unittest.main()
