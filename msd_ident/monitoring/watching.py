"""A robot's records in the order of time: series, change points, and one alarm for all that is watched."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from msd_ident import seeds
from msd_ident.data.record import FloatArray
from msd_ident.errors import DataError, UsageError
from msd_ident.model.base_model import FRICTION_FORCE, PLANT
from msd_ident.monitoring.alarm import Detector, Ranks, Regression, rank_evidence, shift_evidence
from msd_ident.monitoring.changes import Change, changes
from msd_ident.quantity import counted, probability

SCHEMA = "msd.watch/1"
#: Parameters that are watched: those that every model has, so that a series has no gaps.
WATCHED = (*PLANT, FRICTION_FORCE)
#: What moves a parameter without any wear, where a record has it.
COVARIATES = ("temperature", "load")
YEAR = 365.25 * 86400.0
#: Part of the records that must have a covariate for it to be used.
_ENOUGH = 0.8
#: Records below which nothing can be watched.
FEWEST = 8


@dataclass(frozen=True)
class Sample:
    """What one record says.

    Attributes:
        time: when [s since 1970]; NaN where nobody knows.
        name: of the record.
        values, stds: parameters by name; those that the data leaves open are not there.
        causes: probability by cause.
        covariates: by name.
    """

    time: float
    name: str
    values: Mapping[str, float]
    stds: Mapping[str, float]
    causes: Mapping[str, float] = field(default_factory=dict)
    covariates: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Options:
    """How a robot is watched.

    Attributes:
        rate: false alarms a year at most, on average.
        records_per_year: how often it is recorded; 0: as the records' times say, or daily where they have none.

    Raises:
        UsageError: a rate that is none.
    """

    rate: float = 1.0
    records_per_year: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.rate <= 365.0:
            raise UsageError(f"{self.rate:g} false alarms a year; expected more than 0, at most 365")
        if not (self.records_per_year >= 0.0 and math.isfinite(self.records_per_year)):
            raise UsageError(f"{self.records_per_year:g} records a year; expected a number above 0")


@dataclass(frozen=True)
class Alarm:
    """The alarm's detector passed its threshold.

    Attributes:
        index: of the record.
        what: the number that contributed most.
        percent: its change against the level before, where it is a parameter; NaN otherwise.
    """

    index: int
    what: str
    percent: float


@dataclass(frozen=True)
class Series:
    """One parameter over the records: indices of those that have it, values, standard deviations, change points."""

    name: str
    index: tuple[int, ...]
    values: FloatArray
    stds: FloatArray
    changes: tuple[Change, ...]


@dataclass(frozen=True)
class Watch:
    """What was found of one robot.

    Attributes:
        name: of the robot (and joint).
        samples: its records, in the order of time.
        series: its parameters.
        statistic: (n,) M of all that is watched together, after each record.
        threshold: A: the mean number of records to a false alarm is at least this.
        alarms: where M passed it; monitoring restarts after each.
        moved_by: what was taken to move parameters without wear.
        rate: false alarms a year that the threshold stands for.
    """

    name: str
    samples: tuple[Sample, ...]
    series: tuple[Series, ...]
    statistic: FloatArray
    threshold: float
    alarms: tuple[Alarm, ...]
    moved_by: tuple[str, ...]
    rate: float

    @property
    def sentence(self) -> str:
        """What was found, in words."""
        if self.alarms:
            last = self.alarms[-1]
            sized = f" by {last.percent:+.2g} %" if math.isfinite(last.percent) else ""
            outcome = f"{last.what} changed{sized}: alarm at {self.samples[last.index].name}"
        else:
            outcome = "no alarm"
        found = [(change, one) for one in self.series for change in one.changes]
        listed = ", ".join(
            f"{one.name} {change.percent:+.2g} % at {self.samples[one.index[change.index]].name} "
            f"(p {probability(change.probability)})"
            for change, one in found
        )
        return (
            f"{outcome} in {len(self.samples)} records, at most {counted(f'{self.rate:g}', 'false alarm')} a year "
            "on average"
            f"{'; change points: ' + listed if listed else '; no change points'}"
        )

    def to_json_dict(self) -> dict[str, Any]:
        """The contract ``msd.watch/1``."""
        return {
            "schema": SCHEMA,
            "robot": self.name,
            "records": len(self.samples),
            "sentence": self.sentence,
            "false_alarms_per_year": self.rate,
            "threshold": self.threshold,
            "statistic": float(self.statistic[-1]) if self.statistic.size else 0.0,
            "moved_by": list(self.moved_by),
            "alarms": [
                {"record": self.samples[a.index].name, "what": a.what, "change_percent": a.percent} for a in self.alarms
            ],
            "change_points": [
                {
                    "parameter": one.name,
                    "record": self.samples[one.index[change.index]].name,
                    "probability": change.probability,
                    "before": change.before,
                    "after": change.after,
                    "std": change.std,
                }
                for one in self.series
                for change in one.changes
            ],
        }


def watch(name: str, samples: Sequence[Sample], options: Options = Options()) -> Watch:  # noqa: B008 - frozen
    """Watch one robot.

    Args:
        name: of it.
        samples: its records, in any order; those without a time keep theirs.
        options: the rate of false alarms.

    Raises:
        DataError: too few records.
    """
    if len(samples) < FEWEST:
        had = counted(str(len(samples)), "record")
        raise DataError(f"{name or 'the table'} has {had}; expected at least {FEWEST} to watch it")
    timed = all(math.isfinite(sample.time) for sample in samples)
    ordered = tuple(sorted(samples, key=lambda sample: sample.time)) if timed else tuple(samples)
    moved_by = _moved_by(ordered, timed)
    regressors = np.array([regressors_of(sample, moved_by) for sample in ordered])
    per_year = options.records_per_year or _per_year(ordered, timed)
    threshold = max(per_year / options.rate, 2.0)
    statistic, alarms = alarms_of(ordered, regressors, threshold)
    series = [_series(parameter, ordered, regressors) for parameter in WATCHED]
    kept = tuple(one for one in series if one is not None)
    return Watch(name, ordered, kept, statistic, threshold, alarms, moved_by, options.rate)


def _moved_by(samples: Sequence[Sample], timed: bool) -> tuple[str, ...]:
    """Covariates that nearly all records have; without a temperature the seasons, where the times are known."""

    def there(name: str) -> bool:
        known = [s.covariates[name] for s in samples if math.isfinite(s.covariates.get(name, math.nan))]
        return len(known) >= _ENOUGH * len(samples) and float(np.ptp(known)) > 0.0

    found = tuple(name for name in COVARIATES if there(name))
    return found if "temperature" in found or not timed else (*found, "season")


def regressors_of(sample: Sample, moved_by: Sequence[str]) -> FloatArray:
    """The constant and what moves a parameter, of one record; NaN where the record lacks it."""
    row = [1.0]
    for name in moved_by:
        if name == "season":
            phase = 2.0 * math.pi * sample.time / YEAR
            row += [math.cos(phase), math.sin(phase)]
        else:
            row.append(sample.covariates.get(name, math.nan))
    return np.array(row)


def _per_year(samples: Sequence[Sample], timed: bool) -> float:
    if not timed:
        return 365.25
    span = samples[-1].time - samples[0].time
    return 365.25 if span <= 0.0 else (len(samples) - 1) * YEAR / span


class Watchers:
    """All detectors of one robot: four fifths of the stake are on its parameters, one on its causes."""

    def __init__(self, size: int) -> None:
        self.regressions = {name: Regression(size) for name in WATCHED}
        self.detectors = {name: Detector() for name in (*WATCHED, "causes")}
        self.ranks = Ranks(seeds.MONITORING)

    def update(self, sample: Sample, regressors: FloatArray) -> float:
        """M after a further record."""
        whole = bool(np.all(np.isfinite(regressors)))
        for name, regression in self.regressions.items():
            value = sample.values.get(name, math.nan)
            own = sample.stds.get(name, 0.0)
            own = own if math.isfinite(own) else 0.0
            score = regression.update(value, regressors, own) if whole and math.isfinite(value) else math.nan
            if math.isfinite(score):  # without a bet a detector stays where it is
                self.detectors[name].update(shift_evidence(score))
        if sample.causes:
            self.detectors["causes"].update(rank_evidence(self.ranks.update(max(sample.causes.values()))))
        return self.value

    def levels(self, regressors: FloatArray) -> dict[str, float]:
        """What is expected of each parameter in a further record."""
        return {name: one.level_at(regressors) for name, one in self.regressions.items()}

    def state(self) -> dict[str, Any]:
        """Parameters and detectors as plain values; causes are not in it."""
        return {
            "regressions": {name: one.state() for name, one in self.regressions.items()},
            "detectors": {name: one.value for name, one in self.detectors.items()},
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from where others were."""
        for name, one in self.regressions.items():
            one.restore(state["regressions"][name])
        for name, detector in self.detectors.items():
            detector.value = float(state["detectors"][name])

    @property
    def value(self) -> float:
        """M of all together."""
        of = [self.detectors[name].value for name in WATCHED]
        return 0.8 * sum(of) / len(of) + 0.2 * self.detectors["causes"].value

    def leading(self) -> str:
        """What contributes most."""
        return max(self.detectors, key=lambda name: self.detectors[name].value)


