"""Files as instruments write them: brackets, decimal commas, no times, runs side by side, MAT files, rounded stamps."""

from __future__ import annotations

import json
import math
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from badinputs import run

from msd_ident.data.quality import check, missing_samples
from msd_ident.data.record import Record
from msd_ident.errors import DataError, SetupError, UsageError
from msd_ident.io import SourceOptions, describe, read, read_all
from msd_ident.io.channel_header import names_of
from msd_ident.io.even_stamps import rebuilt

T = np.arange(300) * 0.01
X = np.exp(-T) * np.cos(12.0 * T)


def write(path: Path, lines: list[str]) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def comma(value: float) -> str:
    return f"{value:.4f}".replace(".", ",")


def ecp(path: Path) -> Path:
    """An ECP export: brackets, a semicolon a line, headings with spaces in them, times with three decimals."""
    rows = [f"{i:6d} {i * 0.0088544:8.3f} {round(1000 * x):8d} {0.5:8.4f};" for i, x in enumerate(X)]
    rows[0], rows[-1] = f"[{rows[0]}", f"{rows[-1][:-1]}]"
    return write(path, [" Sample   Time     Encoder 1 Pos   Control Effort", "", *rows])


def side_by_side(path: Path, padding: str = "") -> Path:
    """Two runs of different length, each with its own times, and decimal commas; the shorter is padded."""
    head = ";".join(f'"{name} Run #{n}"' for n in (1, 2) for name in ("Time (s)", "Angle, Ch 1+2 (rad)", "Force (N)"))
    rows = []
    for i, (t, x) in enumerate(zip(T, X, strict=True)):
        second = [comma(t), comma(2.0 * x), "0,5"] if i < 200 else [padding] * 3
        rows.append(";".join([comma(t), comma(x), "0", *second]))
    return write(path, ["\ufeff" + head, *rows])


def no_times(path: Path, heading: str = "Position (mm)") -> Path:
    return write(path, [f"{heading};Temperature (°C)", *(f"{comma(1000 * x)};20,5" for x in X)])


def test_an_ecp_export_is_read(tmp_path: Path) -> None:
    source = SourceOptions("Control Effort", "Encoder 1 Pos", force_unit="V", position_scale=1e-3)
    record = read(ecp(tmp_path / "export.csv"), source)
    np.testing.assert_allclose(record.position, np.round(1000 * X) / 1000, atol=1e-12)
    assert (record.force_unit, record.position_unit, np.ptp(record.force)) == ("V", "m", 0.0)
    np.testing.assert_allclose(record.time, 0.0088544 * np.arange(300), atol=2e-4)
    assert np.ptp(np.diff(record.time)) < 1e-12, "rounded stamps are rebuilt"


def test_settings_with_a_value_above_the_names_are_no_numbers(tmp_path: Path) -> None:
    """A drive's recorder writes its settings as a name and a number each, then the names of the columns."""
    settings = ["Axis1", f"Number of sampling data,{T.size}", "Sampling time interval(ms),0.667"]
    rows = [f"{t:.4f},{x:.6f},0.5" for t, x in zip(T, X, strict=True)]
    table = write(tmp_path / "drive.csv", [*settings, "Time,Position,Torque", "s,m,N", *rows])
    record = read(table, SourceOptions(force="Torque"))
    assert record.samples == T.size and record.position_unit == "m"
    np.testing.assert_allclose(record.position, X, atol=1e-6)


@pytest.mark.parametrize("unit", ["ms", "[ms]", "(ms)"])
def test_a_unit_of_the_time_stands_above_names_of_the_other_columns(unit: str, tmp_path: Path) -> None:
    """A drive's recorder names its channels, and below them what each was set to; the times were read as seconds."""
    head = ["Axis1", "Time,Analog 1,Analog 2,Digital 1", f'{unit},"Droop pulses, by 1",mm,INP']
    rows = [f"{1000 * t:.1f},{x:.6f},{1000 * x:.6f},0.0" for t, x in zip(T, X, strict=True)]
    table = write(tmp_path / "drive.csv", [*head, *rows])
    assert [column.name for column in describe(table).topics] == [
        "Time (ms)",
        "Droop pulses, by 1",
        "Analog 2 (mm)",
        "INP",
    ]
    record = read(table, SourceOptions("none", "Analog 2"))
    np.testing.assert_allclose(record.time, T, atol=1e-9)
    np.testing.assert_allclose(record.position, X, atol=1e-6)
    assert "column Time (ms) was multiplied by 0.001, as its unit says." in record.notes
    assert read(table, SourceOptions("none", "Droop pulses, by 1")).position_unit == "m"


