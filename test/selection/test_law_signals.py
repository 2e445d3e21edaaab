"""What laws do along a measured motion: the equation of motion holds with their forces in it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from effect_examples import DAMPING, EXAMPLES, MASS, STIFFNESS, model, record

from msd_ident.model import simulate
from msd_ident.model.effects import by_name
from msd_ident.selection.law_signals import Motion

#: Effects of which a motion alone does not tell the force: it depends on more than place, speed, time and command.
HIDDEN = {
    "bouc_wen", "buffered_stop", "constraint_stop", "drive_hysteresis", "hysteresis", "lagging_drive_damping",
    "position_dependent_inertia", "relaxing_spring", "rubbing_second_mode",
}  # fmt: skip


def motion_of(name: str) -> tuple[Motion, np.ndarray]:
    """A simulated motion of a rig with one effect, and its readings."""
    given = record(rate=4000.0)
    made = simulate(model(name), given, 0.004, 0.05)
    without = simulate(model(), given, 0.004, 0.05)
    reads = by_name(name).acts_on == "sensor"
    position = without.position if reads else made.position
    time = made.time - made.time[0]
    return Motion(time, position, made.velocity, np.sign(made.velocity), made.force, STIFFNESS), made.position


def test_which_laws_a_motion_tells() -> None:
    motion, _ = motion_of("cubic_spring")
    assert {name for name in EXAMPLES if not motion.can_tell(by_name(name))} == HIDDEN


@pytest.mark.parametrize("name", sorted(set(EXAMPLES) - HIDDEN))
def test_the_equation_of_motion_holds(name: str) -> None:
    """m·x'' + b·x' + k·x + what the law adds is the commanded force, but for where it jumps or the cart stands."""
    motion, readings = motion_of(name)
    effect = by_name(name).from_values(EXAMPLES[name])
    error = motion.error_of(effect)
    if error is not None:
        assert readings == pytest.approx(motion.position + error, abs=1e-9)
        assert not np.any(motion.force_of(effect))
        return
    inertia = MASS * np.gradient(motion.velocity, motion.time)
    left = inertia + DAMPING * motion.velocity + STIFFNESS * motion.position + motion.force_of(effect) - motion.force
    missing = inertia + DAMPING * motion.velocity + STIFFNESS * motion.position - motion.force
    moving = np.abs(motion.velocity) > 0.05 * np.max(np.abs(motion.velocity))
    taken = np.sum(np.abs(left[moving])) / np.sum(np.abs(missing[moving]))
    assert taken < 0.1, "the law takes the missing force away"


def test_a_law_that_python_cannot_evaluate_is_no_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python raises where compiled code goes on with infinities."""
    motion, _ = motion_of("cubic_spring")
    spring = by_name("cubic_spring")
    monkeypatch.setattr(spring, "force", staticmethod(lambda x, cubic_stiffness: math.exp(cubic_stiffness) * x))
    assert not np.any(np.isfinite(motion.force_of(spring(1e5))))
