"""Errors of displacement and stress, integrated element by element with the elements' own shape functions."""
from math import pi, sqrt
from typing import NamedTuple

from harness import read_vtu

ELEMENT_OF_VTK = {5: "tri3", 9: "quad4", 22: "tri6", 23: "quad8", 28: "quad9"}
CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
# Gauss's four points: exact to degree 7, one more than the square of an error of quadratic elements has.
GAUSS = ((-0.8611363115940526, 0.3478548451374538), (-0.3399810435848563, 0.6521451548625461),
         (0.3399810435848563, 0.6521451548625461), (0.8611363115940526, 0.3478548451374538))


class Elastic(NamedTuple):
    """A material; `expansion(x, y)` is its free thermal strain, `force(x, y)` a force per volume, moving bubbles."""
    young: float
    poisson: float
    hypothesis: str = "plane strain"
    b_bar: bool = False
    expansion: object = None
    force: object = None

    def depth(self, x):
        """What an area of the plane is multiplied by."""
        return 2*pi*x if self.hypothesis == "axisymmetric" else 1.0

    def stress(self, strain):
        """The stresses xx, yy, zz, xy of the elastic strains xx, yy, zz and the shear angle."""
        mu = self.young/(2*(1 + self.poisson))
        first = self.young*self.poisson/((1 + self.poisson)*(1 - 2*self.poisson))
        if self.hypothesis == "plane stress":
            first = 2*first*mu/(first + 2*mu)
            strain = strain[0], strain[1], 0.0, strain[3]
        trace = first*(strain[0] + strain[1] + strain[2])
        return [trace + 2*mu*strain[0], trace + 2*mu*strain[1], trace + 2*mu*strain[2], mu*strain[3]]

    def squared_norm(self, stress):
        """Stress times the strain that makes it; only of a body of revolution the stress zz is one of its own."""
        xx, yy, zz, xy = stress
        if self.hypothesis != "axisymmetric":
            zz = self.poisson*(xx + yy) if self.hypothesis == "plane strain" else 0.0
        return ((1 + self.poisson)*(xx**2 + yy**2 + zz**2 + 2*xy**2) - self.poisson*(xx + yy + zz)**2)/self.young


class Point(NamedTuple):
    """A quadrature point of an element: weight, place, and the computed field there."""
    area: float
    place: tuple
    displacement: tuple
    gradient: tuple  # u_x by x and by y, u_y by x and by y
    values: tuple  # of the shape functions
    bubble: tuple = ()  # value of the function inside an element that has one, and its derivatives by x and by y


def quadrature(path):
    """The nodes' coordinates and the quadrature points of every element of a grid."""
    arrays, _, _ = read_vtu(path.read_bytes())
    tables = {}
    start = 0
    for kind, end in zip(arrays["types"], arrays["offsets"]):
        nodes = arrays["connectivity"][start:end]
        start = end
        if kind not in tables:
            tables[kind] = reference_points(ELEMENT_OF_VTK[kind])
        x = [arrays["points"][node] for node in nodes]
        u = [arrays["displacement"][node] for node in nodes]
        yield x, [point_of(entry, x, u) for entry in tables[kind]]


def point_of(entry, x, u):
    """A quadrature point from its weight, shape functions and their derivatives, and the nodes of its element."""
    weight, values, by_r, by_s = entry
    px, py, xr, yr, xs, ys = (sum(f*point[axis] for f, point in zip(functions, x))
                              for functions in (values, by_r, by_s) for axis in (0, 1))
    ux, uy, uxr, uyr, uxs, uys = (sum(f*shift[axis] for f, shift in zip(functions, u))
                                  for functions in (values, by_r, by_s) for axis in (0, 1))
    det = xr*ys - xs*yr
    gradient = tuple(g/det for g in (uxr*ys - uxs*yr, uxs*xr - uxr*xs, uyr*ys - uys*yr, uys*xr - uyr*xs))
    bubble = [(b, (br*ys - bs*yr)/det, (bs*xr - br*xs)/det)
              for b, br, bs in zip(values[len(x):], by_r[len(x):], by_s[len(x):])]
    return Point(weight*det, (px, py), (ux, uy), gradient, values, *bubble)


