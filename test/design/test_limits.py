"""Limits of a rig: where a file may have them, what they allow, what is refused in words."""

from __future__ import annotations

from pathlib import Path

import pytest
from designrigs import ALL, STEP
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.design import Limits, read_limits
from msd_ident.design.limits import from_tree
from msd_ident.errors import DataError, UsageError


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no limits found; expected force: 10, travel: 0.03, duration: 20"),
        ("force: 1\ntravel: 0.1\n", "limits: duration is missing; expected force"),
        ("force: 1\ntravel: 0.1\nduration: 1:30\n", "limits: duration is '1:30'; expected a finite number"),
        ("force: 010\ntravel: 0.1\nduration: 1\n", "limits: force is '010'; expected a finite number"),
        ("force: 1\ntravel: 0.1\nduration: 0\n", "limits: duration is 0 s; expected more than 0 s"),
        ("force: 0\ntravel: 0.1\nduration: 1\n", "limits: force from 0 to 0; expected one number above 0"),
        ("force: [1, 2]\ntravel: 0.1\nduration: 1\n", "limits: force from 1 to 2; expected"),
        ("force: [1, 2, 3]\ntravel: 0.1\nduration: 1\n", "limits: force has 3 numbers; expected one, or two"),
        ("force: 1\ntravel: far\nduration: 1\n", "limits: travel is 'far'; expected a finite number"),
        ("force: 1\ntravel: 1\nduration: 1\nspeed: -1\n", "limits: speed is -1; expected more than 0"),
        ("force: 1\ntravel: 1\nduration: 1\nheat: 1\n", "limits: no limit is called 'heat'"),
        ("force: {", "is no YAML"),
        ("force: 1\ntravel: 1\nduration: 1\nforce: 100\n", "it has the key 'force' twice, in lines 1 and 4"),
        ("force: 1e400\ntravel: 1\nduration: 1\n", "limits: force is inf; expected a finite number"),
        pytest.param(
            f"force: 1{'0' * 400}\ntravel: 1\nduration: 1\n",
            "limits: force is beyond 1e308; expected a finite number",
            id="huge force",
        ),
        pytest.param(
            f"force: 1{'0' * 5000}\ntravel: 1\nduration: 1\n", "is no YAML (Exceeds the limit", id="5000 digits"
        ),
        pytest.param(
            f"force: 0x{'f' * 5000}\ntravel: 1\nduration: 1\n",
            "limits: force is beyond 1e308; expected a finite number",
            id="huge hexadecimal",
        ),
        pytest.param(
            "force: 2024-13-45\ntravel: 1\nduration: 1\n", "is no YAML (month must be in 1..12)", id="month 13"
        ),
        pytest.param("[" * 3000, "is no YAML (it is nested too deeply)", id="deep"),
        pytest.param("rig: &a {rig: *a}", "limits that hold themselves; expected force", id="holding itself"),
    ],
)
def test_limits_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "l.yaml").write_text(text)
    with pytest.raises(DataError) as error:
        read_limits(tmp_path / "l.yaml")
    assert words in str(error.value) and "\n" not in str(error.value)


def test_limits_in_a_parameter_file_and_beyond_them() -> None:
    block = {"force": [-2, 4], "travel": 0.05, "duration": 5, "speed": 1}
    limits = from_tree({"/**": {"ros__parameters": {"rate": 1.0, "limits": block}}})
    assert limits == Limits((-2.0, 4.0), (-0.05, 0.05), 5.0, 1.0)
    with pytest.raises(UsageError, match="takes 6.5 s, the limits allow 5 s; expected a shorter one"):
        limits.check(ALL)
    with pytest.raises(UsageError, match="pushes from -1.29.* to 2 N, the limits allow -1 to 4"):
        Limits((-1.0, 4.0), (-1.0, 1.0), 60.0).check(ALL)
    with pytest.raises(DataError, match="cannot read nowhere.yaml: No such file"):
        read_limits(Path("nowhere.yaml"))


def test_numbers_with_an_exponent(tmp_path: Path) -> None:
    (tmp_path / "l.yaml").write_text("force: 1e1\ntravel: [-3e-2, 3E-2]\nduration: 2e+1\n")
    assert read_limits(tmp_path / "l.yaml") == Limits((-10.0, 10.0), (-0.03, 0.03), 20.0)


sizes = st.just(0.0) | st.floats(1e-6, 0.1)


@given(sizes, sizes, st.floats(1e-3, 1e3))
def test_readings_and_forces_may_grow_up_to_the_limit_and_not_beyond(low: float, high: float, unit: float) -> None:
    limits = Limits((-2.0 * unit, 5.0 * unit), (-0.02 * unit, 0.05 * unit), 10.0)
    for room, least, greatest in ((limits.room, -0.02, 0.05), (limits.force_room, -2.0, 5.0)):
        factor = room(-low * unit, high * unit)
        if low == high == 0.0:
            assert factor == float("inf")
            continue
        assert factor * high <= greatest * (1.0 + 1e-9) and -factor * low >= least * (1.0 + 1e-9)
        assert factor * high == pytest.approx(greatest) or factor * low == pytest.approx(-least)


@pytest.mark.parametrize("speed", [float("inf"), 0.7])
def test_limits_are_read_as_they_were_told(speed: float) -> None:
    limits = Limits((-2.0, 4.0), (-0.05, 0.01), 5.0, speed)
    assert from_tree({"limits": limits.to_dict()}) == limits
    assert limits.reach == 4.0


def test_a_profile_that_just_reaches_the_limits_is_within_them() -> None:
    limits = Limits((-10.0, 8.0), (-0.1, 0.1), STEP.duration)
    limits.check(STEP)
    with pytest.raises(UsageError, match="pushes from 0 to 8.008 N, the limits allow -10 to 8"):
        limits.check(STEP.scaled(1.001))
