"""Solves decks and reduced problems with the library.

What the program refuses raises an exception with the program's sentence. What does not converge is returned, with a
warning and `is_solved` False. The module loads libamontons_c.so: the file that the environment variable
AMONTONS_LIBRARY names, else the one of the wheel, the installation or the build tree it is part of, else the one that
the system finds. Calls release Python's lock; from several threads they wait for each other, and each has threads of
its own inside.
"""
import csv
import ctypes
import ctypes.util
import json
import os
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

import numpy as np

STATUSES = np.array(["", "open", "stick", "slip+", "slip-"])
WORDS = ("status", "outcome", "warnings", "statuses")  # columns of tables
TEXT_SIZE = 65536


class AmontonsError(Exception):
    """What Amontons cannot do; its text is the program's sentence."""


class InputRefused(AmontonsError, ValueError):
    """A deck, an array or an argument is at fault."""


class NumericalFailure(AmontonsError, ArithmeticError):
    """The numbers are at fault: not positive definite, a body flies off."""


class SystemFailure(AmontonsError, OSError):
    """The machine is at fault: a file cannot be written."""


class NotConverged(UserWarning):
    """A result is there, but not to the tolerance, or its certificate failed."""


ERRORS = {1: InputRefused, 2: NumericalFailure, 3: SystemFailure}


@dataclass(frozen=True)
class ReducedResult:
    """The solution of a reduced problem; unknowns as in `solve_reduced`."""
    r: np.ndarray       # forces (2m)
    u: np.ndarray       # displacements or velocities (2m)
    status: np.ndarray  # 'open', 'stick', 'slip+' or 'slip-' (m)
    residual: float
    iterations: int
    is_solved: bool


@dataclass(frozen=True)
class DeckResult:
    """What a deck left; doc/output.md explains every column and member."""
    name: str                   # name of the case
    directory: Optional[Path]   # where its files are; None if they were not to be kept
    contact: Optional[dict]     # columns of NAME.contact.csv, as arrays; None where there is no such file
    sweep: Optional[dict]       # columns of NAME.sweep.csv, one row per case; None where there is no such file
    summary: dict               # NAME.summary.json
    is_solved: bool


def _library_path():
    """Where the library is: beside the package's files in a wheel, in the folder of the libraries, which the package's
    own folder is in, in an installation or a build tree."""
    named = os.environ.get("AMONTONS_LIBRARY")
    if named:
        return named
    package = Path(__file__).absolute().parent
    found = [path for folder in (package, package.parent.parent) for path in sorted(folder.glob("libamontons_c.so*"))]
    return str(found[0]) if found else ctypes.util.find_library("amontons_c") or "libamontons_c.so"


def _load():
    """Loads the library and declares its procedures."""
    library = ctypes.CDLL(_library_path())
    numbers = np.ctypeslib.ndpointer(np.float64, flags="F_CONTIGUOUS")
    text, size = ctypes.c_char_p, ctypes.c_int
    library.amontons_version_text.restype = text
    library.amontons_version_text.argtypes = []
    library.amontons_set_threads.restype = None
    library.amontons_set_threads.argtypes = [ctypes.c_int]
    library.amontons_solve_deck.argtypes = [text, text, text, size, text, size]
    library.amontons_solve_reduced_problem.argtypes = [
        ctypes.c_int, numbers, numbers, numbers, text, ctypes.c_double, ctypes.c_int, numbers, numbers,
        np.ctypeslib.ndpointer(np.intc), ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int), text, size]
    return library


_library = _load()


def version():
    """The version, 'major.minor.patch'."""
    return _library.amontons_version_text().decode()


def set_threads(n_threads):
    """Sets the number of threads of the loops inside, and one thread for the BLAS; to be called first, if at all."""
    _library.amontons_set_threads(n_threads)


