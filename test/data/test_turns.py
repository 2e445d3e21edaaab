"""Wrapped angles: unwrapped with a note, and nothing else is changed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.data.quality import check
from msd_ident.data.record import Record, from_samples
from msd_ident.data.streams import from_seconds
from msd_ident.io import SourceOptions, read

TURN = 2.0 * np.pi
TIME = 0.01 * np.arange(1000)


def joint(time: np.ndarray, angle: np.ndarray, unit: str = "rad") -> Record:
    return from_seconds(time, angle, time, np.sin(3.0 * time), position_unit=unit)


def wrap(angle: np.ndarray, low: float) -> np.ndarray:
    """The angle between ``low`` and one turn above it."""
    return (angle - low) % TURN + low


@st.composite
def motions(draw: st.DrawFn) -> np.ndarray:
    """Readings of an encoder on a shaft that swings and turns, at most a sixth of a turn from sample to sample."""
    angle = draw(st.floats(-3.0, 3.0)) + draw(st.floats(-30.0, 30.0)) * TIME
    for _ in range(draw(st.integers(1, 3))):
        rate = draw(st.floats(0.2, 30.0))
        angle = angle + draw(st.floats(-20.0, 20.0)) / rate * np.sin(rate * TIME + draw(st.floats(0.0, 6.0)))
    step = TURN / draw(st.sampled_from([500, 4096, 10**6]))
    noise = draw(st.sampled_from([0.0, 1e-3])) * np.random.default_rng(draw(st.integers(0, 9))).normal(size=TIME.size)
    return np.asarray(step * np.round((angle + noise) / step))


@given(angle=motions(), low=st.sampled_from([-np.pi, 0.0]), lost=st.sets(st.integers(10, 990), max_size=20))
def test_a_wrapped_angle_reads_like_the_angle(angle: np.ndarray, low: float, lost: set[int]) -> None:
    kept = np.delete(np.arange(TIME.size), sorted(lost))
    time, angle = TIME[kept], angle[kept]
    angle = angle + (wrap(angle[:1], low) - angle[:1])
    found, plain = joint(time, wrap(angle, low)), joint(time, angle)
    np.testing.assert_allclose(found.position, angle, atol=1e-9)
    assert plain.position.tolist() == angle.tolist() and not plain.notes
    jumped = bool(np.any(np.abs(np.diff(wrap(angle, low))) > np.pi))
    assert len(found.notes) == jumped
    if jumped:
        assert "times, the first time at" in found.notes[0] or "once, the first time at" in found.notes[0]
        assert "it was wrapped, and is unwrapped" in found.notes[0]


def test_a_wrapped_angle_in_degrees_of_a_table(tmp_path: Path) -> None:
    angle = 0.2 + 9.0 * np.sin(TIME)
    rows = [f"{t:.3f},{np.cos(t):.3f},{np.rad2deg(x) % 360.0:.4f}" for t, x in zip(TIME, angle, strict=True)]
    path = tmp_path / "shaft.csv"
    path.write_text("\n".join(["time_s,torque (N·m),angle (deg)", *rows]) + "\n")
    record = read(path, SourceOptions(force="torque", position="angle"))
    np.testing.assert_allclose(record.position, angle, atol=1e-6)
    assert "the angle jumps by one turn 9 times" in " ".join(record.notes)
    plain = read(path, SourceOptions(force="torque", position="angle", position_unit="deg"))
    np.testing.assert_array_equal(plain.position, record.position)


def test_a_gap_in_which_it_turned_on() -> None:
    kept = (TIME < 2.0) | (TIME > 2.4)
    angle = (10.0 * TIME)[kept]
    found = joint(TIME[kept], wrap(angle, 0.0))
    np.testing.assert_allclose(found.position, angle, atol=1e-9)


@pytest.mark.parametrize(
    "angle",
    [
        np.where(TIME < 3.0, 0.1, 4.5),  # a step between two samples
        np.where(np.arange(TIME.size) == 500, 4.5, np.sin(TIME)),  # a wild reading
        np.pi * np.sin(5.0 * TIME),  # a whole turn to and fro
    ],
)
def test_other_jumps_stay(angle: np.ndarray) -> None:
    found = joint(TIME, angle)
    assert found.position.tolist() == angle.tolist() and not found.notes


def test_a_turn_that_is_too_fast_to_tell_is_named() -> None:
    angle = wrap(4.0 * np.cumsum(1.0 + 0.3 * np.sin(TIME)), 0.0)
    found = joint(TIME, angle)
    assert found.position.tolist() == angle.tolist()
    assert "it cannot be told whether it is wrapped: it is used as it is; sample faster" in found.notes[0]


@pytest.mark.parametrize(
    ("unit", "factor", "said"),
    [
        ("m", 360.0 / TURN, "jumps by 360 m between two samples (7 times, the first at 0.340 s)"),
        ("m", 1.0, "is it an angle in radians that is wrapped at one turn? If so, use --position-unit rad"),
        ("count", 4096.0 / TURN, "is it a counter that overflows? If so, unwrap it before"),
    ],
)
def test_a_wrapped_angle_in_another_unit_is_named(unit: str, factor: float, said: str) -> None:
    position = np.round(factor * wrap(0.2 + 9.0 * np.sin(TIME), -np.pi), 3)
    found = check(joint(TIME, position, unit))
    assert [one.code for one in found].count("wrong_unit") == 1
    assert said in next(one.sentence for one in found if one.code == "wrong_unit")
    assert not any(one.code == "wrong_unit" for one in check(from_samples(TIME, np.sin(TIME), 0.3 * np.sin(TIME))))
