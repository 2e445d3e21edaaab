"""Profile: a force over time, made of segments, that can be played on a rig."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.errors import UsageError
from msd_ident.tuning import fixed

Kind = Literal["step", "hold", "ramp", "sweep", "prbs", "release", "table"]

#: What each kind of segment needs besides its duration, with what it means.
NEEDS: Mapping[Kind, tuple[str, ...]] = {
    "step": ("force",),
    "hold": (),
    "ramp": ("force",),
    "sweep": ("amplitude", "low_hz", "high_hz"),
    "prbs": ("amplitude", "shortest"),
    "release": (),
    "table": ("time", "values"),
}
#: What it may have.
MAY: Mapping[Kind, tuple[str, ...]] = {"sweep": ("offset",), "prbs": ("offset", "seed")}
_POSITIVE = ("low_hz", "high_hz", "shortest")
RATE = fixed(250.0, "interface", "commands a second, unless a profile says otherwise")
MOST_COMMANDS = fixed(1_000_000, "interface", "commands of a profile, at most")
MOST_RATE = fixed(10_000.0, "interface", "commands a second, at most")
LONGEST = fixed(86_400.0, "interface", "duration of a profile [s], at most: a day")


def is_finite(value: Any) -> bool:
    """Whether a value of a file is a finite number; a whole number may be larger than any float."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return -sys.float_info.max <= value <= sys.float_info.max


def shown(value: Any) -> str:
    """A value of a file in a message, without the digits of a number that no float holds."""
    return "beyond 1e308" if isinstance(value, int) and abs(value) > sys.float_info.max else repr(value)


@dataclass(frozen=True)
class Segment:
    """One part of a profile.

    Attributes:
        kind: ``step`` jumps to ``force`` and stays; ``hold`` goes on with the force there is; ``ramp`` goes to
            ``force`` in a straight line; ``sweep`` is a sine whose frequency rises (or falls) exponentially from
            ``low_hz`` to ``high_hz``; ``prbs`` jumps between ``offset`` ± ``amplitude`` at random, each level held for
            ``shortest`` or a whole multiple of it; ``release`` lets go; ``table`` is a list of forces, each held.
        duration: [s].
        force, amplitude, offset: [N].
        low_hz, high_hz: [Hz].
        shortest: [s].
        seed: of the random train.
        time, values: (n,) instants [s] from the segment's start and forces [N] of a table.
    """

    kind: Kind
    duration: float
    force: float = 0.0
    amplitude: float = 0.0
    offset: float = 0.0
    low_hz: float = 0.0
    high_hz: float = 0.0
    shortest: float = 0.0
    seed: int = 0
    time: tuple[float, ...] = ()
    values: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.kind not in NEEDS:
            raise UsageError(f"no kind of segment is called {self.kind!r}; expected one of {', '.join(NEEDS)}")
        for name in ("duration", "force", "amplitude", "offset", "low_hz", "high_hz", "shortest"):
            value = getattr(self, name)
            if not is_finite(value):
                raise UsageError(f"segment {self.kind}: {name} is {shown(value)}; expected a finite number")
        if not 0.0 < self.duration <= LONGEST:
            raise UsageError(
                f"segment {self.kind}: duration is {self.duration:g} s; expected more than 0 s and at most a day"
            )
        for name in set(_POSITIVE) & set(NEEDS[self.kind]):
            if getattr(self, name) <= 0.0:
                raise UsageError(f"segment {self.kind}: {name} is {getattr(self, name):g}; expected more than 0")
        _check_table(self)

    def scaled(self, factor: float) -> Segment:
        """The same with all its forces multiplied."""
        return replace(
            self,
            force=self.force * factor,
            amplitude=self.amplitude * factor,
            offset=self.offset * factor,
            values=tuple(value * factor for value in self.values),
        )

    def to_dict(self) -> dict[str, Any]:
        """The segment as it stands in a profile file."""
        names = (*NEEDS[self.kind], *(n for n in MAY.get(self.kind, ()) if getattr(self, n)))
        found = {name: getattr(self, name) for name in names}
        return {"kind": self.kind, "duration": self.duration, **{k: _plain(v) for k, v in found.items()}}

    def commands(self, before: float, rate: float) -> tuple[FloatArray, FloatArray]:
        """Commands of a segment, each of which is held until the next.

        Args:
            before: force at the end of the segment before [N].
            rate: commands per second in ramps and sweeps [Hz].

        Returns:
            Instants (n,) from the segment's start [s] and forces (n,) [N].
        """
        if self.kind in ("step", "hold", "release"):
            return np.zeros(1), np.array([{"step": self.force, "hold": before, "release": 0.0}[self.kind]])
        if self.kind == "table":
            return np.asarray(self.time), np.asarray(self.values)
        if self.kind == "prbs":
            return self._random_train()
        time = np.arange(max(math.ceil(self.duration * rate - 1e-9), 1)) / rate
        if self.kind == "ramp":
            middle = np.minimum(time + 0.5 / rate, self.duration)  # half a step ahead: no lag on average
            return time, before + (self.force - before) * middle / self.duration
        growth = math.log(self.high_hz / self.low_hz) / self.duration
        turns = self.low_hz * (np.expm1(growth * time) / growth if growth else time)
        return time, self.offset + self.amplitude * np.sin(2.0 * np.pi * turns)

    def _random_train(self) -> tuple[FloatArray, FloatArray]:
        bits = max(math.ceil(self.duration / self.shortest - 1e-9), 1)
        signs = np.random.default_rng(self.seed).choice((-1.0, 1.0), size=bits)
        return np.asarray(self.shortest * np.arange(bits)), np.asarray(self.offset + self.amplitude * signs)


