#!/usr/bin/env python3
"""Contact that runs past the end of its set: the boundary that goes on bears no force, so it goes through obstacles and
other bodies. A warning names the end; what penetrates fails the certificate."""
import csv
import json
import math
import unittest

from cut_meshes import block_mesh
from harness import ProgramTest
from verification import Verification

WHOLE = (-math.inf, math.inf)
UPPER = {"top": ("top", *WHOLE), "symmetry": ("left", *WHOLE)}
LOWER = {"base": ("bottom", *WHOLE)}
HELD = """&material young = 1000.0  poisson = 0.3 /
&support set = '{0}symmetry'  ux = 0.0 /
"""
REACHED = "the contact reaches the end of its set at ({}) and the boundary goes on: enlarge the set '{}'"
NAMED = "pressure = 5.0  name = 'press'"
ABOVE, BELOW = "set = 'upper.bottom'  against = 'lower.top'", "set = 'lower.top'  against = 'upper.bottom'"
INSIDE = "the boundary outside the contact sets penetrates the obstacle or the other body by "


class SetEnds(Verification, ProgramTest):
    """Blocks whose contact sets end within their sides."""

    def run_deck(self, deck, status, name="case"):
        """Runs a deck; its warnings and the part of the boundary that penetrates, as the certificate has it."""
        self.run_program("--output", "results", self.write(f"{name}.nml", deck), status=status)
        self.summary = json.loads((self.directory/"results"/f"{name}.summary.json").read_text(encoding="utf-8"))
        return self.summary["warnings"], self.summary["certificate"]["penetration_outside"]

    def expect_end(self, deck, *ends):
        """Checks that contact runs past ends of sets, and how large the penetration is."""
        warnings, inside = self.run_deck(deck, 4)
        found = [warning for warning in warnings if warning.startswith("the contact reaches")]
        self.assertEqual(found, [REACHED.format(*end) for end in ends])
        self.assertEqual(len([warning for warning in warnings if warning.startswith(INSIDE)]), 1, warnings)
        self.assertGreater(inside, 1e-3)
        self.assertFalse(self.summary["certificate"]["passed"])
        self.run_program("--verify", "results", status=4)

    def expect_sound(self, deck):
        """Checks that no end is reached, and nothing penetrates."""
        warnings, inside = self.run_deck(deck, 0)
        self.assertEqual([warning for warning in warnings if "set at" in warning or warning.startswith(INSIDE)], [])
        self.assertEqual(inside, 0.0)
        self.run_program("--verify", "results")

    def on_obstacle(self, end, obstacle, pressure=5.0, **mesh):
        """A block on an obstacle, its contact set from 0 to an end."""
        self.write("body.msh", block_mesh({**UPPER, "bottom": ("bottom", 0.0, end)}, **mesh))
        return f"&mesh file = 'body.msh' /\n{HELD.format('')}" \
            f"&load set = 'top'  pressure = {pressure} /\n&contact set = 'bottom'  {obstacle} /\n"

    def on_body(self, upper_end, lower_end, contact, bottom=lambda x: x*x/100, is_quadratic=False):
        """A block on another one, 2 wider, their contact sets from 0 to an end each."""
        self.write("upper.msh", block_mesh({**UPPER, "bottom": ("bottom", 0.0, upper_end)}, bottom=bottom,
                                           is_quadratic=is_quadratic))
        self.write("lower.msh", block_mesh({**LOWER, "top": ("top", 0.0, lower_end)}, size=(6.0, 3.0), cells=(48, 8),
                                           corner=(0.0, -3.0), is_quadratic=is_quadratic))
        return "&mesh name = 'upper'  file = 'upper.msh' /\n" \
            "&mesh name = 'lower'  file = 'lower.msh' /\n" + HELD.format("upper.") + \
            "&support set = 'lower.base'  ux = 0.0  uy = 0.0 /\n&load set = 'upper.top'  pressure = 5.0 /\n" \
            f"&contact {contact}  search = 3.0 /\n"

    def test_circle_wider_than_the_set(self):
        for is_quadratic in (False, True):
            for radius in (50.0, 200.0):
                with self.subTest(radius=radius, is_quadratic=is_quadratic):
                    obstacle = f"obstacle = 'circle'  radius = {radius}"
                    self.expect_end(self.on_obstacle(0.8, obstacle, is_quadratic=is_quadratic), ("0.8, 0.0", "bottom"))
                    self.expect_sound(self.on_obstacle(4.0, obstacle, is_quadratic=is_quadratic))

    def test_set_that_ends_early_in_a_pair(self):
        of_upper, of_lower = ("0.8, 0.0064", "upper.bottom"), ("0.75, 0.0", "lower.top")
        for is_quadratic in (False, True):
            for contact in (ABOVE, BELOW):
                with self.subTest(contact=contact, is_quadratic=is_quadratic):
                    self.expect_end(self.on_body(0.8, 6.0, contact, is_quadratic=is_quadratic), of_upper)
                    self.expect_end(self.on_body(4.0, 0.75, contact, is_quadratic=is_quadratic), of_lower)
                    self.expect_sound(self.on_body(4.0, 6.0, contact, is_quadratic=is_quadratic))
            self.expect_end(self.on_body(0.8, 0.75, ABOVE, is_quadratic=is_quadratic), of_upper, of_lower)

    def test_contact_beyond_where_it_is_looked_for(self):
        # Nodes of the slave that the master is too far from have no contact force, and go through it all the same.
        for is_quadratic in (False, True):
            for contact in (ABOVE, BELOW):
                for search, is_enough in ((0.002, False), (0.005, False), (0.1, True)):
                    with self.subTest(contact=contact, is_quadratic=is_quadratic, search=search):
                        deck = self.on_body(4.0, 6.0, contact, is_quadratic=is_quadratic)
                        deck = deck.replace("search = 3.0", f"search = {search}")
                        warnings, inside = self.run_deck(deck, 0 if is_enough else 4)
                        self.assertEqual(any(warning.startswith(INSIDE) for warning in warnings), not is_enough)
                        self.assertEqual(any("the end of search at" in warning for warning in warnings),
                                         not is_enough)
                        self.assertEqual(inside > 1e-3, not is_enough)
                        self.run_program("--verify", "results", status=0 if is_enough else 4)

    def test_nothing_touches_where_contact_is_looked_for(self):
        # A bar that bends down on a slope goes through it at its tip, 17 sides of the mesh away.
        self.write("slope.msh", block_mesh({"base": ("top", *WHOLE), "top": ("bottom", *WHOLE)}, size=(12.0, 1.0),
                                           cells=(100, 4), corner=(-1.0, 0.0), bottom=lambda x: 0.025*(x + 1.0)))
        warnings, inside = self.run_deck("""&mesh name = 'bar'  size = 10.0, 0.2  cells = 200, 4  origin = 0.0, -0.29 /
&mesh name = 'slope'  file = 'slope.msh' /
&material young = 1000.0  poisson = 0.3 /
&support set = 'bar.left'  ux = 0.0  uy = 0.0 /
&support set = 'slope.base'  ux = 0.0  uy = 0.0 /
&load set = 'bar.bottom'  pressure = 4e-4 /
&contact set = 'bar.top'  against = 'slope.top'  friction = 0.2 /
""", 4)
        self.assertGreater(inside, 0.1)
        self.assertTrue(any(warning.startswith(INSIDE) for warning in warnings), warnings)

    def test_sets_that_end_at_a_corner(self):
        # The block ends at x = 4: it covers a part of the lower one, whose set may end beside it.
        for ends in ((4.0, 6.0), (4.0, 4.0)):
            for contact in (ABOVE, BELOW):
                self.expect_sound(self.on_body(*ends, contact, bottom=lambda x: 0.0))
        self.expect_sound(self.on_obstacle(4.0, "obstacle = 'plane'"))

    def test_guided_end_of_a_slave_keeps_its_normal_where_the_other_body_goes_on(self):
        # A wedge pushed along the floor by an inclined wall: all of it slips. The normal of its corner was mirrored on
        # the wall, as if it were a plane of symmetry; and the flank on the other side, which hangs over, slides along
        # the floor without entering it.
        for slope in (-0.3, 0.6):
            lines = block_mesh({"top": ("top", *WHOLE), "wall": ("left", *WHOLE), "bottom": ("bottom", *WHOLE)},
                               size=(4.0, 2.0), cells=(10, 12)).splitlines()
            for k in range(lines.index("$Nodes") + 2, lines.index("$EndNodes")):
                number, x, y, z = lines[k].split()
                lines[k] = f"{number} {float(x) + slope*float(y)!r} {y} {z}"
            self.write("wedge.msh", "\n".join(lines) + "\n")
            for contact in (ABOVE, BELOW):
                with self.subTest(slope=slope, contact=contact):
                    self.expect_sound(f"""&mesh name = 'upper'  file = 'wedge.msh' /
&mesh name = 'lower'  size = 12.0, 2.0  cells = 30, 3  origin = -4.0, -2.0 /
&material young = 1000.0  poisson = 0.3 /
&support set = 'lower.bottom'  ux = 0.0  uy = 0.0 /
&support set = 'upper.wall'  un = -0.4 /
&load set = 'upper.top'  pressure = 1.0 /
&contact {contact}  friction = 0.2 /
""")
                    forces = [abs(self.summary["key_results"][f"contact_force_{axis}"]) for axis in "xy"]
                    self.assertAlmostEqual(forces[0], 0.2*forces[1], delta=1e-8)

    def test_half_of_a_flat_block(self):
        self.expect_end(self.on_obstacle(2.0, "obstacle = 'plane'"), ("2.0, 0.0", "bottom"))
        self.expect_end(self.on_body(2.0, 6.0, ABOVE, bottom=lambda x: 0.0), ("2.0, 0.0", "upper.bottom"))

    def test_obstacle_that_ends_with_the_set(self):
        self.write("pad.csv", "-4.0, -1.0\n-4.0, 0.0\n2.0, 0.0\n2.0, -1.0\n-4.0, -1.0\n")
        self.expect_sound(self.on_obstacle(2.0, "obstacle = 'polyline'  line = 'pad.csv'"))
        self.expect_sound(self.on_obstacle(4.0, "obstacle = 'polyline'  line = 'pad.csv'"))

    def test_body_that_reaches_below_its_plane(self):
        # The plane stands for a pad under the raised part of the bottom: what lies beside and below never touches it.
        self.expect_sound(self.on_obstacle(2.0, "obstacle = 'plane'", bottom=lambda x: 0.0 if x < 2.05 else -0.5))

    def test_axisymmetric_body(self):
        deck = self.on_obstacle(0.8, "obstacle = 'circle'  radius = 50.0", pressure=50.0).replace(
            "poisson = 0.3", "poisson = 0.3  hypothesis = 'axisymmetric'")
        self.expect_end(deck, ("0.8, 0.0", "bottom"))

    def test_constant_multipliers(self):
        self.expect_end(self.on_obstacle(0.8, "obstacle = 'circle'  radius = 50.0  multipliers = 'constant'"),
                        ("0.8, 0.0", "bottom"))

    def test_interference(self):
        # The obstacle is what loads the block.
        deck = self.on_obstacle(0.8, "obstacle = 'circle'  radius = 50.0  extra_gap = -0.02", pressure=0.0).replace(
            "&load set = 'top'  pressure = 0.0 /", "&support set = 'top'  uy = 0.0 /")
        self.expect_end(deck, ("0.8, 0.0", "bottom"))

    def test_cases_of_a_sweep(self):
        deck = self.on_obstacle(0.8, "obstacle = 'circle'  radius = 50.0").replace("pressure = 5.0", NAMED)
        deck += "&sweep load = 'press'  factor = 0.05, 1.0, 0.5 /\n"
        warnings, inside = self.run_deck(deck, 4)
        self.assertIn("2 of 3 cases, case 2 the first: the contact reaches an end of its set and the boundary goes on: "
                      "enlarge the set, or search", warnings)
        self.assertEqual(self.summary["certificate"]["case"], 2)
        self.assertGreater(inside, 1e-3)
        rows = (self.directory/"results"/"case.sweep.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual(["end_of_set" in row for row in rows], [False, False, True, True])

    def test_steps_of_a_history(self):
        # The load reaches its peak in the middle; an obstacle that moves does the same.
        deck = self.on_obstacle(0.8, "obstacle = 'circle'  radius = 50.0").replace("pressure = 5.0", NAMED)
        history = "&history times = 0.0, 1.0, 2.0 /\n"
        pressed = deck + history + "&steps load = 'press'  factor = 0.0, 1.0, 0.01 /\n"
        moved = deck.replace(f"&load set = 'top'  {NAMED} /", "&support set = 'top'  uy = 0.0 /") + history \
            + "&steps obstacle = 'bottom'  shift_y = 0.0, 0.02, 0.0001 /\n"
        for text in (pressed, moved):
            warnings, _ = self.run_deck(text, 4)
            found, = [warning for warning in warnings if "end" in warning]
            self.assertIn("the contact reaches an end of its set and the boundary goes on: enlarge the set", found)
            self.assertGreater(self.summary["load_history"]["violation"], 1e-3)
            self.run_program("--verify", "results", status=4)
        # The bodies of a pair close gaps larger than search at the peak alone.
        deck = self.on_body(4.0, 6.0, ABOVE).replace("pressure = 5.0", NAMED).replace("search = 3.0", "search = 0.005")
        self.run_deck(deck + history + "&steps load = 'press'  factor = 0.0, 1.0, 0.01 /\n", 4)
        self.assertGreater(self.summary["load_history"]["violation"], 1e-3)


class MeetingSets(Verification, ProgramTest):
    """Contact sets that meet at a node: the law of both holds there, whichever the deck names first."""

    def key_results(self, name, deck):
        """Runs a deck; its key results, and the estimated error."""
        self.run_program("--output", "results", self.write(f"{name}.nml", deck))
        self.run_program("--verify", "results")
        summary = json.loads((self.directory/"results"/f"{name}.summary.json").read_text(encoding="utf-8"))
        return {**summary["key_results"], **summary["accuracy"]}

    def test_line_cut_in_two_sets(self):
        # The pressure at the node between them is that of the whole line, and so is the shear within Tresca's bound.
        whole = {"bottom": ("bottom", *WHOLE)}
        parts = {"bottom": ("bottom", -math.inf, 2.0), "rest": ("bottom", 2.0, math.inf)}
        for is_quadratic in (False, True):
            found = []
            for name, sets in (("whole", whole), ("parts", parts)):
                self.write(f"{name}.msh", block_mesh({**UPPER, **sets}, cells=(8, 4), is_quadratic=is_quadratic))
                deck = f"&mesh file = '{name}.msh' /\n{HELD.format('')}" \
                    "&load set = 'top'  pressure = 5.0  pressure_slope = -0.5, 0.0 /\n"
                deck += "".join(f"&contact set = '{key}'  slip_bound = 0.02 /\n" for key in sets)
                results = self.key_results(name, deck)
                found.append([results[key] for key in ("max_contact_pressure", "max_contact_shear", "max_slip",
                                                       "error_norm")])
            for one, two in zip(*found):
                self.assertAlmostEqual(one, two, delta=1e-8*abs(one))  # ten digits are solved for

    def corner_results(self, element, hypothesis, friction, name):
        """A block that is pressed by 10 on a floor and by 20 on a wall: key results, the floor named first and last."""
        left = 2.0 if hypothesis == "axisymmetric" else 0.0
        walls = [f"&contact set = 'bottom'  friction = {friction} /\n",
                 f"&contact set = 'left'  friction = {friction}  normal = 1.0, 0.0  point = {left}, 0.0 /\n"]
        deck = f"&mesh size = 4.0, 2.0  cells = 4, 3  element = '{element}'  origin = {left}, 0.0 /\n" \
            f"&material young = 1000.0  poisson = 0.3  hypothesis = '{hypothesis}' /\n" \
            "&load set = 'top'  pressure = 10.0 /\n&load set = 'right'  pressure = 20.0 /\n"
        return [self.key_results(f"{name}_{k}", deck + "".join(order)) for k, order in enumerate((walls, walls[::-1]))]

    def test_uniform_pressure_in_a_corner(self):
        # Without friction the stresses are (-20, -10) everywhere; in plane strain 0.3*(-30) besides.
        for element in ("tri3", "quad4", "tri6", "quad8", "quad9"):
            for hypothesis, mises in (("plane stress", math.sqrt(300.0)), ("plane strain", math.sqrt(111.0))):
                for results in self.corner_results(element, hypothesis, 0.0, element):
                    self.assertAlmostEqual(results["max_contact_pressure"], 20.0, delta=1e-7)
                    self.assertAlmostEqual(results["max_von_mises"], mises, delta=1e-7)
                    self.assertLess(results["relative_error"], 1e-12)
                    # The moment of a set is that of its forces on the nodes, so also that of the forces by name.
                    self.assertEqual({round(abs(results[f"contact_moment_{k}"]), 9) for k in (1, 2)}, {80.0, 40.0})
                    self.assertEqual({round(results["force_moment_bottom"], 9), round(results["force_moment_left"], 9)},
                                     {80.0, -40.0})

    def test_estimated_error_where_sets_and_ties_meet(self):
        # Nothing is to be estimated where the stresses are exact: each set has its own pressure in the corners.
        cells = "multipliers = 'constant'  cells"
        for link in ("&contact set = 'upper.bottom'  against = 'lower.top' /",
                     "&tie set = 'upper.bottom'  to = 'lower.top' /",
                     f"&contact set = 'lower.top'  against = 'upper.bottom'  {cells} = 3 /"):
            walls = ["&contact set = 'lower.bottom'  point = 0.0, -2.0 /",
                     "&contact set = 'upper.left'  normal = 1.0, 0.0 /",
                     f"&contact set = 'lower.left'  normal = 1.0, 0.0  {cells} = 1 /"]
            for element in ("quad4", "tri6"):
                deck = "&mesh name = 'lower'  size = 4.0, 2.0  cells = 5, 3  origin = 0.0, -2.0  " \
                    f"element = '{element}' /\n&mesh name = 'upper'  size = 4.0, 2.0  cells = 4, 3  " \
                    f"element = '{element}' /\n&material young = 1000.0  poisson = 0.3 /\n" \
                    "&load set = 'upper.top'  pressure = 10.0 /\n&load set = 'upper.right'  pressure = 20.0 /\n" \
                    "&load set = 'lower.right'  pressure = 20.0 /\n"
                for sets in ([link, *walls], [*walls[::-1], link]):
                    results = self.key_results("meet", deck + "\n".join(sets) + "\n")
                    self.assertLess(results["relative_error"], 1e-12, msg=f"{element} {sets[0]}")

    def test_order_of_the_sets_at_a_corner(self):
        # What is left of it is the direction in which the node at the corner slides, on either wall.
        for element, hypothesis in (("quad4", "plane strain"), ("tri6", "plane stress"), ("quad8", "axisymmetric")):
            one, two = self.corner_results(element, hypothesis, 0.2, element)
            one, two = (results["max_displacement"] for results in (one, two))
            self.assertAlmostEqual(one, two, delta=2e-4*one, msg=element)


class AxisOfRevolution(Verification, ProgramTest):
    """Bodies of revolution of quadratic elements: the corner on the axis, whose shape function has no area."""

    def points(self, element, obstacle, top):
        """Solves a disc on an obstacle; its points from the axis on, as numbers by columns."""
        deck = f"&mesh size = 2.0, 1.0  cells = 4, 3  element = '{element}' /\n&support set = 'left'  ux = 0.0 /\n" \
            "&material young = 1000.0  poisson = 0.3  hypothesis = 'axisymmetric' /\n" \
            f"{top}\n&contact set = 'bottom'  {obstacle} /\n"
        self.run_program("--output", "results", self.write("disc.nml", deck))
        self.run_program("--verify", "results")
        with open(self.directory/"results"/"disc.contact.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_uniform_pressure_is_exact(self):
        for element in ("tri6", "quad8", "quad9"):
            points = self.points(element, "friction = 0.0", "&load set = 'top'  pressure = 5.0 /")
            self.assertEqual(float(points[0]["x"]), 0.0)
            for point in points:
                self.assertAlmostEqual(float(point["contact_pressure"]), 5.0, delta=1e-8, msg=element)

    def test_corner_stays_on_a_sphere(self):
        # The largest pressure is on the axis; a corner that is no point has the obstacle's apex inside the body.
        for element in ("tri6", "quad8", "quad9"):
            points = self.points(element, "obstacle = 'circle'  radius = 20.0", "&support set = 'top'  uy = -0.05 /")
            pressures = [float(point["contact_pressure"]) for point in points]
            self.assertEqual(float(points[0]["x"]), 0.0)
            self.assertGreater(pressures[0], 0.8*max(pressures), msg=element)


if __name__ == "__main__":
    unittest.main()
