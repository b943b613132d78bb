"""A handful of equations, solved in place: compiled code here cannot call LAPACK."""

from thermobearing.core.compile import compiled
from thermobearing.core.records import Floats


@compiled
def solve_dense(matrix: Floats, vector: Floats) -> bool:
    """Gauss elimination with partial pivoting; `vector` becomes the solution.

    The matrix is destroyed. Returns False if it is singular.
    """
    n = matrix.shape[0]
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if matrix[pivot, k] == 0.0:
            return False
        if pivot != k:
            for j in range(n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            vector[k], vector[pivot] = vector[pivot], vector[k]
        for i in range(k + 1, n):
            ratio = matrix[i, k] / matrix[k, k]
            for j in range(k + 1, n):
                matrix[i, j] -= ratio * matrix[k, j]
            vector[i] -= ratio * vector[k]
    for k in range(n - 1, -1, -1):
        value = vector[k]
        for j in range(k + 1, n):
            value -= matrix[k, j] * vector[j]
        vector[k] = value / matrix[k, k]
    return True