def _check_table(segment: Segment) -> None:
    if segment.kind != "table":
        return
    time, values = np.asarray(segment.time), np.asarray(segment.values)
    if time.size == 0 or time.size != values.size or not (np.isfinite(time).all() and np.isfinite(values).all()):
        raise UsageError(
            f"a table of {time.size} instants and {values.size} forces; expected finite numbers, as many of each"
        )
    if time[0] != 0.0 or np.any(np.diff(time) <= 0.0) or time[-1] >= segment.duration:
        raise UsageError("a table whose instants do not rise from 0 to less than its duration; expected them to")


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


@dataclass(frozen=True)
class Profile:
    """A force over time: segments one after the other, and 0 at the end.

    Attributes:
        segments: at least one.
        name: a few words for tables.
        unit: of the force.
        rate: commands a second in ramps and sweeps [Hz].

    Raises:
        UsageError: no segments, an impossible rate, or more commands than anything could play.
    """

    segments: tuple[Segment, ...]
    name: str = "profile"
    unit: str = "N"
    rate: float = RATE

    def __post_init__(self) -> None:
        if not self.segments:
            raise UsageError("a profile without segments; expected at least one")
        if not 0.0 < self.rate <= MOST_RATE:
            raise UsageError(f"a profile with {self.rate:g} commands a second; expected more than 0, at most 10000")
        expected = sum(
            s.duration * self.rate if s.kind in ("ramp", "sweep") else s.duration / (s.shortest or s.duration)
            for s in self.segments
        )
        if expected > MOST_COMMANDS or self.duration > LONGEST:
            raise UsageError(
                f"a profile of {self.duration:g} s with about {expected:.3g} commands; expected at most "
                f"{MOST_COMMANDS} in a day: lower its rate"
            )

    @property
    def duration(self) -> float:
        """From the first command to the last, which sets the force to 0 [s]."""
        return sum(segment.duration for segment in self.segments)

    @cached_property
    def commands(self) -> tuple[FloatArray, FloatArray]:
        """Instants (n,) [s] from 0 on and the force (n,) [N] from each on, without repetitions; the last is 0."""
        times, forces = [], []
        begin, before = 0.0, 0.0
        for segment in self.segments:
            time, force = segment.commands(before, self.rate)
            inside = time < segment.duration - 1e-12
            times.append(begin + time[inside])
            forces.append(force[inside])
            begin += segment.duration
            before = segment.force if segment.kind == "ramp" else float(force[inside][-1])
        time, force = np.concatenate([*times, [begin]]), np.concatenate([*forces, [0.0]])
        keep = np.concatenate(([True], np.diff(force) != 0.0))
        keep[-1] = True
        return time[keep], force[keep]

    @property
    def extremes(self) -> tuple[float, float]:
        """Least and greatest force [N]."""
        force = self.commands[1]
        return float(force.min()), float(force.max())

    def force_at(self, time: FloatArray) -> FloatArray:
        """Force (n,) [N] at instants (n,) [s]; 0 before and after."""
        at, force = self.commands
        index = np.searchsorted(at, time, side="right") - 1
        return np.where(index < 0, 0.0, force[np.maximum(index, 0)])

    def scaled(self, factor: float) -> Profile:
        """The same with all forces multiplied."""
        return Profile(tuple(segment.scaled(factor) for segment in self.segments), self.name, self.unit, self.rate)
