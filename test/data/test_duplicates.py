"""Records that are given twice: left out by what was measured, not by name or clock."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.duplicates import without_duplicates
from msd_ident.data.record import Record

RNG = np.random.default_rng(7)
TIME = np.arange(500) * 2e-3
ONE = Record(TIME, 1e-5 * RNG.standard_normal(500), np.array([0.0, 0.3, 0.7]), np.array([0.0, 5.0, -5.0]), name="a.csv")
SAID = (
    "b.csv is left out: its positions and its force are those of a.csv, sample by sample, and one measurement counts "
    "once."
)


@pytest.mark.parametrize(
    "other",
    [
        ONE,
        replace(ONE, time=TIME + 1.7e9, force_time=ONE.force_time + 1.7e9),
        replace(ONE, position=np.array([float(f"{value:.9g}") for value in ONE.position])),
    ],
    ids=["under another name", "on another clock", "written with nine digits"],
)
def test_a_duplicate_is_left_out(other: Record) -> None:
    assert without_duplicates([ONE, replace(other, name="b.csv")]) == ((ONE,), (SAID,))


@pytest.mark.parametrize(
    "other",
    [
        replace(ONE, position=1e-5 * RNG.standard_normal(500)),
        replace(ONE, position=-ONE.position),
        replace(ONE, force=ONE.force * [1.0, 1.0, 1.001]),
        replace(ONE, force_time=ONE.force_time + [0.0, 0.01, 0.0]),
        replace(ONE, time=2.0 * TIME, force_time=2.0 * ONE.force_time),
        replace(ONE, time=TIME[:-1], position=ONE.position[:-1]),
    ],
    ids=["other noise", "turned", "another force", "a later force", "another rate", "a sample less"],
)
def test_what_was_measured_again_is_kept(other: Record) -> None:
    assert without_duplicates([ONE, other]) == ((ONE, other), ())
