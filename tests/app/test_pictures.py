"""Pictures and pages made of solved cases by the commands amontons-plot and amontons-report."""
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import unittest
import urllib.parse
from pathlib import Path
from xml.etree import ElementTree

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block, read_vtu

try:
    import matplotlib
except ImportError:
    matplotlib = None
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
if matplotlib:
    import numpy as np
    from amontons.draw_line import closed_zone, points_of, stretches
    from amontons.grid import Grid
    from amontons.svg_axes import ticks_between

ROOT = Path(__file__).resolve().parents[2]
BROWSER = shutil.which("chromium")
PUSH = "load set = 'right'  traction = -0.5, 0.3"


@unittest.skipIf(matplotlib is None, "matplotlib is not installed")
class Pictures(ProgramTest):
    """The two commands, on cases with names that need care."""

    def setUp(self):
        super().setUp()
        for name, options in (("it's <one> & only", ""), ("two", "solver method = 'psor'  max_iterations = 2")):
            groups = (SUPPORT, PRESSURE, CONTACT, PUSH, f'case name = "{name}"  title = "A & B"')
            self.write("deck.nml", block(*groups, *filter(None, [options])))
            self.run_program("--quiet", "--output", "some results", "deck.nml", status=4 if options else 0)

    def script(self, name, *arguments, status=0):
        """Runs one of the two commands."""
        return self.run_package(name, *arguments, status=status)

    def test_a_case_is_drawn_as_png_and_svg(self):
        run = self.script("plot", "some results/two.lst")
        self.assertEqual(run.stdout, "some results/two.png\nsome results/two.svg\n")
        folder = self.directory / "some results"
        self.assertEqual((folder / "two.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertTrue(ElementTree.parse(folder / "two.svg").getroot().tag.endswith("svg"))

    def test_a_home_folder_that_cannot_be_written_to_is_no_news(self):
        homeless = ["env", "-u", "MPLCONFIGDIR", "-u", "XDG_CONFIG_HOME", "-u", "XDG_CACHE_HOME", "HOME=/dev/null"]
        run = self.run_command([*homeless, "PYTHONPATH=" + str(ROOT / "python"), sys.executable, "-B", "-m", "amontons",
                                "plot", "some results/two"])
        # Fontconfig may miss its own configuration.
        self.assertNotIn("matplotlib", run.stderr.lower())

    def test_a_folder_is_drawn_case_by_case(self):
        self.script("plot", "some results")
        self.assertEqual(len(list((self.directory / "some results").glob("*.png"))), 2)

    def test_names_are_never_run_nor_taken_for_markup(self):
        folder = "-n $(touch pwned); `touch pwned` \n\"'"
        name = "-x $(touch pwned); `touch pwned` $\\frac $1 <b> \"' % # ?"
        self.write("deck.nml", block(SUPPORT, PRESSURE, CONTACT, PUSH, "case title = 'of $5 and $\\frac{$, <script>'"))
        (self.directory / "deck.nml").rename(self.directory / f"{name}.nml")
        self.run_program("--quiet", f"--output={folder}", "--", f"{name}.nml")
        self.run_command([ROOT / "scripts" / "report.sh", folder])
        page = (self.directory / folder / "report.html").read_text(encoding="utf-8")
        self.assertIn("of $5 and $\\frac{$, &lt;script&gt;", page)
        self.assertNotIn("of $5 and $\\frac{$, <script>", page)
        self.assertNotIn("<b> ", page)
        self.assertFalse([path for path in self.files() if Path(path).name == "pwned"])

    def test_sweeps_and_reduced_problems_are_drawn_and_told(self):
        loads = "load name = 'push'  set = 'right'  traction = -1.0, 0.2"
        sweep = "sweep load = 'push'  factor = 0.5, 1.0, 1.5"
        for name, groups in (("line", [sweep]), ("map", [sweep, "sweep friction_factor = 0.5, 1.0"])):
            self.write(f"{name}.nml", block(SUPPORT, PRESSURE, CONTACT, loads, *groups))
        self.run_program("--quiet", "--output", "more", "line.nml", "map.nml")
        self.write("point.dat", "2 1 0 2 2 2 2 1 0 0 1 -1 0.1 0.5")
        self.write("point.nml", "&problem kind = 'reduced'  file = 'point.dat' /\n&solver method = 'psor' /\n")
        self.run_program("--quiet", "--output", "more", "point.nml")
        self.script("plot", "more/line.sweep.csv", "more/map.lst", "more/point.contact.csv")
        self.script("report", "more")
        page = (self.directory / "more" / "report.html").read_text(encoding="utf-8")
        self.assertIn("3 cases: 3 green, 0 amber, 0 red.", page)
        self.assertEqual(len(list((self.directory / "more").glob("*.svg"))), 3)

    def test_histories_have_a_loop(self):
        self.write("cycle.nml", block(SUPPORT, PRESSURE, CONTACT, "load name = 'F'  set = 'right'  traction = 1.0, 0.0",
                                      "history times = 0.0, 1.0, 2.0, 3.0  substeps = 8",
                                      "steps load = 'F'  factor = 0.0, -1.0, 1.0, -1.0"))
        self.run_program("--quiet", "--output", "out", "cycle.nml")
        run = self.script("plot", "out", "--loop", "factor_F", "dissipation", "--format", "svg")
        self.assertEqual(run.stdout, "out/cycle.svg\nout/cycle.steps.svg\n")
        drawn = (self.directory / "out" / "cycle.steps.svg").read_text(encoding="utf-8")
        for text in ("factor of F", "slip +", "stick", "dissipation / length"):
            self.assertIn(text, drawn)
        run = self.script("plot", "out", "--loop", "factor_G", "dissipation", status=1)
        self.assertIn("out/cycle.history.csv: no column 'factor_G'; the columns are: step, time, factor_F", run.stderr)
        run = self.script("plot", "some results/two", "--loop", "x", "y", status=1)
        self.assertIn("some results/two: a loop is only for a load history", run.stderr)
        self.script("report", "out")
        page = (self.directory / "out" / "report.html").read_text(encoding="utf-8")
        self.assertIn("load history", page)

    def test_a_history_without_steps_is_drawn_as_a_case(self):
        deck = block(SUPPORT, PRESSURE, CONTACT, "load name = 'F'  set = 'right'  traction = 1.0, 0.0",
                     "history times = 0.0, 1.0{}", "steps load = 'F'  factor = 0.0, 1.0", "output states_every = 1")
        self.write("first.nml", deck.format(""))
        self.run_program("--quiet", "--output", "first", "first.nml")
        self.write("last.nml", deck.format("  start = 'first/first.states.csv'"))
        self.run_program("--quiet", "--output", "last", "last.nml")
        self.assertEqual(self.script("plot", "last", "--format", "png").stdout, "last/last.png\n")
        self.script("report", "last")
        self.assertIn("1 green", (self.directory / "last" / "report.html").read_text(encoding="utf-8"))

    def test_the_loop_is_over_what_turns_back_or_changes_last_and_not_over_the_preload(self):
        for name, factors in (("cycle", "0.0, 0.0, 1.0, -1.0"), ("once", "0.0, 0.0, 1.0, 1.0")):
            self.write(f"{name}.nml", block(
                SUPPORT, PRESSURE.replace("load", "load name = 'preload' "), CONTACT,
                "load name = 'push'  set = 'right'  traction = 1.0, 0.0",
                "history times = 0.0, 1.0, 2.0, 3.0  substeps = 3, 2, 2",
                "steps load = 'preload'  factor = 0.0, 1.0, 1.0, 1.0", f"steps load = 'push'  factor = {factors}"))
            self.run_program("--quiet", "--output", "out", f"{name}.nml")
        self.script("plot", "out", "--format", "svg")
        for name in ("cycle", "once"):
            drawn = (self.directory / "out" / f"{name}.steps.svg").read_text(encoding="utf-8")
            self.assertIn("factor of push", drawn)
            self.assertNotIn("factor of preload", drawn)

    def test_a_history_shows_what_it_is_about(self):
        push = ("load name = 'push'  set = 'right'  traction = -1.0, 0.0", "history times = 0.0, 1.0",
                "steps load = 'push'  factor = 0.0, 1.0")
        wall = "contact set = 'left'  normal = 1.0, 0.0"
        for name, groups, shown in (
                ("worn", (SUPPORT, PRESSURE, CONTACT + "  wear = 1e-6", *push),
                 (">time<", "max wear depth", ">wear depth<")),
                # Sums over two contact sets may cancel.
                ("sets", (PRESSURE, CONTACT, wall, *push),
                 ("factor of push", "tangential force 1", "dissipation / length"))):
            self.write(f"{name}.nml", block(*groups))
            self.run_program("--quiet", "--output", "out", f"{name}.nml")
            self.script("plot", f"out/{name}", "--format", "svg")
            drawn = (self.directory / "out" / f"{name}.steps.svg").read_text(encoding="utf-8")
            for text in shown:
                self.assertIn(text, drawn)

    def test_long_labels_are_wrapped(self):
        floor, wall = (CONTACT + "  name = 'the floor below the block'",
                       "contact set = 'left'  normal = 1.0, 0.0  name = 'the wall beside the block'")
        self.write("case.nml", block(PRESSURE, floor, wall, "load set = 'right'  traction = -0.5, 0.0"))
        self.run_program("--quiet", "--output", "out", "case.nml")
        label = "length along the contact line: the floor below the block, the wall beside the block"
        for size, is_whole in (("120x80", False), ("400x120", True)):
            self.script("plot", "out/case", "--format", "svg", "--size", size)
            drawn = (self.directory / "out" / "case.svg").read_text(encoding="utf-8")
            self.assertEqual(label in drawn, is_whole, size)
            self.assertIn("beside the block", drawn)

    def test_orthotropic_bodies_are_drawn(self):
        wood = "young = 80.0, 20.0, 20.0  poisson = 0.3, 0.3, 0.3  shear = 10.0"
        self.write("wood.nml", block(SUPPORT, PRESSURE, CONTACT, material=wood))
        self.run_program("--quiet", "--output", "out", "wood.nml")
        self.script("plot", "out/wood", "--format", "png")
        self.script("report", "out")

    def test_scripts_take_the_python_that_can_draw(self):
        # A python3 that comes first on the search path and has the packages, and one that has not.
        for packages, expected in ((True, "first"), (False, "other")):
            folder = self.directory / str(packages)
            folder.mkdir()
            python = folder / "python3"
            python.write_text("#!/bin/sh\ncase $1 in -c) " + ("exit 0" if packages else "exit 1") + " ;; esac\n"
                              f"echo first \"$@\"\n", encoding="utf-8")
            python.chmod(0o755)
            run = self.run_command(["env", f"PATH={folder}:{os.environ['PATH']}", ROOT / "scripts" / "plot.sh",
                                    "some results/two"])
            self.assertEqual(run.stdout, "first -B -m amontons plot some results/two\n" if packages else
                             "some results/two.png\nsome results/two.svg\n", expected)

    def test_what_is_no_case_is_refused(self):
        for script in ("plot", "report"):
            self.assertIn(f"{script}: ", self.script(script, "nowhere", status=1).stderr)

    def test_the_page_tells_every_case_and_verdict(self):
        self.script("report", "some results")
        page = (self.directory / "some results" / "report.html").read_text(encoding="utf-8")
        self.assertIn("2 cases: 1 green, 0 amber, 1 red.", page)
        self.assertIn("it&#x27;s &lt;one&gt; &amp; only", page)
        self.assertIn("A &amp; B", page)
        self.assertIn("The method stopped after 2 iterations", page)
        self.assertNotIn("http", page, "the page needs no network")

    def test_sweeps_with_cases_that_are_not_solved(self):
        swept = (SUPPORT, "load name = 'press'  set = 'top'  pressure = 0.2", CONTACT)
        for name, groups in {"off": ("sweep load = 'press'  factor = 1.0, -1.0, 2.0", "output fields_every = 1"),
                             "map": ("sweep load = 'press'  factor = 1.0, -1.0, 2.0", "sweep friction = 0.1, 0.3"),
                             "none": ("sweep load = 'press'  factor = -1.0, -2.0", )}.items():
            self.write(f"{name}.nml", block(*swept, *groups))
        self.run_program("--quiet", "--output", "swept", "off.nml", "map.nml", "none.nml", status=2)
        self.script("plot", "swept")
        self.script("report", "swept")
        page = (self.directory / "swept" / "report.html").read_text(encoding="utf-8")
        verdicts = re.findall(r'<p class="verdict (\w+)"><b>\w+</b><span>(.*)</span></p>', page)
        self.assertEqual([color for color, _ in verdicts], ["amber"]*3)
        self.assertIn("no case has an equilibrium", verdicts[0][1])
        self.assertIn("Of 6 cases, 2 have no equilibrium", verdicts[1][1])
        self.assertIn('href="off.sweep.pvd"', page)

    def test_widths_of_every_contact_set_are_in_the_table(self):
        right = "contact set = 'right'  friction = 0.2  point = 4.0, 0.0  normal = -1.0, 0.0"
        for name in ("one", "two"):
            self.write(f"{name}.nml", block(SUPPORT, PRESSURE, CONTACT, right))
        self.run_program("--quiet", "--output", "sets", "one.nml", "two.nml")
        self.script("report", "sets")
        page = (self.directory / "sets" / "report.html").read_text(encoding="utf-8")
        for number in (1, 2):
            self.assertEqual(page.count(f'data-label="contact width {number}"'), 2)

    def test_warnings_are_amber(self):
        self.write("rough.nml", block(SUPPORT, PRESSURE, "contact set = 'bottom'  friction = 2.5"))
        self.write("fine.nml", block(SUPPORT, PRESSURE, CONTACT))
        self.run_program("--quiet", "--output", "warned", "rough.nml", "fine.nml")
        self.script("report", "warned")
        page = (self.directory / "warned" / "report.html").read_text(encoding="utf-8")
        self.assertIn("2 cases: 1 green, 1 amber, 0 red.", page)
        warning = '<p class="verdict amber"><b>warning</b><span>contact set &#x27;bottom&#x27;: friction of 2.5'
        self.assertEqual(page.count(warning), 1)

    def test_a_solid_is_drawn_from_both_sides_with_maps_of_its_contact_sets(self):
        walls = "contact name = 'wall'  set = 'right'  normal = -1.0, 0.0, 0.0  point = 1.002, 0.0, 0.0"
        self.write("cube.nml", block("support set = 'top'  ux = 0.001  uy = 0.002  uz = -0.01", CONTACT, walls,
                                     mesh="kind = 'box'  size = 1.0, 1.0, 1.0  cells = 2, 2, 2",
                                     material="young = 1.0  poisson = 0.3"))
        self.run_program("--quiet", "--output", "space", "cube.nml")
        run = self.script("plot", "space")
        self.assertEqual((run.stdout, run.stderr), ("space/cube.png\nspace/cube.svg\n", ""))
        self.script("report", "space")
        page = (self.directory / "space" / "report.html").read_text(encoding="utf-8")
        self.assertIn("1 case: 1 green, 0 amber, 0 red.", page)
        pictures = re.findall(r'<svg id="[^"]*" viewBox="0 0 331.2 [^"]*" role="img" aria-label="([^"]*)"', page)
        self.assertEqual(pictures, ["cube: body"]*2 + ["cube: bottom on a plane"]*2 + ["cube: wall on a plane"]*2)
        # As bodies of the plane have: identifiers once, and places with all their coordinates.
        names = re.findall(r' id="([^"]*)"', page)
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual(set(re.findall(r'(?:href="|url\()#(\w+)', page)), set(names))
        self.assertRegex(page, r"<dt>max displacement</dt><dd>[\d.e-]+ at \([\d.]+, [\d.]+, 1\)</dd>")
        self.assertNotIn("<dt>max displacement z</dt>", page)

    def test_a_history_of_a_solid_has_the_areas_of_its_zones_over_the_time(self):
        self.write("steps.nml", block("support name = 'top'  set = 'top'  ux = 0.01  uy = 0.0  uz = -0.01", CONTACT,
                                      "history times = 0.0, 1.0, 2.0  substeps = 2",
                                      "steps support = 'top'  factor = 0.0, 1.0, 0.5",
                                      mesh="kind = 'box'  size = 1.0, 1.0, 1.0  cells = 2, 2, 2",
                                      material="young = 1.0  poisson = 0.3"))
        self.run_program("--quiet", "--output", "steps", "steps.nml")
        self.assertEqual(self.script("plot", "steps", "--format", "svg").stdout,
                         "steps/steps.svg\nsteps/steps.steps.svg\n")
        picture = (self.directory / "steps" / "steps.steps.svg").read_text(encoding="utf-8")
        for words in ("open area", "slip area", "stick area", ">area<", ">dissipation<"):
            self.assertIn(words, picture)
        self.script("report", "steps")
        page = (self.directory / "steps" / "report.html").read_text(encoding="utf-8")
        self.assertEqual(page.count("steps: load history"), 3)

    def test_a_sweep_of_a_solid_has_the_areas_of_its_zones(self):
        self.write("rows.nml", block("support set = 'top'  ux = 0.01  uy = 0.0  uz = -0.01", CONTACT,
                                     "sweep friction = 0.1, 0.2, 0.4", mesh="kind = 'box'  size = 1.0, 1.0, 1.0  "
                                     "cells = 2, 2, 2", material="young = 1.0  poisson = 0.3"))
        self.run_program("--quiet", "--output", "rows", "rows.nml")
        self.assertEqual(self.script("plot", "rows", "--format", "svg").stdout, "rows/rows.svg\n")
        picture = (self.directory / "rows" / "rows.svg").read_text(encoding="utf-8")
        for words in ("open area", "slip area", "stick area"):
            self.assertIn(words, picture)
        self.script("report", "rows")
        page = (self.directory / "rows" / "report.html").read_text(encoding="utf-8")
        self.assertIn("rows: sweep", page)

    def test_a_case_without_equilibrium_has_its_message(self):
        self.write("fine.nml", block(SUPPORT, PRESSURE, CONTACT))
        self.write("lifted.nml", block(SUPPORT, CONTACT, "load set = 'top'  traction = 0.0, 1.0"))
        self.run_program("--quiet", "--output", "free", "lifted.nml", "fine.nml", status=2)
        run = self.script("plot", "free", "--format", "png")
        self.assertEqual((run.stdout, run.stderr),
                         ("free/fine.png\n", "plot: free/lifted: no equilibrium, nothing to draw\n"))
        self.script("report", "free")
        page = (self.directory / "free" / "report.html").read_text(encoding="utf-8")
        self.assertIn("2 cases: 1 green, 0 amber, 0 red, 1 without equilibrium.", page)
        self.assertIn('<p class="verdict amber"><b>lifted</b><span>no equilibrium: contact and friction cannot balance '
                      "the loads;", page)

    def test_a_page_of_cases_without_equilibrium_alone_has_no_chart(self):
        for i in (1, 2):
            self.write(f"lifted{i}.nml", block(SUPPORT, CONTACT, f"load set = 'top'  traction = 0.0, {i}.0"))
            self.run_program("--quiet", "--output", "lifted", f"lifted{i}.nml", status=2)
            self.script("report", "lifted")
            page = (self.directory / "lifted" / "report.html").read_text(encoding="utf-8")
            self.assertIn(f"{i} without equilibrium.", page)
            self.assertNotIn('id="chart"', page)

    def test_a_history_that_ends_early_shows_what_it_reached(self):
        deck = block(PRESSURE, CONTACT, "load name = 'push'  set = 'left'  traction = 1.0, 0.0",
                     "history times = 0.0, 1.0", "steps load = 'push'  factor = {}, 1.0")
        self.write("slides.nml", deck.format(0.0))
        self.write("slid.nml", deck.format(1.0))
        self.run_program("--quiet", "--output", "out", "slides.nml", "slid.nml", status=2)
        run = self.script("plot", "out", "--format", "png")
        self.assertEqual((run.stdout, run.stderr), ("out/slides.png\nout/slides.steps.png\n",
                                                    "plot: out/slid: no equilibrium, nothing to draw\n"))
        self.script("report", "out")
        page = (self.directory / "out" / "report.html").read_text(encoding="utf-8")
        self.assertIn("2 cases: 0 green, 1 amber, 0 red, 1 without equilibrium.", page)
        self.assertIn("Incomplete: step 7 (to ", page)
        self.assertIn("What is shown is the last state, certified.", page)

    def test_failed_decks_are_red_with_their_message(self):
        self.write("some results/batch.csv",
                   "deck,case,outcome,message\nbad <1>.nml,,refused,\"line 3: unknown key 'E', really\"\n"
                   "two.nml,two,not_converged,not converged\n")
        self.script("report", "some results")
        page = (self.directory / "some results" / "report.html").read_text(encoding="utf-8")
        self.assertIn("2 cases: 1 green, 0 amber, 1 red, 1 failed.", page)
        self.assertIn('<p class="verdict red"><b>failed: bad &lt;1&gt;.nml</b><span>line 3: unknown key &#x27;E&#x27;, '
                      "really</span>", page)

    def test_many_cases_in_a_page(self):
        for i in range(9):
            self.write(f"case{i}.nml", block(f"load set = 'top'  pressure = {i + 1}.0", SUPPORT,
                                             f"contact set = 'bottom'  friction = {0.02*(7*i % 9)}",
                                             mesh="size = 4.0, 2.0  cells = 60, 40"))
        self.run_program("--quiet", "--output", "many", *(f"case{i}.nml" for i in range(9)))
        self.script("report", "many")
        page = (self.directory / "many" / "report.html").read_text(encoding="utf-8")
        self.assertLess(len(page), 9*150e3)
        results = json.loads(re.search(r'id="results">(.*?)</script>', page)[1])
        rows = results["cases"]
        self.assertEqual([row["case"] for row in rows], [f"case{i}" for i in range(9)])
        for i, row in enumerate(rows):
            self.assertAlmostEqual(row["normal_force"], 4.0*(i + 1), delta=1e-6)
        self.assertLessEqual({"slip_length", "contact_points", "residual", "seconds"}, {*results["labels"]})
        # What the decks differ in is in the table, and first over which the chart draws.
        labels = results["labels"]
        self.assertEqual([key for key in labels if "." in key], ["load.pressure", "contact.friction"])
        self.assertEqual([row["contact.friction"] for row in rows], [round(0.02*(7*i % 9), 12) for i in range(9)])
        self.assertEqual(results["chart"], ["load.pressure", "max_contact_pressure"])
        self.assertEqual(page.count('data-label="contact friction"'), 9)
        # Every identifier is there once: of pictures drawn side by side, too.
        names = re.findall(r' id="([^"]*)"', page)
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual(set(re.findall(r'(?:href="|url\()#(\w+)', page)), set(names))

    def test_histories_and_sweeps_in_a_page(self):
        push = "load name = 'push'  set = 'left'  traction = 0.2, 0.0"
        for name, groups in {
                "cycle": ("history times = 0.0, 1.0, 2.0  substeps = 2",
                          "steps load = 'push'  factor = 0.0, 1.0, -1.0"),
                "curve": ("sweep friction = 0.1, 0.2, 0.3", ),
                "map": ("sweep friction = 0.1, 0.2, 0.3", "sweep load = 'push'  factor = 0.5, 1.0")}.items():
            self.write(f"{name}.nml", block(SUPPORT, PRESSURE, CONTACT, push, *groups))
        self.run_program("--quiet", "--output", "studies", "cycle.nml", "curve.nml", "map.nml")
        self.script("report", "studies")
        page = (self.directory / "studies" / "report.html").read_text(encoding="utf-8")
        pictures = {name: re.findall(r'<svg id="[^"]*" viewBox="0 0 331.2 [^"]*" role="img" aria-label="([^"]*)"', part)
                    for name, part in re.findall(r'<section data-case="(\w+)">(.*?)</section>', page, re.DOTALL)}
        self.assertEqual(pictures["map"], [f"map: map of {zone} length" for zone in ("open", "slip", "stick")])
        self.assertEqual(pictures["curve"], ["curve: sweep"])
        self.assertEqual(pictures["cycle"][-3:], ["cycle: load history"]*3)
        for text in (">factor of push<", ">time<", ">dissipation / length<", ">friction<", ">slip length<"):
            self.assertIn(text, page)
        # The layout of Matplotlib's figures takes a hundred times as long as all the rest.
        self.run_command([sys.executable, "-c", f"import sys; sys.path.insert(0, {str(ROOT / 'python')!r}); "
                          "import amontons.report; sys.exit('matplotlib.pyplot' in sys.modules)"])

    def test_lines_of_a_page_are_where_their_axes_say(self):
        # Pressure over length, in points of the picture: what the ticks of both axes mean must lead to the table.
        self.run_program("--quiet", "--output", "one", self.write("case.nml", block(PRESSURE, SUPPORT, CONTACT)))
        self.script("report", "one")
        page = (self.directory / "one" / "report.html").read_text(encoding="utf-8")
        picture = re.search(r'<svg id="c0l".*?</svg>', page)[0]
        lines = re.search(r'<g clip-path="url\(#c0l0\)".*?</g>', picture)[0]
        pressure = re.search(r'd="M([^"]*)" stroke="currentColor"', lines)[1]
        drawn = [tuple(map(float, pair.split())) for pair in pressure.split("L")]
        with open(self.directory / "one" / "case.contact.csv", encoding="utf-8") as text:
            rows = list(csv.DictReader(text))
        texts = re.findall(r'<text x="([-\d.]+)" y="([-\d.]+)" font-size="8" text-anchor="(end|middle)">(−?[\d.]+)<',
                           picture)
        top, height = map(float, re.search(r'id="c0l0"><rect x="[^"]*" y="([^"]*)" width="[^"]*" height="([^"]*)"',
                                           picture).groups())
        ordinates = [(float(y) - 3, float(text.replace("−", "-"))) for _, y, anchor, text in texts
                     if anchor == "end" and float(y) - 3 < top + height]
        abscissas = [(float(x), float(text)) for x, _, anchor, text in texts if anchor == "middle"]
        for ticks, key, place in ((ordinates, "contact_pressure", 1), (abscissas, "x", 0)):
            (first, low), (second, high) = ticks[0], ticks[-1]
            scale = (high - low)/(second - first)
            for row, point in zip(rows, drawn, strict=True):
                # Places have two decimals.
                self.assertAlmostEqual(low + (point[place] - first)*scale, float(row[key]), delta=0.03*abs(scale))

    def test_the_deck_in_a_page_runs_elsewhere(self):
        (self.directory / "far").mkdir()
        name = "a 'mesh'.msh"
        shutil.copy(ROOT / "tests" / "meshes" / "tri6-41.msh", self.directory / "far" / name)
        self.write("far/part.nml", block("support set = 'bottom'  ux = 0.0  uy = 0.0",
                                         mesh="kind = 'file'  file = \"a 'mesh'.msh\""))
        self.run_program("--quiet", "--output", "results", "far/part.nml")
        self.script("report", "results")
        page = (self.directory / "results" / "report.html").read_text(encoding="utf-8")
        deck = urllib.parse.unquote(re.search(r'download="part.deck.nml" href="data:[^,]*,([^"]*)"', page)[1])
        self.assertIn("a &#x27;mesh&#x27;.msh</code>", page)
        self.assertNotIn(str(self.directory), page)
        (self.directory / "elsewhere").mkdir()
        shutil.move(self.directory / "far" / name, self.directory / "elsewhere" / name)
        self.write("elsewhere/part.nml", deck)
        self.run_program("--check", "elsewhere/part.nml")

    def test_bodies_with_one_contact_point_and_with_none_are_drawn(self):
        held = "support set = 'left'  ux = 0.0  uy = 0.0"
        self.write("one.nml", block(held, PRESSURE, CONTACT, mesh="size = 4.0, 2.0  cells = 1, 1"))
        self.write("none.nml", block(held, "load set = 'top'  pressure = 0.1"))
        self.run_program("--quiet", "--output", "few", "one.nml", "none.nml")
        arrays, *_ = read_vtu((self.directory / "few" / "one.contact.vtu").read_bytes())
        self.assertEqual(arrays["types"], (1, ))
        self.assertEqual(self.script("plot", "few").stderr, "")
        self.script("report", "few")
        self.assertIn("2 cases: 2 green", (self.directory / "few" / "report.html").read_text(encoding="utf-8"))

    def test_a_small_closed_part_is_drawn_by_itself(self):
        # A block on a small drum: a few points of its whole bottom side are closed.
        self.write("block.nml", block(
            "support set = 'top'  ux = 0.0  uy = -0.01",
            "contact set = 'bottom'  obstacle = 'circle'  radius = 1.0  point = 2.0, 0.0",
            mesh="size = 4.0, 2.0  cells = 40, 8"))
        self.run_program("--quiet", "block.nml")
        self.script("plot", "block")
        self.assertIn(">closed zone, displacements ", (self.directory / "block.svg").read_text(encoding="utf-8"))

    def test_a_line_ends_where_the_set_has_a_hole(self):
        line = Grid(np.array([[x, 0.0, 0.0] for x in (0.0, 0.5, 1.0, 3.0, 3.5, 4.0)]),
                    [("line", np.array([[0, 1], [1, 2], [3, 4], [4, 5]]))],
                    {"set": np.ones(6), "status": np.full(6, 2), "contact_pressure": np.ones(6)}, {})
        pieces = stretches(line)
        self.assertEqual([list(piece.points) for piece in pieces], [[0, 1, 2], [3, 4, 5]])
        # The hole counts along the line.
        self.assertEqual([list(piece.length) for piece in pieces], [[0.0, 0.5, 1.0], [3.0, 3.5, 4.0]])

    def test_the_closed_zone_is_that_of_the_set_with_the_largest_pressure(self):
        places = [(0.1*i, 0.0, 0.0) for i in range(11)] + [(5.0 + 0.1*i, 3.0, 0.0) for i in range(11)]
        status, pressure = np.ones(22), np.zeros(22)
        status[[3, 4, 14, 15]], pressure[[3, 4, 14, 15]] = 2, [1.0, 1.0, 2.0, 3.0]
        cells = np.array([[i, i + 1] for i in range(21) if i != 10])
        line = Grid(np.array(places), [("line", cells)], {"set": np.repeat([1, 2], 11), "status": status,
                                                          "contact_pressure": pressure}, {})
        sets = stretches(line)
        zone = points_of(closed_zone(line, sets))
        self.assertTrue(set(zone) <= set(range(11, 22)) and {14, 15} <= set(zone), zone)

    def test_a_single_iteration_has_a_tick_at_its_number_alone(self):
        ticks, _ = ticks_between((0.95, 1.05), 5, are_whole=True)
        self.assertEqual([value for value, _ in ticks], [1.0])

    def test_large_displacements_are_drawn_as_they_are(self):
        # A fourth of the block's height; a twelfth of its width is what smaller ones are magnified to.
        self.write("block.nml", block("support set = 'top'  ux = 0.0  uy = -0.5", CONTACT))
        self.run_program("--quiet", "block.nml")
        self.script("plot", "block")
        self.assertIn("displacements to scale", (self.directory / "block.svg").read_text(encoding="utf-8"))

    @unittest.skipIf(BROWSER is None, "chromium is not installed")
    def test_a_browser_shows_the_page(self):
        self.script("report", "some results")
        page = self.directory / "some results" / "report.html"
        # A script of the test, not of the page, sorts the table by its names and asks the browser for the order
        # of the cases, whether the pictures have an extent, whether the page is wider than its window, a frame, or a
        # text than its cell, and whether every tick of the chart has its number.
        probe = """<script>addEventListener('load', () => {
            const heads = document.querySelectorAll('th button'), pictures = document.querySelectorAll('.figures svg');
            const names = () => [...document.querySelectorAll('td.name a')].map(cell => cell.textContent).join();
            heads[0].click(); const first = names(); heads[0].click(); const second = names();
            const search = document.getElementById('find');
            const dots = () => document.querySelectorAll('#chart circle').length;
            const seen = word => { search.value = word; search.dispatchEvent(new Event('input'));
               return [[...document.querySelectorAll('.cases tbody tr')].filter(row => row.offsetHeight > 0).length,
                  [...document.querySelectorAll('section')].filter(one => !one.hidden).length, dots()].join('/'); };
            const found = [seen('only'), seen('no such case'), seen('')].join(' ');
            parent.document.title += [innerWidth, first, second, found, pictures.length, [...pictures].every(picture =>
               picture.getBBox().width > 100), document.documentElement.scrollWidth > innerWidth,
               [...document.querySelectorAll('.cases td')].every(cell => cell.scrollWidth <= cell.clientWidth),
               [...document.querySelectorAll('#chart text')].every(tick => tick.textContent),
               getComputedStyle(document.body).backgroundColor, ''].join(' | ') })</script>"""
        page.with_name("probe.html").write_text(page.read_text(encoding="utf-8") + probe, encoding="utf-8")
        widths, frame = (360, 500, 1280), page.with_name("frame.html")
        frame.write_text("".join(f"<iframe src='probe.html' style='width:{width}px;height:800px;border:0'></iframe>"
                                 for width in widths), encoding="utf-8")
        expected = ("two,it's &lt;one&gt; &amp; only | it's &lt;one&gt; &amp; only,two | 1/1/1 0/0/0 2/2/2 | 5 | true "
                    "| false | true | true | rgb")
        for scheme, paper in ((0, "(20, 24, 27)"), (1, "(255, 255, 255)")):
            run = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--disable-gpu",
                                  "--virtual-time-budget=10000", "--window-size=1400,900",
                                  f"--blink-settings=preferredColorScheme={scheme}", "--enable-logging=stderr",
                                  "--allow-file-access-from-files", f"--user-data-dir={self.directory / 'profile'}",
                                  "--dump-dom", frame.as_uri()],
                                 capture_output=True, encoding="utf-8", timeout=300, check=True)
            for width in widths:
                self.assertIn(f"{width} | {expected}{paper} |", run.stdout, (width, scheme))
            self.assertNotIn("CONSOLE", run.stderr)

    @unittest.skipIf(BROWSER is None, "chromium is not installed")
    def test_a_search_compares_numbers_and_a_chart_of_equal_ones_has_different_ticks(self):
        for i in range(1, 13):
            # Pressures of ten digits, which rounding alone distinguishes.
            self.write(f"bar_{i}.nml", block(SUPPORT, "load set = 'top'  pressure = 7.0e9",
                                             f"contact name = 'on \"it\"'  set = 'bottom'  friction = {i/10}",
                                             material="young = 1.0e14  poisson = 0.0"))
            self.run_program("--quiet", "--output", "found", f"bar_{i}.nml")
        self.script("report", "found")
        page = self.directory / "found" / "report.html"
        probe = """<script>addEventListener('load', () => {
            const search = document.getElementById('find'), by = document.getElementById('by');
            const drawn = document.getElementById('drawn');
            const seen = word => { search.value = word; search.dispatchEvent(new Event('input'));
               return [...document.querySelectorAll('.cases tbody tr')].filter(row => !row.hidden).length; };
            const found = ['friction>0.95', 'contact_friction<=0.3', 'friction=0.3', '0.3', '1', 'bar_1', 'green',
               'max', 'max_contact_pressure>1e6', 'bar_1 friction<1.05'].map(seen).join(' ');
            seen('');
            for (const one of by.options) { by.value = one.value; by.dispatchEvent(new Event('change')); }
            drawn.value = 'max_contact_pressure'; drawn.dispatchEvent(new Event('change'));
            const ticks = [...document.querySelectorAll('#chart text[text-anchor=end]')].map(one => one.textContent);
            document.title = [found, new Set(ticks).size === ticks.length,
               Math.max(...ticks.map(one => one.length)) < 9, ''].join(' | ') })</script>"""
        page.write_text(page.read_text(encoding="utf-8") + probe, encoding="utf-8")
        run = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000",
                              "--enable-logging=stderr", "--window-size=1280,900",
                              f"--user-data-dir={self.directory / 'profile'}", "--dump-dom", page.as_uri()],
                             capture_output=True, encoding="utf-8", timeout=300, check=True)
        self.assertIn("<title>3 3 1 1 4 4 12 0 12 2 | true | true |", run.stdout)
        self.assertNotIn("CONSOLE", run.stderr)

    @unittest.skipIf(BROWSER is None, "chromium is not installed")
    def test_a_search_finds_rows_that_are_sorted_otherwise_and_long_names_wrap(self):
        # The folder has 10 before 2, the page 2 before 10.
        long = "a_name_without_a_blank_" * 8 + "1"
        for name in ("case_2", "case_10", long):
            self.write(f"{name}.nml", block(PRESSURE, CONTACT, "support set = 'left'  ux = 0.0"))
            self.run_program("--quiet", "--output", "found", f"{name}.nml")
        self.script("report", "found")
        page = self.directory / "found" / "report.html"
        probe = """<script>addEventListener('load', () => {
            const search = document.getElementById('find');
            const isNarrow = document.querySelector('td.name').offsetWidth < 400;
            search.value = 'case_10'; search.dispatchEvent(new Event('input'));
            document.title = [...document.querySelectorAll('.cases tbody tr')].filter(row => !row.hidden).map(row =>
               row.querySelector('td.name').textContent).join() + ' | ' + isNarrow + ' |' })</script>"""
        page.write_text(page.read_text(encoding="utf-8") + probe, encoding="utf-8")
        run = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000",
                              "--window-size=1280,900", f"--user-data-dir={self.directory / 'profile'}", "--dump-dom",
                              page.as_uri()], capture_output=True, encoding="utf-8", timeout=300, check=True)
        self.assertIn("case_10 | true |", run.stdout)


if __name__ == "__main__":
    unittest.main()
