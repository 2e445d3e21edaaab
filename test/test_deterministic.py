"""The same record gives the same verdict and the same next experiment: whatever the clock says, on one core or many."""

from __future__ import annotations

import os
import time

import pytest
from designrigs import LIMITS, stepped

from msd_ident.design import Proposal, check, searching
from msd_ident.diagnose import Diagnosis
from msd_ident.pipeline import diagnose
from msd_ident.record import Record
from msd_sim import lottery
from msd_sim.api import simulate

CLOCKS = ("process_time", "perf_counter", "monotonic", "time", "thread_time")


def told(found: Diagnosis) -> str:
    """All that a diagnosis says."""
    return repr(found.to_json_dict())


def poor_record() -> Record:
    """One step of a rig that rubs, with a play: several laws of friction are tied."""
    made = simulate(dict(lottery.draw(22037, "backlash", True, "step").spec))
    return Record(made.time, made.position, made.force_time, made.force, hold=made.hold)


def proposed() -> Proposal:
    """What to do after one step."""
    found = check(stepped("force_gain_nonlinearity", "gain_slope", 0.006), LIMITS)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    found = diagnose([poor_record()])
    assert found.next_experiment is not None
    return found


@pytest.mark.parametrize("pace", [0.1, 10.0, 1000.0])
def test_clock(pace: float, diagnosis: Diagnosis, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = proposed()
    for name in CLOCKS:
        clock = getattr(time, name)
        monkeypatch.setattr(time, name, lambda clock=clock: pace * clock())
    found = proposed()
    assert found.to_json_dict() == plain.to_json_dict() and found.considered == plain.considered
    assert told(diagnose([poor_record()])) == told(diagnosis)


@pytest.mark.parametrize("cores", [1, 2, 8])
def test_cores(cores: int, diagnosis: Diagnosis, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    assert told(diagnose([poor_record()])) == told(diagnosis)


def test_budget_is_work(monkeypatch: pytest.MonkeyPatch) -> None:
    everything = len(proposed().considered)
    monkeypatch.setattr(searching, "_SCREENING", 1.0)
    assert 0 < len(proposed().considered) < everything
