"""Draws a solid: its displacements magnified, from two opposite sides, a field in colors, and the obstacles; and its
contact faces as maps of pressure, of gap, and of status with arrows of slip."""
from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_hex, to_rgb
from matplotlib.ticker import MaxNLocator

from amontons.cases import Case, dimension_of
from amontons.draw_body import (FIELD, OBSTACLE, OUTLINE, UNDEFORMED, UNIFORM, VISIBLE, draw_bar, field_of,
                                initial_gaps, magnification, rounding, slides_far, true_or_times)
from amontons.draw_line import ROUNDING, STATUSES, Canvas
from amontons.faces import Faces, Seen, View, boundary_faces, facing, look, smoothed
from amontons.grid import Array, Grid
from amontons.obstacles import Surface, triangles_near
from amontons.raster import N_COLORS, palette

NODAL_FIELD = "nodal_von_mises"  # cells at the boundary of a solid look uneven
EYE = np.array([0.5, -1.0, 0.6])  # the direction to the eye of the first view, opposite to that of the second
LIGHT = np.array([-0.35, 0.55, 0.76])  # the direction to the light in a picture
DIM = 0.35      # how much darker what turns away from the light is
LINES, RIDGES, OUTSIDE = 0.25, 0.55, 0.7  # opacity of the lines between faces, of edges, and of lines beside the body
FINE = 4000     # faces: the lines between more would hide the colors
COARSE = 1200   # triangles of an obstacle, likewise
VEIL = 0.18     # opacity of an obstacle
NEARLY = 0.99   # of the boundary has a value below the end of the bar,
PEAK = 4.0      # which is no smaller than the largest one over this
SHORT = 0.08    # of the size of a picture of a body, an axis without numbers
TALL = 1.4      # height over width of a body whose sides are beside each other
MARGIN = 0.16   # of the size of a body, around it for the texts of its axes
PAPER = (0.9, 0.9, 0.9)  # of contact faces without pressure
QUANTITIES = {"stress": "contact_pressure", "slip": "status", "gap": "gap"}  # of the maps of panels
VIEW_PIXELS, MAP_PIXELS = 450, 360  # of the longer side of an image
FACING = 0.6    # length of the mean normal of a set that is shown as it is seen along it
FLAT = 1e-6     # of normals that are the same
MOST_MAPS = 4
SPARSE = 0.3    # of the place that parts of a set take up around them, below which each has its own map
SEAM = 0.06     # of the extent of a map, around it
ZOOM = 0.6      # of the extent of a set: a smaller closed part is shown alone
ARROWS = 14     # along the longer side of a map
PALE, PALE_OPEN = 0.6, 0.25  # opacity of the colors of statuses
LONGEST = 0.2  # inch: the longest arrow
SMALLEST = 0.02  # slip over the largest one of a set that has an arrow


@dataclass(frozen=True)
class Part:
    """The body as it is drawn: its boundary, with a field."""
    case: Case
    factor: float
    faces: Faces  # its boundary
    values: Array  # of the field, on cells or nodes
    label: str
    dimension: str
    limits: tuple[float, float]  # of the colors
    uniform: Optional[float]  # the value, where it has only one
    largest: Optional[float] = None  # the largest one, where the colors end below it

    @cached_property
    def before(self) -> Array:
        """Its triangles before (n, 3, 3)."""
        return self.faces.at_corners(self.case.mesh.points)

    @cached_property
    def after(self) -> Array:
        """Its triangles where they are drawn (n, 3, 3)."""
        return self.faces.at_corners(self.case.mesh.points + self.factor * self.case.mesh.point_data["displacement"])

    @cached_property
    def sheets(self) -> list[tuple[Array, Array]]:
        """The triangles of the obstacles and the face of each, likewise."""
        return [(faces.at_corners(points), faces.triangles[1]) for points, faces in obstacles(self.case, self.factor)]

    @cached_property
    def views(self) -> tuple[View, View]:
        """From where it is seen."""
        return View.along(EYE), View.along(-EYE)

    def window(self, view: View) -> Array:
        """What is shown of a picture; lower left and upper right corner. Both views are of the same size."""
        def ends(one: View) -> Array:
            low, high = self.case.mesh.points.min(axis=0), self.case.mesh.points.max(axis=0)
            box = np.array([np.where(side, high, low) for side in np.ndindex(2, 2, 2)])
            shown = np.concatenate([one.of(corners)[..., :2].reshape(-1, 2)
                                    for corners in (box, self.after, *(sheet for sheet, _ in self.sheets))])
            return np.array([shown.min(axis=0), shown.max(axis=0)])
        size = np.max([np.ptp(ends(one), axis=0) for one in self.views], axis=0)
        half = size / 2 + MARGIN * size.max() / 2
        middle = ends(view).mean(axis=0)
        return np.array([middle - half, middle + half])

    @property
    def is_tall(self) -> bool:
        """Whether its sides are better beside each other."""
        width, height = np.ptp(self.window(self.views[0]), axis=0)
        return bool(height > TALL * width)


