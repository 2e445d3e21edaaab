"""``msd validate --simulated``: in which units the file is read, what is doubted, and what is refused."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import effect_examples
import numpy as np
import pytest
from badinputs import run
from exportrigs import measured, pushes

from msd_ident.cli.user_simulation import table
from msd_ident.errors import DataError
from msd_ident.external import TableSimulation
from msd_ident.io import SourceOptions

ASKED = ("coulomb_friction", "quadratic_drag", "cubic_spring")


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a record in mm whose headings name no unit, and a simulation of it in the same numbers."""
    folder = tmp_path_factory.mktemp("simulated")
    record = measured(effect_examples.model("coulomb_friction"), pushes(3.0))
    rows = np.column_stack([record.time, record.force_at(record.time), 1e3 * record.position])
    np.savetxt(folder / "rig.csv", rows, delimiter=",", header="time,force,position", comments="", fmt="%.9g")
    write(folder / "theirs.csv", "time,position", rows[:, [0, 2]] * [1.0, 0.95])
    return folder


def write(path: Path, header: str, rows: np.ndarray) -> Path:
    """A file of columns."""
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.9g")
    return path


@pytest.mark.parametrize("options", [("--position-unit", "mm"), ("--position-scale", "0.001")])
@pytest.mark.xdist_group("simulated")
def test_a_file_without_units_has_those_of_the_record(
    options: tuple[str, str], rig: Path, asking_about: Callable[..., None]
) -> None:
    asking_about(*ASKED)
    found = run("validate", rig / "rig.csv", *options, "--simulated", rig / "theirs.csv", "--json", "-")
    assert found.code == 0, found.err
    told = json.loads(found.out)
    assert 99.0 < told["explained_percent"] < 99.9
    assert not any("factor of 1000" in said for said in told["warnings"])


@pytest.mark.xdist_group("simulated")
def test_positions_a_thousand_times_smaller_are_doubted(
    rig: Path, tmp_path: Path, asking_about: Callable[..., None]
) -> None:
    asking_about(*ASKED)
    small = np.loadtxt(rig / "theirs.csv", delimiter=",", skiprows=1) * [1.0, 1e-3]
    theirs = write(tmp_path / "theirs.csv", "time,position", small)
    whole = ("validate", rig / "rig.csv", "--position-unit", "mm", "--json", "-", "--simulated")
    told = json.loads(run(*whole, theirs).out)
    (said,) = (said for said in told["warnings"] if "factor of 1000" in said)
    assert said.startswith(f"The positions of {theirs} span ") and "those of rig.csv 0.0" in said
    assert "is a unit wrong by a factor of 1000? Name the unit in the heading of each file, such as position_mm" in said
    named = json.loads(run(*whole, write(theirs, "time,position_m", small)).out)
    assert named["explained_percent"] > 99.0 and not any("factor of 1000" in said for said in named["warnings"])


@pytest.mark.parametrize(
    ("header", "options", "factor"),
    [
        ("time,position", SourceOptions(), 1.0),
        ("time,position", SourceOptions(position_unit="mm"), 1e-3),
        ("time,position", SourceOptions(position_scale=2e-3), 2e-3),
        ("time,position", SourceOptions(position_scale=-2.0, position_unit="mm"), -2e-3),
        ("time,position", SourceOptions(position_unit="deg"), np.pi / 180.0),
        ("time,position_m", SourceOptions(position_unit="mm"), 1.0),
        ("time,position_m", SourceOptions(position_scale=2e-3), 1.0),
        ("time,position_mm", SourceOptions(position_scale=1e-6, position_unit="m"), 1e-3),
        ("time,position [mm]", SourceOptions(position_unit="mm"), 1e-3),
        ("time,position_deg", SourceOptions(position_unit="rad"), np.pi / 180.0),
        ("time,position_counts", SourceOptions(position_scale=1e-5), 1e-5),
        ("time,x", SourceOptions(position="x", position_unit="mm"), 1e-3),
        ("time,x_mm", SourceOptions(position="x_mm", position_scale=1e-3), 1e-3),
        ("time,position", SourceOptions(position="x", force="u", position_unit="mm"), 1e-3),
    ],
)
def test_a_unit_in_the_heading_counts_and_else_the_options_do(
    header: str, options: SourceOptions, factor: float, tmp_path: Path
) -> None:
    time = np.arange(100) * 1e-2
    position = np.sin(7.0 * time)
    made = table(write(tmp_path / "theirs.csv", header, np.column_stack([time, position])), options)
    assert isinstance(made, TableSimulation)
    np.testing.assert_allclose(made.position, factor * position, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize(
    ("header", "scale", "factor"), [("time,position", 0.5, 0.5), ("time_s,position", 0.5, 1.0), ("t,position", None, 1)]
)
def test_so_does_the_time(header: str, scale: float | None, factor: float, tmp_path: Path) -> None:
    time = np.arange(100) * 1e-2
    theirs = write(tmp_path / "theirs.csv", header, np.column_stack([time, np.sin(7.0 * time)]))
    made = table(theirs, SourceOptions(time_scale=scale))
    assert isinstance(made, TableSimulation)
    np.testing.assert_allclose(made.time, factor * time, rtol=1e-8, atol=1e-12)


@pytest.mark.xdist_group("simulated")
def test_a_heading_in_another_unit_is_refused(rig: Path, tmp_path: Path) -> None:
    rows = np.loadtxt(rig / "theirs.csv", delimiter=",", skiprows=1)
    theirs = write(tmp_path / "angle.csv", "time_s,angle_rad", rows)
    found = run("validate", rig / "rig.csv", "--position-unit", "mm", "--simulated", theirs)
    assert found.code == 2 and found.err.count("\n") == 1
    assert "angle.csv is in rad, and" in found.err and "rig.csv in m; expected one unit: name" in found.err


def test_a_file_without_positions_is_refused(tmp_path: Path) -> None:
    time = np.arange(100) * 1e-2
    theirs = write(tmp_path / "theirs.csv", "time,height", np.column_stack([time, time]))
    with pytest.raises(DataError, match="theirs.csv has no column .*position"):
        table(theirs, SourceOptions(position_unit="mm"))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--require", "101"), "the required part is 101 %; expected 0 to 100, e.g. --require 99"),
        (("--require", "nan"), "the required part is nan %; expected 0 to 100, e.g. --require 99"),
        (("--joint", "foo"), "--joint foo without --mujoco; expected a MuJoCo model that has the joint: leave --joint"),
    ],
)
@pytest.mark.xdist_group("simulated")
def test_options_that_make_no_sense_are_refused(options: tuple[str, str], words: str, rig: Path) -> None:
    found = run("validate", rig / "rig.csv", "--simulated", rig / "theirs.csv", *options)
    assert found.code == 2 and words in found.err and found.err.count("\n") == 1
