"""MATLAB scripts with a matrix of readings, as students save an ECP export."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from msd_ident.errors import DataError
from msd_ident.io import SourceOptions, describe, read
from msd_ident.io.matlab_matrix import is_script, without_brackets

HEADINGS = "Sample   Time     Encoder 1 Pos   Control Effort"
SOURCE = SourceOptions("Control Effort", "Encoder 1 Pos", force_unit="V", position_unit="count")
COUNTS = np.round(1000.0 * np.cos(0.4 * np.arange(40)))
VOLTS = np.where(np.arange(40) % 20 < 10, 4.884, -1.5)


def rows(between: str = "  ", end: str = ";\n") -> str:
    lines = zip(range(40), 0.01 * np.arange(40), COUNTS.tolist(), VOLTS.tolist(), strict=True)
    return end.join(between.join((str(i), f"{t:.3f}", f"{x:.0f}", f"{f:.4f}")) for i, t, x, f in lines)


def script(above: str = f"% {HEADINGS}\n\n", begin: str = "data =[", end: str = "];\n", body: str = "") -> str:
    return f"{above}{begin}{body or rows()}{end}"


def write(folder: Path, text: str, name: str = "run.m") -> Path:
    path = folder / name
    path.write_bytes(text.encode())
    return path


def same(path: Path, source: SourceOptions = SOURCE) -> tuple[str, ...]:
    """The notes of a record, which holds what was written."""
    record = read(path, source)
    np.testing.assert_allclose(record.time, 0.01 * np.arange(40), atol=1e-9)
    np.testing.assert_array_equal(record.position, COUNTS)
    np.testing.assert_array_equal(record.force, VOLTS)
    return record.notes


@pytest.mark.parametrize(
    "text",
    [
        script(),
        script().replace("\n", "\r\n"),
        script(end="]"),
        script(end="];  % the end\n\n"),
        script(begin="exp1.data = [\n"),
        script(above=f"{HEADINGS}\n"),
        script(above=f"clear all\nclose all; clc\nTs = 0.01;\n%{HEADINGS}\n% of Monday\n"),
        script(above="% Sample,Time,Encoder 1 Pos,Control Effort\n", body=rows(", ")),
        script(body=rows(end="\n")),
        script(body=rows(end=" ; % a reading\n")),
        script(body=rows(end=";\n%\n\n")),
        script(body=rows().replace(";\n", "; ", 12)),
    ],
)
@pytest.mark.parametrize("name", ["run.m", "run.txt", "run.csv"])
def test_a_script_with_a_matrix_is_read(tmp_path: Path, text: str, name: str) -> None:
    """A data row was quoted as the headings; with code behind the matrix there was 'no line of numbers'."""
    path = write(tmp_path, text, name)
    assert same(path) == ()
    names = [column.name for column in describe(path, SOURCE).topics]
    assert names == ["Sample", "Time", "Encoder 1 Pos", "Control Effort"]


def test_code_behind_the_matrix_is_left_out_with_a_note(tmp_path: Path) -> None:
    code = "\n% plots\ntime = data(:,2); %read Time\nplot(time, data(:,3), [0 1])\naxis([0 1 2 3])\n"
    path = write(tmp_path, script() + code)
    said = "line 45 and what follows are code of a MATLAB script, and left out: 'time = data(:,2); %read Time'."
    assert same(path) == (said,) and describe(path, SOURCE).notes == (said,)


def test_a_matrix_without_headings_has_numbers_for_names(tmp_path: Path) -> None:
    source = SourceOptions("4", "3", "2", force_unit="V", position_unit="count")
    for above in ("", "clear all\n", "% Monday\nTs = 0.01; x = 3; y\n"):
        assert same(write(tmp_path, script(above=above)), source) == ()
    with pytest.raises(DataError, match="has no column called time; the columns are: 1, 2, 3, 4: say which"):
        read(tmp_path / "run.m")


def test_a_script_that_is_cut_is_read_to_its_last_whole_line(tmp_path: Path) -> None:
    notes = same(write(tmp_path, script(end=";\n 40  0.40")))
    assert notes[0].startswith("the matrix data of the MATLAB script has no closing bracket: the file may have been")
    assert notes[1].startswith("line 43 was left out: the file ends in the middle of it") and len(notes) == 2


def test_lines_of_a_matrix_keep_their_numbers(tmp_path: Path) -> None:
    for end in ("];", "]", "];\nplot(data)\n"):
        with pytest.raises(
            DataError, match="run.m line 43 has 2 cells; expected 4 as in the header .Sample, Time, Enc"
        ):
            read(write(tmp_path, script(end=f";\n 40 0.40{end}")), SOURCE)
    with pytest.raises(DataError, match="run.m line 5, column Encoder 1 Pos holds 'inf'; expected a finite number"):
        read(write(tmp_path, script(body=rows().replace(f"  {COUNTS[2]:.0f}  ", "  inf  ", 1))), SOURCE)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (script() + script(above="", begin="more = ["), "script with the matrices data, more; expected one matrix"),
        (script(end="]*0.5;\n"), "script that goes on with ']*0.5;' in or behind the matrix data; expected one"),
        (script(end="]/16000"), "script that goes on with ']/16000' in or behind the matrix data; expected"),
        (script(end="]';\n"), 'script that goes on with "]\';" in or behind the matrix data; expected'),
        (script(body=rows() + "\n% [N]"), "script that goes on with '[N]];' in or behind the matrix data; expected"),
        ("t = [0 1 2 3];\nx = [4 5 6 7];\nplot(t, x)\n", "is a MATLAB script; expected one matrix with a line for"),
    ],
)
def test_other_scripts_are_refused_with_the_next_step(tmp_path: Path, text: str, found: str) -> None:
    with pytest.raises(DataError) as refused:
        read(write(tmp_path, text), SOURCE)
    line = str(refused.value)
    assert found in line and line.count("\n") == 0
    assert line.endswith("save the numbers as CSV, with a header like time_s,force_n,position_m")


def test_brackets_of_other_tables_stay() -> None:
    for text in ("Time [s],Force [N]\n0,1\n", "range = [0 10]\nt,x\n0,1\n", "t,x\n0,1\n"):
        assert without_brackets(text, "x.csv") == (text, [])
    assert is_script("x = [1 2]") and not is_script("Time [s]\n0\n")
