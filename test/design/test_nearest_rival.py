"""Rivals moved next to the explanation that stands."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from designrigs import stepped

from msd_ident.design import hidden_effects, nearest_rival
from msd_ident.design.hidden_effects import beside
from msd_ident.design.prediction import sensing
from msd_ident.model import Model
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance

pytestmark = pytest.mark.xdist_group("bent gain")


def test_what_no_reading_holds_stays_where_it_was() -> None:
    """A disturbance too faint to see: a step in its frequency changes nothing, so none may be taken at a venture."""
    diagnosis = stepped("force_gain_nonlinearity", "gain_slope", 0.006)
    lead = diagnosis.contenders[0]
    faint = {"disturbance_amplitude": 1e-6, "disturbance_frequency": 3.5, "disturbance_phase": 2.2}
    model: Model = lead.model + PeriodicDisturbance(*faint.values())
    count = len(lead.free)
    information = np.zeros((count + 3, count + 3))
    information[:count, :count] = lead.information
    scale = np.concatenate([lead.scale, [10.0, 10.0, 1.0]])
    shaken = replace(lead, model=model, free=(*lead.free, *faint), scale=scale, information=information)
    rival = beside(replace(diagnosis, contenders=(shaken,)), CubicSpring(2e5))
    sizes = dict(zip(shaken.free, scale, strict=True))
    assert all(abs(rival.model[name] - value) < 30.0 * sizes[name] for name, value in faint.items())


def test_what_can_not_hide_is_given_up_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """A spring bent so much that no step brings it near: looked at to the end only for whoever asks for this size."""
    diagnosis = stepped("force_gain_nonlinearity", "gain_slope", 0.006)
    lead, effect = diagnosis.contenders[0], CubicSpring(-3.2e5)
    data = hidden_effects._measured(diagnosis, sensing(diagnosis.records, diagnosis.noise_floor))
    trial = hidden_effects._trial(lead, lead.model + effect, effect, data)
    looks: list[int] = []
    real = nearest_rival._linearised

    def counted(*args: object) -> object:
        looks[-1] += 1
        return real(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(nearest_rival, "_linearised", counted)
    rises, moving = [], nearest_rival.Moving(len(lead.free))
    for hopeless in (hidden_effects._HOPELESS, math.inf):
        looks.append(0)
        rises.append(nearest_rival.nearest(lead, trial, moving, data, hopeless)[1])
    assert looks[0] == nearest_rival.LOOK < looks[1]
    assert min(rises) > hidden_effects._HOPELESS
