"""When a hand let go: rigs pulled by a force that the record does not hold, at an instant that the test knows."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from pendulums import dropped

from msd_ident.data.record import Record
from msd_ident.features import extract
from msd_ident.io import SourceOptions, read
from msd_ident.workflow.preparation import prepare
from msd_sim import api

MASS, STIFFNESS, RATE = 1.0, 400.0, 500.0
PERIOD = 2.0 * np.pi * (MASS / STIFFNESS) ** 0.5

#: Force of the hand [N] at instants [s], straight lines between; the last instant is the release.
PULLS = {
    "held": [(1.0, 0.0), (1.5, 8.0), (2.2, 8.0), (2.2005, 0.0)],
    "let go slowly": [(1.0, 0.0), (1.5, 8.0), (2.2, 8.0), (2.26, 0.0)],
    "pushed before": [(1.0, 0.0), (1.3, -6.0), (1.6, 0.0), (2.0, 8.0), (2.1, 8.0), (2.101, 0.0)],
    "quick": [(1.0, 0.0), (1.12, 8.0), (1.15, 8.0), (1.16, 0.0)],
    "shoved": [(1.0, 0.0), (1.02, 30.0), (1.04, 0.0)],
    "swung": [(1.0, 0.0), (1.16, -4.0), (1.31, 4.0), (1.47, -4.0), (1.63, 4.0), (2.0, 8.0), (2.05, 8.0), (2.06, 0.0)],
}
EFFECTS: dict[str, Mapping[str, Mapping[str, float]]] = {
    "linear": {},
    "dry friction": {"coulomb_friction": {"coulomb_force": 0.15}},
    "drag": {"quadratic_drag": {"drag_coefficient": 5.0}},
    "end stop": {"end_stop": {"stop_position": 0.01, "stop_stiffness": 3000.0}},
    "hardening": {"cubic_spring": {"cubic_stiffness": 1.2e5}},
}


def pulled(points: list[tuple[float, float]], effects: Mapping[str, object], start: float = 0.0) -> Record:
    """A rig that a hand pulls, from ``start`` [m], as a record without force."""
    time, force = np.array([(0.0, 0.0), *points]).T
    made = api.simulate(
        {
            "mass": MASS, "damping": 1.6, "stiffness": STIFFNESS, "friction_coefficient": 0.0, "effects": effects,
            "encoder": {"counts_per_metre": 0.0, "noise": 5e-6}, "rate": RATE, "seed": 1, "duration": 9.0,
            "force_time": time, "force": force, "hold": "linear", "initial_position": start,
        }
    )  # fmt: skip
    return Record(made.time, made.position, made.time[:1], np.zeros(1))


@pytest.mark.parametrize("law", EFFECTS)
@pytest.mark.parametrize("pull", [name for name in PULLS if name != "swung"])
def test_the_release_is_found(pull: str, law: str) -> None:
    """Not before the hand is off, and little of the free motion is lost."""
    (response,) = extract(pulled(PULLS[pull], EFFECTS[law])).responses
    off = PULLS[pull][-1][0]
    assert off - 0.03 * PERIOD < response.onset < off + 0.16 * PERIOD
    assert all(turn.time >= response.onset for turn in response.turns)


@pytest.mark.parametrize("law", ["linear", "dry friction", "drag", "end stop"])
def test_a_cart_swung_by_hand_is_free_from_the_last_pull_on(law: str) -> None:
    (response,) = extract(pulled(PULLS["swung"], EFFECTS[law])).responses
    off = PULLS["swung"][-1][0]
    assert off - 0.03 * PERIOD < response.onset < off + 0.16 * PERIOD


@pytest.mark.parametrize("law", EFFECTS)
def test_what_is_free_from_the_start_loses_nothing(law: str) -> None:
    record = pulled([(1.0, 0.0)], EFFECTS[law], start=0.02)
    found = extract(record)
    assert found.responses[0].onset == 0.0 and not found.remarks
    data = prepare([record])
    assert data.records[0].samples == record.samples and data.rest_before == (None,)


@pytest.mark.parametrize("law", [name for name in EFFECTS if name != "end stop"])
@pytest.mark.parametrize("lead", [0.11, 0.16])
def test_a_pull_that_the_start_of_the_record_cuts_off_is_left_out(law: str, lead: float) -> None:
    """Less than a quarter period of it is in the record: a recorder's trigger is often set to the pull."""
    off = PULLS["quick"][-1][0]
    (response,) = extract(pulled(PULLS["quick"], EFFECTS[law]).window(off - lead * PERIOD, 9.0)).responses
    assert off - 0.03 * PERIOD < response.onset < off + 0.16 * PERIOD


