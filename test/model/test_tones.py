"""What a tone of the force may be: its size is bounded by what acts on the rig."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import from_samples
from msd_ident.estimate.resolution import seen
from msd_ident.model import Plant
from msd_ident.model.declarations import RecordScales
from msd_ident.model.effects.modulated_disturbance import ModulatedDisturbance
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.two_tone_disturbance import TwoToneDisturbance

SEEN = RecordScales(
    mass=2.0, stiffness=200.0, reach=0.05, span=0.1, duration=10.0, period=0.01, speed=1.0, rate=10.0, force=50.0
)


@pytest.mark.parametrize(("effect", "names"), [
    (PeriodicDisturbance, ["disturbance_amplitude"]),
    (TwoToneDisturbance, ["second_tone_amplitude"]),
    (ModulatedDisturbance, ["lower_sideband_amplitude", "upper_sideband_amplitude"]),
])  # fmt: skip
def test_a_tone_is_at_most_ten_times_the_force_that_acts_or_that_the_motion_takes(
    effect: type[PeriodicDisturbance], names: list[str]
) -> None:
    """A damper that a shaker moves was given a tone of 570 kN beside a force of 250 N: it follows any motion.

    A mass of 2 kg with an acceleration of 20 m/s² takes 40 N.
    """
    for name in names:
        assert effect.resolvable(SEEN)[name] == (0.0, 500.0)
        assert effect.resolvable(replace(SEEN, force=1.0, acceleration=20.0))[name] == (0.0, 400.0)


def test_a_fast_tone_beside_a_hundredth_of_its_force_keeps_its_size() -> None:
    """10 N at 20 Hz beside pushes of 0.05 N, of which the top speed over many samples shows nothing."""
    time = 0.005 * np.arange(3000)
    swing = 10.0 / (2.0 * np.pi * 20.0) ** 2 * np.sin(2.0 * np.pi * 20.0 * time)
    record = from_samples(time, 0.05 * np.sign(np.sin(time)), swing + 1e-3 * np.sign(np.sin(time)))
    (_, most) = PeriodicDisturbance.resolvable(seen([record], Plant(1.0, 1.0, 39.5)))["disturbance_amplitude"]
    assert 50.0 < most < 200.0
