"""Pictures and pages made of solved cases by the commands amontons-plot and amontons-report."""
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path
from xml.etree import ElementTree

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block, read_vtu

try:
    import matplotlib
except ImportError:
    matplotlib = None

ROOT = Path(__file__).resolve().parents[2]
BROWSER = shutil.which("chromium")
PUSH = "load set = 'right'  traction = -1.5, 0.3"


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
        return self.run_command(["env", f"PYTHONPATH={ROOT / 'python'}", sys.executable, "-B", "-m", "amontons", name,
                                 *arguments], status)

    def test_a_case_is_drawn_as_png_and_svg(self):
        run = self.script("plot", "some results/two.lst")
        self.assertEqual(run.stdout, "some results/two.png\nsome results/two.svg\n")
        folder = self.directory / "some results"
        self.assertEqual((folder / "two.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertTrue(ElementTree.parse(folder / "two.svg").getroot().tag.endswith("svg"))

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
        self.assertNotIn("<script>", page)
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
        self.assertNotIn("http", page.replace('xmlns="http://www.w3.org', ""), "the page needs no network")

    def test_sweeps_with_cases_that_are_not_solved(self):
        swept = (SUPPORT, "load name = 'press'  set = 'top'  pressure = 1.0", CONTACT)
        for name, groups in {"off": ("sweep load = 'press'  factor = 1.0, -1.0, 2.0", "output fields_every = 1"),
                             "map": ("sweep load = 'press'  factor = 1.0, -1.0, 2.0", "sweep friction = 0.1, 0.3"),
                             "none": ("sweep load = 'press'  factor = -1.0, -2.0", )}.items():
            self.write(f"{name}.nml", block(*swept, *groups))
        self.run_program("--quiet", "--output", "swept", "off.nml", "map.nml", "none.nml", status=4)
        self.script("plot", "swept")
        self.script("report", "swept")
        page = (self.directory / "swept" / "report.html").read_text(encoding="utf-8")
        verdicts = re.findall(r'<p class="verdict (\w+)"><b>\w+</b>(.*)</p>', page)
        self.assertEqual([color for color, _ in verdicts], ["amber", "red", "amber"])
        self.assertIn("Of 6 cases 2 have no equilibrium", verdicts[0][1])
        self.assertIn("No case is solved", verdicts[1][1])
        self.assertIn('href="off.sweep.pvd"', page)

    def test_warnings_are_amber(self):
        self.write("rough.nml", block(SUPPORT, PRESSURE, "contact set = 'bottom'  friction = 2.5"))
        self.write("fine.nml", block(SUPPORT, PRESSURE, CONTACT))
        self.run_program("--quiet", "--output", "warned", "rough.nml", "fine.nml")
        self.script("report", "warned")
        page = (self.directory / "warned" / "report.html").read_text(encoding="utf-8")
        self.assertIn("2 cases: 1 green, 1 amber, 0 red.", page)
        warning = '<p class="verdict amber"><b>warning</b>contact set &#x27;bottom&#x27;: friction of 2.5'
        self.assertEqual(page.count(warning), 1)

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
        self.assertIn("the closed part", (self.directory / "block.svg").read_text(encoding="utf-8"))

    def test_large_displacements_are_drawn_as_they_are(self):
        # A fourth of the block's height; a twelfth of its width is what smaller ones are magnified to.
        self.write("block.nml", block("support set = 'top'  ux = 0.0  uy = -0.5", CONTACT))
        self.run_program("--quiet", "block.nml")
        self.script("plot", "block")
        self.assertIn("stress; displacements as they are", (self.directory / "block.svg").read_text(encoding="utf-8"))

    @unittest.skipIf(BROWSER is None, "chromium is not installed")
    def test_a_browser_shows_the_page(self):
        self.script("report", "some results")
        page = self.directory / "some results" / "report.html"
        # A script of the test, not of the page, asks the browser whether it could draw the pictures, and whether
        # the page is wider than the window.
        probe = page.with_name("probe.html")
        probe.write_text(page.read_text(encoding="utf-8") + "<script>addEventListener('load', () => { document.title = "
                         "[...document.images].map(image => image.complete && image.naturalWidth > 100).join() + "
                         "' ' + document.querySelectorAll('h2').length + ' ' + "
                         "Math.max(0, document.documentElement.scrollWidth - innerWidth) })</script>", encoding="utf-8")
        for width in (390, 1280):
            run = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=10000",
                                  f"--window-size={width},800", "--enable-logging=stderr",
                                  f"--user-data-dir={self.directory / 'profile'}", "--dump-dom", probe.as_uri()],
                                 capture_output=True, encoding="utf-8", timeout=60, check=True)
            self.assertIn("<title>true,true 2 0</title>", run.stdout, width)
            self.assertNotIn("CONSOLE", run.stderr)


if __name__ == "__main__":
    unittest.main()
