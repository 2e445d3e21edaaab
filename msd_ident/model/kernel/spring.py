"""The spring's characteristic as straight pieces: linear spring, backlash, end stops and bends."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

import numpy as np

from msd_ident.model.kernel.compiled import lean, making


@making
def characteristic(k, gap, knees):
    """Pieces of the spring force c(x) = intercept + slope x.

    Args:
        k: stiffness [N/m] of the linear spring, which acts beyond ``gap`` [m] either side of 0.
        knees: (n, 3) of stops and bends: position [m], further stiffness [N/m] beyond it, and the side beyond it (±1).

    Returns:
        (edges, springs): piece i lies between edges[i] and edges[i + 1], the outer edges are infinite; springs[:, i] is
        its slope, intercept, slope and intercept of the linear spring without the stops, and a place [m] within it.
    """
    edges = np.empty(knees.shape[0] + 4)
    edges[0] = -np.inf
    count = 1
    if gap > 0.0 and k != 0.0:
        count = _with_edge(_with_edge(1, edges, -gap), edges, gap)
    for n in range(knees.shape[0]):
        if knees[n, 1] != 0.0:
            count = _with_edge(count, edges, knees[n, 0])
    edges[count] = np.inf
    springs = np.empty((5, count))
    for i in range(count):
        own_slope, own_intercept = _beyond(k, gap, edges[i], edges[i + 1])
        more, shift = 0.0, 0.0
        for n in range(knees.shape[0]):
            place, stiffness, side = knees[n, 0], knees[n, 1], knees[n, 2]
            if abs(place) < np.inf and ((side > 0.0 and edges[i] >= place) or (side < 0.0 and edges[i + 1] <= place)):
                more, shift = more + stiffness, shift - stiffness * place
        springs[0, i], springs[1, i] = own_slope + more, own_intercept + shift
        springs[2, i], springs[3, i], springs[4, i] = own_slope, own_intercept, _within(edges[i], edges[i + 1])
    return edges[: count + 1], springs


@lean
def _with_edge(count, edges, edge):
    """Number of edges, in rising order from −∞ on, after one more that is finite and new found its place."""
    i = count
    while edges[i - 1] > edge:
        i -= 1
    if not abs(edge) < np.inf or edges[i - 1] == edge:
        return count
    for j in range(count, i, -1):  # sorting them all would take three seconds more to compile
        edges[j] = edges[j - 1]
    edges[i] = edge
    return count + 1


@lean
def _within(low, high):
    """A place between low and high."""
    if low > -np.inf and high < np.inf:
        return 0.5 * (low + high)
    if low > -np.inf:
        return low + (1.0 + abs(low))
    return high - (1.0 + abs(high)) if high < np.inf else 0.0


@lean
def _beyond(k, edge, low, high):
    """(slope, intercept) between low and high of a spring that acts beyond ``edge`` either side of 0."""
    if edge == 0.0:
        return k, 0.0
    if low >= edge:
        return k, -k * edge
    if high <= -edge:
        return k, k * edge
    return 0.0, 0.0


@lean
def piece(edges, x, direction):
    """Piece that a motion from x in ``direction`` (-1, 0, 1) goes through."""
    i = 0
    while i < edges.size - 2 and (x > edges[i + 1] or (x == edges[i + 1] and direction > 0)):
        i += 1
    return i
