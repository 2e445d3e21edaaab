"""Dates with times in tables become seconds since the first one."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.io import SourceOptions, read
from msd_ident.io.date_times import as_seconds

BEGIN = datetime(2025, 11, 9, 23, 59, 58, 748_000)


def table(separator: str, between: str, zone: str, quote: str = "") -> str:
    """Forty readings a tenth of a second apart, over midnight."""
    lines = [separator.join(("timestamp", "force_n", "position_m"))]
    for i in range(40):
        stamp = (BEGIN + timedelta(seconds=0.1 * i)).isoformat(between, "milliseconds")
        position = 0.01 * np.cos(0.7 * i)
        lines.append(separator.join((f"{quote}{stamp}{zone}{quote}", f"{1.0 + i % 2}", f"{position:.6f}")))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize(
    ("between", "zone", "quote"), [("T", "Z", ""), (" ", "", ""), ("T", "+01:00", ""), (" ", "", '"')]
)
def test_a_table_with_dates_is_read(tmp_path: Path, separator: str, between: str, zone: str, quote: str) -> None:
    path = tmp_path / "logged.csv"
    path.write_text(table(separator, between, zone, quote))
    record = read(path, SourceOptions(time="timestamp"))
    assert record.samples == 40 and record.time[-1] - record.time[0] == pytest.approx(3.9)
    np.testing.assert_allclose(np.diff(record.time), 0.1, atol=1e-9)


@given(st.lists(st.integers(0, 10**12), min_size=1, max_size=20))
def test_seconds_are_those_since_the_first_date(microseconds: list[int]) -> None:
    stamps = [BEGIN + timedelta(microseconds=one) for one in microseconds]
    found = [float(cell) for cell in as_seconds("\n".join(one.isoformat() for one in stamps)).split("\n")]
    np.testing.assert_allclose(found, [(one - stamps[0]).total_seconds() for one in stamps], atol=1e-6)


@pytest.mark.parametrize(
    "text",
    [
        "time,position\n0.1,2.0\n",
        "2025-11-09T09:27:03Z,1\n2025-11-09T09:27:04+01:00,2\n",
        "2025-13-09T09:27:03,1\n",
        "2025-11-09 09:27:03 1 2\n",
        "# made on 2025-11-09 at noon\n1,2\n",
    ],
    ids=["none", "two zones", "no month", "between spaces", "a comment"],
)
def test_other_text_stays_as_it_is(text: str) -> None:
    assert as_seconds(text) == text
