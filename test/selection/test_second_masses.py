"""Starts for a second mass, by regressions alone."""

from __future__ import annotations

import pytest
from massrigs import swept

from msd_ident.model import Plant, simulate
from msd_ident.selection.second_masses import second_masses


def test_a_heavy_second_mass_is_begun_where_a_regression_puts_it() -> None:
    """The model without it has the sum of both masses, and from there no small change leads to two."""
    second = {"second_mass": 0.36, "second_stiffness": 3017.0, "second_damping": 1.7}
    record = swept({"second_mode": second})
    whole = Plant(1.37, 1.354, 724.4)
    residual = simulate(whole, record).position - record.position
    start = second_masses(whole, record, residual, ())[0]
    assert start.plant == pytest.approx((0.96, 1.35, 712.0), rel=0.15)
    assert start.hung[:2] == pytest.approx((0.36, 3017.0), rel=0.2)
    held = second_masses(whole, record, residual, ("mass",))
    assert held and all(one.plant[0] == whole.mass for one in held)
