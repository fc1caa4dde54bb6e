#!/usr/bin/env python3
"""Every name that a result file uses is explained: members of summaries, columns of tables, arrays of grids. The pages
have the words that people search for."""
import csv
import importlib.util
import json
import re
import sys
import unittest
from pathlib import Path

from harness import CONTACT, PRESSURE, SUPPORT, TWO_BODIES, ProgramTest, block, read_vtu

PAGES = Path(__file__).resolve().parents[2] / "doc"
PUSH = "load name = 'push'  set = 'right'  traction = -1.5, 0.3"
WALL = "contact set = 'left'  friction = 0.2  obstacle = 'plane'  normal = 1.0, 0.0"
DECKS = {
    "case": block(SUPPORT, PRESSURE, CONTACT, PUSH),
    "sets": block("load set = 'right'  traction = -0.5, 0.0", PRESSURE, CONTACT, WALL),
    "bound": block(SUPPORT, PRESSURE, "contact set = 'bottom'  slip_bound = 0.1", PUSH,
                   mesh="size = 4.0, 2.0  cells = 8, 4  element = 'tri3'"),
    "cells": block(SUPPORT, PRESSURE, CONTACT + "  multipliers = 'constant'  cells = 4", PUSH),
    "refined": block(SUPPORT, PRESSURE, CONTACT, PUSH, "accuracy refinements = 2"),
    "pair": TWO_BODIES,
    "sweep": block(SUPPORT, PRESSURE, CONTACT, PUSH, "sweep load = 'push'  factor = 0.5, 1.0",
                   "sweep friction = 0.2, 0.3", "output key_results = 'all'  fields_every = 1"),
    "history": block(SUPPORT, PRESSURE, CONTACT + "  wear = 1e-5", PUSH,
                     "history times = 0.0, 1.0, 2.0, 3.0  substeps = 2  cycles = 1.0, 3.0",
                     "steps load = 'push'  factor = 0.0, 1.0, 0.5, 1.0",
                     "steps obstacle = 'bottom'  shift_y = 0.0, 0.0, 0.001, 0.001",
                     "output probe = 4.0, 2.0  points_every = 2  states_every = 2  fields_every = 2"
                     "  fretting = 'parameters'"),
}
DECKS["walked"] = DECKS["history"] + "&accuracy refinements = 2 /\n"
DECKS["twisted"] = block(
    "support name = 'turned'  set = 'top'  ux = 0.0  uy = -0.01  turn = 0.001", CONTACT + "  wear = 1e-5",
    "history times = 0.0, 1.0, 2.0  substeps = 2", "steps support = 'turned'  factor = 0.0, 1.0, 0.5",
    "output probe = 4.0, 2.0  points_every = 2  states_every = 2  fields_every = 2",
    material="young = 100.0  poisson = 0.25  hypothesis = 'axisymmetric'  twist = .true.")
# What newcomers look for by name, whether there is such a thing or not.
SEARCHED = ("3D", "adhesion", "bolt", "buckling", "coupling", "creep", "cyclic symmetry", "damping",
            "dovetail", "dynamics", "frictional heat", "gasket", "hyperelastic", "impact", "interference",
            "large sliding", "macOS", "orthotropic", "plasticity", "preload", "press fit", "pull-out",
            "reaction", "restart", "roughness", "rubber", "seal", "shrink fit", "submodel", "thermal contact",
            "three dimensions", "torque", "vibration", "wear", "Windows")

# A row of a table: names, what a grid has them on, the unit.
ROW = re.compile(r"^\| (`[^|]*`) \| (?:(?:nodes|cells)[^|]*\| )?([^|`]*?) ?\| ", re.MULTILINE)