def part_of(case: Case, name: Optional[str] = None, factor: Optional[float] = None) -> Part:
    """The body with a field and a magnification. If nearly all that is seen is below half of the largest value, the
    colors end there."""
    name = name or (NODAL_FIELD if NODAL_FIELD in case.mesh.point_data else FIELD)
    factor = magnification(case) if factor is None else factor
    values, label = field_of(case, name)
    dimension = dimension_of(name)
    if np.abs(values).max() <= rounding(case, name):
        values = 0.0 * values
    low, high = float(values.min()), float(values.max())
    faces = boundary_faces(case.mesh)
    if high - low <= UNIFORM * max(abs(low), abs(high)):
        middle = (low + high) / 2
        return Part(case, factor, faces, values, label, dimension,
                    (middle - (abs(middle) or 1.0), middle + (abs(middle) or 1.0)), middle)
    corners = faces.at_corners(case.mesh.points)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    seen = faces.at_corners(values).mean(axis=1) if len(values) == len(case.mesh.points) else \
        values[faces.cells[faces.triangles[1]]]
    order = np.argsort(seen)
    share = np.cumsum(areas[order])
    usual = max(float(seen[order[np.searchsorted(share, NEARLY * share[-1])]]), low + (high - low) / PEAK)
    if low + 2.0 * (usual - low) < high:
        return Part(case, factor, faces, values, label, dimension, (low, usual), None, high)
    return Part(case, factor, faces, values, label, dimension, (low, high), None)


def obstacles(case: Case, factor: float) -> list[tuple[Array, Faces]]:
    """The surfaces of the obstacles, as places and faces between them: as the deck describes them, or, where gaps are
    magnified, an obstacle has moved or is of another kind, through the places opposite the contact points."""
    grid, found = case.contact_grid, []
    gaps = np.full(len(grid.points), np.nan)
    gaps[:len(case.line.points)] = initial_gaps(case)
    size = np.ptp(case.mesh.points, axis=0).max()
    opposite = grid.points + gaps[:, None] * grid.point_data["normal"]
    places = grid.points + factor * gaps[:, None] * grid.point_data["normal"]
    if slides_far(case):
        near = np.where(grid.point_data["gap"] <= 2 * size, grid.point_data["gap"], np.nan)
        opposite = places = grid.points + grid.point_data["displacement"] + near[:, None] * grid.point_data["normal"]
    for one in contact_sets(case):
        if "against" in one.contact:
            continue
        # Between corners gaps are those of transformed unknowns.
        corners = [outline[:, ::2] if outline.shape[1] > 4 else outline for outline in one.faces.outlines]
        points = np.unique(np.concatenate([outline.ravel() for outline in corners]))
        points = points[np.isfinite(gaps[points])]
        if len(points) and (factor == 1.0 or not (np.abs(gaps[points]) > UNIFORM * size).any()):
            described = described_surface(one, opposite[points], case.is_history)
            if described is not None:
                found.append(described)
                continue
        outlines = [outline[np.isfinite(gaps[outline]).all(axis=1)] for outline in corners]
        outlines = [outline for outline in outlines if len(outline)]
        if outlines:
            found.append((places, Faces(outlines, np.arange(sum(map(len, outlines))))))
    return found


