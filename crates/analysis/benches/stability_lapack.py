"""The other side of stability.rs: the same eigenvalue problems by NumPy and SciPy, which call LAPACK.

Reads one request a line, answers one line, both JSON. A request names its work and its stack of
matrices, a file of doubles of shape [parts, matrices, rows, rows]. The answer has the seconds that
the work took inside Python and, where wanted, the eigenvalues of each matrix as [re, im, re, im, …].
"""

import json
import sys
import time
from functools import cache

import numpy as np
import scipy.linalg


@cache
def stack(file, *shape):
    return np.fromfile(file, "<f8").reshape(shape)


def numpy_stack(request):
    """All matrices in one call: no Python between them."""
    return np.linalg.eigvals(stack(*request["stack"])[0])


def scipy_each(request):
    """One call a matrix, as a program that follows one state makes them."""
    matrices = stack(*request["stack"])[0]
    return [scipy.linalg.eigvals(matrix, check_finite=False) for matrix in matrices]


def first_order(request):
    """The paper's eq. (6): twice as large, with (u, u') as unknowns; from M, C and K."""
    values = []
    for mass, damping, stiffness in zip(*stack(*request["stack"])[1:]):
        zero, one = np.zeros_like(mass), np.eye(len(mass))
        rates = np.linalg.solve(mass, np.hstack((-stiffness, -damping)))
        first = np.vstack((np.hstack((zero, one)), rates))
        values.append(scipy.linalg.eigvals(first, check_finite=False))
    return values


def waves(request):
    """Uniform sliding of equal modules: for each wave exp(2 pi i k j / n) eq. (6) of one module,
    whose third mass keeps its contact: x4 = 0, and its row is row 3 - mu row 4."""
    count, mu = request["modules"], request["friction"]
    turns = 2j * np.pi * np.arange(count) / count
    stiffness = np.zeros((count, 4, 4), complex)
    for row, column, value in request["stiffness"]:
        stiffness[:, row, column % 4] += value * np.exp(turns * (column // 4))
    mass = np.array(request["mass"][:3])
    reduced = stiffness[:, :3, :3].copy()
    reduced[:, 2] -= mu * stiffness[:, 3, :3]
    operator = reduced / mass[:, None]
    first = np.zeros((count, 6, 6), complex)
    first[:, :3, 3:] = np.eye(3)
    first[:, 3:, :3] = -operator
    first[:, 3:, 3:] = -request["alpha"] * np.eye(3) - request["beta"] * operator
    return np.linalg.eigvals(first)


WORK = {work.__name__: work for work in (numpy_stack, scipy_each, first_order, waves)}

blas = np.show_config(mode="dicts")["Build Dependencies"]["blas"]
about = f"NumPy {np.__version__}, SciPy {scipy.__version__}, {blas['name']} {blas['version']}"
print(json.dumps({"about": about}), flush=True)
for line in sys.stdin:
    request = json.loads(line)
    start = time.perf_counter()
    values = WORK[request["work"]](request)
    answer = {"seconds": time.perf_counter() - start}
    if request["values"]:
        answer["values"] = [v.astype(complex).view(float).tolist() for v in values]
    print(json.dumps(answer), flush=True)
