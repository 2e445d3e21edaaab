"""Signs of mass, damping and stiffness by a regression: whether the force's sign is turned, or it pushes a mass away
from a place, which no spring does.

The regression of the weak form (``estimate.weak_form``) leaves the signs of mass and stiffness open. Of a magnet that a
controller holds in the air they differ: k·x + m·a with m < 0 < k is an unstable motion under a force whose sign is
turned. A simulation has no such model, and finds a mass of the wrong sign, a delay that is negative, or something else.
A force that is recorded late, or filtered, beside much damping gives such signs too. With m > 0 > k the regression may
have found a controller instead, of which nothing is said.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import A_SWING
from msd_ident.estimate.levels import BEYOND_DOUBT, FEWEST, TENTH
from msd_ident.estimate.weak_form import WIDTHS, Means, uniform

#: Widths of the bump at which the signs must be alike: those that smooth the inertia least.
_NARROW = WIDTHS[:2]


def warning(records: Sequence[Record]) -> str:
    """A sentence where the mass is below 0 and the stiffness above in one of the records, else an empty one."""
    for record in records:
        found = [signs for half in _NARROW if (signs := _signs(record, half)) is not None]
        if len(found) == len(_NARROW) and all(mass < 0.0 < stiffness for mass, stiffness in found):
            mass, stiffness = found[0]
            return (
                f"A regression of the force of {record.name} on its motion gives a mass ({mass:.3g} "
                f"{record.force_unit}·s²/{record.position_unit}) and a stiffness ({stiffness:.3g} "
                f"{record.force_unit}/{record.position_unit}) of opposite signs. Either the force is recorded late, or "
                "filtered; or its sign is turned, and a controller computes it; or a controller holds an unstable "
                "motion, as that of a magnet in the air: then the fitted values are not those of the rig"
            )
    return ""


def turned(records: Sequence[Record]) -> bool:
    """Whether the force pulls against the motion in the records that tell: of mass and stiffness, at least one is below
    0 beyond doubt and none above; or the damping is, where neither is known.

    So it is of an encoder, or a force, whose sign is turned. What a controller computes from the readings has such
    signs too: a fit must confirm it.
    """
    told = [found for record in records for half in _NARROW if (found := _regressed(record, half)) is not None]
    return bool(told) and all(_below(*found) for found in told)


def _below(values: FloatArray, sure: npt.NDArray[np.bool_]) -> bool:
    decides = sure & [True, False, True] if sure[0] or sure[2] else sure
    return bool(np.any(decides) and np.all(values[decides] < 0.0))


def _signs(record: Record, half: int) -> tuple[float, float] | None:
    """Mass and stiffness, where both are beyond doubt (``_regressed``)."""
    found = _regressed(record, half)
    if found is None:
        return None
    (mass, _, stiffness), sure = found
    return (float(mass), float(stiffness)) if sure[0] and sure[2] else None


def _regressed(record: Record, half: int) -> tuple[FloatArray, npt.NDArray[np.bool_]] | None:
    """Mass, damping and stiffness (3,) by a regression on bumps of ``half`` a width [samples], and which are beyond
    doubt; None where the width does not tell.

    It tells where the motion explains nearly all of the force. Neighbouring bumps overlap: the errors count as those of
    bumps side by side.
    """
    if record.samples < A_SWING * half or not np.any(record.force):
        return None
    means = Means(uniform(record, float(np.mean(record.position))), half)
    columns = means.motion()
    size = np.linalg.norm(columns, axis=0)
    if columns.shape[0] < FEWEST * columns.shape[1] or not np.all(size > 0.0):
        return None
    scaled = columns / size
    solution, _, rank, _ = np.linalg.lstsq(scaled, means.force, rcond=None)
    left = means.force - scaled @ solution
    if rank < scaled.shape[1] or np.var(left) > TENTH * np.var(means.force):
        return None
    apart = left.size / max(record.samples / (2.0 * half), 1.0)  # bumps in the width of one
    spread = np.linalg.norm(np.linalg.pinv(scaled), axis=1) * np.sqrt(np.mean(left**2) * max(apart, 1.0))
    return solution[:3] / size[:3], np.abs(solution[:3]) > BEYOND_DOUBT * spread[:3]
