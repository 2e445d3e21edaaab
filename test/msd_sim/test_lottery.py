"""Rigs by lot: what is drawn, how wide, and that every draw runs."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest

from msd_sim import api, lottery
from msd_sim.errors import RigError


def strengths(name: str, parameter: str, ranges: lottery.Ranges) -> np.ndarray:
    """A parameter relative to the narrow draws of the same seeds, whose plants are the same."""
    return np.array([lottery.draw(seed, name, ranges=ranges).spec["effects"][name][parameter] for seed in range(300)])


@pytest.mark.parametrize(
    ("name", "parameter"), [("quadratic_drag", "drag_coefficient"), ("backlash", "backlash_half_width")]
)
def test_wide_ranges_reach_three_times_as_far_to_both_sides(name: str, parameter: str) -> None:
    ratio = strengths(name, parameter, "wide") / strengths(name, parameter, "narrow")
    assert ratio.max() / ratio.min() == pytest.approx(3.0, rel=0.05)
    assert ratio.min() < 0.6 and ratio.max() > 1.65


def test_a_stribeck_peak_may_be_narrow_and_high() -> None:
    """Fs/Fc up to 5, vs down to 2 % of the top speed."""
    drawn = [lottery.draw(seed, "stribeck_friction", ranges="wide") for seed in range(300)]
    effects = [draw.spec["effects"]["stribeck_friction"] for draw in drawn]
    ratios = [effect["static_force"] / effect["coulomb_force"] for effect in effects]
    forces = [draw.spec["experiment"]["force"] / np.sqrt(draw.spec["mass"] * draw.spec["stiffness"]) for draw in drawn]
    speeds = [effect["stribeck_velocity"] / speed for effect, speed in zip(effects, forces, strict=True)]
    assert 4.8 < max(ratios) <= 5.0 and 0.02 <= min(speeds) < 0.022


def test_noises_differ_in_what_they_are_and_not_in_the_rig() -> None:
    white, coloured, growing = (lottery.draw(7, "backlash", noise=noise) for noise in lottery.NOISES)
    assert white.spec["effects"] == coloured.spec["effects"] == growing.spec["effects"]
    assert coloured.spec["encoder"]["noise"] > 0.0 and 1.0 <= coloured.spec["encoder"]["noise_correlation"] <= 20.0
    made = api.simulate(growing.spec)
    error = np.abs(made.position - made.motion.position)
    fast = np.abs(made.motion.velocity) > np.quantile(np.abs(made.motion.velocity), 0.9)
    assert np.mean(error[fast]) > 1.5 * np.mean(error[~fast])


def test_the_level_that_a_draw_states_is_that_of_its_readings() -> None:
    for seed in range(8):
        draw = lottery.draw(seed, None, noise="coloured", ranges="wide")
        made = api.simulate(draw.spec)
        assert np.std(made.position - made.motion.position) == pytest.approx(draw.noise, rel=0.12), seed


def test_two_effects_are_both_there_and_two_dry_frictions_are_refused() -> None:
    draw = lottery.draw(3, "quadratic_drag", other="backlash")
    assert draw.truth == {"quadratic_drag", "backlash"}
    with pytest.raises(RigError, match="stribeck_friction and coulomb_friction are two laws"):
        lottery.draw(3, "stribeck_friction", other="coulomb_friction")
    with pytest.raises(RigError, match="no noise 'pink'"):
        lottery.draw(3, None, noise="pink")  # type: ignore[arg-type]


@pytest.mark.parametrize("name", lottery.NAMES)
def test_no_wide_rig_runs_away(name: str) -> None:
    for seed, experiment in enumerate(lottery.EXPERIMENTS):
        draw = lottery.draw(seed, name, seed % 2 == 0, experiment, 250.0, ranges="wide")
        assert np.isfinite(api.simulate(draw.spec).position).all()


@cache
def moved(spec: str) -> np.ndarray:
    """Positions (n,) [m] of a rig in JSON; without effects, several draws of a seed are the same rig."""
    return api.simulate(json.loads(spec)).position


@pytest.mark.parametrize("name", lottery.VARIANTS)
def test_a_variant_is_drawn_and_moves_the_cart_otherwise(name: str) -> None:
    experiment = "sweep" if name == lottery.BAND_LIMITED else "steps"
    for seed in range(4):
        draw = lottery.draw(seed, name, False, experiment, 250.0)
        assert draw.truth == {name}
        spec = {**draw.spec, "encoder": {}}
        plain = {key: value for key, value in spec.items() if key != "hold"} | {"effects": {}}
        one, other = api.simulate(spec).position, moved(json.dumps(plain))
        assert np.abs(one - other).max() > draw.noise
    assert not set(lottery.VARIANTS) & {*lottery.NAMES, *lottery.ODDITIES}


def test_a_force_between_commands_needs_commands() -> None:
    with pytest.raises(RigError, match="band_limited_force in steps; expected sweep or ramp"):
        lottery.draw(1, lottery.BAND_LIMITED)
