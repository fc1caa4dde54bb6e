#!/usr/bin/env python3
r"""Long bar on an elastic block.

The paper's bar, 32 by 10, rests on an elastic block of 60 by 20 that is held at its bottom, with friction of 0.2; their
meshes do not match, and the bar, with the finer one, is the slave. The stiffer the block, the more it is the rigid
floor: as $E_b$ grows, all differences to the bar on the floor fall with $1/E_b$.

The rigid floor has contact forces at the nodes; the dual multipliers of the pair have the same weights on the bar, so
that the limit is the same to the last digits. The lower right corner of the bar is held along the line. On the floor
the support bears its shear; on the block, which slides below it, friction does, so the tangential force there is left
out. Shown are the differences of the displacement of the bar's upper left corner and of the contact forces, over their
largest values, and that the forces on both bodies cancel.
"""
from harness import read_vtu

from benchmark import Benchmark, main
from convergence import ConvergenceTable, RoundoffTable

FLOOR = """&mesh size = 32.0, 10.0  cells = 32, 10 /
&material young = 1000.0   poisson = 0.3 /
&support set = 'right'  ux = 0.0 /
&load set = 'left'  traction = 10.0, 0.0 /
&load set = 'top'  pressure = 5.0 /
&contact set = 'bottom'  friction = 0.2 /
"""
N_POINTS = 33


class ElasticBlock(Benchmark):
    """From an elastic counter-body to a rigid one."""

    def test_stiffening(self):
        floor = self.solve(FLOOR)
        corner = self.corner()
        table = ConvergenceTable("Differences to the bar on the rigid floor; h stands for $E/E_b$",
                                 ["displacement", "forces"], {"quad4": (1, 1)}, allowance=0.05)
        forces = RoundoffTable("Sum of the forces on both bodies", ["$E_b$"], ["balance"], 1e-12)
        for young in self.meshes((1e6, 1e8), (1e4, 1e5, 1e6, 1e7, 1e8)):
            result = self.solve(self.deck("elastic_block").replace("1.0e6", repr(young)))
            self.assert_sound(result)
            held = N_POINTS + max(range(N_POINTS), key=lambda point: result["x"][point])
            differences = [abs(a - b) for k, (a, b) in enumerate(zip(result.forces, floor.forces)) if k != held]
            moved = max(abs(a - b) for a, b in zip(self.corner(), corner))
            table.add("quad4", 1000.0/young, moved/max(map(abs, corner)), max(differences)/max(floor.forces))
            forces.add(f"{young:.0e}", errors=[self.imbalance()])
        table.close()
        self.assert_table(table)
        self.assert_table(forces)

    def corner(self):
        """The displacement of the bar's upper left corner."""
        arrays, *_ = read_vtu((self.directory/"case.vtu").read_bytes())
        corner = next(i for i, point in enumerate(arrays["points"]) if point == (0.0, 10.0, 0.0))
        return arrays["displacement"][corner]

    def imbalance(self):
        """The sum of all forces on the contact line and on the line of the master, over that of their magnitudes."""
        arrays, n_points, _ = read_vtu((self.directory/"case.contact.vtu").read_bytes())
        self.assertEqual(n_points, N_POINTS + 46)
        force = arrays["force"]
        total = [sum(column) for column in zip(*force)]
        return max(map(abs, total))/sum(abs(part) for vector in force for part in vector)


if __name__ == "__main__":
    main()
