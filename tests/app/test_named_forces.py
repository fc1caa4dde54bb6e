#!/usr/bin/env python3
"""Forces by name: what each support, contact set, pair, foundation and tie exerts on the body."""
import csv
import json
import math
import random
import unittest

from harness import CONTACT, PRESSURE, SUPPORT, TWO_BODIES, ProgramTest, block

SIZE = (4.0, 2.0)
# A ring pressed into another one of the same stiffness, pulled out at its end; the other one is held there.
PRESS_FIT = """&mesh name = 'pin'  size = 1.0, 6.0  cells = 3, 18  origin = 0.5, 0.0 /
&mesh name = 'hub'  size = 1.0, 4.0  cells = 3, 10  origin = 1.499, 1.0 /
&material young = 1e5  poisson = 0.3  hypothesis = 'axisymmetric' /
&support name = 'pull'  set = 'pin.top'  uy = 0.1 /
&support name = 'held'  set = 'hub.bottom'  uy = 0.0 /
&contact name = 'fit'  set = 'pin.right'  against = 'hub.left'  friction = 0.2 /
"""


def along(pressure, slope, length):
    """Resultant of a linear pressure over a length, and its moment about the beginning."""
    return pressure*length + slope*length**2/2, pressure*length**2/2 + slope*length**3/3


def random_block(choice):
    """A block with random supports, springs and obstacles, and the resultant (x, y, moment) of its loads."""
    traction = choice.uniform(-0.2, 0.2), choice.uniform(-0.2, 0.2)
    pressure, slope = choice.uniform(0.5, 1.0), choice.uniform(-0.05, 0.05)
    point = (0.0, SIZE[1], choice.uniform(-0.5, 0.5), choice.uniform(-0.5, 0.0))
    pressed, moment = along(pressure, slope, SIZE[0])
    # Along the bottom the origin is the corner; moments of tractions on the right side count from there as well.
    load = [traction[0]*SIZE[1] + point[2], traction[1]*SIZE[1] - pressed + point[3],
            SIZE[0]*traction[1]*SIZE[1] - traction[0]*SIZE[1]**2/2 - moment + point[0]*point[3] - point[1]*point[2]]
    hold = choice.choice(("ux = 0.0", "ux = 0.0  uy = 0.03", "un = -0.01", "ux = 0.0  spring_t = 20.0",
                          "spring_n = 30.0  spring_t = 10.0"))
    groups = [f"support set = 'left'  {hold}",
              f"load set = 'right'  traction = {traction[0]!r}, {traction[1]!r}",
              f"load set = 'top'  pressure = {pressure!r}  pressure_slope = {slope!r}, 0.0",
              f"load point = {point[0]}, {point[1]}  force = {point[2]!r}, {point[3]!r}"]
    if choice.random() < 0.5:
        # It shares a node with the left side.
        slide = "ut = 0.0  " if "-0.01" not in hold else ""
        groups.append(f"support name = 'roof'  set = 'top'  {slide}spring_n = {choice.uniform(1.0, 20.0)!r}")
    elif choice.random() < 0.5:
        groups.append("support point = 4.0, 2.0  ux = -0.02")
    tilt = choice.uniform(-0.01, 0.01)
    kind = choice.choice(("plane", "circle"))
    radius = "  radius = 100.0" if kind == "circle" else ""
    cells = "  multipliers = 'constant'" if choice.random() < 0.3 else ""
    friction = choice.uniform(0.0, 0.8)
    groups.append(f"contact name = 'floor'  set = 'bottom'  friction = {friction!r}  obstacle = '{kind}'"
                  f"{radius}  point = 2.0, 0.0  normal = {tilt!r}, 1.0{cells}")
    if choice.random() < 0.5:
        groups.append("contact set = 'right'  friction = 0.3  obstacle = 'plane'  normal = -1.0, 0.0"
                      f"  point = {4.0 + choice.uniform(-0.01, 0.01)!r}, 0.0")
    element = choice.choice(("tri3", "quad4", "tri6", "quad8", "quad9"))
    return block(*groups, mesh=f"size = 4.0, 2.0  cells = {choice.randint(3, 9)}, {choice.randint(2, 5)}"
                 f"  element = '{element}'"), load


