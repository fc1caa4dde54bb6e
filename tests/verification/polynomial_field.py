"""Displacements of plane strain that are polynomials and carry no body force, from what is known of them on y = 0."""


class PolynomialField:
    """The only such field with u_y = 0 and given u_x, shear stress xy and normal stress yy on y = 0.

    With u = sum of a_k(x) y^k and v = sum of b_k(x) y^k, the equations of equilibrium give a_(k+2) and b_(k+2) from
    the coefficients below, and end after some steps since each of them differentiates the given polynomials.
    Polynomials in x are lists of coefficients, the constant first.
    """

    def __init__(self, young, poisson, u_x, shear, normal):
        mu = young/(2*(1 + poisson))
        first = young*poisson/((1 + poisson)*(1 - 2*poisson))
        a = [u_x, scaled(shear, 1/mu)]
        b = [[], scaled(added(normal, scaled(derivative(u_x), -first)), 1/(first + 2*mu))]
        while any(a[-1]) or any(b[-1]) or any(a[-2]) or any(b[-2]):
            k = len(a) - 2
            factor = -1/((k + 1)*(k + 2))
            next_a = added(scaled(second(a[k]), (first + 2*mu)*factor/mu),
                           scaled(derivative(b[k + 1]), (first + mu)*(k + 1)*factor/mu))
            next_b = added(scaled(second(b[k]), mu*factor/(first + 2*mu)),
                           scaled(derivative(a[k + 1]), (first + mu)*(k + 1)*factor/(first + 2*mu)))
            a.append(next_a)
            b.append(next_b)
        self.rows = a, b

    def __call__(self, x, y):
        """The displacement at a point."""
        return tuple(value([value(row, x) for row in rows], y) for rows in self.rows)


def value(polynomial, x):
    """The value of a polynomial."""
    result = 0.0
    for coefficient in reversed(polynomial):
        result = result*x + coefficient
    return result


def derivative(polynomial):
    """The derivative of a polynomial."""
    return [power*coefficient for power, coefficient in enumerate(polynomial)][1:]


def second(polynomial):
    """The second derivative of a polynomial."""
    return derivative(derivative(polynomial))


def scaled(polynomial, factor):
    """A multiple of a polynomial."""
    return [factor*coefficient for coefficient in polynomial]


def added(first, other):
    """The sum of two polynomials."""
    length = max(len(first), len(other))
    return [a + b for a, b in zip(first + [0.0]*(length - len(first)), other + [0.0]*(length - len(other)))]
