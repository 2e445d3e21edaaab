"""A result: what follows from its parameters has the interval that they give it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from fitrigs import DEMO, demo_record
from hypothesis import given
from hypothesis import strategies as st

from msd_ident.estimate import FitResult, fit
from msd_ident.estimate.identifiability import OpenDirection
from msd_ident.model import Plant
from msd_ident.model.effects.power_spring import PowerSpring


@cache
def found() -> FitResult:
    return fit(DEMO, demo_record(rate=250.0, encoder={"noise": 2e-5}, seed=1), search="near")


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_a_product_of_powers_has_the_relative_variance_of_its_factors(of_mass: float, of_stiffness: float) -> None:
    result = found()
    powers = np.array([of_mass, 0.0, of_stiffness, 0.0]) / result.model.values
    expected = math.sqrt(max(powers @ result.covariance @ powers, 0.0))
    told = result.derived(lambda p: p["mass"] ** of_mass * p["stiffness"] ** of_stiffness, "1")
    assert told.std / told.value == pytest.approx(expected, rel=1e-4, abs=1e-9)


def test_a_parameter_is_derived_from_itself() -> None:
    for name in DEMO.names:
        quantity, told = found().quantities[name], found().derived(lambda p, name=name: p[name], "1")
        assert told.value == quantity.value and told.std == pytest.approx(quantity.std, rel=1e-6)


@pytest.mark.parametrize(("name", "edge"), [("upper", 7.0), ("lower", 1.2)])
def test_a_value_on_its_limit_is_not_moved_beyond_it(name: str, edge: float) -> None:
    """A spring whose exponent ended at 7 was refused: "power_exponent is 7.00001 1; expected 1.2 to 7"."""
    model = Plant(1.0, 2.0, 400.0) + PowerSpring(5.0, 0.01, edge)
    record = demo_record(rate=250.0, encoder={"noise": 2e-5}, seed=1)
    result = fit(model, record, search="near", fixed=("power_exponent",))
    free = replace(result, free=(*result.free, "power_exponent"), covariance=np.diag([1e-6] * (len(result.free) + 1)))
    told = free.derived(lambda p: free.model.with_values(p)["power_exponent"], "1")
    assert told.value == edge and told.std == pytest.approx(1e-3, rel=1e-4), name


def test_what_is_fixed_adds_nothing() -> None:
    result = fit(DEMO, demo_record(rate=250.0, encoder={"noise": 2e-5}, seed=1), search="near", fixed=["mass"])
    assert result.derived(lambda p: p["mass"], "kg").std == 0.0
    ratio = result.derived(lambda p: p["stiffness"] / p["mass"], "1/s²")
    stiffness = result.quantities["stiffness"]
    assert ratio.std / ratio.value == pytest.approx(stiffness.std / stiffness.value, rel=1e-6)


def test_what_changes_along_an_open_direction_is_open() -> None:
    """Mass and stiffness with a common factor that nobody knows: their ratio is known, their product is not."""
    common = OpenDirection((("mass", DEMO["mass"]), ("stiffness", DEMO["stiffness"])), "")
    result = replace(found(), model=DEMO, open=(common,))
    values = {name: replace(q, value=DEMO[name]) for name, q in result.quantities.items()}
    result = replace(result, quantities=values)
    assert math.isfinite(result.derived(lambda p: p["stiffness"] / p["mass"], "1/s²").std)
    assert math.isfinite(result.derived(lambda p: p["damping"], "N·s/m").std)
    assert math.isnan(result.derived(lambda p: p["stiffness"] * p["mass"], "N²·s²/m²").std)


def test_correlations_are_those_of_the_covariance() -> None:
    matrix = found().correlation
    np.testing.assert_allclose(np.diag(matrix), 1.0)
    np.testing.assert_allclose(matrix, matrix.T)
    assert np.max(np.abs(matrix)) <= 1.0 + 1e-12 and np.abs(matrix[0, 2]) > 0.1
    std = np.array([found().quantities[name].std for name in found().free])
    np.testing.assert_allclose(matrix * np.outer(std, std), found().covariance, rtol=1e-9)
    assert found().samples == demo_record(rate=250.0).samples