def channels(second: str = "0.01", mark: str = ",") -> list[str]:
    """A header as National Instruments' programs write it, of two channels with times of their own."""
    head = [
        "Timestamp,2020-03-16 17:04:51,Timestamp,2020-03-16 17:04:51",
        f"Interval,0.01,Interval,{second}",
        'Channel name,"Force",Channel name,"Angle, raw"',
        'Unit,"V",Unit,"deg"',
    ]
    rows = [f"{t:g},0.5,{t:g},{x:.6f}" for t, x in zip(T, X, strict=True)]
    return [line.replace(",", mark).replace(f"Angle{mark}", "Angle,") for line in [*head, *rows]]


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_a_header_of_the_properties_of_channels_is_read(mark: str, tmp_path: Path) -> None:
    table = write(tmp_path / "ni.csv", channels(mark=mark))
    found = describe(table, SourceOptions(position="Angle, raw"))
    names = ["Time", "Force (V)", "Time of Angle, raw", "Angle, raw (deg)"]
    assert [column.name for column in found.topics] == names
    assert (found.messages, found.duration, found.problem) == (300, pytest.approx(2.99), "")
    record = read(table, SourceOptions(position="Angle, raw"))
    np.testing.assert_allclose(record.time, T, atol=1e-9)
    np.testing.assert_allclose(record.position, np.deg2rad(np.round(X, 6)), atol=1e-12)
    assert (record.force_unit, record.position_unit) == ("V", "rad")


def test_channels_with_times_of_their_own_say_whose_they_are(tmp_path: Path) -> None:
    table = write(tmp_path / "ni.csv", channels(second="0.02"))
    with pytest.raises(DataError) as refused:
        read(table, SourceOptions(position="Angle, raw"))
    words = (
        "no column called time; the columns are: Time of Force, Force (V), Time of Angle, raw, Angle, raw (deg): say "
    )
    assert f"{words}which, by heading or number, with --time COLUMN" in str(refused.value)
    assert read(table, SourceOptions("none", "Angle, raw", "3")).samples == 300


def test_settings_above_the_names_are_no_channels() -> None:
    assert names_of([("Name", "Rig 3"), ("Interval", "0.01"), ("0.0", "1.2")]) == (("Time", "Rig 3"), 2)
    assert names_of([("Name", "Rig 3"), ("Interval", "0.01"), ("Time", "Position"), ("0.0", "1.2")]) is None
    assert names_of([("Name", "Rig 3"), ("Time", "Position"), ("0.0", "1.2")]) is None
    assert names_of([("Name", "Rig 3"), ("Interval", "0.01"), ("0.0", "1.2", "3.4", "5.6")]) is None


def test_two_times_are_told_apart_by_their_number(tmp_path: Path) -> None:
    rows = [f"{t:.2f},0.5,{t:.2f},{x:.6f}" for t, x in zip(T, X, strict=True)]
    table = write(tmp_path / "x.csv", ["t,force,t,position", *rows])
    with pytest.raises(
        DataError, match="has 2 columns called time; .*: say which, by heading or number, with --time C"
    ):
        read(table)
    assert read(table, SourceOptions(time="3")).samples == 300


def test_names_below_a_title_are_no_units(tmp_path: Path) -> None:
    rows = [f"{t:.2f},{x:.6f},0.0" for t, x in zip(T, X, strict=True)]
    table = write(tmp_path / "x.csv", ["Run 1,Channel A,Channel B", "Time,Position,s", *rows])
    assert [column.name for column in describe(table).topics] == ["Time", "Position", "s"]


def test_one_of_several_runs_is_read_and_all_of_them(tmp_path: Path) -> None:
    path = side_by_side(tmp_path / "runs.csv")
    source = SourceOptions("none", "Angle, Ch 1+2", run="2")
    second = read(path, source)
    assert (second.samples, second.position_unit, second.force_unit, second.name) == (
        200,
        "rad",
        "N·m",
        "runs.csv run 2",
    )
    np.testing.assert_allclose(second.position, 2.0 * X[:200], atol=1e-4)
    both = read_all(path, SourceOptions("Force", "Angle, Ch 1+2", run="all"))
    assert [(record.samples, float(record.force[0])) for record in both] == [(300, 0.0), (200, 0.5)]


