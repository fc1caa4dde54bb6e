"""The receding contact of an elastic layer on a half plane, by a singular integral equation."""
from math import cos, cosh, pi, sin, sinh, sqrt

from linear_equations import solve


def squeeze(xi):
    """What a layer of height 1, squeezed by p cos(xi x) on both faces, gives way by, over what a half plane does."""
    if xi > 30:
        return 1.0
    return 2*sinh(xi/2)**2/(sinh(xi) + xi)


def bend(xi):
    """The same under p cos(xi x) on one face and -p cos(xi x) on the other."""
    if xi > 30:
        return 1.0
    # sinh(xi) - xi, from its series where the difference would lose digits.
    difference, term, k = 0.0, xi, 1
    while abs(term) > 1e-18*abs(difference) or k == 1:
        k += 2
        term *= xi*xi/((k - 1)*k)
        difference += term
    return 2*cosh(xi/2)**2/difference


def rule(end, parts):
    """Points and weights on 0 to end: Gauss's rule of 3 points on equal parts."""
    step = end/parts
    return [(step*(k + 0.5 + place*0.5), weight*step/2) for k in range(parts)
            for place, weight in ((-sqrt(0.6), 5/9), (0.0, 8/9), (sqrt(0.6), 5/9))]


class Layer:
    """A layer of height 1 under a pressure of 1 on |x| < b, on a half plane; ratio is E*/E* of layer and half plane."""

    def __init__(self, b, ratio, n=32):
        self.b, self.ratio, self.n = b, ratio, n
        # Beyond 40 the layer is a half plane to 1e-15.
        self.points = [(xi, weight*(squeeze(xi) + bend(xi) - 2), weight*(bend(xi) - squeeze(xi)))
                       for xi, weight in rule(40.0, 160)]

    def pressed(self, c):
        """The integral equation at half of n places, and the equilibrium of a contact force of 2 b, for an assumed half
        width c: half of n other places, the regular part of the pressure there, the force that belongs to it, and
        what the pressure on the layer must be, which is 1 for one c only."""
        n, half = self.n, self.n//2
        s = [cos(pi*i/(n + 1)) for i in range(1, half + 1)]
        weights = [pi*(1 - place**2)/(n + 1) for place in s]
        rows = []
        for k in range(1, half + 1):
            r = cos(pi*(2*k - 1)/(2*(n + 1)))
            sines = [(xi, even*sin(xi*c*r), odd*sin(xi*c*r)) for xi, even, odd in self.points]
            row = []
            for place, weight in zip(s, weights):
                kernel = sum(even*(cos(xi*c*place) - 1) for xi, even, _ in sines)
                row.append(weight*((2 + 2*self.ratio)*(1/(r - place) + 1/(r + place)) + 2*c*kernel))
            load = 2*self.b*sum(odd*sin(xi*self.b)/(xi*self.b) - even for xi, even, odd in sines)
            rows.append([*row, -load, 0.0])
        *regular, load = solve([*rows, [*(2*c*weight for weight in weights), 0.0, 2*self.b]])
        return s, regular, [weight*value for weight, value in zip(weights, regular)], load

    def solve(self):
        """The half width, the pressure in the middle, and the root of the mean square of x under the pressure."""
        low, high = 0.5, 4.0
        for _ in range(50):
            c = 0.5*(low + high)
            s, regular, forces, load = self.pressed(c)
            if load < 1:
                low = c
            else:
                high = c
        # The middle lies between the points s and -s, and the regular part is even: a polynomial in its square.
        peak = 0.0
        for i, place in enumerate(s):
            factor = 1.0
            for other in s[:i] + s[i + 1:]:
                factor *= other**2/(other**2 - place**2)
            peak += factor*regular[i]
        return c, peak, c*sqrt(sum(force*place**2 for force, place in zip(forces, s))/sum(forces))
