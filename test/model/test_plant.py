"""Model: values in and out, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from effect_examples import model, plant

from msd_ident.errors import UsageError
from msd_ident.model import Plant
from msd_ident.model.effects import by_name


def test_names_values_and_parameters_go_together() -> None:
    whole = model("stribeck_friction", "force_offset")
    assert whole.names == (
        "mass", "damping", "stiffness", "offset_force", "coulomb_force", "static_force", "stribeck_velocity",
    )  # fmt: skip
    assert [whole[name] for name in whole.names] == whole.values.tolist()
    assert [p.unit for p in whole.parameters][:3] == ["kg", "N·s/m", "N/m"]
    assert whole.has("force_offset") and not whole.has("backlash")


def test_with_values_by_name_and_in_order() -> None:
    whole = model("force_offset")
    changed = whole.with_values({"offset_force": 2.0, "mass": 3.0})
    assert (changed["offset_force"], changed["mass"], changed["damping"]) == (2.0, 3.0, whole["damping"])
    assert whole.with_values(changed.values) == changed
    assert whole["offset_force"] == 0.5
    with pytest.raises(UsageError, match="the model has no parameter 'gap'; expected one of mass, damping"):
        whole.with_values({"gap": 1.0})
    with pytest.raises(UsageError, match="3 values for 4 parameters"):
        whole.with_values(np.ones(3))


def test_without_and_effect() -> None:
    whole = model("force_offset", "cogging")
    assert whole.without("cogging") == model("force_offset")
    assert whole.effect("cogging").name == "cogging"
    with pytest.raises(UsageError, match="the model has no effect 'backlash'; it has cogging, force_offset"):
        whole.effect("backlash")
    with pytest.raises(UsageError, match="the model has no parameter 'gap'"):
        whole["gap"]


@pytest.mark.parametrize(
    ("mass", "damping", "stiffness", "words"),
    [
        (0.0, 1.0, 1.0, "plant: mass is 0 kg; expected a finite value above 0"),
        (1.0, -1.0, 1.0, "plant: damping is -1 N·s/m; expected a finite value from 0"),
        (1.0, 1.0, math.nan, "plant: stiffness is nan N/m; expected a finite value from 0"),
        (math.inf, 1.0, 1.0, "plant: mass is inf kg"),
    ],
)
def test_impossible_plants_are_refused_in_words(mass: float, damping: float, stiffness: float, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        Plant(mass, damping, stiffness)


def test_unknown_effects_are_refused_with_the_list() -> None:
    with pytest.raises(UsageError, match="no effect is called 'magic'; expected one of actuator_lag, "):
        by_name("magic")


def test_models_are_frozen_and_comparable() -> None:
    assert plant() == plant() and hash(model("cogging")) == hash(model("cogging"))
    with pytest.raises(AttributeError):
        plant().mass = 2.0  # type: ignore[misc]
