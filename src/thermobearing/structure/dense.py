"""A handful of equations, solved in place: compiled code here cannot call LAPACK."""

from thermobearing.core.compile import compiled
from thermobearing.core.lanes.choose import all_lanes, any_lane, no, select
from thermobearing.core.records import Floats


@compiled
def swap_rows(matrix: Floats, vector: Floats, k: int, i: int, where: bool) -> None:
    """Rows k and i change places where it is wanted."""
    for j in range(matrix.shape[0]):
        upper, lower = matrix[k, j], matrix[i, j]
        matrix[k, j], matrix[i, j] = select(where, lower, upper), select(where, upper, lower)
    upper, lower = vector[k], vector[i]
    vector[k], vector[i] = select(where, lower, upper), select(where, upper, lower)


@compiled
def solve_dense(matrix: Floats, vector: Floats) -> bool:
    """Gauss elimination with partial pivoting; `vector` becomes the solution.

    The matrix is destroyed. Returns False if it is singular.
    """
    n = matrix.shape[0]
    singular = False
    for k in range(n):
        for i in range(k + 1, n):
            larger = abs(matrix[i, k]) > abs(matrix[k, k])
            if any_lane(larger):
                swap_rows(matrix, vector, k, i, larger)
        singular = singular | (matrix[k, k] == 0.0)
        if all_lanes(singular):
            return no(singular)
        matrix[k, k] = 1.0 / matrix[k, k]
        for i in range(k + 1, n):
            ratio = matrix[i, k] * matrix[k, k]
            for j in range(k + 1, n):
                matrix[i, j] -= ratio * matrix[k, j]
            vector[i] -= ratio * vector[k]
    for k in range(n - 1, -1, -1):
        value = vector[k]
        for j in range(k + 1, n):
            value -= matrix[k, j] * vector[j]
        vector[k] = value * matrix[k, k]
    return no(singular)