@pytest.mark.parametrize("word", ["NA", "NaN", "nan", "N/A", "#N/A", '"NA"'])
def test_a_shorter_run_may_be_padded_with_a_word(word: str, tmp_path: Path) -> None:
    path = side_by_side(tmp_path / "runs.csv", word)
    assert read(path, SourceOptions("Force", "Angle, Ch 1+2", run="2")).samples == 200
    assert read(path, SourceOptions("Force", "Angle, Ch 1+2", run="1")).samples == 300


@pytest.mark.parametrize("word", ["NA", "#N/A", "nan", "null"])
def test_a_missing_number_in_the_middle_is_a_lost_sample(word: str, tmp_path: Path) -> None:
    rows = [f"{t:.2f},{x:.6f}" for t, x in zip(T, X, strict=True)]
    rows[40], rows[41] = f"{T[40]:.2f},{word}", f"{T[41]:.2f},{word}"
    record = read(write(tmp_path / "x.csv", ["time_s,position_m", *rows]), SourceOptions("none"))
    np.testing.assert_allclose(record.time, np.delete(T, [40, 41]), atol=1e-9)
    np.testing.assert_allclose(record.position, np.delete(X, [40, 41]), atol=1e-6)
    assert missing_samples(record) == 2
    assert "missing_samples" in [finding.code for finding in check(record)]


def test_every_run_gets_its_result_on_the_command_line(tmp_path: Path) -> None:
    path = side_by_side(tmp_path / "runs.csv")
    found = run("identify", path, "--force", "none", "--position", "Angle, Ch 1+2", "--run", "all", "--json", "-")
    lines = [json.loads(line) for line in found.out.splitlines()]
    assert [line["path"] for line in lines] == [f"{path} run 1", f"{path} run 2"]
    assert [line["data"][0]["samples"] > 250 for line in lines] == [True, False]
    one = run(
        "identify", path, "--force", "none", "--position", "angle, ch 1+2", "--run", "all", "--together", "--json", "-"
    )
    assert len(json.loads(one.out)["data"]) == 2


def test_a_rate_stands_in_for_times(tmp_path: Path) -> None:
    record = read(no_times(tmp_path / "sonar.csv"), SourceOptions("none", rate=100.0))
    np.testing.assert_allclose(record.time, T, atol=1e-12)
    np.testing.assert_allclose(record.position, X, atol=1e-6)
    assert "the stamps are those of 100 samples a second, as --rate says." in record.notes


@pytest.mark.parametrize(
    ("heading", "unit", "factor"),
    [
        ("Position (mm)", "m", 1e-3),
        ("position [cm]", "m", 1e-2),
        ("Position (°)", "rad", math.pi / 180),
        ("Position (µm)", "m", 1e-6),
        ("Position (counts)", "count", 1.0),
        ("Position (left)", "m", 1.0),
    ],
)
def test_units_in_headings(heading: str, unit: str, factor: float, tmp_path: Path) -> None:
    record = read(no_times(tmp_path / "x.csv", heading), SourceOptions("none", rate=100.0))
    assert record.position_unit == unit
    assert record.position[0] == pytest.approx(1000 * factor)


@pytest.mark.parametrize(
    "unit",
    [
        *("m/s^2", "m/s2", "m/s**2", "m/s²", "m/s/s", "ms^-2", "ms-2", "m s-2", "m.s^-2", "m·s⁻²", "m*s^-2", "cm/s2"),
        *("m/s", "m s^-1", "mm/s", "mps", "rad/s", "rad/s^2", "rad s-1", "rads-1", "deg/s", "deg/s2", "°/s", "rpm"),
        *("1/s", "kg m2", "m^2", "g", "A", "N", "Hz"),
    ],
)
def test_a_heading_with_the_unit_of_something_else_is_no_position(unit: str, tmp_path: Path) -> None:
    """A phone's recorder writes accelerations in m/s^2; as metres they gave a mass of their own."""
    path = no_times(tmp_path / "x.csv", f"Linear Acceleration x ({unit})")
    with pytest.raises(DataError) as refused:
        read(path, SourceOptions("none", "Linear Acceleration x", rate=100.0))
    assert f"x ({unit}) is in {unit}; expected a length, an angle or counts: choose another --pos" in str(refused.value)


