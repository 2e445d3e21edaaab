"""The same record gives the same verdict and the same next experiment: whatever the clock says, on one core or many."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest
from designrigs import LIMITS, checked, stepped

from msd_ident import parallel
from msd_ident.data.record import Record
from msd_ident.design import Proposal, check, profile_search
from msd_ident.diagnosis import Diagnosis
from msd_ident.selection import replication
from msd_ident.workflow.pipeline import diagnose
from msd_sim import lottery
from msd_sim.api import simulate

pytestmark = pytest.mark.xdist_group("bent gain")

CLOCKS = ("process_time", "perf_counter", "monotonic", "time", "thread_time")


def told(found: Diagnosis) -> str:
    """All that a diagnosis says."""
    return repr(found.to_json_dict())


def poor_record() -> Record:
    """One step of a rig with a lag, which may as well have a delay, a stop or drag: three causes are tied."""
    made = simulate(dict(lottery.draw(21, "actuator_lag", False, "step", 250.0).spec))
    return Record(made.time, made.position, made.force_time, made.force, hold=made.hold)


def proposed() -> Proposal:
    """What to do after one step."""
    found = check(stepped("force_gain_nonlinearity", "gain_slope", 0.006), LIMITS)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def proposal() -> Proposal:
    return checked()


@pytest.mark.parametrize("copies", [2, pytest.param(replication.COPIES, marks=pytest.mark.long)])
def test_clock_and_cores(copies: int, proposal: Proposal, monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock on which any budget of time is used up at once, and four threads in place of one."""
    monkeypatch.setattr(replication, "COPIES", copies)
    with parallel.limited_to(1):
        diagnosis = diagnose([poor_record()])
    assert diagnosis.next_experiment is not None and diagnosis.calibration is not None
    for name in CLOCKS:
        clock = getattr(time, name)
        monkeypatch.setattr(time, name, lambda clock=clock: 1000.0 * clock())
    found = proposed()
    assert found.to_json_dict() == proposal.to_json_dict() and found.considered == proposal.considered
    with parallel.limited_to(4):
        assert told(diagnose([poor_record()])) == told(diagnosis)


def test_budget_is_work(proposal: Proposal, monkeypatch: pytest.MonkeyPatch) -> None:
    everything = len(proposal.considered)
    monkeypatch.setattr(profile_search, "_SCREENING", 1.0)
    assert 0 < len(proposed().considered) < everything


#: A rig whose two causes are surer than digits can tell, so that nothing but their names orders them; a few causes are
#: asked about.
_DIAGNOSED = """
from dataclasses import replace
from msd_ident.diagnosis import searching
asked = frozenset(("coulomb_friction", "quadratic_drag", "stribeck_friction", "fading_damping", "hysteresis"))
prepare = searching.prepare
searching.prepare = lambda task: replace(prepare(task), asked=asked)
from msd_ident.data.record import Record
from msd_ident.workflow.pipeline import diagnose
from msd_sim import lottery
from msd_sim.api import simulate
made = simulate(dict(lottery.draw(403, "quadratic_drag", True, "steps", 500.0).spec))
print(repr(diagnose([Record(made.time, made.position, made.force_time, made.force, hold=made.hold)]).to_json_dict()))
"""
_ORDER = "print(*frozenset({'coulomb_friction', 'quadratic_drag'}))"


def hashed(code: str, seed: int) -> str:
    """What a process prints whose strings are hashed with this seed."""
    environment = {**os.environ, "PYTHONHASHSEED": str(seed), "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    ).stdout


def test_hash_seed() -> None:
    orders: dict[str, int] = {}
    for seed in range(12):
        orders.setdefault(hashed(_ORDER, seed), seed)
        if len(orders) == 2:
            break
    assert len(orders) == 2
    first, second = (hashed(_DIAGNOSED, seed) for seed in orders.values())
    assert first == second and "coulomb_friction" in first
