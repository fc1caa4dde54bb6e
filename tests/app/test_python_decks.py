"""Decks in Python: texts and dicts, with settings; meshes of arrays, fields as arrays, warnings and missing files."""
import os
import re
import sys
import types
import unittest
import warnings
from pathlib import Path

from harness import CONTACT, PRESSURE, SOUND, SUPPORT, ProgramTest, block

try:
    import numpy as np
except ImportError:
    print("skipped: there is no NumPy")
    sys.exit(0)

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
import amontons  # noqa: E402  pylint: disable=wrong-import-position
from amontons.grid import EDGES, FACES  # noqa: E402  pylint: disable=wrong-import-position

BLOCK = {"mesh": {"size": (4.0, 2.0), "cells": [4, 2], "element": "tri6"},
         "material": {"young": 100, "poisson": np.float64(0.2)},
         "support": [{"set": "left", "ux": 0.0}],
         "load": [{"set": "top", "pressure": 1.0}, {"set": "right", "traction": np.array([0.1, 0.0])}],
         "contact": {"set": "bottom", "friction": 0.3}}
TEXT = """! The same as a text.
&mesh size = 4.0, 2.0  cells = 4, 2  element = 'tri6' /
&material young = 100  poisson = 0.2 /
&support set = 'left'  ux = 0.0 /
&load set = 'top'  pressure = 1.0 /
&load set = 'right'  traction = 0.1, 0.0 /
&contact set = 'bottom'  friction = 0.3 /
"""


