"""Whether a positive force moves the encoder downwards, by fits of records with the force as it is, and turned."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.data.record import Record
from msd_ident.estimate import FitResult
from msd_ident.estimate.base_fits import joint_fit
from msd_ident.estimate.explained import LEAST, explained_variance
from msd_ident.estimate.levels import MOST_OF
from msd_ident.estimate.single_tone import common_tone
from msd_ident.workflow.starting_plant import typical_plant


def leaves_less(as_it_is: Sequence[Record], turned: Sequence[Record]) -> bool:
    """Whether with the force turned a plant with dry friction leaves the smaller error.

    Args:
        as_it_is: driven records.
        turned: the same with the force turned.
    """
    return _fitted(turned, sprung=True).see < _fitted(as_it_is, sprung=True).see


def leaves_far_less(as_it_is: Sequence[Record], turned: Sequence[Record], *, asked: bool) -> bool:
    """Whether with the force turned a plant with dry friction, on a spring or without, leaves less than half the error
    of either with the force as it is.

    Where no regression asks, the fits decide alone: then the force turned must show a mass, and the force as it is
    none, with a spring or without. Measured: of five axes without a spring, read upright and inverted, all upright ones
    showed a mass and no inverted one; of a pendulum whose motor turns a wheel on it, the force as it is gave a mass of
    5.1 ± 9.4, and left all of the motion; of another one 1.4 ± 0.6, and left 88 %. Under a single tone a mass alone
    does with the force turned what a spring does with the force as it is: there a regression must ask, and a spring
    acts.

    Args:
        as_it_is: driven records; False where there are none.
        turned: the same with the force turned.
        asked: whether a regression says so (``estimate.opposite_signs``).
    """
    one_tone = bool(as_it_is) and common_tone(as_it_is) > 0.0
    if not as_it_is or (one_tone and not asked):
        return False
    structures = (True,) if one_tone else (True, False)
    upright = []
    for sprung in structures:
        upright.append(_fitted(as_it_is, sprung))
        if not asked and _shows_mass(upright[-1], as_it_is):
            return False
    least = min(fitted.see for fitted in upright)
    other = [_fitted(turned, sprung) for sprung in structures]
    return any(one.see < MOST_OF * least and (asked or _shows_mass(one, turned)) for one in other)


def _shows_mass(found: FitResult, records: Sequence[Record]) -> bool:
    """Whether a fit that carries the records knows their mass."""
    mass = found.quantities["mass"]
    return mass.known and mass.low > 0.0 and explained_variance(found.residuals, records) > LEAST


def _fitted(records: Sequence[Record], sprung: bool) -> FitResult:
    fixed = {} if sprung else {"stiffness": 0.0}
    return joint_fit(tuple(records), typical_plant(records[0]), sprung, fixed)