class NamedForces(ProgramTest):
    """The members `reaction_...`, `force_...` and `tie_...` of the key results, and the columns of tables."""

    def summary(self, name):
        """The summary of a case."""
        return json.loads((self.directory/f"{name}.summary.json").read_text(encoding="utf-8"))

    def forces(self, deck):
        """The key results of a deck."""
        return self.solve(deck).summary["key_results"]

    def assert_balance(self, key, load, names, limit):
        """Checks that forces by name and the resultant of the loads, (x, y, moment), cancel."""
        # Moments are measured by forces times the size of the body.
        scale = sum(abs(value) for name, value in key.items() if name.startswith(("reaction_", "force_"))
                    and "moment" not in name) + abs(load[0]) + abs(load[1])
        for component, of_loads in zip(("x", "y", "moment"), load):
            total = of_loads + math.fsum(key[f"{kind}_{component}_{name}"] for kind, name in names)
            self.assertLess(abs(total), limit*scale*max(SIZE), component)

    def test_random_blocks_are_balanced_by_the_forces_on_them(self):
        decks = {}
        for number in range(200):
            deck, load = random_block(random.Random(number))
            decks[f"block_{number}"] = load
            self.write(f"block_{number}.nml", deck)
        self.run_program("--quiet", "--output", ".", *(f"{name}.nml" for name in decks), status=None)
        kinds, n_solved = set(), 0
        for name, load in decks.items():
            summary = self.summary(name)
            if not summary["converged"]:
                continue
            n_solved += 1
            key = summary["key_results"]
            names = {(kind, rest.partition("_")[2]) for kind, _, rest in (key_name.partition("_") for key_name in key)
                     if kind in ("reaction", "force")}
            with self.subTest(name):
                self.assert_balance(key, load, names, summary["certificate"]["limit"])
            kinds |= names
        self.assertGreater(n_solved, 180)
        self.assertEqual(kinds, {("reaction", "left"), ("reaction", "roof"), ("reaction", "point_2"),
                                 ("force", "floor"), ("force", "right")})

    def test_each_body_of_a_pair_is_balanced(self):
        key = self.forces(TWO_BODIES)
        for component, load in zip("xy", (1.2, -4.0)):
            pair = key[f"force_{component}_a.bottom"]
            self.assertAlmostEqual(key[f"reaction_{component}_a.left"] + pair, -load, delta=1e-10)
            self.assertAlmostEqual(key[f"reaction_{component}_b.bottom"], pair, delta=1e-10)
        self.assertAlmostEqual(key["force_normal_a.bottom"], 4.0, delta=1e-10)

    def test_the_force_beside_an_end_without_multiplier_acts_at_its_mean_place(self):
        # The corner of the slave is held, or belongs to another set: the multiplier beside it acts on the whole side.
        pair, held = "&contact set = 'a.bottom'  against = 'b.top'  friction = 0.2 /", "set = 'a.left'  ux = 0.0"
        wall = "&contact set = 'a.left'  obstacle = 'plane'  normal = 1.0, 0.0 /\n"
        pushed = TWO_BODIES.replace(f"&support {held} /\n", "").replace("0.3, 0.0", "-0.3, 0.0")
        for element in ("quad4", "tri6"):
            for kind, deck, other, load in (
                    ("force", TWO_BODIES.replace(held, held + "  uy = 0.001"), "reaction_moment_a.left", -10.4),
                    ("force", pushed.replace(pair, wall + pair), "force_moment_a.left", -5.6),
                    ("tie", TWO_BODIES.replace(held, held + "  uy = 0.001").replace(
                        pair, "&tie set = 'a.bottom'  to = 'b.top' /"), "reaction_moment_a.left", -10.4)):
                with self.subTest(element=element, kind=kind, other=other):
                    key = self.forces(deck.replace("8, 4 /", f"8, 4  element = '{element}' /"))
                    moment = key[f"{kind}_moment_a.bottom"]
                    self.assertAlmostEqual(moment + key[other], -load, delta=1e-8)
                    self.assertAlmostEqual(moment, key["reaction_moment_b.bottom"], delta=1e-8)
                    if kind == "force":
                        number = "_2" if wall in deck else ""
                        self.assertAlmostEqual(moment, key["contact_moment" + number], delta=1e-9)

    def test_pulled_and_held_face_of_a_press_fit(self):
        key = self.forces(PRESS_FIT)
        # It slips all along, so friction is at its bound.
        pull = key["reaction_y_pull"]
        self.assertAlmostEqual(pull, 0.2*key["force_normal_fit"], delta=1e-9*pull)
        self.assertAlmostEqual(key["reaction_y_held"], -pull, delta=1e-9*pull)
        self.assertAlmostEqual(key["force_y_fit"], -pull, delta=1e-9*pull)
        self.assertFalse([name for name in key if name.startswith(("reaction_x", "reaction_moment", "force_x",
                                                                   "force_moment"))])

    def test_sets_are_told_apart_by_their_names(self):
        # A bolt head that 3 press on its seat, and a gasket under 5; the reactions of two groups of one set are one.
        meshes = "".join(f"&mesh name = '{name}'  size = 1.0, 1.0  cells = 2, 2  origin = {x}, 0.0 /\n"
                         f"&load set = '{name}.top'  total_force = 0.0, -{force} /\n"
                         f"&support set = '{name}.left'  ux = 0.0 /\n"
                         f"&contact name = '{name}'  set = '{name}.bottom'  friction = 0.0  obstacle = 'plane' /\n"
                         for name, x, force in (("head", 0.0, 3.0), ("gasket", 5.0, 5.0)))
        key = self.forces(meshes + "&material young = 100.0  poisson = 0.0 /\n")
        for name, force, center in (("head", 3.0, 0.5), ("gasket", 5.0, 5.5)):
            for component, value in (("normal", force), ("tangential", 0.0), ("x", 0.0), ("y", force),
                                     ("moment", force*center)):
                self.assertAlmostEqual(key[f"force_{component}_{name}"], value, delta=1e-12)
        listing = (self.directory / "case.lst").read_text(encoding="utf-8")
        self.assertRegex(listing, r"\n  Force normal gasket +5\.0\n")

    def test_supports_along_oblique_directions_have_their_own_shares(self):
        # One node is held along y by one support and along the diagonal by another: the load (1, 0) takes sqrt(2)
        # along the diagonal, and -1 along y.
        mesh = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 1 "slope"
