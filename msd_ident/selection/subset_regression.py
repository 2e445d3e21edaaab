"""Sets of causes chosen by regression of the equation of motion, in which each law is a column.

Where several causes act, each of them may explain nothing while another one is missing, and the simulated motion of a
wrong set tells little of what it lacks. The equation of motion with the measured motion in it has no such trouble. It
is linear in the strengths of all laws (``weak_form``), so thousands of sets are compared without a simulation. Its
noise is that of accelerations: it chooses sets, which are then fitted to the positions.

Columns are the laws with the values that a search begins with (``guesses``). Sets grow by a cause at a time, the best
few at once. (Brunton, Proctor, Kutz 2016, PNAS 113: sparse identification; Messenger and Bortz 2021, Multiscale Model.
Simul. 19: its weak form.)
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate.effort import KEPT
from msd_ident.estimate.levels import NULL
from msd_ident.estimate.problem import Initial
from msd_ident.estimate.weak_form import WIDTHS, Means, uniform
from msd_ident.model import Effect, Model
from msd_ident.model.base_model import PLANT
from msd_ident.model.effects import by_name
from msd_ident.model.effects.law import SECOND_MASS, STRUCTURAL
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, Hypothesis, causes_that_fit, kinds
from msd_ident.selection.law_signals import Motion, along, column
from msd_ident.selection.neighbours import LARGEST
from msd_ident.selection.ranking import LEADERS
from msd_ident.selection.second_masses import light_masses, second_masses
from msd_ident.selection.starting_points import fitted_record
from msd_ident.selection.starting_values import guesses


@dataclass(frozen=True)
class Regressed:
    """A set of causes with the values that a regression gives.

    Attributes:
        model: plant and effects.
        initial: state and zero of each record.
        left: part of the force that the set leaves, beyond what the plant alone explains.
    """

    model: Model
    initial: tuple[Initial, ...]
    left: float

    @property
    def causes(self) -> Causes:
        """The set."""
        return frozenset(self.model.effect_names)


@dataclass(frozen=True)
class Start:
    """A law with the values that a search begins with, and the columns of the equation that are its own.

    Attributes:
        effect: the law with these values.
        parts: the same with one strength each, and no other; the effect itself where it has one strength.
        places: of their columns.
    """

    effect: Effect
    parts: tuple[Effect, ...]
    places: tuple[int, ...]

    def scaled(self, times: Sequence[float]) -> Effect:
        """The effect with each part so many times as strong, as far as its bounds allow."""
        values = dict(zip([p.name for p in self.effect.parameters], self.effect.values, strict=True))
        neutral = dict(self.effect.neutral)
        for part, factor in zip(self.parts, times, strict=True):
            for name in _scaled_together(part):
                origin = neutral.get(name, 0.0)
                values[name] = origin + factor * (getattr(part, name) - origin)
        return type(self.effect).within_bounds(*values.values())

    def may_be(self, times: Sequence[float]) -> bool:
        """Whether the bounds allow that, but for no strength at all."""
        found = self.scaled(times)
        return not all(getattr(found, name) == value for name, value in self.effect.neutral)


def strengths(effect: Effect) -> list[str]:
    """Parameters without which the effect does nothing, as far as they have a strength here."""
    return [name for name, value in effect.neutral if math.isfinite(value) and getattr(effect, name) != value]


def _scaled_together(effect: Effect) -> list[str]:
    """Parameters that grow with its force: of a second mass its spring and its damper too."""
    if effect.structure != SECOND_MASS:
        return strengths(effect)
    return [parameter.name for parameter in effect.parameters[: STRUCTURAL[SECOND_MASS]]]


def _with_all(found: Sequence[Effect]) -> tuple[Effect, ...]:
    """Values that a search begins with, and where each has one of several strengths, one with all of them."""
    if not found:
        return ()
    first = found[0]
    missing = {name: getattr(one, name) for one in found[1:] for name in strengths(one) if name not in strengths(first)}
    values = dict(zip([p.name for p in first.parameters], first.values, strict=True))
    return (*found, type(first).from_values({**values, **missing})) if missing else tuple(found)


def parted(effect: Effect) -> tuple[Effect, ...]:
    """The effect with one of its strengths each; itself where one alone does nothing, or there is one."""
    several = strengths(effect)
    if len(several) < 2:
        return (effect,)
    values = dict(zip([p.name for p in effect.parameters], effect.values, strict=True))
    neutral = {name: value for name, value in effect.neutral if name in several}
    return tuple(type(effect).from_values({**values, **neutral, name: values[name]}) for name in several)


@dataclass(frozen=True)
class Equation:
    """The equation of motion of all records, for one width of the bump.

    Attributes:
        base: the base model, fitted.
        known: names of the plant's parameters that are known.
        plant: (r, p + k) columns of those of inertia, damper and spring that are not, and a constant for each record.
        force: (r,) right-hand side.
        starts: laws whose columns are known.
        columns: (r, c) of these.
    """

    base: Hypothesis
    known: frozenset[str]
    plant: FloatArray
    force: FloatArray
    starts: tuple[Start, ...]
    columns: FloatArray

    def sets(self) -> Iterator[Regressed]:
        """The best few sets of each size from two causes on."""
        if self.force.size <= self.plant.shape[1] + LARGEST:
            return  # the cart hardly moves
        frame = np.linalg.qr(self.plant / _sizes(self.plant))[0]
        size = _sizes(self.columns)
        scaled = self.columns / size
        free = scaled - frame @ (frame.T @ scaled)
        target = self.force - frame @ (frame.T @ self.force)
        gram, right, whole = free.T @ free, free.T @ target, float(target @ target)
        if not whole > 0.0:
            return
        beam: list[tuple[Start, ...]] = [()]
        for count in range(1, LARGEST + 1):
            found: dict[Causes, tuple[float, tuple[Start, ...]]] = {}
            for chosen in beam:
                for left, larger in self._grown(chosen, gram, right, size):
                    causes = frozenset(start.effect.name for start in larger)
                    if causes not in found or left < found[causes][0]:
                        found[causes] = left, larger
            best = sorted(found.values(), key=lambda one: one[0])[:LEADERS]
            beam = [larger for _, larger in best]
            if count > 1:
                yield from (self._solved(larger, 1.0 + left / whole) for left, larger in best[:KEPT])

    def _grown(
        self, chosen: tuple[Start, ...], gram: FloatArray, right: FloatArray, size: FloatArray
    ) -> Iterator[tuple[float, tuple[Start, ...]]]:
        """The best few sets with a law more, each with minus what it takes away of the sum of squares."""
        inside = [place for start in chosen for place in start.places]
        shares = np.linalg.lstsq(gram[np.ix_(inside, inside)], gram[inside], rcond=NULL)[0]
        beside, beyond = gram - gram[:, inside] @ shares, right - shares.T @ right[inside]
        names = frozenset(start.effect.name for start in chosen)
        sizes = np.diag(beside).tolist()
        gains = []
        for i, start in enumerate(self.starts):
            if start.effect.name not in names and min(sizes[place] for place in start.places) > NULL:
                gains.append((_gain(beside, beyond, start.places), i))
        kept = 0
        for _, i in sorted(gains, reverse=True):
            larger = (*chosen, self.starts[i])
            causes = names | {self.starts[i].effect.name}
            places = [place for start in larger for place in start.places]
            strength = np.linalg.lstsq(gram[np.ix_(places, places)], right[places], rcond=NULL)[0]
            factors = _shared(larger, strength / size[places])
            if causes_that_fit(causes) and all(map(Start.may_be, larger, factors)):
                yield -float(right[places] @ strength), larger
                kept += 1
            if kept == LEADERS:
                return

    def _solved(self, chosen: Sequence[Start], left: float) -> Regressed:
        """The set of these laws with its values, in the whole equation."""
        rows = np.column_stack([self.plant, self.columns[:, [place for start in chosen for place in start.places]]])
        size = _sizes(rows)
        values = np.linalg.lstsq(rows / size, self.force, rcond=None)[0] / size
        free = [name for name in PLANT if name not in self.known]
        given = dict(zip(free, values.tolist(), strict=False))
        known = {name: self.base.model[name] for name in PLANT}
        known |= {name: value for name, value in given.items() if value > 0.0}
        if given.get("damping", 1.0) <= 0.0:
            known["damping"] = 0.0
        plant = Model(known["mass"], known["damping"], known["stiffness"])
        count, records = self.plant.shape[1], len(self.base.initial)
        factors = _shared(chosen, values[count:])
        effects = tuple(map(Start.scaled, chosen, factors))
        shifts = values[count - records : count] / plant.stiffness if plant.stiffness > 0.0 else np.zeros(records)
        initial = tuple(
            replace(one, position=one.position + shift, zero=one.zero - shift)
            for one, shift in zip(self.base.initial, shifts.tolist(), strict=True)
        )
        return Regressed(replace(plant, effects=effects), initial, left)


def _gain(gram: FloatArray, right: FloatArray, own: Sequence[int]) -> float:
    """What columns take away of the sum of squares, by their products with each other and with the right-hand side."""
    if len(own) == 1:  # nearly all: a call of the solver takes ten times as long
        return float(right[own[0]] ** 2 / gram[own[0], own[0]])
    places = list(own)
    return float(right[places] @ np.linalg.lstsq(gram[np.ix_(places, places)], right[places], rcond=NULL)[0])


def _sizes(columns: FloatArray) -> FloatArray:
    """Norms (c,) of columns; 1 for one of nothing but zeros."""
    size = np.linalg.norm(columns, axis=0)
    return np.where(size > 0.0, size, 1.0)


def _shared(chosen: Sequence[Start], values: FloatArray) -> list[list[float]]:
    """Values (c,) of the columns of laws, law by law."""
    rest = iter(values.tolist())
    return [list(islice(rest, len(start.places))) for start in chosen]


def likely(experiment: Experiment, base: Hypothesis, known: Sequence[Hypothesis] = ()) -> list[Regressed]:
    """Sets of two causes and more that the equation of motion calls for, each once, those that leave least first.

    Args:
        experiment: the data.
        base: the base model, fitted.
        known: further fitted sets; the values of their laws are tried too, and those that other laws begin with beside
            them.
    """
    laws = [effect for one in known for effect in one.model.effects]
    laws += [effect for one in (base, *known) for effect in _beside(experiment, one)]
    shortest = min(record.samples for record in experiment.records)
    best: dict[Causes, Regressed] = {}
    for half in WIDTHS[:KEPT]:
        if 2 * half + 1 > shortest // 3:
            break
        for found in _equation(experiment, base, half, laws).sets():
            if found.causes not in best or found.left < best[found.causes].left:
                best[found.causes] = found
    return sorted(best.values(), key=lambda one: one.left)


def _beside(experiment: Experiment, fitted: Hypothesis) -> Iterator[Effect]:
    """Laws that a fitted set lacks, with the values that a search begins with beside it."""
    plant = Model(fitted.model.mass, fitted.model.damping, fitted.model.stiffness)
    record, own = fitted_record(experiment, fitted, plant), kinds(fitted.causes)
    for effect in map(by_name, experiment.library):
        if effect.form_of or effect.cause() in own:
            continue
        yield from _with_all(guesses(effect.name, record))
        if effect.structure == SECOND_MASS:
            starts = second_masses(plant, record.record, record.residual, experiment.fixed)
            hung = [start.hung for start in starts] + light_masses(plant, record.record) * (not fitted.causes)
            yield from (effect.within_bounds(*values) for values in hung)


def _equation(experiment: Experiment, base: Hypothesis, half: int, effects: Sequence[Effect]) -> Equation:
    """The rows of all records; ``effects`` that do not follow from the motion are left out."""
    base_values = [base.model[name] for name in PLANT]
    known = [i for i, name in enumerate(PLANT) if name in experiment.fixed]
    moved = [
        _moved(record, initial.zero, half, base)
        for record, initial in zip(experiment.records, base.initial, strict=True)
    ]
    effects = [one for one in effects if all(motion.can_tell(type(one)) for motion, _ in moved)]
    parts = [part for one in effects for part in parted(one)]
    plants, forces, columns, constants = [], [], [], []
    for motion, means in moved:
        plant = means.plant_columns(motion.position)
        plants.append(np.delete(plant, known, axis=1))
        forces.append(means.force - plant[:, known] @ [base_values[i] for i in known])
        found = np.array([column(part, motion, means, base.model) for part in parts])
        found = found.reshape(len(parts), means.force.size).T  # also of no laws
        columns.append(np.where(np.all(np.isfinite(found), axis=0), found, 0.0))  # what runs away is no column
        constants.append(means.constant)
    plant = np.column_stack([np.vstack(plants), _apart(constants)])
    fixed = frozenset(PLANT[i] for i in known)
    return Equation(base, fixed, plant, np.concatenate(forces), _starts(effects), np.vstack(columns))


def _moved(record: Record, zero: float, half: int, base: Hypothesis) -> tuple[Motion, Means]:
    """A record's motion from its zero, and its means over a bump."""
    grid = record.kept(("grid", zero), partial(uniform, record, zero))
    means = record.kept(("means", zero, half), partial(Means, grid, half))
    return along(means, base.model.stiffness), means


def _starts(effects: Sequence[Effect]) -> tuple[Start, ...]:
    places = iter(range(sum(len(parted(effect)) for effect in effects)))
    return tuple(Start(one, parts, tuple(islice(places, len(parts)))) for one in effects if (parts := parted(one)))


def _apart(parts: Sequence[FloatArray]) -> FloatArray:
    """Columns (r, k) each of which holds one part (r_k,) at its place, and zeros."""
    whole = np.zeros((sum(part.size for part in parts), len(parts)))
    first = 0
    for k, part in enumerate(parts):
        whole[first : first + part.size, k] = part
        first += part.size
    return whole
