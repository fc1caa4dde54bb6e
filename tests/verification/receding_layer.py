"""The receding contact of an elastic layer on a half plane, by a singular integral equation."""
from math import cos, cosh, pi, sin, sinh, sqrt


def eliminated(rows):
    """Gauss's elimination of equations, each with its right side at its end: the sign of the determinant with the last
    column, if there are as many rows as columns, and else the solution."""
    n, sign = len(rows), 1
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        if pivot != k:
            rows[k], rows[pivot], sign = rows[pivot], rows[k], -sign
        sign = sign if rows[k][k] > 0 else -sign
        for i in range(n):
            if i != k:
                factor = rows[i][k]/rows[k][k]
                rows[i] = [a - factor*b for a, b in zip(rows[i], rows[k])]
    return sign if len(rows[0]) == n else [rows[k][n]/rows[k][k] for k in range(n)]


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

    def __init__(self, b, ratio, n=16):
        self.b, self.ratio, self.n = b, ratio, n
        # Beyond 40 the layer is a half plane to 1e-15.
        self.points = [(xi, weight*(squeeze(xi) + bend(xi) - 2), weight*(bend(xi) - squeeze(xi)))
                       for xi, weight in rule(40.0, 160)]

    def equations(self, c):
        """The integral equation at half of n places for the regular part of the pressure at half of n others, for an
        assumed half width c; and a last equation, the equilibrium of forces."""
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
            rows.append([*row, 2*self.b*sum(odd*sin(xi*self.b)/(xi*self.b) - even for xi, even, odd in sines)])
        return s, [*rows, [*(2*c*weight for weight in weights), 2*self.b]]

    def solve(self):
        """The half width, the pressure in the middle, and the root of the mean square of x under the pressure."""
        low, high = 0.5, 4.0
        at_low = eliminated(self.equations(low)[1])
        for _ in range(50):
            c = 0.5*(low + high)
            if eliminated(self.equations(c)[1]) == at_low:
                low = c
            else:
                high = c
        s, rows = self.equations(c)
        regular = eliminated(rows[:-1])
        # The middle lies between the points s and -s, and the regular part is even: a polynomial in its square.
        peak = 0.0
        for i, place in enumerate(s):
            factor = 1.0
            for other in s[:i] + s[i + 1:]:
                factor *= other**2/(other**2 - place**2)
            peak += factor*regular[i]
        moments = [weight*value for weight, value in zip(rows[-1], regular)]
        return c, peak, c*sqrt(sum(moment*place**2 for moment, place in zip(moments, s))/sum(moments))