def described_surface(one: ContactSet, opposite: Array, may_have_moved: bool) -> Optional[tuple[Array, Faces]]:
    """The surface of an obstacle as the deck describes it, places and faces; None where it is not there, which the
    places opposite the contact points tell, or is of another kind."""
    points = one.case.contact_grid.points[one.points]
    try:
        if one.contact["obstacle"] == "surface":
            at, corners = triangles_near(one.contact, points)
            return None if may_have_moved or not len(corners) else (at, Faces([corners], np.arange(len(corners))))
        described = Surface.near(one.contact, points)
    except (LookupError, OSError, ValueError):
        return None
    if np.abs(described.heights(opposite)).max() > VISIBLE * np.ptp(one.case.mesh.points, axis=0).max():
        return None
    at, corners = described.mesh(points)
    return at, Faces([corners], np.arange(len(corners)))


def colored(part: Part, view: View, window: Array, size: tuple[int, int]) -> Array:
    """What is seen of a body in a window of a view, as an image: red, green, blue and opacity from 0 to 1."""
    corners, faces = view.of(part.after), part.faces.triangles[1]
    is_facing = facing(corners)
    seen = look(corners[is_facing], faces[is_facing], window, size)
    if len(part.values) == len(part.case.mesh.points):
        values = seen.values(part.faces.at_corners(part.values)[is_facing])
    else:
        values = part.values[part.faces.cells[faces[is_facing]]][seen.number]
    image = np.zeros((*seen.number.shape, 4))
    has_lines = len(part.faces.cells) <= FINE
    paint(image, seen, values, part.limits, has_lines)
    light = 1.0 - DIM * (1.0 - np.clip(seen.normals @ LIGHT, 0.0, 1.0))
    image[..., :3] *= light[seen.number][..., None]
    blend(image, seen.edge == 2, "white", RIDGES)
    is_free = seen.number < 0
    if part.factor * np.abs(part.case.mesh.point_data["displacement"]).max() > VISIBLE * np.ptp(window[:, 0]):
        corners = view.of(part.before)
        is_facing = facing(corners)
        before = look(corners[is_facing], faces[is_facing], window, size)
        blend(image, is_free & (before.edge == 2), UNDEFORMED, OUTSIDE)
    for corners, faces in part.sheets:
        sheet = look(view.of(corners), faces, window, size)
        is_near = sheet.depth > np.where(is_free, -np.inf, seen.depth - VISIBLE * np.ptp(window[:, 0]))
        blend(image, is_near & (sheet.number >= 0), OBSTACLE, VEIL)
        has_lines = len(corners) <= COARSE
        blend(image, is_near & (sheet.edge > (0 if has_lines else 1)), OBSTACLE, RIDGES)
    return smoothed(image)


def paint(image: Array, seen: Seen, values: Array, limits: tuple[float, float], has_lines: bool) -> None:
    """Colors an image by values, where something is seen, with lines between faces or not."""
    low, high = limits
    here = seen.number >= 0
    share = np.clip((values[here] - low) / ((high - low) or 1.0), 0.0, 1.0)
    image[here, :3] = palette("cividis")[np.rint(share * (N_COLORS - 1)).astype(int)] / 255.0
    image[here, 3] = 1.0
    if has_lines:
        blend(image, seen.edge == 1, "white", LINES)


def blend(image: Array, where: Array, color: Any, opacity: float) -> None:
    """Puts a color over some pixels of an image."""
    under = image[where]
    share = opacity + under[:, 3] * (1.0 - opacity)
    image[where, :3] = (opacity * np.array(to_rgb(color)) + ((1.0 - opacity) * under[:, 3])[:, None] * under[:, :3]) \
        / share[:, None]
    image[where, 3] = share


