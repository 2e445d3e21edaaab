"""Pose a problem: which parameters of a model are free, on which records, with which sizes and bounds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from msd_ident.data.record import Record
from msd_ident.errors import UsageError
from msd_ident.estimate.bounds import bounds
from msd_ident.estimate.parameter_units import Magnitudes, magnitudes
from msd_ident.estimate.problem import Initial, Nuisance, Problem
from msd_ident.model import Model, Simulator


def build(
    model: Model,
    records: Sequence[Record],
    fixed: frozenset[str],
    nuisances: tuple[Nuisance, ...],
    typical: Magnitudes | None = None,
) -> Problem:
    """A problem in which every parameter that is not in ``fixed`` is free.

    Args:
        model: structure, and the values of the fixed parameters.
        records: the records that the parameters are fitted to.
        fixed: names of the parameters to keep.
        nuisances: initial positions, velocities and zeros to fit; all others are 0.
        typical: typical force, length and time of these records; computed if None.

    Raises:
        UsageError: a fixed name that the model does not have.
    """
    unknown = sorted(fixed - set(model.names))
    if unknown:
        raise UsageError(f"no parameter {unknown[0]!r} to fix; this model has {', '.join(model.names)}")
    free = tuple(i for i, name in enumerate(model.names) if name not in fixed)
    group = tuple(records)
    typical = typical or magnitudes(group, model["mass"])
    own = {"initial velocity": typical.length / typical.time}
    sizes = [typical.of(model.parameters[i].unit) for i in free]
    lower, upper = bounds(model, free, nuisances, typical, group)
    return Problem(
        model=model,
        records=group,
        simulators=tuple(Simulator(model, record) for record in group),
        free=free,
        nuisances=nuisances,
        initial=(Initial(),) * len(group),
        typical=typical,
        scale=np.array(sizes + [own.get(n.kind, typical.length) for n in nuisances]),
        lower=lower,
        upper=upper,
    )
