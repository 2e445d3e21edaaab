"""Bouc and Wen's law where it must be Dahl's."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.model import Plant, Simulator
from msd_ident.model.effects.bouc_wen import BoucWen
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.hysteresis import Hysteresis


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("length", [0.002, 0.02])
def test_with_equal_rates_it_is_dahls_law_at_rest_too(friction: float, length: float) -> None:
    """Friction stops the cart again and again; what the hysteretic spring holds then decides where it goes on."""
    time = np.arange(0.0, 6.0, 0.002)
    force = 2.0 * np.sin(2.1 * time) + 0.4 * np.sin(17.0 * time)
    record = Record(time=time, position=np.zeros(time.size), force=force, force_time=time)
    plant, size = Plant(0.9, 1.0, 90.0), 0.6
    dahl = plant + Hysteresis(size, length)
    same = plant + BoucWen(size / length, 1.0 / length, 1.0 / length)
    if friction:
        dahl, same = dahl + CoulombFriction(friction), same + CoulombFriction(friction)
    expected = Simulator(dahl, record).positions(dahl.values)
    found = Simulator(same, record).positions(same.values)
    assert np.max(np.abs(found - expected)) < 2e-6 * np.ptp(expected)