def draw_axes(axes: Canvas, part: Part, view: View, window: Array) -> None:
    """The three axes along edges of a box around the body, with the numbers of their ticks."""
    case = part.case
    low, high = case.mesh.points.min(axis=0), case.mesh.points.max(axis=0)
    middle = view.of((low + high) / 2)[:2]
    size = np.ptp(window, axis=0).max()
    for k, name in enumerate("xyz"):
        others = [i for i in range(3) if i != k]
        edges = []
        for sides in np.ndindex(2, 2):
            start = np.where(np.eye(3)[k] > 0, low, 0.0)
            is_towards = []
            for i, side in zip(others, sides):
                start[i] = (low, high)[side][i]
                is_towards.append((view.towards[i] > 0) == (side == 1))
            end = np.where(np.eye(3)[k] > 0, high, start)
            if is_towards[0] != is_towards[1]:  # an edge of the outline
                edges.append((view.of(start)[:2], view.of(end)[:2]))
        # The lower one, or that on the left.
        start, end = min(edges, key=lambda edge: (edge[0] + edge[1])[0 if k == 2 else 1])
        way = end - start
        out = np.array([way[1], -way[0]]) / max(np.hypot(*way), 1e-300)
        out *= np.copysign(1.0, out @ ((start + end) / 2 - middle))
        start, end = (place + 0.015 * size * out for place in (start, end))
        part_of_size = np.hypot(*way) / size
        values = [value for value in MaxNLocator(max(1, int(8 * part_of_size)), steps=[1, 2, 5, 10])
                  .tick_values(low[k], high[k]) if low[k] - 1e-9 * size <= value <= high[k] + 1e-9 * size]
        if part_of_size < SHORT:
            values = []
        places = [start + (value - low[k]) / (high[k] - low[k]) * way for value in values]
        strokes = np.concatenate([[start, end, [np.nan] * 2],
                                  *([place, place + 0.012 * size * out, [np.nan] * 2] for place in places)])
        axes.plot(*strokes.T, color="black", linewidth=0.5, scalex=False, scaley=False)
        texts = [(place + 0.04 * size * out, f"{value:.6g}".replace("-", "\N{MINUS SIGN}"))
                 for value, place in zip(values, places)]
        at = end + 0.06 * size * way / max(np.hypot(*way), 1e-300) if k == 2 else (start + end) / 2 + 0.1 * size * out
        texts.append((at, case.label(name, "L")))
        for (x, y), text in texts:
            axes.text(x, y, text, ha="center", va="center", fontsize=7)


def draw_view(axes: Canvas, part: Part, number: int) -> tuple[View, Array]:
    """What is drawn of a view besides its image. Returns the view and its window."""
    view = part.views[number]
    window = part.window(view)
    draw_axes(axes, part, view, window)
    title = true_or_times(part.case, part.factor)
    if number == 1:
        title = "from the other side"
        if part.largest is not None:
            title += f"; largest {part.largest:.4g} {part.case.unit(part.dimension)}".rstrip()
    axes.set(aspect="equal", xlim=window[:, 0], ylim=window[:, 1], title=title)
    return view, window


@dataclass(frozen=True)
class ContactSet:
    """The faces of a `&contact`, or some of them."""
    case: Case
    contact: dict[str, Any]  # its keys; none where the deck is gone
    number: int
    faces: Faces  # by the nodes of `Case.contact_grid`

    @property
    def points(self) -> Array:
        """Their nodes."""
        return np.unique(np.concatenate([outline.ravel() for outline in self.faces.outlines]))

    @property
    def title(self) -> str:
        """The name of the set and what it is on."""
        name = str(self.contact.get("name") or self.contact.get("set") or f"contact set {self.number}")
        kind = self.contact.get("obstacle")
        if "against" in self.contact:
            return f"{name} on {self.contact['against']}"
        if not kind:
            return name
        radius = f" of radius {self.contact['radius']:g}" if "radius" in self.contact else ""
        return f"{name} on a {kind}{radius}"


