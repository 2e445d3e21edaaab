"""The force between its samples: held, linear or band-limited, decided by the data.

A table with a force on the position's stamps does not say whether a converter held that force (a command) or a sensor
read one that is smooth in between. A wrong answer acts like a delay of half a sample. The same model is fitted with
each hold, and the likelihoods are compared.

The residual of a model that lacks something is large and slow, and hides what the hold does at high frequencies. So the
likelihood is that of an autoregressive process (Box & Jenkins 1970): its one-step errors count every frequency alike.
What is most often missing is dry friction, which makes the residual jump: each hold is tried with it and without.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from msd_ident.data.autoregressive import log_likelihood
from msd_ident.data.record import FloatArray, Record
from msd_ident.data.resampling import band_limited, is_even
from msd_ident.estimate import FitResult, fit
from msd_ident.estimate.levels import TENTH
from msd_ident.model import Model
from msd_ident.model.base_model import DryFriction
from msd_ident.model.effects.law import DELAY

#: What may be chosen, the simplest first.
CANDIDATES = ("zero", "linear", "band_limited")
#: Part of the force samples that must differ from the one before, or of the changes that must follow one another: a
#: force that seldom changes, from one level to the next at once, is a command, and held.
_DENSE, _ROWS = 0.1, 0.5
#: Fewest changes that are looked at for rows of them.
_CHANGES = 4
#: Samples that are compared: the part of the record in which the force changes most.
_WINDOW = 3000
#: Fewest samples of such a part.
_FEWEST = 200
#: Log-likelihood by which another hold must lead a simpler one. What the model lacks moves the difference: a bare plant
#: on held sweeps of drawn rigs with friction or drift gives up to 27 to the wrong hold. Measured forces that are smooth
#: lead by 363 to 1069.
_DECISIVE = 60.0

_WORDS = {"zero": "held", "linear": "linear", "band_limited": "band-limited"}


@dataclass(frozen=True)
class HoldChoice:
    """How the force goes on between its samples, and how sure that is.

    Attributes:
        hold: ``zero``, ``linear`` or ``band_limited``.
        log_likelihood: hold → log-likelihood of the model's residual, less that of the best.
        see: hold → standard error of estimate of the model in the part that was compared, in the position unit.
    """

    hold: str
    log_likelihood: dict[str, float]
    see: dict[str, float]

    @property
    def tied(self) -> tuple[str, ...]:
        """Holds that the data does not tell from the chosen one, which is the simplest of them."""
        own = self.log_likelihood[self.hold]
        others = {hold: value for hold, value in self.log_likelihood.items() if hold != self.hold}
        return tuple(hold for hold, value in others.items() if value > own - _DECISIVE)

    @property
    def sentence(self) -> str:
        """The answer with its reason."""
        own = self.log_likelihood[self.hold]
        chosen = f"Between its samples the force is assumed to be {_WORDS[self.hold]}"
        if self.tied:
            chosen += f" (this data does not distinguish that from {' or '.join(_WORDS[hold] for hold in self.tied)})"
        against = " and ".join(
            f"{own - value:.0f} against {_WORDS[hold]}"
            for hold, value in self.log_likelihood.items()
            if hold != self.hold and hold not in self.tied
        )
        reason = f": the log-likelihood ratio of the model's residual is {against}" if against else ""
        return f"{chosen}{reason}; if you know it, use --hold zero, linear, band_limited or centred."


def is_open(record: Record) -> bool:
    """Whether the record leaves open how its force goes on, and can be asked."""
    return record.samples >= _FEWEST and may_lead(record) and _goes_on(record.force)


def _goes_on(force: FloatArray) -> bool:
    """Whether a force changes often, or changes gradually where it does: a hammer's blow, ramps between plateaus."""
    changes = np.diff(force) != 0.0
    if float(np.mean(changes)) >= _DENSE:
        return True
    beside = np.concatenate((changes[1:], [False])) | np.concatenate(([False], changes[:-1]))
    count = np.count_nonzero(changes)
    return bool(count >= _CHANGES and np.count_nonzero(changes & beside) >= _ROWS * count)


def may_lead(record: Record) -> bool:
    """Whether the stamps of the record's force, those of the positions, may be late."""
    return not record.hold_known and bool(np.all(np.isin(record.time, record.force_time)))


def choose_hold(records: Sequence[Record], model: Model) -> HoldChoice:
    """Compare the holds on records whose force shares the position's stamps.

    Args:
        records: of one rig and one instrument, at least one.
        model: to be fitted with each hold, also beside Coulomb friction; its values are starting values. It need not be
            complete.
    """
    largest = max(float(np.max(np.abs(record.force))) for record in records)
    return compared(records, (model, model + DryFriction(TENTH**2 * largest)))


def compared(records: Sequence[Record], models: Sequence[Model]) -> HoldChoice:
    """Compare the holds, each with the one of these models that makes it likeliest.

    A model is searched for with the first hold. The others move its motion by half a sample, so their fits begin there.

    Args:
        records: as in ``choose_hold``.
        models: to be fitted; their values are starting values.
    """
    parts = tuple(_busiest(record) for record in records)
    likely, errors = {}, {}
    fits: list[FitResult] = []
    for hold in CANDIDATES:
        if hold == "band_limited" and not all(is_even(part.force_time) for part in parts):
            continue
        held = [with_hold(part, hold) for part in parts]
        near = [fit(one.model, held, search="near", initial=one.initial) for one in fits]
        fits = near or [fit(one, held) for one in models]
        likely[hold], errors[hold] = max((sum(map(log_likelihood, one.residuals)), one.see) for one in fits)
    best = max(likely.values())
    chosen = CANDIDATES[0]
    for hold, value in likely.items():
        if value > likely[chosen] + _DECISIVE:
            chosen = hold
    return HoldChoice(chosen, {hold: value - best for hold, value in likely.items()}, errors)


def stands_for_a_hold(model: Model, records: Sequence[Record]) -> bool:
    """Whether the model delays the force by half a sample, either way: what a wrong hold looks like.

    Args:
        model: a fitted one.
        records: that it was fitted to.
    """
    half = 0.5 * float(np.median([np.median(np.diff(record.time)) for record in records]))
    delays = [abs(effect.values[0]) for effect in model.effects if effect.structure == DELAY]
    return any(abs(delay - half) < TENTH * half for delay in delays)


def with_hold(record: Record, hold: str) -> Record:
    """The record with another hold of the force, marked as known.

    Args:
        record: the record.
        hold: ``zero``, ``linear`` or ``band_limited``.

    Raises:
        DataError: a band-limited force has too few samples, or uneven ones.
    """
    if hold == "band_limited":
        return band_limited(record)
    return replace(record, hold="linear" if hold == "linear" else "zero", hold_known=True)


def _busiest(record: Record) -> Record:
    """The ``_WINDOW`` samples in which the force changes most; the record itself where it has no more."""
    if record.samples <= _WINDOW:
        return record
    work = np.interp(record.time, record.force_time[1:], np.cumsum(np.diff(record.force) ** 2))
    first = int(np.argmax(work[_WINDOW - 1 :] - work[: record.samples - _WINDOW + 1]))
    return record.window(float(record.time[first]), float(record.time[first + _WINDOW - 1]))
