"""Solves decks and reduced problems with the library.

What the program refuses raises an exception with the program's sentence. What does not converge is returned, with a
warning and `is_solved` False. The module loads libamontons_c.so: the file that the environment variable
AMONTONS_LIBRARY names, else the one of the wheel, the installation or the build tree it is part of, else the one that
the system finds. Calls release Python's lock; from several threads they wait for each other, and each has threads of
its own inside.
"""
from __future__ import annotations

import csv
import ctypes
import ctypes.util
import os
import re
import tempfile
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from amontons.arguments import AmontonsError, InputRefused, real_number, real_numbers, whole_number
from amontons.cases import Case, CaseFault
from amontons.deck import deck_text, value_text
from amontons.grid import Array
from amontons.mesh import Mesh

Deck = Union[str, "os.PathLike[str]", Mapping[str, Any]]
STATUSES = np.array(["", "open", "stick", "slip+", "slip-", "slip"])
WORDS = ("status", "pair", "outcome", "warnings", "statuses")  # columns of tables
TEXT_SIZE = 65536
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NO_FILE = os.strerror(2)  # what a message ends with where a file is not there


class FileMissing(InputRefused, FileNotFoundError):
    """A deck, or a file that it names, is not there."""


class NumericalFailure(AmontonsError, ArithmeticError):
    """The numbers are at fault: a stiffness that is not positive definite, numbers out of range."""


class NoEquilibrium(NumericalFailure):
    """Contact and friction cannot balance the loads, or nothing holds the body: the answer to a case, not a failure.
    `result` has what a history reached before a later step had none, and the table of a sweep."""
    result: Optional[DeckResult] = None


class SystemFailure(AmontonsError, OSError):
    """The machine is at fault: a file cannot be written."""


class DoubtfulResult(UserWarning):
    """What is doubtful about a model and its result: one of the warnings of its summary."""


class NotConverged(DoubtfulResult):
    """A result is there, but not to the tolerance, or its certificate failed."""


class _Sentence(str):
    """The text of a warning. It equals one that differs in its numbers alone: Python prints equal warnings once for
    each place, and a loop over loads or sizes warns of the same thing with other numbers."""

    def _kind(self) -> str:
        return NUMBER.sub("#", str(self))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Sentence) and self._kind() == other._kind()

    def __hash__(self) -> int:
        return hash(self._kind())


# By the codes of amontons.h
ERRORS: dict[int, type[AmontonsError]] = {1: InputRefused, 2: NumericalFailure, 3: SystemFailure, 6: NoEquilibrium}


@dataclass(frozen=True)
class ReducedResult:
    """The solution of a reduced problem; unknowns as in `solve_reduced`."""
    r: Array       # forces (dm)
    u: Array       # displacements or velocities (dm)
    status: Array  # 'open', 'stick', 'slip+' or 'slip-'; in space 'open', 'stick' or 'slip' (m)
    residual: float
    iterations: int
    is_solved: bool