def contact_sets(case: Case) -> list[ContactSet]:
    """The contact sets of a solid, as far as they have faces with contact points."""
    grid = case.contact_grid
    try:
        contacts = case.contacts
    except OSError:
        contacts = []
    found: dict[int, list[Array]] = {}
    is_point = grid.point_data["status"] > 0
    for kind, nodes in grid.cells:
        if kind not in OUTLINE:
            continue
        numbers = grid.point_data["set"][nodes].max(axis=1)  # a node may be a point of an earlier set
        numbers = np.where(is_point[nodes].any(axis=1), numbers, 0)
        for number in np.unique(numbers[numbers > 0]):
            outlines = nodes[numbers == number][:, OUTLINE[kind]]
            if outlines.shape[1] > 4 and not is_point[outlines[:, 1::2]].any():
                outlines = outlines[:, ::2]  # the points of a pair are corners
            found.setdefault(int(number), []).append(outlines)
    return [ContactSet(case, contacts[number - 1] if number <= len(contacts) else {}, number,
                       Faces(outlines, np.arange(sum(map(len, outlines)))))
            for number, outlines in sorted(found.items())]


def pieces(whole: ContactSet) -> list[ContactSet]:
    """A set in its pieces, the one with the largest force first, if they are few and far from each other; else as it
    is."""
    grid = whole.case.contact_grid
    label = np.arange(len(grid.points))
    while True:  # each face takes the least label of its nodes, until they agree
        before = label.copy()
        for outline in whole.faces.outlines:
            np.minimum.at(label, outline, label[outline].min(axis=1)[:, None])
        label = label[label]
        if np.array_equal(label, before):
            break
    found = []
    for number in np.unique(label[whole.points]):
        outlines = [outline[label[outline[:, 0]] == number] for outline in whole.faces.outlines]
        outlines = [outline for outline in outlines if len(outline)]
        found.append(replace(whole, faces=Faces(outlines, np.arange(sum(map(len, outlines))))))
    def extent(one: ContactSet) -> float:
        return float(np.linalg.norm(np.ptp(grid.points[one.points], axis=0)))
    if len(found) > MOST_MAPS or max(map(extent, found)) > SPARSE * extent(whole):
        return [whole]
    pressure = grid.point_data["contact_pressure"]
    return sorted(found, key=lambda one: -float(pressure[one.points].sum()))


