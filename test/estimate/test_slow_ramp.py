"""A record far slower than its plant: bounds and scales must not be those of the slow motion."""

from __future__ import annotations

import pytest

from msd_ident.data.record import Record
from msd_ident.estimate import fit
from msd_ident.model import Plant
from msd_sim import api

MASS, DAMPING, STIFFNESS = 0.8, 2.1, 900.0


def test_mass_is_recovered_from_a_slow_ramp() -> None:
    made = api.simulate(
        {
            "mass": MASS, "damping": DAMPING, "stiffness": STIFFNESS, "friction_coefficient": 0.0,
            "effects": {"force_offset": {"offset_force": 1.2}}, "rate": 250.0, "seed": 1,
            "encoder": {"counts_per_metre": 0.0, "noise": 1e-5},
            "experiment": {"name": "ramp", "force": 15.0, "duration": 16.0, "rate": 250.0},
        }
    )  # fmt: skip
    record = Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)
    found = fit(Plant(1.3 * MASS, 0.7 * DAMPING, 1.3 * STIFFNESS), record)
    for name, truth in (("mass", MASS), ("damping", DAMPING), ("stiffness", STIFFNESS)):
        quantity = found.quantities[name]
        assert abs(quantity.value - truth) < 4.0 * quantity.std
    assert found.see == pytest.approx(1e-5, rel=0.1)