@pytest.mark.parametrize("label", ["2", "A1", "M-1", "Ch 1", "Ch 1/2", "axis 2", "S2", "x1", "0.1", "min", "left"])
def test_a_label_in_brackets_is_no_unit(label: str, tmp_path: Path) -> None:
    path = no_times(tmp_path / "x.csv", f"Angle ({label})")
    assert read(path, SourceOptions("none", f"Angle ({label})", rate=100.0)).position[0] == pytest.approx(1000.0)


@pytest.mark.parametrize("unit", ["N·m", "N⋅m", "N*m", "N-m", "N.m", "N m", "Nm"])
def test_every_sign_of_a_product_makes_a_torque(unit: str, tmp_path: Path) -> None:
    rows = [f"{t:.2f},{t:.2f},{x:.6f}" for t, x in zip(T, X, strict=True)]
    path = write(tmp_path / "x.csv", [f"Time (s),Torque ({unit}),Angle (rad)", *rows])
    assert read(path, SourceOptions("Torque", "Angle")).force_unit == "N·m"


def rounded(lost: tuple[int, ...] = (), jitter: float = 0.0, counter: bool = True) -> list[str]:
    """Lines of 2 000 samples at 887 Hz whose stamps have three decimals."""
    time = np.arange(2000) / 887.1 + jitter * np.random.default_rng(3).uniform(-1.0, 1.0, 2000)
    rows = [(i, t, math.sin(20.0 * t)) for i, t in enumerate(time) if i not in lost]
    if counter:
        return ["Sample,time_s,position_m", *(f"{i},{t:.3f},{x:.6f}" for i, t, x in rows)]
    return ["time_s,position_m", *(f"{t:.3f},{x:.6f}" for _, t, x in rows)]


def of(path: Path, lines: list[str]) -> Record:
    return read(write(path, lines), SourceOptions("none"))


@pytest.mark.parametrize("counter", [True, False])
def test_rounded_stamps_are_no_lost_messages(counter: bool, tmp_path: Path) -> None:
    record = of(tmp_path / "x.csv", rounded(counter=counter))
    np.testing.assert_allclose(record.time, np.arange(2000) / 887.1, atol=5e-4)
    assert missing_samples(record) == 0
    assert not [finding for finding in check(record) if finding.code in ("missing_samples", "jitter")]
    evidence = "Sample numbers the samples" if counter else "the stamps stay within one rounding of even ones"
    assert f"time_s is rounded to 0.001 s, and {evidence}: the true times are rebuilt, 887.1 Hz." in record.notes


def test_a_rate_that_rounding_leaves_open_is_told_with_its_interval(tmp_path: Path) -> None:
    """Of 2 s with stamps of 10 ms the rate was 200.08 Hz for 200, and no interval held it."""
    true = 0.3333 + np.arange(400) / 200.0
    lines = ["time_s,position_m", *(f"{math.floor(100.0 * t) / 100.0:.2f},{math.sin(20.0 * t):.6f}" for t in true)]
    (note,) = of(tmp_path / "x.csv", lines).notes
    assert note.endswith(" Hz ± 0.1, which the intervals of the parameters leave out: a mass may be off by 0.1 %.")


def test_a_long_line_that_begins_like_a_rule_is_read_at_once(tmp_path: Path) -> None:
    """It took 1.4 times as long for each further sign: a heading of 70 dashes and a name did not end."""
    lines = ["-" * 2000 + " rig 3", "time_s,force_n,position_m"]
    lines += [f"{t:.3f},1.0,{x:.6f}" for t, x in zip(T, X, strict=True)]
    path = tmp_path / "told.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    assert read(path, SourceOptions()).samples == len(T)


@pytest.mark.parametrize("rule", ["-" * 37, "=== === ===", "|----|:---|---|", "__________", "--------,-------------"])
def test_a_rule_under_the_names_is_no_name(rule: str, tmp_path: Path) -> None:
    lines = ["Time(s), Position(mm)", rule, *(f"{t:.3f}, {1e3 * x:.6f}" for t, x in zip(T, X, strict=True))]
    record = read(write(tmp_path / "x.txt", lines), SourceOptions("none"))
    np.testing.assert_allclose(record.position, X, atol=1e-8)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-8"])
