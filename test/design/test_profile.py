"""Profiles and limits: what they mean, how they are written, what is refused in words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.design import Limits, Profile, Segment, read_limits, read_profile, write_profile
from msd_ident.design.library import TimeScale, family, why
from msd_ident.design.limits import from_tree
from msd_ident.design.profile_file import from_yaml, to_yaml
from msd_ident.errors import DataError, UsageError

ALL = Profile(
    (
        Segment("hold", 0.5),
        Segment("step", 1.0, force=2.0),
        Segment("ramp", 1.0, force=-1.0),
        Segment("hold", 0.5),
        Segment("sweep", 2.0, amplitude=1.5, offset=0.2, low_hz=0.5, high_hz=5.0),
        Segment("prbs", 1.0, amplitude=1.0, shortest=0.1, seed=3),
        Segment("release", 0.5),
    ),
    "all kinds",
)

forces = st.floats(-100.0, 100.0).map(lambda value: round(value, 3))
durations = st.floats(0.01, 3.0).map(lambda value: round(value, 3))
segments = st.one_of(
    st.builds(Segment, st.just("step"), durations, force=forces),
    st.builds(Segment, st.just("hold"), durations),
    st.builds(Segment, st.just("release"), durations),
    st.builds(Segment, st.just("ramp"), durations, force=forces),
    st.builds(
        Segment, st.just("sweep"), durations, amplitude=forces, offset=forces,
        low_hz=st.floats(0.1, 5.0), high_hz=st.floats(0.1, 20.0),
    ),
    st.builds(
        Segment, st.just("prbs"), durations, amplitude=forces, shortest=st.floats(0.05, 1.0), seed=st.integers(0, 99)
    ),
)  # fmt: skip


def test_force_over_time() -> None:
    assert ALL.force_at(np.array([0.2, 0.6, 1.4, 2.75, 6.4])).tolist() == pytest.approx([0.0, 2.0, 2.0, -1.0, 0.0])
    assert ALL.force_at(np.array([2.0]))[0] == pytest.approx(0.5, abs=0.01)  # the middle of the ramp
    time, force = ALL.commands
    assert force[-1] == 0.0 and time[-1] == ALL.duration == 6.5
    sweep = force[(time >= 3.0) & (time < 5.0)]
    assert sweep.max() == pytest.approx(1.7, abs=0.01) and sweep.min() == pytest.approx(-1.3, abs=0.02)
    train = ALL.force_at(np.linspace(5.001, 5.999, 100))
    assert set(train.tolist()) == {-1.0, 1.0}


@settings(max_examples=30, deadline=None)
@given(st.lists(segments, min_size=1, max_size=5))
def test_files_give_the_same_force(parts: list[Segment]) -> None:
    profile = Profile(tuple(parts), "any", rate=100.0)
    again = from_yaml(to_yaml(profile, ("a remark",)))
    for one, other in zip(profile.commands, again.commands, strict=True):
        np.testing.assert_array_equal(one, other)
    assert profile.scaled(-2.0).extremes == tuple(-2.0 * value for value in profile.extremes[::-1])


def test_csv(tmp_path: Path) -> None:
    write_profile(ALL, tmp_path / "p.csv")
    again = read_profile(tmp_path / "p.csv")
    at = np.linspace(0.0, 6.6, 3000)
    np.testing.assert_allclose(again.force_at(at), ALL.force_at(at), atol=1e-8)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("segments: 3", "no list of segments; expected 'segments:' with one mapping each"),
        ("segments: []", "a profile without segments; expected at least one"),
        ("segments: [{kind: jump, duration: 1}]", "segment 1 is of kind 'jump'; expected one of step, hold"),
        ("segments: [{kind: step, duration: 1}]", "segment 1 (step) has no force; expected duration, force"),
        ("segments: [{kind: step, duration: -1, force: 1}]", "duration is -1 s; expected more than 0 s"),
        ("segments: [{kind: step, duration: .nan, force: 1}]", "duration is nan; expected a finite number"),
        ("segments: [{kind: step, duration: 1, force: much}]", "force is 'much'; expected a finite number"),
        ("segments: [{kind: hold, duration: 1, force: 1}]", "segment 1 (hold) has no use for 'force'"),
        ("segments: [{kind: sweep, duration: 1, amplitude: 1, low_hz: 0, high_hz: 1}]", "low_hz is 0; expected more"),
        ("segments: [{kind: prbs, duration: 80000, amplitude: 1, shortest: 0.001}]", "expected at most 1000000"),
        ("segments: [{kind: prbs, duration: 1, amplitude: 1, shortest: 1, seed: -1}]", "seed is -1; expected a whole"),
        ("rate: fast\nsegments: [{kind: hold, duration: 1}]", "rate is 'fast'; expected commands a second"),
        ("speed: 1\nsegments: [{kind: hold, duration: 1}]", "no entry is called 'speed'"),
        ("{", "no YAML"),
    ],
)
def test_profiles_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(text)
    with pytest.raises(DataError) as error:
        read_profile(path)
    assert words in str(error.value) and str(path) in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,f\n0,1\n", "first line 't,f'; expected time_s,force_n"),
        ("time_s,force_n\n0,1\n1,x\n", "a line that is not two numbers"),
        ("time_s,force_n\n0,1\n0,0\n", "instants that do not rise"),
        ("time_s,force_n\n0,1\n1,2\n", "a last force of 2; expected 0"),
        ("time_s,force_n\n0,1\n", "1 lines of numbers; expected at least two"),
    ],
)
def test_tables_refused(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(DataError, match=words):
        read_profile(tmp_path / "p.csv")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no limits found; expected force: 10, travel: 0.03, duration: 20"),
        ("force: 1\ntravel: 0.1\n", "limits: duration is missing; expected force"),
        ("force: 1\ntravel: 0.1\nduration: 0\n", "limits: duration is 0 s; expected more than 0 s"),
        ("force: 0\ntravel: 0.1\nduration: 1\n", "limits: force from 0 to 0; expected one number above 0"),
        ("force: [1, 2]\ntravel: 0.1\nduration: 1\n", "limits: force from 1 to 2; expected"),
        ("force: [1, 2, 3]\ntravel: 0.1\nduration: 1\n", "limits: force has 3 numbers; expected one, or two"),
        ("force: 1\ntravel: far\nduration: 1\n", "limits: travel is 'far'; expected a finite number"),
        ("force: 1\ntravel: 1\nduration: 1\nspeed: -1\n", "limits: speed is -1; expected more than 0"),
        ("force: 1\ntravel: 1\nduration: 1\nheat: 1\n", "limits: no limit is called 'heat'"),
        ("force: {", "is no YAML"),
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


def test_the_family_keeps_to_the_time_and_to_unit_force() -> None:
    for period in (0.1, 0.5, 3.0):
        made = family(TimeScale(period, 20.0))
        assert len({one.name for one in made}) == len(made) > 8
        for one in made:
            assert one.duration <= 20.0 + 1e-9
            assert max(map(abs, one.extremes)) <= 1.0 + 1e-12
            assert one.force_at(np.array([0.0]))[0] == 0.0, "every experiment begins at rest"
            assert why(one.name) != why("something unheard of")