def alarms_of(
    samples: Sequence[Sample], regressors: FloatArray, threshold: float
) -> tuple[FloatArray, tuple[Alarm, ...]]:
    """M after each record, and where it passed the threshold; monitoring restarts after each alarm.

    Args:
        samples: in the order of time.
        regressors: (n, q) of each, the constant first.
        threshold: mean number of records to a false alarm, at least.
    """
    watchers, statistic, alarms = Watchers(regressors.shape[1]), [], []
    for index, sample in enumerate(samples):
        levels = watchers.levels(regressors[index])
        statistic.append(watchers.update(sample, regressors[index]))
        if statistic[-1] >= threshold:
            what = watchers.leading()
            alarms.append(Alarm(index, what, percent(sample.values.get(what, math.nan), levels.get(what, math.nan))))
            watchers = Watchers(regressors.shape[1])
    return np.array(statistic), tuple(alarms)


def percent(value: float, level: float) -> float:
    """A value against the level that was expected [%]."""
    return 100.0 * (value - level) / abs(level) if level else math.nan


def _series(name: str, samples: Sequence[Sample], regressors: FloatArray) -> Series | None:
    index = [
        i
        for i, sample in enumerate(samples)
        if math.isfinite(sample.values.get(name, math.nan)) and np.all(np.isfinite(regressors[i]))
    ]
    if not index:
        return None
    values = np.array([samples[i].values[name] for i in index])
    stds = np.array([samples[i].stds.get(name, math.nan) for i in index])
    return Series(name, tuple(index), values, stds, changes(values, regressors[index][:, 1:], stds))
