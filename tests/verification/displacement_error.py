"""The error of the displacements in L2, integrated element by element with the elements' own shape functions."""
from math import sqrt

from harness import read_vtu

ELEMENT_OF_VTK = {5: "tri3", 9: "quad4", 22: "tri6", 23: "quad8", 28: "quad9"}
CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
# Gauss's four points: exact to degree 7, one more than the square of an error of quadratic elements has.
GAUSS = ((-0.8611363115940526, 0.3478548451374538), (-0.3399810435848563, 0.6521451548625461),
         (0.3399810435848563, 0.6521451548625461), (0.8611363115940526, 0.3478548451374538))


def displacement_error(path, exact, depth=lambda x: 1.0):
    """The L2 norm of u - exact over that of exact; exact(x, y) is a pair, depth(x) multiplies areas."""
    arrays, _, _ = read_vtu(path.read_bytes())
    tables = {}
    error = size = 0.0
    start = 0
    for kind, end in zip(arrays["types"], arrays["offsets"]):
        nodes = arrays["connectivity"][start:end]
        start = end
        if kind not in tables:
            tables[kind] = reference_points(ELEMENT_OF_VTK[kind])
        x = [arrays["points"][node] for node in nodes]
        u = [arrays["displacement"][node] for node in nodes]
        for weight, values, by_r, by_s in tables[kind]:
            px, py, ux, uy, xr, yr, xs, ys = 8*(0.0,)
            for value, r, s, point, shift in zip(values, by_r, by_s, x, u):
                px += value*point[0]
                py += value*point[1]
                ux += value*shift[0]
                uy += value*shift[1]
                xr += r*point[0]
                yr += r*point[1]
                xs += s*point[0]
                ys += s*point[1]
            area = weight*(xr*ys - xs*yr)*depth(px)
            vx, vy = exact(px, py)
            error += area*((ux - vx)**2 + (uy - vy)**2)
            size += area*(vx**2 + vy**2)
    return sqrt(error/size)


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
    """Value and derivatives of the functions of the nine-node quadrilateral: corners, middles, centre."""
    def line(x, node):
        return (1.0 - x*x, -2.0*x) if node == 0.0 else (0.5*x*(x + node), x + 0.5*node)
    middles = [(0.5*(a + c), 0.5*(b + d)) for (a, b), (c, d) in zip(CORNERS, (*CORNERS[1:], CORNERS[0]))]
    functions = []
    for a, b in (*CORNERS, *middles, (0.0, 0.0)):
        (p, dp), (q, dq) = line(r, a), line(s, b)
        functions.append((p*q, dp*q, p*dq))
    return functions
