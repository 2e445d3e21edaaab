"""The model that is simulated in parallel with the rig under the same force; the encoder gives only its first state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from msd_ident.data.record import MINIMUM_SAMPLES, FloatArray, Hold, Record
from msd_ident.errors import UsageError
from msd_ident.live.track import Track
from msd_ident.model import Model
from msd_ident.model.effects import LIBRARY, Effect
from msd_ident.model.plant import PLANT_PARAMETERS
from msd_ident.model.simulator import Simulator

#: How far back the simulation begins, at least and at most [s]; the state at its begin is the model's own.
SHORT, LONG = 0.2, 5.0
#: A pause of the encoder after which the model restarts from a measured state [s].
PAUSE = 1.0
#: Columns of the samples.
TIME, POSITION, MODEL = range(3)


@dataclass(frozen=True)
class Beside:
    """A model that shall run beside the rig.

    Attributes:
        model: with its values.
        label: where it comes from, in a few words.
        noise: standard deviation of what no model can beat, in the position unit; NaN when it is not known.
        turned: a positive force moves the encoder downwards, and the model was fitted to the force turned round.
    """

    model: Model
    label: str
    noise: float = float("nan")
    turned: bool = False


def model_of(values: Mapping[str, float]) -> Model:
    """The model that has these parameters, by their canonical names; names of no parameter are left aside.

    Raises:
        UsageError: no mass, a value out of its bounds, or a law that needs to know when its record began.
    """
    if "mass" not in values:
        raise UsageError(f"no mass among {', '.join(values) or 'no parameters'}; expected a fitted model's parameters")
    mass, damping, stiffness = (values.get(parameter.name, 0.0) for parameter in PLANT_PARAMETERS)
    model = Model(mass, damping, stiffness)
    for kind in _kinds(values):
        if not kind.steady:
            raise UsageError(
                f"{kind.name} depends on the time since its record began; expected laws that hold at any time"
            )
        model += kind.from_values(dict(values))
    return model


def _kinds(values: Mapping[str, float]) -> list[type[Effect]]:
    """Effects whose parameters are all there, those that take most first; a parameter belongs to one effect."""
    found, taken = [], set[str]()
    for kind in sorted(LIBRARY, key=lambda kind: -len(kind.parameters)):
        names = {parameter.name for parameter in kind.parameters}
        if names and names <= set(values) and not names & taken:
            found.append(kind)
            taken |= names
    return found


@dataclass
class _Checkpoint:
    """The model's state at a row; ``None`` where the next run must begin from the measurement."""

    row: int
    state: tuple[float, float] | None = None


class Shadow:
    """Runs a model along the rows of a track and writes its readings beside the measured ones.

    Args:
        beside: the model.
        first: number of the row to begin with.
        hold: how the force goes on between its samples.
    """

    def __init__(self, beside: Beside, first: int, hold: Hold = "zero") -> None:
        self.beside = beside
        self._hold: Hold = hold
        self._at = _Checkpoint(first)
        remembers = any(effect.remembers() for effect in beside.model.effects)
        # Without a spring nothing pulls an error back: the model restarts from the measurement now and then.
        self._free = beside.model.stiffness == 0.0
        self._span = LONG if remembers or self._free else SHORT

    def restart(self, row: int) -> None:
        """Restart from the measurement, at a row."""
        self._at = _Checkpoint(row)

    def advance(self, rows: Track, forces: Track) -> None:
        """Simulate up to the newest row.

        Raises:
            MsdError: the samples cannot be simulated.
        """
        self._at = _after_pauses(self._at, rows)
        begin = self._at.row - rows.first
        if len(rows) - begin < MINIMUM_SAMPLES:
            return
        time, measured = rows.column(TIME)[begin:], rows.column(POSITION)[begin:]
        state = self._at.state or _measured_state(time, measured)
        record = Record(time, measured, *self._force(forces, float(time[0])), hold=self._hold)
        made = Simulator(self.beside.model, record).trajectory(self.beside.model.values, *state)
        rows.column(MODEL)[begin:] = made.position
        if time[-1] - time[0] > self._span:
            back = time.size - MINIMUM_SAMPLES
            kept = None if self._free else (float(made.position[back]), float(made.velocity[back]))
            self._at = _Checkpoint(self._at.row + back, kept)

    def _force(self, forces: Track, start: float) -> tuple[FloatArray, FloatArray]:
        """Stamps and values that act from ``start`` on; 0 before the first."""
        time, force = forces.column(0), forces.column(1)
        first = int(np.searchsorted(time, start, side="right")) - 1
        time, force = time[max(first, 0) :], force[max(first, 0) :]
        if first < 0:
            time, force = np.insert(time, 0, start), np.insert(force, 0, 0.0)
        return time, -force if self.beside.turned else force


def _after_pauses(at: _Checkpoint, rows: Track) -> _Checkpoint:
    """The checkpoint, or the first row after the last pause behind it."""
    if at.row < rows.first:
        at = _Checkpoint(rows.first)
    pauses = np.flatnonzero(np.diff(rows.column(TIME)[at.row - rows.first :]) > PAUSE)
    return _Checkpoint(at.row + int(pauses[-1]) + 1) if pauses.size else at


def _measured_state(time: FloatArray, position: FloatArray) -> tuple[float, float]:
    """Position and velocity at the first sample, from a cubic through the first few."""
    t, x = time[:MINIMUM_SAMPLES] - time[0], position[:MINIMUM_SAMPLES]
    curve = np.polynomial.Polynomial.fit(t, x, 3)
    return float(curve(0.0)), float(curve.deriv()(0.0))
