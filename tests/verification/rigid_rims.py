"""Random blocks with rigid sets beside walls, and their solution by a small finite element program of its own.

Linear triangles in plane strain, Gaussian elimination on the displacements of all nodes, the motions of the rigid sets
and the forces of all contact nodes together, and Newton's steps from status to status. Standard library only.
"""
import random

from linear_equations import solve

YOUNG, POISSON = 1000.0, 0.3


class Wall:
    """A straight wall beside a boundary set: its outward normal, its distance from the set and its friction."""

    def __init__(self, side, gap, friction):
        self.side, self.gap, self.friction = side, gap, friction
        self.normal = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "bottom": (0.0, -1.0), "top": (0.0, 1.0)}[side]


class Block:
    """A rectangle of cells halved by `/`, its rigid sets with their forces and moments, its walls and a pressure."""

    def __init__(self, size, cells, rigid, walls, pressure):
        self.size, self.cells, self.rigid, self.walls, self.pressure = size, cells, rigid, walls, pressure
        self.place = [(size[0]*i/cells[0], size[1]*j/cells[1]) for j in range(cells[1] + 1)
                      for i in range(cells[0] + 1)]
        self.elements = []
        for j in range(cells[1]):
            for i in range(cells[0]):
                a, width = j*(cells[0] + 1) + i, cells[0] + 1
                self.elements += [(a, a + 1, a + width + 1), (a, a + width + 1, a + width)]

    def nodes(self, side):
        """The nodes of a side of the rectangle, in the order of their coordinates."""
        along, at = {"left": (0, 0.0), "right": (0, self.size[0]), "bottom": (1, 0.0),
                     "top": (1, self.size[1])}[side]
        return [k for k, place in enumerate(self.place) if abs(place[along] - at) < 1e-9]

    def deck(self):
        """The deck of the block."""
        text = f"&mesh size = {self.size[0]}, {self.size[1]}  cells = {self.cells[0]}, {self.cells[1]}" \
               "  element = 'tri3' /\n" \
               f"&material young = {YOUNG}  poisson = {POISSON} /\n" \
               f"&load set = 'top'  pressure = {self.pressure!r} /\n"
        for side, force, moment in self.rigid:
            text += f"&rigid name = '{side}'  set = '{side}'  force = {force[0]!r}, {force[1]!r}" \
                    f"  moment = {moment!r} /\n"
        for wall in self.walls:
            corner = [self.size[0] if wall.side == "right" else 0.0, 0.0]
            point = [corner[k] + wall.gap*wall.normal[k] for k in range(2)]
            text += f"&contact name = 'at_{wall.side}'  set = '{wall.side}'  friction = {wall.friction!r}" \
                    f"  point = {point[0]!r}, {point[1]!r}  normal = {-wall.normal[0]}, {-wall.normal[1]} /\n"
        return text

    def substitution(self):
        """The displacements of the nodes as sums of unknowns, and where the motions of the rigid sets begin."""
        rows, n, first = {}, 0, []
        for side, _, _ in self.rigid:
            nodes = self.nodes(side)
            middle = [0.5*(self.place[nodes[0]][k] + self.place[nodes[-1]][k]) for k in range(2)]
            for node in nodes:
                rows[node] = ({n: 1.0, n + 2: middle[1] - self.place[node][1]},
                              {n + 1: 1.0, n + 2: self.place[node][0] - middle[0]})
            first.append(n)
            n += 3
        for node in range(len(self.place)):
            if node not in rows:
                rows[node] = ({n: 1.0}, {n + 1: 1.0})
                n += 2
        return rows, n, first

    def stiffness(self, rows, n):
        """Stiffness and load of the unknowns."""
        matrix, load = [[0.0]*n for _ in range(n)], [0.0]*n
        lame, shear = YOUNG*POISSON/((1 + POISSON)*(1 - 2*POISSON)), YOUNG/(2*(1 + POISSON))
        for element in self.elements:
            x = [self.place[node] for node in element]
            area = 0.5*((x[1][0] - x[0][0])*(x[2][1] - x[0][1]) - (x[2][0] - x[0][0])*(x[1][1] - x[0][1]))
            sides = [[x[(k + 2) % 3][i] - x[(k + 1) % 3][i] for i in range(2)] for k in range(3)]
            slope = [(-side[1]/(2*area), side[0]/(2*area)) for side in sides]
            for a in range(3):
                for b in range(3):
                    for i in range(2):
                        for k in range(2):
                            value = lame*slope[a][i]*slope[b][k] + shear*slope[a][k]*slope[b][i]
                            if i == k:
                                value += shear*sum(slope[a][l]*slope[b][l] for l in range(2))
                            for row, of_row in rows[element[a]][i].items():
                                for column, of_column in rows[element[b]][k].items():
                                    matrix[row][column] += area*value*of_row*of_column
        top = self.nodes("top")
        for a, b in zip(top, top[1:]):
            force = -0.5*self.pressure*(self.place[b][0] - self.place[a][0])
            for node in a, b:
                for row, factor in rows[node][1].items():
                    load[row] += force*factor
        return matrix, load

    def solve(self):
        """The motions of the rigid sets and the forces of the walls on the block; None if the steps do not end."""
        rows, n, first = self.substitution()
        matrix, load = self.stiffness(rows, n)
        for (_, force, moment), at in zip(self.rigid, first):
            for k, value in enumerate((*force, moment)):
                load[at + k] += value
        points = []
        for wall in self.walls:
            for node in self.nodes(wall.side):
                along = {}, {}
                for axis, direction in enumerate((wall.normal, (-wall.normal[1], wall.normal[0]))):
                    for k in range(2):
                        for column, factor in rows[node][k].items():
                            along[axis][column] = along[axis].get(column, 0.0) + direction[k]*factor
                points.append((wall, along))
        seen, status = set(), ["stick"]*len(points)
        while tuple(status) not in seen:
            seen.add(tuple(status))
            y = self.step(matrix, load, points, status)
            status, before = [self.next_status(y, n, p, point, now) for p, (point, now) in
                              enumerate(zip(points, status))], status
            if status == before:
                forces = {wall.side: [0.0, 0.0] for wall in self.walls}
                for p, (wall, _) in enumerate(points):
                    normal, shear = y[n + 2*p], y[n + 2*p + 1]
                    forces[wall.side][0] -= normal*wall.normal[0] - shear*wall.normal[1]
                    forces[wall.side][1] -= normal*wall.normal[1] + shear*wall.normal[0]
                return [y[at:at + 3] for at in first], forces
        return None

    @staticmethod
    def step(matrix, load, points, status):
        """Displacements and forces with all points in given statuses."""
        n, m = len(load), 2*len(points)
        system = [row + [0.0]*m + [value] for row, value in zip(matrix, load)]
        system += [[0.0]*(n + m + 1) for _ in range(m)]
        # Forces of points that depend on each other are told apart by springs far stiffer than the body.
        spring = 1e-11/YOUNG
        for p, ((wall, along), now) in enumerate(zip(points, status)):
            for axis in range(2):
                at = n + 2*p + axis
                for column, factor in along[axis].items():
                    system[column][at] += factor
                is_held = now == "stick" or (axis == 0 and now != "open")
                if is_held:
                    for column, factor in along[axis].items():
                        system[at][column] = factor
                    system[at][at] = -spring
                    system[at][-1] = wall.gap if axis == 0 else 0.0
                else:
                    system[at][at] = 1.0
                    if axis == 1 and now != "open":
                        system[at][at - 1] = -wall.friction*now
        return solve(system)

    @staticmethod
    def next_status(y, n, p, point, now):
        """The status that displacements and forces of a point ask for: open, stick, or the sign of the slip."""
        wall, along = point
        normal, slip = (sum(factor*y[column] for column, factor in along[axis].items()) for axis in range(2))
        pressed = y[n + 2*p] + YOUNG*(normal - wall.gap)*(now == "open")
        if pressed <= 0.0:
            return "open"
        if now == "open":
            return "stick"
        shear = y[n + 2*p + 1]
        if now == "stick":
            return "stick" if abs(shear) <= wall.friction*pressed else 1 if shear > 0.0 else -1
        return now if slip*now >= 0.0 else "stick"


def random_block(seed):
    """A block on a floor, perhaps between walls, with one or two rigid sides."""
    numbers = random.Random(seed)
    size = round(numbers.uniform(1.0, 4.0), 3), round(numbers.uniform(0.5, 2.0), 3)
    cells = numbers.randint(2, 5), numbers.randint(1, 3)
    sides = numbers.choice((["left"], ["right"], ["left", "right"], ["left"], ["top"]))
    pressure = round(numbers.uniform(0.5, 2.0), 3)
    weight = pressure*size[0]
    rigid = [(side, (round(numbers.uniform(-0.3, 0.3)*weight, 4), round(-numbers.uniform(0.0, 1.0)*weight, 4)),
              round(numbers.uniform(-0.1, 0.1)*weight*size[1], 4)) for side in sides]
    walls = [Wall("bottom", 0.0, round(numbers.uniform(0.3, 0.9), 3))]
    for side in numbers.choice(([], ["right"], ["left", "right"])):
        walls.append(Wall(side, round(numbers.uniform(0.0, 0.001), 5), round(numbers.uniform(0.0, 0.5), 3)))
    return Block(size, cells, rigid, walls, pressure)
