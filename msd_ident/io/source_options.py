"""SourceOptions: which signals of a bag or table are the force and the position, and in which units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Literal

from msd_ident.data.record import Hold
from msd_ident.errors import UsageError
from msd_ident.io import units

#: Words for ``SourceOptions.hold``.
HOLDS = ("auto", "zero", "linear", "band_limited", "centred")

#: Options of which one takes the place of another.
_RIVALS = (
    frozenset({"time", "rate", "time_scale"}),
    frozenset({"force_scale", "force_unit"}),
    frozenset({"position_scale", "position_unit"}),
)
_LARGEST = 1e300

#: Value of ``force`` for a free decay.
NO_FORCE = "none"


@dataclass(frozen=True)
class SourceOptions:
    """What to read, and how.

    Attributes:
        force: ``TOPIC:FIELD`` (``/joint_states:effort[elbow]``, ``/force:wrench.force.x``), a topic alone, or a
            column of a table; ``none`` when no force acts (free decay); empty for the default: the topic or column
            called ``force``.
        position: the same; by default the topic called ``encoder`` or ``encoder_batch``, or the column ``position``.
        time: column of a table with the time; by default the one called ``time``.
        rate: samples a second of a file without times; its lines are taken as evenly spaced.
        run: number of the run, where a file has several side by side (``Position (mm) Run #1``); ``all`` for each as
            a record, see ``msd_ident.io.read_all``.
        force_scale: factor from the source's number to ``force_unit``; ``None`` takes what the unit in a column's
            name says, else 1. A negative factor changes the sign.
        position_scale: the same for the position.
        time_scale: factor from the numbers of the time column to seconds; ``None`` as above.
        force_unit: of the numbers after scaling: ``N``, ``N·m``, ``V`` …; empty for what the source says. The record
            is in N, N·m, V or A where it is a multiple of one (``kN``).
        position_unit: the same for the position: ``m``, ``rad``, ``count``; ``mm`` becomes m, ``deg`` becomes rad.
        hold: how the force goes on between its samples: ``zero`` (held), ``linear``, ``band_limited`` (no faster than
            its samples tell), ``centred`` (held from half a sample before its stamp), or ``auto``: held for topics,
            asked of the data for a table's force on the position's stamps.
        start: begin of the part to use [s from the first position sample]; ``None`` for all.
        end: end of that part [s].

    Raises:
        UsageError: a scale is 0 or not finite, or converts what the unit converts too, a rate or a run that is none, a
            rate stands beside a time column or its scale, or the window is empty.
    """

    force: str = ""
    position: str = ""
    time: str = ""
    force_scale: float | None = None
    position_scale: float | None = None
    time_scale: float | None = None
    force_unit: str = ""
    position_unit: str = ""
    hold: Literal["auto", "zero", "linear", "band_limited", "centred"] = "auto"
    start: float | None = None
    end: float | None = None
    rate: float | None = None
    run: str = ""

    def __post_init__(self) -> None:
        for name in ("force_scale", "position_scale", "time_scale"):
            scale = getattr(self, name)
            if scale is not None and (scale == 0 or not math.isfinite(scale)):
                raise UsageError(
                    f"{name.replace('_', ' ')} is {scale}; expected a finite number other than 0: the size of the "
                    "record's unit, such as 0.001"
                )
        if self.time_scale is not None and self.time_scale < 0.0:
            raise UsageError(
                f"time scale is {self.time_scale:g}; expected a number above 0, the seconds in one unit of the time "
                "column, such as 0.001: times cannot be inverted"
            )
        for quantity, unit, scale in (
            (units.FORCE, self.force_unit, self.force_scale),
            (units.POSITION, self.position_unit, self.position_scale),
        ):
            units.of_option(quantity, unit, scale)  # refuses a scale that converts what the unit converts
        if self.rate is not None and not (self.rate > 0.0 and math.isfinite(self.rate)):
            raise UsageError(f"rate is {self.rate:g}; expected a sampling rate above 0, e.g. --rate 100")
        if self.rate is not None and self.time:
            raise UsageError(
                f"a rate of {self.rate:g} and the time column {self.time}; expected one of them: leave --rate or "
                "--time away"
            )
        if self.rate is not None and self.time_scale is not None:
            raise UsageError(
                f"a rate of {self.rate:g} and a time scale of {self.time_scale:g}; expected one of them: leave --rate "
                "or --time-scale away"
            )
        if self.run and self.run != "all" and not self.run.isdecimal():
            raise UsageError(f"run is {self.run!r}; expected its number, or all, e.g. --run 2")
        if self.hold not in HOLDS:
            raise UsageError(f"hold is {self.hold!r}; expected one of {', '.join(HOLDS)}")
        start, end = self.window
        if not start < end:
            raise UsageError(f"the window from {start:g} s to {end:g} s is empty; expected start before end")

    def beside(self, earlier: Mapping[str, Any]) -> SourceOptions:
        """These options, and those of an earlier reading (``chosen``) that none of these takes the place of.

        Raises:
            UsageError: an option that there is none of, or a value of another type.
        """
        words = {one.name: isinstance(one.default, str) for one in fields(self)}
        kept = dict(self.chosen)
        for name, value in earlier.items():
            number = isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < _LARGEST
            if name not in words or not (isinstance(value, str) if words[name] else number):
                raise UsageError(f"{name} is {value!r:.40}; expected an option of how a record is read, and its value")
            rivals = next((group for group in _RIVALS if name in group), frozenset({name}))
            if rivals.isdisjoint(self.chosen):
                kept[name] = value
        return SourceOptions(**kept)

    @property
    def chosen(self) -> dict[str, Any]:
        """The options that are not the default, by name; an open end of the window is none."""
        found = {one.name: value for one in fields(self) if (value := getattr(self, one.name)) != one.default}
        return {name: value for name, value in found.items() if isinstance(value, str) or math.isfinite(value)}

    @property
    def no_force(self) -> bool:
        """Whether the record is a free decay."""
        return self.force.strip().lower() == NO_FORCE

    @property
    def as_force(self) -> tuple[str, float]:
        """Unit of the record for ``force_unit``, empty where that is, and factor from the source's numbers to it."""
        return units.of_option(units.FORCE, self.force_unit, self.force_scale)

    @property
    def as_position(self) -> tuple[str, float]:
        """The same for ``position_unit``."""
        return units.of_option(units.POSITION, self.position_unit, self.position_scale)

    @property
    def record_hold(self) -> Hold:
        """Hold of the record as it is read, before the data is asked or a band-limited force is interpolated."""
        return "linear" if self.hold == "linear" else "zero"

    @property
    def window(self) -> tuple[float, float]:
        """Part to use [s], infinite where open."""
        return (-math.inf if self.start is None else self.start, math.inf if self.end is None else self.end)
