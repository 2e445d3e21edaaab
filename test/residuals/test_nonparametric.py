"""Characteristic curves: the law of a spring and of a damper, without assuming one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from fitrigs import measured

from msd_ident.data.record import Record
from msd_ident.estimate import Initial
from msd_ident.model import Model, Plant
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.residuals.noise_model import prepare
from msd_ident.residuals.nonparametric import Characteristics, measure

PLANT = Plant(1.0, 4.0, 600.0)
BENT = PLANT + CubicSpring(5e5) + QuadraticDrag(6.0)


def record(model: Model, seed: int = 1, force: float = 8.0) -> Record:
    encoder = {"counts_per_metre": 0.0, "noise": 1e-5}
    return measured(model, {"name": "steps", "force": force, "hold": 0.6}, rate=250.0, encoder=encoder, seed=seed)


def curves(records: Sequence[Record], initial: Sequence[Initial] = ()) -> Characteristics:
    """From the linear plant."""
    found = measure(prepare(records), PLANT, initial or [Initial()] * len(records), 1e-4)
    assert found is not None
    return found


def test_curves_that_leave_more_than_the_base_model_measure_nothing() -> None:
    """A damping of 456 A at 0.27 rad/s was published, with an error 5.4 times that of the base model."""
    readings, begun = prepare([record(BENT)]), [Initial()]
    assert measure(readings, PLANT, begun, 1e-6) is None and measure(readings, PLANT, begun, 1e-3) is not None


def test_a_bent_spring_and_a_drag_are_measured() -> None:
    found = curves([record(BENT)])
    x, v = found.spring.over, found.damper.over
    spring, damper = 600.0 * x + 5e5 * x**3, 4.0 * v + 6.0 * v * np.abs(v)
    assert np.max(np.abs(found.spring.force - spring)) < 0.05 * np.max(np.abs(spring))
    assert np.max(np.abs(found.damper.force - damper)) < 0.1 * np.max(np.abs(damper))
    assert found.mass == pytest.approx(1.0, rel=0.02)
    straight = 600.0 * x
    assert np.max(np.abs(straight - spring)) > 0.1 * np.max(np.abs(spring)), "more than the curve is off by"
    assert found.see_reduction_percent == pytest.approx(100.0 * (1.0 - found.see / 1e-4))


def test_a_linear_plant_has_straight_curves_within_their_bands() -> None:
    found = curves([record(PLANT)])
    assert found.see == pytest.approx(1e-5, rel=0.15)
    for curve, slope in ((found.spring, 600.0), (found.damper, 4.0)):
        off = np.abs(curve.force - slope * curve.over)
        assert np.all(off < 4.0 * curve.std + 1e-3 * np.max(np.abs(curve.force)))


def test_the_json_holds_plain_lists() -> None:
    found = curves([record(PLANT)])
    told = found.to_json_dict()
    assert told["spring_force_over_position"]["force"] == list(found.spring.force)
    assert told["damping_force_over_velocity"]["over"] == list(found.damper.over)
    assert (told["mass"], told["see_m"]) == (found.mass, found.see)


def test_records_with_zeros_of_their_own_share_one_spring() -> None:
    """An encoder that counts from where it was switched on."""
    first, second = record(BENT), record(BENT, seed=2, force=5.0)
    together = curves([first, second])
    moved = replace(second, position=second.position + 0.01)
    apart = curves([first, moved], (Initial(), Initial(zero=0.01)))
    assert apart.see == pytest.approx(together.see, rel=1e-3)
    np.testing.assert_allclose(apart.spring.force, together.spring.force, atol=0.01)