def displacement_error(path, exact, depth=lambda x: 1.0):
    """The L2 norm of u - exact over that of exact; exact(x, y) is a pair, depth(x) multiplies areas."""
    error = size = 0.0
    for _, points in quadrature(path):
        for point in points:
            area = point.area*depth(point.place[0])
            vx, vy = exact(*point.place)
            error += area*((point.displacement[0] - vx)**2 + (point.displacement[1] - vy)**2)
            size += area*(vx**2 + vy**2)
    return sqrt(error/size)


def stress_error(path, exact, material):
    """The norm of the strain energy of the stresses less the exact ones, and its ratio to that of the exact ones."""
    error = size = 0.0
    for x, points in quadrature(path):
        strains = [strain_of(point.gradient, point.displacement[0], point.place[0], material) for point in points]
        areas = [point.area*material.depth(point.place[0]) for point in points]
        if material.expansion:
            free = [sum(value*material.expansion(node[0], node[1]) for value, node in zip(point.values, x))
                    for point in points]
            strains = [without_expansion(strain, e) for strain, e in zip(strains, free)]
        if material.b_bar:
            strains = b_bar_strains(strains, points, areas, material, 1 if len(x) == 4 else 3)
        for area, point, strain in zip(areas, points, strains):
            wanted = strain_of(gradient_of(exact, *point.place), exact(*point.place)[0], point.place[0], material)
            if material.expansion:
                wanted = without_expansion(wanted, material.expansion(*point.place))
            stress = material.stress(wanted)
            error += area*material.squared_norm([s - t for s, t in zip(material.stress(strain), stress)])
            size += area*material.squared_norm(stress)
    return sqrt(error), sqrt(error/max(size, 1e-300))


def b_bar_strains(strains, points, areas, material, n_modes):
    """Elastic strains with the dilatation projected to 1, x, y over the element, and with those of its bubble."""
    modes = []
    for terms in list(zip(*((1.0, *point.place) for point in points)))[:n_modes]:
        for mode in modes:
            share = inner(areas, mode, terms)
            terms = [term - share*value for term, value in zip(terms, mode)]
        modes.append([term/sqrt(inner(areas, terms, terms)) for term in terms])
    strains = projected(strains, modes, areas)
    if not points[0].bubble:
        return strains
    moved = [projected([strain_of(((dx, dy, 0.0, 0.0), (0.0, 0.0, dx, dy))[axis], value*(axis == 0), point.place[0],
                                  material) for point in points for value, dx, dy in (point.bubble,)], modes, areas)
             for axis in (0, 1)]
    forces = [material.force(*point.place) if material.force else (0.0, 0.0) for point in points]
    rest = [sum(area*(force[axis]*point.bubble[0] - work(material.stress(strain), strain_by))
                for area, point, force, strain, strain_by in zip(areas, points, forces, strains, moved[axis]))
            for axis in (0, 1)]
    xx, xy, yy = (sum(area*work(material.stress(one), other) for area, one, other in zip(areas, moved[i], moved[j]))
                  for i, j in ((0, 0), (0, 1), (1, 1)))
    ux, uy = (yy*rest[0] - xy*rest[1])/(xx*yy - xy**2), (xx*rest[1] - xy*rest[0])/(xx*yy - xy**2)
    return [[e + ux*by_x + uy*by_y for e, by_x, by_y in zip(*entry)] for entry in zip(strains, *moved)]


def inner(areas, one, other):
    """The integral of a product."""
    return sum(area*a*b for area, a, b in zip(areas, one, other))


def projected(strains, modes, areas):
    """Strains xx, yy, zz and shear angle, their trace projected to orthonormal modes."""
    traces = [sum(strain[:3]) for strain in strains]
    shares = [inner(areas, mode, traces) for mode in modes]
    excess = [(sum(share*value for share, value in zip(shares, at)) - trace)/3
              for trace, at in zip(traces, zip(*modes))]
    return [[e + change for e in strain[:3]] + [strain[3]] for strain, change in zip(strains, excess)]


def work(stress, strain):
    """Stress times strain."""
    return sum(s*e for s, e in zip(stress, strain))


def strain_of(gradient, radial, radius, material):
    """The strains xx, yy, zz and the shear angle of a field."""
    hoop = radial/radius if material.hypothesis == "axisymmetric" else 0.0
    return [gradient[0], gradient[3], hoop, gradient[1] + gradient[2]]


