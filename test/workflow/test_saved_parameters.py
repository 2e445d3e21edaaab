"""Parameters of a saved result: each is simulated, in its own unit; what was edited otherwise is refused."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from badinputs import run

from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError
from msd_ident.estimate.parameter_units import unit_in
from msd_ident.model import Model, Plant
from msd_ident.model.effects import LIBRARY
from msd_ident.workflow import saved_model

RIG = Plant(mass=1.0, damping=2.0, stiffness=600.0)
#: Units that rigs have.
RIGS = [("N", "m"), ("N·m", "rad"), ("V", "m"), ("A", "rad"), ("V", "count"), ("N", "count"), ("V", "V"), ("%", "m")]


def rig(force: str, position: str) -> Record:
    """A record in these units."""
    time = np.arange(50) * 1e-2
    return replace(from_samples(time, 0.0 * time, 0.0 * time), force_unit=force, position_unit=position)


def result(model: Model, units: tuple[str, str] = ("N", "m")) -> dict[str, Any]:
    """An identification in the JSON contract, with µ, as far as it is read."""
    made = rig(*units)
    parameters: dict[str, Any] = {
        p.name: {"value": v if np.isfinite(v) else None, "std": 0.1, "unit": unit_in(p.unit, made)}
        for p, v in zip(model.parameters, model.values.tolist(), strict=True)
    }
    parameters["friction_coefficient"] = {"value": 0.02, "std": 0.001, "unit": "1"}
    return {
        "schema": "msd.identification/1", "path": "own.csv", "effects": list(model.effect_names),
        "refined": {"parameters": parameters, "see_m": 1e-5},
        "data": [{"force_unit": units[0], "position_unit": units[1]}], "initial": [{"zero_m": 0.0}],
    }  # fmt: skip


def edited(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """A result with some of its parameters edited."""
    told = result(RIG)
    for name, quantity in parameters.items():
        told["refined"]["parameters"][name] = {**told["refined"]["parameters"].get(name, {}), **quantity}
    return told


@pytest.mark.parametrize("effect", LIBRARY, ids=lambda effect: effect.name)
def test_results_of_every_effect_on_every_rig_are_read(effect: Any) -> None:
    inside = {p.name: min(max(1.5, p.lower), p.upper) for p in effect.parameters}
    unlimited = {name: value for name, value in effect.neutral if value == np.inf}
    model = RIG + effect.from_values({**inside, **unlimited})
    for units in RIGS:
        np.testing.assert_array_equal(saved_model.from_json_dict(result(model, units)).model.values, model.values)


@pytest.mark.parametrize("unit", ["N·s²/m", "kg"])
def test_a_unit_may_be_written_in_another_way(unit: str) -> None:
    told = edited({"mass": {"unit": unit}})
    assert saved_model.from_json_dict(told).model.mass == 1.0


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"mass": {"value": 1000.0, "unit": "g"}}, "mass is in g; expected kg, with forces in N and positions in m"),
        ({"stiffness": {"unit": "N/mm"}}, "stiffness is in N/mm; expected N/m, with forces in N"),
        ({"damping": {"unit": ""}}, "damping is in no unit; expected N·s/m, with forces in N"),
        ({"friction_coefficient": {"unit": "%"}}, "friction_coefficient is in %; expected 1, with forces"),
        (
            {"cubic_stiffness": {"value": 1e6, "std": 1.0, "unit": "N/m³"}},
            "cubic_stiffness is a parameter of no effect of the model; expected mass, damping, stiffness: remove it, "
            "or name its effect in effects",
        ),
        ({"masss": {"value": 1.0, "std": 1.0, "unit": "kg"}}, "masss is a parameter of no effect of the model"),
    ],
)
def test_what_would_not_be_simulated_as_it_stands_is_refused(
    parameters: Mapping[str, Any], words: str, tmp_path: Path
) -> None:
    path = tmp_path / "model.json"
    path.write_text(json.dumps(edited(parameters)), encoding="utf-8")
    with pytest.raises(DataError) as refused:
        saved_model.load(path)
    assert f"{path}: {words}" in str(refused.value) and "or renew it with msd identify" in str(refused.value)
    found = run("validate", path, tmp_path / "other.csv")
    assert found.code == 2 and words in found.err and found.err.count("\n") == 1


def test_the_unit_is_that_of_the_results_own_rig() -> None:
    told = result(RIG, ("V", "count"))
    told["refined"]["parameters"]["mass"]["unit"] = "V·s²/m"
    with pytest.raises(DataError, match="mass is in V·s²/m; expected V·s²/count, with forces in V and positions in co"):
        saved_model.from_json_dict(told)
