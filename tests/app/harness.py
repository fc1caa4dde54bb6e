"""Runs the program in a scratch directory and reads what it leaves there.

The environment variable AMONTONS names the program, AMONTONS_SLOWNESS how many times longer than the optimized one it
may take. Standard library only.
"""
import base64
import contextlib
import csv
import importlib
import io
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PROGRAM = os.environ["AMONTONS"]
SUFFIXES = ("contact.csv", "contact.vtu", "deck.nml", "lst", "summary.json", "vtu")
# Whether a test may mount a small file system of its own.
CAN_MOUNT = shutil.which("unshare") and subprocess.run(
    ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", "mount -t tmpfs none /mnt"],
    capture_output=True, check=False).returncode == 0
# Whether the program was built with SuiteSparse, and with which BLAS.
VERSION = subprocess.run([PROGRAM, "--version"], capture_output=True, encoding="utf-8", check=True).stdout
HAS_SUITESPARSE = "SuiteSparse  none\n" not in VERSION
HAS_OPENBLAS = "OpenBLAS" in VERSION
# The address sanitizer reserves more addresses than any limit allows.
HAS_SANITIZER = b"__asan_init" in Path(PROGRAM).read_bytes()
# A shell has its background jobs ignore these, and the program leaves it at that: a test that interrupts it would wait
# for ever.
for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
    if signal.getsignal(number) == signal.SIG_IGN:
        signal.signal(number, signal.SIG_DFL)
COLUMNS = ("point", "x", "y", "normal_x", "normal_y", "weight", "gap", "slip", "normal_force", "tangential_force",
           "contact_pressure", "contact_shear", "shear_bound", "status")


def finite(text):
    """A number that the program wrote. One that is none would pass through every maximum, so it is refused here."""
    value = float(text)
    assert math.isfinite(value), f"{text} was written"
    return value


class Result:
    """What a solved case left: the summary, and the columns of the contact table."""

    def __init__(self, directory, name):
        self.summary = json.loads((directory / f"{name}.summary.json").read_text(encoding="utf-8"),
                                  parse_constant=finite)
        with open(directory / f"{name}.contact.csv", newline="", encoding="utf-8") as table:
            reader = csv.DictReader(table)
            rows, names = list(reader), reader.fieldnames
        self.columns = {column: [row[column] if column in ("status", "pair") else finite(row[column]) for row in rows]
                        for column in names}

    def __getitem__(self, column):
        return self.columns[column]

    @property
    def forces(self):
        """All normal forces, then all tangential ones."""
        return self["normal_force"] + self["tangential_force"]

    @property
    def lengths(self):
        """The open, the slip and the stick length."""
        return [self.summary["lengths"][zone] for zone in ("open_length", "slip_length", "stick_length")]


class ProgramTest(unittest.TestCase):
    """A scratch directory that the program runs in."""
    # Seconds until a run counts as hanging; on a busy machine one may take long.
    timeout = 300*int(os.environ.get("AMONTONS_SLOWNESS", "1"))

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="amontons_")
        self.addCleanup(scratch.cleanup)
        self.directory = Path(scratch.name)

    def run_program(self, *arguments, status=0):
        """Runs the program, checks its exit status and returns what it printed."""
        return self.run_command([PROGRAM, *map(str, arguments)], status)

    def run_command(self, command, status=0):
        """Runs a command, checks its exit status, unless it is None, and returns what the command printed."""
        run = subprocess.run(command, cwd=self.directory, capture_output=True, encoding="utf-8", timeout=self.timeout,
                             check=False)
        if status is not None:
            self.assertEqual(run.returncode, status, f"{command}\n{run.stdout}{run.stderr}")
        return run

    def run_package(self, *arguments, status=0):
        """Runs a command of the Python package as `python -m amontons` does, in the Python of the test: to start one
        and to import Matplotlib takes longer than most commands. Checks its exit status and returns what it printed."""
        package = str(Path(__file__).resolve().parents[2] / "python")
        if package not in sys.path:
            sys.path.insert(0, package)
        command = importlib.import_module("amontons.commands").main
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.chdir(self.directory), contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            with self.assertRaises(SystemExit) as end:
                command([str(argument) for argument in arguments])
            code = end.exception.code
            if isinstance(code, str):
                print(code, file=sys.stderr)
        found = 1 if isinstance(code, str) else code or 0
        self.assertEqual(found, status, f"{arguments}\n{output.getvalue()}{errors.getvalue()}")
        return subprocess.CompletedProcess(arguments, found, output.getvalue(), errors.getvalue())

    def write(self, name, text):
        """Writes a file, byte by byte as given, and returns its name."""
        (self.directory / name).write_bytes(text.encode("utf-8"))
        return name

    def files(self):
        """The names of all files and directories in the scratch directory."""
        return sorted(str(path.relative_to(self.directory)) for path in self.directory.rglob("*"))

    def contents(self, directory="."):
        """The content of every file in a directory of the scratch directory."""
        return {path.name: path.read_bytes() for path in (self.directory / directory).iterdir() if path.is_file()}

    def result(self, name, directory="."):
        """What the case of this name left."""
        return Result(self.directory / directory, name)

    def solve(self, text, name="case", status=0):
        """Writes a deck, runs the program on it, quietly, and returns what the case left."""
        run = self.run_program("--quiet", self.write(f"{name}.nml", text), status=status)
        self.assertEqual(run.stdout, "")
        return self.result(name)

    def assert_close(self, found, expected, tolerance, message=None):
        """Checks numbers one by one against an absolute tolerance."""
        self.assertEqual(len(found), len(expected), message)
        far = [(a, b) for a, b in zip(found, expected) if not abs(a - b) <= tolerance]
        self.assertEqual(far, [], message)


