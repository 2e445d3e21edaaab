"""Numbers as people read them: digits that the interval carries, and words where there is none."""

from __future__ import annotations

import math

import pytest

from msd_ident.quantity import Quantity
from msd_ident.report import numbers


@pytest.mark.parametrize(
    ("quantity", "value", "interval"),
    [
        (Quantity(694.0977, 0.01179, "N/m"), "694.098", "694.075 … 694.121"),
        (Quantity(0.94069, 1.9e-5, "kg"), "0.940690", "0.940653 … 0.940727"),
        (Quantity(1.0, 0.0, "kg"), "1.000", "fixed"),
        (Quantity(3.2, math.nan, "N"), "3.200", "open"),
        (Quantity(math.nan, math.nan, "N"), "–", "open"),
    ],
)
def test_value_and_interval(quantity: Quantity, value: str, interval: str) -> None:
    assert numbers.value(quantity) == value
    assert numbers.interval(quantity) == interval


@pytest.mark.parametrize(
    ("quantity", "text"),
    [
        (Quantity(3.927, 0.01, "N·s/m"), "3.927 ± 0.020"),
        (Quantity(199.0, 46.0, "kg"), "199 ± 90"),
        (Quantity(230828.7, 1200.0, "N/m³"), "230829 ± 2352"),
        (Quantity(2.5e-6, 1e-7, "s"), "2.500e-06 ± 2.0e-07"),
        (Quantity(1.0, 0.0, "kg"), "1.000 (fixed)"),
    ],
)
def test_value_with_its_band(quantity: Quantity, text: str) -> None:
    assert numbers.with_band(quantity) == text


def test_lengths_are_shown_in_centimetres_and_nothing_else_is_changed() -> None:
    assert numbers.shown(Quantity(0.0144, 1e-4, "m/N")) == Quantity(1.44, 0.01, "cm/N")
    assert numbers.shown(Quantity(0.015, 1e-5, "m")).unit == "cm"
    assert numbers.shown(Quantity(5.0, 1.0, "rad/s")) == Quantity(5.0, 1.0, "rad/s")


@pytest.mark.parametrize(("value", "text"), [(0.0, "0"), (27.163, "27.16"), (9.48e-5, "9.480e-05"), (math.inf, "–")])
def test_bare_numbers_have_four_digits(value: float, text: str) -> None:
    assert numbers.number(value) == text


def test_a_value_of_0_with_a_tiny_interval_has_digits() -> None:
    """Fc 0.000000000 stood beside -0.000000000 … 0.000000000."""
    tiny = Quantity(0.0, 2.5e-13, "V")
    assert numbers.value(tiny) == "0" and numbers.interval(tiny) == "-4.900e-13 … 4.900e-13"
    assert numbers.with_band(tiny) == "0 ± 4.9e-13"
    plain = Quantity(0.0, 0.01, "V")
    assert numbers.value(plain) == "0.000" and numbers.interval(plain) == "-0.020 … 0.020"
