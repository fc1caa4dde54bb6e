"""The stick zone under a flat punch on a half plane with friction, from integral equations.

With forces on |x| < 1 only, p(x) even and q(x) odd, displacements over 2/E* are, but for a constant in the first,

    u_y = -1/pi int p(s) ln|x - s| ds + beta int_0^x q ds        u_x = -1/pi int q(s) ln|x - s| ds - beta int_0^x p ds

(K. L. Johnson, Contact Mechanics, 1985, section 2.5, integrated). Under the punch u_y is constant; u_x = 0 on |x| < c,
and q = mu p beyond. Whatever c is, there is a solution; that of the contact problem is the one without a singularity
of q at c. p and q are taken as constant on intervals that shrink towards c and 1, and the equations hold at their
middles.
"""
from math import log, pi, sqrt

from linear_equations import solve


def stick_zone(friction, beta, feedback=None, shortest=1e-4, growth=1.6):
    """The half width c of the stick zone. `feedback` replaces beta in u_y: 0 leaves out the effect of q on p."""
    feedback = beta if feedback is None else feedback
    low, high = 0.0, 1.0
    while high - low > 1e-4:
        c = (low + high)/2
        if shear_excess(c, friction, beta, feedback, shortest, growth) > 0:
            high = c
        else:
            low = c
    return (low + high)/2


def shear_excess(c, friction, beta, feedback, shortest, growth):
    """The excess of the shear over friction times pressure where the stick zone ends."""
    half = shrinking(c, shortest, growth)
    outer = shrinking((1 - c)/2, shortest, growth)
    places = [c - place for place in reversed(half)]
    places += [c + place for place in outer[1:]] + [1 - place for place in reversed(outer[:-1])]
    n, m = len(places) - 1, len(half) - 1  # intervals in all, and of the stick zone
    matrix = []
    for i in range(n):
        normal, tangential = [0.0]*(n + m + 2), [0.0]*(n + m + 2)
        middle = (places[i] + places[i + 1])/2
        for j in range(n):
            one, other = places[j], places[j + 1]
            right = (primitive(middle - one) - primitive(middle - other))/pi
            left = (primitive(middle + other) - primitive(middle + one))/pi
            length = max(0.0, min(middle, other) - one)
            normal[j] -= right + left
            tangential[j] -= beta*length
            column, factor = (n + j, 1.0) if j < m else (j, friction)
            normal[column] += factor*feedback*length
            tangential[column] -= factor*(right - left)
        normal[n + m] = 1.0
        matrix.append(normal)
        if i < m:
            matrix.append(tangential)
    matrix.append([b - a for a, b in zip(places, places[1:])] + [0.0]*(m + 1) + [1.0])
    solution = solve(matrix)
    return solution[n + m - 1] - friction*solution[m - 1]


def shrinking(length, shortest, growth):
    """Ends of intervals from 0 to a length, each longer by a factor than the one before."""
    ends = [0.0]
    step = shortest
    while ends[-1] < length:
        ends.append(ends[-1] + step)
        step *= growth
    return [end*length/ends[-1] for end in ends]


def primitive(x):
    """An integral of ln|x|."""
    return x*log(abs(x)) - x


def uncoupled_stick_zone(ratio):
    """The c with K(sqrt(1 - c^2))/K(c) = ratio; with beta/mu, the stick zone if the shear left the pressure alone."""
    low, high = 0.0, 1.0
    while high - low > 1e-12:
        c = (low + high)/2
        # K(k) = pi/2 over the arithmetic-geometric mean of 1 and sqrt(1 - k^2).
        if mean(1.0, sqrt(1 - c**2)) > ratio*mean(1.0, c):
            low = c
        else:
            high = c
    return c


def mean(a, b):
    """The arithmetic-geometric mean."""
    while abs(a - b) > 1e-15*a:
        a, b = (a + b)/2, sqrt(a*b)
    return a
