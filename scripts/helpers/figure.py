"""Draws the example of Pop and Zelina (2005) from solved cases: the loaded bar of their Fig. 4.1, the zones found for
each row of Table 1, and the rows on the map of states over friction and F/f.

Usage: figure.py FOLDER-OF-ROWS MAP IMAGE... MAP is the path of the swept case without endings.
"""

import sys

import matplotlib
import matplotlib.pyplot as plt
import table1
from amontons.cases import Case
from amontons.draw_sweep import ZONES, draw_map, study_of

COLORS = tuple(ZONES.values())
SIDE = 40.0


def draw_bar(axes):
    """Half of the bar's section on its floor, with its loads and the symmetry plane."""
    arrow = {"arrowstyle": "-|>", "color": "black", "linewidth": 1.0}
    axes.add_patch(plt.Rectangle((0, 0), SIDE, SIDE, facecolor="0.93", edgecolor="black"))
    axes.fill_between([-6, SIDE + 6], -4, 0, facecolor="white", edgecolor="0.5", hatch="////", linewidth=0)
    axes.plot([-6, SIDE + 6], [0, 0], color="black", linewidth=1.5)
    for at in range(2, 40, 6):
        axes.annotate("", (0, at + 2), (-7, at + 2), arrowprops=arrow)
        axes.annotate("", (at + 2, SIDE), (at + 2, SIDE + 7), arrowprops=arrow)
    axes.text(-9, SIDE / 2, "F", ha="right", va="center", style="italic")
    axes.text(SIDE / 2, SIDE + 8, "f", ha="center", va="bottom", style="italic")
    axes.plot([SIDE, SIDE], [-4, SIDE + 9], color="black", linestyle="-.", linewidth=0.8)
    axes.text(SIDE + 1.5, SIDE / 2, "symmetry plane, $u_x = 0$", rotation=90, va="center")
    axes.text(SIDE / 2, SIDE / 2, "E = 13000 daN/mm²\nν = 0.2\nplane strain\n40 mm x 40 mm", ha="center", va="center")
    for name, x in (("A", 0.0), ("D", SIDE)):
        axes.text(x, 1.0, f" {name} ", ha="left" if name == "A" else "right", va="bottom")
    axes.set(aspect="equal", xlim=(-13, SIDE + 7), ylim=(-5, SIDE + 13))
    axes.axis("off")


def draw_zones(axes, summaries):
    """The parts AB, BC and CD of each row, found above and, thinner, as the paper has them."""
    for i, (row, summary) in enumerate(zip(table1.ROWS, summaries)):
        expected = table1.CORRECTED.get(i + 1, row[3])
        for values, y, height in ((table1.lengths(summary), i - 0.14, 0.42), (expected, i + 0.24, 0.18)):
            start = 0.0
            for value, color, zone, edge in zip(values, COLORS, ZONES, ("AB", "BC", "CD")):
                axes.barh(y, value, left=start, height=height, color=color, edgecolor="white",
                          label=f"{zone.removesuffix('_length')} ({edge})" if i == 0 and height > 0.3 else None)
                if value > 2.0 and height > 0.3:
                    axes.text(start + value / 2, y, f"{value:g}", ha="center", va="center", color="white",
                              fontsize="small")
                start += value
    axes.set(xlabel="x from A, mm", xlim=(0, SIDE), yticks=range(len(summaries)),
             yticklabels=[f"{i + 1}: µ {mu:g}, F {push:g}, f {press:g}"
                          for i, (mu, push, press, _) in enumerate(table1.ROWS)],
             title="Zones found (thin: the paper, row 2 as corrected)")
    axes.invert_yaxis()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=3, frameon=False)


def main(folder, sweep, *images):
    matplotlib.use("Agg")
    summaries = [table1.summary(folder, row) for row in range(1, len(table1.ROWS) + 1)]
    figure = plt.figure(figsize=(14, 9.5), layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=(1.15, 1))
    left, right = above.subplots(1, 2, width_ratios=(1, 1.35))
    draw_bar(left)
    draw_zones(right, summaries)
    marks = [(-push / press, mu, str(row)) for row, (mu, push, press, _) in enumerate(table1.ROWS, start=1)]
    swept = Case(sweep)
    study = study_of(swept)
    axes = below.subplots(1, 3, sharey=True)
    maps = [draw_map(axis, study, column, marks) for axis, column in zip(axes, study.columns)]
    below.colorbar(maps[-1], ax=axes)
    for axis in axes:
        axis.set(xlabel="F / f")
    axes[0].set(ylabel="friction µ")
    for image in images:
        figure.savefig(image, dpi=110)
        print(image)


if __name__ == "__main__":
    main(*sys.argv[1:])
