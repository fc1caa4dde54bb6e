#!/usr/bin/env python3
r"""A driven wheel, and a roller between two plates.

With `sliding = 'finite'` bodies that a rigid set alone supports, or nothing, may turn by any angle. An elastic wheel
of radius $R$ rolls on an elastic floor, pressed by $P$ and driven by a torque. Carter (1926): it turns by more than
it rolls, by the share $\mu a/R\,(1 - \sqrt{1 - Q/(\mu P)})$ of its way, where $a$ is half the width of the contact
and $Q$ the pull of its hub. A ring without any support rolls between two plates, of which one moves: its center moves
by half as much, and it turns by half of this way over its radius.

Tolerances: 2.5 %, since the bodies are no half planes and half the contact is seven sides wide. 0.5 % for the ring,
whose 144 sides roll by their chords and flatten.
"""
import math

from benchmark import main
from convergence import ValueTable
from history_benchmark import HistoryBenchmark
from mapped_mesh import mapped_mesh
from test_sliding_pair import stations

LOAD, FRICTION, HALF_WIDTH = 2.7618397, 0.3, 0.08


def graded(t):
    """A way from 0 to 1 in steps that grow."""
    return (math.exp(3.2*t) - 1)/(math.exp(3.2) - 1)


def wheel():
    """A sector of a wheel of radius 1 on a floor below; its top is the hub."""
    along = stations((-0.9, -0.15, 8), (-0.15, 0.66, 68), (0.66, 1.2, 7))

    def place(s, t):
        radius = 1 - 0.6*graded(t)
        return radius*math.sin(along(s)), 1 - radius*math.cos(along(s))
    return mapped_mesh((83, 12), "quad4", place)


def floor():
    """The floor below the wheel."""
    along = stations((-1.3, -0.2, 8), (-0.2, 0.7, 62), (0.7, 1.9, 8))
    return mapped_mesh((78, 12), "quad4", lambda s, t: (along(s), -graded(1 - t)))


def ring(sides=144, rings=4):
    """A closed ring of radius 1 with its center at (0, 1), as a mesh file."""
    places = [(r*math.sin(2*math.pi*i/sides), 1 - r*math.cos(2*math.pi*i/sides))
              for r in (1 - 0.7*j/rings for j in range(rings + 1)) for i in range(sides)]

    def node(i, j):
        return j*sides + i % sides + 1
    cells = [(3, 1, node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1))
             for j in range(rings) for i in range(sides)]
    rows = cells + [(1, 2, node(i, 0), node(i + 1, 0)) for i in range(sides)]
    return "\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '2 1 "ring"', '1 2 "rim"',
                      "$EndPhysicalNames", "$Nodes", str(len(places)),
                      *(f"{k} {x!r} {y!r} 0" for k, (x, y) in enumerate(places, 1)), "$EndNodes",
                      "$Elements", str(len(rows)),
                      *(" ".join(map(str, (k, kind, 2, group, group, *nodes)))
                        for k, (kind, group, *nodes) in enumerate(rows, 1)), "$EndElements", ""])


class Rolling(HistoryBenchmark):
    """Wheels that turn far."""

    def test_wheel(self):
        table = ValueTable("Creep of the wheel over mu a/R", ["torque over mu P R"])
        self.write("rolling_wheel.msh", wheel())
        self.write("rolling_floor.msh", floor())
        free = None
        for torque in (0.0, 0.4375, 0.75, 0.9375):
            deck = self.deck("rolling").replace("-0.62141", repr(-torque*FRICTION*LOAD))
            # The first 0.3 of the way, nearly four half widths, bring the wheel to its steady state.
            rows = [row for row in self.steps(deck) if row["rigid_hub_ux"] > 0.3]
            first, last = rows[0], rows[-1]
            way = last["rigid_hub_ux"] - first["rigid_hub_ux"]
            turn = (first["rigid_hub_turn"] - last["rigid_hub_turn"])/way
            if free is None:
                free = turn
                continue
            pull = -sum(row["rigid_hub_force_x"] for row in rows)/len(rows)
            table.add(f"{torque:g}", computed=(turn - free)/(FRICTION*HALF_WIDTH), allowed=2.5e-2,
                      reference=1 - math.sqrt(1 - pull/(FRICTION*LOAD)))
        self.assert_table(table)

    def test_ring(self):
        table = ValueTable("Motion of the ring over the way of the plate", ["what"])
        self.write("ring.msh", ring())
        rows = self.steps(self.deck("free_roller"))
        first, last = rows[1], rows[-1]
        # The probes are 0.6 apart on the upright diameter.
        across, up = last["ux_1"] - last["ux_2"], 0.6 + last["uy_1"] - last["uy_2"]
        center = 0.5*(last["ux_1"] + last["ux_2"] - first["ux_1"] - first["ux_2"])
        table.add("center", computed=center/2.0, reference=0.5, allowed=5e-3)
        table.add("turn", computed=math.atan2(across, up)/2.0, reference=0.5, allowed=5e-3)
        self.assert_table(table)


if __name__ == "__main__":
    main()
