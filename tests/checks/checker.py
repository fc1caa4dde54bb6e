"""Runs a checker of scripts/dev on a small tree of files. Standard library only."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts" / "dev"


class CheckerTest(unittest.TestCase):
    """A scratch folder that takes the place of the repository."""
    script = ""  # name of the checker

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="amontons_")
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name)

    def write(self, name, text):
        """Writes a file of the tree."""
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def run_checker(self):
        """Runs the checker on the tree."""
        return subprocess.run([sys.executable, "-B", SCRIPTS / self.script, self.root], capture_output=True,
                              encoding="utf-8", check=False)

    def assert_finds(self, *faults):
        """Checks that the checker prints these faults, in any order, and no others."""
        run = self.run_checker()
        self.assertEqual(run.stderr, "")
        self.assertEqual(sorted(run.stdout.splitlines()), sorted(faults))
        self.assertEqual(run.returncode, 1 if faults else 0)