class DeckResult(Case):
    """What a deck left; doc/output.md explains every column and member. `mesh` and `line` are the grids of the body and
    of its contact line; a sweep and a reduced problem have none."""

    def __init__(self, path: Path, is_kept: bool, is_solved: bool) -> None:
        super().__init__(path)
        self.name: str = path.name                   # name of the case
        self.is_solved: bool = is_solved             # whether it converged and is certified
        self.directory: Optional[Path] = path.parent if is_kept else None  # where its files are, if they are kept
        # A directory that is kept may hold files of an earlier deck of the same name.
        is_sweep = self.kind == "sweep"
        self.contact: Optional[dict[str, Array]] = None  # columns of NAME.contact.csv, but of a sweep
        self.sweep: Optional[dict[str, Array]] = None    # columns of NAME.sweep.csv, one row per case
        self.history: Optional[dict[str, Array]] = None  # columns of NAME.history.csv, one row per step
        if self.is_history:
            self.history = _read_table(f"{path}.history.csv")
        if is_sweep:
            self.sweep = _read_table(f"{path}.sweep.csv")
        else:
            self.contact = _read_table(f"{path}.contact.csv")
        if self.kind == "body" and not is_kept:
            self.mesh, self.line, self.contacts  # read while the files are there  # pylint: disable=W0104

    @property
    def nodes(self) -> Array:
        """Coordinates of the nodes (n_nodes, 2), of a solid (n_nodes, 3)."""
        return self.mesh.points[:, :3 if self.mesh.is_solid else 2]

    @property
    def cells(self) -> list[tuple[str, Array]]:
        """Pairs: the kind of some cells, and their nodes, from 0 (n_cells, n)."""
        return self.mesh.cells

    @property
    def displacement(self) -> Array:
        """Displacements of the nodes (n_nodes, 2), of a solid (n_nodes, 3); of a twisted body also around the axis."""
        twists = any(material.get("twist") == ".true." for material in self.groups("material"))
        return self.mesh.point_data["displacement"][:, :3 if twists or self.mesh.is_solid else 2]

    @property
    def stress(self) -> Array:
        """Mean stresses of the cells, tension positive: xx, yy, zz, xy, yz, xz (n_cells, 6)."""
        return self.mesh.cell_data["stress"]

    @property
    def nodal_stress(self) -> Array:
        """Stresses at the nodes, as `stress` (n_nodes, 6)."""
        return self.mesh.point_data["nodal_stress"]


def _library_path() -> str:
    """Where the library is: beside the package's files in a wheel, in the folder of the libraries, which the package's
    own folder is in, in an installation or a build tree."""
    named = os.environ.get("AMONTONS_LIBRARY")
    if named:
        return named
    package = Path(__file__).absolute().parent
    found = [path for folder in (package, package.parent.parent) for path in sorted(folder.glob("libamontons_c.so*"))]
    return str(found[0]) if found else ctypes.util.find_library("amontons_c") or "libamontons_c.so"


def _load() -> ctypes.CDLL:
    """Loads the library and declares its procedures."""
    library = ctypes.CDLL(_library_path())
    numbers = np.ctypeslib.ndpointer(np.float64, flags="F_CONTIGUOUS")
    text, size = ctypes.c_char_p, ctypes.c_int
    library.amontons_version_text.restype = text
    library.amontons_version_text.argtypes = []
    library.amontons_set_threads.restype = None
    library.amontons_set_threads.argtypes = [ctypes.c_int]
    library.amontons_solve_deck.argtypes = [text, text, text, size, text, size]
    library.amontons_solve_deck_text.argtypes = [text, text, text, text, text, size, text, size]
    address, counts = ctypes.c_void_p, ctypes.POINTER(ctypes.c_int)
    library.amontons_new_stepper.argtypes = [text, text, text, ctypes.POINTER(address), counts, counts, counts, text,
                                             size, text, size]
    library.amontons_step.argtypes = [address, ctypes.c_double, size, numbers, size, numbers, numbers, size, numbers,
                                      size, address, np.ctypeslib.ndpointer(np.intc), text, size]
    library.amontons_stepper_points.argtypes = [address, size, numbers]
    library.amontons_stepper_frames.argtypes = [address, size, numbers]
    library.amontons_free_stepper.argtypes = [address]
    library.amontons_free_stepper.restype = None
    library.amontons_solve_contacts.argtypes = [
        ctypes.c_int, ctypes.c_int, numbers, numbers, numbers, text, ctypes.c_double, ctypes.c_int, numbers, numbers,
        np.ctypeslib.ndpointer(np.intc), ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int), text, size]
    return library


_library = _load()


def version() -> str:
    """The version, 'major.minor.patch'."""
    return str(_library.amontons_version_text().decode())


def set_threads(n_threads: int) -> None:
    """Sets the number of threads of the loops inside, and one thread for the BLAS; to be called first, if at all."""
    _library.amontons_set_threads(whole_number(n_threads, "n_threads"))