class Decks(ProgramTest):
    """Decks that are no files."""

    def same(self, one, other):
        """Checks that two results have the same tables."""
        for key, values in one.contact.items():
            np.testing.assert_array_equal(values, other.contact[key], err_msg=key)

    def test_text_dict_and_file_are_the_same_deck(self):
        expected = amontons.solve_deck(self.directory / self.write("deck.nml", TEXT))
        self.assertEqual(expected.name, "deck")
        for deck in (TEXT, BLOCK):
            result = amontons.solve_deck(deck)
            self.assertEqual((result.name, result.directory), ("deck", None))
            self.same(result, expected)
        self.assertEqual(self.files(), ["deck.nml"])

    def test_pair_is_a_column_of_words(self):
        pair = block("mesh name = 'b'  size = 4.0, 1.0  cells = 5, 2  origin = 0.0, -1.0",
                     "support set = 'b.bottom'  ux = 0.0  uy = 0.0", "load set = 'a.top'  pressure = 1.0",
                     "contact set = 'a.bottom'  against = 'b.top'  friction = 0.3",
                     mesh="name = 'a'  size = 4.0, 2.0  cells = 8, 4")
        result = amontons.solve_deck(pair)
        self.assertEqual(set(result.contact["pair"]), {"a.bottom/b.top"})
        self.assertAlmostEqual(sum(result.contact["normal_force"]), 4.0, delta=1e-9)

    def test_words_and_logicals_of_a_dict(self):
        text = amontons.deck_text({"case": {"title": "it's", "a": Path("b c")},
                                   "sweep": [{"factor": range(3)}, {"x": True}]})
        self.assertEqual(text, "&case title = 'it''s'  a = 'b c' /\n&sweep factor = 0, 1, 2 /\n&sweep x = .true. /\n")
        self.assertEqual(amontons.read_deck(text), [("case", {"title": "it's", "a": "b c"}),
                                                    ("sweep", {"factor": [0, 1, 2]}), ("sweep", {"x": ".true."})])
        # any double comes back to the last bit
        value = 0.1 + 0.2
        self.assertEqual(amontons.read_deck(amontons.deck_text({"g": {"k": value}})), [("g", {"k": value})])

    def test_an_effective_deck_is_read_and_solved_again(self):
        expected = amontons.solve_deck(TEXT, self.directory / "out")
        text = (self.directory / "out" / "deck.deck.nml").read_text(encoding="utf-8")
        groups = {}
        for name, keys in amontons.read_deck(text):
            groups.setdefault(name, []).append(keys)
        self.same(amontons.solve_deck(groups), expected)

    def test_settings_take_the_place_of_what_a_deck_says(self):
        name = self.directory / self.write("deck.nml", TEXT)
        expected = amontons.solve_deck(TEXT.replace("0.3", "0.5").replace("0.1, 0.0", "0.2, 0.1"))
        for deck in (TEXT, BLOCK, name, str(name)):
            result = amontons.solve_deck(deck, contact__friction=0.5, load__2__traction=(0.2, 0.1), case__name="other",
                                         case__title="10 % more, it's")
            self.same(result, expected)
            self.assertEqual((result.name, result.summary["title"]), ("other", "10 % more, it's"))
        self.same(amontons.solve_deck(TEXT, **{"contact.friction": 0.5, "load(2).traction": [0.2, 0.1]}), expected)

    def test_a_total_force_acts_in_all_studies_as_its_traction(self):
        studies = ((), ("sweep load = 'p'  factor = 0.5, 1.0  count = 3",),
                   ("history times = 0.0, 1.0  substeps = 3", "steps load = 'p'  factor = 0.0, 1.0"))
        for study in studies:
            # On a length of 4.
            one, other = (amontons.solve_deck(block(SUPPORT, f"load name = 'p'  set = 'top'  {force}", CONTACT, *study))
                          for force in ("traction = 0.1, -1.0", "total_force = 0.4, -4.0"))
            for name in ("contact", "sweep", "history"):
                for key, column in (getattr(one, name) or {}).items():
                    if column.dtype.kind == "f" and key != "residual":
                        np.testing.assert_allclose(getattr(other, name)[key], column, rtol=1e-9, atol=1e-11,
                                                   err_msg=key)

    def test_keys_without_a_value_are_left_out(self):
        self.assertEqual(amontons.deck_text({"support": {"set": "left", "ux": 0.0, "uy": None}}),
                         "&support set = 'left'  ux = 0.0 /\n")

    def test_faults_of_texts_and_settings_are_sentences(self):
        for deck, settings, sentence in (
                (TEXT.replace("friction", "frction"), {}, "^deck:7: unknown key 'frction' in &contact"),
                (TEXT, {"contact__frction": 1}, "unknown key 'frction' in &contact"),
                (TEXT, {"friction": 1}, "unknown setting 'friction'; settings are called GROUP__KEY"),
                (TEXT, {"load__traction": (1, 0)}, r"the deck has 2 &load; write load\(1\).traction for the first"),
                (TEXT + "\0", {}, "a character of code 0")):
            with self.subTest(sentence), self.assertRaisesRegex(amontons.InputRefused, sentence):
                amontons.solve_deck(deck, **settings)

    def test_groups_of_other_kinds_are_refused(self):
        for group in (1, None, "quad4", "", 1.5, ["size"], [("size", (1.0, 1.0))]):
            with self.subTest(group=group), \
                    self.assertRaisesRegex(amontons.InputRefused, "^deck: &mesh: expected a dict of keys or a list of"):
                amontons.solve_deck({"mesh": group})

    def test_files_of_a_text_are_seen_from_the_current_directory(self):
        text = block(SUPPORT, PRESSURE, "contact set = 'bottom'  obstacle = 'polyline'  line = 'no such line.csv'")
        with self.assertRaisesRegex(FileNotFoundError, "^deck:5: line: no such line.csv: cannot read this file: "):
            amontons.solve_deck(text)
        here = os.path.relpath(self.directory / self.write("line.csv", "-1 0\n9 0\n"))
        self.assertTrue(amontons.solve_deck(text, contact__line=here).is_solved)

    def test_missing_files_are_missing_files(self):
        for settings in ({}, {"contact__friction": 0.1}):
            with self.assertRaisesRegex(amontons.FileMissing, "nowhere.nml: cannot read this file") as caught:
                amontons.solve_deck(self.directory / "nowhere.nml", **settings)
            self.assertIsInstance(caught.exception, FileNotFoundError)
            self.assertIsInstance(caught.exception, amontons.InputRefused)
            with self.assertRaises(amontons.InputRefused) as caught:
                amontons.solve_deck(self.directory, **settings)
            self.assertNotIsInstance(caught.exception, FileNotFoundError)

    def test_warnings_are_warnings(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = amontons.solve_deck(SOUND, contact__friction=2.5)
        self.assertTrue(result.is_solved)
        self.assertEqual([str(warning.message) for warning in caught], result.summary["warnings"])
        self.assertIn("friction of 2.5", str(caught[0].message))
        self.assertEqual({(warning.category, warning.filename) for warning in caught},
                         {(amontons.DoubtfulResult, __file__)})

    def test_a_warning_with_other_numbers_is_printed_once_for_a_place(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("default")
            for friction in (2.5, 2.6, 2.7):
                amontons.solve_deck(SOUND, contact__friction=friction)
            amontons.solve_deck(SOUND, contact__friction=2.8)
        found = [str(warning.message) for warning in caught if "friction of" in str(warning.message)]
        self.assertEqual(len(found), 2, found)
        self.assertIn("friction of 2.5", found[0])
        self.assertIn("friction of 2.8", found[1])

    def test_twisted_bodies_have_displacements_around_the_axis(self):
        shaft = {"mesh": {"size": (1.0, 4.0), "cells": (2, 8)},
                 "material": {"young": 100.0, "poisson": 0.25, "hypothesis": "axisymmetric", "twist": True},
                 "support": [{"set": "bottom", "uy": 0.0, "turn": 0.0}, {"set": "left", "ux": 0.0},
                             {"set": "top", "turn": 0.01}]}
        for output in (None, self.directory / "out"):
            result = amontons.solve_deck(shaft, output)
            # A shaft twists in proportion to its length, its nodes by their radius.
            np.testing.assert_allclose(result.displacement[:, 2], 0.01*result.nodes.prod(axis=1)/4.0, atol=1e-15)

    def test_fields_are_arrays(self):
        for output in (None, self.directory / "out"):
            result = amontons.solve_deck(TEXT, output)
            (kind, cells), = result.cells
            n, m = len(result.nodes), len(cells)
            self.assertEqual((kind, cells.shape[1], n, m), ("triangle6", 6, 45, 16))
            self.assertEqual([values.shape for values in (result.displacement, result.stress, result.nodal_stress)],
                             [(n, 2), (m, 6), (n, 6)])
            # On the floor gap and slip are the displacements; at the top the pressure is on the body.
            at = np.array([np.argmin(np.hypot(*(result.nodes - [x, 0.0]).T)) for x in result.contact["x"]])
            np.testing.assert_allclose(result.displacement[at, 0], result.contact["slip"], atol=1e-15)
            np.testing.assert_allclose(result.displacement[at, 1], result.contact["gap"], atol=1e-15)
            areas = np.abs(np.cross(*(result.nodes[cells[:, i]] - result.nodes[cells[:, 0]] for i in (1, 2))))/2
            # Without body forces the mean stress yy of a block is the load over its width: the forces on its ends act
            # along x.
            self.assertAlmostEqual((areas*result.stress[:, 1]).sum()/8.0, -1.0, delta=1e-9)

    def test_a_history_is_a_table_of_steps(self):
        text = TEXT.replace("&load set = 'right' ", "&load name = 'push'  set = 'right' ")
        text += "&history times = 0.0, 1.0 /\n&steps load = 'push'  factor = 0.0, 1.0 /\n"
        result = amontons.solve_deck(text)
        self.assertEqual(result.history["time"][-1], 1.0)
        self.assertEqual(result.history["factor_push"][-1], 1.0)
        # the forces of the last step are those of the contact table
        self.assertAlmostEqual(result.history["normal_force"][-1], result.contact["normal_force"].sum(), delta=1e-9)

    def test_a_history_that_ends_early_has_what_it_reached(self):
        text = block(PRESSURE, CONTACT, "load name = 'push'  set = 'left'  traction = 1.0, 0.0",
                     "history times = 0.0, 1.0", "steps load = 'push'  factor = 0.0, 1.0")
        for deck, factors in ((text, [0.0, 0.6]), (text.replace("0.0, 1.0 /\n", "1.0, 1.0 /\n").replace(
                "times = 1.0", "times = 0.0"), None)):
            with self.assertRaisesRegex(amontons.NoEquilibrium, r"step \d+ \(to .*\): no equilibrium") as caught:
                amontons.solve_deck(deck)
            result = caught.exception.result
            if factors is None:
                self.assertIsNone(result)
                continue
            self.assertFalse(result.is_solved)
            # The shortest step is 1/1024.
            self.assertAlmostEqual(result.history["factor_push"][-1], factors[-1], delta=1.0/1024.0)
            self.assertEqual(result.contact["status"].size, 9)

    def test_results_are_drawn(self):
        try:
            import matplotlib  # pylint: disable=import-outside-toplevel
        except ImportError:
            self.skipTest("matplotlib is not installed")
        matplotlib.use("Agg")
        figure = amontons.figure(amontons.solve_deck(TEXT), ["body", "stress"], "nodal_von_mises")
        self.assertEqual([len(part.axes) for part in figure.subfigs], [1, 1])


class Meshes(ProgramTest):
    """Meshes of arrays."""

    CONTACT = "&material young = 100  poisson = 0.2 /\n&support set = 'left'  ux = 0.0 /\n" \
        "&load set = 'top'  pressure = 1.0 /\n&contact set = 'bottom'  friction = 0.3 /\n"

    @staticmethod
    def rectangle(quadratic=False):
        """The mesh of a rectangle of 4 x 2 with 4 x 2 cells, its nodes in another order than the program's."""
        grid = amontons.solve_deck(TEXT, mesh__element="quad8" if quadratic else "quad4", load__2__traction=(0, 0))
        (kind, cells), = grid.cells
        order = np.random.default_rng(1).permutation(len(grid.nodes))
        nodes, place = grid.nodes[order], np.argsort(order)
        cells = place[cells]
        loops = np.concatenate([cells[:, [i, (i + 1) % 4, *([4 + i]*quadratic)]] for i in range(4)])
        sides = {name: loops[(np.abs(nodes[loops][:, :, axis] - value) < 1e-12).all(axis=1)]
                 for name, axis, value in (("left", 0, 0.0), ("bottom", 1, 0.0), ("top", 1, 2.0))}
        return grid, amontons.Mesh(nodes, [(kind, cells)], sides)

    def test_a_mesh_of_arrays_is_the_mesh(self):
        for quadratic in (False, True):
            expected, mesh = self.rectangle(quadratic)
            result = amontons.solve_deck(self.CONTACT, mesh=mesh)
            np.testing.assert_array_equal(result.nodes, mesh.nodes)
            self.assertEqual(len(mesh.sides["bottom"]), 4)
            # another numbering, another order of sums
            np.testing.assert_allclose(result.contact["contact_pressure"], expected.contact["contact_pressure"],
                                       rtol=1e-9)
            np.testing.assert_array_equal(result.contact["x"], expected.contact["x"])

    def test_kept_results_can_be_verified(self):
        _, mesh = self.rectangle()
        amontons.solve_deck({"case": {"name": "part"}}, self.directory / "out", mesh=mesh,
                            **{"material.young": 100, "material.poisson": 0.2, "support.set": "left", "support.ux": 0,
                               "support.uy": 0})
        self.assertEqual(len(list((self.directory / "out").glob("mesh_*.msh"))), 1)
        self.run_program("--verify", "out")

    def test_regions_and_points(self):
        nodes = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [3, 0]]
        mesh = amontons.Mesh(nodes, [("quad", [[0, 1, 4, 3]]), ("triangle", [[1, 2, 5], [1, 5, 4], [2, 6, 5]])],
                             points={"ends": [0, 3]}, regions={"stiff": [1, 2]})
        deck = {
            "material": [{"young": 1.0, "poisson": 0.0}, {"young": 1e3, "poisson": 0.0, "region": "stiff"}],
            "support": [{"point": node, "ux": 0.0, "uy": 0.0} for node in nodes[:4:3]],
            "load": [{"set": "ends", "force": (1.0, 0.0)}, {"point": nodes[6], "force": (0.0, 1e-6)}]}
        result = amontons.solve_deck(deck, mesh=mesh)
        self.assertEqual(result.mesh.cell_data["material"].tolist(), [1, 2, 2, 1])

    def test_regions_may_overlap(self):
        nodes = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]
        mesh = amontons.Mesh(nodes, [("quad", [[0, 1, 4, 3], [1, 2, 5, 4]])], {"floor": [[0, 1]]},
                             regions={"all": [0, 1], "right": [1]})
        deck = {"material": {"young": 1e3, "poisson": 0.0, "region": "all"},
                "support": {"set": "floor", "ux": 0.0, "uy": 0.0},
                "load": {"region": "right", "body_force": (0.0, -1.0)}}
        result = amontons.solve_deck(deck, mesh=mesh)
        # the weight of one square
        self.assertAlmostEqual(result.key_results["reaction_y_floor"], 1.0, delta=1e-12)

    def meshio_block(self, quadratic, kind=lambda **parts: types.SimpleNamespace(**parts)):
        """The block of `rectangle` as meshio has it, read of a file of Gmsh and of one of Abaqus."""
        expected, mesh = self.rectangle(quadratic)
        nodes = np.column_stack([mesh.nodes, np.full(len(mesh.nodes), 7.0)])
        line = "line3" if quadratic else "line"
        blocks = [*((line, sides) for sides in mesh.sides.values()), *mesh.cells]
        physical = [np.full(len(members), number) for number, (_, members) in enumerate(blocks, 1)]
        gmsh = kind(points=nodes, cells=blocks, cell_data={"gmsh:physical": physical},
                    field_data={name: np.array([number, 1]) for number, name in enumerate(mesh.sides, 1)})
        abaqus = kind(points=nodes, cells=mesh.cells, point_sets={name: np.unique(sides)
                                                                 for name, sides in mesh.sides.items()},
                      cell_sets={"part": [np.arange(len(mesh.cells[0][1]))]})
        return expected, gmsh, abaqus

    def test_meshes_of_meshio(self):
        kinds = [lambda **parts: types.SimpleNamespace(**parts)]
        try:
            import meshio  # pylint: disable=import-outside-toplevel
            kinds.append(lambda **parts: meshio.Mesh(**parts))
        except ImportError:
            pass
        for quadratic in (False, True):
            for kind in kinds:
                expected, *meshes = self.meshio_block(quadratic, kind)
                for mesh in map(amontons.Mesh.from_meshio, meshes):
                    result = amontons.solve_deck(self.CONTACT, mesh=mesh)
                    # another numbering, another order of sums
                    np.testing.assert_allclose(result.contact["contact_pressure"],
                                               expected.contact["contact_pressure"], rtol=1e-9)
                self.assertEqual(list(mesh.regions), ["part"])

    SOLID = {"material": {"young": 100.0, "poisson": 0.2}, "support": {"set": "left", "ux": 0.0},
             "load": [{"set": "top", "traction": (0.05, 0.1, -1.0)}, {"set": "right", "pressure": 0.1}],
             "contact": {"set": "bottom", "friction": 0.3}}

    def box(self, element):
        """A result on the block of 3 x 2 x 1 of the program, and its mesh with nodes in another order."""
        expected = amontons.solve_deck({**self.SOLID, "mesh": {
            "kind": "box", "size": (3.0, 2.0, 1.0), "cells": (3, 2, 2), "element": element}})
        (kind, cells), = expected.cells
        order = np.random.default_rng(1).permutation(len(expected.nodes))
        nodes, place = expected.nodes[order], np.argsort(order)
        return expected, nodes, kind, place[cells]

    @staticmethod
    def faces(kind, nodes, cells, axis, value):
        """The faces of cells in a plane, with their middle nodes."""
        shape = kind.rstrip("0123456789")
        found = []
        for corners in FACES[shape]:
            around = list(zip(corners, corners[1:] + corners[:1]))
            n_corners = 4 if shape == "tetra" else 8
            middles = [n_corners + EDGES[kind].index((min(edge), max(edge))) for edge in around] \
                if kind in EDGES else []
            found.append(cells[:, corners + middles])
        found = np.concatenate(found)
        return found[(np.abs(nodes[found][:, :, axis] - value) < 1e-12).all(axis=1)]

    def test_meshes_of_solids(self):
        for element in ("hex8", "hex20", "tet4", "tet10"):
            expected, nodes, kind, cells = self.box(element)
            planes = (("left", 0, 0.0), ("right", 0, 3.0), ("top", 2, 1.0), ("bottom", 2, 0.0))
            sides = {name: self.faces(kind, nodes, cells, axis, value) for name, axis, value in planes}
            between = {name: np.flatnonzero(np.abs(nodes[:, axis] - value) < 1e-12) for name, axis, value in planes}
            flat = "quad" if sides["top"].shape[1] in (4, 8) else "triangle"
            flat += {6: "6", 8: "8"}.get(sides["top"].shape[1], "")
            blocks = [*((flat, faces) for faces in sides.values()), (kind, cells)]
            gmsh = types.SimpleNamespace(
                points=nodes, cells=blocks, cell_data={"gmsh:physical": [
                    np.full(len(members), number) for number, (_, members) in enumerate(blocks, 1)]},
                field_data={name: np.array([number, 2]) for number, name in enumerate(sides, 1)})
            points = types.SimpleNamespace(points=nodes, cells=[(kind, cells)], point_sets=between)
            # Sides in several arrays, and named by their corners alone.
            n_corners = 4 if flat.startswith("quad") else 3
            halves = {name: [faces[:2], faces[2:, :n_corners]] for name, faces in sides.items()}
            for mesh in (amontons.Mesh(nodes, [(kind, cells)], sides), amontons.Mesh(nodes, [(kind, cells)], halves),
                         *map(amontons.Mesh.from_meshio, (gmsh, points))):
                result = amontons.solve_deck(self.SOLID, mesh=mesh)
                np.testing.assert_array_equal(result.nodes, nodes)
                # another numbering, another order of sums
                np.testing.assert_allclose(result.key_results["max_contact_pressure"],
                                           expected.key_results["max_contact_pressure"], rtol=1e-9)
                np.testing.assert_allclose(
                    result.displacement[np.lexsort(result.nodes.T)],
                    expected.displacement[np.lexsort(expected.nodes.T)], atol=1e-9*np.abs(expected.displacement).max())
        self.assertEqual(result.displacement.shape, (len(nodes), 3))
        self.assertEqual(result.stress.shape, (len(cells), 6))
        # The sum of all forces of the obstacle: weights of top and right against it, along y alone.
        for axis, force in (("y", -0.1*6.0), ("z", 6.0)):
            self.assertAlmostEqual(result.contact[f"force_{axis}"].sum(), force, delta=1e-9)
        self.assertEqual(set(result.summary["areas"]), {"open_area", "slip_area", "stick_area"})
        self.assertAlmostEqual(result.contact["area"].sum(), 6.0, delta=1e-12)
        self.assertEqual(result.line.point_data["slip_vector"].shape[1], 3)
        self.assertIn(result.contact["status"][0], ("open", "stick", "slip"))

    def test_sides_of_two_kinds_of_cells(self):
        # A hexahedron, and beside it two tetrahedra whose part of the bottom is of triangles.
        nodes = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)], dtype=float)
        first = np.array([[0, 1, 4, 3, 6, 7, 10, 9]])
        hexahedra = types.SimpleNamespace(points=nodes, cells=[("hexahedron", first)],
                                          point_sets={"bottom": np.arange(6)})
        mesh = amontons.Mesh.from_meshio(hexahedra)
        self.assertEqual([sorted(part.ravel()) for part in mesh.sides["bottom"]], [[0, 1, 3, 4]])
        tetrahedra = types.SimpleNamespace(points=nodes, cells=[("hexahedron", first), ("tetra", np.array(
            [[1, 2, 5, 8], [1, 5, 4, 8]]))], point_sets={"bottom": np.arange(6)})
        mesh = amontons.Mesh.from_meshio(tetrahedra)
        self.assertEqual([part.shape for part in mesh.sides["bottom"]], [(1, 4), (2, 3)])
        self.assertIn(f"$Elements\n{6 + 3 + 3}\n", mesh.text())  # nodes of the set, its sides, and cells

    def test_stepper_of_a_mesh_of_arrays(self):
        expected, mesh = self.rectangle()
        deck = self.CONTACT.replace("&load", "&load name = 'top' ") \
            + "&history times = 0.0, 1.0 /\n&steps load = 'top'  factor = 0.0, 1.0 /\n"
        stepper = amontons.Stepper(deck, mesh=mesh)
        state = stepper.step(stepper.rest(), 1.0, factor_top=1.0)
        # another numbering, another order of sums
        np.testing.assert_allclose(state.normal_force, expected.contact["normal_force"], rtol=1e-9)

    def test_faults_of_meshes_of_meshio(self):
        nodes, cells = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0, 1, 2]])
        for arguments, sentence in (((nodes + [0, 0, 1]*cells.T, [("triangle", cells)]), "3-D mesh: expected points"),
                                    ((nodes, [("wedge", cells)]), "cells 'wedge': expected one of 'vertex', 'line', ")):
            mesh = types.SimpleNamespace(points=arguments[0], cells=arguments[1])
            with self.subTest(sentence), self.assertRaisesRegex(ValueError, sentence):
                amontons.Mesh.from_meshio(mesh)

    def test_faults_of_meshes(self):
        nodes, cells = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [("triangle", [[0, 1, 2]])]
        for arguments, sentence in (
                (([[0.0], [1.0]], cells), r"expected nodes of n x 2 numbers, found \(2, 1\)"),
                ((nodes, [("triangle", [[0, 1, 3]])]), "'triangle': expected numbers from 0 to 2, found 0 to 3"),
                ((nodes, [("tri", [[0, 1, 2]])]), "cells 'tri' of 3 nodes: expected one of 'triangle' of 3, "),
                ((nodes, [("triangle", [[0.0, 1.0, 2.0]])]), "'triangle': expected whole numbers, found float64"),
                ((nodes, cells, {"left": [[0, 1, 2, 0]]}), "sides 'left': expected 2 or 3 nodes a side, found 4"),
                ((np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])], {"left": [[0, 1]]}),
                 "sides 'left': expected 3, 4, 6 or 8 nodes a side, found 2"),
                ((nodes, [("tetra", [[0, 1, 2, 0]])]), r"expected nodes of n x 3 numbers, found \(3, 2\)"),
                ((np.eye(4, 3), [("tetra", [[0, 1, 2, 3]]), *cells]), "cells 'triangle': expected solids alone"),
                ((nodes, cells, {'a"b': [[0, 1]]}), "a name with a quote or a line end"),
                ((nodes, cells, {}, {}, {"core": [1]}), "region 'core': expected numbers from 0 to 0, found 1 to 1")):
            with self.subTest(sentence), self.assertRaisesRegex(ValueError, sentence):
                amontons.Mesh(*arguments).text()
        with self.assertRaisesRegex(amontons.SystemFailure, "cannot write the mesh there"):
            amontons.solve_deck({}, self.directory / self.write("file", "") / "out", mesh=amontons.Mesh(nodes, cells))

    def test_example_of_wear_ends_in_the_pressure_on_the_block(self):
        printed = self.run_command(["env", f"PYTHONPATH={ROOT / 'python'}", sys.executable, "-B",
                                    str(ROOT / "doc" / "examples" / "wear.py"), "wear"]).stdout
        new, = map(float, re.findall(r"touch, peak pressure (\S+)", printed))
        peak, area, archard = map(float, re.search(r"after \d+ passes: peak pressure (\S+), worn area (\S+), "
                                                   r"Archard's (\S+)\n", printed).groups())
        self.assertGreater(new, 1.3)
        # What is left of the crown wears away like an exponential; Archard's area is a balance of forces.
        self.assertAlmostEqual(peak, 1.0, delta=0.05)
        self.assertAlmostEqual(area, archard, delta=1e-5)


if __name__ == "__main__":
    unittest.main()
