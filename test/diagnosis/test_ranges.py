"""Ranges over the explanations that fit alike: about the stated model, of the parameters that are fitted."""

from __future__ import annotations

import io
import math
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from reportrigs import diagnosed
from rich.console import Console

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis, Task, diagnose_records, ranges
from msd_ident.estimate.base_fits import Shared
from msd_ident.report import diagnosis
from msd_ident.selection.hypothesis import Hypothesis
from msd_sim.api import simulate

ASKED = ("coulomb_friction", "stribeck_friction", "quadratic_drag", "cubic_spring", "bilinear_spring")
STEP = {"name": "step", "force": 6.0, "hold": 2.0}
RELEASE = {"name": "release", "position": 0.02, "duration": 3.0}


def unlike_the_library(seed: int, experiment: dict[str, object]) -> Diagnosis:
    """A plant by lot whose spring bends as none of the laws asked about does: every set leaves more than noise."""
    rng = np.random.default_rng(seed)
    rig = {
        "mass": 1.0, "damping": rng.uniform(1.0, 3.0), "stiffness": rng.uniform(400.0, 800.0), "rate": 250.0,
        "friction_coefficient": 0.0, "encoder": {"counts_per_metre": 1e5, "noise": 0.0}, "seed": seed,
        "effects": {"asymmetric_spring": {"quadratic_stiffness": 1.2e4}, "coulomb_friction": {"coulomb_force": 0.2}},
    }  # fmt: skip
    made = simulate({**rig, "experiment": experiment})
    return diagnose_records(Task((Record(made.time, made.position, made.force_time, made.force),)))


@pytest.mark.usefixtures("without_copies")
@pytest.mark.parametrize("experiment", [STEP, RELEASE], ids=["step", "release"])
@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2, 3))])
def test_each_range_has_the_stated_models_value(
    seed: int, experiment: dict[str, object], asking_about: Callable[..., None]
) -> None:
    """They were those of the search's fits alone, the stated model is the refit to the least simulation error."""
    asking_about(*ASKED)
    found = unlike_the_library(seed, experiment)
    assert found.verdict == "ambiguous" and found.adequacy.ratio > 1.5
    for name, (low, high) in found.spread.items():
        quantity = found.extended.quantities[name]
        assert low <= quantity.value <= high, name
        assert quantity.std != 0.0 and f"{low:.4g}" != f"{high:.4g}", f"{name}: nothing moves"


def test_what_the_data_leaves_open_has_no_range() -> None:
    """A motor axis under a single tone was printed with a mass a hundred times too large, as a range of 12 %."""
    stated = diagnosed().extended
    other = cast(Hypothesis, SimpleNamespace(model=stated.model.with_values({"mass": 1.5, "damping": 9.0})))
    found = ranges.over(stated, [other], True, cast(Shared, None))
    assert set(found) == {"mass", "damping"}
    quantity = replace(stated.quantities["mass"], std=math.nan)
    opened = replace(stated, quantities={**stated.quantities, "mass": quantity})
    assert set(ranges.over(opened, [other], True, cast(Shared, None))) == {"damping"}


def test_an_interval_that_holds_the_range_stays_in_its_place() -> None:
    found = diagnosed()
    mass = found.extended.quantities["mass"]
    inside = (mass.value, mass.value + 0.5 * mass.std)
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(diagnosis.models_table(replace(found, spread={"mass": inside})))
    text = console.export_text()
    assert " to " not in text and "ranges" not in text
