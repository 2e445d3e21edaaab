"""The two fits that identification and diagnosis start from: the plant with Coulomb friction, and the linear model.

``identify`` reports them and ``diagnose`` starts from them, so that neither ends with a worse fit than the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from msd_ident.data.record import Record
from msd_ident.estimate.fitting import fit
from msd_ident.estimate.formulation import Zero
from msd_ident.estimate.objective import Loss
from msd_ident.estimate.result import FitResult
from msd_ident.model import Model
from msd_ident.model.base_model import DRY_FRICTION, OFFSET, PLANT, DryFriction, Offset


@dataclass(frozen=True)
class Shared:
    """Both fits of one experiment.

    Attributes:
        joint: m, b, k and Coulomb friction; on an axis without a spring also a force offset.
        linear: m, b and k alone.
    """

    joint: FitResult
    linear: FitResult


def structure(plant: Model, sprung: bool) -> Model:
    """Model of the joint fit: the plant with Coulomb friction, and without a spring also a force offset.

    Args:
        plant: starting values of m, b and k.
        sprung: whether a spring acts. Without one no zero is fitted, and the offset takes its place.

    Returns:
        The model; friction and offset start at 0 N.
    """
    rubbing = plant + DryFriction(0.0)
    return rubbing if sprung else rubbing + Offset(0.0)


def joint_fit(
    records: tuple[Record, ...], plant: Model, sprung: bool, fixed: Mapping[str, float], loss: Loss = "linear"
) -> FitResult:
    """All parameters of plant and Coulomb friction by simulation error.

    Args:
        records: one experiment.
        plant: where to start from.
        sprung: whether a spring acts; without one its stiffness stands in ``fixed`` as 0.
        fixed: parameters that keep these values, by name.
        loss: as in ``fit``.
    """
    zero: Zero = "free" if sprung else "known"
    return fit(structure(plant, sprung), records, fixed=fixed, zero=zero, loss=loss)


def linear_fit(records: tuple[Record, ...], joint: FitResult, loss: Loss = "linear") -> FitResult:
    """Fit of the linear model (m, b, k) by simulation error.

    Two fits are made, one that only refines the values of the joint fit and one with all starts; the one with the
    smaller SEE is returned.

    Args:
        records: the records of the joint fit.
        joint: the fit with Coulomb friction. Plant parameters that were fixed in it keep their values here.
        loss: as in ``fit``.
    """
    start = joint.model.without(DRY_FRICTION, OFFSET)
    fixed = {name: joint.model[name] for name in PLANT if name not in joint.free}
    near = fit(start, records, fixed=fixed, loss=loss, search="near")
    wide = fit(start, records, fixed=fixed, loss=loss)
    return min(near, wide, key=lambda found: found.see)
