"""The fitting problem: which parameters are free, what each record adds, residuals and their Jacobian.

The vector that the solver moves holds the free parameters of the model, shared by all records, and then, for each
record, its own initial position, initial velocity and zero where these are free. Residual = model − data (eq. 14).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
import numpy.typing as npt

from msd_ident.data import quality
from msd_ident.data.record import FloatArray, Record
from msd_ident.data.resampling import thinned
from msd_ident.estimate.effort import A_SWING, FEWEST_READINGS, LONG_RECORD
from msd_ident.estimate.jacobian import relative_step
from msd_ident.estimate.levels import NATURAL_RANGE
from msd_ident.estimate.parameter_units import Magnitudes
from msd_ident.model import Model, Parameter, Simulator
from msd_ident.model.base_model import OFFSET_FORCE
from msd_ident.tuning import fixed

NuisanceKind = Literal["initial position", "initial velocity", "zero"]

_BLOWN_UP = fixed(1e6, "accuracy", "amplitudes that the error of a simulation counts as which blows up")
_PARTED = fixed(1e3, "resources", "amplitudes at which a joint that spins, in ever smaller steps, counts as blown up")


@dataclass(frozen=True)
class Nuisance:
    """A free initial position, initial velocity or zero of one record."""

    record: int
    kind: NuisanceKind


@dataclass(frozen=True)
class Initial:
    """State of a record at its first sample.

    Attributes:
        position: [m] from the relaxed spring.
        velocity: [m/s].
        zero: reading [m] at which the spring is relaxed.
    """

    position: float = 0.0
    velocity: float = 0.0
    zero: float = 0.0


@dataclass(frozen=True)
class RestConstraint:
    """Balance of forces of a record that rests before its first push: spring and offset cancel, within the friction.

    A pseudo-observation ``x0 + F0/k = 0 ± spread``. Its weight is small, so that it decides only what the samples leave
    open: the scale of a record with one constant force and an unknown zero.

    Attributes:
        record: index of the record.
        spread: standard deviation [m] of the balance.
        noise: standard deviation [m] of a position sample.
    """

    record: int
    spread: float
    noise: float

    @property
    def weight(self) -> float:
        """Its weight beside a sample that counts 1."""
        return (self.noise / self.spread) ** 2


@dataclass(frozen=True)
class Problem:
    """A model, records, and what is fitted.

    Attributes:
        model: structure, and the values of the parameters that are fixed.
        records: the records that share the model's parameters.
        simulators: one for each record.
        free: indices of the free parameters in ``model.names``.
        nuisances: the free entries of single records, after the free parameters in the vector.
        initial: per record, the values of the entries that are not free.
        typical: typical force, length and time.
        scale, lower, upper: natural size and bounds (p,) of the vector's entries.
        balances: rest at the start of records, as observations beside their samples.
    """

    model: Model
    records: tuple[Record, ...]
    simulators: tuple[Simulator, ...]
    free: tuple[int, ...]
    nuisances: tuple[Nuisance, ...]
    initial: tuple[Initial, ...]
    typical: Magnitudes
    scale: FloatArray
    lower: FloatArray
    upper: FloatArray
    balances: tuple[RestConstraint, ...] = ()

    @cached_property
    def encoder_steps(self) -> tuple[float, ...]:
        """The encoder's step in each record [m], 0 where none is seen."""
        return tuple(quality.encoder_step(record) for record in self.records)

    @property
    def size(self) -> int:
        """Entries of the vector."""
        return len(self.free) + len(self.nuisances)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Name of each entry of the vector."""
        own = tuple(f"{n.kind} of {self.records[n.record].name}" for n in self.nuisances)
        return tuple(self.model.names[i] for i in self.free) + own

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The free parameters, in the order of the vector's first entries."""
        return tuple(self.model.parameters[i] for i in self.free)

    def vector(self, values: Mapping[str, float], initial: Sequence[Initial]) -> FloatArray:
        """The solver's vector for given parameters and initial states.

        Args:
            values: values by name, at least of all free parameters.
            initial: one for each record. Where its zero is not free here, the position is counted from the zero that
                the problem has.

        Returns:
            (p,): the free parameters, then the free initial positions, velocities and zeros.
        """
        shared = [values[self.model.names[i]] for i in self.free]
        loose = {n.record for n in self.nuisances if n.kind == "zero"}
        states = [
            start if r in loose else Initial(start.position + start.zero - own.zero, start.velocity, own.zero)
            for r, (start, own) in enumerate(zip(initial, self.initial, strict=True))
        ]
        return np.array(shared + [_get(states[n.record], n.kind) for n in self.nuisances])

    def values(self, vector: FloatArray) -> FloatArray:
        """Values of all the model's parameters (in the order of ``model.names``)."""
        values = self.model.values.copy()
        values[self._places] = vector[: len(self.free)]
        return np.asarray(values)

    @cached_property
    def _places(self) -> npt.NDArray[np.intp]:
        """``free`` as an index."""
        return np.array(self.free, dtype=np.intp)

    def initials(self, vector: FloatArray) -> tuple[Initial, ...]:
        """Initial state and zero of each record."""
        states = [[start.position, start.velocity, start.zero] for start in self.initial]
        for nuisance, value in zip(self.nuisances, vector[len(self.free) :], strict=True):
            states[nuisance.record][_KINDS.index(nuisance.kind)] = float(value)
        return tuple(Initial(*state) for state in states)

    def entries(self, record: int) -> npt.NDArray[np.intp]:
        """Indices of the vector's entries that this record depends on."""
        return self._entries[record]

    def simulated(self, record: int) -> npt.NDArray[np.intp]:
        """``entries`` but for a free zero, the last of its record, with which the residual moves alike."""
        entries = self._entries[record]
        last = int(entries[-1]) - len(self.free)
        return entries[:-1] if last >= 0 and self.nuisances[last].kind == "zero" else entries

    @cached_property
    def _entries(self) -> tuple[npt.NDArray[np.intp], ...]:
        """``entries`` of each record."""
        shared = range(len(self.free))
        return tuple(np.array([*shared, *(entry for _, entry in own)], dtype=np.intp) for own in self._own)

    def residual(self, vector: FloatArray, record: int, *weights: FloatArray) -> FloatArray:
        """Model − data (n,) [m] of one record, as ``residuals`` gives it.

        Args:
            vector: (p,) whole vector of the problem.
            record: index of the record.
            weights: (n,) square roots of the samples' weights, if these are not 1.
        """
        return np.asarray(self.residuals(vector[None, :], record, *weights)[0])

    def linearised(self, vector: FloatArray, record: int, steps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Residual and Jacobian of one record by forward differences.

        Args:
            vector: (p,) whole vector of the problem.
            record: index of the record.
            steps: (p,) finite-difference steps of the whole vector; a negative step makes a backward difference.

        Returns:
            Residual (n,) and Jacobian (q, n) for the q entries that the record depends on (``entries``). The Jacobian
            is the simulation's own buffer, so that a million samples need it only once.
        """
        moved = self.simulated(record)
        points = np.repeat(vector[None, :], moved.size + 1, axis=0)
        points[np.arange(moved.size), moved] += steps[moved]
        rows = self.residuals(points, record)
        jacobian, residual = rows[:-1], rows[-1]
        if moved.size < self.entries(record).size:  # the last row becomes that of the zero
            jacobian, residual = rows, residual.copy()
        rows[:-1] -= residual
        rows[:-1] /= steps[moved][:, None]
        if jacobian is rows:
            rows[-1] = 1.0
        return residual, jacobian

    def central(self, vector: FloatArray, record: int, steps: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Residual and Jacobian of one record by central differences.

        A difference is one-sided at a bound, and for records of more than ``LONG_RECORD`` samples.

        Args:
            vector: (p,) whole vector of the problem.
            record: index of the record.
            steps: (p,) positive finite-difference steps of the whole vector.

        Returns:
            Residual (n,) and Jacobian (q, n), as ``linearised`` gives them.
        """
        residual, ahead = self.linearised(vector, record, np.where(vector + steps > self.upper, -steps, steps))
        if self.records[record].samples > LONG_RECORD:
            return residual, ahead
        _, behind = self.linearised(vector, record, np.where(vector - steps < self.lower, steps, -steps))
        ahead += behind
        ahead *= 0.5
        return residual, ahead

    def shortened(self, share: float) -> Problem:
        """The same problem over the first part of each record.

        Args:
            share: part of each record's samples to keep, in (0, 1]; at least 40 samples are kept.
        """
        records = tuple(
            record.window(record.time[0], record.time[min(max(int(share * record.samples), 40), record.samples) - 1])
            for record in self.records
        )
        return self.on(records, self.simulators[0].slack)

    def thinned(self, enough: int) -> Problem:
        """The same problem on every n-th sample; the problem itself where thinning would lose too much.

        A record with few force values keeps them all. Where force and position share their stamps and the force is
        held, each kept sample gets the mean force of the samples that it stands for. Other records are not thinned.

        Args:
            enough: samples of all records together that should remain. A record keeps at least ``FEWEST_READINGS``
                samples and about ``A_SWING`` samples in each swing.
        """
        every = sum(record.samples for record in self.records) // enough
        turn = 2.0 * np.pi * self.typical.time
        spare = [min(every, int(turn / (A_SWING * record.period))) for record in self.records]
        records = tuple(thinned(*pair, FEWEST_READINGS) for pair in zip(self.records, spare, strict=True))
        if all(few is record for few, record in zip(records, self.records, strict=True)):
            return self
        return self.on(records, self.simulators[0].slack)

    def on(self, records: tuple[Record, ...], slack: float) -> Problem:
        """The same problem on these records, whose simulations have this slack (``Simulator``)."""
        simulators = tuple(Simulator(self.model, record, slack) for record in records)
        return replace(self, records=records, simulators=simulators)

    def first_steps(self) -> FloatArray:
        """Finite-difference steps (p,) before anything is known about the Jacobian: far within the bounds."""
        room = self.upper - self.lower
        return relative_step(self.simulators[0].slack) * np.where(room > 0.0, np.minimum(self.scale, room), self.scale)

    def steps(self, matrix: FloatArray) -> FloatArray:
        """Steps that move the positions by ``relative_step`` of the motion, from the last Gauss–Newton matrix."""
        samples = sum(record.samples for record in self.records)
        effect = np.sqrt(np.maximum(matrix.diagonal(), 1e-300) / samples)
        first = self.first_steps()
        steps = relative_step(self.simulators[0].slack) * self.typical.length / effect
        return np.asarray(np.minimum(np.maximum(steps, first / NATURAL_RANGE), NATURAL_RANGE * first))

    def imbalance(self, vector: FloatArray, balance: RestConstraint) -> tuple[float, FloatArray]:
        """Deviation x0 + F0/k [m] of a record from the balance of spring and offset force at rest.

        Args:
            vector: (p,) whole vector of the problem.
            balance: names the record, whose initial position must be free.

        Returns:
            The deviation and its gradient (p,).
        """
        gradient = np.zeros(vector.size)
        start = len(self.free) + self.nuisances.index(Nuisance(balance.record, "initial position"))
        gradient[start] = 1.0
        if OFFSET_FORCE not in self.model.names:
            return float(vector[start]), gradient
        values = dict(zip(self.model.names, self.values(vector).tolist(), strict=True))
        stiffness, offset = max(values["stiffness"], 1e-9), values[OFFSET_FORCE]
        slopes = {OFFSET_FORCE: 1.0 / stiffness, "stiffness": -offset / stiffness**2}
        for place, index in enumerate(self.free):
            gradient[place] = slopes.get(self.model.names[index], 0.0)
        return float(vector[start]) + offset / stiffness, gradient

    def residuals(self, points: FloatArray, record: int, *weights: FloatArray) -> FloatArray:
        """Residuals of one record at several points, simulated together.

        Args:
            points: (q, p) whole vectors of the problem.
            record: index of the record.
            weights: (n,) square roots of the samples' weights, if these are not 1.

        Returns:
            (q, n) model − data [m], times the roots of the weights; large but finite where a simulation diverges.
        """
        still, columns = self._rows[record]
        rows = np.empty((len(points), still.size))
        rows[:] = still
        rows[:, columns] = points[:, self._entries[record]]
        length = self.typical.length
        return self.simulators[record].residuals(rows, _BLOWN_UP * length, _PARTED * length, *weights)

    @cached_property
    def _rows(self) -> tuple[tuple[FloatArray, npt.NDArray[np.intp]], ...]:
        """What ``Simulator.residuals`` is given for each record: its row (p + 3,) without the vector's values, and the
        columns of ``entries``.
        """
        found = []
        for start, own in zip(self.initial, self._own, strict=True):
            row = np.array([*self.model.values.tolist(), start.position, start.velocity, start.zero])
            columns = [*self.free, *(self.model.values.size + column for column, _ in own)]
            found.append((row, np.array(columns, dtype=np.intp)))
        return tuple(found)

    @cached_property
    def _own(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """For each record: place in (position, velocity, zero) and in the vector, of each of its free entries."""
        places = [(n.record, (_KINDS.index(n.kind), len(self.free) + j)) for j, n in enumerate(self.nuisances)]
        return tuple(tuple(place for r, place in places if r == record) for record in range(len(self.records)))


_KINDS: tuple[NuisanceKind, ...] = ("initial position", "initial velocity", "zero")


def _get(initial: Initial, kind: NuisanceKind) -> float:
    return (initial.position, initial.velocity, initial.zero)[_KINDS.index(kind)]