def documented(*pages):
    """Patterns of the names between backticks of some pages: words in capitals stand for names of the deck, and a name
    that begins with a dot is a member of the object named before it."""
    names, owner = set(), ""
    for page in pages:
        text = re.sub(r"^```.*?^```", "", (PAGES / page).read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        for name in re.findall(r"`([^`\s]+)`", text):
            if re.fullmatch(r"[a-z_]+\.[a-z_]+", name):
                owner = name.partition(".")[0]
                names.add(owner)
            names.add(owner + name if re.fullmatch(r"\.[a-z_]+", name) else name)
    return [re.compile(re.sub(r"[A-Z]{2,}", ".+", re.escape(name))) for name in names
            if re.fullmatch(r"[a-z][A-Za-z_0-9.]*", name)]


def section_of(page, heading):
    """A section of a page, without those within it."""
    return (PAGES / page).read_text(encoding="utf-8").partition(f"\n## {heading}\n")[2].partition("\n#")[0]


def units_of_names(text):
    """The unit in the tables of a page of each pattern of names, in L and F; a row has one for all or for each."""
    found = []
    for names, units in ROW.findall(text):
        names = re.findall(r"`([^`]+)`", names)
        units = [unit.strip().replace("none", "") for unit in units.split(", ")]
        if len(units) in (1, len(names)):
            found += [(re.compile(re.sub(r"[A-Z]{2,}", ".+", name) + r"(_\d+)?"), unit)
                      for name, unit in zip(names, units*len(names))]
    return found


def members(value, path=""):
    """The paths of all members of an object."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield f"{path}.{key}".strip(".")
            yield from members(inner, f"{path}.{key}".strip("."))
    elif isinstance(value, list):
        for inner in value:
            yield from members(inner, path)


class DocumentedNames(ProgramTest):
    """Names in files against doc/output.md and, of reduced problems, doc/library.md."""

    def assert_documented(self, names, patterns, source):
        """Checks that each name, or the last part of its path, is explained, but for numbers and axes behind it."""
        missing = set()
        for name in names:
            # Names and numbers of contact sets, probes, meshes and points; names of extremes are those of key results.
            # Those of forces end with the name of a set, which may have points in it.
            last, inner = name.rpartition(".")[2], name.partition(".")[2]
            forms = {form for known in (name, last, inner) for form in (
                known, re.sub(r"_\d+$", "", known), re.sub(r"_\d+$", "_1", known), re.sub(r"_[xy]$", "", known),
                re.sub(r"_step$", "", known), re.sub(r"_[xy]_\d+$", "", known))}
            if not any(pattern.fullmatch(form) for pattern in patterns for form in forms):
                missing.add(name)
        self.assertEqual(sorted(missing), [], f"{source}: not in the pages")

    def assert_files(self, directory, patterns):
        """Checks every file of a directory, and the folders of grids in it."""
        found = set()
        for path in sorted((self.directory / directory).rglob("*.*")):
            kind = path.name.partition(".")[2]
            if path.suffix == ".json":
                names = set(members(json.loads(path.read_text(encoding="utf-8"))))
            elif path.suffix == ".csv":
                with open(path, newline="", encoding="utf-8") as table:
                    names = next(csv.reader(table))
            elif path.suffix == ".vtu":
                names = set(read_vtu(path.read_bytes())[0]) - {"points", "connectivity", "offsets", "types"}
            else:
                continue
            found.add(kind)
            self.assert_documented(names, patterns, path.name)
        return found

    def test_names_of_every_kind_of_study(self):
        for name, deck in DECKS.items():
            self.write(f"{name}.nml", f"&case name = '{name}' /\n{deck}")
        self.run_program("--quiet", "--output", "out", *(f"{name}.nml" for name in DECKS))
        found = self.assert_files("out", documented("output.md", "theory.md"))
        # What nobody wrote would not be compared.
        self.assertLessEqual({"csv", "summary.json", "contact.csv", "convergence.csv", "sweep.csv", "history.csv",
                              "points.csv", "cycles.csv", "states.csv", "vtu", "contact.vtu"}, found)

    def test_names_of_reduced_problems_and_of_all_solutions(self):
        self.run_program("--quiet", "--output", "out", "--write-reduced", "--all-solutions", self.write(
            "case.nml", block("support set = 'top'  ux = 0.0  uy = -0.01", CONTACT, PUSH,
                              mesh="size = 4.0, 2.0  cells = 4, 2")))
        self.assertIn("solutions.csv", self.assert_files("out", documented("output.md", "theory.md")))
        self.run_program("--quiet", "--output", "reduced", "--reduced", "out/case.reduced.dat")
        self.assertIn("reduced.summary.json", self.assert_files(
            "reduced", documented("output.md", "theory.md", "library.md")))

    def test_units_in_the_tables_of_results_are_those_that_the_program_writes(self):
        table = units_of_names((PAGES / "output.md").read_text(encoding="utf-8"))
        decks = {"driven": block("rigid name = 'punch'  set = 'top'  turn = 0.0  force = 0.0, -50.0", CONTACT),
                 "bolt": TWO_BODIES.replace("&contact", "&preload name = 'bolt'  shortening = 0.1 ").replace(
                     "against", "to").replace("friction = 0.2", ""),
                 **{name: DECKS[name] for name in ("case", "sets", "pair", "history")},
                 "tied": TWO_BODIES + "&mesh name = 'c'  size = 1.0, 1.0  cells = 2, 2  origin = 4.0, 0.5 /\n"
                         "&tie set = 'c.left'  to = 'a.right' /\n"}
        decks["twisted"] = decks["tied"]
        for old, new in (("poisson = 0.25", "poisson = 0.25  hypothesis = 'axisymmetric'  twist = .true."),
                         ("ux = 0.0  uy", "turn = 0.0  uy"), ("cells = 8, 4", "cells = 8, 4  origin = 1.0, 0.0"),
                         ("-1.0, -2.0", "0.0, -2.0"), ("origin = 4.0, 0.5", "origin = 5.0, 0.5")):
            decks["twisted"] = decks["twisted"].replace(old, new)
        checked = set()
        for name, deck in decks.items():
            self.write(f"{name}.nml", f"&case name = '{name}'  units = 'L, F' /\n{deck}")
            self.run_program("--quiet", f"{name}.nml")
            written = {}
            # Key results are listed in the order of the summary, which has the places of the largest values last.
            results = json.loads((self.directory / f"{name}.summary.json").read_text(encoding="utf-8"))["key_results"]
            keys = [key for key in results if not re.search("_[xy]$", key) or key[:-2] not in results]
            listing = (self.directory / f"{name}.lst").read_text(encoding="utf-8").partition("\nKey results\n")[2]
            lines = re.findall(r"^  (?!Points)\S.*? -?\d[\d.e+-]*(?: ((?!at)\S.*?))?(?: at \(.*\))?$",
                               listing.partition("\nWarnings\n")[0], re.MULTILINE)
            written.update(zip(keys, lines[:len(keys)], strict=True))
            for ending in ("vtu", "contact.vtu"):
                grid = (self.directory / f"{name}.{ending}").read_text(encoding="utf-8")
                for array in re.findall(r"<DataArray.*?</DataArray>", grid, re.DOTALL):
                    unit = re.search(r'"UNITS_LABEL"[^>]*>([^<]*)<', array)
                    written[re.search(r'Name="([^"]*)"', array)[1]] = unit[1] if unit else ""
            for key, unit in written.items():
                units = {known.replace("–", "") for pattern, known in table if pattern.fullmatch(key)}
                if units:
                    checked.add(key)
                    self.assertIn(unit.replace("^2", "²").replace("^3", "³").replace("sqrt", "√"), units, key)
        self.assertLessEqual({"gap", "force", "jump", "von_mises", "error_norm", "material"}, checked)
        # And each key result of the page exists.
        section = section_of("output.md", "Key results")
        for name in re.findall(r"`([^`]+)`", "".join(re.findall(r"^\| (`[^|]*`) \|", section, re.MULTILINE))):
            pattern = re.compile(re.sub(r"[A-Z]{2,}", ".+", name))
            self.assertTrue(any(pattern.fullmatch(key) for key in checked), name)

    @unittest.skipIf(importlib.util.find_spec("numpy") is None, "NumPy is not installed")
    def test_reports_and_pictures_show_the_units_of_key_results(self):
        sys.path.insert(0, str(PAGES.parent / "python"))
        dimension_of = importlib.import_module("amontons.cases").dimension_of
        found = units_of_names(section_of("output.md", "Key results"))
        self.assertGreater(len(found), 20)
        for pattern, unit in found:
            name = pattern.pattern.replace("(_\\d+)?", "").replace(".+", "part")
            self.assertEqual(dimension_of(name), unit, name)

    @unittest.skipIf(importlib.util.find_spec("matplotlib") is None, "Matplotlib is not installed")
    def test_options_of_the_command_that_draws_have_a_row_with_all_their_words(self):
        sys.path.insert(0, str(PAGES.parent / "python"))
        plot = importlib.import_module("amontons.plot")
        rows = dict(re.findall(r"^\| `(--[a-z]+)(.*)$", section_of("guide.md", "Figures"), re.MULTILINE))
        # argparse has no other list of its options.
        options = re.findall(r"^  (--[a-z]+)", plot.parser().format_help(), re.MULTILINE)
        self.assertEqual(sorted(rows), sorted(options))
        for option, words in (("--panels", plot.PANELS), ("--abscissa", plot.ABSCISSAS), ("--format", plot.FORMATS)):
            self.assertLessEqual({*words}, {*re.findall(r"[a-z]+", rows[option])}, option)

    def test_words_that_people_search_for_are_in_the_pages(self):
        text = " ".join(" ".join(page.read_text(encoding="utf-8") for page in PAGES.glob("*.md")).split())
        self.assertEqual([word for word in SEARCHED if word not in text], [])

    def test_violations_have_a_row_in_the_theory_and_a_sentence(self):
        # A third body is tied to the side of the first.
        tied = "&mesh name = 'c'  size = 1.0, 1.0  cells = 2, 2  origin = 4.0, 0.5 /\n" \
            "&tie set = 'c.left'  to = 'a.right' /\n"
        self.run_program("--quiet", self.write("case.nml", TWO_BODIES.replace(
            "friction = 0.2", "slip_bound = 0.1") + tied))
        certificate = json.loads((self.directory / "case.summary.json").read_text(encoding="utf-8"))["certificate"]
        found = set(certificate) - {"passed", "limit", "strain_energy", "work_of_friction"}
        theory = (PAGES / "theory.md").read_text(encoding="utf-8").split("\n## ")
        section, = (text for text in theory if text.startswith("8. Certificate"))
        table = section.partition("### ")[0]
        self.assertEqual(set(re.findall(r"^\| `([a-z_]+)` \| ", table, re.MULTILINE)), found)
        self.assertLessEqual({"pair_force", "duality_gap"}, found)
        verdicts = (PAGES.parent / "python" / "amontons" / "verdicts.py").read_text(encoding="utf-8")
        self.assertEqual(set(re.findall(r'^    "([a-z_]+)": "', verdicts, re.MULTILINE)), found)

    def test_no_name_is_a_missing_one(self):
        # The comparison itself: a name that no page has is found.
        patterns = documented("output.md", "theory.md")
        with self.assertRaisesRegex(AssertionError, "certificate.pear"):
            self.assert_documented(["certificate.pear"], patterns, "none")
        self.assert_documented(["factor_push", "contact_width_2", "mesh_3", "ux_2", "counts.elements"], patterns,
                               "none")


if __name__ == "__main__":
    unittest.main()
