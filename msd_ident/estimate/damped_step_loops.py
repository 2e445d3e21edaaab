"""Loops of ``damped_step``, for numba to compile: what they find, they fill in."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls, disable-error-code="untyped-decorator"

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(error_model="numpy")
def damped_step(matrix, gradient, levels, bounds, found):
    """Fill the step (p,), which begins as zero, and the predicted decrease (1,)."""
    damping, null = levels
    lowest, highest = bounds
    move, decrease = found
    count = gradient.size
    size, free = np.ones(count), np.ones(count, dtype=np.bool_)
    for i in range(count):
        if matrix[i, i] > 0.0:
            size[i] = math.sqrt(matrix[i, i])
    scaled, right = np.empty((count, count)), np.empty(count)
    for i in range(count):
        for j in range(count):
            scaled[i, j] = matrix[i, j] / size[i] / size[j]
        scaled[i, i] += damping
    for _ in range(count):
        for i in range(count):
            right[i] = -gradient[i] / size[i]
            for j in range(count):
                if not free[j]:
                    right[i] -= scaled[i, j] * move[j] * size[j]
        _solve(scaled, right, free, null, move)
        inside = True
        for i in range(count):
            if free[i]:
                move[i] /= size[i]
                if move[i] < lowest[i] or move[i] > highest[i]:
                    move[i] = min(max(move[i], lowest[i]), highest[i])
                    free[i] = inside = False
        if inside:
            break
    decrease[0] = 0.0
    for i in range(count):
        slope = 2.0 * gradient[i]
        for j in range(count):
            slope += matrix[i, j] * move[j]
        decrease[0] -= move[i] * slope


@njit(error_model="numpy")
def _solve(matrix, right, free, null, solution):
    """Fill the free entries of the solution, by Cholesky's method."""
    index, count = np.empty(right.size, np.int64), 0
    for i in range(right.size):
        if free[i]:
            index[count] = i
            count += 1
    factor, value = np.empty((count, count)), np.empty(count)
    for a in range(count):
        value[a] = right[index[a]]
    for a in range(count):
        for c in range(a + 1):
            element = matrix[index[a], index[c]]
            for e in range(c):
                element -= factor[a, e] * factor[c, e]
            if c < a:
                factor[a, c] = element / factor[c, c]
            else:
                factor[a, a] = math.sqrt(element) if element > null else math.inf
        for c in range(a):
            value[a] -= factor[a, c] * value[c]
        value[a] /= factor[a, a]
    for a in range(count - 1, -1, -1):
        for c in range(a + 1, count):
            value[a] -= factor[c, a] * value[c]
        value[a] /= factor[a, a]
        solution[index[a]] = value[a]
