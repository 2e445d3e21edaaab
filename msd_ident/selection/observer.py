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
from msd_ident.data.record import LARGEST, FloatArray, Record
from msd_ident.estimate.levels import TENTH
from msd_ident.estimate.problem import Initial, Problem
from msd_ident.model import Model, Simulator
from msd_ident.selection.experiment import Experiment, formulated, weigh
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import descended, refine_near
from msd_ident.tuning import tuned

_OBSERVERS = tuned(
    ((10.0, 1.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.1)),
    unit="1",
    why="observers, the strongest first: spring in parts of the plant's, and damping ratio with it",
    chosen="on 60 rigs with a strong breakaway friction (`python -m bench.stiction`): the truth is found for 51, from "
    "the same guesses without observers for none",
)

#: Values, and the initial state of each record.
_Start = tuple[Model, Sequence[Initial]]


def can_follow(model: Model) -> bool:
    """Whether a model's cart may stick, and an observer can pull it.

    Force and readings must be those of the cart. No law may take the observer's spring for the plant's, or its force
    for that of the drive.
    """
    sticks = any(effect.holding for effect in model.effects)
    return sticks and not any(
        effect.acts_on != "force" or effect.needs_spring or effect.asks_drive() for effect in model.effects
    )


def followed(
    experiment: Experiment, causes: Causes, models: Sequence[Model], initial: Sequence[Initial]
) -> Hypothesis | None:
    """A set fitted through observers, at last by its plain simulation error.

    Args:
        experiment: readings with their weights.
        causes: names of the set; see ``can_follow``.
        models: starting points, at least one. The one that the strongest observer leaves nearest to the readings is
            followed.
        initial: initial state of each record to start from.

    Returns:
        None where without an observer this leaves many times as much as a cart that does not move (``refine_near``).
    """
    strongest, *weaker = _OBSERVERS
    tried = (_drawn(experiment, (model, initial), strongest) for model in models)
    _, start = min(tried, key=lambda one: one[0])
    for observer in weaker:
        _, start = _drawn(experiment, start, observer)
    return refine_near(experiment, causes, *start)


def _drawn(experiment: Experiment, start: _Start, observer: tuple[float, float]) -> tuple[float, _Start]:
    """Chi² and end of a fit with one observer."""
    problem, _, point = formulated(experiment, *start)
    frequency = _frequency(experiment)
    stiffness, damping = _strength(experiment.base.mass, frequency, observer)
    added = np.array([{"stiffness": stiffness, "damping": damping}.get(name, 0.0) for name in problem.names])
    model = _held(problem.model.with_values(problem.values(point)), stiffness, damping)
    pulls = zip(problem.records, problem.initials(point), strict=True)
    records = tuple(_pulled(record, one.zero, stiffness, damping, frequency) for record, one in pulls)
    pulled: Problem = replace(
        problem,
        model=model,
        records=records,
        simulators=tuple(Simulator(model, record) for record in records),
        lower=problem.lower + added,
        upper=problem.upper + added,
    )
    state = descended(experiment, weigh(pulled, experiment.readings), point + added)
    found = model.with_values(pulled.values(state.point))
    return state.chi, (_held(found, -stiffness, -damping), pulled.initials(state.point))


def _frequency(experiment: Experiment) -> float:
    """Frequency [rad/s] of the plant, or of the motion where that is faster or no spring acts."""
    base, moves = experiment.base, (part.octaves.swings / part.record.duration for part in experiment.readings)
    return max(math.sqrt(max(base.stiffness, 0.0) / base.mass), 2.0 * math.pi * max(moves))


def _strength(mass: float, frequency: float, observer: tuple[float, float]) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N·s/m] of an observer beside a plant of a mass [kg] and a frequency [rad/s]."""
    spring, ratio = observer
    return spring * mass * frequency**2, 2.0 * ratio * mass * frequency * math.sqrt(1.0 + spring)


def _held(model: Model, stiffness: float, damping: float) -> Model:
    """The model with a spring [N/m] and a damper [N·s/m] beside its own, or without them."""
    return replace(model, damping=max(model.damping + damping, 0.0), stiffness=max(model.stiffness + stiffness, 0.0))


def _pulled(record: Record, zero: float, stiffness: float, damping: float, frequency: float) -> Record:
    """The record with the force of a spring [N/m] and a damper [N·s/m] that pull towards its readings."""
    from scipy.interpolate import CubicHermiteSpline  # imported here: a search rarely comes to this

    path = CubicHermiteSpline(record.time, *_smoothed(record, 2.0 * math.pi / frequency))
    stamps = np.union1d(record.time, record.force_time)
    at = stamps
    if record.hold == "zero":  # on average it acts half a sample later
        at = stamps + 0.5 * np.diff(stamps, append=stamps[-1])
    elif record.force_time[0] > record.time[0]:  # the force jumps there, and is no ramp
        stamps = at = np.union1d(stamps, record.force_time[0] - 1e-9 * record.duration)
    inside = np.clip(at, record.time[0], record.time[-1])
    pull = stiffness * (path(inside) - zero) + damping * path(inside, 1)
    return replace(record, force_time=stamps, force=np.clip(record.force_at(stamps) + pull, -LARGEST, LARGEST))


def _smoothed(record: Record, period: float) -> tuple[FloatArray, FloatArray]:
    """Position (n,) [m] and speed (n,) [m/s] at the stamps of a record, by cubics over a tenth of a period [s]."""
    grid = np.linspace(record.time[0], record.time[-1], record.samples)
    step = float(grid[1] - grid[0])
    even = np.interp(grid, record.time, record.position)
    window = min(max(int(TENTH * period / step) // 2 * 2 + 1, 5), (record.samples - 1) // 2 * 2 + 1)
    place, speed = (local_polynomial(even, window, 3, order, step) for order in (0, 1))
    return np.interp(record.time, grid, place), np.interp(record.time, grid, speed)
