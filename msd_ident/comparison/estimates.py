"""Every record fitted with one and the same model, so that its parameters can be compared."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import DataError
from msd_ident.estimate import FitResult, fit
from msd_ident.model import Model, Plant
from msd_ident.model.effects import by_name
from msd_ident.workflow.preparation import prepare

#: A cause belongs to the common model where it is named in this part of the records of a group.
_OFTEN = 0.5
#: Information that an open direction keeps, as a part of what its parameter's own size would be worth.
_OPEN = 1e6


@dataclass(frozen=True)
class Measured:
    """A record, where it belongs, and what its own diagnosis says.

    Attributes:
        name: of the record.
        group: value of the column that is compared by.
        record: the data.
        causes: named by its diagnosis.
        parameters: of its extended model, by name.
        fixed: names of those that were not fitted (the mass of a free decay, the stiffness of a plain axis).
        covariates: what else was measured, by name; ``amplitude`` too.
    """

    name: str
    group: str
    record: Record
    causes: tuple[str, ...]
    parameters: Mapping[str, float]
    fixed: tuple[str, ...] = ()
    covariates: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Estimate:
    """One record's parameters in the common model.

    Attributes:
        source: what it is of.
        used: the record as it was fitted.
        values, covariance: (p,) and (p, p) of the common free parameters; an open direction has a huge variance.
        fit: the whole fit.
    """

    source: Measured
    used: Record
    values: FloatArray
    covariance: FloatArray
    fit: FitResult


def structure(measured: Sequence[Measured]) -> Model:
    """The common model: what is named in most records of any group, with the median of the records' values.

    Raises:
        DataError: no record has a model.
    """
    groups = Counter(one.group for one in measured)
    named = Counter((one.group, cause) for one in measured for cause in one.causes)
    often = sorted({cause for (group, cause), count in named.items() if count >= _OFTEN * groups[group]})
    causes = _one_of_a_family(often, Counter(cause for one in measured for cause in one.causes))
    plant = [_median(measured, name) for name in ("mass", "damping", "stiffness")]
    if any(value is None for value in plant):
        raise DataError("no record has a mass, damping and stiffness; expected diagnoses that found a model")
    model: Model = Plant(*(value or 0.0 for value in plant))
    for cause in causes:
        values = {p.name: _median(measured, p.name) for p in by_name(cause).parameters}
        if all(value is not None for value in values.values()):
            model = model + by_name(cause).from_values({name: value or 0.0 for name, value in values.items()})
    return model


def _one_of_a_family(causes: Sequence[str], count: Mapping[str, int]) -> list[str]:
    """Of effects that replace each other, the one that is named most."""
    found: dict[str, str] = {}
    for cause in sorted(causes, key=lambda name: -count[name]):
        found.setdefault(by_name(cause).family or cause, cause)
    return sorted(found.values())


def _median(measured: Sequence[Measured], name: str) -> float | None:
    values = [one.parameters[name] for one in measured if name in one.parameters]
    return float(np.median(values)) if values else None


def estimate(one: Measured, model: Model, fixed: Collection[str]) -> Estimate:
    """Fit the common model to one record.

    Raises:
        DataError: the record cannot carry it.
    """
    used = prepare([one.record]).records[0]
    own = {name: one.parameters.get(name, model[name]) for name in model.names}
    start = model.with_values([own[name] for name in model.names])
    kept = {name: own[name] for name in fixed if name in model.names}
    found = fit(model, used, fixed=kept, starts=[start])
    if not found.converged:
        raise DataError(f"{one.name}: {found.message}")
    values = np.array([found.quantities[name].value for name in found.free])
    return Estimate(one, used, values, _covariance(found, values), found)


def _covariance(found: FitResult, values: FloatArray) -> FloatArray:
    """The covariance, with no information along what the data leaves open."""
    covariance = np.array(found.covariance)
    for direction in found.open:
        for name in direction.names:
            if name in found.free:
                place = found.free.index(name)
                covariance[place, place] += _OPEN * max(values[place] ** 2, covariance[place, place], 1e-300)
    size = np.maximum(np.abs(values), 1e-12)
    return np.asarray(covariance + np.diag((1e-9 * size) ** 2))