def test_headings_of_a_european_spreadsheet(encoding: str, tmp_path: Path) -> None:
    """Of "Weg (µm)" the unit was lost, and the numbers were read in metres."""
    path = tmp_path / "x.csv"
    lines = [
        "Zeit (s);Moment (Nm);Weg (µm);Winkel (°)",
        *(f"{t:.3f};0;{1e6 * x:.3f};{9 + t:.3f}" for t, x in zip(T, X, strict=True)),
    ]
    path.write_bytes("\n".join(lines).encode(encoding))
    record = read(path, SourceOptions("none", "Weg", "Zeit"))
    assert record.position_unit == "m"
    np.testing.assert_allclose(record.position, X, atol=1e-8)
    assert read(path, SourceOptions("none", "Winkel", "Zeit")).position[0] == pytest.approx(9.0 * math.pi / 180.0)
    cut = path.read_bytes()[:-2] + "µ".encode()[:1]  # in the middle of a character
    if encoding == "utf-8":
        path.write_bytes(cut)
        assert read(path, SourceOptions("none", "Weg", "Zeit")).position_unit == "m"


def of_digits(rate: float, digits: int, lost: tuple[int, ...] = (), count: int = 600) -> list[str]:
    """Lines whose stamps have so many digits: rounded ever more coarsely."""
    rows = [(t, math.sin(3.0 * t)) for i, t in enumerate(np.arange(count) / rate) if i not in lost]
    return ["time_s,position_m", *(f"{t:.{digits - 1}E},{x:.6f}" for t, x in rows)]


@pytest.mark.parametrize(("rate", "digits", "count"), [(29.97, 3, 535), (887.1, 4, 20_000), (100.0, 3, 1500)])
def test_stamps_of_a_fixed_number_of_digits_are_rebuilt(rate: float, digits: int, count: int, tmp_path: Path) -> None:
    """A camera's frames at 30 Hz: from 10 s on, three stamps each were the same, and two of them were dropped."""
    record = of(tmp_path / "x.csv", of_digits(rate, digits, count=count))
    assert record.samples == count
    np.testing.assert_allclose(record.time, np.arange(count) / rate, atol=0.3 / rate)
    assert not [one for one in check(record) if one.code in ("missing_samples", "jitter", "two_rates")]
    (note,) = record.notes
    assert note.startswith(f"time_s is written with {digits} digits, at its end rounded to ")
    assert note.endswith(" s, and the stamps stay within one rounding of even ones: the true times are rebuilt, "
                         f"{rate:g} Hz.")  # fmt: skip


@pytest.mark.parametrize("lost", range(30, 520, 35))
def test_stamps_of_a_fixed_number_of_digits_with_a_gap_are_left(lost: int) -> None:
    time = np.array([float(line.split(",")[0]) for line in of_digits(29.97, 3, (lost, lost + 1), 560)[1:]])
    assert rebuilt(time) is None


def test_stamps_that_are_no_seconds_are_left_to_be_refused() -> None:
    time = np.array([float(line.split(",")[0]) for line in of_digits(29.97, 3, count=535)[1:]])
    assert rebuilt(time) is not None
    with np.errstate(divide="raise", invalid="raise"):
        assert rebuilt(1e300 * time) is None and rebuilt(1e-300 * time) is None


def test_stamps_of_all_digits_are_left() -> None:
    assert rebuilt(np.arange(500) / 29.97 + 1e-4 * np.sin(np.arange(500))) is None
    assert rebuilt(np.arange(500) / 10.0) is None


def test_a_counter_tells_what_is_really_lost(tmp_path: Path) -> None:
    record = of(tmp_path / "x.csv", rounded(lost=(700, 701, 702, 1500)))
    assert missing_samples(record) == 4
    np.testing.assert_allclose(record.time[-1], 1999 / 887.1, atol=5e-4)


