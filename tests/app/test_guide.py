#!/usr/bin/env python3
"""The user guide: its example works, and its messages are those that the program prints. The commands of the README and
of the page on decks print what these show.

Behind a message in a table stands a comment on where it comes from, before a file a comment with its name,

    <!-- raised by: ARGUMENTS; status N -->     what the program is run with, and its exit status, 1 if it is not named;
                                                a comment may not contain two hyphens: an en dash stands for them
    <!-- in: MODULE -->                         the module that has its words, where it cannot be raised at will
    <!-- file: NAME -->                         what the reader is to write into a file

and a message stands in what the program prints, or in the listing. An ellipsis stands for anything.
"""
import importlib.util
import re
import shutil
import unittest
from pathlib import Path

from harness import PROGRAM, ProgramTest

ROOT = Path(__file__).resolve().parents[2]
MESSAGE = re.compile(r"^\| `([^`\n]+)` <!-- (raised by|in): (.*?)(?:; status (\d))? --> \| ", re.MULTILINE)
FILE = re.compile(r"<!-- file: (.*?) -->\n```\w+\n(.*?)```", re.DOTALL)
CONSOLE = re.compile(r"^```console\n(.*?)^```", re.DOTALL | re.MULTILINE)
# The deck whose faults the page on decks shows.
FAULTS = """&mesh cels = 4, 4 /
&material young = 1.0  poisson = 0.5 /
&suport set = 'right'  ux = 0.0 /
&load set = 'top'  pressure = 1.0 /
&contact set = 'bottom'  friction = -0.3 /
"""
# The commands whose output is compared; one with a remark shows nothing that it prints.
DONE_HERE = re.compile(r"((build/release/bin/)?amontons|scripts/(plot|report)\.sh) [^#]*")
NUMBER = re.compile(r"\d+(\.\d+)?(e-?\d+)?")


class Guide(ProgramTest):
    """The messages and files of doc/guide.md that have a comment."""

    def setUp(self):
        super().setUp()
        self.text = (ROOT / "doc" / "guide.md").read_text(encoding="utf-8")
        self.messages = MESSAGE.findall(self.text)
        self.files = FILE.findall(self.text)

    def messages_by(self, kind):
        """Message, origin and status of the messages whose comments are of a kind."""
        return [(message, origin.replace("\u2013", "--"), status)
                for message, found, origin, status in self.messages if found == kind]

    def assert_has(self, text, message):
        """Checks that a text has a message, in which an ellipsis stands for anything."""
        pattern = ".*?".join(map(re.escape, message.strip().split("\u2026")))
        self.assertRegex(text, re.compile(pattern, re.DOTALL))

    def mesh_parts(self):
        """Makes the meshes of the guide's two parts, as it says."""
        for dimension, name in (("-2", "foot"), ("-3", "bearing")):
            self.run_command(["gmsh", dimension, "-order", "2", f"{name}.geo"])

    def test_every_comment_belongs_to_a_message_or_a_file(self):
        self.assertEqual(len(self.messages) + len(self.files), self.text.count("<!-- "))
        self.assertGreater(len(self.messages_by("raised by")), 20)
        self.assertEqual([text for text in re.findall(r"<!-- (.*?) -->", self.text) if "--" in text], [])

    def test_messages_are_raised(self):
        for name in ("tests", "input"):
            (self.directory / name).symlink_to(ROOT / name)
        for message, arguments, status in self.messages_by("raised by"):
            with self.subTest(arguments=arguments):
                output = [] if arguments.startswith("--verify") else ["--output=results"]
                run = self.run_program(*output, *arguments.split(), status=int(status or 1))
                listings = [file.read_text(encoding="utf-8") for file in self.directory.glob("results/*.lst")]
                shutil.rmtree(self.directory / "results", ignore_errors=True)
                self.assert_has("\n".join([run.stdout, run.stderr, *listings]), message)

    def test_messages_are_in_the_sources(self):
        for message, module, _ in self.messages_by("in"):
            with self.subTest(module=module, message=message):
                source = next((ROOT / "src").rglob(module + ".f90"))
                self.assert_has(source.read_text(encoding="utf-8"), message)

    @unittest.skipIf(shutil.which("gmsh") is None, "Gmsh is not installed")
    def test_consoles_show_all_that_is_printed(self):
        (self.directory / "input").symlink_to(ROOT / "input")
        self.write("faults.nml", FAULTS)
        for page, least in (("README.md", 2), ("doc/decks.md", 3), ("doc/guide.md", 8)):
            text = (ROOT / page).read_text(encoding="utf-8")
            for name, content in FILE.findall(text):
                self.write(name, content)
            if (self.directory / "foot.geo").exists():
                self.mesh_parts()
            runs = [line.partition("\n") for console in CONSOLE.findall(text)
                    for line in re.split(r"^\$ ", console, flags=re.MULTILINE)]
            runs = [(command.split(), shown) for command, _, shown in runs if DONE_HERE.fullmatch(command)]
            self.assertGreaterEqual(len(runs), least, page)
            for (command, *arguments), shown in runs:
                if command.endswith("amontons"):
                    printed = self.run_program(*arguments, status=1 if shown.startswith(f"{arguments[-1]}:") else 0)
                elif importlib.util.find_spec("matplotlib"):
                    printed = self.run_package(Path(command).stem, *arguments)
                else:
                    continue
                # Another version of Gmsh makes another mesh, and residuals are rounding: any number stands for another.
                self.assertEqual(*(NUMBER.sub("#", text) for text in (printed.stdout + printed.stderr, shown)))

    def test_groups_in_the_pages_have_known_keys_and_values_in_range(self):
        # What an excerpt leaves out, a deck lacks; some show one group in several ways.
        lacking = re.compile("needs |is given in line|no load has the name|cannot read this file")
        n_found = 0
        for page in (ROOT / "README.md", *sorted((ROOT / "doc").glob("*.md"))):
            for block in re.findall(r"^```(?:fortran)?\n([&!].*?)^```", page.read_text(encoding="utf-8"),
                                    re.DOTALL | re.MULTILINE):
                n_found += 1
                run = self.run_command([PROGRAM, "--check", self.write("excerpt.nml", block)], status=None)
                self.assertEqual([line for line in run.stderr.splitlines() if not lacking.search(line)], [], block)
        self.assertGreater(n_found, 15)

    @unittest.skipIf(shutil.which("gmsh") is None, "Gmsh is not installed")
    def test_example_works(self):
        for name, content in self.files:
            self.write(name, content)
        self.mesh_parts()
        for name in ("foot", "bearing"):
            self.assertRegex(self.run_program("--check", f"{name}.nml").stdout, rf"^{name}: deck OK; \d+ nodes, ")
        run = self.run_program("--output", "results", "foot.nml")
        # Another version of Gmsh makes another mesh: what the guide says of the sole, to an element's side or two.
        lengths = self.result("foot", "results").lengths
        self.assert_close(lengths, [8.0, 8.7, 10.7], 1.0, run.stdout)


if __name__ == "__main__":
    unittest.main()
