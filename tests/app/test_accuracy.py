#!/usr/bin/env python3
"""The accuracy of results: estimated errors, refined meshes, error bars."""
import csv
import json
import math
import random
import re
import signal
import subprocess
import time
import unittest

from harness import CONTACT, PRESSURE, PROGRAM, SUPPORT, ProgramTest, block, read_vtu

GROUPS = SUPPORT, PRESSURE, CONTACT
# A flat bar that rests on given friction and is pulled and pushed at one end.
ROUGH = """&case name = 'rough' /
&mesh size = 10.0, 0.01  cells = 40, 1 /
&material young = 1e5  poisson = 0.0  hypothesis = 'plane stress' /
&support set = 'right'  ux = 0.0 /
&load set = 'top'  pressure = 1.0 /
&load name = 'F'  set = 'left'  traction = 1000.0, 0.0 /
&contact set = 'bottom'  slip_bound = 2.0 /
&history times = 0.0, 1.0, 2.0, 3.0, 4.0  substeps = 1  cycles = 1.0, 4.0 /
&steps load = 'F'  factor = 0.0, 1.0, 0.0, -1.0, 1.0 /
&output probe = 0.0, 0.0  points_every = 2  states_every = 2 /
"""
COARSE = "size = 4.0, 2.0  cells = 4, 2"