def test_stamps_that_truly_jitter_or_lose_are_left_as_they_are(tmp_path: Path) -> None:
    for lines in (rounded(jitter=2e-3, counter=False), rounded(lost=(700, 701, 702), counter=False)):
        times = sorted({float(line.split(",")[0]) for line in lines[1:]})
        try:
            record = of(tmp_path / "x.csv", [lines[0], *sorted(lines[1:], key=lambda line: float(line.split(",")[0]))])
        except DataError:
            continue
        np.testing.assert_allclose(record.time, np.array(times) - times[0], atol=1e-9)


def test_a_counter_shows_a_clock_that_drifts(tmp_path: Path) -> None:
    time = np.cumsum(np.where(np.arange(6000) < 3000, 1.1270e-3, 1.1290e-3))
    rows = [f"{i},{t:.3f},{math.sin(20.0 * t):.6f}" for i, t in enumerate(time)]
    record = of(tmp_path / "x.csv", ["Sample,time_s,position_m", *rows])
    assert missing_samples(record) == 0
    np.testing.assert_allclose(record.time, time - time[0], atol=6e-4)
    assert np.median(np.diff(record.time)[:2500]) == pytest.approx(1.1270e-3, rel=3e-4)


def drifting(period: float, lost: tuple[int, ...] = ()) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Stamps [s] with three decimals of 10 000 samples, less the lost ones; the clock drifts by 3 ms."""
    number = np.arange(10_000)
    return np.round(np.delete(period * number + 3e-3 * np.sin(np.pi * number / number[-1]), lost), 3)


def of_stamps(path: Path, time: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Record:
    return of(path, ["time_s,position_m", *(f"{t:.3f},{math.sin(20.0 * t):.6f}" for t in time)])


def test_a_clock_that_drifts_is_no_lost_message(tmp_path: Path) -> None:
    record = of_stamps(tmp_path / "x.csv", drifting(1.128e-3))
    assert missing_samples(record) == 0 and np.std(np.diff(record.time)) < 1e-5
    assert not [finding for finding in check(record) if finding.code in ("missing_samples", "jitter")]
    assert any("no interval is longer than the period rounded up" in note for note in record.notes)


def test_a_lost_sample_of_a_clock_that_drifts_is_found(tmp_path: Path) -> None:
    record = of_stamps(tmp_path / "x.csv", drifting(1.128e-3, lost=(5003,)))
    assert not [note for note in record.notes if "rebuilt" in note]
    assert "missing_samples" in [finding.code for finding in check(record)]


@pytest.mark.parametrize("period", [1.00e-3, 1.03e-3, 1.128e-3, 1.3333e-3, 1.5e-3, 1.9e-3, 3.33e-3])
def test_stamps_with_a_lost_sample_are_never_rebuilt(period: float) -> None:
    for lost in range(300, 9700, 501):
        assert rebuilt(drifting(period, lost=(lost, 9800))) is None


def mat(path: Path, **variables: object) -> Path:
    scipy.io.savemat(path, variables)
    return path


def test_a_mat_file_is_read(tmp_path: Path) -> None:
    path = mat(tmp_path / "x.mat", time=T, force=np.ones_like(T), position=X[:, None], fs=100.0, note="rig 3")
    record = read(path)
    np.testing.assert_array_equal(record.position, X)
    np.testing.assert_allclose(record.time, T, atol=1e-12)
    assert describe(path).kind == "MAT file" and describe(path).is_table
    assert [topic.name for topic in describe(path).topics] == ["time", "force", "position"]


def test_structures_and_matrices_of_a_mat_file(tmp_path: Path) -> None:
    path = mat(tmp_path / "x.mat", log={"t": T, "out": np.stack([X, 2 * X], axis=1)}, u=np.zeros((1, 300)))
    record = read(path, SourceOptions("u", "log.out(:,2)", "log.t"))
    np.testing.assert_array_equal(record.position, 2 * X)


def test_arrays_of_structures_and_cells_in_a_mat_file(tmp_path: Path) -> None:
    """A measurement program keeps its channels in a structure's array of structures; one of 600 was offered."""
    channels = np.zeros(40, dtype=[("Name", object), ("Data", object)])
    for i, channel in enumerate(channels):
        channel["Name"], channel["Data"] = f"ch {i}", np.zeros(0) if i == 0 else i * X
    cells = np.empty(2, dtype=object)
    cells[:] = [T, 3.0 * X]
    path = mat(tmp_path / "x.mat", rig={"log": {"of": channels}}, parts=cells)
    names = [topic.name for topic in describe(path).topics]
    assert names == [*(f"rig.log.of({i}).Data" for i in range(2, 41)), "parts{1}", "parts{2}"]
    record = read(path, SourceOptions("none", "rig.log.of(3).Data", "parts{1}"))
    np.testing.assert_array_equal(record.position, 2.0 * X)
    np.testing.assert_array_equal(read(path, SourceOptions("none", "parts{2}", rate=100.0)).position, 3.0 * X)
    with pytest.raises(DataError) as refused:
        read(path)
    assert ", rig.log.of(31).Data and 11 more, which msd info lists: say which, by heading" in str(refused.value)