def _judge(code: int, message: ctypes.Array[ctypes.c_char], n_callers: int) -> bool:
    """Raises what a return code stands for; returns whether the problem is solved. A warning points above the callers
    that are in this module."""
    sentence = message.value.decode(errors="replace")
    if code in ERRORS:
        kind = ERRORS[code]
        if code == 1 and sentence.endswith(NO_FILE):
            kind = FileMissing
        raise kind(sentence)
    if code:
        warnings.warn(_Sentence(sentence), NotConverged, stacklevel=n_callers + 1)
    return code == 0


def solve_reduced(W: ArrayLike, q: ArrayLike, mu: ArrayLike, method: str = "auto", tolerance: float = 1e-10,
                  max_iterations: int = 1000, dimension: Optional[int] = None) -> ReducedResult:
    """Solves u = W r + q with friction: 0 <= u_N _|_ r_N >= 0, |r_T| <= mu r_N, r_T opposes u_T.

    W is symmetric and positive semidefinite (dm x dm; a sparse matrix of SciPy is made dense), q has dm numbers, mu m
    numbers, or one for all contacts. `dimension` is d: 2 in the plane, 3 in space; where it is not given, 3 if q has
    three numbers for each of mu, else 2. The unknowns of a contact stand together, the normal one first. `method` is a
    word for `&solver method` in a deck.
    """
    W = np.asfortranarray(real_numbers(W.toarray() if hasattr(W, "toarray") else W, "W"))
    q = np.ascontiguousarray(real_numbers(q, "q"))
    mu = real_numbers(mu, "mu")
    if dimension is None:
        dimension = 3 if mu.ndim == 1 and q.size == 3*mu.size > 0 else 2
    dimension = whole_number(dimension, "dimension")
    if not isinstance(method, str):
        raise InputRefused(f"method: expected the name of a method, found {type(method).__name__}")
    if dimension not in (2, 3):
        raise InputRefused(f"expected dimension = 2 or 3, found {dimension}")
    if q.ndim != 1 or q.size % dimension or W.shape != (q.size, q.size):
        raise InputRefused(f"expected W of {dimension}m x {dimension}m numbers and q of {dimension}m, found {W.shape} "
                           f"and {q.shape}")
    m = q.size // dimension
    try:
        mu = np.ascontiguousarray(np.broadcast_to(mu, (m,)))
    except ValueError:
        raise InputRefused(f"expected one mu, or one for each of {m} contacts, found {np.shape(mu)}") from None
    r, u, status = np.zeros(q.size), np.zeros(q.size), np.zeros(m, dtype=np.intc)
    residual, iterations = ctypes.c_double(), ctypes.c_int()
    message = ctypes.create_string_buffer(TEXT_SIZE)
    code = _library.amontons_solve_contacts(
        dimension, m, W, q, mu, method.encode(), real_number(tolerance, "tolerance"),
        whole_number(max_iterations, "max_iterations"), r, u, status, ctypes.byref(residual), ctypes.byref(iterations),
        message, TEXT_SIZE)
    is_solved = _judge(code, message, n_callers=2)
    return ReducedResult(r, u, STATUSES[status], residual.value, iterations.value, is_solved)


@dataclass(frozen=True)
class StepState:
    """A body after a step of a `Stepper`, or at rest."""
    raw: Array              # all that the next step needs; may be kept, copied and handed to another process
    columns: dict[str, float]    # the numbers of the step, as in NAME.history.csv; none at rest
    normal_force: Array     # of each contact point, as are the others
    tangential_force: Array     # of a twisted body two rows, in the plane and around the axis (2, n_points); of a solid
                            # vectors, as the slip of a step along x, y and z (3, n_points)
    normal_displacement: Array
    tangential_displacement: Array    # likewise
    slip_step: Array        # likewise
    slip_accumulated: Array
    dissipation: Array
    wear_depth: Array       # with the key `wear` of &contact: what was worn, which the next step adds to the gaps
    status: Array           # 'open', 'stick', 'slip+' or 'slip-'; of a twisted body or a solid 'open', 'stick' or
                            # 'slip'


