#!/usr/bin/env python3
r"""Twist of bodies of revolution.

With `twist = .true.` a body of revolution has a displacement around its axis, and friction acts against the resultant
of both slips. A shaft twists by $TL/(GJ)$, exactly on any mesh. A cone between two spherical caps about its apex twists
by $B/R^3$ under the torque $6\pi G B(\frac23-\cos\alpha_0+\frac13\cos^3\alpha_0)$ (A. Föppl, 1905). A punch that sticks
needs $T = \frac{16}3 G a^3\theta$ (E. Reissner, H. F. Sagoci, *J. Appl. Phys.* 15, 1944), one that slips $\frac\pi4\mu
P a$, a sphere that slips $\frac{3\pi}{16}\mu P a$; in between a ring of it slips (J. L. Lubkin, *J. Appl. Mech.* 18,
1951). A stepped shaft is compared with finite volumes on Michell's equation. A ring on a shaft slides when $(T/r)^2+Q^2
= (\mu N)^2$, a clutch of two rings slips at $\frac23\pi\mu p(b^3-a^3)$.

In between a ring slips and the circle $r < c$ sticks. With the function $g$ of the Abel transform of the shear, $\theta
= \frac{\mu p_0}{2G} I(c/a)$ and $T = \frac{16}3 G\theta c^3 + 8\mu p_0\int_c^a t^2 I(t/a)\,dt$, $I(k) = K(k')-E(k')$,
the complete elliptic integrals of $k' = \sqrt{1-k^2}$. The sphere is pressed on without friction, so that no slip is
left of that. $c$ is found from the turn, and compared with where the points stick; the torque follows.

The torque of a stepped shaft is compared with finite volumes on Michell's equation for the angle $u_\theta/r$, a
program of its own in the test, extrapolated.

Tolerances: shaft and clutch 1e-9, stepped shaft and ring 0.1 %, sphere 0.5 %, punch 1.5 % on the finest mesh.
"""
import csv
import math
import shutil

from benchmark import DECKS, ELEMENTS, Benchmark, main
from convergence import ConvergenceTable, RoundoffTable, ValueTable
from graded_block import graded_block
from mapped_mesh import mapped_mesh

SHEAR = 1000.0/2.5
HALF_SPACE, SIZE = 1000.0/2.6, 20.0
FRICTION, HALF_ANGLE = 0.3, math.pi/6


def cone(s, t):
    """The cone from R = 1 to 2, its axis on the left."""
    return (1 + t)*math.sin(HALF_ANGLE*s), (1 + t)*math.cos(HALF_ANGLE*s)


def shear_integral(k):
    """K(k') - E(k') by the arithmetic-geometric mean."""
    a, b, c, total, weight = 1.0, k, math.sqrt(1 - k*k), 0.0, 0.5
    while abs(c) > 1e-15:
        total += weight*c*c
        a, b, c, weight = (a + b)/2, math.sqrt(a*b), (a - b)/2, 2*weight
    return math.pi/(2*a)*total


