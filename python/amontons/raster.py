"""Makes an image of a field that is constant in each cell of a mesh, as text of a PNG with a palette: quicker by far
than to draw every cell as a polygon."""
from __future__ import annotations

import base64
import functools
import struct
import zlib

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
        # In pixels from the upper left corner of the window, as x and y (n_cells, n_corners).
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
        pixels[row[span] * width + column] = colors[cell[span]]
    return pixels.reshape(height, width)


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


def png_text(pixels: Array, colors: Array) -> str:
    """The address of an image that holds it: a PNG of pixels (height, width), 0 where it is transparent, else the
    place in the table of colors (n, 3), from 1."""
    height, width = pixels.shape
    lines = np.zeros((height, width + 1), np.uint8)  # each begins with its filter, none
    lines[:, 1:] = pixels
    table = np.concatenate([np.zeros((1, 3), np.uint8), colors])
    content = b"\x89PNG\r\n\x1a\n"
    for kind, data in ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)), (b"PLTE", table.tobytes()),
                       (b"tRNS", b"\0"), (b"IDAT", zlib.compress(lines.tobytes(), 6)), (b"IEND", b"")):
        content += struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return "data:image/png;base64," + base64.b64encode(content).decode("ascii")
