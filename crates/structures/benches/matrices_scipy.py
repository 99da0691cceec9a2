"""The other side of the benchmark `matrices`: SciPy makes the brake and finds its eigenvalues.

    matrices_scipy.py make FOLDER                    writes brake.mat with the matrices M, D, G, K
    matrices_scipy.py solve FOLDER COUNT RE IM …     finds COUNT eigenvalues nearest to each shift, and prints JSON

The brake is a steel block of hexahedra with friction at 50 nodes of one face, dampers there, Rayleigh damping and gyroscopic
forces; 5,148 degrees of freedom.
"""

import json
import sys
import time

import numpy
import scipy.io
import scipy.sparse
import scipy.sparse.linalg

CELLS = (25, 10, 5)
LENGTHS = (0.20, 0.11, 0.03)
YOUNG, POISSON, DENSITY = 2.1e11, 0.3, 7850.0
CONTACTS, FRICTION, CONTACT_STIFFNESS, DAMPER, SPEED = 50, 0.6, 2e8, 5.0, 30.0


def element(sides):
    """Stiffness and mass of a brick of eight nodes, integrated at eight points."""
    corners = numpy.array([(a, b, c) for c in (-1, 1) for b in (-1, 1) for a in (-1, 1)])
    half = numpy.array(sides) / 2
    lame = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
    shear = YOUNG / 2 / (1 + POISSON)
    law = numpy.diag([2 * shear] * 3 + [shear] * 3)
    law[:3, :3] += lame
    stiffness, mass = numpy.zeros((24, 24)), numpy.zeros((24, 24))
    for point in corners / numpy.sqrt(3):
        terms = 1 + corners * point
        shapes = terms.prod(axis=1) / 8
        slopes = numpy.stack([corners[:, i] * numpy.delete(terms, i, axis=1).prod(axis=1) / 8 / half[i] for i in range(3)], axis=1)
        strains = numpy.zeros((6, 24))
        for node, (x, y, z) in enumerate(slopes):
            strains[:, 3 * node : 3 * node + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
        stiffness += strains.T @ law @ strains * half.prod()
        moves = numpy.kron(shapes, numpy.eye(3))
        mass += DENSITY * moves.T @ moves * half.prod()
    return stiffness, mass


def make(folder):
    nx, ny, nz = CELLS
    place = lambda i, j, k: i + (nx + 1) * (j + (ny + 1) * k)
    rows = []
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                nodes = [place(i + a, j + b, k + c) for c in (0, 1) for b in (0, 1) for a in (0, 1)]
                rows.append([3 * node + direction for node in nodes for direction in range(3)])
    rows = numpy.array(rows)
    size = 3 * (nx + 1) * (ny + 1) * (nz + 1)
    places = (numpy.repeat(rows, 24, axis=1).ravel(), numpy.tile(rows, (1, 24)).ravel())
    assemble = lambda part: scipy.sparse.csc_matrix((numpy.tile(part.ravel(), len(rows)), places), (size, size))
    stiffness, mass = map(assemble, element([length / cells for length, cells in zip(LENGTHS, CELLS)]))
    nodes = numpy.linspace(0, (nx + 1) * (ny + 1) - 1, CONTACTS).astype(int)
    ones = numpy.full(CONTACTS, CONTACT_STIFFNESS)
    contact = lambda row, column, values: scipy.sparse.csc_matrix((values, (3 * nodes + row, 3 * nodes + column)), (size, size))
    stiffness = stiffness + contact(2, 2, ones) + contact(0, 2, FRICTION * ones)
    dampers = contact(0, 0, numpy.full(CONTACTS, DAMPER)) + contact(1, 1, numpy.full(CONTACTS, DAMPER))
    damping = mass + 2e-8 * stiffness + dampers
    lumps = 2 * SPEED * numpy.asarray(mass.sum(axis=1)).ravel()[::3]
    x = numpy.arange(0, size, 3)
    gyroscopic = scipy.sparse.csc_matrix(
        (numpy.concatenate([-lumps, lumps]), (numpy.concatenate([x, x + 1]), numpy.concatenate([x + 1, x]))), (size, size)
    )
    scipy.io.savemat(f"{folder}/brake.mat", {"M": mass, "D": damping, "G": gyroscopic, "K": stiffness})


def solve(folder, count, shifts):
    parts = scipy.io.loadmat(f"{folder}/brake.mat")
    mass, damping, stiffness = parts["M"].tocsr(), (parts["D"] + parts["G"]).tocsr(), parts["K"].tocsr()
    size = mass.shape[0]
    times, values = {}, []
    # The two orders of elimination of SuperLU that may suit; the quicker one counts.
    for order in ("COLAMD", "MMD_AT_PLUS_A"):
        values = []
        begun = time.perf_counter()
        for shift in shifts:
            factors = scipy.sparse.linalg.splu((shift * shift * mass + shift * damping + stiffness).tocsc(), permc_spec=order)
            scale = abs(shift)

            def apply(state):
                x, v = state[:size], state[size:]
                y = factors.solve(-(mass @ (scale * v + shift * x)) - damping @ x)
                return numpy.concatenate([y, (x + shift * y) / scale])

            operator = scipy.sparse.linalg.LinearOperator((2 * size, 2 * size), apply, dtype=complex)
            start = numpy.random.default_rng(0).standard_normal(2 * size) + 0j
            found = scipy.sparse.linalg.eigs(operator, k=count, which="LM", v0=start, return_eigenvectors=True)[0]
            values += [[value.real, value.imag] for value in shift + 1 / found]
        times[order] = time.perf_counter() - begun
    print(json.dumps({"seconds": times, "values": values}))


if __name__ == "__main__":
    work, folder, *rest = sys.argv[1:]
    if work == "make":
        make(folder)
    else:
        numbers = [float(word) for word in rest[1:]]
        solve(folder, int(rest[0]), [complex(*pair) for pair in zip(numbers[::2], numbers[1::2])])
