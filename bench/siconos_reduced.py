"""A reduced problem (Siconos text file, dimension 2) in Siconos' own solvers. Usage: siconos_reduced.py FILE [SECONDS].

Runs the plane Gauss-Seidel and Lemke solvers, and the semismooth Newton solver of three dimensions on the same problem
with its third direction left out, each in a process of its own. Prints processor time and the residual of the result:
the largest violation of the contact law, displacements turned into forces by the diagonal of W, over the largest such
force without contact.
"""

import multiprocessing
import sys
import time

import numpy
import siconos.numerics as numerics

SOLVERS = {
    "Gauss-Seidel": "SICONOS_FRICTION_2D_NSGS",
    "Lemke": "SICONOS_FRICTION_2D_LEMKE",
    "Newton": "SICONOS_FRICTION_3D_NSN_AC",
}


def dense_problem(file):
    """W, q and mu of a dense file."""
    numbers = iter(open(file, encoding="ascii").read().split())
    dimension, contacts, storage = (int(next(numbers)) for _ in range(3))
    assert (dimension, storage) == (2, 0), "only dense plane problems are timed"
    rows, columns = int(next(numbers)), int(next(numbers))
    next(numbers), next(numbers)
    values = numpy.array([float(number) for number in numbers])
    matrix = values[: rows * columns].reshape((rows, columns), order="F")
    q = values[rows * columns : rows * columns + rows]
    return matrix, q, values[rows * columns + rows :][:contacts]


def residual(matrix, q, mu, force):
    motion = matrix @ force + q
    rho = 1.0 / numpy.diag(matrix)
    normal = numpy.maximum(0.0, force[0::2] - rho[0::2] * motion[0::2])
    bound = mu * numpy.maximum(0.0, force[0::2])
    tangential = numpy.clip(force[1::2] - rho[1::2] * motion[1::2], -bound, bound)
    violation = max(abs(force[0::2] - normal).max(), abs(force[1::2] - tangential).max())
    return violation / abs(rho * q).max()


def run(name, file, queue):
    matrix, q, mu = dense_problem(file)
    options = numerics.SolverOptions(getattr(numerics, SOLVERS[name]))
    options.dparam[numerics.SICONOS_DPARAM_TOL] = 1e-10
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = 100000
    start = time.process_time()
    if name == "Newton":
        keep = numpy.arange(3 * mu.size) % 3 < 2
        wide, force, motion = numpy.eye(3 * mu.size), numpy.zeros(3 * mu.size), numpy.zeros(3 * mu.size)
        wide[numpy.ix_(keep, keep)] = matrix
        load = numpy.zeros(3 * mu.size)
        load[keep] = q
        numerics.fc3d_driver(numerics.FrictionContactProblem(3, mu.size, wide, load, mu), force, motion, options)
        force = force[keep]
    else:
        force, motion = numpy.zeros(2 * mu.size), numpy.zeros(2 * mu.size)
        numerics.fc2d_driver(numerics.FrictionContactProblem(2, mu.size, matrix, q, mu), force, motion, options)
    seconds = time.process_time() - start
    queue.put((seconds, residual(matrix, q, mu, force)))


def main(file, limit):
    for name in SOLVERS:
        queue = multiprocessing.Queue()
        process = multiprocessing.Process(target=run, args=(name, file, queue))
        process.start()
        process.join(limit)
        if process.is_alive():
            process.kill()
            print(f"{name}: stopped after {limit:g} s")
        elif queue.empty():
            print(f"{name}: failed with status {process.exitcode}")
        else:
            print("{}: {:.2f} s, residual {:.1e}".format(name, *queue.get()))


main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 120.0)
