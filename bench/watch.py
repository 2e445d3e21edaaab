"""``python -m bench.watch``: simulated years of daily estimates, with a yearly temperature swing larger than the wear.

The estimates are drawn, not identified from 73 000 records: a stiffness that swings by 5 % with the seasons and the
weather, with 0.3 % of its own scatter from day to day, mass, damping and friction with theirs, causes' probabilities.

    python -m bench.watch --years 200
"""

from __future__ import annotations

import argparse
import json
import math
import time
from typing import Any

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.monitoring.watching import YEAR, Options, Sample, alarms_of, regressors_of, watch

DAY = 86400.0
DAYS = 365
#: Swing of the stiffness over a year, its scatter from day to day, the change that must be found.
SWING, SCATTER, CHANGE = 0.05, 0.003, 0.03


def weather(lots: np.random.Generator, times: FloatArray) -> FloatArray:
    """Temperature [°C]: the season, and weather of a few days."""
    found, days = np.zeros(times.size), lots.normal(size=times.size)
    for number in range(1, times.size):
        found[number] = 0.8 * found[number - 1] + 1.8 * days[number]
    return 20.0 + 12.0 * np.cos(2.0 * np.pi * times / YEAR) + found


def year(lots: np.random.Generator, measured: bool, change: int = DAYS) -> list[Sample]:
    """One robot's year of daily estimates; the stiffness falls on the day of the change."""
    times = 1.7e9 + DAY * (np.arange(DAYS) + lots.integers(DAYS))
    warm = weather(lots, times)
    stiffness = 694.0 * (1.0 - SWING / 24.0 * (warm - 20.0)) * (1.0 + SCATTER * lots.normal(size=DAYS))
    stiffness[change:] *= 1.0 - CHANGE
    told = warm + 0.3 * lots.normal(size=DAYS)
    found = []
    for day in range(DAYS):
        values = {
            "mass": 0.94 * (1.0 + 0.001 * lots.normal()),
            "damping": 3.9 * (1.0 + 0.02 * lots.normal()),
            "stiffness": float(stiffness[day]),
            "coulomb_force": 0.12 * (1.0 + 0.05 * lots.normal()),
        }
        causes = {"coulomb_friction": 0.999, "backlash": float(0.1 * lots.uniform())}
        beside = {"temperature": float(told[day])} if measured else {}
        found.append(Sample(float(times[day]), f"day {day}", values, {}, causes, beside))
    return found


def study(years: int, measured: bool, rate: float, seed: int) -> dict[str, Any]:
    """False alarms of years without a change, and delays of years with one."""
    lots, began = np.random.default_rng(seed), time.perf_counter()
    false = [len(_rung(year(lots, measured), measured, rate)) for _ in range(years)]
    delays = []
    for _ in range(max(years // 2, 1)):
        change = int(lots.integers(60, DAYS - 30))
        behind = [day - change + 1 for day in _rung(year(lots, measured, change), measured, rate) if day >= change]
        delays.append(behind[0] if behind else math.inf)
    dates = [_dated(lots, measured, rate) for _ in range(max(years // 20, 1))]
    return {
        "temperature": "measured" if measured else "not measured",
        "stated, a robot-year": rate,
        "robot-years": years,
        "false alarms, a robot-year": sum(false) / years,
        "most in one year": max(false),
        "changes": len(delays),
        "delay, median and largest [records]": [float(np.median(delays)), max(delays)],
        "found within 10 [%]": 100.0 * sum(delay <= 10 for delay in delays) / len(delays),
        "change points, dated within 2 records [%]": 100.0 * sum(dates) / len(dates),
        "seconds": time.perf_counter() - began,
    }


def _rung(samples: list[Sample], measured: bool, rate: float) -> list[int]:
    """Days on which the alarm rang."""
    regressors = np.array([regressors_of(sample, ("temperature" if measured else "season",)) for sample in samples])
    return [alarm.index for alarm in alarms_of(samples, regressors, DAYS / rate)[1]]


def _dated(lots: np.random.Generator, measured: bool, rate: float) -> bool:
    """Whether a change in the middle of a year has its change point where it came."""
    change = int(lots.integers(60, DAYS - 60))
    found = watch("robot", year(lots, measured, change), Options(rate, float(DAYS)))
    told = [one.index for series in found.series if series.name == "stiffness" for one in series.changes]
    return any(abs(index - change) <= 2 for index in told)


def main() -> None:
    """Print a JSON object for each case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--years", type=int, default=20)
    parser.add_argument("--rate", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    for measured in (True, False):
        print(json.dumps(study(given.years, measured, given.rate, given.seed), ensure_ascii=False), flush=True)


if __name__ == "__main__":
    main()
