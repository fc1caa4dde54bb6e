#!/usr/bin/env python3
"""The examples of doc/examples, built outside on the installed library, and doc/library.md, which quotes them.

PREFIX is where the library is installed, LIBRARY_DIRECTORY its libraries' place there, EXAMPLES where the examples are
built.
"""
import importlib.util
import math
import os
import re
import sys
import unittest
from pathlib import Path

from harness import ProgramTest, results_of

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "doc" / "examples"
EXAMPLES = Path(os.environ["EXAMPLES"])
LIBRARIES = Path(os.environ["LIBRARY_DIRECTORY"])
HAS_PYTHON = all(importlib.util.find_spec(module) for module in ("numpy", "matplotlib"))
LENGTHS = {"open": 3.75, "slip": 20.0, "stick": 16.25}  # row 1 of the paper's Table 1

C_PROJECT = """cmake_minimum_required(VERSION 3.25)
project(only_c LANGUAGES C)
find_package(amontons 0.3 REQUIRED)
add_executable(from_c from_c.c)
target_link_libraries(from_c PRIVATE amontons::amontons_c)
"""


class Examples(ProgramTest):
    """The programs, one by one."""

    def run_example(self, name, *arguments, status=0):
        """Runs an example and returns what it printed."""
        return self.run_command([str(EXAMPLES / name), *map(str, arguments)], status)

    def test_solve_deck(self):
        printed = self.run_example("solve_deck", SOURCES / "bar.nml", "out").stdout
        self.assertIn("bar: solved", printed)
        for part, length in LENGTHS.items():
            self.assertRegex(printed, rf"{part} +{length:.2f}\n")
        self.assertEqual(sorted(self.contents("out")), results_of("bar"))

    def test_solve_deck_ends_with_the_status_of_an_error(self):
        run = self.run_example("solve_deck", "missing.nml", "out", status=1)
        self.assertEqual(run.stderr, "missing.nml: cannot read this file: No such file or directory\n")

    def test_build_body(self):
        rows = [line.split() for line in self.run_example("build_body").stdout.splitlines()]
        self.assertEqual(rows[0], ["x", "pressure", "shear", "status"])
        floor = [(float(x), float(pressure), float(shear), status) for x, pressure, shear, status in rows[1:10]]
        self.assertEqual([status for *_, status in floor], ["open"] + 4*["slip+"] + 4*["stick"])
        for x, pressure, shear, status in floor:
            # friction 1; four decimals are printed
            self.assertLessEqual(abs(shear), pressure + 1e-4, x)
            self.assertTrue(status != "slip+" or abs(shear - pressure) <= 1e-4, x)
        self.assertEqual(rows[10][-3:], ["3.75", "27.50", "8.75"])  # row 2, as tests/verification finds it

    def test_reduced_problem(self):
        rows = [line.split() for line in self.run_example("reduced_problem").stdout.splitlines()[2:]]
        self.assertEqual([row[-1] for row in rows], ["stick", "slip-"])
        (n_1, t_1, u_1, v_1), (n_2, t_2, u_2, v_2) = [map(float, row[:4]) for row in rows]
        # six decimals are printed
        self.assertTrue(all(abs(u) <= 1e-6 for u in (u_1, v_1, u_2)) and v_2 < 0)
        self.assertLess(abs(t_1), 0.75*n_1)
        self.assertAlmostEqual(t_2, -0.5*n_2, delta=1e-6)

    def test_step_history(self):
        printed = self.run_example("step_history", SOURCES / "bar_history.nml").stdout.splitlines()
        # The states 1 and 2 of the benchmark of the long bar's history.
        self.assertEqual(printed[1:3], ["push  10.0, displacement of the corner  0.014488876",
                                        "push  15.0, displacement of the corner  0.028459438"])

    def test_step_history_in_c(self):
        printed = self.run_example("step_history_c", SOURCES / "bar_history.nml").stdout.splitlines()
        self.assertEqual([line.rpartition(",")[0] for line in printed[1:3]],
                         ["push  10.0, displacement of the corner  0.014488876",
                          "push  15.0, displacement of the corner  0.028459438"])
        # Loads that friction does not hold: the sentence of the program, and the code of the C interface.
        deck = (SOURCES / "bar_history.nml").read_text(encoding="utf-8").replace("&support", "! &support")
        run = self.run_example("step_history_c", self.write("free.nml", deck), status=6)
        self.assertIn("no equilibrium", run.stderr)
        self.assertEqual(len(run.stdout.splitlines()), 1)

    @unittest.skipUnless(HAS_PYTHON, "NumPy and Matplotlib are needed")
    def test_step_history_in_python(self):
        printed = self.run_command(["env", "-u", "AMONTONS_LIBRARY", f"PYTHONPATH={LIBRARIES / 'amontons'}",
                                    sys.executable, "-B", str(SOURCES / "step_history.py"),
                                    str(SOURCES / "bar_history.nml")]).stdout
        self.assertRegex(printed, r"\n15\.0 0\.0284594384")

    def test_from_c(self):
        printed = self.run_example("from_c", SOURCES / "bar.nml", "out").stdout
        self.assertRegex(printed, r"^Amontons \d+\.\d+\.\d+\niterations: .*\n.* stick\n.* slip\nbar: solved, see out/")
        self.assertEqual(sorted(self.contents("out")), results_of("bar"))

    def test_c_needs_no_fortran(self):
        self.write("from_c.c", (SOURCES / "from_c.c").read_text(encoding="utf-8"))
        self.write("CMakeLists.txt", C_PROJECT)
        self.run_command(["cmake", "-G", "Ninja", "-S", ".", "-B", "build",
                          f"-DCMAKE_PREFIX_PATH={os.environ['PREFIX']}"])
        self.run_command(["cmake", "--build", "build"])
        self.assertIn("bar: solved", self.run_command(["build/from_c", str(SOURCES / "bar.nml"), "out"]).stdout)

    def test_pkg_config_knows_the_c_interface(self):
        # What pkg-config prints is for a shell to read: blanks in names are escaped.
        self.write("compile.sh", f"""set -e
export PKG_CONFIG_PATH='{LIBRARIES}/pkgconfig'
eval "cc -std=c11 -Wall -Wextra -pedantic -Werror '{SOURCES}/from_c.c' -o from_c \\
   $(pkg-config --cflags --libs amontons_c) '-Wl,-rpath,{LIBRARIES}'"
""")
        self.run_command(["bash", "compile.sh"])
        self.assertIn("bar: solved", self.run_command(["./from_c", str(SOURCES / "bar.nml"), "out"]).stdout)

    @unittest.skipUnless(HAS_PYTHON, "NumPy and Matplotlib are needed")
    def test_long_bar_is_drawn_by_the_installed_module(self):
        printed = self.run_command(["env", "-u", "AMONTONS_LIBRARY", f"PYTHONPATH={LIBRARIES / 'amontons'}",
                                    f"MPLCONFIGDIR={self.directory}", "MPLBACKEND=agg", sys.executable, "-B",
                                    str(SOURCES / "long_bar.py"), "out"]).stdout
        self.assertIn(", ".join(f"{part} {length:g} mm" for part, length in LENGTHS.items()), printed)
        files = self.contents("out")
        self.assertTrue(files["long_bar.png"].startswith(b"\x89PNG"))
        self.assertIn(b"<svg", files["long_bar.svg"])
        self.assertTrue(files["friction.png"].startswith(b"\x89PNG"))

    @unittest.skipUnless(HAS_PYTHON, "NumPy and Matplotlib are needed")
    def test_roller_of_arrays(self):
        printed = self.run_command(["env", "-u", "AMONTONS_LIBRARY", f"PYTHONPATH={LIBRARIES / 'amontons'}",
                                    f"MPLCONFIGDIR={self.directory}", "MPLBACKEND=agg", sys.executable, "-B",
                                    str(SOURCES / "roller.py"), "out"]).stdout
        width, force = map(float, re.fullmatch(r"contact width (.*) mm, force (.*) N/mm\n", printed).groups())
        # Hertz's force of this width on a half space, E/(1 - nu^2) = 6.27. A layer on its hub is stiffer, not by half.
        hertz = 6.27*math.pi*(width/2)**2/(4*40)
        self.assertTrue(hertz < force < 1.5*hertz, force/hertz)
        self.assertTrue(self.contents("out")["roller.png"].startswith(b"\x89PNG"))

    @unittest.skipUnless(HAS_PYTHON, "NumPy and Matplotlib are needed")
    def test_installed_commands_run_on_the_python_of_the_search_path(self):
        self.run_command([os.environ["PREFIX"] + "/bin/amontons", "--quiet", "--output", "out",
                          str(SOURCES / "bar.nml")])
        (self.directory / "bin").mkdir()
        python = self.directory / "bin" / "python3"
        python.write_text(f"#!/bin/sh\nexec '{sys.executable}' \"$@\"\n", encoding="utf-8")
        python.chmod(0o755)
        for command, files in (("plot", ["bar.png", "bar.svg"]), ("report", ["report.html"])):
            printed = self.run_command(["env", f"PATH={self.directory / 'bin'}:{os.environ['PATH']}",
                                        f"MPLCONFIGDIR={self.directory}", "PYTHONDONTWRITEBYTECODE=1",
                                        f"{os.environ['PREFIX']}/bin/amontons-{command}", "out"]).stdout
            self.assertEqual(printed.splitlines(), [f"out/{file}" for file in files])
            self.assertLessEqual({*files}, {*self.contents("out")})


class Page(unittest.TestCase):
    """doc/library.md: every piece of code in it stands in a tested file, line by line."""

    def test_code_is_that_of_the_examples(self):
        text = (ROOT / "doc" / "library.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```(fortran|c|python|cmake)\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)
        self.assertEqual({language for language, _ in blocks}, {"fortran", "c", "python", "cmake"})
        files = [*SOURCES.iterdir(), *(ROOT / "python" / "amontons").iterdir()]
        sources = [[line.strip() for line in file.read_text(encoding="utf-8").splitlines() if line.strip()]
                   for file in files if file.is_file()]
        for language, block in blocks:
            lines = [line.strip() for line in block.splitlines() if line.strip()]
            found = any(lines == source[i:i + len(lines)] for source in sources for i in range(len(source)))
            self.assertTrue(found, f"no example holds this {language}:\n{block}")


if __name__ == "__main__":
    unittest.main()
