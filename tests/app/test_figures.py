"""What figures of cases show: obstacles, magnified gaps, uniform fields, units; and the options of the command."""
import base64
import re
import struct
import sys
import unittest
import zlib
from pathlib import Path

from harness import CONTACT, PRESSURE, SUPPORT, ProgramTest, block, words_of

try:
    import matplotlib
    import numpy as np
    from matplotlib.colors import ListedColormap
except ImportError:
    print("skipped: Matplotlib and NumPy are not installed")
    sys.exit(0)

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
# pylint: disable=wrong-import-position
from amontons.cases import Case  # noqa: E402
from amontons.draw_body import initial_gaps, magnification, magnification_at, surfaces  # noqa: E402
from amontons.draw_solid import (Chart, contact_sets, map_image, maps_of, obstacles, pale, part_of,  # noqa: E402
                                 pieces)
from amontons.draw_steps import draw_zones  # noqa: E402
from amontons.faces import View, boundary_faces  # noqa: E402
from amontons.grid import Grid, read_grid  # noqa: E402
from amontons.numerals import scientific  # noqa: E402
from amontons.obstacles import Surface, hatching, surface  # noqa: E402
from amontons.raster import cell_image, color_numbers, nearest, png_text, weights_of  # noqa: E402
from amontons.report import cell_text  # noqa: E402
from amontons.svg_axes import SvgAxes  # noqa: E402
# pylint: enable=wrong-import-position

matplotlib.use("Agg")
WINDOW = np.array([[-1.0, -2.0], [5.0, 3.0]])
PUNCH = ("support set = 'top'  ux = 0.0  uy = -0.01",
         "contact set = 'bottom'  friction = 0.2  obstacle = 'circle'  radius = 3.0  point = 2.0, 0.0")


def text_of(svg):
    """The words of a picture: they are text, not outlines of letters."""
    return re.findall(r"<text[^>]*>([^<]*)</text>", svg.read_text(encoding="utf-8"))


class Numerals(ProgramTest):
    """Numbers in texts of pictures and reports, beside the program's own."""

    def test_moduli_in_a_report_have_an_exponent_from_a_million_on(self):
        values = (0.0, 0.0123456, 1.0e-8, 205000.0, 7251687.0, 2.1e11, 9999999999.0)
        self.assertEqual([cell_text(value) for value in values],
                         ["0", "0.012346", "1.0e-8", "205000", "7.2517e6", "2.1e11", "1e10"])

    def test_they_have_the_form_of_the_listing(self):
        for value, text in ((0.704, "0.704"), (1730.2, "1730.0"), (1e-8, "1.0e-8"), (2.0549e-11, "2.05e-11"),
                            (0.0, "0.0"), (-3.0e-5, "-3.0e-5"), (1e17, "1.0e17")):
            self.assertEqual(scientific(value), text)
        self.solve(block(SUPPORT, PRESSURE, CONTACT))
        listing = (self.directory / "case.lst").read_text(encoding="utf-8")
        certificate = Case(self.directory / "case").summary["certificate"]
        for label, name in (("Equilibrium", "equilibrium"), ("Energy balance", "energy")):
            self.assertEqual(re.search(rf"^  {label} +(\S+)", listing, re.MULTILINE)[1], scientific(certificate[name]))


