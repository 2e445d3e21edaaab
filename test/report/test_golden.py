"""The terminal's tables, letter by letter, 80 columns wide.

A golden file that is not there is written, and the test fails once: delete it, run, read what was written, commit.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from reportrigs import diagnosed, identified, with_everything
from rich.console import Console

from msd_ident.diagnosis import Rival
from msd_ident.quantity import Quantity
from msd_ident.report.diagnosis import print_diagnosis
from msd_ident.report.tables import print_identification

pytestmark = pytest.mark.xdist_group("report")

NAMES = ("position_dependent_friction", "force_gain_nonlinearity", "periodic_disturbance")
#: What the search comes by on its way is not what is tested here.
RIVALS = (Rival(NAMES, 0.0123, 2.345), Rival(("stribeck_friction",), 1e-9, 30.1))
GOLDEN = Path(__file__).parent / "golden"


def crowded() -> str:
    """The longest names of the library, in all places."""
    found = with_everything()
    parameters = {
        "coulomb_force": Quantity(0.123456, 0.0012, "N"),
        "position_friction_slope": Quantity(-12.3456, 0.0123, "1/m"),
    }
    cause = replace(found.causes[0], name=NAMES[0], parameters=parameters, tied_with=NAMES[1:])
    return shown(print_diagnosis, replace(found, causes=(cause,), rivals=RIVALS))


def shown(show: Callable[..., None], found: object) -> str:
    """What a terminal of 80 columns shows, without the spaces at the ends of lines."""
    console = Console(width=80, file=io.StringIO(), record=True, highlight=False)
    show(found, console)
    return "".join(f"{line.rstrip()}\n" for line in console.export_text().splitlines())


CASES = {
    "identification": lambda: shown(print_identification, identified()),
    "diagnosis": lambda: shown(print_diagnosis, replace(diagnosed(), rivals=RIVALS[1:])),
    "crowded_diagnosis": crowded,
}


@pytest.mark.parametrize("name", CASES)
def test_tables_are_as_agreed(name: str) -> None:
    text, path = CASES[name](), GOLDEN / f"{name}.txt"
    assert max(map(len, text.splitlines())) <= 80
    assert "…" not in text.replace(" … ", ""), "nothing is cut"
    if not path.exists():
        path.write_text(text, encoding="utf-8")
        pytest.fail(f"{path} was not there and is written; read it")
    assert text == path.read_text(encoding="utf-8"), f"if it is meant so, delete {path}, run again, read and commit"


def test_brackets_in_names_are_no_markup() -> None:
    found = diagnosed()
    record = replace(found.records[0], name="arm[elbow].mcap")
    text = shown(print_diagnosis, replace(found, records=(record,), warnings=("/joint_states:effort[elbow] is odd.",)))
    assert text.startswith("arm[elbow].mcap: explained") and "/joint_states:effort[elbow] is odd." in text


def test_colours_are_for_terminals_alone() -> None:
    plain, coloured = io.StringIO(), io.StringIO()
    print_diagnosis(diagnosed(), Console(file=plain, width=80))
    print_diagnosis(diagnosed(), Console(file=coloured, width=80, force_terminal=True, color_system="standard"))
    assert "\x1b[" not in plain.getvalue() and "\x1b[" in coloured.getvalue()
