"""A diagnosis as an object and in the JSON contract."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import replace

import pytest
from reportrigs import diagnosed, with_everything

from msd_ident.diagnosis.result import SCHEMA, quantities_dict
from msd_ident.quantity import Quantity

pytestmark = pytest.mark.xdist_group("report")


def test_the_json_says_what_the_object_says() -> None:
    found = diagnosed()
    told = json.loads(json.dumps(found.to_json_dict()))
    assert told["schema"] == SCHEMA and told["verdict"] == found.verdict and told["summary"] == found.summary
    for key, fitted in (("base", found.base), ("extended", found.extended)):
        assert told[key]["see_m"] == fitted.see
        assert {name: one["value"] for name, one in told[key]["parameters"].items()} == {
            name: quantity.value for name, quantity in fitted.quantities.items()
        }
    assert [cause["name"] for cause in told["causes"]] == told["effects"] == ["coulomb_friction"]
    assert told["causes"][0]["parameters"]["coulomb_force"]["unit"] == "N"
    assert told["gain"]["interval_percent"] == list(found.heldout.interval_percent)
    assert told["missing_force_depends_on"] == {one.signal: one.share for one in found.dependences}
    assert len(told["data"]) == len(told["initial"]) == len(found.records) == 1


def test_a_section_that_there_is_no_reason_for_is_not_there() -> None:
    plain, full = diagnosed().to_json_dict(), with_everything().to_json_dict()
    assert "calibration" not in plain and full["calibration"]["copies"] == 44
    assert plain["next_experiment"] is None and full["next_experiment"]["duration_s"] == 30.0
    assert full["causes"][0]["tied_with"] == ["stribeck_friction", "hysteresis"]
    assert full["causes"][0]["tied_probability"] >= full["causes"][0]["probability"]
    assert ("characteristics" in plain) is (diagnosed().characteristics is not None)
    assert ("ring_down" in plain) is (diagnosed().ring_down is not None)
    assert "ring_down" not in replace(diagnosed(), ring_down=None).to_json_dict()


def test_a_force_that_was_turned_is_told_by_its_sign() -> None:
    assert diagnosed().to_json_dict()["force_sign"] == 1
    assert replace(diagnosed(), turned=True).to_json_dict()["force_sign"] == -1


def test_quantities_have_value_deviation_and_unit() -> None:
    assert quantities_dict({"mass": Quantity(1.5, 0.1, "kg")}) == {"mass": {"value": 1.5, "std": 0.1, "unit": "kg"}}


def test_a_diagnosis_cannot_be_changed() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        diagnosed().verdict = "adequate"  # type: ignore[misc]
