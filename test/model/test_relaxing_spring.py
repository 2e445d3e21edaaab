"""A damper behind a spring: its limits, its start, and what goes beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_examples import EXAMPLES, STIFFNESS, plant, record

from msd_ident.errors import UsageError
from msd_ident.estimate import fit
from msd_ident.model import simulate
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.actuator_lag import ActuatorLag
from msd_ident.model.effects.lagging_drive_damping import LaggingDriveDamping
from msd_ident.model.effects.law import VELOCITY_LAG
from msd_ident.model.effects.relaxing_spring import RelaxingSpring
from msd_ident.model.effects.second_mode import SecondMode
from msd_sim.rig import Rig
from msd_sim.truth import Truth


def test_a_short_time_is_damping_and_a_long_one_a_spring() -> None:
    measured = record(1000.0)
    for damper, other in (
        (RelaxingSpring(2.0, 0.0), {"damping": plant().damping + 2.0}),
        (RelaxingSpring(2.0, 1e-5), {"damping": plant().damping + 2.0}),
        (RelaxingSpring(50.0 * 1e5, 1e5), {"stiffness": STIFFNESS + 50.0}),
    ):
        behind = simulate(plant() + damper, measured, 0.0, 0.1).position
        limit = simulate(plant().with_values(other), measured, 0.0, 0.1).position
        assert np.max(np.abs(behind - limit)) <= 2e-4 * np.max(np.abs(limit)), damper


def test_a_motor_on_a_voltage_moves_as_it_does_behind_a_lag() -> None:
    """L i' + R i = u - Ke v by small steps, the amplifier always on."""
    lag, brake, step = 0.03, 6.0, 1e-5
    driven = record(1000.0)
    model = plant() + RelaxingSpring(brake, lag) + ActuatorLag(lag)
    mass, damping, stiffness = (model[name] for name in ("mass", "damping", "stiffness"))
    x = v = pull = 0.0  # pull [N]: Kt i
    moved = []
    for now in driven.time:
        moved.append(x)
        commanded = float(driven.force_at(now))
        for _ in range(round(driven.period / step)):
            pull += step / lag * (commanded - brake * v - pull)
            v += step * (pull - damping * v - stiffness * x) / mass
            x += step * v
    found = simulate(model, driven, 0.0, 0.0).position
    assert np.max(np.abs(found - moved)) <= 1e-3 * np.max(np.abs(moved))


def test_a_model_has_one_second_state() -> None:
    """The kernel has room for one."""
    lagged = [effect for effect in LIBRARY if effect.structure == VELOCITY_LAG]
    assert len(lagged) > 1 and len({effect.parameters[-1] for effect in lagged}) == 1
    assert {effect.family for effect in lagged} == {SecondMode.family}
    for other in (SecondMode(0.2, 800.0), LaggingDriveDamping(2.0, 0.02)):
        with pytest.raises(UsageError, match="second state laws"):
            plant() + RelaxingSpring(4.0, 0.05) + other


@pytest.mark.parametrize("law", [RelaxingSpring, LaggingDriveDamping])
def test_it_is_found_again(law: type[RelaxingSpring] | type[LaggingDriveDamping]) -> None:
    """From a rig of other code."""
    theirs = {
        "relaxing_spring": {"creeping_spring": {"creep_stiffness": 80.0, "creep_time": 0.05}},
        "lagging_drive_damping": {"slow_brake": {"slow_brake_damping": 3.0, "slow_brake_time": 0.02}},
    }[law.name]
    time = np.arange(3000) / 500.0
    force = np.where(time < 2.0, 8.0, np.where(time < 3.5, 0.0, np.where(time < 5.0, -5.0, 0.0)))
    rig = Rig(Truth(0.9407, 3.927, 694.1, theirs), 0.0, 0.0, 0.0, "zero")
    rig.drive(time, force)
    noise = 1e-5 * np.random.default_rng(1).standard_normal(time.size)
    seen = replace(
        record(500.0), time=time, position=rig.sample(time).position + noise, force_time=time, force=force, hold="zero"
    )
    start = law.guess(seen, plant())[0]
    found = fit(plant().with_values({"mass": 1.0, "damping": 3.0}) + start, [seen]).model
    for name, value in {"mass": 0.9407, "stiffness": 694.1, **EXAMPLES[law.name]}.items():
        assert found[name] == pytest.approx(value, rel=0.02), name