def _judge(code, message, n_callers):
    """Raises what a return code stands for; returns whether the problem is solved. A warning points above the callers
    that are in this module."""
    sentence = message.value.decode(errors="replace")
    if code in ERRORS:
        raise ERRORS[code](sentence)
    if code:
        warnings.warn(sentence, NotConverged, stacklevel=n_callers + 1)
    return code == 0


def solve_reduced(W, q, mu, method="auto", tolerance=1e-10, max_iterations=1000):
    """Solves u = W r + q with friction: 0 <= u_N _|_ r_N >= 0, |r_T| <= mu r_N, r_T opposes u_T.

    W is symmetric and positive semidefinite (2m x 2m; a sparse matrix of SciPy is made dense), q has 2m numbers, mu m
    numbers, or one for all contacts. The unknowns of a contact stand together, the normal one first. `method` is a word
    for `&solver method` in a deck.
    """
    W = np.asfortranarray(W.toarray() if hasattr(W, "toarray") else W, dtype=np.float64)
    q = np.ascontiguousarray(q, dtype=np.float64)
    if q.ndim != 1 or q.size % 2 or W.shape != (q.size, q.size):
        raise InputRefused(f"expected W of 2m x 2m numbers and q of 2m, found {W.shape} and {q.shape}")
    m = q.size // 2
    try:
        mu = np.ascontiguousarray(np.broadcast_to(np.asarray(mu, dtype=np.float64), (m,)))
    except ValueError:
        raise InputRefused(f"expected one mu, or one for each of {m} contacts, found {np.shape(mu)}") from None
    r, u, status = np.zeros(2*m), np.zeros(2*m), np.zeros(m, dtype=np.intc)
    residual, iterations = ctypes.c_double(), ctypes.c_int()
    message = ctypes.create_string_buffer(TEXT_SIZE)
    code = _library.amontons_solve_reduced_problem(
        m, W, q, mu, method.encode(), tolerance, max_iterations, r, u, status, ctypes.byref(residual),
        ctypes.byref(iterations), message, TEXT_SIZE)
    is_solved = _judge(code, message, n_callers=2)
    return ReducedResult(r, u, STATUSES[status], residual.value, iterations.value, is_solved)


def solve_deck(deck, output=None):
    """Solves a deck as the program does; its files go to the directory `output`, or nowhere."""
    if output is None:
        with tempfile.TemporaryDirectory(prefix="amontons_") as scratch:
            return _solve_deck(deck, scratch, is_kept=False)
    return _solve_deck(deck, output, is_kept=True)


def _solve_deck(deck, output, is_kept):
    """Solves a deck and reads the files it leaves in a directory."""
    name, message = ctypes.create_string_buffer(TEXT_SIZE), ctypes.create_string_buffer(TEXT_SIZE)
    code = _library.amontons_solve_deck(os.fsencode(deck), os.fsencode(output), name, TEXT_SIZE, message, TEXT_SIZE)
    is_solved = _judge(code, message, n_callers=3)
    name = os.fsdecode(name.value)
    directory = Path(output)
    summary = json.loads((directory / f"{name}.summary.json").read_text(encoding="utf-8"))
    # A directory that is kept may hold files of an earlier deck of the same name.
    is_sweep = "sweep" in summary
    contact = None if is_sweep else _read_table(directory / f"{name}.contact.csv")
    sweep = _read_table(directory / f"{name}.sweep.csv") if is_sweep else None
    return DeckResult(name, directory if is_kept else None, contact, sweep, summary, is_solved)


def _read_table(path):
    """Reads a table: a column of numbers as an array of them (not a number where a case has none), any other as an
    array of words."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    columns = zip(*rows) if rows else ([] for _ in header)
    return {key: np.array(column) if key in WORDS else _numbers(column) for key, column in zip(header, columns)}


def _numbers(cells):
    """Turns the cells of a column of numbers into an array, of whole numbers where they are."""
    try:
        return np.array([int(cell) for cell in cells], dtype=int)
    except ValueError:
        return np.array([float(cell or "nan") for cell in cells])