def read_vtu(content):
    """The arrays of a VTU file, by name, and the numbers of points and cells."""
    root = ElementTree.fromstring(content)
    assert root.attrib == {"type": "UnstructuredGrid", "version": "1.0", "byte_order": "LittleEndian",
                           "header_type": "UInt64"}, root.attrib
    arrays = {}
    for array in root.iter("DataArray"):
        name, width = array.get("Name"), int(array.get("NumberOfComponents", "1"))
        assert array.get("format") == "binary", name
        content = base64.b64decode(array.text, validate=True)
        length, = struct.unpack_from("<Q", content)
        assert len(content) == 8 + length, f"{name}: {len(content) - 8} bytes, {length} are announced"
        kind = {"Float64": "d", "Int32": "i"}[array.get("type")]
        values = struct.unpack(f"<{length//struct.calcsize(kind)}{kind}", content[8:])
        assert all(map(math.isfinite, values)), f"{name}: a number that is none"
        if width > 1:
            values = [values[i:i + width] for i in range(0, len(values), width)]
        arrays[name] = values
    piece = root.find("UnstructuredGrid/Piece")
    return arrays, int(piece.get("NumberOfPoints")), int(piece.get("NumberOfCells"))


def change_array(content, name, change):
    """A VTU file with one of its arrays changed: `change` is given the array as bytes, its length included, and returns
    others."""
    pattern = rb'(.*Name="%s"[^>]*>)([^<]*)(<.*)' % name.encode()
    before, text, behind = re.fullmatch(pattern, content, re.DOTALL).groups()
    return before + base64.b64encode(change(base64.b64decode(text))) + behind


def results_of(name):
    """The names of the files that a case leaves."""
    return [f"{name}.{suffix}" for suffix in SUFFIXES]


def block(*groups, mesh="size = 4.0, 2.0  cells = 8, 4", material="young = 100.0  poisson = 0.25"):
    """The text of a deck: a block, and further groups without their & and /."""
    return "".join(f"&{group} /\n" for group in (f"mesh {mesh}", f"material {material}", *groups))


def words_of(group, key):
    """The words that a key of a deck may have, as the program's own reference lists them."""
    reference = subprocess.run([PROGRAM, "--reference", group], capture_output=True, encoding="utf-8",
                               check=True).stdout
    return re.findall(r"'(\w[^']*)'", re.search(rf"^\| `{key}` \|([^|]*)\|", reference, re.MULTILINE)[1])


SUPPORT = "support set = 'left'  ux = 0.0"
PRESSURE = "load set = 'top'  pressure = 1.0"
CONTACT = "contact set = 'bottom'  friction = 0.3"
TWO_BODIES = """&mesh name = 'a'  size = 4.0, 2.0  cells = 8, 4 /
&mesh name = 'b'  size = 6.0, 2.0  cells = 9, 3  origin = -1.0, -2.0 /
&material young = 100.0  poisson = 0.25 /
&support set = 'b.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'a.left'  ux = 0.0 /
&load set = 'a.top'  pressure = 1.0  traction = 0.3, 0.0 /
&contact set = 'a.bottom'  against = 'b.top'  friction = 0.2 /
"""
SOUND = block(SUPPORT, PRESSURE, CONTACT)
