"""Structured meshes of any four-sided body: cells of the unit square, mapped and written in Gmsh's format 2.2."""
from math import atan2, cos, hypot, pi, sin

# Numbers of the elements in the format; order and shape.
GMSH_KIND = {"tri3": 2, "quad4": 3, "tri6": 9, "quad8": 16, "quad9": 10}
GMSH_SIDE = {1: 1, 2: 8}
SIDES = ("bottom", "right", "top", "left")


def mapped_mesh(cells, element, mapping=lambda s, t: (s, t), n_pressed=0):
    """The text of a mesh file: cells[0] by cells[1] cells, the point (s, t) of the unit square put to mapping(s, t).

    The boundary sets are bottom (t = 0), right, top and left, the region is body. The sides of the first n_pressed
    cells of the top are not in that set, but in pressed. Middle nodes are mapped as well, so that curved
    sides are curved. Triangles halve the cells by turns along one diagonal and the other.
    """
    order = 1 if element in ("tri3", "quad4") else 2
    across, up = order*cells[0], order*cells[1]
    is_left_out = (lambda i, j: i % 2 == 1 and j % 2 == 1) if element == "quad8" else (lambda i, j: False)
    number = {}
    for j in range(up + 1):
        for i in range(across + 1):
            if not is_left_out(i, j):
                number[i, j] = len(number) + 1
    nodes = ["{} {!r} {!r} 0".format(node, *map(float, mapping(i/across, j/up))) for (i, j), node in number.items()]
    rows = side_rows(number, order, across, up, order*n_pressed)
    for j in range(0, up, order):
        for i in range(0, across, order):
            corners = [(i, j), (i + order, j), (i + order, j + order), (i, j + order)]
            for polygon in polygons(corners, element, (i + j)//order):
                rows.append((GMSH_KIND[element], 5, with_middles(polygon, element, number)))
    elements = [" ".join(map(str, (row, kind, 2, group, group, *members)))
                for row, (kind, group, members) in enumerate(rows, start=1)]
    names = [f'1 {group} "{name}"' for group, name in enumerate(SIDES, start=1)] + ['2 5 "body"']
    names += ['1 6 "pressed"']*(n_pressed > 0)
    return "\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat",
                      "$PhysicalNames", str(len(names)), *names, "$EndPhysicalNames",
                      "$Nodes", str(len(nodes)), *nodes, "$EndNodes",
                      "$Elements", str(len(elements)), *elements, "$EndElements", ""])


def side_rows(number, order, across, up, pressed):
    """The sides of the boundary: kind, group, nodes; those of the top up to a place are a group of their own."""
    lines = {1: [(i, 0) for i in range(across + 1)], 2: [(across, j) for j in range(up + 1)],
             3: [(i, up) for i in range(across, -1, -1)], 4: [(0, j) for j in range(up, -1, -1)]}
    sides = [(3 + 3*(line[k][0] <= pressed) if group == 3 else group, [number[line[k]], number[line[k + order]],
                                                                       *(number[line[k + 1]],)*(order - 1)])
             for group, line in lines.items() for k in range(0, len(line) - 1, order)]
    return [(GMSH_SIDE[order], *side) for side in sides]


def polygons(corners, element, parity):
    """The corners of a cell's elements: the cell itself, or its two triangles."""
    a, b, c, d = corners
    if not element.startswith("tri"):
        return [corners]
    return [(a, b, c), (a, c, d)] if parity % 2 == 0 else [(a, b, d), (b, c, d)]


def with_middles(polygon, element, number):
    """The nodes of an element: corners, middles of its sides, center."""
    nodes = [number[corner] for corner in polygon]
    if element in ("tri6", "quad8", "quad9"):
        for (i, j), (k, l) in zip(polygon, (*polygon[1:], polygon[0])):
            nodes.append(number[(i + k)//2, (j + l)//2])
    if element == "quad9":
        nodes.append(number[(polygon[0][0] + polygon[2][0])//2, (polygon[0][1] + polygon[2][1])//2])
    return nodes


def sector(inner, outer, angle):
    """The mapping to a sector of a ring: bottom is its first radius, right its outer side, left its inner one."""
    return lambda s, t: ((inner + (outer - inner)*s)*cos(angle*t), (inner + (outer - inner)*s)*sin(angle*t))


def wall(inner, outer):
    """The mapping to a section through the wall of a tube, of height 1, its inner nodes moved."""
    def move(s, t):
        shift = 0.1*sin(pi*s)*sin(pi*t)
        return inner + (outer - inner)*(s + shift), t - 0.7*shift
    return move


def turned(mapping, angle):
    """A mapping turned about the origin."""
    def turn(s, t):
        x, y = mapping(s, t)
        return hypot(x, y)*cos(atan2(y, x) + angle), hypot(x, y)*sin(atan2(y, x) + angle)
    return turn


def distorted(cells, are_triangles, share=0.2):
    """The mapping of so many by so many cells, or their triangles, to ones with straight sides in the unit square, each
    corner inside moved by a share of a cell."""
    def corner(i, j):
        angle = 12.9898*i + 78.233*j if 0 < i < cells and 0 < j < cells else None
        return (i/cells, j/cells) if angle is None else ((i + share*sin(angle))/cells, (j + share*cos(3*angle))/cells)

    def move(s, t):
        i, j = min(int(s*cells), cells - 1), min(int(t*cells), cells - 1)
        a, b = s*cells - i, t*cells - j
        shares = (1 - a)*(1 - b), a*(1 - b), a*b, (1 - a)*b
        if are_triangles and (i + j) % 2 == 0:
            shares = 1 - max(a, b), max(a - b, 0.0), min(a, b), max(b - a, 0.0)
        elif are_triangles:
            shares = max(1 - a - b, 0.0), min(a, 1 - b), max(a + b - 1, 0.0), min(1 - a, b)
        corners = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
        return tuple(sum(part*place[axis] for part, place in zip(shares, corners)) for axis in (0, 1))
    return move
