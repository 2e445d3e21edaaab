"""The shape of a saved result: what was edited into another one is refused in words of the result, not of Python."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from msd_ident.errors import DataError
from msd_ident.workflow import saved_model


def told() -> dict[str, Any]:
    """A diagnosis in the JSON contract, as far as it is read."""
    plant = {
        name: {"value": value, "std": 0.1, "unit": unit}
        for name, value, unit in (("mass", 1.0, "kg"), ("damping", 2.0, "N·s/m"), ("stiffness", 600.0, "N/m"))
    }
    return {
        "schema": "msd.diagnosis/2", "base": {"parameters": plant}, "extended": {"parameters": plant, "see_m": 1e-5},
        "causes": [], "effects": [], "rivals": [{"causes": [], "probability": 0.1}], "initial": [{"zero_m": 0.0}],
        "data": [{"force_unit": "N", "position_unit": "m"}], "read_with": {}, "missing_force_depends_on": {},
    }  # fmt: skip


def test_a_whole_result_is_read() -> None:
    assert saved_model.from_json_dict(told()).model.stiffness == 600.0


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"effects": None}, "effects is null, which is no list"),
        ({"effects": "backlash"}, 'effects is "backlash", which is no list'),
        ({"effects": [3]}, "effects[0] is 3, which is no text"),
        ({"initial": None}, "initial is null, which is no list"),
        ({"initial": [None]}, "initial[0] is null, which is no object"),
        ({"data": {}}, "data is {}, which is no list"),
        ({"data": []}, "data is an empty list, without a record"),
        ({"data": [7]}, "data[0] is 7, which is no object"),
        ({"causes": [["a"]]}, 'causes[0] is ["a"], which is no object'),
        ({"rivals": [{"causes": None, "probability": 0.1}]}, "rivals[0].causes is null, which is no list"),
        ({"read_with": None}, "read_with is null, which is no object"),
        ({"missing_force_depends_on": [0.5]}, "missing_force_depends_on is [0.5], which is no object"),
        ({"extended": None}, "extended is null, which is no object"),
        ({"extended": {"parameters": [], "see_m": 1.0}}, "extended.parameters is [], which is no object"),
        ({"extended": {"parameters": {"mass": 1}}}, "extended.parameters.mass is 1, which is no object"),
        ({"base": {"parameters": {"mass": None}}}, "base.parameters.mass is null, which is no object"),
        ({"known": "m" * 100}, 'known is "' + "m" * 39 + "…, which is no list"),
    ],
)
def test_another_shape_is_refused_in_words(changed: dict[str, Any], says: str) -> None:
    with pytest.raises(DataError) as refused:
        saved_model.from_json_dict({**told(), **changed}, "model.json")
    assert str(refused.value) == (
        f"model.json lacks what a simulation needs ({says}); expected all keys of msd.diagnosis/2: renew it with msd "
        "diagnose PATH --json FILE"
    )


def test_an_empty_list_is_not_called_an_empty_file(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text(json.dumps([]))
    with pytest.raises(DataError, match=r"model.json holds an empty list; expected a result that msd identify"):
        saved_model.load(path)
    path.write_text(" \n")
    with pytest.raises(DataError, match=r"model.json is empty; expected a result that msd identify"):
        saved_model.load(path)
