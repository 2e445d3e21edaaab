"""The last estimates of one rig in a file, with the state of the alarm, across restarts of a program."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident.errors import SetupError
from msd_ident.monitoring.watching import Sample, Watchers, percent, regressors_of
from msd_ident.writing import writing_to

SCHEMA = "msd.history/1"


@dataclass(frozen=True)
class Standing:
    """How the watch stands.

    Attributes:
        estimates: seen since it began, or since its last alarm.
        kept: in the file.
        statistic: M of the alarm.
        threshold: smallest mean number of estimates until a false alarm.
        alarm: the last one in words; empty where there was none, or where somebody took note of it.
    """

    estimates: int
    kept: int
    statistic: float
    threshold: float
    alarm: str = ""

    @property
    def sentence(self) -> str:
        """In words."""
        if self.alarm:
            return self.alarm
        return f"no change in {self.estimates} estimates; one false alarm in {self.threshold:g} estimates at most"


class History:
    """Estimates of one rig.

    Args:
        path: of the file; it is made where it is not there.
        size: estimates that are kept, the newest.
        threshold: smallest mean number of estimates until a false alarm.
        moved_by: covariates that move parameters without wear.

    Raises:
        SetupError: the file is of something else, or cannot be read.
    """

    def __init__(self, path: Path, size: int, threshold: float, moved_by: tuple[str, ...] = ()) -> None:
        self._path, self._size, self._threshold, self._moved_by = path, size, threshold, moved_by
        self._watchers = Watchers(1 + len(moved_by))
        self._kept: list[dict[str, Any]] = []
        self._estimates, self._alarm = 0, ""
        if path.exists():
            self._restore(self._read())

    @property
    def standing(self) -> Standing:
        """How the watch stands."""
        return Standing(self._estimates, len(self._kept), self._watchers.value, self._threshold, self._alarm)

    def add(self, sample: Sample) -> Standing:
        """Take a further estimate.

        Raises:
            SetupError: the disk does not take it; it counts nevertheless.
        """
        row = regressors_of(sample, self._moved_by)
        levels = self._watchers.levels(row) if np.all(np.isfinite(row)) else {}
        self._watchers.update(sample, row)
        self._estimates += 1
        self._kept = [*self._kept, _plain(sample)][-self._size :]
        if self._watchers.value >= self._threshold:
            what = self._watchers.leading()
            size = percent(sample.values.get(what, math.nan), levels.get(what, math.nan))
            self._alarm = (
                f"{what} changed by {size:+.2g} % against the {self._estimates - 1} estimates before {sample.name}; "
                f"one false alarm in {self._threshold:g} estimates at most"
            )
            self._watchers, self._estimates = Watchers(1 + len(self._moved_by)), 0
        self._write()
        return self.standing

    def note(self) -> None:
        """Somebody took note of the alarm."""
        if self._alarm:
            self._alarm = ""
            self._write()

    def _read(self) -> Mapping[str, Any]:
        try:
            found = json.loads(self._path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise SetupError(f"cannot read {self._path} ({error}); expected a history of estimates") from None
        if not isinstance(found, dict) or found.get("schema") != SCHEMA:
            raise SetupError(f"{self._path} is no history of estimates ({SCHEMA}); expected one, or a new name")
        return found

    def _restore(self, found: Mapping[str, Any]) -> None:
        if found["moved_by"] != list(self._moved_by):
            before, now = (", ".join(one) or "nothing" for one in (found["moved_by"], self._moved_by))
            raise SetupError(
                f"{self._path} was kept with {before} beside, now it is {now}; expected the same: a new name"
            )
        self._kept, self._estimates, self._alarm = list(found["estimates"]), found["since"], found["alarm"]
        self._watchers.restore(found["state"])

    def _write(self) -> None:
        content = {
            "schema": SCHEMA,
            "moved_by": list(self._moved_by),
            "since": self._estimates,
            "alarm": self._alarm,
            "state": self._watchers.state(),
            "estimates": self._kept,
        }
        there = self._path.with_name(f"{self._path.name}.tmp")
        with writing_to(self._path, "a file that takes it"):
            there.write_text(json.dumps(content), encoding="utf-8")
            os.replace(there, self._path)


def _plain(sample: Sample) -> dict[str, Any]:
    covariates = {name: value for name, value in sample.covariates.items() if math.isfinite(value)}
    time = sample.time if math.isfinite(sample.time) else None
    plain = {"time": time, "name": sample.name, "values": dict(sample.values), "stds": dict(sample.stds)}
    return {**plain, "covariates": covariates}