@pytest.mark.parametrize("law", EFFECTS)
@pytest.mark.parametrize("phase", [0.1, 0.35, 0.6, 0.7, 0.8, 0.9])
def test_what_is_free_from_the_start_loses_nothing_at_any_phase(law: str, phase: float) -> None:
    record = pulled([(1.0, 0.0)], EFFECTS[law], start=0.02).window(phase * PERIOD, 9.0)
    assert extract(record).responses[0].onset == record.time[0]


def test_rest_before_the_pull_is_kept_beside_the_free_motion() -> None:
    """A record of its own: until a period before the cart moved, as friction may have held it against the hand."""
    record = pulled(PULLS["held"], EFFECTS["dry friction"])
    data = prepare([record])
    (rest,), (used,) = data.rest_before, data.records
    assert rest is not None
    assert rest.time[0] == 0.0 and 0.5 < rest.time[-1] < 1.0 - 0.5 * PERIOD
    assert np.array_equal(rest.position, record.position[: rest.samples])
    assert used.time[-1] == record.time[-1], "rest after the motion is a part of it"
    assert any("by hand" in said and "--start" in said for said in data.warnings)


def test_a_cart_that_a_hand_holds_does_not_rest() -> None:
    """It stands still at the place it is pulled to from the first sample on."""
    points = [(0.5, 0.0), (1.5, 8.0), (5.0, 8.0), (5.0005, 0.0)]
    record = pulled(points, EFFECTS["dry friction"]).window(3.5, 9.0)
    data = prepare([record])
    assert data.records[0].time[0] == pytest.approx(5.0, abs=0.16 * PERIOD)
    assert np.ptp(record.position[:200]) < 1e-4, "it stands still"
    assert data.rest_before == (None,)


def test_a_measured_pull_and_release(shared_data: Path) -> None:
    """The cart stands at its greatest excursion at 1.755 s; the hand lets go there, or within a sixth of a swing."""
    path = shared_data / "real" / "polimi_decay_stiff.csv"
    if not path.is_file():
        pytest.skip(f"no {path}")
    data = prepare([read(path, SourceOptions(force="none"))])
    (rest,), (used,) = data.rest_before, data.records
    assert 1.73 < used.time[0] < 1.78
    assert rest is not None and 1.0 < rest.time[-1] < 1.5 and np.ptp(rest.position) == 0.0


def test_a_pendulum_that_is_held_is_free_later_though_most_readings_are_lost() -> None:
    """With ten readings in a packet of 36, the law of the decay departs as much as a hand does."""
    whole = dropped(15.0, (1.0, 55.0, 0.005), 1.0, 1.45, 1.7)
    sent = np.flatnonzero(np.arange(whole.samples) % 36 < 10)
    (response,) = extract(Record(whole.time[sent], whole.position[sent], whole.time[:1], np.zeros(1))).responses
    assert 1.7 - 36 / 200 < response.onset < 1.7 + 36 / 200
    (free,) = extract(Record(whole.time[400:], whole.position[400:], whole.time[400:401], np.zeros(1))).responses
    assert free.onset == pytest.approx(2.0, abs=0.2), "in motion from the first sample on"
