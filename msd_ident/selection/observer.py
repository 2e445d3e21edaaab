"""Fits through an observer: the readings draw the simulated cart to them, less and less.

Where a cart sticks and slips, the simulation error has many narrow minima. A cart that rests at one place too long is
elsewhere ever after, and no small step of a parameter mends that. A spring κ and a damper c between the simulated cart
and the measured one make it forget such an error. The error e of the position is then smooth in the parameters:

    m e″ + (b + c) e′ + (k + κ) e = missing force

So a search gets to the minimum from almost anywhere. Spring and damper are taken away in steps. Each fit begins where
the last one ended, and the last one is that of the plain simulation error.

Sources: C. P. Vyasarayani, T. Uchida, A. Carvalho and J. McPhee 2011, Multibody Syst. Dyn. 26, p. 411 (homotopy);
H. D. I. Abarbanel et al. 2009, SIAM J. Appl. Dyn. Syst. 8 (synchronisation with data).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from msd_ident.data.local_polynomial import local_polynomial
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.levels import TENTH
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.model.effects import typical
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import refine

#: The observers, the strongest first: spring in parts of the plant's, and damping ratio with it. Of 45 drawn rigs with
#: a breakaway friction of 2 to 5 times the sliding one, gone at 4 to 30 mm/s, a fit from 6 guesses ends at the truth
#: for none, and through these observers for 40 (`python -m bench.stiction`).
_OBSERVERS = ((1.0 / TENTH, 1.0), (1.0, 1.0), (0.0, 1.0), (0.0, TENTH))


def can_follow(model: Model) -> bool:
    """Whether a model's cart may stick, and an observer can pull it.

    The force and the readings must be those of the cart, and no law may take the observer's spring for the plant's.
    """
    sticks = any(effect.holding for effect in model.effects)
    return sticks and all(effect.acts_on == "force" and not effect.needs_spring for effect in model.effects)


def followed(experiment: Experiment, causes: Causes, models: Sequence[Model], initial: Sequence[Initial]) -> Hypothesis:
    """A set fitted through observers, at last by its plain simulation error.

    Args:
        experiment: readings with their weights.
        causes: names of the set; see ``can_follow``.
        models: starting points, at least one. The one that the strongest observer leaves nearest to the readings is
            followed.
        initial: initial state of each record to start from.
    """
    strongest, *weaker = _OBSERVERS
    tried = (_drawn(experiment, causes, (model, initial), strongest) for model in models)
    _, start = min(tried, key=lambda one: one[0])
    for observer in weaker:
        _, start = _drawn(experiment, causes, start, observer)
    return refine(experiment, causes, *start)


#: Values, and the initial state of each record.
_Start = tuple[Model, Sequence[Initial]]


def _drawn(
    experiment: Experiment, causes: Causes, start: _Start, observer: tuple[float, float]
) -> tuple[float, _Start]:
    """Chi² and end of a fit with one observer."""
    (model, initial), (spring, ratio) = start, observer
    base = experiment.base
    swing = max(typical.natural_frequency(record, base) for record in experiment.records)
    stiffness = spring * base.mass * swing**2
    damping = 2.0 * ratio * base.mass * swing * math.sqrt(1.0 + spring)
    readings = tuple(
        replace(part, record=_pulled(part.record, one.zero, stiffness, damping, swing))
        for part, one in zip(experiment.readings, initial, strict=True)
    )
    pulled = replace(experiment, readings=readings, base=_held(base, stiffness, damping))
    found = refine(pulled, causes, _held(model, stiffness, damping), initial)
    return found.chi, (_held(found.model, -stiffness, -damping), found.initial)


def _held(model: Model, stiffness: float, damping: float) -> Model:
    """The model with a spring [N/m] and a damper [N·s/m] beside its own, or without them."""
    return replace(model, damping=max(model.damping + damping, 0.0), stiffness=max(model.stiffness + stiffness, 0.0))


def _pulled(record: Record, zero: float, stiffness: float, damping: float, swing: float) -> Record:
    """The record with the force of a spring [N/m] and a damper [N·s/m] that pull towards its readings."""
    place, speed = _moved(record, 2.0 * np.pi / swing)
    stamps = np.union1d(record.time, record.force_time)
    # A force that is held acts on average half a sample later than its stamp.
    at = stamps + (0.5 * np.diff(stamps, append=stamps[-1]) if record.hold == "zero" else 0.0)
    pull = stiffness * (np.interp(at, record.time, place) - zero) + damping * np.interp(at, record.time, speed)
    return replace(record, force_time=stamps, force=record.force_at(stamps) + pull)


def _moved(record: Record, period: float) -> tuple[FloatArray, FloatArray]:
    """Smoothed position (n,) [m] and speed (n,) [m/s] at the stamps of a record that swings with a period [s]."""
    grid = np.linspace(record.time[0], record.time[-1], record.samples)
    step = float(grid[1] - grid[0])
    even = np.interp(grid, record.time, record.position)
    window = min(max(int(TENTH * period / step) // 2 * 2 + 1, 7), (record.samples - 1) // 2 * 2 + 1)
    place, speed = (local_polynomial(even, window, 3, order, step) for order in (0, 1))
    return np.interp(record.time, grid, place), np.interp(record.time, grid, speed)