@dataclass(frozen=True)
class Chart:
    """How contact faces are laid out on paper: as they are seen along their mean normal, or unrolled from around an
    axis."""
    # Two directions in the picture and that to the eye; or where an angle is 0, where it is 90°, and the axis (3, 3)
    frame: Array
    center: Optional[Array]  # a point of the axis; None where nothing is unrolled

    @classmethod
    def of(cls, points: Array, normals: Array, weights: Array) -> Chart:
        """The one for points whose normals have weights."""
        mean = weights @ normals / weights.sum()
        length = np.linalg.norm(mean)
        if length > FACING:
            mean = mean / length
            k = int(np.argmax(np.abs(mean)))
            is_flat = (normals @ mean).min() > 1.0 - FLAT
            if np.abs(mean[k]) > (1.0 - FLAT if is_flat else 0.9):
                i, j = (i for i in range(3) if i != k)
                return cls(np.stack([np.eye(3)[i], np.eye(3)[j], np.copysign(np.eye(3)[k], mean[k])]), None)
            i = int(np.argmin(np.abs(mean)))
            across = np.eye(3)[i] - mean[i] * mean
            across /= np.linalg.norm(across)
            along = np.cross(mean, across)
            along *= np.copysign(1.0, along[np.argmax(np.abs(along))])
            return cls(np.stack([across, along, mean]), None)
        values, vectors = np.linalg.eigh((normals * weights[:, None]).T @ normals)
        axis = vectors[:, 0] if values[0] < 0.1 * values[1] else np.eye(3)[2]
        k = int(np.argmax(np.abs(axis)))
        axis = np.eye(3)[k] if np.abs(axis[k]) > 1.0 - 1e-4 else axis * np.copysign(1.0, axis[k])
        first = np.eye(3)[(k + 1) % 3] - axis[(k + 1) % 3] * axis
        first /= np.linalg.norm(first)
        frame = np.stack([first, np.cross(axis, first), axis])
        x, y, _ = frame @ points.T
        (a, b, _), *_ = np.linalg.lstsq(np.stack([2 * x, 2 * y, np.ones(len(x))], axis=1), x**2 + y**2, rcond=None)
        return cls(frame, a * first + b * frame[1])

    def places(self, corners: Array) -> Array:
        """Places in the picture and depths of triangles (n, 3, 3). Angles are in degrees; a triangle across their end
        is whole, beyond 180."""
        if self.center is None:
            return corners @ self.frame.T
        s, t, h = np.moveaxis((corners - self.center) @ self.frame.T, 2, 0)
        angle = np.degrees(np.arctan2(t, s))
        angle = np.where((np.ptp(angle, axis=1)[:, None] > 180.0) & (angle < 0.0), angle + 360.0, angle)
        return np.stack([angle, h, 0.0 * h], axis=-1)

    def directions(self, points: Array, vectors: Array) -> Array:
        """Components of vectors at points to the right and upwards (n, 2)."""
        s, t, h = self.frame @ vectors.T
        if self.center is None:
            return np.stack([s, t], axis=1)
        x, y, _ = self.frame @ (points - self.center).T
        return np.stack([(t * x - s * y) / np.hypot(x, y), h], axis=1)

    def labels(self, case: Case) -> tuple[str, str]:
        """What the axes show; of directions that are none of a coordinate the first is told, behind the abscissa."""
        names, told = [], ""
        shown = zip(self.frame, "st") if self.center is None else zip(self.frame[2:], "a")
        for direction, other in shown:
            k = int(np.argmax(np.abs(direction)))
            if direction[k] > 1.0 - 1e-12:
                names.append("xyz"[k])
                continue
            names.append(other)
            parts = (f"{part:.2g}".replace("-", "\N{MINUS SIGN}") for part in np.round(direction, 9) + 0.0)
            told = told or f"; {other} along ({', '.join(parts)})"
        if self.center is None:
            return case.label(names[0], "L") + told, case.label(names[1], "L")
        return f"angle around {names[0]} [°]" + told, case.label(names[0], "L")


@dataclass(frozen=True)
class Map:
    """Contact faces on paper."""
    shown: ContactSet
    title: str

    @property
    def grid(self) -> Grid:
        """The contact points and faces of all sets."""
        return self.shown.case.contact_grid

    @cached_property
    def chart(self) -> Chart:
        """Where their places are: those that press count."""
        points, data = self.shown.points, self.grid.point_data
        pressure = data["contact_pressure"][points]
        return Chart.of(self.grid.points[points], data["normal"][points],
                        pressure if pressure.max() > 0.0 else np.ones(len(points)))

    @cached_property
    def places(self) -> Array:
        """Places and depths of the triangles (n, 3, 3)."""
        return self.chart.places(self.shown.faces.at_corners(self.grid.points))

    @cached_property
    def of_points(self) -> Array:
        """Places of the contact points (n, 2)."""
        points = self.grid.points[self.shown.points]
        return self.chart.places(np.repeat(points[:, None], 3, axis=1))[:, 0, :2]

    @cached_property
    def window(self) -> Array:
        """What is shown: all, or where points are closed, if that is a small part; lower left, upper right corner."""
        low, high = (self.places[..., :2].reshape(-1, 2).min(axis=0), self.places[..., :2].reshape(-1, 2).max(axis=0))
        closed = self.of_points[self.grid.point_data["status"][self.shown.points] > 1]
        if self.chart.center is not None and high[0] - low[0] > 350.0:
            low[0], high[0] = -180.0, 180.0
        elif len(closed) > 2:
            margin = 0.3 * np.ptp(closed, axis=0).max() if self.chart.center is None else 0.3 * np.ptp(closed, axis=0)
            first, last = np.maximum(closed.min(axis=0) - margin, low), np.minimum(closed.max(axis=0) + margin, high)
            if (last - first).max() < ZOOM * (high - low).max() and (last > first).all():
                low, high = first, last
        margin = SEAM * (high - low).max() if self.is_equal else SEAM * (high - low) * [high[0] - low[0] < 350.0, 1.0]
        return np.array([low - margin, high + margin])

    @property
    def is_equal(self) -> bool:
        """Whether both axes have the same scale."""
        return self.chart.center is None

    def seen(self, size: tuple[int, int]) -> Seen:
        """What is seen of its faces."""
        places, faces = self.places, self.shown.faces.triangles[1]
        if self.chart.center is not None:  # what goes beyond the one end begins at the other
            places = np.concatenate([places, places - [360.0, 0.0, 0.0]])
            faces = np.concatenate([faces, faces])
        return look(places, faces, self.window, size)


