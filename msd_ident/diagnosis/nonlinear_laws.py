"""The force beyond the linear plant, compared with the law of the named causes.

The force that mass, damper and spring of the extended model do not make is smoothed from the readings. The same
smoother goes over the extended model's own motion: if the named causes are right, the two agree at every instant,
whatever kind of cause it is. A law that depends on one signal alone is a curve over it, too.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.diagnosis.result import Diagnosis
from msd_ident.model import Effect, Model
from msd_ident.residuals import noise_model
from msd_ident.residuals.disturbance import DisturbanceEstimate, missing_force
from msd_ident.tuning import fixed

Signal = Literal["velocity", "position", "time", "applied"]

_POINTS = fixed(401, "interface", "points of a drawn curve")
#: What a law may be given of each signal.
_OF: Mapping[Signal, frozenset[str]] = {
    "velocity": frozenset({"v", "speed", "direction"}),
    "position": frozenset({"x"}),
    "time": frozenset({"t"}),
    "applied": frozenset({"u"}),
}
_INSTANT = frozenset({"t", "x", "v", "speed", "direction", "spring_force", "u"})


@dataclass(frozen=True)
class LawCurve:
    """Sum of the laws of named causes that depend on one signal alone.

    Attributes:
        causes: their names.
        signal: the signal.
        over: (k,) its values.
        force: (k,) force [N] on the left-hand side of the equation of motion.
    """

    causes: tuple[str, ...]
    signal: Signal
    over: FloatArray
    force: FloatArray


@dataclass(frozen=True)
class Beyond:
    """The force beyond the linear plant.

    Attributes:
        measured: as smoothed from each record.
        explained: as the extended model has it, by the same smoother; empty without causes.
        laws: curves, one a signal, of the causes that depend on that signal alone.
        named: number of causes.
    """

    measured: tuple[DisturbanceEstimate, ...]
    explained: tuple[DisturbanceEstimate, ...]
    laws: tuple[LawCurve, ...]
    named: int

    @property
    def whole(self) -> bool:
        """Whether there is one curve, and it holds all causes: then it runs through the measured cloud."""
        return len(self.laws) == 1 and len(self.laws[0].causes) == self.named


def beyond(diagnosis: Diagnosis) -> Beyond:
    """Smooth the measured and the modelled motion, and draw the laws."""
    model = diagnosis.extended.model
    if not diagnosis.causes:
        return Beyond(diagnosis.missing, (), (), 0)
    plant = (model.mass, model.damping, model.stiffness)
    measured, explained = [], []
    parts = noise_model.prepare(diagnosis.records)
    for part, residual, start in zip(parts, diagnosis.extended.residuals, diagnosis.extended.initial, strict=True):
        measured.append(missing_force(part.record, plant, part.noise, start.zero))
        modelled = replace(part.record, position=part.record.position + residual)
        explained.append(missing_force(modelled, plant, part.noise, start.zero))
    return Beyond(tuple(measured), tuple(explained), law_curves(model, measured), len(model.effects))


def law_curves(model: Model, motion: Sequence[DisturbanceEstimate]) -> tuple[LawCurve, ...]:
    """Curves of all effects that depend on one signal alone.

    Args:
        model: the extended model.
        motion: smoothed motion of each record, which gives the range of the signals.

    Returns:
        One curve for each signal, the sum over the effects that depend on it.
    """
    found: dict[Signal, list[Effect]] = {}
    for effect in model.effects:
        signal = _signal(effect)
        if signal is not None:
            found.setdefault(signal, []).append(effect)
    return tuple(_curve(model, effects, signal, motion) for signal, effects in found.items())


def _laws(effect: Effect) -> dict[str, Callable[..., float]]:
    kinds = ("force", "constant", "disturbance", "friction", "input_map")
    return {kind: law for kind, law in type(effect).laws().items() if kind in kinds}


def _signal(effect: Effect) -> Signal | None:
    """The one signal that all of the effect's force depends on; ``None`` for several, or for a law with a memory."""
    if effect.memory or not _laws(effect) or "reading" in type(effect).laws():
        return None
    given: set[str] = set()
    for kind, law in _laws(effect).items():
        given |= set(inspect.signature(law).parameters) & _INSTANT
        given |= {"direction"} if kind == "friction" else set()
    for signal, names in _OF.items():
        if given and given <= names:
            return signal
    return None


def _curve(model: Model, effects: Sequence[Effect], signal: Signal, motion: Sequence[DisturbanceEstimate]) -> LawCurve:
    reach = np.concatenate([getattr(part, signal) for part in motion])
    over = np.linspace(float(reach.min()), float(reach.max()), _POINTS)
    if signal == "velocity":  # dry friction jumps at rest: show the jump, not a slope
        over = np.sort(np.append(over, [-1e-9, 1e-9]))
    force = sum((_force(model, effect, signal, over) for effect in effects), np.zeros(over.size))
    return LawCurve(tuple(effect.name for effect in effects), signal, over, force)


def _force(model: Model, effect: Effect, signal: Signal, over: FloatArray) -> FloatArray:
    """Force [N] of an effect over one signal."""
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    short = {"velocity": "v", "position": "x", "time": "t", "applied": "u"}[signal]
    known: dict[str, FloatArray | float] = {**values, short: over}
    if signal == "velocity":
        known |= {"speed": np.abs(over), "direction": np.sign(over)}
    total = np.zeros(over.size)
    for kind, law in _laws(effect).items():
        names = list(inspect.signature(law).parameters)
        made = np.vectorize(law, otypes=[float])(*(known[name] for name in names)) + np.zeros(over.size)
        if kind == "friction":
            made = made * np.sign(over)
        total += over - made if kind == "input_map" else made
    return total
