"""Draws a body: its displacements magnified, a field in colors, the contact points by status, and the obstacles, with
the same magnification of the gaps between them."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.tri import Triangulation

from amontons.cases import Case, CaseFault, dimension_of
from amontons.draw_line import STATUSES, Canvas
from amontons.grid import Array, Grid
from amontons.obstacles import distance, hatching, surface

UNDEFORMED, OBSTACLE = "#888888", "#707070"
COMPONENTS = {3: ("x", "y", "z"), 6: ("xx", "yy", "zz", "xy", "yz", "xz")}
# Corners and middle nodes of a cell in their order around it, and the triangles of these that fill it.
OUTLINE = {"triangle": [0, 1, 2], "quad": [0, 1, 2, 3], "triangle6": [0, 3, 1, 4, 2, 5],
           "quad8": [0, 4, 1, 5, 2, 6, 3, 7], "quad9": [0, 4, 1, 5, 2, 6, 3, 7]}
TRIANGLES = {"triangle": [[0, 1, 2]], "quad": [[0, 1, 2], [0, 2, 3]],
             "triangle6": [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
             "quad8": [[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 7], [5, 6, 7]],
             "quad9": [[0, 4, 8], [4, 1, 8], [1, 5, 8], [5, 2, 8], [2, 6, 8], [6, 3, 8], [3, 7, 8], [7, 0, 8]]}
FINE = 2000     # cells: the lines of a finer mesh would hide its colors
UNIFORM = 1e-6  # a field that varies less, over its largest value, is drawn as uniform
ROUNDING = 1e-10  # of a strain, over the displacement that has lost its digits
VISIBLE = 1e-3  # what is smaller over the size of a body is not seen
FIELD = "von_mises"
STRAIGHT = 1e-9  # sine of a turn that is rounding
BREAK = np.full((1, 2), np.nan)  # of a line


def fields(mesh: Grid) -> dict[str, Array]:
    """The fields of a mesh by name, those of vectors and tensors by component too."""
    found = {}
    for data in (mesh.cell_data, mesh.point_data):
        for name, values in data.items():
            if values.ndim == 1:
                found[name] = values
                continue
            if values.shape[1] == 3:
                found[name] = np.linalg.norm(values[:, :3 if mesh.is_solid else 2], axis=1)
            for component, column in zip(COMPONENTS[values.shape[1]], values.T):
                found[f"{name}_{component}"] = column
    return found


def field_of(case: Case, name: str) -> tuple[Array, str]:
    """The values of a field, on cells or nodes, and its label."""
    found = fields(case.mesh)
    if name not in found:
        raise CaseFault(f"{case.path}.vtu: no field '{name}'; the fields are: {', '.join(sorted(found))}")
    text = name.replace("von_mises", "von Mises stress").replace("_", " ")
    return found[name], case.label(text, dimension_of(name))


def boundary(mesh: Grid) -> Array:
    """The outlines of a mesh, the edges that belong to one cell alone, one outline behind the other as places (n, 2)
    with a break between; nodes on straight parts are left out."""
    corners = [nodes[:, :3 if kind.startswith("tri") else 4] for kind, nodes in mesh.cells]
    edges = np.concatenate([np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2) for cells in corners])
    low, high = np.sort(edges, axis=1).T.astype(np.int64)
    _, first, count = np.unique(low * len(mesh.points) + high, return_index=True, return_counts=True)
    following: dict[int, list[int]] = {}
    for start, end in edges[first[count == 1]].tolist():
        following.setdefault(start, []).append(end)
    parts = []
    for start in list(following):
        way = [start]
        while following.get(way[-1]):
            way.append(following[way[-1]].pop())
        if len(way) > 1:
            parts += [_corners(mesh.points[way, :2]), BREAK]
    return np.concatenate(parts)


def _corners(line: Array) -> Array:
    """A line without the points where it goes straight on."""
    steps = np.diff(line, axis=0)
    turns = np.abs(steps[:-1, 0] * steps[1:, 1] - steps[:-1, 1] * steps[1:, 0])
    is_corner = turns > STRAIGHT * np.hypot(*steps[:-1].T) * np.hypot(*steps[1:].T)
    found: Array = line[np.concatenate([[True], is_corner, [True]])]
    return found


def initial_gaps(case: Case) -> Array:
    """The gap of each contact point before anything is loaded; not a number where it is out of reach."""
    line = case.line
    moved = line.point_data.get("jump", line.point_data["displacement"])
    gaps = line.point_data["gap"] + (moved * line.point_data["normal"]).sum(axis=1)
    size = np.ptp(case.mesh.points, axis=0).max()
    return np.where(np.abs(gaps) > 2 * size, np.nan, gaps)


def joints(case: Case) -> Array:
    """Which contact points are closed, between two bodies."""
    data = case.line.point_data
    found: Array = np.isin(data["set"], case.master.point_data["set"]) & (data["status"] > 1)
    return found


def slides_far(case: Case) -> bool:
    """Whether gaps and normals are those at the moved places, so that bodies are drawn where they are."""
    return "turn" in case.line.point_data


def places_opposite(case: Case, factor: float) -> Array:
    """Where obstacles are opposite the contact points, gaps magnified as displacements are (n, 2)."""
    line = case.line
    if slides_far(case):
        places, gaps = line.points + line.point_data["displacement"], line.point_data["gap"]
    else:
        places, gaps = line.points, factor * initial_gaps(case)
    found: Array = places[:, :2] + gaps[:, None] * line.point_data["normal"][:, :2]
    return found


def magnification(case: Case) -> float:
    """A round number that makes displacements visible: the largest then measures about a twelfth of the body.
    Displacements that are visible by themselves are drawn as they are, unless they are larger than the body; so are
    those beside an obstacle whose shape would be stretched with its gaps. Those that close a gap between two bodies, or
    an overlap, are magnified as far as is not seen there: the bodies would be drawn into each other, or apart."""
    gaps = np.abs(initial_gaps(case))
    size = np.ptp(case.mesh.points, axis=0).max()
    largest = np.abs(case.mesh.point_data["displacement"]).max()
    if slides_far(case) or largest == 0.0 or np.nanmax(gaps, initial=0.0) > VISIBLE * size:
        return 1.0
    wanted = size / 12.0 / largest
    most = max(1.0, VISIBLE * size / max(np.nanmax(gaps[joints(case)], initial=0.0), 1e-300))
    return 1.0 if wanted < 1.0 and largest <= size else round_factor(min(wanted, most))


def magnification_at(case: Case, points: Array) -> float:
    """The same for the part of the body at some contact points. If they are on a straight line the gaps may be
    stretched up to an eighth of it: the obstacle is then seen as it is, but higher."""
    at = case.line.points[points, :2]
    size = np.ptp(at, axis=0).max()
    largest = np.abs(case.line.point_data["displacement"][points]).max()
    gaps = np.abs(initial_gaps(case)[points])
    gap = np.nanmax(gaps, initial=0.0)
    closed = np.nanmax(gaps[joints(case)[points]], initial=0.0)
    chord = at[-1] - at[0]
    bow = np.abs((at - at[0]) @ [chord[1], -chord[0]]).max() / max(np.hypot(*chord), 1e-300)
    if slides_far(case) or min(bow, gap) > VISIBLE * size:
        return 1.0
    wanted = size / max(12.0 * largest, 8.0 * gap, closed / VISIBLE, 1e-300)
    return round_factor(wanted) if 1.0 < wanted < 1e12 else 1.0


def round_factor(wanted: float) -> float:
    """The next round number below."""
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted))


@dataclass(frozen=True)
class Field:
    """A field on a body that has moved."""
    cells: list[tuple[str, Array]]  # of its mesh
    places: Array  # of the nodes (n_nodes, 2)
    values: Array  # on cells or nodes
    label: str
    uniform: Optional[float]  # the value, where it has only one

    @property
    def limits(self) -> tuple[float, float]:
        """The values that the colors are between."""
        if self.uniform is None:
            return float(self.values.min()), float(self.values.max())
        return self.uniform - (abs(self.uniform) or 1.0), self.uniform + (abs(self.uniform) or 1.0)

    @property
    def outlines(self) -> list[Array]:
        """The corners of the cells of each kind (n_cells, n_corners, 2)."""
        return [self.places[nodes[:, OUTLINE[kind]]] for kind, nodes in self.cells]


def moved_field(case: Case, factor: float, name: str) -> Field:
    """A field on the mesh, whose displacements are multiplied by a factor."""
    mesh = case.mesh
    values, label = field_of(case, name)
    if np.abs(values).max() <= rounding(case, name):
        values = 0.0 * values
    low, high = float(values.min()), float(values.max())
    is_uniform = high - low <= UNIFORM * max(abs(low), abs(high))
    moved = mesh.points[:, :2] + factor * mesh.point_data["displacement"][:, :2]
    return Field(mesh.cells, moved, values, label, (low + high) / 2 if is_uniform else None)


def draw_field(axes: Axes, field: Field, has_lines: bool) -> Any:
    """A field in colors, with lines between the cells or not; returns what a bar is made for."""
    outlines = [outline for outlines in field.outlines for outline in outlines]
    has_lines = has_lines and len(outlines) <= FINE
    if len(field.values) == len(field.places):
        triangles = np.concatenate([nodes[:, TRIANGLES[kind]].reshape(-1, 3) for kind, nodes in field.cells])
        drawn = axes.tripcolor(Triangulation(*field.places.T, triangles), field.values, shading="gouraud",
                               cmap="cividis", rasterized=True)
        if has_lines:
            axes.add_collection(PolyCollection(outlines, facecolors="none", edgecolors="white", linewidths=0.15,
                                               rasterized=True))
    else:
        drawn = axes.add_collection(PolyCollection(outlines, array=field.values, cmap="cividis", linewidths=0.15,
                                                   edgecolors="white" if has_lines else "face",
                                                   antialiased=has_lines, rasterized=not has_lines))
    drawn.set_clim(*field.limits)
    return drawn


def rounding(case: Case, name: str) -> float:
    """What rounding may leave of a field that is 0: of a stress, of which a body that is only moved has none."""
    if dimension_of(name) != "F/L²":
        return 0.0
    try:
        young = max((np.max(material["young"]) for material in case.groups("material")), default=0.0)
    except OSError:
        return 0.0
    size = np.ptp(case.mesh.points, axis=0).max()
    return float(ROUNDING * young * np.abs(case.mesh.point_data["displacement"]).max() / size)


def draw_bar(axes: Axes, drawn: Any, label: str, uniform: Optional[float] = None) -> None:
    """The bar of a field; of a uniform one it has its one value."""
    bar = axes.figure.colorbar(drawn, cax=axes.inset_axes([1.03, 0.0, 0.035, 1.0]),
                               ticks=None if uniform is None else [uniform])
    bar.set_label(label if uniform is None else label + ", uniform")
    bar.outline.set_linewidth(0.4)
    bar.solids.set_rasterized(True)  # as one image: viewers draw seams between the patches of a vector bar
    if uniform is not None:
        bar.ax.set_yticklabels([f"{uniform:.4g}"])


def surfaces(case: Case, factor: float, window: Array) -> list[Array]:
    """The obstacles as lines: as the deck describes them, or, where gaps are magnified, through the places that they
    then have opposite the contact points; so, too, where an obstacle has moved or a file that describes it is gone."""
    gaps, line, found = initial_gaps(case), case.line, []
    places = places_opposite(case, factor)
    size = np.ptp(window, axis=0).max()
    try:
        contacts = case.contacts
    except OSError:
        contacts = []
    for number in np.setdiff1d(line.point_data["set"], case.master.point_data["set"]):
        here = (line.point_data["set"] == number) & np.isfinite(gaps)
        if factor == 1.0 or not (np.abs(gaps[here]) > UNIFORM * size).any():
            try:
                described = surface(contacts[number - 1], window)
            except (OSError, LookupError, ValueError):
                described = None
            opposite = places[here & ((places >= window[0]) & (places <= window[1])).all(axis=1)]
            if described is not None and distance(opposite, described) < VISIBLE * size:
                found.append(described)
                continue
        if here.sum() > 1:
            found.append(places[here])
    return [one for i, one in enumerate(found) if not any(np.array_equal(one, other) for other in found[:i])]


def draw_obstacles(axes: Canvas, case: Case, factor: float, window: Array) -> None:
    """The surfaces of the obstacles, hatched on their solid side."""
    for line in surfaces(case, factor, window):
        axes.plot(*line.T, color=OBSTACLE, linewidth=1.0, scalex=False, scaley=False, zorder=1.5)
        strokes = hatching(line, window, np.hypot(*np.ptp(window, axis=0)) / 60)
        if len(strokes):
            ways = np.insert(strokes, 2, np.nan, axis=1).reshape(-1, 2)
            axes.plot(*ways.T, color=OBSTACLE, linewidth=0.4, scalex=False, scaley=False, zorder=1.4)


def draw_points(axes: Canvas, case: Case, factor: float) -> Array:
    """The contact points, by status. Returns where they are drawn."""
    line = case.line
    at: Array = line.points[:, :2] + factor * line.point_data["displacement"][:, :2]
    for status, (label, color, marker) in enumerate(STATUSES, start=1):
        here = at[line.point_data["status"] == status]
        if len(here):
            axes.plot(*here.T, linestyle="none", marker=marker, color=color, markersize=3 if len(at) < 150 else 2,
                      label=f"{label} ({len(here)})")
    return at


def window_of(case: Case, factor: float) -> Array:
    """What is shown of the plane: the body before and after, and what of the obstacles is near; lower left and upper
    right corner."""
    mesh, line, gaps = case.mesh, case.line, initial_gaps(case)
    size = np.ptp(mesh.points[:, :2], axis=0).max()
    gaps = line.point_data["gap"] if slides_far(case) else factor * gaps
    near = places_opposite(case, factor)[np.abs(gaps) < size / 3]
    shown = np.concatenate([mesh.points[:, :2], near,
                            mesh.points[:, :2] + factor * mesh.point_data["displacement"][:, :2]])
    margin = 0.04 * np.ptp(shown, axis=0).max()
    return np.array([shown.min(axis=0) - margin, shown.max(axis=0) + margin])


def true_or_times(case: Case, factor: float) -> str:
    """What is said of a magnification."""
    if factor == 1.0:
        return "displacements to scale"
    return f"displacements{' and gaps' if len(case.line.points) else ''} × {factor:g}"


def draw_scene(axes: Canvas, case: Case, factor: float) -> None:
    """The shape of the body before, its contact points, the obstacles, and what the axes say."""
    window = window_of(case, factor)
    axes.plot(*boundary(case.mesh).T, color=UNDEFORMED, linestyle="--", linewidth=0.5)
    draw_obstacles(axes, case, factor, window)
    draw_points(axes, case, factor)
    axes.set(aspect="equal", xlabel=case.label("x", "L"), ylabel=case.label("y", "L"), xlim=window[:, 0],
             ylim=window[:, 1], title=true_or_times(case, factor))


def draw_body(axes: Axes, case: Case, name: str, factor: Optional[float] = None) -> None:
    """The body with a field and its bar, its shape before, its contact points and the obstacles."""
    factor = magnification(case) if factor is None else factor
    field = moved_field(case, factor, name)
    drawn = draw_field(axes, field, has_lines=True)
    draw_scene(axes, case, factor)
    draw_bar(axes, drawn, field.label, field.uniform)
    if len(case.line.points):
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=4.6, ncols=2, frameon=False)


def draw_zone(axes: Canvas, case: Case, shown: Array, factor: float) -> None:
    """What is near the contact points that are shown, without the body."""
    at = draw_points(axes, case, factor)[shown]
    half = max(np.ptp(at, axis=0).max(), np.ptp(case.line.points[shown, :2], axis=0).max()) / 2
    inwards = -case.line.point_data["normal"][shown, :2].mean(axis=0)
    middle = (at.min(axis=0) + at.max(axis=0)) / 2 + 0.3 * half * inwards
    window = middle + np.array([[-1.0, -0.5], [1.0, 0.5]]) * half
    draw_obstacles(axes, case, factor, window)
    axes.set(aspect="equal", xlim=window[:, 0], ylim=window[:, 1], title="closed zone, " + true_or_times(case, factor))


def draw_detail(axes: Axes, case: Case, name: str, shown: Array, factor: Optional[float] = None) -> None:
    """The body once more, near the contact points that are shown."""
    factor = magnification_at(case, shown) if factor is None else factor
    draw_field(axes, moved_field(case, factor, name), has_lines=True)
    draw_zone(axes, case, shown, factor)
