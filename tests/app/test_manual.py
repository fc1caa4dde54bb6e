#!/usr/bin/env python3
"""What helps at the shell: the manual page and the completion tell the options that the program has."""
import re
import shutil
import subprocess
import unittest
from pathlib import Path

from harness import PROGRAM, SUFFIXES, ProgramTest

ROOT = Path(__file__).resolve().parents[2]
MANUAL = ROOT / "doc" / "amontons.1"
COMPLETION = ROOT / "doc" / "amontons.bash"


class Manual(ProgramTest):
    """The manual page."""

    def options_of_help(self):
        """The options that --help tells, without values."""
        return re.findall(r"^  (--[a-z-]*) ", self.run_program("--help").stdout, re.MULTILINE)

    def test_every_option_file_and_status_is_told(self):
        text = MANUAL.read_text(encoding="utf-8").replace("\\-", "-")
        options = re.findall(r"^\.TP\n\.BI? (--[a-z-]*)", text, re.MULTILINE)
        self.assertEqual(options, self.options_of_help())
        for suffix in SUFFIXES:
            self.assertIn(f"NAME.{suffix}", text)
        statuses = text[text.index(".SH EXIT STATUS"):text.index(".SH SIGNALS")]
        self.assertEqual(re.findall(r"^\.B (\d)$", statuses, re.MULTILINE), list("012345"))

    def test_every_group_and_table_is_told(self):
        text = MANUAL.read_text(encoding="utf-8")
        for group in re.findall(r"^### `(&\w+)`", self.run_program("--reference").stdout, re.MULTILINE):
            self.assertTrue(re.search(rf"(?m)^\.BR? {group}\b", text), group)
        for name in ("sweep.csv", "history.csv", "history.pvd", "sweep.pvd"):
            self.assertTrue(re.search(rf"(?m)^\.IR? NAME\.{name}\b", text), name)

    def test_its_keys_are_those_of_their_groups(self):
        lines = re.findall(r"^\.B &(\w+) (.*)$", MANUAL.read_text(encoding="utf-8"), re.MULTILINE)
        self.assertGreaterEqual(len(lines), 2)
        for group, words in lines:
            known = re.findall(r"^\| \**`(\w+)`", self.run_program("--reference", group).stdout, re.MULTILINE)
            for key in re.findall(r"\w+(?= =)", words) or words.split():
                self.assertIn(key, known, group)

    def test_its_example_is_that_of_help(self):
        lines = [line.strip() for line in MANUAL.read_text(encoding="utf-8").splitlines() if line.startswith("    &")]
        self.assertEqual(lines, re.findall(r"^  (&.*)$", self.run_program("--help").stdout, re.MULTILINE))

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_it_is_set_without_warnings(self):
        run = subprocess.run(["groff", "-ww", "-man", "-Tutf8", MANUAL], capture_output=True, encoding="utf-8",
                             check=True)
        self.assertEqual(run.stderr, "")
        self.assertIn("NAME", run.stdout)


class Completion(ProgramTest):
    """The completion for bash, as the shell calls it."""

    def setUp(self):
        super().setUp()
        for name in ("block.nml", "bar.nml", "two words.nml", "w.dat", "w.lst", "mesh.msh"):
            self.write(name, "")
        (self.directory / "results").mkdir()

    def complete(self, *words):
        """What the last of these words can become behind the program's name."""
        run = self.run_command(["bash", "-c", f"""source "{COMPLETION}"; COMP_WORDS=(amontons "$@"); COMP_CWORD=$#
            _amontons "{PROGRAM}"; complete -p amontons >/dev/null
            printf '%s\n' "${{COMPREPLY[@]}}" """, "bash", *words])
        self.assertEqual(run.stderr, "")
        return sorted(line for line in run.stdout.splitlines() if line)

    def test_every_option_of_help_is_offered(self):
        options = re.findall(r"^  (--[a-z-]+) ", self.run_program("--help").stdout, re.MULTILINE)
        self.assertEqual(self.complete("-"), sorted(options))
        self.assertEqual(self.complete("block.nml", "--o"), ["--output"])

    def test_decks_and_directories(self):
        self.assertEqual(self.complete(""), ["bar.nml", "block.nml", "results", "two words.nml"])
        self.assertEqual(self.complete("b"), ["bar.nml", "block.nml"])
        self.assertEqual(self.complete("--", "bl"), ["block.nml"])

    def test_reduced_problems(self):
        self.assertEqual(self.complete("--reduced", "w"), ["w.dat"])

    def test_groups_of_the_reference(self):
        self.assertEqual(self.complete("--reference", "m"), ["material", "mesh"])
        self.assertEqual(self.complete("--reference", "mesh", "sw"), ["sweep"])

    def test_values(self):
        self.assertEqual(self.complete("--output", ""), ["results"])
        self.assertEqual(self.complete("--output", "=", "re"), ["results"])
        self.assertEqual(self.complete("--output", "="), ["results"])
        self.assertEqual(self.complete("-o", "re"), ["results"])
        for option in ("--threads", "-t", "--set"):
            self.assertEqual(self.complete(option, ""), [])
        self.assertEqual(self.complete("--", "--output", "bl"), ["block.nml"])


if __name__ == "__main__":
    unittest.main()
