"""Equations 3 to 13 give the paper's Tables 2 and 3 from its Table 1."""

from __future__ import annotations

import math

import pytest

from msd_ident.features import equations as eq


def test_tables_2_and_3_follow_from_table_1() -> None:
    decrement = eq.logarithmic_decrement(2.554, 2.150, 1.502)
    ratio = eq.damping_ratio(decrement)
    frequency = eq.natural_frequency(eq.damped_frequency(eq.damped_period(0.1120, 0.3440)), ratio)
    force = eq.step_force(0.15, 69.5)
    gain = eq.static_gain(1.502e-2, force)
    stiffness = eq.stiffness(gain)
    assert ratio == pytest.approx(0.0769, abs=5e-5)
    assert frequency == pytest.approx(27.16, abs=5e-3)
    assert force == pytest.approx(10.43, abs=6e-3)
    assert gain * 100 == pytest.approx(0.1441, abs=5e-5)
    assert eq.mass(stiffness, frequency) == pytest.approx(0.9407, abs=5e-5)
    assert eq.damping(stiffness, frequency, ratio) == pytest.approx(3.927, abs=3e-3)
    assert stiffness == pytest.approx(694.1, abs=0.05)


@pytest.mark.parametrize("ratio", [0.001, 0.0769, 0.3, 0.9])
def test_decrement_of_a_known_damping_ratio_gives_it_back(ratio: float) -> None:
    decrement = 2.0 * math.pi * ratio / math.sqrt(1.0 - ratio**2)
    first, second = 1.0 + math.exp(0.0), 1.0 + math.exp(-decrement)
    assert eq.damping_ratio(eq.logarithmic_decrement(first, second, 1.0)) == pytest.approx(ratio, rel=1e-12)