def test_an_object_of_a_mat_file_is_no_column(tmp_path: Path) -> None:
    """A Simulink dataset was a column of six samples: the handle of the object."""
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "x.mat"

    def write(**others: np.ndarray) -> None:
        with h5py.File(path, "w", userblock_size=512) as file:
            file["data"] = np.array([[3707764736, 2, 1, 1, 1, 1]], dtype=np.uint32)
            file["data"].attrs["MATLAB_class"] = np.bytes_("Simulink.SimulationData.Dataset")
            file["data"].attrs["MATLAB_object_decode"] = np.int32(3)
            file["note"] = np.array([[114, 105, 103]], dtype=np.uint16)
            file["note"].attrs["MATLAB_class"] = np.bytes_("char")
            for name, values in others.items():
                file[name] = values
        with path.open("r+b") as raw:
            raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")

    write()
    with pytest.raises(
        DataError, match=r"no vector of numbers, data is an object \(Simulink.SimulationData.Dataset\);"
    ):
        describe(path)
    write(position=X[None, :])
    assert [topic.name for topic in describe(path).topics] == ["position"]


def test_a_mat_file_of_version_7_3(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "x.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["log/time"], file["log/position"] = T[None, :], X[None, :]
        file["both"] = np.stack([X, 2 * X])  # MATLAB's (300, 2)
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    record = read(path, SourceOptions("none", "both(:,2)", "log.time"))
    np.testing.assert_array_equal(record.position, 2 * X)


def test_version_7_3_without_h5py_names_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "x.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + bytes(400) + b"\x89HDF\r\n\x1a\n" + bytes(600))
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(SetupError, match=r"version 7.3, which needs h5py; .* pip install 'msd_ident\[mat\]', or save"):
        read(path)
    monkeypatch.undo()
    pytest.importorskip("h5py")
    with pytest.raises(
        DataError, match="cannot be read as a MAT file of version 7.3 .*; expected one that MATLAB saved"
    ):
        read(path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "has 2 runs side by side (1, 2); expected one at a time: say which with --run 1, or --run all"),
        ({"run": "7"}, "has the runs 1, 2; expected a run 7, which is not there: say --run 1, or --run all"),
        ({"run": "1"}, "no column called force; the columns are: Time (s), Angle, Ch 1+2 (rad), "),
    ],
)
def test_runs_that_cannot_be_read_name_the_option(options: dict[str, str], words: str, tmp_path: Path) -> None:
    path = side_by_side(tmp_path / "runs.csv")
    path.write_text(path.read_text(encoding="utf-8").replace("Force (N)", "Power (W)"), encoding="utf-8")
    with pytest.raises(DataError) as refused:
        read(path, SourceOptions(position="Angle, Ch 1+2", **options))  # type: ignore[arg-type]
    assert words in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "no column called time; the columns are: Position (mm), Temperature (°C): say which, by heading or "
         "number, with --time COLUMN, or the sampling rate with --rate HZ"),
        ({"position": "Temperature", "rate": 9.0}, "column Temperature (°C) is in °C; expected a length, an angle or "
         "counts: choose another --position, or give --position-unit and --position-scale"),
        ({"run": "1", "rate": 9.0}, "has no runs side by side; expected a run 1, which is not there: leave --run away"),
    ],
)  # fmt: skip
def test_tables_that_cannot_be_read_name_the_option(options: dict[str, object], words: str, tmp_path: Path) -> None:
    with pytest.raises(DataError) as refused:
        read(no_times(tmp_path / "sonar.csv"), SourceOptions("none", **options))  # type: ignore[arg-type]
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_a_unit_given_by_option_beats_a_heading_of_something_else(tmp_path: Path) -> None:
    source = SourceOptions("none", "Temperature", rate=100.0, position_unit="count")
    path = no_times(tmp_path / "x.csv")
    path.write_text(path.read_text(encoding="utf-8").replace(";20,5", ";30,5", 5), encoding="utf-8")
    assert read(path, source).position_unit == "count"


