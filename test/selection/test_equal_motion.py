"""Dry friction and the dead zone of an actuator: one motion where nothing stores energy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lsim
from setrigs import BASE, fitted, steps

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Effect
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.fading_damping import FadingDamping
from msd_ident.model.effects.typical import speed
from msd_ident.selection.equal_motion import equal_motion
from msd_ident.selection.evidence import NoiseScale
from msd_ident.workflow import pipeline
from msd_sim import api

DAMPING, LARGEST, TIME = 5.0, 10.0, np.arange(1200) / 200.0


def behind_dead_zone(mass: float) -> Record:
    """A slider without a spring in steps of a command, of which a valve lets pass what exceeds 1.5 N."""
    levels = LARGEST * np.array([0.0, 0.5, -0.3, 1.0, -0.7, 0.2, -1.0, 0.6, 0.1, -0.4, 0.8, -0.9])
    command = levels[np.minimum((TIME / 0.5).astype(int), levels.size - 1)]
    force = np.sign(command) * np.maximum(np.abs(command) - 1.5, 0.0)
    _, moved, _ = lsim(([[0.0, 1.0], [0.0, -DAMPING / mass]], [[0.0], [1.0 / mass]], [[1.0, 0.0]], 0.0), force, TIME,
                       interp=False)  # fmt: skip
    noise = np.random.default_rng(4).normal(0.0, 1e-5, TIME.size)
    return from_samples(TIME, command, moved + noise)


def rubbing(mass: float) -> Record:
    """The same slider with 1.5 N of dry friction in place of the valve."""
    made = api.simulate(
        {"mass": mass, "damping": DAMPING, "stiffness": 0.0, "rate": 200.0, "seed": 4, "friction_coefficient": 0.0,
         "effects": {"coulomb_friction": {"coulomb_force": 1.5}}, "encoder": {"counts_per_metre": 1e6, "noise": 1e-5},
         "experiment": {"name": "steps", "force": LARGEST, "hold": 0.5}}
    )  # fmt: skip
    return Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)


@pytest.mark.parametrize("slider", [behind_dead_zone, rubbing])
def test_without_inertia_friction_is_tied_to_a_dead_zone(
    slider: Callable[[float], Record], asking_about: Callable[..., None]
) -> None:
    asking_about("coulomb_friction", "force_dead_zone", "quadratic_drag")
    (cause,) = pipeline.diagnose([slider(2e-4)], pipeline.Options(model="no_spring")).causes
    assert {cause.name, *cause.tied_with} == {"coulomb_friction", "force_dead_zone"}
    assert cause.probability <= 0.5 and cause.tied_probability > 0.9


@pytest.mark.parametrize(
    ("slider", "name"),
    [(behind_dead_zone, "force_dead_zone"), (rubbing, "coulomb_friction")],
    ids=["valve", "friction"],
)
def test_inertia_tells_friction_from_a_dead_zone(
    slider: Callable[[float], Record], name: str, asking_about: Callable[..., None]
) -> None:
    asking_about("coulomb_friction", "force_dead_zone", "quadratic_drag")
    (cause,) = pipeline.diagnose([slider(1.0)], pipeline.Options(model="no_spring")).causes
    assert (cause.name, cause.tied_with) == (name, ()) and cause.probability > 0.9


@pytest.mark.parametrize(
    ("beside", "other"),
    [(None, None), (CoulombFriction(0.1), "stribeck_friction"), (CubicSpring(1e6), None)],
    ids=["alone", "beside friction", "beside a spring"],
)
def test_a_damping_that_has_faded_may_be_friction_where_another_curve_over_the_speed_is_beside_it(
    beside: Effect | None, other: str | None
) -> None:
    """Two curves over the speed come near any third, so what they leave does not show the form of either.

    Friction that creeps in another way was fading damping with 0.997 beside Coulomb friction.
    """
    data = steps()
    top = max(speed(record) for record in data.records)
    model = BASE + FadingDamping(3.0, 0.2 * top, 1.3)
    one = fitted(data, model if beside is None else model + beside, data.evidence)
    found = equal_motion(one, {one.causes: one}, data, NoiseScale(noise=data.evidence))
    assert found.get("fading_damping") == other