@dataclass(frozen=True)
class ContactPoints:
    """Where the contact points of a `Stepper` are, in the order of all arrays of a state."""
    x: Array
    y: Array
    weight: Array           # the length of the contact line that belongs to each; of a solid the area
    area: Array             # and its area: that length times the thickness, or the way around the axis
    z: Array                # of a solid; else 0
    normal: Array           # unit normals of the body, towards the obstacle (2, n_points), of a solid (3, n_points)


class Stepper:
    """Steps of a history whose loads the caller chooses, one call for each: `state = stepper.step(state, 1.0, ...)`.

    The deck, given as to `solve_deck`, has `&history` and a `&steps` for whatever changes; their values and the times
    do not matter. A mesh of arrays takes the place of its `&mesh`. `changes` names what changes, as the columns of
    NAME.history.csv do: `factor_F`, `shift_x_floor`.
    """

    def __init__(self, deck: Deck, *, mesh: Optional[Mesh] = None, **settings: Any) -> None:
        self._address = ctypes.c_void_p()
        text, file = _text_of(deck)
        text = _bytes_of(file) if text is None else text
        counts = [ctypes.c_int() for _ in range(3)]
        names, message = ctypes.create_string_buffer(TEXT_SIZE), ctypes.create_string_buffer(TEXT_SIZE)
        with tempfile.TemporaryDirectory(prefix="amontons_") as scratch:
            lines = _lines_of(_with_mesh(settings, mesh, Path(scratch)))
            code = _library.amontons_new_stepper(text, os.fsencode(file), lines, ctypes.byref(self._address),
                                                 *map(ctypes.byref, counts), names, TEXT_SIZE, message, TEXT_SIZE)
        _judge(code, message, n_callers=2)
        n_changes, self.n_points, self._n_state = (count.value for count in counts)
        self._columns = next(csv.reader([names.value.decode()]))
        self.changes = self._columns[1:n_changes + 1]
        points, frames = np.zeros((4, self.n_points)), np.zeros((self.n_points, 4, 3))
        self._n_tangents = _library.amontons_stepper_points(self._address, self.n_points, points.T)
        n_dim = _library.amontons_stepper_frames(self._address, self.n_points, frames.T)
        self.points = ContactPoints(*points, frames[:, 0, 2], frames[:, 1, :n_dim].T)
        self._tangents = frames[:, 2:] if n_dim == 3 else None

    def __del__(self) -> None:
        if getattr(self, "_address", None):
            _library.amontons_free_stepper(self._address)
            self._address = ctypes.c_void_p()

    def __reduce_ex__(self, protocol: object) -> tuple[Any, ...]:
        # Its body is in the library, which frees it once: there are no copies.
        raise TypeError("a Stepper can be neither copied nor pickled: make another one of the deck, or share this one; "
                        "the states that its steps return can be copied and pickled")

    def rest(self) -> StepState:
        """The body before the first step: at rest and unstressed."""
        return self._state(np.zeros(self._n_state), {}, np.ones(self.n_points, dtype=np.intc))

    def step(self, before: StepState, time: float, *, gap: Optional[ArrayLike] = None, **changes: float) -> StepState:
        """The state after a step to a time at which the changes have the numbers given. Nothing else is altered, so
        that the step may be taken again from the same state. One that does not converge raises `NumericalFailure`, one
        whose loads nothing can balance `NoEquilibrium`.

        `gap` is added to the gaps that deck, changes and wear give in this step: a number, or one for each contact
        point. Anchors, slips and works stay those of the state before."""
        if sorted(changes) != sorted(self.changes):
            raise InputRefused(f"expected {', '.join(self.changes)}, found {', '.join(changes) or 'nothing'}")
        if not isinstance(before, StepState):
            raise InputRefused(f"expected a state that rest or step returned, found {type(before).__name__}")
        time = real_number(time, "time")
        numbers = np.array([real_number(changes[name], name) for name in self.changes], dtype=np.float64)
        after, columns = np.zeros(self._n_state), np.zeros(len(self._columns))
        status = np.zeros(self.n_points, dtype=np.intc)
        message = ctypes.create_string_buffer(TEXT_SIZE)
        raw = np.ascontiguousarray(real_numbers(before.raw, "state"))
        added = real_numbers(0.0 if gap is None else gap, "gap")
        try:
            added = np.ascontiguousarray(np.broadcast_to(added, (self.n_points,)))
        except ValueError:
            raise InputRefused(f"expected a gap for each of {self.n_points} contact points, found "
                               f"{np.shape(gap)}") from None
        code = _library.amontons_step(self._address, time, numbers.size, numbers, raw.size, raw, after, columns.size,
                                      columns, self.n_points, added.ctypes.data, status, message, TEXT_SIZE)
        if code == 4:
            raise NumericalFailure(f"the step to {time} does not converge; a shorter one may")
        _judge(code, message, n_callers=2)
        return self._state(after, dict(zip(self._columns, columns.tolist())), status)

    def _state(self, raw: Array, columns: dict[str, float], status: Array) -> StepState:
        """A state with its parts."""
        n = self._n_tangents
        rows = raw[raw.size - (7 + 3*n)*self.n_points:].reshape(7 + 3*n, self.n_points)
        normal, tangential, u_normal, u_tangential, anchor, (slip, dissipation, _, _, depth) = \
            np.split(rows, np.cumsum([1, n, 1, n, n]))
        if n == 1:
            tangential, u_tangential, anchor = tangential[0], u_tangential[0], anchor[0]
        elif self._tangents is not None:
            tangential, u_tangential, anchor = (np.einsum("tp,ptx->xp", components, self._tangents)
                                                for components in (tangential, u_tangential, anchor))
        return StepState(raw, columns, normal[0], tangential, u_normal[0], u_tangential, u_tangential - anchor, slip,
                         dissipation, depth, STATUSES[status])


