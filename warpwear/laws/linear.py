"""Linear systems are solved in one order of operations, whatever the threads of BLAS and LAPACK.

What enters a run is solved here: from some hundred unknowns on, LAPACK shares its sums among threads, and
their last digits would depend on how many there are.
"""

import numpy as np

from warpwear.grid import FloatArray


def solve(matrix: FloatArray, right: FloatArray, *, rcond: float = 1e-15) -> FloatArray:
    """Return x, shape (n, m), of matrix · x = right, shape (n, m), by Cholesky's method with diagonal pivots.

    matrix: symmetric without negative eigenvalues, shape (n, n). Unknowns whose pivots are less than rcond
    times the largest are not told from the others by the equations, and are 0.
    """
    count = len(matrix)
    known = np.hstack([matrix, right])
    factor = np.zeros_like(known)  # its rows, and beside them the right sides on their way
    rest = matrix.diagonal().copy()
    least, order = rcond * float(rest.max()), list[int]()
    while len(order) < count and not rest.max() <= least:  # what is not a number goes on into x
        row, pivot = len(order), int(rest.argmax())
        along = known[pivot] - np.einsum("ki,k->i", factor[:row], factor[:row, pivot])
        factor[row] = along / np.sqrt(rest[pivot])  # above the least, whatever the rounding of along
        rest -= np.square(factor[row, :count])
        order.append(pivot)
        rest[pivot] = -np.inf
    upper, solution = factor[:, order], factor[: len(order), count:]
    for row in reversed(range(len(order))):
        solution[row] -= np.einsum("k,km->m", upper[row, row + 1 :], solution[row + 1 :])
        solution[row] /= upper[row, row]
    x = np.zeros((count, right.shape[1]))
    x[order] = solution
    return x


def least_squares(design: FloatArray, values: FloatArray) -> FloatArray:
    """Return the coefficients, shape (k,), with which k columns come nearest to values, shape (n,).

    design: the columns, shape (n, k), scaled to about 1.
    """
    matrix, right = np.einsum("ni,nj->ij", design, design), np.einsum("ni,n->i", design, values)
    return solve(matrix, right[:, np.newaxis])[:, 0]
