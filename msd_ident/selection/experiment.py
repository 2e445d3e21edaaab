"""The data of a diagnosis, with its weights and its base model: what all candidate sets of causes share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.data.turns import turned_away
from msd_ident.estimate import resolution
from msd_ident.estimate.broyden import Weighting
from msd_ident.estimate.effort import A_SWING, FEWEST_READINGS, SLACK
from msd_ident.estimate.formulation import formulate
from msd_ident.estimate.parameter_units import Magnitudes, magnitudes
from msd_ident.estimate.posing import build
from msd_ident.estimate.problem import Initial, Nuisance, Problem
from msd_ident.model import Model
from msd_ident.model.declarations import RecordScales
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.residuals.noise_model import NOISE_ERROR, Readings
from msd_ident.tuning import tuned

SOUGHT = tuned(
    40.0, unit="1", why="features of a model's error that are counted while a search goes on", chosen="by hand"
)


@dataclass(frozen=True)
class Experiment:
    """The data and the base model, which all candidate sets share.

    Attributes:
        readings: the records with their weights.
        base: the base model.
        fixed: base parameters that the data cannot give (stiffness without a spring, mass in a free decay).
        rests: stretches of the records in which the cart stands still, which the fits leave out.
        asked: the only causes in question; None for all of the library.
        begun: whether the records are copies, and the search begins with sets that were fitted to the measured ones.
        led: whether a controller leads the motion, or force and motion are a single tone: then laws that need no force
            may follow it.
        slack: factor on the errors that steps of the simulations may have.
    """

    readings: tuple[Readings, ...]
    base: Model
    fixed: frozenset[str]
    rests: tuple[Readings, ...] = ()
    asked: frozenset[str] | None = None
    begun: bool = False
    led: bool = False
    slack: float = 1.0

    @property
    def evidence(self) -> float:
        """Sum of the weights of all samples, in pieces of evidence."""
        return sum(part.evidence for part in self.readings)

    @cached_property
    def motion(self) -> float:
        """Chi² that a cart leaves which stands still at the mean position of each record."""
        return sum(part.chi(part.record.position - np.mean(part.record.position)) for part in self.readings)

    def worse(self, chi: float, times: float) -> float:
        """The chi² of a set whose error has ``times`` the variance of another set's, along ``SOUGHT`` features.

        Args:
            chi: chi² of the other set. What it leaves above the noise by less than the uncertainty of the noise counts
                as noise.
            times: factor on the variance.
        """
        above = max(chi - (1.0 + NOISE_ERROR) * self.evidence, 0.0)
        return chi + (times - 1.0) * (SOUGHT + above)

    def thinned(self, keep: int) -> Experiment:
        """The same experiment with about ``keep`` samples in all.

        Every n-th sample is kept, but at least ``A_SWING`` samples in each swing. If these are still too many, only a
        stretch of a record that goes on in the same way is kept, as short as one that is like the whole.
        """
        total = sum(part.record.samples for part in self.readings)
        parts = []
        for part in self.readings:
            fewest = int(A_SWING * part.octaves.swings)
            own = max(keep * part.record.samples // total, FEWEST_READINGS)
            parts.append(_stretch(part.thinned(max(own, fewest)), own))
        return replace(self, readings=tuple(parts))

    def with_mean_force(self) -> Experiment:
        """The same experiment with one force, the mean, between any two samples; its simulation takes fewer steps."""
        return replace(self, readings=tuple(part.with_mean_force() for part in self.readings))

    def with_force_lines(self) -> Experiment:
        """The same experiment with one line of force between any two samples; its simulation takes fewer steps."""
        return replace(self, readings=tuple(part.with_force_lines() for part in self.readings))

    def loose(self) -> Experiment:
        """The same experiment, simulated in longer steps."""
        return replace(self, slack=SLACK)

    @property
    def records(self) -> tuple[Record, ...]:
        """The records."""
        return tuple(part.record for part in self.readings)

    @cached_property
    def library(self) -> tuple[str, ...]:
        """Names of the causes that can act here.

        Causes on the spring are left out if there is none, causes on the input if no force acts, and those at a place
        of the travel on a shaft that turns on and on.
        """
        sprung = "stiffness" not in self.fixed
        forced = any(bool(np.any(record.force_at(record.time))) for record in self.records)
        turns = max(map(turned_away, self.records)) > 0.0
        return tuple(
            effect.name
            for effect in LIBRARY
            if (sprung or not effect.needs_spring)
            and (forced or effect.acts_on != "input")
            and any(effect.fits(record) for record in self.records)
            and not (turns and effect.belongs_to_a_place())
            if self.asked is None or effect.name in self.asked
        )

    @property
    def tried_alone(self) -> tuple[str, ...]:
        """Causes that are tried in every search: all except those that are only another form of a simple law, or may
        be mistaken for another cause.
        """
        return tuple(
            name
            for name in self.library
            if by_name(name).stands_alone or not (by_name(name).form_of or by_name(name).mistaken_for)
        )

    def forms(self, name: str) -> tuple[str, ...]:
        """Other laws of the same cause, and of causes for which one of the two may be mistaken."""
        return tuple(other for other in self.library if by_name(name).alike(by_name(other)) and other != name)

    def nuisances(self, model: Model) -> tuple[Nuisance, ...]:
        """Free entries of each record: the same for all models, but for the zero of a law of an angle.

        Such a law counts from a direction that no encoder knows, so it has a zero where no spring has one too. Within a
        radian, a sine from anywhere is no more than a spring, which this axis has not, and a constant force.
        """
        return self._from_a_zero if any(effect.angular for effect in model.effects) else self._of_each

    @cached_property
    def _of_each(self) -> tuple[Nuisance, ...]:
        return formulate(self.base, self.records, self.fixed).nuisances

    @cached_property
    def _from_a_zero(self) -> tuple[Nuisance, ...]:
        known = {n.record for n in self._of_each if n.kind == "zero"}
        far = [r for r, record in enumerate(self.records) if r not in known and np.ptp(record.position) > 1.0]
        return (*self._of_each, *(Nuisance(r, "zero") for r in far))

    @cached_property
    def scales(self) -> RecordScales:
        """What the records show, which bounds the laws' inner parameters to what the samples can resolve."""
        return resolution.seen(self.records, self.base)

    @cached_property
    def _ranges(self) -> dict[str, tuple[float, float]]:
        """What the samples can resolve of the parameters of all laws."""
        return resolution.of_laws(LIBRARY, self.scales)

    @cached_property
    def typical(self) -> Magnitudes:
        """Typical force, length and time of the records."""
        return magnitudes(self.records, self.base.mass)

    def problem(self, model: Model, held: frozenset[str] = frozenset()) -> Problem:
        """The fitting problem of a model on these records.

        Args:
            model: structure, and the values of what is not fitted.
            held: further parameters that keep the model's values.
        """
        fixed = self.fixed | held | switched_off(model)
        problem = build(model, self.records, fixed, self.nuisances(model), self.typical)
        problem = problem.on(self.records, self.slack) if self.slack > 1.0 else problem
        own = resolution.of_laws(map(type, model.effects), self.scales)
        return resolution.within(problem, self._ranges | own)

    def posed(self, model: Model, held: frozenset[str] = frozenset()) -> Weighting:
        """The same in units of the noise, made once for all models with these laws and these values of what is fixed.

        The values of the free parameters in the problem's model are those of the first such model.

        Args:
            model: structure, and the values of what is not fitted.
            held: further parameters that keep the model's values.
        """
        fixed = self.fixed | held | switched_off(model)
        kept = tuple(value for name, value in zip(model.names, model.values.tolist(), strict=True) if name in fixed)
        key = (model.effect_names, fixed, kept)
        if key not in self._posed:
            self._posed[key] = weigh(self.problem(model, held), self.readings)
        return self._posed[key]

    @cached_property
    def _posed(self) -> dict[tuple[tuple[str, ...], frozenset[str], tuple[float, ...]], Weighting]:
        return {}


