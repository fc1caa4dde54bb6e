"""Draws how the figures of the releases went. Usage: draw_releases.py [IMAGE]; the image is doc/images/releases.svg unless
another is given.

bench/releases.csv has one line a release: what scripts/bench.sh --full prints for the long bar on 512 x 512 cells (wall time
of the five rows on one thread, memory), and the code lines of src/ (scripts/dev/house.py). Add a line when a release is made.
"""

import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  pylint: disable=wrong-import-position

ROOT = pathlib.Path(__file__).resolve().parent.parent
PANELS = {"code_lines": "code lines of src/", "seconds": "five rows, 512 x 512, one thread [s]", "memory_mb": "memory [MB]"}


def main(image):
    """Draws one panel for each figure."""
    with open(ROOT / "bench" / "releases.csv", encoding="ascii", newline="") as file:
        releases = list(csv.DictReader(file))
    # The same bytes for the same numbers.
    matplotlib.rcParams["svg.hashsalt"] = "releases"
    figure, all_axes = pyplot.subplots(1, len(PANELS), figsize=(9.0, 2.6), layout="constrained")
    for axes, (column, title) in zip(all_axes, PANELS.items()):
        values = [float(release[column]) for release in releases]
        axes.plot([release["version"] for release in releases], values, marker="o", color="black")
        axes.set_ylim(0.0, 1.15 * max(values))
        axes.set_title(title, fontsize=9)
        axes.tick_params(labelsize=8)
    figure.savefig(image, metadata={"Date": None})


main(sys.argv[1] if len(sys.argv) > 1 else ROOT / "doc" / "images" / "releases.svg")
