"""Loops of ``compiled``, for numba to compile: what they find, they fill in."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls, disable-error-code="untyped-decorator"

from __future__ import annotations

import numpy as np
from numba import njit


@njit(nogil=True)
def all_pole(coefficients, rows, found):
    """Direct form II, transposed: the sums have the order of scipy's, so that their rounding is the same."""
    order = coefficients.size - 1
    for row in range(rows.shape[0]):
        state = np.zeros(order + 1)
        for n in range(rows.shape[1]):
            value = state[0] + rows[row, n]
            for i in range(order):
                state[i] = state[i + 1] - coefficients[i + 1] * value
            found[row, n] = value


@njit(nogil=True)
def pole_zero(above, below, signal, found):
    """Direct form II, transposed, in the order of scipy's sums."""
    order = above.size - 1
    state = np.zeros(order + 1)
    for n in range(signal.size):
        value = signal[n]
        result = state[0] + above[0] * value
        for i in range(order):
            state[i] = state[i + 1] + value * above[i + 1] - result * below[i + 1]
        found[n] = result


@njit(nogil=True)
def ranked(signal, rank, window, found):
    """Insertion into the ordered window, from which the oldest value is taken out."""
    ordered = np.empty(window)
    for n in range(signal.size):
        last = n
        if n >= window:
            last = window - 1
            old, i = signal[n - window], 0
            while i < last and ordered[i] != old:
                i += 1
            while i < last:
                ordered[i] = ordered[i + 1]
                i += 1
        while last > 0 and ordered[last - 1] > signal[n]:
            ordered[last] = ordered[last - 1]
            last -= 1
        ordered[last] = signal[n]
        if n >= window - 1:
            found[n - window + 1] = ordered[rank]


@njit(nogil=True)
def peaks(signal, prominence, found):
    """Fill the indices of maxima that stand out, and in the last entry how many there are."""
    last, count = signal.size - 1, 0
    i = 1
    while i < last:
        if signal[i - 1] < signal[i]:
            end = i + 1
            while end < last and signal[end] == signal[i]:
                end += 1
            if signal[end] < signal[i]:
                middle = (i + end - 1) // 2
                if _prominence(signal, middle) >= prominence:
                    found[count] = middle
                    count += 1
                i = end
        i += 1
    found[-1] = count


@njit(nogil=True)
def _prominence(signal, top):
    height = signal[top]
    left = right = height
    i = top
    while i >= 0 and signal[i] <= height:
        left = min(left, signal[i])
        i -= 1
    i = top
    while i < signal.size and signal[i] <= height:
        right = min(right, signal[i])
        i += 1
    return height - max(left, right)
