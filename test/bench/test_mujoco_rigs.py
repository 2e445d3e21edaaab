"""MuJoCo's rigs against closed forms, and what a draw promises."""

from __future__ import annotations

import ast
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.mujoco_rigs import simulate
from bench.mujoco_rigs.rig import EXPERIMENTS, FAULTS, Limit, Rig, draw

PLAIN = Rig(
    seed=1, faults=(), mass=0.8, armature=0.3, damping=1.2, stiffness=420.0, gain=2.0, frictionloss=0.0, lag=0.0,
    saturation=math.inf, dead_zone=0.0, limit=None, experiment="step", start=0.0, commands=(2.0,) * 1000, rate=1000.0,
    noise=0.0, count=1e-6,
)  # fmt: skip


def rings(rig: Rig, time: np.ndarray, force: float, start: float = 0.0) -> np.ndarray:
    """Position of a linear rig that begins at rest [m]."""
    inertia = rig.mass + rig.armature
    decay, omega = rig.damping / (2.0 * inertia), math.sqrt(rig.stiffness / inertia)
    turn, end = math.sqrt(omega**2 - decay**2), force / rig.stiffness
    swing = np.cos(turn * time) + decay / turn * np.sin(turn * time)
    return end + (start - end) * np.exp(-decay * time) * swing


def test_a_rig_without_faults_is_the_linear_one() -> None:
    time = np.arange(1000) / 1000.0
    assert simulate.positions(PLAIN) == pytest.approx(rings(PLAIN, time, 4.0), abs=1e-12)
    assert PLAIN.plant == {"mass": pytest.approx(0.55), "damping": 0.6, "stiffness": 210.0}


def test_frictionloss_is_dry_friction() -> None:
    """Between two turns it is a constant force: each swing is shorter by 2 Fc/k both ways, and at last it stands."""
    undamped = replace(PLAIN, damping=0.0, frictionloss=0.5, start=0.01, commands=(0.0,) * 1200, noise=5e-6, count=0.0)
    found = simulate.positions(undamped)
    turn, shift = math.sqrt(420.0 / 1.1), 0.5 / 420.0
    half = math.pi / turn
    for swing in range(3):
        at = round(half * (swing + 1) * 1000)
        peak = (0.01 - 2.0 * shift * (swing + 1)) * (-1) ** (swing + 1)
        assert found[at] == pytest.approx(peak, abs=2e-6)
    assert np.ptp(found[-300:]) < 1e-6 and abs(found[-1]) < shift


def test_a_limit_with_a_small_impedance_is_a_spring_on_one_side() -> None:
    """A rig pressed into it stands where both springs carry the force; MuJoCo's k counts per mass without armature."""
    limit = Limit(-1.0, 0.005, 2000.0, 80.0, (1e-4, 1e-4), 0.001)
    pressed = replace(PLAIN, damping=20.0, limit=limit, commands=(2.0,) * 1000)
    place = simulate.stepped(pressed, 40)[-1]
    assert 420.0 * place + 0.8 * 2000.0 * (place - 0.005) == pytest.approx(4.0, rel=1e-3)


def test_lag_saturation_and_dead_zone_are_what_they_say() -> None:
    time = np.arange(1000) / 1000.0
    slow = simulate.positions(replace(PLAIN, lag=0.05, stiffness=0.0, damping=0.0))
    push = 4.0 / 1.1
    assert slow[-1] == pytest.approx(push * (time[-1] ** 2 / 2 - 0.05 * time[-1] + 0.05**2), rel=1e-3)
    assert simulate.positions(replace(PLAIN, saturation=1.5)) == pytest.approx(rings(PLAIN, time, 3.0), abs=1e-12)
    assert simulate.positions(replace(PLAIN, dead_zone=0.4)) == pytest.approx(rings(PLAIN, time, 3.2), abs=1e-12)
    assert np.all(simulate.positions(replace(PLAIN, dead_zone=2.1)) == 0.0)


def test_readings_have_the_noise_that_the_rig_states() -> None:
    rig = replace(PLAIN, noise=3e-5, count=5e-5, commands=(0.0,) * 20000)
    readings = simulate.read(rig, np.linspace(0.0, 0.01, 20000))
    assert np.std(readings - np.linspace(0.0, 0.01, 20000)) == pytest.approx(rig.noise_level, rel=0.03)


@pytest.mark.parametrize("fault", [None, *FAULTS])
def test_every_fault_is_drawn_and_moves_the_rig_otherwise(fault: str | None) -> None:
    rig = draw(3, fault, True, "steps")
    assert rig == draw(3, fault, True, "steps") and set(rig.faults) == {fault or "frictionloss", "frictionloss"}
    plain = replace(rig, frictionloss=0.0, lag=0.0, saturation=math.inf, dead_zone=0.0, limit=None)
    short, other = (replace(one, commands=one.commands[:1500]) for one in (rig, plain))
    moved = np.abs(simulate.stepped(short, 5) - simulate.stepped(other, 5)).max()
    assert moved > 3.0 * rig.noise_level
    assert len(rig.commands) > 3000 and max(map(abs, rig.commands)) > 0.0


def test_what_an_experiment_cannot_show_is_not_drawn() -> None:
    with pytest.raises(ValueError, match="lag shows nothing in release"):
        draw(1, "lag", False, "release")
    with pytest.raises(ValueError, match="dead_zone shows nothing in step"):
        draw(1, "dead_zone", False, "step")
    assert {len(draw(1, None, False, name).commands) for name in EXPERIMENTS} >= {3000, 4000, 5000}


def test_the_second_author_knows_neither_the_library_nor_the_rig() -> None:
    for path in Path(simulate.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            assert not any(name.split(".")[0] in ("msd_ident", "msd_sim") for name in names), path
