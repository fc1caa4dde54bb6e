"""Benchmarks: tests on decks whose results are in doc/verification.md.

A benchmark is a file test_NAME.py, named in benchmarks.txt, with its decks in decks/. The first line of its docstring
is its heading in the document, the paragraph after it the text: what is computed, the formula or source. What follows,
how numbers are measured and what is allowed for which reason, is printed with every row only.

    python3 test_NAME.py           the test: coarse meshes, seconds
    python3 test_NAME.py --print   on fine meshes; prints its section with every row, in Markdown
    python3 test_NAME.py --print --digest=FILE   and writes the section of the document into a file
"""
import argparse
import re
import sys
import unittest
import zlib
from pathlib import Path

from convergence import ORDER_ALLOWANCE, ConvergenceTable, digest
from field_error import displacement_error, stress_error
from harness import ProgramTest

HERE = Path(__file__).resolve().parent
DECKS = HERE/"decks"
MESHES = HERE.parent/"meshes"
ELEMENTS = ("tri3", "quad4", "tri6", "quad8", "quad9")
SOLIDS = ("tet4", "tet10", "hex8", "hex20")
VALUE = r"(?:'[^']*'|[^\s,/'!]+)"


class Benchmark(ProgramTest):
    """Runs decks, on coarse meshes as a test, on finer ones for the document, and fills tables."""
    is_printing = False
    tables = []
    timeout = 600

    def meshes(self, coarse, fine):
        """The meshes of a study: coarse ones in the test, fine ones for the document."""
        return fine if self.is_printing else coarse

    def deck(self, name, mesh=None, **values):
        """The text of decks/NAME.nml with other values for keys, each of which must stand in it once.

        `mesh` is the text of a mesh file that takes the place of the deck's own mesh.
        """
        text = (DECKS/f"{name}.nml").read_text(encoding="utf-8")
        if mesh is not None:
            # One file for each text, since decks of several meshes may be run together.
            file = self.write(f"mesh_{zlib.crc32(mesh.encode()):08x}.msh", mesh)
            text = re.sub(r"^&mesh\b[^/]*/", f"&mesh kind = 'file'  file = '{file}' /", text, flags=re.MULTILINE)
        for key, value in values.items():
            text, count = re.subn(rf"\b{key}( *= *){VALUE}( *, *{VALUE})*", rf"{key}\g<1>{written(value)}", text)
            assert count == 1, f"{name}.nml: {key} stands in it {count} times"
        return text

    def assert_table(self, table):
        """Keeps a table for the document, and fails if a row misses what is required of it."""
        self.tables.append(table)
        self.assertTrue(table.rows, table.caption)
        self.assertEqual(table.faults, [])

    def study_elements(self, caption, deck_of, exact, material, length, meshes):
        """Checks a table of all elements, each on decks `deck_of(element, cells)` with so many cells along a length."""
        orders = {element: ((2, 1) if element in ("tri3", "quad4") else (3, 2)) for element in ELEMENTS}
        table = ConvergenceTable(caption, ["displacement", "stress"], orders,
                                 allowance=self.meshes(0.2, ORDER_ALLOWANCE))
        for element in ELEMENTS:
            for cells in self.meshes(*meshes):
                result = self.solve(deck_of(element, cells))
                self.assert_sound(result)
                errors, effectivity = self.field_errors(result, exact, material)
                table.add(element, length/cells, *errors, effectivity=effectivity)
        table.close()
        self.assert_table(table)

    def field_errors(self, result, exact, material):
        """Errors of displacement and stress of a solved case, and the effectivity of the estimate of the latter."""
        grid = self.directory/"case.vtu"
        norm, stress = stress_error(grid, exact, material)
        return (displacement_error(grid, exact, material.depth), stress), result.summary["accuracy"]["error_norm"]/norm

    def assert_sound(self, result):
        """Checks that a case converged and passed its certificate."""
        self.assertIs(result.summary["converged"], True)
        self.assertIs(result.summary["certificate"]["passed"], True)


def patch_mesh(element):
    """A mesh by Gmsh of a block of 3 by 2, of cells of any shape."""
    return (MESHES/f"patch-{element}.msh").read_text(encoding="utf-8")


def with_points_held(deck, points, exact):
    """A deck whose supports at points give way to ones that put points where an exact field has them."""
    supports = [f"&support point = {x!r}, {y!r}  ux = {{!r}}  uy = {{!r}} /\n".format(*exact(x, y)) for x, y in points]
    return re.sub(r"^&support point[^/]*/\n", "", deck, flags=re.MULTILINE) + "".join(supports)


def written(value):
    """A value as a deck writes it."""
    if isinstance(value, (tuple, list)):
        return ", ".join(map(written, value))
    return f"'{value}'" if isinstance(value, str) else repr(value)


def main():
    """Runs the tests of the calling script; with --print its section follows on standard output."""
    module = sys.modules["__main__"]
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--print", action="store_true")
    parser.add_argument("--digest", type=Path)
    options, others = parser.parse_known_args()
    Benchmark.is_printing = options.print
    program = unittest.main(module, argv=[sys.argv[0], *others], exit=False)
    heading, _, text = module.__doc__.strip().partition("\n")
    if options.print:
        print(section(heading, text, [table.markdown() for table in Benchmark.tables]))
    if options.digest:
        text = text.strip().partition("\n\n")[0]
        options.digest.write_text(section(heading, text, digest(Benchmark.tables)) + "\n", encoding="utf-8")
    sys.exit(not program.result.wasSuccessful())


def section(heading, text, tables):
    """The section on a benchmark: its text, and its tables in Markdown. Its heading leads to the script."""
    link = f"[{heading.rstrip('.')}](../tests/verification/{Path(sys.argv[0]).name})"
    return "\n\n".join([f"## {link}", text.strip(), *tables])
