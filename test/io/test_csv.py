"""CSV files of many writers, and what is said about those that cannot be read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from msd_ident.data.record import from_samples
from msd_ident.errors import DataError, MsdError, UsageError
from msd_ident.io import SourceOptions, describe, read, write_csv

ROWS = [(i / 100, 1.5 * (i > 5), 0.001 * i * i) for i in range(40)]


def table(
    separator: str = ",", header: str = "time_s,force_n,position_m", rows: object = None, comma: str = "."
) -> str:
    """Text of a file with ``ROWS``."""
    lines = [header.replace(",", separator)]
    for row in ROWS if rows is None else rows:  # type: ignore[attr-defined]
        lines.append(separator.join(str(cell).replace(".", comma) for cell in row))
    return "\n".join(lines) + "\n"


def read_text(folder: Path, text: str | bytes, **options: object) -> object:
    path = folder / "data.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read(path, SourceOptions(**options))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "text",
    [
        table(),
        table(";"),
        table("\t"),
        table(" "),
        table("  "),
        table(";", comma=","),
        table("\t", comma=","),
        table().replace("\n", "\r\n"),
        table().replace("\n", "\r"),
        table().rstrip("\n"),
        table() + "\n\n",
        "\ufeff" + table(),
        table().encode("utf-16"),
        "# rig 3, 2024\n\n% made by hand\n" + table(),
        "# " + table(),
        table().replace("\n0.07,", "\n# pause\n\n0.07,"),
        table(header='"time_s","force_n","position_m"'),
        table(header=" Time_S , Force [N] , position (m)"),
        table(rows=[(f'"{t}"', f, x) for t, f, x in ROWS]),
        table(rows=[(*row, "") for row in ROWS]),  # a separator at the end of each line
        table(header="note,position_m,force_n,time_s", rows=[("a", x, f, t) for t, f, x in ROWS]),
        table(header="time_ms,force_mn,position_mm", rows=[(t * 1000, f * 1000, x * 1000) for t, f, x in ROWS]),
        table(header="t,force_kn,position_um", rows=[(t, f / 1000, x * 1e6) for t, f, x in ROWS]),
        table(header="timestamp_ns,force,position", rows=[(int(t * 1e9 + 0.5), f, x) for t, f, x in ROWS]),
    ],
)
def test_every_way_to_write_it_gives_the_same_record(tmp_path: Path, text: str | bytes) -> None:
    record = read_text(tmp_path, text)
    t, f, x = np.array(ROWS).T
    np.testing.assert_allclose(record.time, t, rtol=1e-12)
    np.testing.assert_allclose(record.force, f, rtol=1e-12)
    np.testing.assert_allclose(record.position, x, rtol=1e-12)
    assert (record.force_unit, record.position_unit, record.name) == ("N", "m", "data.csv")


def test_columns_scales_and_units_by_option(tmp_path: Path) -> None:
    text = table(header="sample,volts_v,encoder_counts")
    record = read_text(
        tmp_path, text, time="sample", force="volts_v", position="ENCODER_COUNTS", position_scale=-2.0, time_scale=0.1
    )
    t, f, x = np.array(ROWS).T
    np.testing.assert_allclose(record.time, 0.1 * t, rtol=1e-12)
    np.testing.assert_array_equal(record.position, -2.0 * x)
    np.testing.assert_array_equal(record.force, f)
    assert (record.force_unit, record.position_unit) == ("V", "m")
    record = read_text(tmp_path, text, time="sample", force="volts_v", position="encoder_counts", force_scale=35.0)
    assert (record.force_unit, record.position_unit) == ("N", "count")
    joint = table(header="time_s,force_nm,position_deg")
    record = read_text(tmp_path, joint)
    assert (record.force_unit, record.position_unit) == ("N·m", "rad")
    np.testing.assert_allclose(record.position, np.deg2rad(x))
    assert record.notes == ("column position_deg was multiplied by 0.0174533, as its unit says.",)


@pytest.mark.parametrize(
    ("unit", "of_record", "factor"),
    [
        *((unit, "rad", np.pi / 180) for unit in ("deg", "degree", "degrees", "Deg", "°")),
        *(("mm", "m", 1e-3), ("cm", "m", 1e-2), ("um", "m", 1e-6), ("µm", "m", 1e-6), ("μm", "m", 1e-6)),
        *(("in", "m", 0.0254), ("mrad", "rad", 1e-3), ("radians", "rad", 1.0), ("counts", "count", 1.0)),
        *(("ft", "m", 0.3048), ("rev", "rad", 2 * np.pi)),
    ],
)
def test_a_unit_converts_alike_as_an_option_and_in_a_heading(
    tmp_path: Path, unit: str, of_record: str, factor: float
) -> None:
    """Degrees as an option stayed degrees, and laws of an angle were lost."""
    given = read_text(tmp_path, table(header="time,force,position"), position_unit=unit)
    named = read_text(tmp_path, table(header=f"time,force,position ({unit})"))
    for record in (given, named):
        assert record.position_unit == of_record
        np.testing.assert_allclose(record.position, factor * np.array(ROWS)[:, 2], rtol=1e-12)
    said = f"column position was multiplied by {factor:g}, as --position-unit {unit} says."
    assert given.notes == ((said,) if factor != 1.0 else ())
    both = read_text(tmp_path, table(header=f"time,force,position ({unit})"), position_unit=unit)
    np.testing.assert_array_equal(both.position, named.position)


@pytest.mark.parametrize(
    ("unit", "of_record", "factor"),
    [
        *(("kN", "N", 1e3), ("mV", "V", 1e-3), ("Nm", "N·m", 1.0), ("N·cm", "N·m", 0.01), ("daN", "N", 10.0)),
        *((unit, "N", 4.4482216152605) for unit in ("lbf", "lb")),
        *((unit, "N·m", 0.1129848290276167) for unit in ("lb-in", "in·lbf", "lbf in")),
        *((unit, "N·m", 1.3558179483314004) for unit in ("ft-lb", "lbf·ft", "ft.lbs")),
        *(("oz-in", "N·m", 0.00706155181422604), ("kgf", "N", 9.80665), ("gf", "N", 0.00980665), ("dyn", "N", 1e-5)),
    ],
)
def test_a_force_unit_converts_alike(tmp_path: Path, unit: str, of_record: str, factor: float) -> None:
    given = read_text(tmp_path, table(header="time,force,position"), force_unit=unit)
    named = read_text(tmp_path, table(header=f"time,force ({unit}),position"))
    for record in (given, named):
        assert record.force_unit == of_record
        np.testing.assert_allclose(record.force, factor * np.array(ROWS)[:, 1], rtol=1e-12)


@pytest.mark.parametrize(("unit", "factor"), [("km", 1e3), ("yd", 0.9144), ("mil", 2.54e-5)])
def test_rare_units_of_a_position(tmp_path: Path, unit: str, factor: float) -> None:
    record = read_text(tmp_path, table(header=f"time,force,position ({unit})"))
    np.testing.assert_allclose(record.position, factor * np.array(ROWS)[:, 2], rtol=1e-12)


@pytest.mark.parametrize(("heading", "factor"), [("Time (min)", 60.0), ("time_min", 60.0), ("t (h)", 3600.0)])
def test_long_units_of_time(tmp_path: Path, heading: str, factor: float) -> None:
    record = read_text(tmp_path, table(header=f"{heading},force,position"), time=heading)
    np.testing.assert_allclose(record.time - record.time[0], factor * (np.array(ROWS)[:, 0] - ROWS[0][0]), atol=1e-9)


def test_a_least_value_is_no_minute(tmp_path: Path) -> None:
    record = read_text(tmp_path, table(header="time,force,position_min"), position="position_min")
    assert record.notes == ()


@pytest.mark.parametrize("header", ["time,force (MN),position", "time,force,position (Mm)", "time (Ms),force,position"])
def test_milli_or_mega_is_asked(tmp_path: Path, header: str) -> None:
    with pytest.raises(
        DataError, match="ends with M., which may be milli or mega; expected one that is clear: correct"
    ):
        read_text(tmp_path, table(header=header))
    in_capitals = read_text(tmp_path, table(header="TIME (MS),force,POSITION (MM)"))
    np.testing.assert_allclose(in_capitals.position, 1e-3 * np.array(ROWS)[:, 2], rtol=1e-12)


@pytest.mark.parametrize(
    ("header", "says"),
    [
        ("time,force (smoot),position", "column force (smoot) is read in N: smoot is no unit that is known here"),
        ("time,force,position (furlong)", "If it is one, give --position-scale, the factor to m."),
        ("time (fortnight),force,position", "is read in seconds: fortnight is no unit of time. If it is one, give"),
    ],
)
def test_a_unit_that_is_not_known_is_said(tmp_path: Path, header: str, says: str) -> None:
    assert any(says in note for note in read_text(tmp_path, table(header=header)).notes)


@pytest.mark.parametrize("cell", ["#VALUE!", "#DIV/0!", "1.#QNAN", "-1.#IND"])
def test_cells_with_a_hash_are_no_comments(tmp_path: Path, cell: str) -> None:
    """They were cut at the hash: a missing force was held, a missing position read as 1."""
    for place in (1, 2):
        rows = [list(map(str, row)) for row in ROWS]
        rows[3][place] = cell
        text = "time,force,position\n" + "".join(",".join(row) + "\n" for row in rows)
        with pytest.raises(
            DataError, match=f"line 5, column (force|position) holds '{cell}'; expected a finite number"
        ):
            read_text(tmp_path, text)


def test_a_comment_behind_numbers_is_none_of_them(tmp_path: Path) -> None:
    lines = table().splitlines()
    lines[4] += "  # the hand touched it"
    np.testing.assert_array_equal(read_text(tmp_path, "\n".join(lines) + "\n").position, np.array(ROWS)[:, 2])


def test_empty_cells_of_the_force_are_said(tmp_path: Path) -> None:
    lines = table().splitlines()
    time, _, position = lines[3].split(",")
    lines[3] = f"{time},,{position}"
    assert any(
        "column force_n is empty in 1 of the lines that have a position: the force is held there" in note
        for note in read_text(tmp_path, "\n".join(lines) + "\n").notes
    )


def test_units_behind_a_comma_in_quoted_headings(tmp_path: Path) -> None:
    """``"Position, mm"`` was a name without a unit, and not found as position."""
    head = '"Time, ms","Force, kN","Position, mm"\n'
    record = read_text(tmp_path, head + "".join(f"{1e3 * t},{f / 1e3},{1e3 * x}\n" for t, f, x in ROWS))
    for found, true in zip((record.time, record.force, record.position), np.array(ROWS).T, strict=True):
        np.testing.assert_allclose(found, true, rtol=1e-12)
    other = '"Time, s","Force, N","Velocity, m/s"\n' + table().split("\n", 1)[1]
    with pytest.raises(DataError, match="column Velocity, m/s is in m/s; expected a length"):
        read_text(tmp_path, other, position="velocity")


@pytest.mark.parametrize(
    ("heading", "options", "of_record", "factor"),
    [
        ("position", {"position_unit": "deg", "position_scale": 0.5}, "rad", np.pi / 360),  # half a degree a count
        ("position (deg)", {"position_unit": "deg", "position_scale": -1.0}, "rad", -np.pi / 180),
        ("position (deg)", {"position_unit": "rad"}, "rad", np.pi / 180),
        ("position (deg)", {"position_unit": "rad", "position_scale": 2.0}, "rad", 2.0),
        ("position (deg)", {"position_scale": 0.02}, "rad", 0.02),
        ("position (mm)", {"position_unit": "count"}, "count", 1.0),
        ("position_in", {"position_unit": "rad"}, "rad", 1.0),  # of the input
        ("position_m", {"position_unit": "deg"}, "rad", np.pi / 180),  # of the motor
    ],
)
def test_the_unit_is_that_of_the_scaled_numbers(
    tmp_path: Path, heading: str, options: dict[str, object], of_record: str, factor: float
) -> None:
    record = read_text(tmp_path, table(header=f"time,force,{heading}"), **options)
    assert record.position_unit == of_record
    np.testing.assert_allclose(record.position, factor * np.array(ROWS)[:, 2], rtol=1e-12)


@pytest.mark.parametrize(
    ("heading", "options", "words"),
    [
        (
            "position",
            {"position_unit": "deg", "position_scale": 0.017453293},
            "--position-scale 0.0174533 and --position-unit deg both convert deg to rad; expected one of them: leave "
            "the scale away, or give the unit after scaling, --position-unit rad",
        ),
        (
            "position (cm)",
            {"position_unit": "mm"},
            "column position (cm) is in cm, and --position-unit says mm; expected one unit: leave --position-unit "
            "away, or give --position-scale too if the heading is wrong",
        ),
        (
            "position (deg)",
            {"position_scale": -1.0},
            "--position-scale -1 would take column position (deg) for rad, whose heading says deg; expected the factor "
            "to rad, --position-scale -0.0174533, or its unit too: --position-unit deg",
        ),
    ],
)
def test_a_scale_and_units_that_contradict_each_other(
    tmp_path: Path, heading: str, options: dict[str, object], words: str
) -> None:
    with pytest.raises(MsdError) as refused:
        read_text(tmp_path, table(header=f"time,force,{heading}"), **options)
    assert words in str(refused.value) and "\n" not in str(refused.value)


def test_a_free_decay_has_no_force_column(tmp_path: Path) -> None:
    record = read_text(tmp_path, table(header="time_s,voltage,position_m"), force="none")
    assert record.force.tolist() == [0.0]


def test_lines_above_the_header_are_titles(tmp_path: Path) -> None:
    """A PASCO or Vernier export: the title has another number of cells, and may have commas."""
    titles = "Voltage, ChA, Run #1\nThu, Oct 07, 2021 10:26 AM\n\n"
    record = read_text(tmp_path, titles + table())
    assert record.position.tolist() == read_text(tmp_path, table()).position.tolist()


def test_units_in_a_line_of_their_own(tmp_path: Path) -> None:
    record = read_text(tmp_path, table(header="time,force,position\n(ms),N,[mm]"))
    plain = read_text(tmp_path, table(header="time_ms,force_n,position_mm"))
    assert record.time.tolist() == plain.time.tolist()
    assert record.position.tolist() == plain.position.tolist()


def test_a_joints_torque_and_angle_need_no_option(tmp_path: Path) -> None:
    record = read_text(tmp_path, table(header="time_s,torque_nm,angle_deg"))
    assert (record.force_unit, record.position_unit) == ("N·m", "rad")
    np.testing.assert_allclose(record.position, np.radians(np.array(ROWS)[:, 2]))
    both = table(header="time_s,force_n,position_m,torque_nm,angle_deg", rows=[(*r, 0, 0) for r in ROWS])
    assert read_text(tmp_path, both).force_unit == "N", "force and position go first"
    with pytest.raises(DataError, match="has no column called position; the columns are: time_s, torque_nm, shaft_deg"):
        read_text(tmp_path, table(header="time_s,torque_nm,shaft_deg"))
    with pytest.raises(DataError, match="has no column called position"):  # not as metres
        read_text(tmp_path, table(header="time_s,torque_nm,angle"))


def test_columns_without_a_header_have_numbers(tmp_path: Path) -> None:
    bare = table().split("\n", 1)[1]
    record = read_text(tmp_path, bare, time="1", force="2", position="3")
    assert record.position.tolist() == read_text(tmp_path, table()).position.tolist()


@pytest.mark.parametrize("value", [0.0, 1.5])
def test_a_force_column_that_never_changes_is_named(tmp_path: Path, value: float) -> None:
    rows = [(t, value, x) for t, _, x in ROWS]
    record = read_text(tmp_path, table(header="time_s,duty_cycle_v,position_m", rows=rows), force="duty_cycle_v")
    assert record.notes == (
        f"column duty_cycle_v is {value:g} V in all 40 samples while the cart moves: check that it is the force "
        "(--force NAME), or give --force none if nothing drives the cart.",
    )
    assert read_text(tmp_path, table(rows=rows), force="none").notes == ()
    assert read_text(tmp_path, table()).notes == ()


@pytest.mark.parametrize(
    ("head", "mark"),
    [
        ("", "."),
        ("position\n", "."),
        ("position\n", ","),
        ("Position of the cart\n", ","),
        ('"Angle, Ch 1+2 (m) Run #1"\n', "."),
        ('"Angle, Ch 1+2 (m) Run #1"\n', ","),
        ("Decay of Monday\nposition\n(m)\n", ","),
        ("# position\n", "."),
        ("Voltage, ChA, Run #1\n", "."),
        ("start, rate, duration\n90, 1000, 5\n", "."),
    ],
)
def test_a_file_of_one_column_is_read_with_a_rate(tmp_path: Path, head: str, mark: str) -> None:
    x = 0.1 * np.exp(-0.01 * np.arange(300.0)) * np.cos(0.2 * np.arange(300.0))
    lines = "".join(f"{value:.6f}\n".replace(".", mark) for value in x)
    record = read_text(tmp_path, head + lines, rate=200.0, position="1", force="none")
    np.testing.assert_allclose(record.position, x, atol=1e-6)
    np.testing.assert_allclose(record.time, np.arange(300) / 200.0, atol=1e-12)


def test_a_column_is_found_by_its_place_where_no_heading_is_that_number(tmp_path: Path) -> None:
    record = read_text(tmp_path, table(header="a,b,c"), time="1", force="2", position="3")
    assert record.position.tolist() == read_text(tmp_path, table()).position.tolist()
    with pytest.raises(DataError, match="has no column 4; the columns are: a, b, c"):
        read_text(tmp_path, table(header="a,b,c"), time="1", force="2", position="4")


def test_a_free_decay_of_a_joint_without_a_header_is_in_newton_metres(tmp_path: Path) -> None:
    bare = table().split("\n", 1)[1]
    record = read_text(tmp_path, bare, time="1", force="none", position="3", position_unit="rad")
    assert (record.force_unit, record.position_unit) == ("N·m", "rad")


def test_time_that_does_not_begin_at_zero(tmp_path: Path) -> None:
    record = read_text(tmp_path, table(rows=[(t + 1000.5, f, x) for t, f, x in ROWS]))
    assert record.time[0] == record.force_time[0] == 0.0
    np.testing.assert_allclose(record.time, np.array(ROWS)[:, 0], atol=1e-9)


def test_empty_cells_are_no_samples(tmp_path: Path) -> None:
    rows = [(t, f if i % 10 == 0 else "", x) for i, (t, f, x) in enumerate(ROWS)]
    record = read_text(tmp_path, table(rows=rows))
    assert record.force_time.tolist() == [0.0, 0.1, 0.2, 0.3]
    assert record.samples == 40


WORDS = ["nan", "NaN", "-nan", "NA", "N/A", "#N/A", "null", "NULL", "None", '"NA"', " nan ", "nan(ind)"]


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_word_for_a_missing_number_is_an_empty_cell(tmp_path: Path, word: str, separator: str) -> None:
    """As pandas, R, C and ROS loggers write them; a file with one was refused."""
    for force, position, row in ((word, "", 0), ("", word, 5), (word, word, 12), (word, word, 39)):
        rows = [list(map(str, one)) for one in ROWS]
        empty = [list(one) for one in rows]
        for column, said in ((1, force), (2, position)):
            if said:
                rows[row][column], empty[row][column] = said, ""
        found = read_text(tmp_path, table(separator, rows=rows))
        same = read_text(tmp_path, table(separator, rows=empty))
        for one, other in ((found.time, same.time), (found.position, same.position), (found.force, same.force)):
            np.testing.assert_array_equal(one, other)
        assert found.notes == same.notes and found.samples == 40 - bool(position)


def test_words_for_missing_numbers_in_white_space_and_in_the_first_line(tmp_path: Path) -> None:
    rows = [("NA", "NA", "NA"), (0.0, "null", "null"), *ROWS[1:]]
    for separator in (",", " "):
        record = read_text(tmp_path, table(separator, rows=rows))
        np.testing.assert_array_equal(record.position, np.array(ROWS)[1:, 2])
    single = "position\nNone\n" + "".join(f"{x}\n" for _, _, x in ROWS)
    record = read_text(tmp_path, single, rate=100.0, force="none")
    np.testing.assert_array_equal(record.position, np.array(ROWS)[:, 2])
    assert record.samples == 40


@pytest.mark.parametrize("end", ["0.4", "0.4,", "0.40,1.", '0.40,1.5,"0', "0.40,1.5,-", "0.40,1.5,1.2e-"])
@pytest.mark.parametrize(("separator", "line_break"), [(",", "\n"), (",", "\r\n"), (";", "\n"), ("\t", "\n")])
def test_a_line_that_the_file_ends_in_the_middle_of_is_left_out(
    tmp_path: Path, end: str, separator: str, line_break: str
) -> None:
    """A logger that was killed; the whole file was refused."""
    end = end.replace(",", separator)
    record = read_text(tmp_path, (table(separator) + end).replace("\n", line_break))
    np.testing.assert_array_equal(record.position, np.array(ROWS)[:, 2])
    said = f"line 42 was left out: the file ends in the middle of it, behind {end!r}."
    assert record.notes == (said,)
    assert describe(tmp_path / "data.csv").notes == (said,)


def test_a_cut_line_of_numbers_in_white_space_or_with_a_mark_behind_each(tmp_path: Path) -> None:
    marked_ends = table(rows=[(*row, "") for row in ROWS])
    for text in (table(" ") + "0.4 1.", table("  ") + "0.4", marked_ends + "0.4,1.5", marked_ends + "0.4,1.5,0.03"):
        record = read_text(tmp_path, text)
        np.testing.assert_array_equal(record.position, np.array(ROWS)[:, 2])
        assert record.notes[0].startswith("line 42 was left out: ")


def test_a_last_line_with_all_its_cells_stays(tmp_path: Path) -> None:
    for end in ("0.4,1.5,1.6", "0.4,1.5,1.6,", "0.4,1.5,", "# stopped", "   "):
        record = read_text(tmp_path, table() + end)
        assert record.notes == () and record.samples == (41 if end.startswith("0.4,1.5,1") else 40)


@pytest.mark.parametrize("end", ["0.4,1.\n", "0.4,1.\r\n", "0.4,1.\n\n", "0.4,1.5,-\n", "0.4,1.5,1.6,9"])
def test_a_short_line_with_a_line_break_is_refused(tmp_path: Path, end: str) -> None:
    with pytest.raises(DataError, match="line 42"):
        read_text(tmp_path, table() + end)
    brackets = "time_s force_n position_m\n[" + "".join(f"{t} {f} {x};\n" for t, f, x in ROWS)
    for closed in ("0.4 1.5]", "0.4 1.5];", "0.4 1.5]\n"):
        with pytest.raises(DataError, match="line 42 has 2 cells"):
            read_text(tmp_path, brackets + closed)


def test_a_header_and_a_cut_line_are_no_table(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="has a header and no numbers"):
        read_text(tmp_path, "time_s,force_n,position_m\n0.0,1.")


def changed(line: int, text: str) -> str:
    """A good file with one line replaced; line 1 is the header."""
    lines = table().splitlines()
    lines[line - 1] = text
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["is empty", "time_s,force_n,position_m"]),
        ("\n\n# nothing\n", ["is empty"]),
        ("time_s,force_n,position_m\n", ["has one line"]),
        ("time_s force_n position_m\n", ["has one line"]),
        (table().split("\n", 1)[1], ["has no column called time; the columns are: 1, 2, 3", "--time COLUMN"]),
        ("Voltage, ChA, Run #1\nno numbers\n", ["has no line of numbers", "time_s,force_n,position_m"]),
        (changed(7, "0.05,1.5"), ["line 7 has 2 cells", "expected 3", "time_s, force_n, position_m"]),
        (changed(7, "0.05,1.5,0.1,9"), ["line 7 has 4 cells"]),
        (changed(8, "0.06,abc,0.1"), ["line 8", "column force_n holds 'abc'"]),
        (changed(8, "0.06,1.5,nano"), ["line 8", "column position_m holds 'nano'", "finite"]),
        (changed(8, "0.06,1.5,inf"), ["line 8", "'inf'"]),
        (changed(8, "0.06,1.5,-Infinity"), ["line 8", "'-Infinity'"]),
        (changed(8, ",1.5,0.1"), ["1 lines have no time_s"]),
        (changed(8, "nan,1.5,0.1"), ["1 lines have no time_s"]),
        (changed(8, "None,1.5,0.1"), ["1 lines have no time_s"]),
        (table(comma=","), ["line 2 has 6 cells", "decimal points, or semicolons"]),
        (table(header="time_s,force_n,x"), ["no column called position", "time_s, force_n, x", "--position COLUMN"]),
        (table(header="time_s,f,position_m"), ["no column called force", "--force none for a free decay"]),
        (table(header="a,force,position"), ["no column called time", "--time COLUMN"]),
        (table(header="time_s,force_n,position_m,position_mm", rows=[(*r, 0) for r in ROWS]), ["2 columns called pos"]),
        (table(rows=ROWS[:5]), ["5 position samples", "at least 20"]),
        (table(rows=[(t, f, 0.25) for t, f, _ in ROWS]), ["never changes (0.25 m in all 40 samples)"]),
        (table(rows=ROWS + ROWS), ["position stamps run backwards: 0.390 s back at sample 41 of 80", "looped"]),
        (table(rows=[(t, "", x) for t, _, x in ROWS]), ["no force samples: column force_n has", "none for a free"]),
        (
            table(rows=[(t, f, "") for t, f, _ in ROWS]),
            ["no position samples: column position_m has no number on any line", "another column with --position"],
        ),
        (b"\x89PNG\r\n" + bytes(50), ["is not text"]),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path: Path, text: str | bytes, words: list[str]) -> None:
    with pytest.raises(DataError) as refused:
        read_text(tmp_path, text)
    line = str(refused.value)
    assert "\n" not in line
    for word in words:
        assert word in line


def test_a_column_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="has no column torque; the columns are: time_s, force_n, position_m"):
        read_text(tmp_path, table(), force="torque")


def test_duplicate_and_late_lines_are_repaired_with_a_note(tmp_path: Path) -> None:
    rows = list(ROWS)
    rows[10], rows[11] = rows[11], rows[10]
    rows.insert(20, (*ROWS[20][:2], 99.0))
    record = read_text(tmp_path, table(rows=rows))
    assert record.samples == 40
    assert record.position[20] == 99.0
    assert "position: 1 of 41 samples came late and were sorted by their stamps." in record.notes
    assert "position: 1 samples with duplicate stamps were dropped, 1 of them with another value." in record.notes


def test_nothing_is_overwritten_unasked(tmp_path: Path) -> None:
    record = from_samples(*np.array(ROWS).T)
    path = tmp_path / "new" / "data.csv"
    write_csv(record, path)
    assert path.read_text().splitlines()[:2] == ["time_s,force_n,position_m", "0.0,0.0,0.0"]
    with pytest.raises(UsageError, match="exists; expected a new name"):
        write_csv(record, path)
    write_csv(record, path, overwrite=True)


def test_a_place_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(MsdError, match="cannot write"):
        write_csv(from_samples(*np.array(ROWS).T), tmp_path / "file" / "data.csv")


def test_a_table_that_would_fill_the_memory_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "huge.csv"
    with path.open("wb") as file:
        file.write(b"time_s,force_n,position_m\n")
        file.truncate(3 * 10**9)  # a hole: nothing is on the disk
    with pytest.raises(DataError, match="huge.csv has 3000 MB; expected at most 500: cut it, or make it a bag"):
        read(path)


def test_measured_files(shared_data: Path) -> None:
    options = SourceOptions(force="control_effort_v", position="encoder_counts", position_scale=-1 / 56000)
    step = read(shared_data / "ecp210" / "step_1.csv", options)
    assert (step.samples, step.force_unit, step.position_unit) == (677, "V", "m")
    assert step.position.max() == pytest.approx(263 / 56000)
    assert step.notes == ()
    axis = read(shared_data / "emps" / "emps_train.csv")
    assert (axis.samples, axis.force_unit, axis.duration) == (24841, "N", pytest.approx(24.84))
    with pytest.raises(DataError, match="the columns are: time_s, control_effort_v, encoder_counts"):
        read(shared_data / "ecp210" / "step_1.csv")


def quoted(*rows: tuple[str, ...]) -> str:
    return "\n".join(",".join(f'"{cell}"' for cell in row) for row in rows) + "\n"


def marked(value: float, decimal: str, thousands: str) -> str:
    """A number with three decimals and these marks."""
    return f"{value:,.3f}".translate({ord("."): decimal, ord(","): thousands})


@pytest.mark.parametrize(
    ("separator", "decimal", "thousands"),
    [(",", ".", ","), (",", ",", "."), (",", ",", ""), (";", ",", "."), (";", ",", ""), (",", ".", "")],
)
def test_quoted_numbers_with_decimal_commas_and_thousands(
    tmp_path: Path, separator: str, decimal: str, thousands: str
) -> None:
    """``"0,010","5.980,000"`` was split at every comma."""
    rows = [(1000.0 * t, 1e3 * f, 1e6 * x) for t, f, x in ROWS]
    lines = ['"Time (ms)","Force (mN)","Position (um)"'.replace(",", separator)]
    lines += [separator.join(f'"{marked(value, decimal, thousands)}"' for value in row) for row in rows]
    record = read_text(tmp_path, "\n".join(lines))
    t, f, x = np.array(ROWS).T
    for found, true in ((record.time, t), (record.force, f), (record.position, x)):
        np.testing.assert_allclose(found, true, rtol=1e-12)


def test_text_with_commas_in_quotes_is_one_cell(tmp_path: Path) -> None:
    rows = [(t, f, x, '"on, steady"') for t, f, x in ROWS]
    record = read_text(tmp_path, table(header="time_s,force_n,position_m,state", rows=rows))
    np.testing.assert_array_equal(record.position, np.array(ROWS)[:, 2])


def test_a_comma_that_may_be_either_is_refused(tmp_path: Path) -> None:
    rows = [(str(i), f"{i + 1},500", "2") for i in range(30)]
    with pytest.raises(DataError, match='cells like "1,500", whose comma may be decimal or separate thousands'):
        read_text(tmp_path, quoted(("time_s", "force_n", "position_m"), *rows))


@pytest.mark.parametrize(
    ("first", "step", "factor", "said"),
    [
        (1724354446163542502, 10_000_000, 1e-9, "nanoseconds, which gives 100 Hz"),
        (1724354446163542, 10_000, 1e-6, "microseconds, which gives 100 Hz"),
        (1724354446163, 10, 1e-3, "milliseconds, which gives 100 Hz"),
        (0, 10_000_000, 1e-9, "nanoseconds, which gives 100 Hz"),
        (0, 1_000, 1e-6, "microseconds, which gives 1000 Hz"),
    ],
)
def test_whole_stamps_without_a_unit_are_taken_for_what_they_can_be(
    tmp_path: Path, first: int, step: int, factor: float, said: str
) -> None:
    """Taken as seconds, the stamps of a clock in nanoseconds gave a mass of 1e18 kg."""
    text = table(header="timestamp,force,position", rows=[(first + i * step, f, x) for i, (_, f, x) in enumerate(ROWS)])
    record = read_text(tmp_path, text)
    np.testing.assert_allclose(record.time, step * factor * np.arange(40), atol=1e-6)
    assert record.notes == (
        f"column timestamp has whole numbers and no unit: they are taken as {said}; if they are not, use --time-scale.",
    )
    assert read_text(tmp_path, text, time_scale=1.0 / step).notes == ()
    assert describe(tmp_path / "data.csv").duration == pytest.approx(record.duration)


@pytest.mark.parametrize("step", [1, 10, 100, 0.01, 10_000.5])
def test_other_stamps_stay_seconds(tmp_path: Path, step: float) -> None:
    rows = [(i * step, f, x) for i, (_, f, x) in enumerate(ROWS)]
    record = read_text(tmp_path, table(header="time,force,position", rows=rows))
    np.testing.assert_allclose(record.time, step * np.arange(40), rtol=1e-12)
    assert record.notes == ()


@pytest.mark.parametrize(
    ("option", "unit"), [("position", "kg"), ("position", "N"), ("position", "ms"), ("force", "kg"), ("force", "rpm")]
)
def test_a_unit_of_something_else_is_refused(option: str, unit: str) -> None:
    with pytest.raises(UsageError, match=f"--{option}-unit {unit} is no unit of a .*; expected one, or a name of your"):
        SourceOptions(**{f"{option}_unit": unit})
    for own in ("count", "V", "%", "cmd", "digits"):
        assert getattr(SourceOptions(**{f"{option}_unit": own}), f"as_{option}") == (own, 1.0)
