"""The scope: the latest samples of force and position, the simulated model, and frames for the page."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray, Hold
from msd_ident.errors import MsdError
from msd_ident.live.shadow import MODEL, POSITION, TIME, Beside, Shadow
from msd_ident.live.thinning import held, thinned
from msd_ident.live.track import Track

#: Rows that are kept: a minute at 1 kHz and some more.
CAPACITY = 80_000

Curve = tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class Frame:
    """What one window shows, thinned; SI.

    Attributes:
        start, end: of the window [s since the first sample].
        force, position, model, residual: time and values of each curve; residual = measured - model.
        force_now, position_now, model_now: the newest values, NaN where there is none.
        residual_rms: root of the mean square of the residual in the window, NaN without a model.
        noise: standard deviation of what no model can beat, NaN when it is not known.
        rate: position samples a second in the window; NaN where there are none.
    """

    start: float
    end: float
    force: Curve
    position: Curve
    model: Curve
    residual: Curve
    force_now: float
    position_now: float
    model_now: float
    residual_rms: float
    noise: float
    rate: float


class Scope:
    """Takes samples from one thread and gives frames to others; its memory does not grow.

    Args:
        capacity: rows of either signal that are kept.
        hold: how the force goes on between its samples.
    """

    def __init__(self, capacity: int = CAPACITY, hold: Hold = "zero") -> None:
        self._hold: Hold = hold
        self._rows = Track(capacity, 3)
        self._forces = Track(capacity, 2)
        self._shadow: Shadow | None = None
        self._zero_ns: int | None = None
        self._lock = threading.Lock()
        #: Why the model does not run; empty when it does, or when there is none.
        self.problem = ""

    def add_positions(self, ns: npt.NDArray[np.int64], values: FloatArray) -> None:
        """Take samples with their stamps [ns]; one that is not newer than the newest is left out."""
        with self._lock:
            self._take(self._rows, ns, values)

    def add_forces(self, ns: npt.NDArray[np.int64], values: FloatArray) -> None:
        """The same for the force."""
        with self._lock:
            self._take(self._forces, ns, values)

    def clear(self) -> None:
        """Forget all samples: the clock was set back."""
        with self._lock:
            self._rows.clear()
            self._forces.clear()
            self._zero_ns = None
            self._renew()

    def run_beside(self, beside: Beside | None) -> None:
        """Let another model run, over what is kept too."""
        with self._lock:
            self._shadow = None if beside is None else Shadow(beside, self._rows.first, self._hold)
            self.problem = ""
            if beside is None:
                self._rows.column(MODEL)[:] = np.nan

    def restart(self) -> None:
        """The rig was put back to its start: the model restarts with the samples to come."""
        with self._lock:
            self._renew()

    @property
    def beside(self) -> Beside | None:
        """The model that runs."""
        shadow = self._shadow
        return shadow.beside if shadow else None

    @property
    def knows_force(self) -> bool:
        """Whether any force was received."""
        return len(self._forces) > 0

    @property
    def bytes(self) -> int:
        """Memory of the samples."""
        return self._rows.bytes + self._forces.bytes

    def advance(self) -> None:
        """Let the model catch up with the newest sample."""
        with self._lock:
            if self._shadow is None or self.problem:
                return
            try:
                self._shadow.advance(self._rows, self._forces)
            except MsdError as error:
                self.problem = str(error)

    def frame(self, seconds: float, columns: int, keep: float = 0.0) -> Frame:
        """The last seconds, for so many columns of pixels; ``keep`` more seconds of the past come with them."""
        with self._lock:
            time, position, model = (self._rows.column(index) for index in (TIME, POSITION, MODEL))
            force_time, force = self._forces.column(0), self._forces.column(1)
            end = float(time[-1]) if time.size else 0.0
            start = end - seconds
            columns = max(columns, 10)
            window = (start - keep, end, math.ceil(columns * (seconds + keep) / seconds))
            # Nothing of this needs the lock, but the views do.
            inside = slice(int(np.searchsorted(time, start)), None)
            residual = position - model if keep else position[inside] - model[inside]
            within = residual[-time[inside].size :]
            return Frame(
                start=start,
                end=end,
                force=held(force_time, force, *window),
                position=thinned(time, position, *window),
                model=thinned(time, model, *window),
                residual=thinned(time if keep else time[inside], residual, *window),
                force_now=_last(force[: np.searchsorted(force_time, end, side="right")]),
                position_now=_last(position),
                model_now=_last(model),
                residual_rms=_rms(within),
                noise=self._shadow.beside.noise if self._shadow else math.nan,
                rate=_rate(time[inside]),
            )

    def _take(self, track: Track, ns: npt.NDArray[np.int64], values: FloatArray) -> None:
        if not ns.size:
            return
        if self._zero_ns is None:
            self._zero_ns = int(ns[0])
        time = (ns - self._zero_ns) / 1e9
        newest = track.column(TIME)[-1] if len(track) else -math.inf
        fresh = time > np.maximum.accumulate(np.insert(time, 0, newest)[:-1])
        if fresh.any():
            track.append(time[fresh], values[fresh])

    def _renew(self) -> None:
        self.problem = ""
        if self._shadow:
            self._shadow.restart(self._rows.first + len(self._rows))


def _last(values: FloatArray) -> float:
    return float(values[-1]) if values.size else math.nan


def _rms(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return math.sqrt(float(np.mean(known**2))) if known.size else math.nan


def _rate(time: FloatArray) -> float:
    return (time.size - 1) / float(time[-1] - time[0]) if time.size > 1 else math.nan
