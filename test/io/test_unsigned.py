"""A force whose sign was lost, because a signed number was read as an unsigned one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.io import SourceOptions, read
from msd_ident.io.unsigned import signed


@given(st.integers(20, 8000), st.integers(2, 9), st.sampled_from([16, 32]))
def test_the_sign_comes_back(size: int, waves: int, bits: int) -> None:
    true = np.rint(size * np.sin(2.0 * np.pi * waves * np.arange(400) / 400.0))
    found, note = signed(np.where(true < 0.0, true + 2.0**bits, true), "load")
    assert np.array_equal(found, true)
    assert note.startswith("Column load holds ") and f"signed numbers of {bits} bits" in note


@pytest.mark.parametrize(
    "values",
    [
        np.arange(-40.0, 40.0),  # signed already
        np.arange(0.0, 65536.0, 16.0),  # in the middle too
        np.where(np.arange(400) // 20 % 2, 65535.0 - np.arange(400) * 7 % 50, np.arange(400) * 11 % 50),  # with noise
        np.repeat([0.0, 65535.0], 50),  # a drive that is fully on or off
        np.concatenate((3000.0 + np.arange(40.0), 60000.0 + np.arange(40.0))),  # two levels with noise
        np.arange(0.0, 80.0),  # never negative
        0.5 + np.where(np.arange(80) % 2, np.arange(80.0), 65535.0 - np.arange(80.0)),  # not whole
        np.full(20, np.nan),
    ],
)
def test_a_force_with_its_sign_stays_as_it_is(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    found, note = signed(values, "load")
    assert found is values and not note


def test_a_table_is_read_with_the_sign_and_says_so(tmp_path: Path) -> None:
    time = 0.01 * np.arange(300)
    force = np.rint(200.0 * np.sin(3.0 * time)).astype(int)
    lines = [f"{t:.2f},{f % 65536},{x:.6f}" for t, f, x in zip(time, force, np.sin(3.0 * time + 1.0), strict=True)]
    (tmp_path / "servo.csv").write_text("\n".join(["time,load,angle_rad", *lines]))
    options = SourceOptions(force="load", force_unit="PWM", force_scale=2.0, position="angle_rad")
    record = read(tmp_path / "servo.csv", options)
    assert np.array_equal(record.force, 2.0 * force)
    (note,) = [note for note in record.notes if "taken as negative" in note]
    assert "and else none above 200: they are taken as negative" in note and "(65534 is -2)" in note
