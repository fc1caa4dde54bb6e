#!/usr/bin/env python3
"""Load histories of solids: against the plane, closed forms, single cases, and with all vectors turned."""
import csv
import math
import shutil
import subprocess
import time
import unittest

from harness import PROGRAM, block, read_vtu
from histories import HistoryTest

TIMES = "history times = 0.0, 1.0, 2.0, 3.0  substeps = 4  cycles = 1.0, 2.0, 3.0"
OUTPUT = "output points_every = 1  states_every = 6  fields_every = 12"
SIDES = ("left", "right"), ("front", "back"), ("bottom", "top")
# How a floor moves under a body: here and there along two directions, and along its normal.
WAYS = {"x": "0.0, 0.06, 0.06, -0.03", "y": "0.0, 0.0, 0.05, -0.04", "z": "0.0, 0.004, -0.004, 0.002"}


def solid(*groups, size="2.0, 2.0, 1.0", cells="4, 4, 2", element="hex8", material="young = 100.0  poisson = 0.3"):
    """The deck of a box."""
    mesh = f"kind = 'box'  size = {size}  cells = {cells}  element = '{element}'"
    return block("case name = 'case'  units = 'mm, N, MPa'", *groups, mesh=mesh, material=material)


def pushed(cells="4, 4, 2", element="hex8", **words):
    """A block that is pressed on a floor, held at its top and pushed on one side, while the floor moves."""
    return solid("support set = 'top'  ux = 0.0  uy = 0.0", "load name = 'press'  set = 'top'  pressure = 2.0",
                 "load name = 'push'  set = 'right'  traction = -1.0, 0.5, 0.1",
                 "contact name = 'floor'  set = 'bottom'  friction = 0.3  wear = 1.0e-3", TIMES, OUTPUT,
                 "steps load = 'press'  factor = 0.0, 1.0, 1.0, 0.7",
                 "steps load = 'push'  factor = 0.0, 0.5, -0.5, 0.5",
                 "steps obstacle = 'floor'  " + "  ".join(f"shift_{axis} = {way}" for axis, way in WAYS.items()),
                 cells=cells, element=element, **words)


