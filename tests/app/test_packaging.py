#!/usr/bin/env python3
"""What packages say of the program is what it says of itself."""
import ast
import importlib
import re
import sys
import unittest
from pathlib import Path

from harness import ProgramTest

ROOT = Path(__file__).resolve().parents[2]


def text(name):
    """The text of a file of the sources."""
    return (ROOT / name).read_text(encoding="utf-8")


class Packaging(ProgramTest):
    """Versions, names and lists that stand in several files."""

    def setUp(self):
        super().setUp()
        self.version = self.run_program("--version").stdout.split()[1]

    def test_every_file_has_the_version_of_the_program(self):
        for name, pattern in (("packaging/spack/package.py", r'version\("(.*)"\)'),
                              ("packaging/conda-forge/recipe.yaml", r'^  version: "(.*)"$')):
            self.assertEqual(re.findall(pattern, text(name), re.MULTILINE), [self.version], name)
        # A wheel takes its version from where the program has it.
        pattern, = re.findall(r"^regex = '(.*)'$", text("pyproject.toml"), re.MULTILINE)
        self.assertEqual(re.search(pattern, text("CMakeLists.txt"))["value"], self.version)

    def test_citation_is_of_the_last_release(self):
        # The newest section of the changelog is that of the program, the newest dated one that of the last release.
        sections = re.findall(r"^## \[(.*)\] - (.*)$", text("CHANGELOG.md"), re.MULTILINE)
        self.assertEqual(sections[0][0], self.version)
        released = next(section for section in sections if section[1] != "Unreleased")
        self.assertEqual(re.findall(r"^(?:version|date-released): (.*)$", text("CITATION.cff"), re.MULTILINE),
                         list(released))

    def test_page_asks_for_the_present_version(self):
        for name in ("doc/library.md", "doc/examples/CMakeLists.txt"):
            self.assertEqual(re.findall(r"find_package\(amontons ([0-9.]+)", text(name)),
                             [self.version.rpartition(".")[0]], name)

    def test_commands_of_the_wheel_are_there(self):
        sys.path.insert(0, str(ROOT / "python"))
        sys.dont_write_bytecode = True
        commands = re.findall(r'^(amontons[a-z-]*) = "([a-z.]+):([a-z]+)"$', text("pyproject.toml"), re.MULTILINE)
        self.assertEqual([name for name, *_ in commands],
                         ["amontons", "amontons-plot", "amontons-report", "amontons-adapt"])
        for _, module, procedure in commands:
            self.assertTrue(callable(getattr(importlib.import_module(module), procedure)))

    def test_scripts_name_letters_by_their_class(self):
        # In a Turkish locale i is not between a and z: sections, methods and groups with an i would not be found.
        scripts = [ROOT/".ci/run", *(ROOT/"scripts").rglob("*.sh"), ROOT/"doc/amontons.bash"]
        self.assertGreater(len(scripts), 20)
        for script in scripts:
            self.assertEqual(re.findall(r"\[[^]\n]*(?:a-z|A-Z)[^]\n]*\]", script.read_text(encoding="utf-8")), [],
                             script)

    def test_recipes_are_python_and_name_options_that_exist(self):
        ast.parse(text("packaging/spack/package.py"))
        known = set(re.findall(r"(?:option|set)\((AMONTONS_[A-Z0-9_]+)", text("CMakeLists.txt")
                               + text("cmake/AmontonsInstall.cmake")))
        for name in ("packaging/spack/package.py", "packaging/conda-forge/recipe.yaml", "pyproject.toml",
                     "scripts/deb.sh"):
            self.assertLessEqual(set(re.findall(r"AMONTONS_[A-Z0-9_]+", text(name))), known, name)

    def test_container_copies_what_the_build_needs(self):
        copied = re.findall(r"^COPY ([a-z]+) ", text("packaging/Containerfile"), re.MULTILINE)
        needed = re.findall(r"^ *add_subdirectory\((\w+)\)", text("CMakeLists.txt"), re.MULTILINE)
        self.assertLessEqual({*needed, "cmake", "doc", "python", "scripts"} - {"tests"}, {*copied})


if __name__ == "__main__":
    unittest.main()
