"""Makes an image of a field that is constant in each cell of a mesh, as text of a PNG with a palette: quicker by far
than to draw every cell as a polygon."""
from __future__ import annotations

import base64
import functools
import struct
import zlib
from typing import Optional

import numpy as np
from matplotlib import colormaps

from amontons.grid import Array

N_COLORS = 255  # beside the transparent one, the first of the palette


def cell_image(polygons: list[tuple[Array, Array]], window: Array, size: tuple[int, int]) -> Array:
    """The colors of the pixels of a window (lower left and upper right corner), rows from above (height, width); 0
    where there is no cell. Polygons are pairs of corners (n_cells, n_corners, 2) and colors (n_cells) of cells that
    are convex; a pixel has the color of the cell that its middle is in."""
    width, height = size
    pixels = np.zeros(height * width, np.uint8)
    for corners, colors in polygons:
        cell, pixel = _covered(corners, window, size)
        pixels[pixel] = colors[cell]
    return pixels.reshape(height, width)


def nearest(triangles: Array, window: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """What is seen of triangles in a window: which of them is in front in each pixel, -1 where there is none, and the
    depth of its middle (height, width), rows from above. Corners have places in the window, as x and y, and a depth,
    which grows towards the eye (n, 3, 3)."""
    width, height = size
    triangle, pixel = _covered(triangles[..., :2], window, size)
    second, third = _shares(triangles, window, size)
    base, across, down = second * (triangles[:, 1] - triangles[:, 0])[:, 2] + third * (
        triangles[:, 2] - triangles[:, 0])[:, 2]
    base += triangles[:, 0, 2]
    row, column = np.divmod(pixel, width)
    far = base[triangle] + across[triangle] * column + down[triangle] * row
    number, depths = np.full(height * width, -1), np.full(height * width, -np.inf)
    while len(pixel):  # as often as triangles cover each other
        nearer = np.flatnonzero(far > depths[pixel])
        triangle, pixel, far = triangle[nearer], pixel[nearer], far[nearer]
        number[pixel], depths[pixel] = triangle, far
    return number.reshape(height, width), depths.reshape(height, width)


def weights_of(triangles: Array, number: Array, window: Array) -> Array:
    """The weights of the corners of triangles that are seen in a window, at the middles of pixels (height, width, 3);
    see `nearest`."""
    height, width = number.shape
    row, column = np.nonzero(number >= 0)
    seen = number[row, column]
    weights = np.zeros((height, width, 3))
    for corner, (base, across, down) in enumerate(_shares(triangles, window, (width, height)), start=1):
        weights[row, column, corner] = base[seen] + across[seen] * column + down[seen] * row
    weights[row, column, 0] = 1.0 - weights[row, column, 1] - weights[row, column, 2]
    return weights


def _shares(triangles: Array, window: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """The weights of the second and of the third corner of triangles: in the first pixel, and their changes by a column
    and by a row (3, n)."""
    column, row = np.ptp(window, axis=0) / size * [1, -1]
    first = triangles[:, 0]
    a, b = triangles[:, 1] - first, triangles[:, 2] - first
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    area[area == 0.0] = np.inf
    x, y = window[0, 0] + column / 2 - first[:, 0], window[1, 1] + row / 2 - first[:, 1]
    return (np.stack([x * b[:, 1] - y * b[:, 0], column * b[:, 1], -row * b[:, 0]]) / area,
            np.stack([y * a[:, 0] - x * a[:, 1], -column * a[:, 1], row * a[:, 0]]) / area)


def _covered(corners: Array, window: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """The pixels whose middles are in convex polygons (n, n_corners, 2): pairs of polygon and pixel, polygon by
    polygon."""
    width, height = size
    # In pixels from the upper left corner of the window, as x and y (n, n_corners).
    x, y = np.moveaxis((corners - [window[0, 0], window[1, 1]]) * [width, -height] / np.ptp(window, axis=0), 2, 0)
    # The rows whose middles a cell meets, one pair of cell and row after the other.
    first, last = _middles(y.min(axis=1), height), _middles(y.max(axis=1), height)
    cell, row = _ranges(first, last)
    left, right = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for i in range(x.shape[1]):
        j = (i + 1) % x.shape[1]
        # Each side from its upper end, so that both its cells find the same crossings.
        upper, lower = (y[:, i] <= y[:, j]), (y[:, i] > y[:, j])
        x0, x1 = np.where(upper, x[:, i], x[:, j])[cell], np.where(lower, x[:, i], x[:, j])[cell]
        y0, y1 = np.where(upper, y[:, i], y[:, j])[cell], np.where(lower, y[:, i], y[:, j])[cell]
        crosses = (y0 <= row + 0.5) & (row + 0.5 < y1)
        at = x0 + (row + 0.5 - y0) * ((x1 - x0) / np.where(crosses, y1 - y0, 1.0))
        left, right = np.where(crosses, np.minimum(left, at), left), np.where(crosses, np.maximum(right, at), right)
    span, column = _ranges(_middles(left, width), _middles(right, width))
    return cell[span], row[span] * width + column


def _middles(places: Array, count: int) -> Array:
    """The first of so many pixels whose middle is not before a place."""
    return np.clip(np.ceil(places - 0.5), 0, count).astype(int)


def _ranges(first: Array, last: Array) -> tuple[Array, Array]:
    """The numbers of ranges, which end before their last, one range after the other: which range, and the number."""
    lengths = np.maximum(last - first, 0)
    which = np.repeat(np.arange(len(lengths)), lengths)
    return which, np.arange(len(which)) + np.repeat(first - np.cumsum(lengths) + lengths, lengths)


def color_numbers(values: Array, low: float, high: float, n_colors: int = N_COLORS) -> Array:
    """The colors of values, from 1, between those of two others."""
    share = (values - low) / ((high - low) or 1.0)
    return np.clip(share * n_colors, 0, n_colors - 1).astype(np.uint8) + np.uint8(1)


@functools.lru_cache(maxsize=None)
def palette(name: str) -> Array:
    """The colors of a map of Matplotlib, red, green, and blue from 0 to 255 (N_COLORS, 3)."""
    colors: Array = colormaps[name](np.linspace(0.0, 1.0, N_COLORS), bytes=True)[:, :3]
    return colors


def png_text(pixels: Array, colors: Optional[Array] = None) -> str:
    """The address of an image that holds it: a PNG of pixels (height, width), 0 where it is transparent, else the
    place in the table of colors (n, 3), from 1; or of red, green, blue and opacity from 0 to 1 (height, width, 4)."""
    height, width = pixels.shape[:2]
    depth = 1 if colors is not None else 4
    lines = np.zeros((height, 1 + depth * width), np.uint8)  # each begins with its filter
    if colors is not None:
        lines[:, 1:] = pixels
        table = np.concatenate([np.zeros((1, 3), np.uint8), colors])
        parts = [(b"PLTE", table.tobytes()), (b"tRNS", b"\0")]
    else:
        # In steps of a 64th, and as differences to the pixel on the left: that needs half the room.
        whole = np.rint(255 / 63 * np.rint(63.0 * pixels)).astype(np.uint8)
        lines[:, 0] = 1
        lines[:, 1:] = np.diff(whole, axis=1, prepend=np.uint8(0)).reshape(height, -1)
        parts = []
    content = b"\x89PNG\r\n\x1a\n"
    for kind, data in ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3 if parts else 6, 0, 0, 0)), *parts,
                       (b"IDAT", zlib.compress(lines.tobytes(), 6)), (b"IEND", b"")):
        content += struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return "data:image/png;base64," + base64.b64encode(content).decode("ascii")
