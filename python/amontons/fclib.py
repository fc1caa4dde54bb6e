"""Converts reduced problems u = W r + q between FCLIB's HDF5 files and the text of Siconos, which Amontons reads.

Usage: python -m amontons fclib [--solution TABLE] SOURCE TARGET

    SOURCE    an FCLIB file (group /fclib_local, dimension 2 or 3) or a text file; its first bytes tell which
    TARGET    a file of the other kind: text with W in CSparse's columns, or an FCLIB file with W in compressed columns
    TABLE     the NAME.contact.csv of `amontons --reduced`; its forces r, and u = W r + q, go to /solution of the FCLIB
              file

Or in Python: `read_fclib`, `write_fclib`, `read_text`, `write_text`. All numbers are kept to the last bit. A file that
is at fault raises a FileFault, whose text is the file and what is wrong with it. Whether W is symmetric and positive
semidefinite is for `amontons --check --reduced` to say. Needs NumPy and h5py.
"""
from __future__ import annotations

import argparse
import csv
import math
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Optional

import h5py
import numpy as np

from amontons.grid import Array

__all__ = ["FileFault", "Problem", "read_fclib", "read_solution", "read_text", "write_fclib", "write_text"]

HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
DENSE, BLOCKS, CSPARSE = 0, 1, 2  # storages of W in a text
TRIPLETS, COLUMNS = 1, 2  # forms of CSparse
COMPRESSED_COLUMNS, COMPRESSED_ROWS = -1, -2
UNKNOWNS = {2: "an even number, two", 3: "a multiple of three, three"}  # of a contact, by the dimension
LARGEST_NUMBER = 16  # bytes that a number of a data set may take
CONSISTENT = 1e-6    # how well a table must fulfill u = W r + q, beside the largest displacement


class FileFault(ValueError):
    """What is wrong with a file, in a sentence."""


@dataclass(frozen=True)
class Problem:
    """A reduced problem of m contacts. The unknowns of a contact stand together, the normal one first."""
    row: Array      # row of each entry of W, from 0; entries of one place add up
    column: Array   # column of each entry, from 0
    value: Array    # the entries
    q: Array        # u without forces (dm)
    mu: Array       # coefficients of friction (m)
    r: Optional[Array] = None  # forces of a solution (dm)
    dimension: int = 2         # number d of unknowns of a contact: 2 in the plane, 3 in space

    def displacements(self) -> Array:
        """u = W r + q, of a problem with forces."""
        return np.bincount(self.row, self.value*np.asarray(self.r)[self.column], len(self.q)) + self.q

    def columns(self) -> tuple[Array, Array, Array]:
        """W in compressed columns: where each column begins, and the end; the row and the value of each entry."""
        n = len(self.q)
        place, entry = np.unique(self.column*np.int64(n) + self.row, return_inverse=True)
        value = np.bincount(entry, self.value, len(place))
        return np.searchsorted(place, np.arange(n + 1)*np.int64(n)), place % max(n, 1), value


