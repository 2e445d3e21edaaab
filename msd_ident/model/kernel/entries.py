"""The two functions of the solver that Python calls; ``model.solver`` declares them."""

# Compiled for the types that they are called with, so functions here have no annotations.
# mypy: allow-untyped-defs, allow-untyped-calls

from __future__ import annotations

from msd_ident.model.kernel import run as kernel
from msd_ident.model.kernel.compiled import making
from msd_ident.model.kernel.groups import Path


@making
def plan(given, room, sizes, largest):
    """What a record says before any parameter is known, see ``run.plan``.

    Args:
        given: stamps of the samples, stamps and values of the force, and whether it is straight between them.
        room: arrays for its parts, each with room for as many as there are samples and stamps of the force.
        sizes: (8,) filled with the sizes of the parts.
        largest: (1,) filled with the largest force [N].
    """
    time, force_time, force, straight = given
    made = kernel.plan(time, force_time, force, straight)
    start, length, kind, force_index, pick, lengths, level, slope, largest[0] = made
    sizes[0] = _copied(start, room[0])
    sizes[1] = _copied(length, room[1])
    sizes[2] = _copied(kind, room[2])
    sizes[3] = _copied(force_index, room[3])
    sizes[4] = _copied(pick, room[4])
    sizes[5] = _copied(lengths, room[5])
    sizes[6] = _copied(level, room[6])
    sizes[7] = _copied(slope, room[7])


@making
def _copied(given, room):
    for i in range(given.size):
        room[i] = given[i]
    return given.size


@making
def run(model, rows, plan, measured, out):
    """``run.row`` and ``run.compare`` for each of r rows of values.

    Args:
        model: set of effects and places of the parameters, see ``run.row``.
        out: (r, n), filled with readings or with what these miss by, and (r, n) or (r, 0), filled with velocities.
    """
    out_x, out_v = out
    for i in range(rows.shape[0]):
        kernel.row(model, rows[i], plan, measured[3:], Path(out_x[i], out_v[i]))
        kernel.compare(rows[i], measured, out_x[i])
