"""Whether a model carries a record at all: what part of the position's variance it explains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import DataError
from msd_ident.estimate.levels import MOST_OF

#: Part of the variance below which parameters mean nothing. The joint fit (m, b, k, Fc) explains 0.977 or more
#: of measured rigs, 0.62 or more of drawn ones with one effect at up to three times the usual strength (0.21 and 0.18
#: with a second mode that swings alone under a step or a release), 0.005 to 0.53 of 15 joints in 16 that a hand moved.
LEAST = MOST_OF


def explained_variance(residuals: Sequence[FloatArray], records: Sequence[Record]) -> float:
    """Share of the position's variance that a model explains.

    1 − (sum of squares of the residuals) / (sum of squares of the positions about each record's mean). The share is
    negative when the model is worse than a constant.

    Args:
        residuals: one (n,) for each record [m].
        records: the records that the residuals belong to.
    """
    left = sum(float(residual @ residual) for residual in residuals)
    moved = sum(float(np.sum((record.position - np.mean(record.position)) ** 2)) for record in records)
    return 1.0 - left / moved


def check(
    residuals: Sequence[FloatArray],
    records: Sequence[Record],
    model: str,
    doubts: Sequence[str] = (),
    *,
    diagnosed: bool = False,
) -> None:
    """Refuse records that no mass-spring-damper model carries.

    Args:
        residuals: of the best model that was found, one (n,) for each record.
        records: what it was fitted to.
        model: what the model holds, in words.
        doubts: sentences on the units of the data, and on a cut, which the reader of a refusal sees nowhere else.
        diagnosed: whether other laws were looked for already.

    Raises:
        DataError: it explains less than half of the position's variance.
    """
    share = explained_variance(residuals, records)
    if share < LEAST:
        raise DataError(
            f"{model} explain {100.0 * max(share, 0.0):.0f} % of the position's variance; expected more than "
            f"{100.0 * LEAST:.0f} %, as else their values mean nothing: {_reasons(records, diagnosed)}"
            + "".join(f"; also, {doubt[0].lower()}{doubt[1:]}" for doubt in doubts)
        )


def forced(records: Sequence[Record]) -> bool:
    """Whether any force acts in one of the records."""
    return any(bool(np.any(record.force)) for record in records)


def _reasons(records: Sequence[Record], diagnosed: bool) -> str:
    """What may be the matter with records that a model does not carry, each with the next step."""
    law = "the rig may follow another law, as a pendulum does that swings far: msd diagnose looks for it"
    force = "the force may be another quantity: check --force"
    sign = "the encoder may be inverted: try a negative --position-scale"
    unstable = (
        "a controller may hold an unstable plant, which no simulation from the first sample follows: cut the record "
        "there"
    )
    hand = "a hand may have moved the cart: leave that part out with --start or --end"
    return "; or ".join([*([] if diagnosed else [law]), *([force, sign, unstable] if forced(records) else []), hand])