@pytest.mark.parametrize(
    ("variables", "options", "words"),
    [
        (
            {"t": T, "F": X, "x": X},
            {},
            "x.mat has no column called position; the columns are: t, F, x: say which, by heading or number, with --p",
        ),
        (
            {"t": T, "x": X[:250]},
            {"position": "x"},
            "different lengths (x 250, t 300); expected one number for each sam",
        ),
        (
            {"fs": 100.0, "note": "rig"},
            {},
            "x.mat holds no vector of numbers; expected variables with a number for each",
        ),
    ],
)
def test_mat_files_without_the_variables(
    variables: dict[str, object], options: dict[str, str], words: str, tmp_path: Path
) -> None:
    with pytest.raises(DataError) as refused:
        read(mat(tmp_path / "x.mat", **variables), SourceOptions("none", **options))  # type: ignore[arg-type]
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_a_broken_mat_file_is_refused(tmp_path: Path) -> None:
    path = mat(tmp_path / "x.mat", time=T, position=X)
    path.write_bytes(path.read_bytes()[:700])
    with pytest.raises(
        DataError, match="cannot be read as a MAT file .*; expected one that MATLAB saved: save it again"
    ):
        read(path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rate": 0.0}, "rate is 0; expected a sampling rate above 0, e.g. --rate 100"),
        ({"rate": 9.0, "time": "t"}, "a rate of 9 and the time column t; expected one of them"),
        ({"rate": 9.0, "time_scale": 0.001}, "a rate of 9 and a time scale of 0.001; expected one of them"),
        (
            {"time_scale": -1.0},
            "time scale is -1; expected a number above 0, the seconds in one unit of the time column",
        ),
        ({"run": "first"}, "run is 'first'; expected its number, or all, e.g. --run 2"),
    ],
)
def test_options_that_make_no_sense(options: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        SourceOptions(**options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "words", [("--rate", "100"), ("--run", "1"), ("--time", "x"), ("--time-scale", "0.001")], ids=lambda words: words[0]
)
def test_bags_have_their_own_stamps(words: tuple[str, str]) -> None:
    bag = Path(__file__).resolve().parents[2] / "bags" / "paper_step"
    found = run("identify", bag, *words)
    assert found.code == 2
    assert f"{words[0]} with the bag {bag}; expected it for a table: messages have their own stamps" in found.err


@pytest.mark.parametrize(
    ("file", "source", "samples"),
    [
        ("raw/ecp_native_export.csv", SourceOptions("none", "Encoder 2 Pos", position_unit="count"), 677),
        ("raw/sensor_no_time_column.csv", SourceOptions("none", run="1", rate=100.0), 1993),
        ("raw/several_runs.csv", SourceOptions("Output Current", "Angle, Ch 1+2", run="10"), None),
        (
            "ecp2025_11_16_25.txt",
            SourceOptions("Control Effort", "Encoder 1 Pos", force_unit="V", position_unit="count"),
            10000,
        ),
    ],
)
def test_measured_files(file: str, source: SourceOptions, samples: int | None, shared_data: Path) -> None:
    path = shared_data / "real" / file
    if not path.exists():
        pytest.skip(f"no {path}")
    record = read(path, source)
    assert samples is None or record.samples == samples
    assert missing_samples(record) == 0
    assert not [finding for finding in check(record) if finding.code == "missing_samples"]


def test_what_scipy_warns_of_in_a_mat_file_is_not_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of objects (timeseries) it warned three times, with a path of its own installation."""
    path = tmp_path / "objects.mat"
    scipy.io.savemat(path, {"time": T, "force": np.sign(X), "position": X})
    plain = scipy.io.loadmat

    def warning(*args: object, **options: object) -> object:
        warnings.warn("Duplicate variable name in stream", scipy.io.matlab.MatReadWarning, stacklevel=2)
        return plain(*args, **options)

    monkeypatch.setattr(scipy.io, "loadmat", warning)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert read(path).samples == T.size
