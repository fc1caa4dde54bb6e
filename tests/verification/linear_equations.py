"""Systems of linear equations."""


def solve(matrix):
    """Solves equations, each with its right-hand side behind it, by Gauss's elimination with pivots."""
    n = len(matrix)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(matrix[i][k]))
        matrix[k], matrix[pivot] = matrix[pivot], matrix[k]
        row = matrix[k]
        for i in range(k + 1, n):
            factor = matrix[i][k]/row[k]
            if factor:
                matrix[i] = matrix[i][:k + 1] + [a - factor*b for a, b in zip(matrix[i][k + 1:], row[k + 1:])]
    solution = [0.0]*n
    for k in reversed(range(n)):
        known = sum(a*x for a, x in zip(matrix[k][k + 1:n], solution[k + 1:]))
        solution[k] = (matrix[k][n] - known)/matrix[k][k]
    return solution