def solve_deck(deck: Deck, output: Union[str, os.PathLike[str], None] = None, *, mesh: Optional[Mesh] = None,
               **settings: Any) -> DeckResult:
    """Solves a deck as the program does; its files go to the directory `output`, or nowhere.

    The deck is the name of a file, a text (a str that begins with & or !) or a dict of groups (`deck_text`). Files that
    a text or dict names are seen from the current directory. A mesh of arrays takes the place of its `&mesh`.

    Settings take the place of what the deck says, as the option --set of the program does: `contact__friction=0.3`, or
    `load__2__traction=(6, 0)` for the second of several groups; `**{"load(2).traction": (6, 0)}` is the same.
    """
    if output is None:
        with tempfile.TemporaryDirectory(prefix="amontons_") as scratch:
            return _solve_deck(deck, Path(scratch), mesh, settings, is_kept=False)
    return _solve_deck(deck, Path(output), mesh, settings, is_kept=True)


def _solve_deck(deck: Deck, output: Path, mesh: Optional[Mesh], settings: Mapping[str, Any],
                is_kept: bool) -> DeckResult:
    """Solves a deck and reads the files it leaves in a directory."""
    settings = _with_mesh(settings, mesh, output)
    name, message = ctypes.create_string_buffer(TEXT_SIZE), ctypes.create_string_buffer(TEXT_SIZE)
    tail = (os.fsencode(output), name, TEXT_SIZE, message, TEXT_SIZE)
    text, deck_file = _text_of(deck)
    if text is None and not settings:
        code = _library.amontons_solve_deck(os.fsencode(deck_file), *tail)
    else:
        if text is None:
            text = _bytes_of(deck_file)
        code = _library.amontons_solve_deck_text(text, os.fsencode(deck_file), _lines_of(settings), *tail)
    try:
        is_solved = _judge(code, message, n_callers=3)
    except NoEquilibrium as answer:
        reached = output / os.fsdecode(name.value)
        if _says(reached, str(answer)) and any(Path(f"{reached}.{end}").exists() for end in ("vtu", "sweep.csv")):
            answer.result = DeckResult(reached, is_kept, False)
        raise
    result = DeckResult(output / os.fsdecode(name.value), is_kept, is_solved)
    for sentence in result.summary.get("warnings", []):
        warnings.warn(_Sentence(sentence), DoubtfulResult, stacklevel=3)
    return result