def without_expansion(strain, expansion):
    """The elastic part of a strain; along z nothing else is in the plane, and in plane stress it does not count."""
    return [strain[0] - expansion, strain[1] - expansion, strain[2] - expansion, strain[3]]


def gradient_of(exact, x, y, step=1e-5):
    """The gradient of a field by central differences, good to ten digits for bodies of size 1."""
    east, west, north, south = exact(x + step, y), exact(x - step, y), exact(x, y + step), exact(x, y - step)
    return tuple((after[axis] - before[axis])/(2*step)
                 for axis in (0, 1) for after, before in ((east, west), (north, south)))


def reference_points(element):
    """Weight, shape functions and their two derivatives at the quadrature points of an element."""
    points = [(wr*ws, r, s) for r, wr in GAUSS for s, ws in GAUSS]
    if element.startswith("tri"):
        # The square with one side drawn together into a corner.
        points = [(0.125*(1.0 - s)*w, 0.25*(1.0 + r)*(1.0 - s), 0.5*(1.0 + s)) for w, r, s in points]
    shape = {"tri3": triangle, "tri6": triangle, "quad4": bilinear, "quad8": serendipity, "quad9": biquadratic}[element]
    table = []
    for weight, r, s in points:
        functions = shape(r, s, 2 if element == "tri6" else 1) if shape is triangle else shape(r, s)
        if element == "tri6":
            t = 1.0 - r - s
            functions.append((r*s*t, s*(t - r), r*(t - s)))
        if element == "quad8":
            functions.append(((1.0 - r*r)*(1.0 - s*s), -2.0*r*(1.0 - s*s), -2.0*s*(1.0 - r*r)))
        table.append((weight, *zip(*functions)))
    return table


def triangle(r, s, degree):
    """Value and derivatives of the functions of the triangle: corners, then middles."""
    corner = [(1.0 - r - s, -1.0, -1.0), (r, 1.0, 0.0), (s, 0.0, 1.0)]
    if degree == 1:
        return corner
    corners = [(l*(2.0*l - 1.0), (4.0*l - 1.0)*lr, (4.0*l - 1.0)*ls) for l, lr, ls in corner]
    middles = [(4.0*l*m, 4.0*(lr*m + l*mr), 4.0*(ls*m + l*ms))
               for (l, lr, ls), (m, mr, ms) in zip(corner, (*corner[1:], corner[0]))]
    return corners + middles


def bilinear(r, s):
    """Value and derivatives of the functions of the four-node quadrilateral."""
    return [(0.25*(1.0 + a*r)*(1.0 + b*s), 0.25*a*(1.0 + b*s), 0.25*b*(1.0 + a*r)) for a, b in CORNERS]


def serendipity(r, s):
    """Value and derivatives of the functions of the eight-node quadrilateral: corners, then middles."""
    functions = []
    for a, b in CORNERS:
        p, q = 1.0 + a*r, 1.0 + b*s
        functions.append((0.25*p*q*(a*r + b*s - 1.0), 0.25*a*q*(2.0*a*r + b*s), 0.25*b*p*(a*r + 2.0*b*s)))
    for (a, b), (c, d) in zip(CORNERS, (*CORNERS[1:], CORNERS[0])):
        a, b = 0.5*(a + c), 0.5*(b + d)
        if a:
            functions.append((0.5*(1.0 + a*r)*(1.0 - s*s), 0.5*a*(1.0 - s*s), -(1.0 + a*r)*s))
        else:
            functions.append((0.5*(1.0 - r*r)*(1.0 + b*s), -r*(1.0 + b*s), 0.5*b*(1.0 - r*r)))
    return functions


def biquadratic(r, s):
    """Value and derivatives of the functions of the nine-node quadrilateral: corners, middles, center."""
    def line(x, node):
        return (1.0 - x*x, -2.0*x) if node == 0.0 else (0.5*x*(x + node), x + 0.5*node)
    middles = [(0.5*(a + c), 0.5*(b + d)) for (a, b), (c, d) in zip(CORNERS, (*CORNERS[1:], CORNERS[0]))]
    functions = []
    for a, b in (*CORNERS, *middles, (0.0, 0.0)):
        (p, dp), (q, dq) = line(r, a), line(s, b)
        functions.append((p*q, dp*q, p*dq))
    return functions
