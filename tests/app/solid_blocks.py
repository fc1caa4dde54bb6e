"""Blocks of hexahedra of any shape, written in Gmsh's format 2.2."""
import math

# Ends of the edges of a hexahedron in the order of their middles, by Gmsh.
EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
FACES = {"bottom": (0, 3, 2, 1), "top": (4, 5, 6, 7), "front": (0, 1, 5, 4), "right": (1, 2, 6, 5),
         "back": (2, 3, 7, 6), "left": (3, 0, 4, 7)}
AXES = {"left": (0, 0), "right": (0, 1), "front": (1, 0), "back": (1, 1), "bottom": (2, 0), "top": (2, 1)}


def block_of_hexahedra(name, cells, mapping, element="hex8", is_straight=False):
    """The elements of a block, as a list of name, number of Gmsh's kind and places of the nodes: cells[0] by cells[1]
    by cells[2] cells of the unit cube, whose point (r, s, t) is put to mapping((r, s, t)), middle nodes as well unless
    edges are straight. The boundary sets are those of a box with the name before them, the region is the name."""
    elements = []
    for cell in ((i, j, k) for k in range(cells[2]) for j in range(cells[1]) for i in range(cells[0])):
        corners = [[(cell[a] + corner[a])/cells[a] for a in range(3)] for corner in CORNERS]

        def on_edge(a, b, corners=corners):
            if is_straight:
                return middle(mapping(corners[a]), mapping(corners[b]))
            return mapping(middle(corners[a], corners[b]))

        middles = [on_edge(a, b) for a, b in EDGES] if element == "hex20" else []
        elements.append((name, 17 if middles else 5, [mapping(point) for point in corners] + middles))
        for side, face in FACES.items():
            axis, end = AXES[side]
            if cell[axis] != end*(cells[axis] - 1):
                continue
            points = [mapping(corners[i]) for i in face]
            if middles:
                points += [on_edge(a, b) for a, b in zip(face, face[1:] + face[:1])]
            elements.append((f"{name}.{side}", 16 if middles else 3, points))
    return elements


def middle(one, other):
    """The middle between two points."""
    return [0.5*(a + b) for a, b in zip(one, other)]


def distorted(rng, cells, amount, mapping):
    """A mapping that moves each node inside of the cube, or of its faces along these, by up to a share of a cell
    before another mapping."""
    moved = {}

    def move(point):
        key = tuple(round(1e6*x) for x in point)
        if key not in moved:
            moved[key] = mapping([x + (amount*rng.uniform(-1.0, 1.0)/n if 1e-6 < x < 1.0 - 1e-6 else 0.0)
                                  for x, n in zip(point, cells)])
        return moved[key]
    return move


def rotation(rng):
    """The matrix of a random rotation."""
    while True:
        w, x, y, z = (rng.gauss(0.0, 1.0) for _ in range(4))
        if (norm := math.sqrt(w*w + x*x + y*y + z*z)) > 0.1:
            break
    w, x, y, z = w/norm, x/norm, y/norm, z/norm
    return ((1 - 2*(y*y + z*z), 2*(x*y - w*z), 2*(x*z + w*y)), (2*(x*y + w*z), 1 - 2*(x*x + z*z), 2*(y*z - w*x)),
            (2*(x*z - w*y), 2*(y*z + w*x), 1 - 2*(x*x + y*y)))


def turned(matrix, point):
    """The product of a matrix and a point."""
    return [sum(a*x for a, x in zip(row, point)) for row in matrix]


def mesh_text(*blocks):
    """The text of a mesh file of blocks that share no nodes."""
    names, nodes, lines, before = [], [], [], 0
    for block in blocks:
        number = {}
        for name, kind, points in block:
            if name not in names:
                names.append(name)
            for point in points:
                key = tuple(round(1e9*x) for x in point)
                if key not in number:
                    number[key] = before + len(number) + 1
                    nodes.append("{} {!r} {!r} {!r}".format(number[key], *map(float, point)))
            group = names.index(name) + 1
            of_points = " ".join(str(number[tuple(round(1e9*x) for x in point)]) for point in points)
            lines.append(f"{len(lines) + 1} {kind} 2 {group} {group} {of_points}")
        before += len(number)
    groups = [f'{2 if "." in name else 3} {i} "{name}"' for i, name in enumerate(names, 1)]
    sections = (("PhysicalNames", groups), ("Nodes", nodes), ("Elements", lines))
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + "".join(
        f"${name}\n{len(rows)}\n" + "\n".join(rows) + f"\n$End{name}\n" for name, rows in sections)
