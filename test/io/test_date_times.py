"""Dates with times in tables become seconds since the first one."""

from __future__ import annotations

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.errors import DataError
from msd_ident.io import SourceOptions, read
from msd_ident.io.date_times import nanoseconds

BEGIN = datetime(2025, 11, 9, 23, 59, 58)


def table(separator: str, between: str, zone: str, quote: str = "", heading: str = "timestamp") -> str:
    """Forty readings a tenth of a second apart, over midnight; Python writes whole seconds without a fraction."""
    lines = [separator.join((heading, "force_n", "position_m"))]
    for i in range(40):
        stamp = (BEGIN + timedelta(microseconds=100_000 * i)).isoformat(between)
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
    assert record.samples == 40 and record.time[0] == 0.0
    np.testing.assert_allclose(np.diff(record.time), 0.1, atol=1e-9)


@pytest.mark.parametrize(
    "above", ["Operator,Smith\nRecorded,2025-11-09 09:27:03\n", "# made 2025-11-09T09:27:03Z, 3 N\n"]
)
def test_dates_above_the_numbers_are_no_numbers(tmp_path: Path, above: str) -> None:
    path = tmp_path / "logged.csv"
    for heading, body in (("time_s", [f"{0.1 * i},1.0,{0.01 * np.sin(i):.6f}" for i in range(40)]),
                          ("timestamp", table(",", "T", "").splitlines()[1:])):  # fmt: skip
        path.write_text(above + f"{heading},force_n,position_m\n" + "\n".join(body) + "\n")
        assert read(path, SourceOptions(time=heading)).time[-1] == pytest.approx(3.9)


def test_another_column_may_have_a_clock_of_its_own(tmp_path: Path) -> None:
    lines = table(",", "T", "Z").splitlines()
    path = tmp_path / "logged.csv"
    path.write_text("\n".join([f"{lines[0]},local", *(f"{line},2025-11-10T01:02:03+01:00" for line in lines[1:])]))
    assert read(path, SourceOptions(time="timestamp")).time[-1] == pytest.approx(3.9)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("58Z", "58+01:00", "expected a date of the same zone as the first one"),
        ("11-09T", "13-09T", "holds '2025-13-09T23:59:58.100000Z'; expected a finite number: repair or remove"),
        ("timestamp", "timestamp_ms", "holds '2025-11-09T23:59:58Z'; expected a number in ms, as the heading says"),
    ],
)
def test_a_date_that_cannot_be_used_is_named_with_its_line(tmp_path: Path, old: str, new: str, words: str) -> None:
    text, path = table(",", "T", "Z"), tmp_path / "logged.csv"
    path.write_text(
        text.replace(old, new, 1) if old != "11-09T" else text.replace("11-09T23:59:58.1", "13-09T23:59:58.1", 1)
    )
    with pytest.raises(DataError) as refused:
        read(path, SourceOptions(time="timestamp_ms" if "_ms" in new else "timestamp"))
    assert words in str(refused.value) and ", column timestamp" in str(refused.value)


@given(st.datetimes(), st.sampled_from(["", "Z", "+01:00", "-0530"]))
def test_nanoseconds_are_those_between_dates(when: datetime, zone: str) -> None:
    found, first = nanoseconds(f"{when.isoformat()}{zone}"), nanoseconds("0001-01-01 00:00:00")
    assert found is not None and first is not None and found[1] == zone
    assert found[0] - first[0] == (when - datetime.min) // timedelta(microseconds=1) * 1000


@pytest.mark.parametrize("cell", ["", "0.1", "2025-11-09", "2025-13-09T00:00:00", "09:27:03", "2025-11-09 at noon"])
def test_other_cells_are_no_dates(cell: str) -> None:
    assert nanoseconds(cell) is None
