"""Dates with times in tables become seconds since the first one."""

from __future__ import annotations

from datetime import datetime, time, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.errors import DataError
from msd_ident.io import SourceOptions, describe, read
from msd_ident.io.date_times import clock, nanoseconds

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


def clocked(path: Path, cells: list[str], heading: str = "time", separator: str = ",") -> Path:
    """A table of readings at these times."""
    head = "" if heading == "none" else separator.join((heading, "force_n", "position_m")) + "\n"
    rows = [separator.join((cell, f"{1 + i % 2}", f"{0.01 * np.cos(0.7 * i):.6f}")) for i, cell in enumerate(cells)]
    path.write_text(head + "\n".join(rows) + "\n")
    return path


def day(seconds: float, form: str = "long") -> str:
    """A time of day: 09:07:03.700, 9:07:03.7, or 07:03.7 without the hours."""
    tenths = round(10 * seconds) % 864_000
    hour, minute, second, tenth = tenths // 36_000, tenths // 600 % 60, tenths // 10 % 60, tenths % 10
    whole = f"{minute:02}:{second:02}.{tenth}"
    return {"long": f"{hour:02}:{whole}00", "short": f"{hour}:{whole}", "minutes": whole}[form]


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
@pytest.mark.parametrize("form", ["long", "short", "minutes"])
def test_times_of_day_are_seconds_from_the_first_one(tmp_path: Path, separator: str, form: str) -> None:
    """They were refused with the advice to remove that line, although every line was so."""
    cells = [day(33_990.0 + 0.1 * i, form) for i in range(40)]
    path = clocked(tmp_path / "logged.csv", cells, separator=separator)
    record = read(path)
    assert record.samples == 40 and record.time[0] == 0.0
    np.testing.assert_allclose(np.diff(record.time), 0.1, atol=1e-9)
    said = f"column time has times of day, which are read as seconds from the first one, {cells[0]}."
    assert record.notes == (said,)
    assert describe(path).notes == (said,) and describe(path).duration == pytest.approx(3.9)


def test_whole_seconds_and_decimal_commas_among_times_of_day(tmp_path: Path) -> None:
    cells = [day(33_990.0 + 0.1 * i).removesuffix(".000") for i in range(40)]
    assert cells[0] == "09:26:30"
    np.testing.assert_allclose(np.diff(read(clocked(tmp_path / "a.csv", cells)).time), 0.1, atol=1e-9)
    path = clocked(tmp_path / "b.csv", cells, separator=";")
    path.write_text(path.read_text().replace(".", ","))
    np.testing.assert_allclose(np.diff(read(path).time), 0.1, atol=1e-9)


@pytest.mark.parametrize(
    ("form", "end", "words"),
    [
        ("long", 86_400, "23:59:58.000; a day was added where the clock passes midnight (line 22)."),
        ("minutes", 36_000, "59:58.0; an hour was added where the clock passes a full hour (line 22)."),
    ],
)
def test_times_of_day_go_on_behind_midnight(tmp_path: Path, form: str, end: float, words: str) -> None:
    seconds = end - 2.0 + 0.1 * np.arange(40)
    record = read(clocked(tmp_path / "logged.csv", [day(one, form) for one in seconds]))
    np.testing.assert_allclose(record.time, seconds - seconds[0], atol=1e-9)
    assert record.notes[0].endswith(words)
    seconds[[19, 20, 21]] = seconds[[20, 21, 19]]  # a line of before midnight that came late
    record = read(clocked(tmp_path / "late.csv", [day(one, form) for one in seconds]))
    np.testing.assert_allclose(record.time, np.sort(seconds) - seconds[0], atol=1e-9)
    assert "1 of 40 samples came late" in " ".join(record.notes) and "(line 24)." in record.notes[0]


def test_a_clock_that_begins_again_within_half_a_day_is_refused(tmp_path: Path) -> None:
    cells = [day(43_000.0 + 0.1 * (i % 30)) for i in range(60)]
    with pytest.raises(DataError, match="run backwards"):
        read(clocked(tmp_path / "looped.csv", cells))


