"""Profiles in files: what is written is read again, and what is refused is told in words."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from designrigs import ALL
from hypothesis import given, settings
from hypothesis import strategies as st

from msd_ident.design import Profile, Segment, read_profile, write_profile
from msd_ident.design.profile_file import from_yaml, to_yaml
from msd_ident.errors import DataError

#: A whole number that no float holds.
HUGE = "1" + "0" * 400

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
        ("rate: 1\nrate: 2\nsegments: []", "no YAML (it has the key 'rate' twice, in lines 1 and 2)"),
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
        pytest.param(
            "segments: [{kind: [step], duration: 1}]",
            "segment 1 is of kind ['step']; expected one of step, hold",
            id="kind that is a list",
        ),
        pytest.param(
            f"segments: [{{kind: hold, duration: {HUGE}}}]",
            "duration is beyond 1e308; expected a finite number",
            id="huge duration",
        ),
        pytest.param(
            f"segments: [{{kind: table, duration: 1, time: [0], values: [{HUGE}]}}]",
            "values is no list of finite numbers",
            id="huge force",
        ),
        pytest.param(
            f"rate: {HUGE}\nsegments: [{{kind: hold, duration: 1}}]",
            "rate is beyond 1e308; expected commands a second",
            id="huge rate",
        ),
        pytest.param(
            f"rate: 1{HUGE * 20}\nsegments: [{{kind: hold, duration: 1}}]",
            "no YAML (Exceeds the limit",
            id="5000 digits",
        ),
        pytest.param(
            "name: 2024-13-45\nsegments: [{kind: hold, duration: 1}]", "no YAML (month must be in 1..12)", id="month 13"
        ),
        pytest.param("[" * 3000, "no YAML (it is nested too deeply)", id="deep"),
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
