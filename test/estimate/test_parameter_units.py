"""Units: exponents, yardsticks, and how a parameter's unit reads on a given rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.estimate.parameter_units import Magnitudes, exponents, unit_in
from msd_ident.model.effects import LIBRARY, by_name

TIME = np.linspace(0.0, 1.0, 50)
CART = from_samples(TIME, TIME, TIME)


def _unit(unit: str, force: str, position: str) -> str:
    record: Record = replace(CART, force_unit=force, position_unit=position)
    return unit_in(unit, record)


def test_exponents_of_a_drag_coefficient() -> None:
    assert exponents("N·s²/m²") == {"N": 1, "s": 2, "m": -2}


def test_a_kilogram_is_a_force_over_an_acceleration() -> None:
    assert exponents("kg") == exponents("N·s²/m")


@pytest.mark.parametrize("unit", sorted({p.unit for effect in LIBRARY for p in effect.parameters}))
def test_every_unit_of_the_library_scales_with_its_yardsticks(unit: str) -> None:
    power = exponents(unit)
    assert set(power) <= {"N", "m", "s", "rad"}
    size = Magnitudes(force=2.0, length=3.0, time=5.0).of(unit)
    expected = 2.0 ** power.get("N", 0) * 3.0 ** power.get("m", 0) * 5.0 ** power.get("s", 0)
    assert size == pytest.approx(expected)


@pytest.mark.parametrize(
    ("unit", "force", "position", "reads"),
    [
        ("kg", "N", "m", "kg"),
        ("kg", "N·m", "rad", "kg·m²"),
        ("N·s/m", "N·m", "rad", "N·m·s/rad"),
        ("m/N", "N·m", "rad", "rad/(N·m)"),
        ("m/N", "V", "m", "m/V"),
        ("N/m", "V", "m", "V/m"),
        ("kg", "V", "m", "V·s²/m"),
        ("N·s²/m²", "V", "count", "V·s²/count²"),
        ("s", "V", "m", "s"),
        (by_name("gravity").parameters[0].unit, "N·m", "rad", "N·m"),
    ],
)
def test_unit_on_a_rig(unit: str, force: str, position: str, reads: str) -> None:
    assert _unit(unit, force, position) == reads
