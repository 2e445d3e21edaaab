"""Limits: what a rig may be put through."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from msd_ident import strict_yaml
from msd_ident.design.profile import Profile, is_finite, shown
from msd_ident.errors import DataError, UsageError
from msd_ident.paths import check_plain

_NAMES = ("force", "travel", "speed", "duration")
_EXAMPLE = "force: 10, travel: 0.03, duration: 20, and speed: 1 if you like"


@dataclass(frozen=True)
class Limits:
    """What a rig may be put through.

    Attributes:
        force: least and greatest force [N, or the unit of the records]; 0 lies between them.
        travel: how far the encoder may read to either side of where the cart is at the start [m, or the unit of
            the records]; 0 lies between.
        duration: of one experiment [s].
        speed: greatest [m/s, or that unit a second]; infinite for no limit.

    Raises:
        UsageError: limits that leave no room.
    """

    force: tuple[float, float]
    travel: tuple[float, float]
    duration: float
    speed: float = math.inf

    def __post_init__(self) -> None:
        for what, (low, high) in (("force", self.force), ("travel", self.travel)):
            if not (math.isfinite(low) and math.isfinite(high)) or not low <= 0.0 <= high or low == high:
                raise UsageError(
                    f"limits: {what} from {low:g} to {high:g}; expected one number above 0, or two with 0 between them"
                )
        if not 0.0 < self.duration < math.inf:
            raise UsageError(f"limits: duration is {self.duration:g} s; expected more than 0 s")
        if not self.speed > 0.0:
            raise UsageError(f"limits: speed is {self.speed:g}; expected more than 0")

    @property
    def reach(self) -> float:
        """Greatest force either way [N]."""
        return max(self.force[1], -self.force[0])

    def room(self, low: float, high: float) -> float:
        """Factor by which readings may still grow before they leave the travel.

        Args:
            low, high: least and greatest reading [m] from where the cart is at the start.
        """
        return min(_growth(high, self.travel[1]), _growth(-low, -self.travel[0]))

    def force_room(self, low: float, high: float) -> float:
        """Factor by which forces may still grow before they leave the limits.

        Args:
            low, high: least and greatest force [N].
        """
        return min(_growth(high, self.force[1]), _growth(-low, -self.force[0]))

    def check(self, profile: Profile) -> None:
        """Refuse a profile that is beyond the limits of force or duration, before anything moves.

        Raises:
            UsageError: it is; the message gives the amount.
        """
        low, high = profile.extremes
        slack = 1e-9 * self.reach
        if low < self.force[0] - slack or high > self.force[1] + slack:
            raise UsageError(
                f"profile {profile.name!r} pushes from {low:g} to {high:g} {profile.unit}, the limits allow "
                f"{self.force[0]:g} to {self.force[1]:g}; expected a profile within them: scale it down"
            )
        if profile.duration > self.duration * (1.0 + 1e-9):
            raise UsageError(
                f"profile {profile.name!r} takes {profile.duration:g} s, the limits allow {self.duration:g} s; "
                "expected a shorter one"
            )

    def no_room(self, unit: str, length: str) -> UsageError:
        """The error where no profile fits; it says in which units the limits were taken.

        Args:
            unit, length: of force and position of the records.
        """
        force, travel = (f"{low:g} to {high:g}" for low, high in (self.force, self.travel))
        return UsageError(
            "no experiment has room within these limits; expected more force, travel, speed or time: raise them "
            f"(they are in the units of the records: force {force} {unit}, travel {travel} {length})"
        )

    def to_dict(self) -> dict[str, Any]:
        """As in a limits file."""
        found: dict[str, Any] = {"force": list(self.force), "travel": list(self.travel), "duration": self.duration}
        return found | ({"speed": self.speed} if math.isfinite(self.speed) else {})


def _growth(value: float, limit: float) -> float:
    return limit / value if value > 1e-300 else math.inf


def read_limits(path: Path) -> Limits:
    """Limits from a YAML file: the four names at its top, under ``limits:``, or so in a ROS parameter file.

    Raises:
        DataError: the file is not there, or does not say all that is needed.
    """
    check_plain(path, "limits in YAML")
    try:
        tree = strict_yaml.load(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        raise DataError(f"{path} is no text; expected limits in YAML") from None
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}; expected a limits file: {_EXAMPLE}") from None
    except strict_yaml.YAMLError as error:
        raise DataError(f"{path} is no YAML ({' '.join(str(error).split())}); expected {_EXAMPLE}") from None
    try:
        return from_tree(tree)
    except UsageError as error:
        raise DataError(f"{path}: {error}") from None


def from_tree(tree: Any) -> Limits:
    """Limits from a parsed file.

    Raises:
        UsageError: it does not hold them.
    """
    try:
        block = _block(tree)
    except RecursionError:
        raise UsageError(f"limits that hold themselves; expected {_EXAMPLE}") from None
    if block is None:
        raise UsageError(f"no limits found; expected {_EXAMPLE}")
    unknown = [str(name) for name in block if name not in _NAMES]
    if unknown:
        raise UsageError(f"limits: no limit is called {unknown[0]!r}; expected {', '.join(_NAMES)}")
    missing = [name for name in ("force", "travel", "duration") if name not in block]
    if missing:
        raise UsageError(f"limits: {missing[0]} is missing; expected {_EXAMPLE}")
    speed = _number("speed", block["speed"]) if "speed" in block else math.inf
    duration = _number("duration", block["duration"])
    return Limits(_pair("force", block["force"]), _pair("travel", block["travel"]), duration, speed)


def _block(tree: Any) -> Mapping[Any, Any] | None:
    """The mapping that holds the limits, wherever a file may have it."""
    if not isinstance(tree, Mapping):
        return None
    for key in ("limits", "ros__parameters"):
        if isinstance(tree.get(key), Mapping):
            return _block(tree[key])
    if any(name in tree for name in _NAMES):
        return tree
    inner = [_block(value) for value in tree.values() if isinstance(value, Mapping)]
    return next((block for block in inner if block is not None), None)


def _pair(name: str, value: Any) -> tuple[float, float]:
    if isinstance(value, list):
        if len(value) != 2:
            raise UsageError(f"limits: {name} has {len(value)} numbers; expected one, or two with 0 between them")
        return _number(name, value[0]), _number(name, value[1])
    size = _number(name, value)
    return 0.0 - size, size  # no minus zero


def _number(name: str, value: Any) -> float:
    if not is_finite(value):
        raise UsageError(f"limits: {name} is {shown(value)}; expected a finite number")
    return float(value)