class _Group:
    """The data sets below a group of an HDF5 file, with sentences for what is wrong with them."""

    def __init__(self, path: Path, file: Any, name: str) -> None:
        self.path, self.file, self.name = path, file, name
        self.n_bytes = os.path.getsize(path)

    def fault(self, key: str, sentence: str) -> FileFault:
        """The fault of a data set."""
        return FileFault(f"{self.path}: {self.name}/{key}{sentence}")

    def numbers(self, key: str, kinds: str = "iu", expected: str = "integers") -> Any:
        """All numbers of a data set, in a row."""
        try:
            data = self.file.get(f"{self.name}/{key}")
            is_named = data is not None or self.file.get(f"{self.name}/{key}", getlink=True) is not None
        except (KeyError, OSError, RuntimeError):
            raise self.fault(key, ": this data set is damaged") from None
        if not is_named:
            raise FileFault(f"{self.path}: expected the data set {self.name}/{key}, found none")
        if data is None:
            raise self.fault(key, ": this data set is damaged")
        if not isinstance(data, h5py.Dataset) or data.size is None:
            raise self.fault(key, ": expected a data set of numbers")
        # A value takes a byte at the least, so that a damaged file cannot ask for all memory.
        if data.size > self.n_bytes:
            raise self.fault(key, f" announces {data.size} values, more than the file can hold")
        try:
            kind = data.dtype
        except (TypeError, ValueError):
            kind = None
        if kind is None or kind.kind not in kinds or kind.itemsize > LARGEST_NUMBER:
            raise self.fault(key, f": expected {expected}")
        try:
            return data[...].ravel()
        except OSError:
            raise self.fault(key, ": this data set is damaged") from None

    def number(self, key: str) -> Any:
        """The number of a data set that holds one integer."""
        values = self.numbers(key)
        if len(values) != 1:
            raise self.fault(key, f": expected one number, found {len(values)}")
        return int(values[0])

    def count(self, key: str) -> int:
        """The number of a data set that holds one integer that is not negative."""
        value = self.number(key)
        if value < 0:
            raise self.fault(key, f" is {value}: expected a number that is not negative")
        return int(value)

    def vector(self, key: str, n: int) -> Array:
        """The first n numbers of a data set of reals; whole numbers will do."""
        values: Array = self.numbers(key, "iuf", "numbers").astype(np.float64)
        if len(values) < n:
            raise self.fault(key, f": expected {n} numbers, found {len(values)}")
        if not np.isfinite(values).all():
            raise self.fault(key, f": number {np.argmin(np.isfinite(values)) + 1} is not finite")
        return values[:n]

    def checked_indices(self, key: str, values: Array, n_entries: int, n: int) -> Any:
        """The first of some indices; those that are too few or out of range are refused."""
        if len(values) < n_entries:
            raise self.fault(key, f": expected {n_entries} indices, found {len(values)}")
        values = values[:n_entries].astype(np.int64)
        if n_entries and not 0 <= values.min() <= values.max() < n:
            wrong = values[(values < 0) | (values >= n)][0]
            raise self.fault(key, f": expected indices from 0 to {n - 1}, found {wrong}")
        return values

    def matrix(self, n: int) -> tuple[Array, Array, Array]:
        """Row, column and value of each entry of W (n x n)."""
        rows = self.count("W/m")
        if rows != n:
            raise self.fault("W", f" is {rows} x {n}: expected as many rows as columns")
        nz = self.number("W/nz")
        if nz < COMPRESSED_ROWS:
            raise self.fault("W/nz", f" is {nz}: expected the number of triplets, -1 (compressed columns) or -2 "
                                     "(compressed rows)")
        p, i = self.numbers("W/p"), self.numbers("W/i")
        if nz < 0:
            n_entries = self.checked_pointers(p, n, len(i))
            p = np.repeat(np.arange(n), np.diff(p[:n + 1]))
        else:
            n_entries = nz
            p = self.checked_indices("W/p", p, n_entries, n)
        i = self.checked_indices("W/i", i, n_entries, n)
        row, column = (i, p) if nz == COMPRESSED_COLUMNS else (p, i)
        return row, column, self.vector("W/x", n_entries)

    def checked_pointers(self, p: Array, n: int, n_indices: int) -> Any:
        """The number of entries that pointers of compressed columns or rows lead to."""
        if len(p) < n + 1:
            raise self.fault("W/p", f": expected {n + 1} pointers, found {len(p)}")
        if p[0] != 0 or (p[1:n + 1] < p[:n]).any():
            raise self.fault("W/p", ": expected pointers that ascend from 0")
        if p[n] > n_indices:
            raise self.fault("W/p", f": expected pointers up to the number of indices, {n_indices}, found {p[n]}")
        return int(p[n])


