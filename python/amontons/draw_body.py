"""Draws a body: its displacements magnified, a field in colors, the contact points by status, and the obstacles, with
the same magnification of the gaps between them."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.tri import Triangulation

from amontons.cases import Case, CaseFault, dimension_of
from amontons.grid import Array, Grid
from amontons.obstacles import distance, hatching, surface

# Okabe and Ito's colors, told apart by color-blind readers too; a marker says the same once more.
STATUSES = (("open", "#D55E00", "o"), ("stick", "#009E73", "s"), ("slip along t", "#0072B2", ">"),
            ("slip against t", "#56B4E9", "<"))
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


def fields(mesh: Grid) -> dict[str, Array]:
    """The fields of a mesh by name, those of vectors and tensors by component too."""
    found = {}
    for data in (mesh.cell_data, mesh.point_data):
        for name, values in data.items():
            if values.ndim == 1:
                found[name] = values
                continue
            if values.shape[1] == 3:
                found[name] = np.hypot(values[:, 0], values[:, 1])
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
    """The edges that belong to one cell alone (pairs of nodes)."""
    corners = [nodes[:, :3 if kind.startswith("tri") else 4] for kind, nodes in mesh.cells]
    edges = np.concatenate([np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1).reshape(-1, 2) for cells in corners])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    found: Array = edges[first[count == 1]]
    return found


def initial_gaps(case: Case) -> Array:
    """The gap of each contact point before anything is loaded; not a number where it is out of reach."""
    line = case.line
    moved = line.point_data.get("jump", line.point_data["displacement"])
    gaps = line.point_data["gap"] + (moved * line.point_data["normal"]).sum(axis=1)
    size = np.ptp(case.mesh.points[:, :2], axis=0).max()
    return np.where(np.abs(gaps) > 2 * size, np.nan, gaps)


def magnification(case: Case) -> float:
    """A round number that makes displacements visible: the largest then measures about a twelfth of the body.
    Displacements that are visible by themselves are drawn as they are, unless they are larger than the body; so are
    those beside an obstacle whose shape would be stretched with its gaps."""
    size = np.ptp(case.mesh.points[:, :2], axis=0).max()
    largest = np.abs(case.mesh.point_data["displacement"]).max()
    if largest == 0.0 or np.nanmax(np.abs(initial_gaps(case)), initial=0.0) > VISIBLE * size:
        return 1.0
    wanted = size / 12.0 / largest
    return 1.0 if wanted < 1.0 and largest <= size else round_factor(wanted)


def magnification_at(case: Case, points: Array) -> float:
    """The same for the part of the body at some contact points. If they are on a straight line their gaps may be
    stretched up to an eighth of it: the obstacle is then seen as it is, but higher."""
    at = case.line.points[points, :2]
    size = np.ptp(at, axis=0).max()
    largest = np.abs(case.line.point_data["displacement"][points]).max()
    gap = np.nanmax(np.abs(initial_gaps(case)[points]), initial=0.0)
    chord = at[-1] - at[0]
    bow = np.abs((at - at[0]) @ [chord[1], -chord[0]]).max() / max(np.hypot(*chord), 1e-300)
    if min(bow, gap) > VISIBLE * size:
        return 1.0
    wanted = size / max(12.0 * largest, 8.0 * gap, 1e-300)
    return round_factor(wanted) if 1.0 < wanted < 1e12 else 1.0


def round_factor(wanted: float) -> float:
    """The next round number below."""
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted))


def draw_field(axes: Axes, case: Case, factor: float, name: str, has_lines: bool) -> tuple[Any, str, Optional[float]]:
    """The mesh, its displacements multiplied by a factor, colored by a field; with lines between its cells or not."""
    mesh = case.mesh
    values, label = field_of(case, name)
    moved = mesh.points[:, :2] + factor * mesh.point_data["displacement"][:, :2]
    outlines = [polygon for kind, nodes in mesh.cells for polygon in moved[nodes[:, OUTLINE[kind]]]]
    has_lines = has_lines and len(outlines) <= FINE
    if len(values) == len(moved):
        triangles = np.concatenate([nodes[:, TRIANGLES[kind]].reshape(-1, 3) for kind, nodes in mesh.cells])
        drawn = axes.tripcolor(Triangulation(*moved.T, triangles), values, shading="gouraud", cmap="cividis",
                               rasterized=True)
        if has_lines:
            axes.add_collection(PolyCollection(outlines, facecolors="none", edgecolors="white", linewidths=0.15,
                                               rasterized=True))
    else:
        drawn = axes.add_collection(PolyCollection(outlines, array=values, cmap="cividis", linewidths=0.15,
                                                   edgecolors="white" if has_lines else "face",
                                                   antialiased=has_lines, rasterized=not has_lines))
    middle = (values.max() + values.min()) / 2
    if np.abs(values).max() <= rounding(case, name):
        values, middle = 0.0 * values, 0.0
        drawn.set_array(values)
    is_uniform = np.ptp(values) <= UNIFORM * np.abs(values).max()
    if is_uniform:
        drawn.set_clim(middle - (abs(middle) or 1.0), middle + (abs(middle) or 1.0))
    return drawn, label, middle if is_uniform else None


def rounding(case: Case, name: str) -> float:
    """What rounding may leave of a field that is 0: of a stress, of which a body that is only moved has none."""
    if dimension_of(name) != "F/L²":
        return 0.0
    try:
        young = max((float(material["young"]) for material in case.groups("material")), default=0.0)
    except OSError:
        return 0.0
    size = np.ptp(case.mesh.points[:, :2], axis=0).max()
    return float(ROUNDING * young * np.abs(case.mesh.point_data["displacement"]).max() / size)


def draw_bar(axes: Axes, drawn: Any, label: str, uniform: Optional[float]) -> None:
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
    places = line.points[:, :2] + (factor * gaps)[:, None] * line.point_data["normal"][:, :2]
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


def draw_obstacles(axes: Axes, case: Case, factor: float, window: Array) -> None:
    """The surfaces of the obstacles, hatched on their solid side."""
    for line in surfaces(case, factor, window):
        axes.plot(*line.T, color=OBSTACLE, linewidth=1.0, scalex=False, scaley=False, zorder=1.5)
        strokes = hatching(line, window, np.hypot(*np.ptp(window, axis=0)) / 60)
        axes.add_collection(LineCollection(strokes, colors=OBSTACLE, linewidths=0.4, zorder=1.4), autolim=False)


def draw_points(axes: Axes, case: Case, factor: float) -> Array:
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
    places = line.points[:, :2] + (factor * gaps)[:, None] * line.point_data["normal"][:, :2]
    size = np.ptp(mesh.points[:, :2], axis=0).max()
    near = places[np.abs(factor * gaps) < size / 3]
    shown = np.concatenate([mesh.points[:, :2], near,
                            mesh.points[:, :2] + factor * mesh.point_data["displacement"][:, :2]])
    margin = 0.04 * np.ptp(shown, axis=0).max()
    return np.array([shown.min(axis=0) - margin, shown.max(axis=0) + margin])


def true_or_times(case: Case, factor: float) -> str:
    """What is said of a magnification."""
    if factor == 1.0:
        return "displacements to scale"
    return f"displacements{' and gaps' if len(case.line.points) else ''} × {factor:g}"


def draw_scene(axes: Axes, case: Case, name: str, factor: Optional[float] = None,
               has_lines: bool = True) -> tuple[Any, str, Optional[float]]:
    """The body with a field, its shape before, its contact points and the obstacles. Returns what a bar of the field
    needs: what is drawn, its label, and its value where it is uniform."""
    mesh = case.mesh
    if factor is None:
        factor = magnification(case)
    window = window_of(case, factor)
    field = draw_field(axes, case, factor, name, has_lines)
    axes.add_collection(LineCollection(mesh.points[boundary(mesh)][:, :, :2], colors=UNDEFORMED, linestyles="--",
                                       linewidths=0.5))
    draw_obstacles(axes, case, factor, window)
    draw_points(axes, case, factor)
    axes.set(aspect="equal", xlabel=case.label("x", "L"), ylabel=case.label("y", "L"), xlim=window[:, 0],
             ylim=window[:, 1], title=true_or_times(case, factor))
    return field


def draw_body(axes: Axes, case: Case, name: str, factor: Optional[float] = None, has_lines: bool = True) -> None:
    """The body with a field and its bar, its contact points and the obstacles."""
    draw_bar(axes, *draw_scene(axes, case, name, factor, has_lines))
    if len(case.line.points):
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=4.6, ncols=2, frameon=False)


def draw_detail(axes: Axes, case: Case, name: str, shown: Array, factor: Optional[float] = None,
                has_lines: bool = True) -> None:
    """The body once more, near the contact points that are shown."""
    if factor is None:
        factor = magnification_at(case, shown)
    draw_field(axes, case, factor, name, has_lines)
    at = draw_points(axes, case, factor)[shown]
    half = max(np.ptp(at, axis=0).max(), np.ptp(case.line.points[shown, :2], axis=0).max()) / 2
    inwards = -case.line.point_data["normal"][shown, :2].mean(axis=0)
    middle = (at.min(axis=0) + at.max(axis=0)) / 2 + 0.3 * half * inwards
    window = middle + np.array([[-1.0, -0.5], [1.0, 0.5]]) * half
    draw_obstacles(axes, case, factor, window)
    axes.set(aspect="equal", xlim=window[:, 0], ylim=window[:, 1], title="closed zone, " + true_or_times(case, factor))