class Obstacles(ProgramTest):
    """The lines that obstacles are drawn as."""

    def test_every_kind_is_drawn_and_no_other(self):
        file = self.directory / "line.csv"
        file.write_text("s,h\n-1,0\n1,0\n", encoding="utf-8")
        placed = {"point": [0.0, 0.0], "normal": [0.0, 1.0], "radius": 2.0, "line": str(file)}
        of_solids = {"sphere", "cylinder", "paraboloid", "surface"}
        for kind in {*words_of("contact", "obstacle")} - of_solids:
            self.assertGreater(len(surface({**placed, "obstacle": kind}, WINDOW)), 1, kind)
        with self.assertRaisesRegex(ValueError, "obstacle 'cusp' cannot be drawn"):
            surface({**placed, "obstacle": "cusp"}, WINDOW)

    @staticmethod
    def local(contact):
        """The points of an obstacle in its frame, s and h."""
        normal = np.array(contact["normal"]) / np.hypot(*contact["normal"])
        line = surface(contact, WINDOW) - contact["point"]
        return line @ [normal[1], -normal[0]], line @ normal

    def test_points_are_on_the_surface(self):
        placed = {"point": [1.0, -0.5], "normal": [-1.0, 2.0]}
        s, h = self.local({**placed, "obstacle": "plane"})
        np.testing.assert_allclose(h, 0.0, atol=1e-14)  # rounding
        for radius in (2.0, -2.0, 1e5):
            s, h = self.local({**placed, "obstacle": "parabola", "radius": radius})
            np.testing.assert_allclose(h, -s**2 / (2 * radius), atol=1e-13)
            s, h = self.local({**placed, "obstacle": "circle", "radius": radius})
            # on the circle through the point, to the rounding of its radius
            np.testing.assert_allclose(np.hypot(s, h + radius), abs(radius), rtol=1e-14)
            self.assertTrue((np.diff(s)[len(s)//2 - 9:len(s)//2 + 9] > 0).all())

    def test_curved_lines_are_smooth_in_the_window(self):
        for radius in (0.1, 10.0, 1e5):
            line = surface({"obstacle": "circle", "radius": radius, "point": [0.0, 0.0], "normal": [0.0, 1.0]}, WINDOW)
            self.assertLess(np.hypot(*np.diff(line, axis=0).T).max(), 0.05)

    def test_a_polyline_is_read_as_the_program_reads_it(self):
        with self.subTest("comments, a heading, any separator"):
            file = Path(self.id())
            file.write_text("# a comment\ns, h\n0.0 0.0\n1.0;2d-1\n\n2.0\t0.5, 7\n", encoding="utf-8")
            self.addCleanup(file.unlink)
            contact = {"obstacle": "polyline", "line": str(file), "point": [1.0, 1.0], "normal": [0.0, -1.0]}
            # s counts along (n_y, -n_x) = (-1, 0), h along (0, -1)
            np.testing.assert_allclose(surface(contact, WINDOW), [[1.0, 1.0], [0.0, 0.8], [-1.0, 0.5]], atol=1e-15)

    def test_hatching_is_on_the_solid_side(self):
        for kind, radius in (("plane", None), ("circle", 2.0), ("circle", -2.0), ("parabola", 1.0)):
            contact = {"obstacle": kind, "radius": radius, "point": [2.0, 0.0], "normal": [0.0, 1.0]}
            strokes = hatching(surface(contact, WINDOW), WINDOW, 0.1)
            self.assertGreater(len(strokes), 20)
            s, h = (strokes[:, 1] - contact["point"]).T
            depth = -h if kind == "plane" else np.where(np.sign(radius) > 0, -h - (s**2 + (kind == "circle")*h**2) / (
                2*radius), np.hypot(s, h + radius) - abs(radius))
            self.assertGreater(depth.min(), 0.0, (kind, radius))


class Images(unittest.TestCase):
    """The images of fields in reports."""

    def test_a_pixel_has_the_color_of_the_cell_that_its_middle_is_in(self):
        # A square of 7 by 7 pixels, a rotated one that it is cut out of, in four triangles without seams between them.
        window, size = np.array([[-1.0, -1.0], [1.0, 1.0]]), (7, 7)
        corners = np.array([[0.9, 0.3], [-0.3, 0.9], [-0.9, -0.3], [0.3, -0.9]])
        triangles = np.stack([corners, np.roll(corners, -1, axis=0), np.zeros((4, 2))], axis=1)
        image = cell_image([(triangles, np.array([1, 2, 3, 4]))], window, size)
        x, y = np.meshgrid((np.arange(7) + 0.5)*2/7 - 1, 1 - (np.arange(7) + 0.5)*2/7)
        for row, column in np.ndindex(*image.shape):
            at = np.array([x[row, column], y[row, column]])
            inside = [i + 1 for i, (a, b, c) in enumerate(triangles) if all(
                np.cross(q - p, at - p) >= 0.0 for p, q in ((a, b), (b, c), (c, a)))]
            # A middle on the side between two cells belongs to one of them.
            self.assertIn(image[row, column], inside or [0], (row, column))

    def test_cells_outside_of_the_window_are_cut_off(self):
        square = np.array([[[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]])
        image = cell_image([(square, np.array([5])), (square + 30.0, np.array([6]))], WINDOW, (12, 10))
        self.assertEqual((image.shape, np.unique(image).tolist()), ((10, 12), [5]))

    def test_what_is_in_front_is_seen_with_the_weights_of_its_corners(self):
        # Two planes that cut each other at x = 0.5, as two triangles each; depths of the third corner, too.
        square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
        depths = (square[:, 0], 1.0 - square[:, 0])
        triangles = np.array([[[*square[i], depth[i]] for i in corners] for depth in depths
                              for corners in ([0, 1, 2], [0, 2, 3])])
        window = np.array([[-1.0, 0.0], [1.0, 1.0]])
        number, depth = nearest(triangles, window, (40, 10))
        weights = weights_of(triangles, number, window)
        x, y = np.meshgrid((np.arange(40) + 0.5)/20 - 1.0, 1.0 - (np.arange(10) + 0.5)/10)
        self.assertTrue((number[x < 0.0] == -1).all())
        inside = x > 0.0
        np.testing.assert_array_equal(number[inside] < 2, x[inside] > 0.5)
        np.testing.assert_allclose(depth[inside], np.maximum(x, 1.0 - x)[inside], atol=1e-14)  # rounding
        at = (triangles[number] * weights[..., None]).sum(axis=-2)
        np.testing.assert_allclose(at[inside], np.stack([x, y, depth], axis=-1)[inside], atol=1e-14)

    def test_an_image_of_colors_is_a_png_of_colors(self):
        image = np.random.default_rng(1).random((4, 3, 4))
        image[0, 0], image[1, 1] = 1.0, 0.0
        data = base64.b64decode(png_text(image).removeprefix("data:image/png;base64,"))
        self.assertEqual(struct.unpack(">IIBB", data[16:26]), (3, 4, 8, 6))
        start = data.index(b"IDAT")
        size, = struct.unpack(">I", data[start - 4:start])
        lines = np.frombuffer(zlib.decompress(data[start + 4:start + 4 + size]), np.uint8).reshape(4, 13)
        self.assertTrue((lines[:, 0] == 1).all())  # each byte less that of the pixel on the left
        read = np.cumsum(lines[:, 1:].reshape(4, 3, 4), axis=1, dtype=np.uint8)
        # Half a step of a 64th, and of 255.
        np.testing.assert_allclose(read/255, image, atol=0.5/63 + 0.5/255)
        self.assertEqual((read[0, 0].tolist(), read[1, 1].tolist()), ([255]*4, [0]*4))

    def test_a_pixel_of_a_map_has_the_color_of_its_cell(self):
        axes, x, y = SvgAxes(10.0, 20.0, 106.0, 68.0), np.array([0.0, 1.0, 4.0]), np.array([0.0, 2.0, 3.0])
        colors = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [9, 9, 9]])
        axes.pcolormesh(x, y, np.array([[0.0, 1.0], [np.nan, 3.0]]), cmap=ListedColormap(colors/255), vmin=-0.5,
                        vmax=3.5)
        data = base64.b64decode(re.search(r'base64,([^"]*)"', axes.image_of_cells("name")[0])[1])
        self.assertEqual(struct.unpack(">II", data[16:24]), (200, 100))
        start = data.index(b"IDAT")
        size, = struct.unpack(">I", data[start - 4:start])
        rows = np.frombuffer(zlib.decompress(data[start + 4:start + 4 + size]), np.uint8).reshape(100, 201)[:, 1:]
        # The upper row is a third of the height, the left column a fourth of the width; 0 is transparent.
        self.assertEqual([np.unique(part).tolist() for part in (
            rows[:33, :50], rows[:33, 50:], rows[34:, :50], rows[34:, 50:])], [[0], [4], [1], [2]])
        table = data.index(b"PLTE") + 4
        self.assertEqual(list(data[table:table + 15]), [0, 0, 0, *colors.ravel()])

    def test_powers_of_ten_are_where_a_logarithmic_ordinate_has_them(self):
        axes = SvgAxes(0.0, 0.0, 100.0, 100.0)
        axes.set_yscale("log")
        axes.plot([1, 2, 3], [2.0, 3e-3, 5e-4], color="black")
        self.assertEqual(axes.ylim, (-4.0, 1.0))
        self.assertAlmostEqual(axes.y(1e-4), 100.0)
        self.assertAlmostEqual(axes.y(1.0), 20.0)
        texts = re.findall(r'y="([\d.]+)"[^>]*>10([⁻⁰¹²³⁴]+)<', axes.frame())
        self.assertEqual(texts, [("103", "⁻⁴"), ("83", "⁻³"), ("63", "⁻²"), ("43", "⁻¹"), ("23", "⁰"), ("3", "¹")])

    def test_colors_are_between_the_limits(self):
        self.assertEqual(color_numbers(np.array([-1.0, 0.0, 0.5, 1.0, 2.0]), 0.0, 1.0).tolist(), [1, 1, 128, 255, 255])


class Figures(ProgramTest):
    """Figures of solved cases."""

    def solve(self, *groups, **options):
        """Solves a block."""
        self.write("block.nml", block(*groups, **options))
        self.run_program("--quiet", "block.nml")
        return Case(self.directory / "block")

    def plot(self, *arguments, status=0):
        """Runs the command."""
        return self.run_package("plot", *arguments, status=status)

    def test_closed_points_lie_on_the_obstacle_at_any_magnification(self):
        case = self.solve(*PUNCH, mesh="size = 4.0, 2.0  cells = 40, 8")
        line = case.line
        closed = line.point_data["status"] > 1
        self.assertGreater(closed.sum(), 2)
        for factor in (3.0, 50.0):
            drawn, = surfaces(case, factor, WINDOW)
            at = line.points[:, :2] + factor*line.point_data["displacement"][:, :2]
            # along the normal; along the obstacle they have slipped
            np.testing.assert_allclose(at[closed, 1], drawn[closed[np.isfinite(initial_gaps(case))], 1], atol=1e-12)
            open_ = ~closed & np.isfinite(initial_gaps(case))
            np.testing.assert_allclose(at[open_, 1] - (line.points[:, 1] - factor*initial_gaps(case))[open_],
                                       factor*line.point_data["gap"][open_], rtol=1e-9)
        # as it is, the obstacle is the circle of the deck
        true, = surfaces(case, 1.0, WINDOW)
        np.testing.assert_allclose(np.hypot(true[:, 0] - 2.0, true[:, 1] + 3.0), 3.0, rtol=1e-14)
        self.assertEqual(magnification(case), 1.0)

    def test_flat_contact_is_magnified(self):
        case = self.solve(SUPPORT, PRESSURE, CONTACT)
        self.assertGreater(magnification(case), 1.0)
        drawn, = surfaces(case, 100.0, WINDOW)
        np.testing.assert_allclose(drawn[:, 1], 0.0, atol=1e-15)

    def test_of_a_pair_both_bodies_are_drawn_and_no_obstacle(self):
        name = self.write("pair.nml", block(
            "mesh name = 'b'  size = 6.0, 2.0  cells = 9, 3  origin = -1.0, -2.01", "support set = 'b.left'  ux = 0.0",
            "support set = 'left'  ux = 0.0", PRESSURE, "contact set = 'bottom'  against = 'b.top'",
            "contact set = 'b.bottom'  point = 0.0, -2.01"))
        self.run_program("--quiet", name)
        case = Case(self.directory / "pair")
        # Of 9 slave points the gaps of the meshes, of the 10 on the obstacle none.
        np.testing.assert_allclose(initial_gaps(case), [0.01]*9 + [0.0]*10, atol=1e-12)
        self.assertEqual((len(case.line.points), len(case.master.points)), (19, 10))
        found, = surfaces(case, 1.0, WINDOW)
        np.testing.assert_allclose(found[:, 1], -2.01)
        self.plot("pair", "--format", "svg")

    def test_bodies_that_close_an_overlap_are_not_drawn_apart(self):
        # A hub whose hole is smaller than the shaft by 0.002 [L] in radius: it moves outwards by about as much.
        fit = "contact set = 'hub.left'  against = 'shaft.right'  gap = 'touching'  extra_gap = {}"
        groups = ("mesh name = 'hub'  size = 1.0, 2.0  cells = 4, 8  origin = 1.0, 0.0",
                  *(f"support set = '{name}.bottom'  uy = 0.0" for name in ("shaft", "hub")))
        parts = {"mesh": "name = 'shaft'  size = 1.0, 2.0  cells = 4, 8",
                 "material": "young = 100.0  poisson = 0.25  hypothesis = 'axisymmetric'"}
        case = self.solve(*groups, fit.format(-0.001), **parts)
        self.assertGreater(np.abs(case.mesh.point_data["displacement"]).max(), 5e-4)
        for factor in (magnification(case), magnification_at(case, np.arange(5))):
            self.assertLessEqual(factor*0.001, 1e-3*2.0)
        # Without an overlap, pressed together.
        case = self.solve(*groups, fit.format(0.0), "load set = 'hub.right'  pressure = 0.1", **parts)
        self.assertGreater(magnification(case), 10.0)

    def test_zones_of_contact_sets_have_a_gap_between_them(self):
        case = self.solve(SUPPORT, "load name = 'p'  set = 'top'  pressure = 1.0",
                          "contact name = 'floor'  set = 'bottom'",
                          "contact set = 'right'  point = 4.1, 0.0  normal = -1.0, 0.0", "history times = 0.0, 1.0",
                          "steps load = 'p'  factor = 1.0, 2.0")
        axes = SvgAxes(0.0, 0.0, 100.0, 100.0)
        draw_zones(axes, case)
        # 9 points, then 5 along another side.
        self.assertEqual(len(axes.cells.y), len(axes.cells.values) + 1)
        self.assertEqual(np.isnan(axes.cells.values).all(axis=1).nonzero()[0].tolist(), [9])
        self.assertEqual(axes.words["ylabel"], "s: floor, right")

    def test_an_obstacle_that_has_moved_is_drawn_where_it_is(self):
        case = self.solve(SUPPORT, PRESSURE, CONTACT)
        case.line.point_data["gap"] = case.line.point_data["gap"] + 0.5
        drawn, = surfaces(case, 1.0, WINDOW)
        np.testing.assert_allclose(drawn[:, 1], -0.5, atol=1e-12)

    def test_an_obstacle_whose_file_is_gone_is_drawn_at_the_contact_points(self):
        self.write("line.csv", "-1 0\n9 0\n")
        case = self.solve(SUPPORT, PRESSURE, "contact set = 'bottom'  obstacle = 'polyline'  line = 'line.csv'")
        self.assertEqual(len(surfaces(case, 1.0, WINDOW)[0]), 2)
        (self.directory / "line.csv").unlink()
        self.assertEqual(len(surfaces(case, 1.0, WINDOW)[0]), len(case.line.points))

    def test_texts_units_and_uniform_fields(self):
        case = self.solve("support set = 'left'  ux = 0.0", PRESSURE, "contact set = 'bottom'",
                          "case title = 'of $5 & <b>'  units = 'mm, N, MPa'")
        self.plot("block", "--format", "svg,pdf")
        words = text_of(self.directory / "block.svg")
        self.assertLessEqual({"of $5 &amp; &lt;b&gt;", "slip [mm]", "gap [mm]", "contact stress [MPa]", "x [mm]",
                              "von Mises stress [MPa], uniform", "length along the contact line [mm]"}, {*words})
        # Its one value is on the bar: plane strain under pressure alone.
        value = case.mesh.cell_data["von_mises"][0]
        self.assertIn(f"{value:.4g}", words)
        pdf = (self.directory / "block.pdf").read_bytes()
        self.assertIn(b"/CIDFontType2", pdf)
        self.assertNotIn(b"/Type3", pdf)

    def test_options(self):
        self.solve(*PUNCH, mesh="size = 4.0, 2.0  cells = 40, 8")
        run = self.plot("block", "--panels", "stress,slip", "--abscissa", "x", "--format", "png,svg", "--size=100x50")
        self.assertEqual(run.stdout, "block.png\nblock.svg\n")
        # 200 points per inch of 25.4 mm
        width, height = struct.unpack(">II", (self.directory / "block.png").read_bytes()[16:24])
        self.assertEqual((width, height), (787, 393))
        words = text_of(self.directory / "block.svg")
        self.assertLessEqual({"x", "slip", "contact stress"}, {*words})
        self.assertFalse({"y", "gap", "residual"} & {*words})
        self.plot("block", "--panels", "body", "--field", "nodal_stress_xy", "--scale", "30", "--format", "svg")
        words = text_of(self.directory / "block.svg")
        self.assertLessEqual({"nodal stress xy", "displacements and gaps × 30"}, {*words})
        self.plot("block", "--field", "displacement", "--scale", "0", "--format", "svg")

    def test_figures_in_python(self):
        from amontons import figure  # pylint: disable=import-outside-toplevel
        case = self.solve(SUPPORT, PRESSURE, CONTACT)
        drawn = figure(case, ["stress"], size=(80, 40))
        np.testing.assert_allclose(drawn.get_size_inches(), [80/25.4, 40/25.4])
        pressure, = [line for line in drawn.subfigs[0].axes[0].lines if line.get_label() == "pressure"]
        np.testing.assert_array_equal(pressure.get_ydata(), case.line.point_data["contact_pressure"])
        with self.assertRaisesRegex(ValueError, "nothing to show in the panels detail"):
            figure(case.path, ["detail"])

    def test_faults_are_sentences(self):
        self.solve(SUPPORT, PRESSURE, CONTACT)
        for arguments, sentence in {
                ("block", "--field", "mises"): "plot: block.vtu: no field 'mises'; the fields are: contact_pressure, ",
                ("block", "--scale", "-1"): "argument --scale: expected a number of at least 0, found '-1'; try --help",
                ("block", "--size", "10x10"): "argument --size: expected 20 to 2000 mm, found '10x10'",
                ("block", "--size", "wide"): "argument --size: expected WIDTHxHEIGHT in mm, found 'wide'",
                ("block", "--panels", "body,foo"): "argument --panels: 'foo' is none of body, detail, stress, slip, ",
                ("block", "--format", "gif"): "argument --format: 'gif' is none of png, svg, pdf",
                ("nowhere",): "plot: nowhere: no case found; expected a folder with *.summary.json, or a "}.items():
            run = self.plot(*arguments, status=1)
            self.assertIn(sentence, run.stderr)
            self.assertNotIn("Traceback", run.stderr)
        self.assertIn("--abscissa", self.plot("--help").stdout)
        grid = self.directory / "block.vtu"
        grid.write_bytes(grid.read_bytes()[:2000])
        self.assertEqual(self.plot("block", status=1).stderr, "plot: block.vtu: damaged, or not a grid of Amontons\n")
        grid.unlink()
        self.assertEqual(self.plot("block", status=1).stderr, "plot: block.vtu: No such file or directory\n")
        self.write("block.summary.json", "{")
        self.assertEqual(self.plot("block", status=1).stderr, "plot: block.summary.json: damaged: not JSON\n")

    def test_columns_of_sweeps(self):
        loads = "load name = 'push'  set = 'right'  traction = -1.0, 0.2"
        self.solve(SUPPORT, PRESSURE, CONTACT, loads, "sweep load = 'push'  factor = 0.5, 1.0, 1.5")
        self.plot("block", "--field", "normal_force", "--format", "svg")
        self.assertLessEqual({"normal force", "factor of push"}, {*text_of(self.directory / "block.svg")})
        run = self.plot("block", "--field", "peak", status=1)
        self.assertIn("no column 'peak'; the columns are: case, ", run.stderr)
        self.assertIn("scale is not for a sweep", self.plot("block", "--scale", "2", status=1).stderr)


def box_deck(*groups, element="hex8", cells="3, 2, 2"):
    """A block of 3 x 2 x 1."""
    return block(*groups, mesh=f"kind = 'box'  size = 3.0, 2.0, 1.0  cells = {cells}  element = '{element}'",
                 material="young = 1000.0  poisson = 0.3")


class Solids(ProgramTest):
    """Figures of solids."""

    def solve(self, *groups, name="solid", **options):
        """Solves a block in space."""
        self.write(f"{name}.nml", box_deck(*groups, **options))
        self.run_program("--quiet", f"{name}.nml")
        return Case(self.directory / name)

    PRESSED = "support set = 'top'  ux = 0.004  uy = 0.0  uz = -0.01"

    def test_faces_of_the_boundary_enclose_the_body(self):
        for element, count in (("hex8", 32), ("hex20", 32), ("tet4", 64), ("tet10", 64)):
            mesh = self.solve(self.PRESSED, CONTACT, element=element).mesh
            faces = boundary_faces(mesh)
            self.assertEqual(len(faces.cells), count, element)
            corners = faces.at_corners(mesh.points)
            areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])/2
            # Gauss: the flux of x/3 outwards, and the surface; to rounding.
            self.assertAlmostEqual((corners.mean(axis=1)*areas).sum()/3, 6.0, delta=1e-12)
            self.assertAlmostEqual(np.linalg.norm(areas, axis=1).sum(), 22.0, delta=1e-12)
            # Each face is one of its cell's.
            nodes = np.concatenate([nodes for _, nodes in mesh.cells])
            for outline, cell in zip(np.concatenate(faces.outlines), faces.cells):
                self.assertLessEqual(set(outline), set(nodes[cell]))

    def test_a_view_shows_z_upwards(self):
        view = View.along(np.array([0.5, -1.0, 0.6]))
        frame = np.stack([view.across, view.up, view.towards])
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)
        self.assertAlmostEqual(np.linalg.det(frame), 1.0)
        self.assertEqual(view.of(np.array([0.0, 0.0, 1.0]))[0], 0.0)
        self.assertGreater(view.of(np.array([0.0, 0.0, 1.0]))[1], 0.0)

    def test_obstacles_in_space(self):
        near = np.array([[2.0, 3.0, 0.1], [4.0, 3.0, 0.2], [3.0, 5.0, 0.1]])
        placed = {"point": [1.0, 2.0, 0.0], "normal": [1.0, 2.0, 9.0]}
        for kind in {*words_of("contact", "obstacle")} - {"circle", "parabola", "polyline", "surface"}:
            for radius in (7.0, -7.0, 1e5):
                contact = {**placed, "obstacle": kind, "radius": radius, "axis": [2.0, -1.0, 0.0]}
                found = Surface.near(contact, near)
                points, quads = found.mesh(near)
                np.testing.assert_allclose(found.heights(points), 0.0, atol=1e-10)  # of a radius of 1e5, to rounding
                self.assertEqual(len(np.unique(quads)), len(points))
                normal = np.array(placed["normal"])/np.linalg.norm(placed["normal"])
                self.assertAlmostEqual(found.heights(np.array([placed["point"]]))[0], 0.0, delta=1e-10)
                # Outside is where the normal points.
                outside = Surface.near(contact, np.array([placed["point"]])).heights(placed["point"] + 0.1*normal[None])
                self.assertAlmostEqual(outside[0], 0.1, delta=1e-10)
        with self.assertRaisesRegex(ValueError, "obstacle 'cusp' cannot be drawn"):
            Surface.near({"obstacle": "cusp"}, near)

    def test_surfaces_of_triangles_are_read_and_drawn_beside_the_body(self):
        # A floor of four triangles below the block and far beyond it, one more far away; as text and binary.
        corners = np.array([[-1.0, -1.0, 0.5], [4.0, -1.0, 0.5], [4.0, 3.0, 0.5], [-1.0, 3.0, 0.5]])
        middle = np.array([1.5, 1.0, 0.5])
        triangles = np.array([[one, other, middle] for one, other in zip(corners, np.roll(corners, -1, axis=0))])
        triangles = np.concatenate([triangles, triangles[:1] + [900.0, 0.0, 0.0]])
        text = "".join("facet normal 0 0 1\nouter loop\n" + "".join(
            "vertex " + " ".join(map(str, corner)) + "\n" for corner in triangle.tolist()) + "endloop\nendfacet\n"
            for triangle in triangles)
        self.write("text.stl", f"solid floor\n{text}endsolid floor\n")
        rows = np.zeros(5, np.dtype([("numbers", "<f4", 12), ("attribute", "<u2")]))
        rows["numbers"][:, 3:] = triangles.reshape(5, 9)
        (self.directory / "binary.stl").write_bytes(b"floor".ljust(80) + struct.pack("<I", 5) + rows.tobytes())
        for file in ("text.stl", "binary.stl"):
            case = self.solve(self.PRESSED, f"{CONTACT}  obstacle = 'surface'  file = '{file}'  point = 0.0, 0.0, -0.5")
            (points, faces), = obstacles(case, 1.0)
            np.testing.assert_allclose(points, triangles[:4].reshape(-1, 3) - [0.0, 0.0, 0.5], atol=1e-15)
            self.assertEqual(len(faces.cells), 4)
        (self.directory / file).unlink()
        (points, faces), = obstacles(Case(self.directory / "solid"), 1.0)
        self.assertEqual(len(faces.cells), 6)  # those of the contact set

    def test_an_obstacle_is_where_the_deck_says_or_opposite_the_points(self):
        case = self.solve("support set = 'top'  ux = 0.0  uy = 0.0  uz = -0.01",
                          CONTACT + "  obstacle = 'cylinder'  radius = 9.0  axis = 0.0, 1.0, 0.0  "
                          "point = 1.5, 0.0, 0.0  normal = 0.0, 0.0, 1.0")
        (points, _), = obstacles(case, 1.0)
        np.testing.assert_allclose(np.hypot(points[:, 0] - 1.5, points[:, 2] + 9.0), 9.0, rtol=1e-12)
        (points, faces), = obstacles(case, 20.0)
        shown = np.unique(np.concatenate(faces.outlines))
        gaps = np.hypot(points[shown, 0] - 1.5, 9.0) - 9.0
        self.assertGreater(gaps.max(), 0.1)
        # The gap along z of a point at x, twenty times.
        s = points[shown, 0] - 1.5
        np.testing.assert_allclose(points[shown, 2], -20*(9.0 - np.sqrt(81.0 - s**2)), atol=1e-9)

    def test_charts(self):
        rng = np.random.default_rng(3)
        points = rng.random((30, 3))
        weights = np.ones(30)
        for direction, labels in (([0, 0, -1], ("x", "y")), ([0, 1, 0], ("x", "z")), ([-1, 0, 0], ("y", "z")),
                                  ([0.6, 0, 0.8], ("y; t along (0.8, 0, −0.6)", "t"))):
            chart = Chart.of(points, np.tile(np.array(direction, float), (30, 1)), weights)
            case = self.Unitless()
            self.assertEqual(chart.labels(case), labels)
            # Distances in the plane are those on paper, and vectors are drawn as the ways between points.
            flat = points - np.outer(points @ direction, direction)
            places = chart.places(np.repeat(points[:, None], 3, axis=1))[:, 0, :2]
            np.testing.assert_allclose(np.linalg.norm(places - places[0], axis=1),
                                       np.linalg.norm(flat - flat[0], axis=1), atol=1e-14)
            np.testing.assert_allclose(chart.directions(points, flat - flat[0]), places - places[0], atol=1e-14)

    class Unitless:
        """Stands for a case whose deck names no units."""

        @staticmethod
        def label(text, _):
            """A text as it is."""
            return text

    def test_what_is_around_an_axis_is_unrolled(self):
        angle, h = (part.ravel() for part in np.meshgrid(np.radians(np.arange(-180, 180, 15)), [0.0, 1.0, 2.0]))
        normals = np.stack([np.zeros_like(h), np.cos(angle), np.sin(angle)], axis=1)
        points = 4.0*normals + np.stack([h, 0.0*h + 7.0, 0.0*h - 2.0], axis=1)
        chart = Chart.of(points, -normals, np.ones(len(h)))
        self.assertEqual(chart.labels(self.Unitless()), ("angle around x [°]", "x"))
        places = chart.places(np.repeat(points[:, None], 3, axis=1))[:, 0, :2]
        np.testing.assert_allclose(np.exp(1j*np.radians(places[:, 0])), np.exp(1j*angle), atol=1e-12)
        np.testing.assert_allclose(places[:, 1], h, atol=1e-12)
        around = np.cross([1.0, 0.0, 0.0], normals)
        np.testing.assert_allclose(chart.directions(points, around + [2.0, 0.0, 0.0]), np.tile([1.0, 2.0], (len(h), 1)),
                                   atol=1e-12)
        # Across the end of the angle a triangle stays whole.
        corners = points[np.argsort(angle, kind="stable")[[-1, 0, 1]]][None]
        self.assertLess(np.ptp(chart.places(corners)[..., 0]), 31.0)

    def test_a_map_has_the_color_of_the_status_that_is_nearest(self):
        for element in ("hex8", "hex20", "tet4", "tet10"):
            case = self.solve(self.PRESSED, CONTACT, element=element)
            one, = maps_of(case)
            image = map_image(one, "status", (60, 44))
            low, high = one.window
            x, y = np.meshgrid(low[0] + (np.arange(60) + 0.5)/60*(high - low)[0],
                               high[1] - (np.arange(44) + 0.5)/44*(high - low)[1])
            data, found = case.contact_grid.point_data, 0
            for point in one.shown.points:
                at = case.contact_grid.points[point]
                # Half of the way to the nearest other node, less a pixel.
                here = np.hypot(x - at[0], y - at[1]) < 0.1
                here &= (x > 0.06) & (x < 2.94) & (y > 0.06) & (y < 1.94)
                color = pale(int(data["status"][point]))
                found += here.sum()
                np.testing.assert_allclose(image[here], np.tile([*color, 1.0], (here.sum(), 1)), atol=0.3*0.4)
            self.assertGreater(found, 20)
            self.assertEqual(image[0, 0, 3], 0.0)  # beside the faces

    def test_pieces_of_a_set_have_maps_of_their_own(self):
        case = self.solve(self.PRESSED, CONTACT, cells="12, 8, 2")
        whole, = contact_sets(case)
        self.assertEqual(pieces(whole), [whole])
        outline, = whole.faces.outlines
        at = case.contact_grid.points[outline].mean(axis=1)
        ends = outline[((at[:, 0] < 0.3) | (at[:, 0] > 2.7)) & (at[:, 1] < 0.3)]
        grid = Grid(case.contact_grid.points, [("quad", ends)], case.contact_grid.point_data, {})
        case.__dict__["contact_grid"] = grid
        parts = pieces(contact_sets(case)[0])
        self.assertEqual([len(part.faces.cells) for part in parts], [1, 1])
        pressure = [grid.point_data["contact_pressure"][part.points].sum() for part in parts]
        self.assertGreaterEqual(pressure[0], pressure[1])
        self.assertEqual([one.title for one in maps_of(case)],
                         ["bottom on a plane, part 1", "bottom on a plane, part 2"])

    def test_nodes_of_a_set_that_are_no_contact_points_belong_to_its_faces(self):
        case = self.solve("support set = 'left'  ux = 0.0  uy = 0.0  uz = 0.0", "load set = 'top'  pressure = 1.0",
                          CONTACT + "  friction_slope = 0.0, 0.0, 0.0")
        self.assertGreater(len(case.contact_grid.points), len(case.line.points))
        whole, = contact_sets(case)
        self.assertEqual(len(whole.faces.cells), 6)

    def test_colors_end_where_nearly_all_is(self):
        case = self.solve(self.PRESSED, CONTACT, cells="12, 8, 4")
        part = part_of(case)
        self.assertIsNone(part.largest)
        case.mesh.point_data["nodal_von_mises"] = case.mesh.points[:, 0].copy()
        case.mesh.point_data["nodal_von_mises"][0] = 300.0
        part = part_of(case)
        self.assertEqual((part.limits, part.largest), ((0.0, 75.0), 300.0))
        case.mesh.point_data["nodal_von_mises"] = np.full(len(case.mesh.points), 4.0)
        self.assertEqual(part_of(case).uniform, 4.0)

    def test_texts_units_and_options(self):
        self.solve(self.PRESSED, CONTACT, "case title = 'A block'  units = 'mm, N, MPa'")
        self.run_package("plot", "solid", "--format", "svg,png")
        words = text_of(self.directory / "solid.svg")
        self.assertLessEqual({"A block", "x [mm]", "y [mm]", "z [mm]", "from the other side", "stick", "slip",
                              "bottom on a plane", "contact pressure [MPa]", "nodal von Mises stress [MPa]"}, {*words})
        self.assertTrue(any(re.fullmatch(r"largest slip [\d.e-]+ mm", word) for word in words))
        # The magnitude of a vector is that of all its components.
        grid = read_grid(self.directory / "solid.vtu")
        self.run_package("plot", "solid", "--panels", "body,gap", "--field", "displacement", "--scale", "3", "--format",
                         "svg")
        words = text_of(self.directory / "solid.svg")
        self.assertLessEqual({"displacement [mm]", "displacements and gaps × 3", "gap [mm]"}, {*words})
        self.assertFalse({"stick", "residual"} & {*words})
        self.assertEqual(part_of(Case(self.directory / "solid"), "displacement").limits[1],
                         np.linalg.norm(grid.point_data["displacement"], axis=1).max())
        for arguments, sentence in ((("--abscissa", "x"), "abscissa is not for a solid"),
                                    (("--panels", "detail"), "nothing to show in the panels detail"),
                                    (("--field", "mises"), "no field 'mises'; the fields are: contact_pressure, ")):
            self.assertIn(sentence, self.run_package("plot", "solid", *arguments, status=1).stderr)

    def test_a_solid_without_contact_is_drawn(self):
        self.solve("support set = 'left'  ux = 0.0  uy = 0.0  uz = 0.0", "load set = 'top'  pressure = 1.0")
        self.run_package("plot", "solid", "--format", "svg")
        self.assertIn("displacements × ", (self.directory / "solid.svg").read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main()