def maps_of(case: Case) -> list[Map]:
    """The maps of a solid, of the sets or parts of them with the largest forces."""
    found = []
    pressure = case.contact_grid.point_data["contact_pressure"]
    for one in contact_sets(case):
        parts = pieces(one)
        names = [one.title if len(parts) == 1 else f"{one.title}, part {i}" for i in range(1, len(parts) + 1)]
        found += [Map(part, name) for part, name in zip(parts, names)]
    order = sorted(range(len(found)), key=lambda i: -float(pressure[found[i].shown.points].sum()))[:MOST_MAPS]
    return [found[i] for i in sorted(order)]


def quantity_limits(one: Map, name: str) -> tuple[float, float]:
    """The values of the first and the last color of a map of pressure or gap."""
    values = one.grid.point_data[name][one.shown.points]
    if name == "gap":  # where the normal all but misses the obstacle it has no end
        values = values[values < np.ptp(one.shown.case.mesh.points, axis=0).max()]
    return 0.0, float(values.max(initial=0.0)) or 1.0


def map_image(one: Map, name: str, size: tuple[int, int]) -> Array:
    """A map as an image of its window: of the pressure or the gap at nodes, or of the status, each node with the part
    of the faces that is nearest to it."""
    seen = one.seen(size)
    image = np.zeros((*seen.number.shape, 4))
    here = seen.number >= 0
    faces, data = one.shown.faces, one.grid.point_data
    n = len(one.places)
    number = np.where(here, seen.number % n, -1)
    if name == "status":
        nodes = faces.triangles[0][number[here]]
        nearest = np.argmax(np.where(nodes >= 0, seen.weights[here], -1.0), axis=1)
        status = data["status"][nodes[np.arange(len(nodes)), nearest]].astype(int)
        image[here, :3], image[here, 3] = np.array([PAPER, *map(pale, range(1, len(STATUSES) + 1))])[status], 1.0
    else:
        limits = quantity_limits(one, name)
        at_corners = faces.at_corners(data[name])
        values = seen.values(at_corners if one.is_equal else np.concatenate([at_corners, at_corners]))
        paint(image, seen, values, limits, has_lines=False)
        blend(image, here & (values <= ROUNDING * limits[1]), PAPER, 1.0)
    if len(faces.cells) <= FINE:
        blend(image, here & (seen.edge > 0), "white", LINES)
    return smoothed(image)


def pale(status: int) -> tuple[float, float, float]:
    """The color of the part of a map that has a status."""
    opacity = PALE if status > 1 else PALE_OPEN
    red, green, blue = (opacity * part + 1.0 - opacity for part in to_rgb(STATUSES[status - 1][1]))
    return red, green, blue


def bar_label(one: Map, name: str) -> str:
    """What the colors of a map of pressure or gap mean."""
    return one.shown.case.label(name.replace("_", " "), dimension_of(name))