class Accuracy(ProgramTest):
    """Decks with &accuracy, and decks that differ in their meshes."""

    def solve(self, name, *groups, **parts):
        """Writes and solves a deck; returns its summary."""
        self.write(name + ".nml", block(*groups, **parts))
        self.run_program("--output", "results", name + ".nml")
        return json.loads((self.directory / "results" / f"{name}.summary.json").read_text())

    def table(self, name):
        """The rows of a case's table of convergence by their quantity."""
        with open(self.directory / "results" / f"{name}.convergence.csv", encoding="utf-8", newline="") as file:
            return {row["quantity"]: row for row in csv.DictReader(file)}

    def test_estimate_falls_with_the_mesh(self):
        found = [self.solve(f"block_{level}", *GROUPS, mesh=f"{COARSE}  refine = {level}")["accuracy"]
                 for level in range(4)]
        for coarse, fine in zip(found, found[1:]):
            # First order where the solution is smooth, half of it beside the corner that the support ends at.
            self.assertLess(fine["error_norm"], 0.8*coarse["error_norm"])
            self.assertLess(fine["relative_error"], 0.8*coarse["relative_error"])

    def test_estimate_can_be_left_out(self):
        self.assertNotIn("accuracy", self.solve("block", *GROUPS, "accuracy estimate = 'none'"))
        self.assertNotIn('"error_norm"', (self.directory / "results" / "block.vtu").read_text())

    def test_fields_of_many_cases_have_estimates(self):
        clamp = SUPPORT + "  uy = 0.0"
        press = "load name = 'press'  set = 'top'  pressure = 1.0"
        histories = ("history times = 0.0, 1.0", "steps load = 'press'  factor = 1.0, 2.0",
                     "output fields_every = 1")
        sweeps = ("sweep load = 'press'  factor = 1.0, 2.0", "output fields_every = 1")
        # Without friction the states of a history are those of single cases, twice the load gives twice the error.
        single = self.solve("single", clamp, press, "contact set = 'bottom'")["accuracy"]
        for folder, groups in (("history", histories), ("sweep", sweeps)):
            summary = self.solve("many", clamp, press, "contact set = 'bottom'", *groups)
            for number in (1, 2):
                path = self.directory/"results"/f"many.{folder}"/f"{number}.vtu"
                errors = read_vtu(path.read_bytes())[0]["error_norm"]
                self.assertAlmostEqual(math.sqrt(sum(error**2 for error in errors)), number*single["error_norm"],
                                       delta=1e-8*single["error_norm"])
            self.run_program("--verify", "results")
            self.solve("none", clamp, press, "contact set = 'bottom'", *groups, "accuracy estimate = 'none'")
            self.assertNotIn(b'"error_norm"', (self.directory/"results"/f"none.{folder}"/"1.vtu").read_bytes())
            # Of the last step, or of the case certified.
            self.assertAlmostEqual(summary["accuracy"]["relative_error"], single["relative_error"], delta=1e-8)
            self.assertNotIn("accuracy", json.loads((self.directory/"results"/"none.summary.json").read_text()))

    def test_case_certified_of_a_sweep_has_an_estimate(self):
        groups = (SUPPORT + "  uy = 0.01", "contact set = 'bottom'  extra_gap = -0.01",
                  "load name = 'p'  set = 'top'  pressure = 1.0")
        summary = self.solve("rows", *groups, "sweep load = 'p'  factor = 0.5, 1.0, 2.0")
        self.assertIn("Accuracy of the worst case", (self.directory/"results"/"rows.lst").read_text(encoding="utf-8"))
        factor = (0.5, 1.0, 2.0)[summary["certificate"]["case"] - 1]
        single = self.solve("single", *groups[:2], f"load set = 'top'  pressure = {factor}")
        for key, value in single["accuracy"].items():
            self.assertAlmostEqual(summary["accuracy"][key], value, delta=1e-8*value)
        self.assertEqual(self.run_program("--verify", "results").stdout.count(": verified"), 2)

    def test_refine_is_an_option(self):
        named = self.solve("block", *GROUPS, "accuracy refinements = 2", mesh=COARSE)["convergence"]
        self.write("block.nml", block(*GROUPS, mesh=COARSE))
        self.run_program("--output", "results", "--refine", "2", "block.nml")
        self.assertEqual(json.loads((self.directory/"results"/"block.summary.json").read_text())["convergence"], named)

    def test_patches_grow_around_a_hub(self):
        # 40 triangles that meet in one node: the patch of a node at the rim, of two, grows by all of them.
        n = 40
        nodes = [(0.0, 0.0), *((math.cos(2*math.pi*i/n), math.sin(2*math.pi*i/n)) for i in range(n))]
        rim = [(i + 2, (i + 1) % n + 2) for i in range(n)]
        elements = [f"{i} 1 2 1 1 {a} {b}" for i, (a, b) in enumerate(rim, 1)]
        elements += [f"{n + i} 2 2 2 2 1 {a} {b}" for i, (a, b) in enumerate(rim, 1)]
        self.write("disc.msh", "\n".join([
            "$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '1 1 "rim"', '2 2 "disc"',
            "$EndPhysicalNames", "$Nodes", str(n + 1), *(f"{i} {x!r} {y!r} 0" for i, (x, y) in enumerate(nodes, 1)),
            "$EndNodes", "$Elements", str(2*n), *elements, "$EndElements", ""]))
        summary = self.solve("disc", "support point = 0.0, 0.0  ux = 0.0  uy = 0.0", "load set = 'rim'  pressure = 1.0",
                             "support point = 1.0, 0.0  uy = 0.0", "contact set = 'rim'  point = 0.0, -9.0",
                             mesh="kind = 'file'  file = 'disc.msh'")
        # Uniform pressure makes a uniform stress, which patches recover but for the mean of the tractions of two sides
        # at a node of the rim, shorter than the pressure by 1 - cos(4.5 degrees) = 0.3 %.
        self.assertLess(summary["accuracy"]["relative_error"], 0.003)

    def test_numbers_under_a_point_force_have_no_limit(self):
        # A continuum has neither stress nor displacement there; with the same force on a side it has both.
        named = r"no limit .* point force acts: Max\. von Mises at .*, Max\. displacement at \(2\.0, 2\.0\);"
        for element in ("quad4", "tri6"):
            for load, warns in (("force = 0.0, -0.1  point = 2.0, 2.0", True),
                                ("set = 'top'  total_force = 0.0, -0.1", False)):
                summary = self.solve("push", SUPPORT, "contact set = 'bottom'  friction = 0.5", f"load {load}",
                                     "accuracy refinements = 2", mesh=f"{COARSE}  element = '{element}'")
                found = [text for text in summary["warnings"] if re.search(named, text)]
                self.assertEqual(len(found), warns, (element, load, summary["warnings"]))
                self.run_program("--quiet", "--verify", "results")

    def test_refined_mesh_is_that_of_more_cells(self):
        one = self.solve("refined", *GROUPS, mesh=f"{COARSE}  refine = 2")
        other = self.solve("cut", *GROUPS, mesh="size = 4.0, 2.0  cells = 16, 8")
        for key, value in other["key_results"].items():
            # The nodes have other numbers, so that sums are rounded in another order.
            self.assertAlmostEqual(one["key_results"][key], value, delta=1e-7*max(1.0, abs(value)), msg=key)

    def test_refinements_compare_the_meshes(self):
        levels = [self.solve(f"block_{level}", *GROUPS, mesh=f"{COARSE}  refine = {level}") for level in range(3)]
        summary = self.solve("study", *GROUPS, "accuracy refinements = 2", mesh=COARSE)
        # Each mesh starts from the one before, and leaves another residual below the tolerance of 1e-10.
        for key, value in levels[2]["key_results"].items():
            self.assertAlmostEqual(summary["key_results"][key], value, delta=1e-8*max(1.0, abs(value)), msg=key)
        table = self.table("study")
        for key, row in table.items():
            values = [float(row[f"mesh_{i}"]) for i in (1, 2, 3)]
            for level, value in zip(levels, values):
                single = {**level["lengths"], **level["key_results"], **level["certificate"]}[key]
                self.assertAlmostEqual(value, single, delta=1e-8*max(1.0, abs(single)), msg=key)
            judged = summary["convergence"][key]
            self.assertEqual(judged["values"], values)
            self.assertEqual(judged["verdict"], row["verdict"])
            self.assertEqual(judged["error_bar"], float(row["error_bar"]) if row["error_bar"] else None)
            if row["verdict"] == "converging":
                change = values[2] - values[1]
                order = float(row["order"])
                self.assertAlmostEqual(2.0**order, (values[1] - values[0])/change, delta=1e-6*2.0**order)
                self.assertAlmostEqual(float(row["extrapolated"]), values[2] + change/(2.0**order - 1.0),
                                       delta=1e-9*max(map(abs, values)))
                bar = 1.25*max(abs(change), 0.5*abs(values[1] - values[0]))/(2.0**min(order, 1.0) - 1.0)
                # Ends between nodes are known to a fifth of a side, which measures 0.25.
                bar = max(bar, 0.05) if key.endswith("_width") else bar
                self.assertAlmostEqual(judged["error_bar"], bar, delta=1e-9*max(map(abs, values)))
        self.assertIn("max_displacement", table)
        self.assertIn("strain_energy", table)
        self.assertIn("Refined meshes (3, each of half the element size)",
                      (self.directory / "results" / "study.lst").read_text())
        self.run_program("--verify", "results")

    def test_history_is_taken_on_every_mesh(self):
        self.write("rough.nml", ROUGH)
        self.run_program("--quiet", "--output", "results", "--refine", "2", "rough.nml")
        summary = json.loads((self.directory/"results"/"rough.summary.json").read_text())
        table = self.table("rough")
        for level in range(3):
            one = ROUGH.replace("'rough'", f"'level_{level}'").replace("40, 1", f"40, 1  refine = {level}")
            self.write("one.nml", one)
            self.run_program("--quiet", "--output", "results", "one.nml")
            single = json.loads((self.directory/"results"/f"level_{level}.summary.json").read_text())
            numbers = {**single["load_history"], **single["lengths"], **single["key_results"]}
            with open(self.directory/"results"/f"level_{level}.history.csv", newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            numbers["max_slip_accumulated"] = float(rows[-1]["max_slip_accumulated"])
            for key, row in table.items():
                self.assertAlmostEqual(float(row[f"mesh_{level + 1}"]), numbers[key],
                                       delta=1e-8*max(1.0, abs(numbers[key])), msg=key)
                column = re.sub("^(least|greatest)_", "", key)
                if column != key and column in rows[0]:
                    extreme = (max if key.startswith("greatest") else min)(float(row[column]) for row in rows)
                    # Sums of the forces of forty points, in the order that a compiler chooses.
                    self.assertAlmostEqual(numbers[key], extreme, delta=1e-13*abs(extreme), msg=key)
        # A bar under given friction q of its length: u = F^2/(2 EA q), from rest and through a cycle friction takes
        # 5/4 of 2 F^3/(3 EA q). Shear across the flat strip matters by 1e-5.
        for key, exact in (("dissipation", 5/12), ("greatest_force_tangential_bottom", 10.0), ("least_ux_1", -0.025),
                           ("greatest_ux_1", 0.025), ("cycle_dissipation", 1/3)):
            self.assertAlmostEqual(float(table[key]["mesh_3"]), exact,
                                   delta=float(table[key]["error_bar"]) + 1e-5*abs(exact), msg=key)
        self.assertLess(float(table["dissipation"]["error_bar"]), 1e-3)
        self.assertEqual(summary["convergence"]["dissipation"]["verdict"], "converging")
        # The files are those of the finest mesh, and nothing of the coarser ones is left.
        for name in ("history.csv", "points.csv", "states.csv"):
            self.assertEqual((self.directory/"results"/f"rough.{name}").read_bytes(),
                             (self.directory/"results"/f"level_2.{name}").read_bytes())
        self.assertEqual([path.name for path in (self.directory/"results").glob("*mesh_*")], [])
        self.run_program("--verify", "results")
        text = (self.directory/"results"/"rough.convergence.csv").read_text()
        first = table["dissipation"]["mesh_1"]
        (self.directory/"results"/"rough.convergence.csv").write_text(text.replace(first, repr(2.0*float(first))))
        self.assertIn("rough.convergence.csv", self.run_program("--verify", "results", status=4).stderr)

    def test_history_on_meshes_goes_on_where_it_was(self):
        self.write("rough.nml", ROUGH.replace("substeps = 1", "substeps = 40"))
        begin = time.monotonic()
        self.run_program("--quiet", "--output", "whole", "--refine", "2", "rough.nml")
        duration = time.monotonic() - begin
        chance, meshes = random.Random(1976), set()
        # Until the finest mesh was interrupted, and one before it.
        while len(meshes) < 2 or "3" not in meshes:
            for path in (self.directory/"results").glob("*"):
                path.unlink()
            for begun in (chance.choice(["rough.mesh_1", "rough.mesh_2"]), "rough"):
                run = subprocess.Popen([PROGRAM, "--quiet", "--output", "results", "--refine", "2", "rough.nml"],
                                       cwd=self.directory, encoding="utf-8", stderr=subprocess.PIPE)
                while run.poll() is None and not (self.directory/"results"/f"{begun}.history.checkpoint").exists():
                    time.sleep(0.002)
                time.sleep(duration*chance.uniform(0.0, 0.1))
                run.send_signal(chance.choice([signal.SIGINT, signal.SIGKILL]))
                meshes |= set(re.findall("interrupted after step .* on mesh ([1-3]);", run.communicate()[1]))
            self.run_program("--quiet", "--output", "results", "--refine", "2", "rough.nml")
            for name in ("convergence.csv", "history.csv", "contact.csv"):
                self.assertEqual((self.directory/"results"/f"rough.{name}").read_bytes(),
                                 (self.directory/"whole"/f"rough.{name}").read_bytes(), name)
            self.assertEqual([*(self.directory/"results").glob("*mesh_*"),
                              *(self.directory/"results").glob("*.checkpoint")], [])

    def test_history_without_an_end_is_refined_no_further(self):
        # Pushed with more than friction holds: the same on all meshes, so that the first one says it.
        self.write("pushed.nml", block("load name = 'push'  set = 'left'  traction = 1.0, 0.0", PRESSURE, CONTACT,
                                       "history times = 0.0, 1.0  substeps = 4", "case name = 'pushed'",
                                       "steps load = 'push'  factor = 0.0, 9.0", "accuracy refinements = 2",
                                       mesh=COARSE))
        message = self.run_program("--output", "results", "pushed.nml", status=2).stderr
        self.assertIn("the history ends at step", message)
        summary = json.loads((self.directory/"results"/"pushed.summary.json").read_text())
        self.assertNotIn("convergence", summary)
        self.assertIn("refine = 0", (self.directory/"results"/"pushed.deck.nml").read_text())
        self.assertEqual(list((self.directory/"results").glob("*mesh_*")), [])
        self.run_program("--verify", "results", status=None)

    def test_far_sides_do_not_widen_bars(self):
        # Cells of 1/4 where the contact ends, and one eighty times as long far away.
        x = (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.5, 4.5, 24.5)
        n = len(x)
        sides = [(i + 1, i) for i in range(1, n)]
        elements = [f"{i} 1 2 1 1 {b} {a}" for i, (a, b) in enumerate(sides, 1)]
        elements += [f"{n + i} 1 2 2 2 {n + a} {n + b}" for i, (a, b) in enumerate(sides, 1)]
        elements += [f"{2*n + i} 3 2 3 3 {b} {a} {n + a} {n + b}" for i, (a, b) in enumerate(sides, 1)]
        elements.append(f"{3*n} 1 2 4 4 {n + 1} 1")
        self.write("graded.msh", "\n".join([
            "$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "4", '1 1 "bottom"', '1 2 "top"',
            '2 3 "body"', '1 4 "left"', "$EndPhysicalNames", "$Nodes", str(2*n), *(
                f"{n*j + i} {place!r} {float(j)!r} 0" for j in (0, 1) for i, place in enumerate(x, 1)), "$EndNodes",
            "$Elements", str(len(elements)), *elements, "$EndElements", ""]))
        found = self.solve("graded", "support set = 'left'  ux = 0.0", "load set = 'top'  pressure = 0.1",
                           "contact set = 'bottom'  obstacle = 'circle'  radius = 0.5", "accuracy refinements = 2",
                           mesh="kind = 'file'  file = 'graded.msh'")
        self.assertLess(found["key_results"]["contact_width"], 1.0)
        self.assertGreaterEqual(found["convergence"]["open_length"]["error_bar"], 0.25/4)
        # The longest side is 5 on the last mesh.
        self.assertLess(found["convergence"]["open_length"]["error_bar"], 1.0)

    def test_each_mesh_starts_from_the_one_before(self):
        groups = ("load set = 'top'  pressure = 0.2", "support set = 'left'  ux = 0.0",
                  "contact set = 'bottom'  obstacle = 'circle'  radius = 8.0  friction = 0.3")
        cold = self.solve("cold", *groups, mesh=COARSE + "  refine = 4")
        study = self.solve("study", *groups, "accuracy refinements = 4", mesh=COARSE)
        self.assertLess(study["iterations"], cold["iterations"])
        for key, value in cold["key_results"].items():
            self.assertAlmostEqual(study["key_results"][key], value, delta=1e-8*max(1.0, abs(value)), msg=key)

    def test_what_a_single_point_does_not_show_has_no_bar(self):
        # On all three meshes the corner on the plane of symmetry alone is in contact; finer ones show more.
        self.solve("point", "support set = 'left'  ux = 0.0", "support set = 'top'  ux = 0.0  uy = -0.001",
                   "contact set = 'bottom'  friction = 0.6  obstacle = 'circle'  radius = 5.0",
                   "accuracy refinements = 2", mesh="size = 2.0, 1.5  cells = 4, 3")
        table = self.table("point")
        for key in ("contact_centroid_x", "contact_force_x", "contact_moment"):
            self.assertEqual((table[key]["verdict"], table[key]["error_bar"]), ("absent", ""), key)
        self.assertGreater(float(table["contact_force_y"]["error_bar"]), 0.0)

    def test_truth_lies_within_the_bars(self):
        # Against a mesh four times finer than the finest of the study.
        self.solve("study", *GROUPS, "accuracy refinements = 3", mesh=COARSE)
        fine = self.solve("fine", *GROUPS, mesh=f"{COARSE}  refine = 5")
        fine = {**fine["lengths"], **fine["key_results"], **fine["certificate"]}
        for key, row in self.table("study").items():
            if row["verdict"] == "absent":
                self.assertEqual((float(row["mesh_4"]), row["error_bar"]), (0.0, ""), key)
            if row["verdict"] in ("absent", "slow"):
                continue
            self.assertLessEqual(abs(float(row["mesh_4"]) - fine[key]), 1.05*float(row["error_bar"]), key)

    def test_bodies_of_different_order_are_refined_together(self):
        self.solve("bodies", "support set = 'b.bottom'  ux = 0.0  uy = 0.0", "support set = 'a.left'  ux = 0.0",
                   "load set = 'a.top'  pressure = 1.0", "contact set = 'a.bottom'  against = 'b.top'",
                   "mesh name = 'b'  size = 2.0, 1.0  cells = 3, 2  element = 'quad4'  origin = 0.0, -1.0",
                   "accuracy refinements = 2", mesh="name = 'a'  size = 2.0, 1.0  cells = 4, 2  element = 'tri6'")
        # Nodes of 16 x 8 cells in two triangles of six nodes, and of 12 x 8 of four.
        _, n_points, n_cells = read_vtu((self.directory / "results" / "bodies.vtu").read_bytes())
        self.assertEqual((n_points, n_cells), (33*17 + 13*9, 2*16*8 + 12*8))

    def test_no_equilibrium_on_any_mesh(self):
        self.write("free.nml", block("load set = 'top'  pressure = -1.0", CONTACT, "accuracy refinements = 2"))
        self.run_program("--output", "results", "free.nml", status=2)
        summary = json.loads((self.directory / "results" / "free.summary.json").read_text())
        self.assertNotIn("convergence", summary)


if __name__ == "__main__":
    unittest.main()