def test_a_stop_watch_may_go_on_behind_an_hour(tmp_path: Path) -> None:
    long = [f"{60 + i // 600}:{i // 10 % 60:02}.{i % 10}" for i in range(40)]
    np.testing.assert_allclose(np.diff(read(clocked(tmp_path / "a.csv", long)).time), 0.1, atol=1e-9)
    both = [day(3598.0 + 0.1 * i, "minutes" if i < 20 else "short") for i in range(40)]
    np.testing.assert_allclose(np.diff(read(clocked(tmp_path / "b.csv", both)).time), 0.1, atol=1e-9)


@pytest.mark.parametrize("heading", ["time", "Time (s)", "Time (HH:MM:SS.mmm)", "Time [hh:mm:ss]", "# time", "none"])
def test_headings_of_times_of_day(tmp_path: Path, heading: str) -> None:
    path = clocked(tmp_path / "logged.csv", [day(7000 + 0.1 * i) for i in range(40)], heading)
    none = SourceOptions("2", "3", "1") if heading == "none" else SourceOptions()
    record = read(path, none)
    np.testing.assert_allclose(record.time, 0.1 * np.arange(40), atol=1e-9)
    assert len(record.notes) == 1 and "times of day" in record.notes[0]


@pytest.mark.parametrize(
    ("line", "cell", "heading", "words"),
    [
        (
            9,
            "09:61:00.0",
            "time",
            "line 11, column time holds '09:61:00.0'; expected a finite number, or a time like HH",
        ),
        (
            9,
            "12:34",
            "time",
            "line 11, column time holds '12:34'; expected a finite number, or a time like HH:MM:SS or",
        ),
        (
            9,
            "2025-11-09T09:27:03",
            "time",
            "line 11, column time holds '2025-11-09T09:27:03'; expected a time like the",
        ),
        (0, "2025-11-09T01:56:40", "time", "holds '01:56:40.100'; expected a time like the first one, 2025-11-09T01"),
        (
            9,
            "0.9",
            "time",
            "column time has 39 dates or times and 1 numbers; expected one of them on all lines: repair",
        ),
        (0, "0.9", "time", "column time has 39 dates or times and 1 numbers"),
        (9, "", "time", "1 lines have no time; expected a time on every line"),
        (9, "nan", "time", "1 lines have no time; expected a time on every line"),
        (0, "01:56:40.0", "time_ms", "holds '01:56:40.0'; expected a number in ms, as the heading says"),
        (0, "01:56:40.0", "Time (min)", "holds '01:56:40.0'; expected a number in min, as the heading says"),
        (0, "01:56:40.0", "angle_deg", "holds '01:56:40.0'; expected a number in deg, as the heading says"),
    ],
)
def test_a_time_of_day_that_cannot_be_used(tmp_path: Path, line: int, cell: str, heading: str, words: str) -> None:
    cells = [day(7000 + 0.1 * i) for i in range(40)]
    cells[line] = cell
    with pytest.raises(DataError) as refused:
        read(clocked(tmp_path / "logged.csv", cells, heading), SourceOptions(time=heading))
    assert words in str(refused.value) and "\n" not in str(refused.value)


@given(st.times(), st.booleans())
def test_a_clock_tells_the_nanoseconds_of_the_day(when: time, padded: bool) -> None:
    text = when.isoformat() if padded else when.isoformat().removeprefix("0")
    ns = (3600 * when.hour + 60 * when.minute + when.second) * 10**9 + 1000 * when.microsecond
    assert clock(text) == (ns, 86_400 * 10**9)


@given(st.datetimes(), st.sampled_from(["", "Z", "+01:00", "-0530"]))
def test_nanoseconds_are_those_between_dates(when: datetime, zone: str) -> None:
    found, first = nanoseconds(f"{when.isoformat()}{zone}"), nanoseconds("0001-01-01 00:00:00")
    assert found is not None and first is not None and found[1] == zone
    assert found[0] - first[0] == (when - datetime.min) // timedelta(microseconds=1) * 1000


@pytest.mark.parametrize("cell", ["", "0.1", "2025-11-09", "2025-13-09T00:00:00", "09:27:03", "2025-11-09 at noon"])
def test_other_cells_are_no_dates(cell: str) -> None:
    assert nanoseconds(cell) is None


@pytest.mark.parametrize("cell", ["", "0.1", "12:34", "1:2:3", "09:60:00", "9:27:03:748", "-1:00:00", "09:27:03 PM"])
def test_other_cells_are_no_times_of_day(cell: str) -> None:
    assert clock(cell) is None