class SolidHistory(HistoryTest):
    """Histories of solids."""

    def rows(self, ending="history.csv"):
        """The rows of a table of the case, its numbers as such."""
        def value(text):
            try:
                return float(text)
            except ValueError:
                return text
        return [{key: value(text) for key, text in row.items()} for row in self.table(f"case.{ending}")]

    def walk_verified(self, text):
        """Runs a deck, whose files must be verified."""
        self.walk(text)
        self.assertEqual(self.run_program("--verify", "out").stdout, "case: verified\n")

    def test_layer_is_the_plane(self):
        # One layer between two guides is plane strain; both fronts have half of the plane's forces.
        rest = ("steps load = 'press'  factor = 0.0, 1.0, 1.0, 0.5",
                "steps load = 'push'  factor = 0.0, 0.8, -1.0, 0.9",
                "load name = 'press'  set = 'top'  pressure = 2.0", TIMES,
                "output points_every = 1  fretting = 'parameters'",
                "contact name = 'floor'  set = 'bottom'  friction = 0.4  wear = 1.0e-3")
        material = "young = 130.0  poisson = 0.2"
        self.walk_verified(block(
            "case name = 'case'", "support set = 'right'  ux = 0.0",
            "load name = 'push'  set = 'left'  traction = 1.0, 0.0", *rest,
            "steps obstacle = 'floor'  shift_x = 0.0, 0.01, -0.01, 0.0  shift_y = 0.0, 0.0, 0.001, 0.0",
            material=material, mesh="size = 4.0, 2.0  cells = 8, 4"))
        plane, points = self.rows(), self.rows("points.csv")
        self.walk_verified(solid(
            "support set = 'right'  ux = 0.0", "support set = 'front'  uy = 0.0",
            "support set = 'back'  uy = 0.0",
            "load name = 'push'  set = 'left'  traction = 1.0, 0.0, 0.0", *rest,
            "steps obstacle = 'floor'  shift_x = 0.0, 0.01, -0.01, 0.0  shift_z = 0.0, 0.0, 0.001, 0.0",
            size="4.0, 1.0, 2.0", cells="8, 1, 4", material=material))
        for before, after in zip(plane, self.rows(), strict=True):
            # Forces of 8 and energies of 0.1 after 13 steps of two routes; the wear has units of 1e-3.
            for name in ("normal_force", "force_x_floor", "reaction_x_right"):
                self.assertAlmostEqual(before[name], after[name], delta=1e-9, msg=name)
            for name in ("strain_energy", "dissipation", "dissipation_step", "work_loads", "work_obstacles",
                         "energy_error", "closing_loss", "max_slip_accumulated"):
                self.assertAlmostEqual(before[name], after[name], delta=1e-10, msg=name)
            for name in ("max_wear_depth", "wear_volume_floor"):
                self.assertAlmostEqual(before[name], after[name], delta=1e-12, msg=name)
        layer = {}
        for row in self.rows("points.csv"):
            layer.setdefault((row["step"], round(row["x"], 9)), []).append(row)
        for row in points:
            both = layer[row["step"], round(row["x"], 9)]
            for name in ("normal_force", "dissipation"):
                self.assertAlmostEqual(sum(twin[name] for twin in both), row[name], delta=1e-9, msg=name)
            for twin in both:
                for name in ("gap", "slip_accumulated", "contact_pressure", "wear_depth"):
                    self.assertAlmostEqual(twin[name], row[name], delta=1e-9, msg=name)
                self.assertAlmostEqual(abs(row["slip"]), twin["slip"], delta=1e-10)
                self.assertAlmostEqual(twin["ruiz_1"], row["ruiz_1"], delta=1e-9)
                # The stress along the layer, or that across it, of which strain there is none.
                along = row["surface_stress"]
                self.assertAlmostEqual(twin["surface_stress"], max(along, 0.2*(along - row["contact_pressure"])),
                                       delta=1e-8)
                self.assertEqual(twin["status"], row["status"].rstrip("+-"))

    def test_floor_that_goes_round_takes_its_way_times_friction(self):
        # All of a stiff block slides at once.
        radius, n = 0.05, 24
        angles = [2.0*math.pi*i/n for i in range(n + 1)]
        way = {axis: ", ".join(f"{radius*value(angle):.15f}" for angle in angles)
               for axis, value in (("x", math.sin), ("y", lambda angle: 1.0 - math.cos(angle)))}
        for element in ("hex8", "hex20", "tet10"):
            with self.subTest(element):
                self.walk_verified(solid(
                    "support set = 'top'  ux = 0.0  uy = 0.0", "load set = 'top'  pressure = 2.0",
                    "contact name = 'floor'  set = 'bottom'  friction = 0.3",
                    f"history times = {', '.join(map(str, range(n + 1)))}  cycles = 0.0, {n}",
                    "output points_every = 1  fretting = 'parameters'",
                    f"steps obstacle = 'floor'  shift_x = {way['x']}  shift_y = {way['y']}", element=element,
                    cells="2, 2, 1", material="young = 1.0e8  poisson = 0.0"))
                force, chord = 0.3*2.0*4.0, 2.0*radius*math.sin(math.pi/n)
                rows = self.rows()
                for i, row in enumerate(rows[1:], 1):
                    middle = 0.5*(angles[i - 1] + angles[i])
                    # The block yields by stresses of 0.6 over 1e8, which is 1e-6 of the way of a step.
                    self.assertAlmostEqual(row["dissipation_step"], force*chord, delta=1e-7)
                    self.assertAlmostEqual(row["max_slip_accumulated"], i*chord, delta=1e-7)
                    self.assertAlmostEqual(row["force_x_floor"], force*math.cos(middle), delta=1e-5)
                    self.assertAlmostEqual(row["force_y_floor"], force*math.sin(middle), delta=1e-5)
                    self.assertAlmostEqual(row["tangential_force"], force, delta=1e-9)
                for row in self.rows("points.csv"):
                    step = int(row["step"]) - 1
                    self.assertAlmostEqual(row["slip_x"], -radius*math.sin(angles[step]), delta=1e-7)
                    self.assertAlmostEqual(row["slip_y"], -radius*(1.0 - math.cos(angles[step])), delta=1e-7)
                    self.assertAlmostEqual(row["slip"], math.hypot(row["slip_x"], row["slip_y"]), delta=1e-15)

                # The range of a slip is the width of its path in the widest of directions 2 degrees apart.
                shear = {}
                for row in self.rows("points.csv"):
                    shear[row["point"]] = max(row["contact_shear"], shear.get(row["point"], 0.0))
                    if row["step"] == n + 1:
                        ruiz = shear[row["point"]]*2.0*radius
                        self.assertAlmostEqual(row["ruiz_1"], ruiz, delta=2e-4*ruiz)

    def test_stress_in_the_surface_is_exact(self):
        # A hot block in uniform stress on a smooth floor or wall, pulled in two directions and sheared between them:
        # 2 and 1 along these, shear 3/4. The planes of SWT are 5 degrees apart; one of them is as near as 2.5.
        principal = 1.5 + math.hypot(0.5, 0.75)
        across = 1.5 - math.hypot(0.5, 0.75)
        swt = 0.5*principal*2.0*(principal - 0.3*across)/200.0
        for element in ("hex8", "hex20", "tet10", "tet4"):
            for shift in (0, 1, 2):
                with self.subTest(element, shift=shift):
                    def turned(*vector, by=shift):
                        return ", ".join(str(vector[(i - by) % 3]) for i in range(3))
                    ends = [SIDES[(i + shift) % 3] for i in range(3)]
                    first, second = f"u{'xyz'[shift]}", f"u{'xyz'[(1 + shift) % 3]}"
                    self.walk_verified(solid(
                        *(f"load name = 'pull'  set = '{ends[i][k]}'  traction = {turned(*(s*(2*k - 1) for s in pull))}"
                          for i, pull in enumerate(((2.0, 0.75, 0.0), (0.75, 1.0, 0.0))) for k in (0, 1)),
                        f"load set = '{ends[2][1]}'  pressure = 3.0", "load temperature = 10.0",
                        f"contact set = '{ends[2][0]}'  normal = {turned(0.0, 0.0, 1.0)}",
                        f"support point = {turned(0.0, 0.0, 1.0)}  {first} = 0.0  {second} = 0.0",
                        f"support point = {turned(1.0, 0.0, 1.0)}  {second} = 0.0",
                        "history times = 0.0, 1.0, 2.0  cycles = 0.0, 2.0",
                        "steps load = 'pull'  factor = 1.0, -1.0, 1.0",
                        "output points_every = 2  fretting = 'parameters'", size="1.0, 1.0, 1.0", cells="2, 2, 2",
                        element=element, material="young = 200.0  poisson = 0.3  expansion = 1.0e-3"))
                    for row in self.rows("points.csv"):
                        # Rounding.
                        self.assertAlmostEqual(row["surface_stress"], principal, delta=1e-11)
                        if row["step"] == 3.0:
                            self.assertAlmostEqual(row["swt"], swt, delta=0.005*swt)
                            self.assertAlmostEqual(row["swt_angle"], 0.0, delta=1e-12)

    def test_path_round_a_corner_is_that_of_a_spring_and_a_slider(self):
        # A column in uniform shear, of stiffness G A/h, on a floor that bears no more than its slip bound: the floor
        # moves along x, then y, then back. Each step returns the force of the spring to the bound along its direction.
        stiffness, bound = 50.0*4.0/2.0, 0.6*4.0
        self.walk_verified(solid(
            "support set = 'top'  ux = 0.0  uy = 0.0  uz = -0.02", "support set = 'top'  ux = 0.0",
            "contact name = 'floor'  set = 'bottom'  slip_bound = 0.6",
            "history times = 0.0, 1.0, 2.0, 3.0  substeps = 8", "output points_every = 1",
            "steps obstacle = 'floor'  shift_x = 0.0, 0.05, 0.05, -0.01  shift_y = 0.0, 0.0, 0.05, -0.02",
            size="2.0, 2.0, 2.0", cells="1, 1, 1", material="young = 100.0  poisson = 0.0"))
        shear, place, taken = (0.0, 0.0), (0.0, 0.0), 0.0
        for row in self.rows():
            here = (row["shift_x_floor"], row["shift_y_floor"])
            trial = [f + stiffness*(new - old) for f, new, old in zip(shear, here, place)]
            share = min(1.0, bound/max(bound, math.hypot(*trial)))
            taken += share*math.hypot(*trial)*(1.0 - share)*math.hypot(*trial)/stiffness
            shear, place = [share*f for f in trial], here
            # Rounding of forces of 200 that press the column.
            self.assertAlmostEqual(row["force_x_floor"], shear[0], delta=1e-10)
            self.assertAlmostEqual(row["force_y_floor"], shear[1], delta=1e-10)
            self.assertAlmostEqual(row["dissipation"], taken, delta=1e-11)
        self.assertGreater(taken, 0.1)

    def test_uniform_pressure_wears_by_archard_exactly(self):
        for element in ("hex8", "hex20", "tet10"):
            with self.subTest(element):
                self.walk_verified(solid(
                    "support set = 'left'  ux = 0.0", "support set = 'front'  uy = 0.0",
                    "load set = 'top'  pressure = 3.0", "contact name = 'sole'  set = 'bottom'  wear = 1.0e-3",
                    "history times = 0.0, 1.0, 2.0  substeps = 3", OUTPUT,
                    "steps obstacle = 'sole'  shift_x = 0.0, 0.3, 0.0  shift_y = 0.0, 0.4, -0.8",
                    element=element, material="young = 100.0  poisson = 0.0"))
                depth = 1.0e-3*3.0*(0.5 + math.hypot(0.3, 1.2))
                last = self.rows()[-1]
                # Rounding; what was worn before the last step is the way that the block has sunk.
                self.assertAlmostEqual(last["max_wear_depth"], depth, delta=1e-14)
                self.assertAlmostEqual(last["wear_volume_sole"], 4.0*depth, delta=1e-14)
                sunk = 1.0e-3*3.0*(0.5 + 2.0/3.0*math.hypot(0.3, 1.2))
                for row in self.rows("points.csv"):
                    self.assertEqual(row["dissipation"], 0.0)
                for uz in self.bottom_displacements():
                    self.assertAlmostEqual(uz, -sunk, delta=1e-13)

    def bottom_displacements(self):
        """The displacements along z of the nodes at z = 0."""
        arrays, _, _ = read_vtu((self.results / "case.vtu").read_bytes())
        return [u[2] for x, u in zip(arrays["points"], arrays["displacement"]) if abs(x[2]) < 1e-12]

    def test_one_step_is_the_case(self):
        for element in ("hex8", "hex20", "tet10"):
            with self.subTest(element):
                groups = ("support set = 'top'  ux = 0.02  uy = 0.01  uz = -0.05",
                          "contact set = 'bottom'  friction = 0.3")
                self.walk(solid(*groups, element=element))
                static = self.rows("contact.csv")
                self.walk_verified(solid(*groups, "history times = 0.0", element=element))
                for before, after in zip(static, self.rows("contact.csv"), strict=True):
                    self.assertEqual(before["status"], after["status"])
                    for column in ("gap", "slip_x", "slip_y", "normal_force", "force_x", "force_y", "force_z"):
                        # Two solutions to a residual of 1e-10 of forces of 1.
                        self.assertAlmostEqual(before[column], after[column], delta=1e-9)

    def test_surface_of_two_triangles_moves_as_the_plane(self):
        corners = [(-1.0, -1.0, 0.0), (4.0, -1.0, 0.0), (4.0, 4.0, 0.0), (-1.0, 4.0, 0.0)]
        facets = "".join("facet normal 0 0 1\nouter loop\n" + "".join(
            "vertex " + " ".join(map(str, corners[i])) + "\n" for i in nodes) + "endloop\nendfacet\n"
            for nodes in ((0, 1, 2), (0, 2, 3)))
        self.write("floor.stl", f"solid floor\n{facets}endsolid floor\n")
        self.walk(pushed())
        plane = self.rows()
        self.walk_verified(pushed().replace("set = 'bottom'  ", "set = 'bottom'  obstacle = 'surface'  file = "
                                            "'floor.stl'  "))
        for before, after in zip(plane, self.rows(), strict=True):
            for name in before:
                if name not in ("iterations", "statuses", "residual"):
                    # Gaps of two routes differ by rounding.
                    self.assertAlmostEqual(before[name], after[name], delta=1e-9, msg=name)

    def test_restart_from_any_written_step_has_the_same_bytes(self):
        text = pushed().replace("states_every = 6", "states_every = 3")
        self.walk_verified(text)
        rows, contact = self.text("case.history.csv").splitlines(), self.text("case.contact.csv")
        shutil.copy(self.results / "case.states.csv", self.directory)
        for step in (1, 4, 7, 10):
            self.walk_verified(text.replace("&history", f"&history start = 'case.states.csv'  start_step = {step} "))
            self.assertEqual(self.text("case.history.csv").splitlines(), [rows[0], *rows[step + 1:]])
            self.assertEqual(self.text("case.contact.csv"), contact)

    def test_killed_history_goes_on_to_the_same_bytes(self):
        text = pushed().replace("substeps = 4", "substeps = 150").replace("points_every = 1 ", "points_every = 7 ")
        growing = [f"case.{ending}.csv" for ending in ("history", "points", "states", "cycles", "contact")]
        self.walk(text)
        expected, note = [self.text(name) for name in growing], self.results / "case.history.checkpoint"
        for _ in range(20):
            shutil.rmtree(self.results)
            run = subprocess.Popen([PROGRAM, "--quiet", "--output", "out", "deck.nml"], cwd=self.directory)
            while run.poll() is None and not (note.exists() and b" rows\n" in note.read_bytes()):
                time.sleep(0.001)
            run.kill()
            run.communicate()
            self.walk(text)
            self.assertEqual([self.text(name) for name in growing], expected)
            if self.summary("case")["load_history"]["steps_done_earlier"] > 0:
                return
        self.fail("no run went on with the steps of another")

    def test_turned_deck_turns_its_vectors(self):
        # By a quarter turn about z, and with the axes exchanged in turn, so that the floor is a wall.
        text = pushed().replace("-1.0, 0.5, 0.1", "-1.0, 0.0, 0.1")
        quarter = text.replace("'right'  traction = -1.0, 0.0, 0.1", "'back'  traction = 0.0, -1.0, 0.1")
        quarter = quarter.replace(f"shift_x = {WAYS['x']}  shift_y = {WAYS['y']}",
                                  f"shift_x = {opposite(WAYS['y'])}  shift_y = {WAYS['x']}")
        exchanged = text
        for old, new in (("size = 2.0, 2.0, 1.0  cells = 4, 4, 2", "size = 1.0, 2.0, 2.0  cells = 2, 4, 4"),
                         ("set = 'top'  ux = 0.0  uy = 0.0", "set = 'right'  uy = 0.0  uz = 0.0"),
                         ("set = 'top'", "set = 'right'"),
                         ("set = 'right'  traction = -1.0, 0.0, 0.1", "set = 'back'  traction = 0.1, -1.0, 0.0"),
                         ("set = 'bottom'", "set = 'left'  normal = 1.0, 0.0, 0.0")):
            self.assertIn(old, exchanged)
            exchanged = exchanged.replace(old, new)
        exchanged = exchanged.replace("shift_x", "shift_1").replace("shift_z", "shift_x").replace(
            "shift_y", "shift_z").replace("shift_1", "shift_y")
        self.walk(text)
        first, points = self.rows(), self.rows("points.csv")
        # Places and vectors of the turned deck from those of the first.
        for other, turned in ((quarter, lambda v: (-v[1], v[0], v[2])), (exchanged, lambda v: (v[2], v[0], v[1]))):
            self.walk_verified(other)
            for before, after in zip(first, self.rows(), strict=True):
                for name in ("slip_area", "normal_force", "tangential_force", "strain_energy", "dissipation",
                             "work_obstacles", "work_loads", "max_slip_accumulated", "max_wear_depth"):
                    # Two factors; rounding of energies of 1 and forces of 8.
                    self.assertAlmostEqual(before[name], after[name], delta=1e-9, msg=name)
                forces = turned([before[f"force_{axis}_floor"] for axis in "xyz"])
                for axis, force in zip("xyz", forces):
                    self.assertAlmostEqual(after[f"force_{axis}_floor"], force, delta=1e-9)
            origin = (2.0, 0.0, 0.0) if other is quarter else (0.0, 0.0, 0.0)
            found = {(row["step"], *(round(row[axis], 9) for axis in "xyz")): row for row in self.rows("points.csv")}
            for row in points:
                place = [round(a + b, 9) + 0.0 for a, b in zip(turned([row[axis] for axis in "xyz"]), origin)]
                twin = found[row["step"], *place]
                for name in ("slip", "force"):
                    for axis, value in zip("xyz", turned([row[f"{name}_{axis}"] for axis in "xyz"])):
                        self.assertAlmostEqual(twin[f"{name}_{axis}"], value, delta=1e-9, msg=name)
                self.assertAlmostEqual(row["slip_accumulated"], twin["slip_accumulated"], delta=1e-9)

    def test_energies_balance_better_with_shorter_steps(self):
        errors = []
        for substeps in (4, 8, 16):
            self.walk(pushed().replace("substeps = 4", f"substeps = {substeps}").replace("  wear = 1.0e-3", ""))
            self.assertLess(self.summary("case")["load_history"]["energy_identities"], 1e-12)
            errors.append(abs(self.rows()[-1]["energy_error"]))
        # Backward Euler is of the first order.
        self.assertLess(errors[1], 0.65*errors[0])
        self.assertLess(errors[2], 0.65*errors[1])

    def test_rigid_set_moves_by_all_six_numbers(self):
        self.walk_verified(solid(
            "rigid name = 'grip'  set = 'top'  force = 0.0, 0.0, -8.0  ux = 0.0  uy = 0.01  moment = 0.2, 0.1, 0.0"
            "  turn_z = 0.05", "contact name = 'floor'  set = 'bottom'  friction = 0.3",
            "history times = 0.0, 1.0, 2.0  substeps = 2", "steps load = 'grip'  factor = 0.0, 1.0, 0.5",
            "steps support = 'grip'  factor = 0.0, 1.0, -1.0"))
        for row in self.rows():
            force, motion = row["factor_grip"], row["motion_factor_grip"]
            # To rounding of forces of 8.
            self.assertAlmostEqual(row["rigid_grip_uy"], 0.01*motion, delta=1e-14)
            self.assertAlmostEqual(row["rigid_grip_turn_z"], 0.05*motion, delta=1e-14)
            self.assertAlmostEqual(row["rigid_grip_ux"], 0.0, delta=1e-14)
            self.assertAlmostEqual(row["force_z_floor"], 8.0*force, delta=1e-10)
            for axis in "xy":
                self.assertAlmostEqual(row[f"force_{axis}_floor"], -row[f"rigid_grip_force_{axis}"], delta=1e-10)
        self.assertGreater(abs(self.rows()[-1]["rigid_grip_moment_z"]), 0.1)

    def test_heat_presses_a_block_between_floor_and_lid(self):
        self.walk_verified(solid(
            "support set = 'top'  uz = 0.0", "support set = 'left'  ux = 0.0", "support set = 'front'  uy = 0.0",
            "load name = 'heat'  temperature = 10.0", "contact name = 'floor'  set = 'bottom'  friction = 0.3",
            "history times = 0.0, 1.0, 2.0", "steps load = 'heat'  factor = 0.0, 1.0, -1.0",
            material="young = 100.0  poisson = 0.0  expansion = 1.0e-3"))
        # The block is pressed by E alpha T over its area, lifts when it is cold, and its feet are held by friction.
        hot, cold = self.rows()[1:]
        self.assertAlmostEqual(hot["normal_force"], 100.0*1.0e-3*10.0*4.0, delta=0.3)
        self.assertEqual((cold["normal_force"], cold["open_area"]), (0.0, 4.0))

    def test_forged_numbers_are_found(self):
        self.results = self.directory / "results"
        self.solve_into_results(pushed(cells="2, 2, 1").replace("'case'", "'case_0'"))
        self.verify()

        def changed(column):
            def change(content):
                rows = list(csv.reader(content.decode().splitlines()))
                place = rows[0].index(column)
                row = max(rows[1:], key=lambda row: abs(float(row[place])))
                row[place] = repr(1.001*float(row[place]))
                return "".join(",".join(row) + "\n" for row in rows).encode()
            return change
        for ending, columns in (("history.csv", ("shift_z_floor", "slip_area", "tangential_force", "force_y_floor",
                                                 "dissipation", "max_wear_depth")),
                                ("points.csv", ("force_y", "slip", "slip_y", "slip_step", "wear_depth")),
                                ("states.csv", ("tangential_force_2_3", "anchor_2_3", "slip_accumulated_1")),
                                ("cycles.csv", ("max_drift", "force_change"))):
            for column in columns:
                with self.subTest(column):
                    self.assert_forgery_is_found(f"case_0.{ending}", changed(column), f"case_0.{ending}:")

    def test_key_of_the_plane_is_refused(self):
        run = self.walk(pushed().replace("shift_z", "turn"), status=1)
        self.assertRegex(run.stderr, "turn is for a plane body, but size in line 1 is for a solid")


def opposite(numbers):
    """A list of numbers with their signs changed."""
    return ", ".join(str(-float(number)) for number in numbers.split(","))


if __name__ == "__main__":
    unittest.main()