def partial_slip(turn, peak):
    """Radius of the circle that sticks, over a = 1, and the torque, when a sphere has turned so far."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high)/2
        twisted = FRICTION*peak/(2*HALF_SPACE)*shear_integral(middle) if middle > 0 else math.inf
        low, high = (middle, high) if twisted > turn else (low, middle)
    n = 2000
    steps = [(low + (1 - low)*(i + 0.5)/n) for i in range(n)]
    ring = sum(t*t*shear_integral(t) for t in steps)*(1 - low)/n
    return low, 16/3*HALF_SPACE*turn*low**3 + 8*FRICTION*peak*ring


def stepped_torque(n):
    """Torque of the stepped shaft by finite volumes, n to a length of 1, relaxed until they stay."""
    cells = [(i, j) for j in range(4*n) for i in range(2*n if j < 2*n else n)]
    angle = dict.fromkeys(cells, 0.0005)
    flow = [((i + 1)**4 - i**4)/(4*n**3) for i in range(2*n)]
    links = {}
    for i, j in cells:
        sides = [((i - 1, j), (i/n)**3), ((i + 1, j), ((i + 1)/n)**3), ((i, j - 1), flow[i]), ((i, j + 1), flow[i])]
        near = [side for side in sides if side[0] in angle]
        top, end = 2*flow[i]*(j == 4*n - 1), 2*flow[i]*(j in (0, 4*n - 1))
        links[i, j] = near, top*0.001, sum(share for _, share in near) + end
    change = 1.0
    while change > 1e-12:
        change = 0.0
        for cell, (near, driven, whole) in links.items():
            step = (driven + sum(share*angle[other] for other, share in near))/whole - angle[cell]
            angle[cell] += 2/(1 + math.pi/(4*n))*step
            change = max(change, abs(step))
    return 2*math.pi*SHEAR*sum(2*flow[i]*angle[i, 0] for i in range(2*n))


class Twist(Benchmark):
    """Torsion, and friction against the resultant of two slips."""

    def test_shaft(self):
        table = RoundoffTable("Shaft", ["element"], ["angle", "shear", "torque"], 1e-9)
        polar = math.pi*2.0**4/2
        for element in ELEMENTS[1:]:
            result = self.solve(self.deck("twist_shaft", element=element))
            self.assert_sound(result)
            self.assertLess(result.summary["accuracy"]["relative_error"], 1e-9)
            key = result.summary["key_results"]
            table.add(element, errors=[abs(key["max_displacement"]/(2*5.0*10/(SHEAR*polar)) - 1),
                                       abs(key["max_von_mises"]/(math.sqrt(3)*5.0*2/polar) - 1),
                                       abs(key["reaction_torque_bottom"]/-5.0 - 1)])
        self.assert_table(table)

    def test_stepped_shaft(self):
        coarse, fine = stepped_torque(4), stepped_torque(8)
        n = self.meshes(8, 32)
        deck = self.deck("twist_stepped").replace("cells = 32, 32", f"cells = {n}, {n}")
        result = self.solve(deck.replace("cells = 16, 32", f"cells = {n//2}, {n}"))
        self.assert_sound(result)
        values = ValueTable("Stepped shaft", ["quantity"])
        values.add("torque", computed=result.summary["key_results"]["reaction_torque_thin.top"],
                   reference=fine + (fine - coarse)/(2**(4/3) - 1), allowed=self.meshes(0.005, 0.001))
        self.assert_table(values)

    def test_cone(self):
        orders = {element: (2,) if element in ("tri3", "quad4") else (4,) for element in ELEMENTS}
        table = ConvergenceTable("Cone: convergence of the torque", ["torque"], orders, allowance=0.3)
        torque = 6*math.pi*SHEAR*0.001/(1 - 1/8)*(2/3 - math.cos(HALF_ANGLE) + math.cos(HALF_ANGLE)**3/3)
        for element in ELEMENTS:
            for n in self.meshes((4, 8), (4, 8, 16)):
                result = self.solve(self.deck("twist_cone", mesh=mapped_mesh((n, 2*n), element, cone)))
                self.assert_sound(result)
                table.add(element, 1/n, abs(result.summary["key_results"]["reaction_torque_top"]/torque - 1))
        table.close()
        self.assert_table(table)

    def test_punch(self):
        values = ValueTable("Flat punch: torque", ["element", "h", "contact"])
        force = 0.1*math.pi*SIZE**2
        shutil.copy(DECKS/"flat_punch.csv", self.directory)
        for element in ("tri6", "quad8"):
            h = self.meshes(1/8, 1/32)
            mesh = graded_block(element, h, SIZE, 1.5)
            for contact, friction, turn, torque in (("sticks", 1000.0, 0.001, 16/3*HALF_SPACE*0.001),
                                                    ("slips", FRICTION, 0.1, math.pi/4*FRICTION*force)):
                result = self.solve(self.deck("twist_punch", mesh=mesh, friction=friction, turn=turn))
                self.assert_sound(result)
                values.add(element, f"1/{round(1/h)}", contact, reference=torque, allowed=self.meshes(0.05, 0.015),
                           computed=abs(result.summary["key_results"]["contact_torque"]))
        self.assert_table(values)

    def test_sphere(self):
        values = ValueTable("Sphere in partial slip", ["element", "turn", "quantity"])
        force = 4*HALF_SPACE*2.6/0.91/300
        peak = 3*force/(2*math.pi)
        for element in ("quad4", "quad8"):
            h = self.meshes(1/8, 1/32)
            self.assert_sound(self.solve(self.deck("twist_sphere", mesh=graded_block(element, h, SIZE, 1.5))))
            points = self.rows("points")
            for step in (11, 13, 17):
                rows = [row for row in points if int(row["step"]) == step and row["status"] != "open"]
                turn = 0.004*(step - 9)/8
                radius, torque = partial_slip(turn, peak)
                computed = sum(float(row["tangential_force_theta"])*float(row["x"]) for row in rows)
                values.add(element, turn, "torque", computed=abs(computed), reference=torque,
                           allowed=self.meshes(0.03, 0.005))
                sticking = [float(row["x"]) for row in rows if row["status"] == "stick" and float(row["x"]) > 0]
                if radius > 2*h:
                    self.assertAlmostEqual(max(sticking), radius, delta=1.5*h, msg=f"{element}, turn {turn}")
                else:
                    values.add(element, turn, "torque of full slip", computed=abs(computed), allowed=0.05,
                               reference=3*math.pi/16*FRICTION*force)
        self.assert_table(values)

    def test_fit(self):
        """Just below the resultant that makes it slide it holds, just above it there is no equilibrium."""
        result = self.solve(self.deck("twist_fit", traction=(0.0, 0.0), torque=0.0))
        limit = 0.2*sum(result["normal_force"])
        for angle in (0.0, 0.6, 1.2):
            pull, torque = limit*math.cos(angle), limit*math.sin(angle)
            for share in (0.999, 1.001):
                deck = self.deck("twist_fit", traction=(0.0, share*pull/(2*math.pi*1.2*0.5)), torque=share*torque)
                if share > 1:
                    self.assertIn("no equilibrium", self.run_program(self.write("case.nml", deck), status=2).stderr)
                    continue
                result = self.solve(deck)
                self.assert_sound(result)
                key = result.summary["key_results"]
                self.assertAlmostEqual(key["force_tangential_left"], -share*pull, delta=1e-9*limit)
                self.assertAlmostEqual(key["force_torque_left"], -share*torque, delta=1e-9*limit)

    def test_clutch(self):
        result = self.solve(self.deck("twist_clutch"))
        self.assert_sound(result)
        self.assertEqual({status for status in result["status"]}, {"slip"})
        torque = 2/3*math.pi*0.3*2.0*7.0
        self.assertAlmostEqual(result.summary["key_results"]["force_torque_upper.bottom"], -torque, delta=1e-9*torque)

    def rows(self, kind):
        """The rows of a table of the case."""
        with open(self.directory/f"case.{kind}.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))


if __name__ == "__main__":
    main()
