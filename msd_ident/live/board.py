"""The state that all pages of the live view share, and the interface of the controls behind its buttons."""

from __future__ import annotations

import math
import threading
import time
from dataclasses import dataclass, field, replace
from typing import Protocol

from msd_ident.quantity import Quantity

#: Sentences that the page keeps.
LINES = 6


class Controls(Protocol):
    """What the buttons do. Each returns at once; the outcome goes to the board."""

    def step(self, force: float) -> None:
        """Command a force, in its unit, until the next one."""

    def record(self, on: bool) -> None:
        """Start or stop a recording."""

    def identify(self) -> None:
        """Fit the live buffer."""

    def diagnose(self) -> None:
        """Diagnose the live buffer."""

    def cancel(self) -> None:
        """Give up the diagnosis in progress."""

    def reset(self) -> None:
        """Encoder to zero, cart at rest."""


@dataclass(frozen=True)
class Row:
    """One parameter: canonical name, symbol and value."""

    name: str
    symbol: str
    quantity: Quantity


@dataclass(frozen=True)
class Estimated:
    """The present estimate.

    Attributes:
        rows: parameters that are shown, in order.
        see: standard error of estimate of the refined model, in the position unit.
        reduction_percent: against the original model, eq. 15; NaN where it does not apply.
        noise: what no model can beat, in the position unit.
        unit: of the position.
        source: ``live`` or a bag's path.
        samples, missing: position samples used, and those missing among them.
        remarks: warnings, and what the data leaves open, a sentence each.
    """

    rows: tuple[Row, ...]
    see: float
    reduction_percent: float
    noise: float
    unit: str
    source: str
    samples: int
    missing: int
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Cause:
    """A cause with its probability, its parameters, and those that the data cannot tell from it."""

    name: str
    probability: float
    rows: tuple[Row, ...]
    tied_with: tuple[str, ...]


@dataclass(frozen=True)
class Diagnosed:
    """The present verdict; the numbers as in the message of the same name.

    ``left_percent`` is the part of the motion that stays unexplained [%], ``force`` the missing force's rms and its
    95 % interval [force_unit].
    """

    verdict: str
    summary: str
    causes: tuple[Cause, ...]
    see_base: float
    see_extended: float
    heldout_percent: float
    heldout_interval: tuple[float, float]
    noise: float
    unit: str
    source: str
    left_percent: float = math.nan
    tolerance_percent: float = math.nan
    force: tuple[float, float, float] = (math.nan, math.nan, math.nan)
    force_unit: str = "N"
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class Job:
    """Something that takes a while: its stage in words, how much is done (0 to 1, NaN: nobody knows)."""

    stage: str
    fraction: float = math.nan


@dataclass(frozen=True)
class Line:
    """What came of something: when [s since the epoch], how it went, and a sentence."""

    at: float
    good: bool
    text: str


@dataclass(frozen=True)
class Known:
    """Everything that the page shows beside the curves.

    Attributes:
        force_unit, position_unit: of the curves.
        place: where the graph is, e.g. ``/msd``.
        data: how the measurements are doing: whether well, and a sentence.
        present: names of the controls that would be answered.
        estimated, diagnosed: the present results.
        beside: the model that runs beside the rig, in words; why none does.
        jobs: in progress, by the name of the control.
        recording: since when [s since the epoch]; ``None`` when no recording is in progress.
        bag: the folder of the recording in progress.
        step_force, step_limit: force of the next step and the greatest that is taken, in the force's unit.
        lines: what came of the latest requests, newest first.
    """

    force_unit: str = "N"
    position_unit: str = "m"
    place: str = ""
    data: tuple[bool, str] = (False, "waiting for the encoder")
    present: frozenset[str] = frozenset()
    estimated: Estimated | None = None
    diagnosed: Diagnosed | None = None
    beside: str = ""
    jobs: tuple[tuple[str, Job], ...] = ()
    recording: float | None = None
    bag: str = ""
    step_force: float = 1.0
    step_limit: float = 1.0
    lines: tuple[Line, ...] = ()

    def job(self, name: str) -> Job | None:
        """The job of a control, when one is in progress."""
        return dict(self.jobs).get(name)


@dataclass
class Board:
    """Holds what is known; written by one side, read by the other, from any thread.

    ``known`` is replaced as a whole, so a reader sees one state; another object means that something changed.
    """

    known: Known = field(default_factory=Known)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def tell(self, **changes: object) -> None:
        """Change some of what is known."""
        with self._lock:
            new = replace(self.known, **changes)  # type: ignore[arg-type]
            if new != self.known:
                self.known = new

    def say(self, good: bool, text: str) -> None:
        """Add a sentence."""
        with self._lock:
            lines = (Line(time.time(), good, text), *self.known.lines)[:LINES]
            self.known = replace(self.known, lines=lines)

    def begin(self, name: str, job: Job) -> None:
        """Something is in progress, or has got on."""
        with self._lock:
            jobs = {**dict(self.known.jobs), name: job}
            self.known = replace(self.known, jobs=tuple(jobs.items()))

    def end(self, name: str, good: bool, text: str) -> None:
        """It is over; how it went."""
        with self._lock:
            jobs = tuple(pair for pair in self.known.jobs if pair[0] != name)
            self.known = replace(self.known, jobs=jobs)
        self.say(good, text)