def _says(path: Path, sentence: str) -> bool:
    """Whether files of a case are those of a run that ended with a sentence: there may be others, of an earlier one."""
    try:
        summary = Case(path).summary
    except (CaseFault, OSError):
        return False
    said = summary.get("message") or summary.get("load_history", {}).get("end")
    return bool(said) and said in sentence


def _with_mesh(settings: Mapping[str, Any], mesh: Optional[Mesh], directory: Path) -> Mapping[str, Any]:
    """Settings that name the file of a mesh, which is written into a directory, if there is one."""
    if mesh is None:
        return settings
    try:
        directory.mkdir(parents=True, exist_ok=True)
        file = mesh.write(directory).absolute()
    except OSError as error:
        raise SystemFailure(f"{error.filename}: cannot write the mesh there: {error.strerror}") from None
    return {"mesh.kind": "file", "mesh.file": file, **settings}


def _lines_of(settings: Mapping[str, Any]) -> bytes:
    """Settings as the library takes them, a line each."""
    return os.fsencode("\n".join(f"{_key(key)}={value_text(value)}" for key, value in settings.items()))


def _text_of(deck: Deck) -> tuple[Optional[bytes], Union[str, os.PathLike[str]]]:
    """The text of a deck, None if it is in a file, and its name."""
    if isinstance(deck, Mapping):
        deck = deck_text(deck)
    elif not isinstance(deck, (str, bytes, os.PathLike)):
        raise InputRefused("deck: expected the name of a file, a text or a dict of groups, found "
                           + type(deck).__name__)
    elif not (isinstance(deck, str) and deck.lstrip()[:1] in ("&", "!")):
        return None, deck
    if "\0" in deck:
        raise InputRefused("deck: a character of code 0")
    return os.fsencode(deck), "deck"


def _bytes_of(file: Union[str, os.PathLike[str]]) -> bytes:
    """The bytes of a deck in a file."""
    try:
        return Path(file).read_bytes()
    except OSError as error:
        kind = FileMissing if isinstance(error, FileNotFoundError) else InputRefused
        raise kind(f"{os.fspath(file)}: cannot read this file: {error.strerror}") from None


def _key(key: str) -> str:
    """A keyword as the option --set has it: `load__2__traction` is `load(2).traction`."""
    if "__" not in key and "." not in key:
        raise InputRefused(f"unknown setting '{key}'; settings are called GROUP__KEY, such as contact__friction=0.3")
    return re.sub(r"^([a-z]+)__(\d+)__", r"\1(\2).", key, flags=re.IGNORECASE).replace("__", ".", 1)


def _read_table(path: str) -> dict[str, Array]:
    """Reads a table: a column of numbers as an array of them (not a number where a case has none), any other as an
    array of words."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    columns = zip(*rows) if rows else ([] for _ in header)
    return {key: np.array(column) if key in WORDS else _numbers(column) for key, column in zip(header, columns)}


def _numbers(cells: Iterable[str]) -> Array:
    """Turns the cells of a column of numbers into an array, of whole numbers where they are."""
    try:
        return np.array([int(cell) for cell in cells], dtype=int)
    except ValueError:
        return np.array([float(cell or "nan") for cell in cells])