1 2 "floor"
2 3 "body"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 1 1 0
$EndNodes
$Elements
4
1 1 2 1 1 1 3
2 1 2 2 2 1 2
3 2 2 3 3 1 2 3
4 2 2 3 3 2 4 3
$EndElements
"""
        self.write("corner.msh", mesh)
        key = self.forces("&mesh kind = 'file'  file = 'corner.msh' /\n&material young = 100.0  poisson = 0.25 /\n"
                          "&support name = 'x'  set = 'slope'  un = 0.0 /\n"
                          "&support name = 'y'  set = 'floor'  un = 0.0 /\n"
                          "&load point = 1.0, 1.0  force = 0.5, -0.25 /\n")
        self.assertAlmostEqual(key["reaction_x_x"], -0.5, delta=1e-12)
        self.assertAlmostEqual(key["reaction_y_x"], 0.0, delta=1e-12)
        self.assertAlmostEqual(key["reaction_x_y"], 0.0, delta=1e-12)
        self.assertAlmostEqual(key["reaction_y_y"], 0.25, delta=1e-12)
        self.assertAlmostEqual(key["reaction_moment_x"] + key["reaction_moment_y"], 0.75, delta=1e-12)

    def test_tie_and_foundation(self):
        # A column of two tied blocks on springs; each bears 4 from above.
        for element in ("quad4", "quad8"):
            key = self.forces("&mesh name = 'a'  size = 4.0, 2.0  cells = 4, 2  element = 'ELEMENT' /\n"
                              "&mesh name = 'b'  size = 4.0, 2.0  cells = 5, 2  origin = 0.0, -2.0 "
                              " element = 'ELEMENT' /\n"
                              "&material young = 100.0  poisson = 0.25 /\n"
                              "&tie name = 'glue'  set = 'a.bottom'  to = 'b.top' /\n"
                              "&support name = 'bed'  set = 'b.bottom'  spring_n = 50.0  spring_t = 20.0 /\n"
                              "&load set = 'a.top'  pressure = 1.0  pressure_slope = 0.1, 0.0  traction = 0.5, 0.0 /\n"
                              .replace("ELEMENT", element))
            pressed, moment = along(1.0, 0.1, 4.0)
            for name in ("tie_{}_glue", "reaction_{}_bed"):
                for component, value in (("x", -2.0), ("y", pressed), ("moment", moment + 2.0*2.0)):
                    self.assertAlmostEqual(key[name.format(component)], value, delta=1e-9)

    def test_prescribed_motion_of_a_rigid_set(self):
        # Its reaction is what drives it; where a force does, that is a load and the reaction is 0.
        deck = block("support set = 'bottom'  ux = 0.0  uy = 0.0", "history times = 0.0, 1.0",
                     "rigid name = 'punch'  set = 'top'  uy = -0.01  turn = 0.001  point = 1.0, 2.0"
                     "  force = 0.5, 0.0", "steps support = 'punch'  factor = 0.0, 1.0")
        key = self.forces(deck)
        self.assertAlmostEqual(key["reaction_x_punch"], 0.0, delta=1e-10)
        self.assertAlmostEqual(key["rigid_punch_force_x"], 0.5, delta=1e-10)
        self.assertAlmostEqual(key["reaction_y_punch"], key["rigid_punch_force_y"], delta=1e-9)
        # About the origin; the given force has a moment of -1 there, that of the load.
        self.assertAlmostEqual(key["reaction_moment_punch"], key["rigid_punch_moment"] + key["reaction_y_punch"],
                               delta=1e-9)
        self.assertAlmostEqual(key["reaction_moment_punch"] + key["reaction_moment_bottom"] - 1.0, 0.0, delta=1e-9)
        with open(self.directory/"case.history.csv", newline="", encoding="utf-8") as file:
            row = list(csv.DictReader(file))[-1]
        for component in ("x", "y", "moment"):
            self.assertAlmostEqual(float(row[f"reaction_{component}_punch"]), key[f"reaction_{component}_punch"],
                                   delta=1e-9)

    def test_steps_and_rows_have_the_forces_of_cases(self):
        push = "load name = 'push'  set = 'right'  traction = -1.5, 0.3"
        held = "support name = 'wall'  set = 'left'  ux = -0.01  spring_t = 5.0"
        body = (held, PRESSURE, CONTACT, push)
        single = self.forces(block(*body))
        names = [name for name in single if name.startswith(("reaction_", "force_"))]
        self.assertEqual(len(names), 8)
        self.run_program("--quiet", self.write("sweep.nml", block(
            *body, "sweep load = 'push'  factor = 0.0, 1.0", "output key_results = 'forces'  fields_every = 1")))
        self.run_program("--quiet", self.write("steps.nml", block(
            *body, "history times = 0.0, 1.0", "steps load = 'push'  factor = 1.0, 1.0",
            "steps support = 'wall'  factor = 0.0, 1.0")))
        for table in ("sweep.sweep.csv", "steps.history.csv"):
            with open(self.directory/table, newline="", encoding="utf-8") as file:
                row = list(csv.DictReader(file))[-1]
            key = single if "sweep" in table else self.summary("steps")["key_results"]
            for name in names:
                self.assertAlmostEqual(float(row[name]), key[name], delta=1e-9, msg=f"{table}: {name}")
        self.assertEqual(self.run_program("--verify", ".").stdout, "case: verified\nsteps: verified\nsweep: verified\n")

    def test_changed_numbers_are_found(self):
        self.forces(block(SUPPORT, PRESSURE, CONTACT, "history times = 0.0, 1.0", "load name = 'p'  set = 'right'"
                          "  traction = -0.5, 0.0", "steps load = 'p'  factor = 0.0, 1.0"))
        path = self.directory/"case.history.csv"
        lines = path.read_text(encoding="utf-8").splitlines()
        place = lines[0].split(",").index("reaction_x_left")
        fields = lines[-1].split(",")
        fields[place] = repr(1.001*float(fields[place]))
        path.write_text("\n".join([*lines[:-1], ",".join(fields), ""]), encoding="utf-8")
        run = self.run_program("--verify", ".", status=4)
        self.assertIn("reaction_x_left is ", run.stdout + run.stderr)


if __name__ == "__main__":
    unittest.main()
