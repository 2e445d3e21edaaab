"""A robot over days: the change is dated and sized, weather is no wear, and what cannot be watched is said."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from msd_ident.errors import DataError, SetupError, UsageError
from msd_ident.monitoring.changes import changes
from msd_ident.monitoring.history import History
from msd_ident.monitoring.watching import YEAR, Options, Sample, watch

DAY = 86400.0


def days(
    count: int, seed: int = 0, change: int | None = None, measured: bool = True, causes: int | None = None
) -> list[Sample]:
    """A robot whose stiffness swings by 5 % with the seasons, and falls by 3 % at a change."""
    lots, found = np.random.default_rng(seed), []
    for number in range(count):
        time = 1.7e9 + number * DAY
        temperature = 20.0 + 12.0 * math.cos(2.0 * math.pi * time / YEAR) + 2.0 * lots.normal()
        stiffness = 694.0 * (1.0 - 0.002 * (temperature - 20.0)) * (1.0 + 0.003 * lots.normal())
        stiffness *= 0.97 if change is not None and number >= change else 1.0
        values = {"mass": 0.94 + 1e-3 * lots.normal(), "damping": 3.9 + 0.05 * lots.normal(), "stiffness": stiffness}
        named = {} if causes is None else {"backlash": 0.99 if number >= causes else 0.02 * lots.uniform()}
        covariates = {"temperature": temperature} if measured else {}
        found.append(Sample(time, f"day {number}", values, {"stiffness": 2.0}, named, covariates))
    return found


def test_a_change_is_dated_sized_and_alarmed() -> None:
    found = watch("arm", days(130, change=100))
    assert found.moved_by == ("temperature",) and found.threshold == pytest.approx(365.25)
    (alarm,) = found.alarms
    assert 100 <= alarm.index <= 103 and alarm.what == "stiffness" and alarm.percent == pytest.approx(-3.0, abs=1.5)
    told = {one.name: one.changes for one in found.series}
    (change,) = told["stiffness"]
    assert change.index == 100 and change.probability > 0.99 and change.percent == pytest.approx(-3.0, abs=0.3)
    assert told["mass"] == () and told["damping"] == ()
    assert "stiffness changed by" in found.sentence and "at most 1 false alarm a year" in found.sentence


@pytest.mark.parametrize("measured", [True, False])
def test_seasons_are_no_wear(measured: bool) -> None:
    for seed in range(2):
        found = watch("arm", days(120, seed, measured=measured))
        assert found.alarms == () and "no alarm in 120 records" in found.sentence
        assert found.moved_by == (("temperature",) if measured else ("season",))


def test_a_cause_that_appears_is_alarmed() -> None:
    found = watch("arm", days(120, causes=80))
    assert found.alarms and found.alarms[0].what == "causes" and 80 <= found.alarms[0].index <= 90


def test_records_in_any_order_are_one_series() -> None:
    samples = days(40, change=25)
    shuffled = [samples[i] for i in np.random.default_rng(0).permutation(40)]
    assert watch("arm", shuffled).to_json_dict() == watch("arm", samples).to_json_dict()


def test_two_changes_are_two() -> None:
    lots = np.random.default_rng(4)
    values = 10.0 + 0.1 * lots.normal(size=90)
    values[30:] += 0.6
    values[60:] -= 1.2
    found = changes(values, np.empty((90, 0)))
    assert [one.index for one in found] == [30, 60]
    assert [round(one.after - one.before, 1) for one in found] == [0.6, -1.2]


def test_a_change_within_what_the_values_are_known_to_is_none() -> None:
    """Records that are all alike have no scatter: a step of 1e-5 was certain, and led the headline."""
    samples = days(14, measured=False)
    for number, sample in enumerate(samples):
        after = number >= 10
        values = {"mass": 0.94 + (1e-5 if after else 0.0), "stiffness": 672.0 if after else 694.0, "damping": 3.9}
        stds = {"mass": 6e-6, "stiffness": 4e-3, "damping": 1e-4}
        samples[number] = replace(sample, values=values, stds=stds)
    found = watch("arm", samples)
    assert [(one.what, one.index) for one in found.alarms] == [("stiffness", 10)]
    assert {one.name: len(one.changes) for one in found.series} == {"mass": 0, "damping": 0, "stiffness": 1}
    (change,) = next(one.changes for one in found.series if one.name == "stiffness")
    assert change.index == 10 and change.std == pytest.approx(4e-3 * math.sqrt(1 / 10 + 1 / 4))


def test_noise_and_constants_have_no_changes() -> None:
    assert changes(np.full(50, 3.0), np.empty((50, 0))) == ()
    lots = np.random.default_rng(5)
    told = [len(changes(lots.normal(size=60), np.empty((60, 0)))) for _ in range(8)]
    assert sum(told) <= 1


def test_too_few_records_and_rates_that_are_none_are_refused() -> None:
    with pytest.raises(DataError, match="arm has 5 records; expected at least 8 to watch it"):
        watch("arm", days(5))
    with pytest.raises(UsageError, match="0 false alarms a year; expected more than 0, at most 365"):
        Options(0.0)


def test_history_goes_on_after_a_restart(tmp_path: Path) -> None:
    samples, path = days(60, change=40, measured=False), tmp_path / "history.json"
    whole = History(tmp_path / "whole.json", 20, 500.0)
    alarms = [number for number, sample in enumerate(samples) if whole.add(sample).alarm]
    for sample in samples[:30]:
        History(path, 20, 500.0).add(sample)  # a new one each time: as after a restart
    assert History(path, 20, 500.0).standing.estimates == 30 and History(path, 20, 500.0).standing.kept == 20
    again = History(path, 20, 500.0)
    told = [number for number, sample in enumerate(samples[30:], 30) if again.add(sample).alarm]
    assert told == alarms and alarms and 40 <= alarms[0] <= 46
    assert "stiffness changed by -" in again.standing.alarm and "against the" in again.standing.sentence
    again.note()
    assert History(path, 20, 500.0).standing.alarm == ""


@pytest.mark.parametrize("text", ["no", '{"schema": "other"}', "[]"])
def test_a_file_that_is_no_history_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "history.json"
    path.write_text(text)
    with pytest.raises(SetupError, match="history of estimates"):
        History(path, 20, 500.0)


def test_a_history_with_another_covariate_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "history.json"
    History(path, 20, 500.0).add(days(1)[0])
    with pytest.raises(SetupError, match="was kept with nothing beside, now it is temperature"):
        History(path, 20, 500.0, ("temperature",))
