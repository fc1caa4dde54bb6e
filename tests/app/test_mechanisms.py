#!/usr/bin/env python3
"""Mechanisms inside a body: blocks that share one node are refused with the node unless contact holds them."""
import unittest

from harness import HAS_SUITESPARSE, ProgramTest

MATERIAL = "&material young = 100.0  poisson = 0.3 /\n"
FACTORIZATIONS = ("auto", "band", "multifrontal") + ("sparse",)*HAS_SUITESPARSE


def blocks(cells, places):
    """A mesh file of blocks of cells x cells squares of size 1 that share the nodes where they meet, and their sides:
    LEFT1 is the left side of the first block."""
    number, elements, sides = {}, [], {}
    for k, (left, low) in enumerate(places, start=1):
        for j in range(cells):
            for i in range(cells):
                corners = [(cells*left + i + a, cells*low + j + b) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                elements.append([number.setdefault(corner, len(number) + 1) for corner in corners])
                for side, is_there in enumerate((j == 0, i == cells - 1, j == cells - 1, i == 0), start=1):
                    if is_there:
                        name = ("FLOOR", "RIGHT", "LID", "LEFT")[side - 1] + str(k)
                        sides.setdefault(name, []).append(f"{len(elements)}, S{side}")
    return "\n".join(["*NODE", *(f"{n}, {x/cells}, {y/cells}" for (x, y), n in number.items()),
                      "*ELEMENT, TYPE=CPE4, ELSET=ALL",
                      *(", ".join(map(str, [n, *nodes])) for n, nodes in enumerate(elements, start=1)),
                      *(line for name, members in sides.items() for line in (f"*SURFACE, NAME={name}", *members)), ""])


def deck_of_blocks(*groups):
    """A deck of blocks in a file."""
    return "&mesh file = 'blocks.inp' /\n" + MATERIAL + "".join(f"&{group} /\n" for group in groups)


# The first block is held, the second one hangs on it by a corner and is pressed on its floor.
HELD = ("support set = 'LEFT1'  ux = 0.0  uy = 0.0", "load set = 'LID2'  pressure = 0.1",
        "contact set = 'FLOOR2'  friction = 0.3")


class Mechanisms(ProgramTest):
    """Two blocks with a hinge."""

    def solve(self, text, status, *arguments):
        """Solves a deck."""
        self.write("hinge.nml", text)
        return self.run_program("--output", "out", *arguments, "hinge.nml", status=status)

    def test_hinge_that_nothing_holds_is_refused_by_all_factorizations(self):
        for cells in (1, 3, 10, 20):
            self.write("blocks.inp", blocks(cells, ((0, 0), (1, 1))))
            text = deck_of_blocks("load set = 'LID1'  pressure = 10.0", "contact set = 'FLOOR1'  friction = 0.3")
            for factorization in FACTORIZATIONS:
                run = self.solve(text, 2, "--set", f"solver.factorization={factorization}")
                self.assertEqual(run.stderr, "hinge.nml: a part of the body is free to turn about the node at 1.0, "
                                 "1.0, which alone joins it to another part: nothing holds it; add a support or a "
                                 "contact set\n")

    def test_hinge_that_a_load_turns_is_refused(self):
        # Contact holds it against the floor, not against a lift.
        self.write("blocks.inp", blocks(4, ((0, 1), (1, 0))))
        lifted = [group.replace("0.1", "-0.1") for group in HELD]
        run = self.solve(deck_of_blocks(*lifted), 2)
        self.assertRegex(run.stderr, r"^hinge\.nml: no equilibrium: .*friction cannot balance the loads; a part of the "
                         r"body is free to turn about the node at 1\.0, 1\.0, which alone joins it to another part; ")

    def test_hinge_that_contact_holds_is_solved(self):
        # The hinge is the first node of the floor, so that friction has no lever about it.
        self.write("blocks.inp", blocks(4, ((0, -1), (1, 0))))
        forces = []
        for factorization in FACTORIZATIONS:
            self.solve(deck_of_blocks(*HELD), 0, "--set", f"solver.factorization={factorization}")
            result = self.result("hinge", "out")
            self.assertTrue(result.summary["certificate"]["passed"])
            self.assertAlmostEqual(sum((x - 1.0)*force for x, force in zip(result["x"], result["normal_force"])), 0.05,
                                   delta=1e-12)
            forces.append(result.forces)
            self.run_program("--verify", "out")
        for other in forces[1:]:
            # Other orders of elimination.
            self.assert_close(other, forces[0], 1e-10, "forces")


if __name__ == "__main__":
    unittest.main()