def read_fclib(path: Path) -> Problem:
    """Reads the reduced problem of an FCLIB file."""
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        if not Path(path).exists():
            raise
        raise FileFault(f"{path}: this HDF5 file is damaged or cut short") from error
    with file:
        if "fclib_local" not in file:
            found = ("/fclib_global, a problem that still has the motions of its bodies; eliminate them first"
                     if "fclib_global" in file else "none")
            raise FileFault(f"{path}: expected the group /fclib_local of a reduced problem, found {found}")
        if "fclib_local/R" in file:
            raise FileFault(f"{path}: /fclib_local has equality constraints (R): expected a problem u = W r + q alone")
        group = _Group(path, file, "/fclib_local")
        dimension = group.count("spacedim")
        if dimension not in UNKNOWNS:
            raise group.fault("spacedim", f" is {dimension}: expected 2 or 3")
        n = group.count("W/n")
        if n % dimension:
            raise group.fault("W/n", f" is {n}: expected {UNKNOWNS[dimension]} for each contact")
        row, column, value = group.matrix(n)
        q, mu = group.vector("vectors/q", n), group.vector("vectors/mu", n//dimension)
        if (mu < 0).any():
            raise group.fault("vectors/mu", f": expected numbers that are not negative, found {mu.min()} of contact "
                                            f"{mu.argmin() + 1}")
    return Problem(row, column, value, q, mu, dimension=dimension)


def write_fclib(path: Path, problem: Problem, title: str) -> None:
    """Writes an FCLIB file, W in compressed columns, with the solution if the problem has one."""
    pointers, rows, values = problem.columns()
    n = len(problem.q)
    data = {"spacedim": [problem.dimension], "W/m": [n], "W/n": [n], "W/nzmax": [len(values)],
            "W/nz": [COMPRESSED_COLUMNS], "W/p": pointers, "W/i": rows}

    def fill(name: str) -> None:
        with h5py.File(name, "w") as file:
            group = file.create_group("fclib_local")
            for key, numbers in data.items():
                group[key] = np.asarray(numbers, dtype=np.int32)
            group["W/x"], group["vectors/q"], group["vectors/mu"] = values, problem.q, problem.mu
            group["info/title"] = np.bytes_(title.encode() or b"reduced problem")
            kind = "plane contact" if problem.dimension == 2 else "contact in space"
            group["info/description"] = np.bytes_(f"{kind} with Coulomb friction, u = W r + q")
            group["info/math_info"] = np.bytes_("written by Amontons")
            if problem.r is not None:
                file["solution/u"], file["solution/r"] = problem.displacements(), problem.r

    _write_whole(path, fill)


def read_text(path: Path) -> Problem:
    """Reads a text file of Siconos (FrictionContactProblem, dimension 2 or 3), in any of its storages."""
    try:
        return _problem_of(Path(path).read_text(encoding="utf-8"))
    except (ValueError, LookupError, StopIteration):
        raise FileFault(f"{path}: not a reduced problem in the text of Siconos; amontons --check --reduced tells in "
                        "which line") from None


def _problem_of(text: str) -> Problem:
    """The reduced problem of a text; an exception where it is none."""
    words = iter(text.split())
    dimension, m, storage, *size = _whole_numbers(words, 5)
    n = dimension*m
    if dimension not in UNKNOWNS or m < 0 or size != [n, n]:
        raise ValueError
    if storage == CSPARSE:
        entries, rest = _read_csparse(text.split("\n"), n)
        words = iter(rest.split())
    else:
        entries = {DENSE: _read_dense, BLOCKS: _read_blocks}[storage](words, n)
    row, column, value = entries
    numbers = _numbers(words, n + m)
    # Siconos writes a whole number behind mu.
    if len([int(word) for word in words]) > 1 or not np.isfinite(value).all() or (numbers[n:] < 0).any() or (
            len(row) and not 0 <= min(row.min(), column.min()) <= max(row.max(), column.max()) < n):
        raise ValueError
    return Problem(row, column, value, numbers[:n], numbers[n:], dimension=dimension)


def _whole_numbers(words: Iterator[str], n: int) -> Any:
    """The next n words as whole numbers."""
    return [int(next(words, "")) for _ in range(n)]


def _numbers(words: Iterator[str], n: int) -> Any:
    """The next n words as finite numbers."""
    values = np.array([float(next(words, "")) for _ in range(n)], dtype=np.float64)
    if not np.isfinite(values).all():
        raise ValueError
    return values


def _entries(block: Array, first_row: int = 0, first_column: int = 0) -> Any:
    """Rows, columns and values of the entries of a full matrix that are not zero."""
    row, column = np.nonzero(block)
    return row + first_row, column + first_column, block[row, column]


def _read_dense(words: Iterator[str], n: int) -> Any:
    """Reads a full matrix, column by column."""
    if _whole_numbers(words, 2) != [n, n]:
        raise ValueError
    return _entries(_numbers(words, n*n).reshape(n, n).T)


def _read_blocks(words: Iterator[str], n: int) -> Any:
    """Reads a matrix of blocks, each column by column."""
    n_blocks, n_rows, n_columns = _whole_numbers(words, 3)
    row_end, column_end = [0, *_whole_numbers(words, n_rows)], [0, *_whole_numbers(words, n_columns)]
    sizes = _whole_numbers(words, 2)
    first, block_column = _whole_numbers(words, n_rows + 1), _whole_numbers(words, n_blocks)
    if sizes != [n_rows + 1, n_blocks] or [first[0], first[-1], row_end[-1], column_end[-1]] != [0, n_blocks, n, n]:
        raise ValueError
    found = [_entries(np.empty((0, 0)))]
    for k, i in enumerate(np.repeat(np.arange(n_rows), np.diff(first))):
        j = block_column[k]
        if _whole_numbers(words, 1) != [k] or j < 0:
            raise ValueError
        height, width = row_end[i + 1] - row_end[i], column_end[j + 1] - column_end[j]
        found.append(_entries(_numbers(words, height*width).reshape(width, height).T, row_end[i], column_end[j]))
    return map(np.concatenate, zip(*found))


def _read_csparse(lines: list[str], n: int) -> Any:
    """Reads what CSparse prints of a matrix, lines `row column : value`, or `row : value` behind `col j : ...`; returns
    its entries, and the text behind it."""
    head = next(k for k, line in enumerate(lines) if re.match("CX?Sparse Version", line)) + 1
    is_triplets = {TRIPLETS: True, COLUMNS: False}[int(lines[head - 2].split()[-1])]
    before = "triplet: " if is_triplets else ""
    n_entries = re.match(f"{before}{n}-by-{n}, nzmax: *[^ ]+ nnz: *([0-9.e+]+)", lines[head])
    last = next((k for k, line in enumerate(lines) if k > head and ":" not in line), len(lines))
    found, n_columns = [], 0
    for line in lines[head + 1:last]:
        place, _, rest = line.partition(":")
        if place.split() == ["col", str(n_columns)] and not is_triplets:
            n_columns += 1
        else:
            i, j = map(int, place.split() if is_triplets else [place, str(n_columns - 1)])
            found.append((i, j, float(rest)))
    # CSparse prints six digits.
    if not n_entries or not math.isclose(len(found), float(n_entries[1]), rel_tol=5e-6) or (
            not is_triplets and n_columns != n):
        raise ValueError
    row, column = (np.array([entry[k] for entry in found], np.int64) for k in range(2))
    value = np.array([entry[2] for entry in found], np.float64)
    return (row, column, value), "\n".join(lines[last:])


def write_text(path: Path, problem: Problem) -> None:
    """Writes a text file of Siconos, W as CSparse prints its columns, but with all digits."""
    pointers, rows, values = (numbers.tolist() for numbers in problem.columns())
    n, m = len(problem.q), len(problem.mu)
    norm = max((sum(map(abs, values[first:end])) for first, end in zip(pointers, pointers[1:])), default=0.0)
    lines = [problem.dimension, m, CSPARSE, n, n, COLUMNS, "CSparse Version 3",
             f"{n}-by-{n}, nzmax: {len(values)} nnz: {len(values)}, 1-norm: {norm}"]
    for j in range(n):
        lines.append(f"    col {j} : locations {pointers[j]} to {pointers[j + 1] - 1}")
        lines += [f"      {row} : {value!r}" for row, value in zip(rows[pointers[j]:pointers[j + 1]],
                                                                  values[pointers[j]:pointers[j + 1]])]
    lines += [*problem.q.tolist(), *problem.mu.tolist()]
    _write_whole(path, lambda name: Path(name).write_text("\n".join(map(str, lines)) + "\n", encoding="utf-8"))


def _write_whole(path: Path, fill: Callable[[str], object]) -> None:
    """Writes a file under a temporary name beside its own, which it gets when it is complete."""
    handle, name = tempfile.mkstemp(dir=os.path.dirname(os.path.abspath(path)), prefix=".", suffix=".tmp")
    os.close(handle)
    try:
        fill(name)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, path)
    except BaseException:
        os.unlink(name)
        raise