def formulated(
    experiment: Experiment, model: Model, initial: Sequence[Initial], held: frozenset[str] = frozenset()
) -> tuple[Problem, Weighting, FloatArray]:
    """A model's problem in units of the noise, and the vector of its values and initial states inside the bounds.

    Parameters ``held`` stay as the model has them.

    Args:
        experiment: readings with their weights.
        model: values to start from.
        initial: initial state of each record.
        held: parameters that are not fitted.
    """
    weighting = experiment.posed(model, held)
    problem = weighting.problem
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    point = np.minimum(np.maximum(problem.vector(values, initial), problem.lower), problem.upper)
    return problem, weighting, point


def weigh(problem: Problem, readings: Sequence[Readings], masks: Sequence[FloatArray] | None = None) -> Weighting:
    """A problem in units of the noise, with each run of equal readings counted once.

    Args:
        problem: model and records.
        readings: the same records with their weights.
        masks: for each record (n,): 0 for samples to leave out, else 1; None for all samples.
    """
    if masks is None:
        return Weighting(problem, tuple(part.root for part in readings))
    factors = [part.factor * mask for part, mask in zip(readings, masks, strict=True)]
    return Weighting(problem, tuple(np.sqrt(factor) for factor in factors))


def switched_off(model: Model) -> frozenset[str]:
    """Parameters that are not fitted.

    Those that an effect only states, and infinite limits, which mean that a part of the effect is absent.
    """
    return frozenset(name for effect in model.effects for name in effect.idle())


def _stretch(few: Readings, keep: int) -> Readings:
    """A stretch of about ``keep`` samples, or twice as many, and so on, that is like the whole; the same object if none
    is of less than half of it.
    """
    while few.record.samples > 2 * keep:
        part = few.stretch(keep)
        if part is not few:
            return part
        keep *= 2
    return few
