"""A record whose force does not move it: no number with a unit of force is stated."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from rich.console import Console

from msd_ident.cli.results import jsonable
from msd_ident.data.record import from_samples
from msd_ident.diagnosis import Diagnosis, Task, diagnose_records
from msd_ident.report.diagnosis import print_diagnosis


@pytest.fixture(scope="module")
def found() -> Diagnosis:
    """A position that follows nothing but a hand, beside a force that is noise."""
    rng = np.random.default_rng(1)
    time = np.arange(0.0, 4.0, 0.02)
    speed = np.interp(time, np.linspace(0.0, 4.0, 12), rng.normal(size=12))
    return diagnose_records(
        Task((from_samples(time, rng.normal(size=time.size), np.cumsum(speed) * 0.01),), sprung=False)
    )


def test_the_missing_force_has_no_size(found: Diagnosis) -> None:
    assert found.verdict != "explained" and all(cause.probability < 0.9 for cause in found.causes)
    assert "a missing force of unknown size" in found.summary
    assert "% of the applied force" not in found.summary
    remainder = json.loads(json.dumps(jsonable(found.to_json_dict())))["remainder"]["extended"]
    assert remainder["force_rms"] is None
    assert remainder["force_interval"] == [None, None]


def test_it_is_said_why_and_what_to_do(found: Diagnosis) -> None:
    said = [one for one in found.warnings if one.startswith("The force of this record explains none of its motion")]
    assert len(said) == 1
    assert "a hand or a position controller" in said[0]
    assert "--start" in said[0]


def test_no_mass_is_printed(found: Diagnosis) -> None:
    console = Console(width=80, file=io.StringIO(), record=True)
    print_diagnosis(found, console)
    rows = {line.split()[0]: line.split()[1:] for line in console.export_text().splitlines() if line.split()}
    assert rows["mass"][:2] == ["open", "open"]
    assert rows["damping"][:2] == ["open", "open"]
    forces = [quantity for quantity in found.extended.quantities.values() if quantity.unit in ("N", "kg", "N·s/m")]
    assert not any(quantity.known for quantity in forces if quantity.value != 0.0), "a disturbance of 5.9e+13 N"