def read_solution(path: Path, problem: Problem) -> Any:
    """The problem with the forces of a contact table of its own, in which u = W r + q."""
    with open(path, newline="", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    tangents = [""] if problem.dimension == 2 else ["_1", "_2"]
    motion = ["gap", *(f"slip{tangent}" for tangent in tangents)]
    forces = ["normal_force", *(f"tangential_force{tangent}" for tangent in tangents)]
    try:
        r, u = (np.array([[row[key] for key in keys] for row in rows], dtype=np.float64).ravel()
                for keys in (forces, motion))
        if len(r) != len(problem.q):
            raise FileFault(f"{path}: expected a row for each of {len(problem.mu)} contacts, found {len(rows)}")
        solved = replace(problem, r=r)
        difference = solved.displacements() - u
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, FileFault):
            raise
        raise FileFault(f"{path}: expected the columns {', '.join([*motion, *forces[:-1]])} and {forces[-1]} of "
                        "numbers") from None
    if len(u) and not np.abs(difference).max() <= CONSISTENT*max(np.abs(u).max(), np.abs(problem.q).max()):
        raise FileFault(f"{path}: gap and slip are not W r + q: not the table of amontons --reduced for this problem")
    return solved


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Converts a file; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="fclib", description="Converts a reduced problem u = W r + q: an FCLIB file (HDF5) to the text of "
                                  "Siconos, which amontons --reduced reads, or the text to an FCLIB file.")
    parser.add_argument("--solution", metavar="TABLE", help="NAME.contact.csv of amontons --reduced, whose forces go "
                                                            "to /solution of the FCLIB file")
    parser.add_argument("source", metavar="SOURCE", help="the file; its first bytes tell which kind it is")
    parser.add_argument("target", metavar="TARGET", help="the file of the other kind")
    options = parser.parse_args(arguments)
    try:
        with open(options.source, "rb") as file:
            is_fclib = file.read(len(HDF5_SIGNATURE)) == HDF5_SIGNATURE
        if not is_fclib:
            problem = read_text(options.source)
            if options.solution:
                problem = read_solution(options.solution, problem)
            write_fclib(options.target, problem, Path(options.source).name.split(".")[0])
        elif options.solution:
            parser.error("--solution is for an FCLIB file to be written")
        else:
            write_text(options.target, read_fclib(options.source))
    except FileFault as fault:
        print(fault, file=sys.stderr)
        return 1
    except OSError as error:
        print(f"{error.filename}: {error.strerror}" if error.filename else error, file=sys.stderr)
        return 1
    return 0