def draw_map_axes(axes: Canvas, one: Map, name: str) -> None:
    """What is drawn of a map besides its image."""
    title = one.title
    if name == "slip":
        largest = float(one.grid.point_data["slip"][one.shown.points].max())
        title = f"largest slip {largest:.3g} {one.shown.case.unit('L')}".rstrip()
    xlabel, ylabel = one.chart.labels(one.shown.case)
    axes.set(aspect="equal" if one.is_equal else "auto", xlim=one.window[:, 0], ylim=one.window[:, 1], xlabel=xlabel,
             ylabel=ylabel, title=title)


def draw_slip_arrows(axes: Canvas, one: Map) -> None:
    """Arrows of the slip, of the largest one in each of some squares."""
    points, data = one.shown.points, one.grid.point_data
    ways = one.chart.directions(one.grid.points[points], data["slip_vector"][points])
    lengths = np.hypot(*ways.T) * (data["status"][points] > 1)
    at, window = one.of_points, one.window
    wanted = (lengths > SMALLEST * lengths.max(initial=0.0)) & ((at > window[0]) & (at < window[1])).all(axis=1)
    at, ways, lengths = at[wanted], ways[wanted], lengths[wanted]
    if not len(at) or lengths.max() <= ROUNDING * np.abs(one.shown.case.mesh.point_data["displacement"]).max():
        return
    extent = np.ptp(window, axis=0)
    square = (np.full(2, extent.max()) if one.is_equal else extent) / ARROWS
    order = np.argsort(-lengths, kind="stable")
    _, first = np.unique(np.floor((at[order] - window[0]) / square).astype(int), axis=0, return_index=True)
    chosen = order[first]
    ways = ways[chosen] / lengths.max()
    axes.quiver(*at[chosen].T, *ways.T, color="black", angles="uv", units="inches", width=0.012, scale=1.0 / LONGEST,
                scale_units="inches")


def draw_status_labels(axes: Canvas, one: Map) -> None:
    """The words for the colors of a map of statuses."""
    status = one.grid.point_data["status"][one.shown.points]
    for number, (label, _, _) in enumerate(STATUSES, start=1):
        if (status == number).any():
            axes.plot([], [], linestyle="none", marker="s", markersize=5, color=to_hex(pale(number)), label=label)


def draw_solid(axes: list[Axes], part: Part) -> None:
    """The body from both sides, with the bar of its field."""
    for number, one in enumerate(axes):
        view, window = draw_view(one, part, number)
        show(one, colored(part, view, window, size_of(window, VIEW_PIXELS)), window)
        one.set_axis_off()
    draw_bar(axes[-1], mappable(part.limits), part.label, part.uniform)


def draw_map(axes: Axes, one: Map, name: str) -> None:
    """A map of the pressure, the gap, or the status with arrows of slip."""
    data = QUANTITIES[name]
    draw_map_axes(axes, one, name)
    show(axes, map_image(one, data, size_of(one.window, MAP_PIXELS, one.is_equal)), one.window)
    if name == "slip":
        draw_slip_arrows(axes, one)
        draw_status_labels(axes, one)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2, frameon=False)
    else:
        draw_bar(axes, mappable(quantity_limits(one, data)), bar_label(one, data))


def show(axes: Axes, image: Array, window: Array) -> None:
    """Puts an image of a window into axes, behind all else."""
    axes.imshow(image, extent=(*window[:, 0], *window[:, 1]), aspect=axes.get_aspect(), zorder=0.5)


def mappable(limits: tuple[float, float]) -> ScalarMappable:
    """What a bar is made of."""
    return ScalarMappable(Normalize(*limits), "cividis")


def size_of(window: Array, pixels: int, is_equal: bool = True) -> tuple[int, int]:
    """Width and height of an image of a window, the longer of so many pixels."""
    width, height = np.ptp(window, axis=0) if is_equal else (1.0, 0.7)
    longer = max(width, height)
    return max(int(pixels * width / longer), 2), max(int(pixels * height / longer), 2)
