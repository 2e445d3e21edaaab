"""The solver against msd_sim's rig, which shares no code with it: positions agree to 1e-6 of the amplitude."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from effect_examples import DAMPING, EXAMPLES, MASS, RIG, STIFFNESS, model, record
from scipy.integrate import solve_ivp

from msd_ident.data.record import Record
from msd_ident.model import simulate
from msd_ident.model.effects import Effect, by_name
from msd_ident.model.effects.bouc_wen import BoucWen
from msd_ident.model.effects.sensor_eccentricity import SensorEccentricity
from msd_sim.effects import ALL as THEIR_EFFECTS
from msd_sim.rig import Rig
from msd_sim.truth import Truth

AGREE = 1e-6
#: Laws that msd_sim does not have: the force against +x, or what a command becomes, as scipy's solver is given them.
PLAIN: dict[str, Callable[[float], float]] = {
    "cogging_harmonic": lambda x: 0.3 * math.sin(100 * math.pi * x + 0.4) + 0.2 * math.sin(200 * math.pi * x + 0.9),
    "force_dead_zone": lambda u: math.copysign(max(abs(u) - 0.6, 0.0), u),
    "force_gain_asymmetry": lambda u: 1.05 * u if u > 0.0 else 0.95 * u,
    "gravity": lambda x: 300.0 * math.sin(x),
    "power_spring": lambda x: 1.5 * (x / 0.02) ** 2 * math.copysign(1.0, x),
}
#: Effects that msd_sim does not have as such, which have a test of their own, here or in their file.
APART = {
    "bouc_wen", "buffered_stop", "constraint_stop", "curved_stiffness_drift", "drive_hysteresis",
    "eccentricity_harmonic", "fading_damping", "frame_compliance", "friction_drift", "gain_drift",
    "growing_damping", "modulated_disturbance", "position_dependent_damping", "position_dependent_gain",
    "position_dependent_inertia", "rubbing_second_mode", "scale_drift", "sensor_eccentricity",
    "sensor_nonlinearity", "settling_friction", "smooth_friction", "smooth_friction_turn", "smooth_stribeck_friction",
}  # fmt: skip
#: Effects that msd_sim has too, as in the examples.
THEIRS = [name for name in sorted(set(EXAMPLES) - set(PLAIN) - APART) if RIG.get(name, (name,))[0] in THEIR_EFFECTS]
#: Samples a second of the contract, with a force held and a force linear between samples.
SAMPLINGS = [(rate, hold) for rate in (250.0, 2000.0) for hold in ("zero", "linear")]
#: Those of them for which the rig's plant is the same, so that the laws of others mean the same too.
TOGETHER = [name for name in THEIRS if name not in RIG or not RIG[name][2]]


def rig_positions(measured: Record, names: tuple[str, ...], x: float, v: float) -> np.ndarray:
    """Readings of a rig with these effects and no encoder error."""
    effects, plant = {}, {"damping": DAMPING, "stiffness": STIFFNESS}
    for name in names:
        theirs, values, other = RIG.get(name, (name, EXAMPLES[name], {}))
        effects[theirs] = values
        plant |= other
    truth = Truth(MASS, plant["damping"], plant["stiffness"], effects)
    rig = Rig(truth, x, v, float(measured.time[0]), measured.hold)
    rig.drive(measured.force_time, measured.force)
    motion = rig.sample(measured.time)
    return truth.sensed(motion.time, motion.position)


def disagreement(measured: Record, names: tuple[str, ...], x: float = 0.0, v: float = 0.0) -> float:
    """Largest difference of both, in parts of the rig's amplitude."""
    theirs = rig_positions(measured, names, x, v)
    ours = simulate(model(*names), measured, x, v).position
    return float(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))


def sensible_pairs() -> list[tuple[str, str]]:
    """All pairs that a model takes: not two dry frictions, nor two laws of one cause."""
    return [pair for pair in itertools.combinations(TOGETHER, 2) if together(*map(by_name, pair))]


def together(one: type[Effect], other: type[Effect]) -> bool:
    """Whether a model may hold both."""
    return one.cause() != other.cause() and not (one.family and one.family == other.family)


def random_pairs(count: int) -> list[tuple[str, str]]:
    """Some of them, always the same."""
    pairs = sensible_pairs()
    return [pairs[i] for i in np.random.default_rng(20).choice(len(pairs), count, replace=False)]


def test_every_effect_is_compared_with_a_law_of_other_code() -> None:
    left = set(EXAMPLES) - set(PLAIN) - APART - set(THEIRS)
    assert not left, (
        f"msd_sim has no {', '.join(sorted(left))}: write the law a second time in PLAIN if it depends on x or u "
        "alone, in words of msd_sim in RIG (effect_examples.py), or in a test with scipy, and put the name into APART"
    )


@pytest.mark.parametrize(("rate", "hold"), SAMPLINGS)
@pytest.mark.parametrize("name", THEIRS)
def test_every_effect_agrees(name: str, rate: float, hold: str) -> None:
    assert disagreement(record(rate, hold), (name,)) <= AGREE


@pytest.mark.parametrize(("rate", "hold"), SAMPLINGS)
@pytest.mark.parametrize("names", random_pairs(20), ids="+".join)
def test_twenty_random_pairs_agree(names: tuple[str, ...], rate: float, hold: str) -> None:
    assert disagreement(record(rate, hold, 1.5), names, 0.004, -0.03) <= AGREE


def test_all_that_goes_together_agrees() -> None:
    """Every effect at once, with each of the dry frictions and one second state."""
    frictions = [name for name in TOGETHER if by_name(name).family == "dry friction"]
    rest = [name for name in TOGETHER if not by_name(name).family and not by_name(name).form_of] + ["second_mode"]
    for friction in frictions:
        # The rig's load is that of a spring without play; here it is what the spring makes.
        others = [name for name in rest if name != "backlash" or friction != "load_dependent_friction"]
        assert disagreement(record(1000.0), (friction, *others), 0.004, -0.03) <= 1e-5


@pytest.mark.parametrize("name", THEIRS)
def test_irregular_samples_agree(name: str) -> None:
    """Stamps that jitter by a third of a period, a gap of 0.1 s, and a force with stamps of its own."""
    random = np.random.default_rng(3)
    time = np.arange(600) / 250.0 + random.uniform(0.0, 0.0013, 600)
    time = np.delete(time, np.s_[200:225])
    force_time = np.sort(random.uniform(0.0, 2.4, 40))
    force = 8.0 * np.sin(9.0 * force_time)
    for hold in ("zero", "linear"):
        measured = Record(time=time, position=0.0 * time, force_time=force_time, force=force, hold=hold)
        assert disagreement(measured, (name,), 0.004, -0.03) <= AGREE


def test_an_eccentric_sensor_agrees() -> None:
    """The rig's wheel begins in phase."""
    measured = record(1000.0)
    truth = Truth(
        MASS, DAMPING, STIFFNESS, {"sensor_eccentricity": {"eccentricity": 1e-4, "wheel_circumference": 0.02}}
    )
    rig = Rig(truth, 0.0, 0.0, 0.0, measured.hold)
    rig.drive(measured.force_time, measured.force)
    motion = rig.sample(measured.time)
    ours = simulate(model() + SensorEccentricity(1e-4, 0.02, 0.0), measured).position
    theirs = truth.sensed(motion.time, motion.position)
    assert np.max(np.abs(ours - theirs)) <= AGREE * np.max(np.abs(theirs))


@pytest.mark.parametrize("name", sorted(PLAIN))
def test_laws_that_the_rig_does_not_have_agree_with_scipy(name: str) -> None:
    measured, on_input = record(500.0, "linear", 2.0), by_name(name).acts_on == "input"

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        force = float(np.interp(t, measured.force_time, measured.force))
        net = PLAIN[name](force) if on_input else force - PLAIN[name](x)
        return [v, (net - DAMPING * v - STIFFNESS * x) / MASS]

    theirs = solve_ivp(slope, (0.0, 2.0), [0.0, 0.0], t_eval=measured.time, rtol=1e-9, atol=1e-12, max_step=1e-3)
    ours = simulate(model(name), measured).position
    assert np.max(np.abs(ours - theirs.y[0])) <= 1e-4 * np.max(np.abs(theirs.y[0]))


@pytest.mark.parametrize(
    ("loading", "unloading"), [(40.0, 250.0), (0.0, 250.0), (-15.0, 250.0), (40.0, 0.0), (40.0, -20.0)]
)
def test_bouc_and_wen_agree_with_scipy(loading: float, unloading: float) -> None:
    """The closed form against z' = ka v - beta abs(v) z - gamma v abs(z)."""
    measured = record(500.0, "linear", 2.0)
    beta, gamma = 0.5 * (loading + unloading), 0.5 * (loading - unloading)

    def slope(t: float, state: np.ndarray) -> list[float]:
        x, v, z = state
        force = np.interp(t, measured.force_time, measured.force)
        return [
            v, (force - DAMPING * v - STIFFNESS * x - z) / MASS,
            120.0 * v - beta * abs(v) * z - gamma * v * abs(z),
        ]  # fmt: skip

    theirs = solve_ivp(slope, (0.0, 2.0), [0.0, 0.0, 0.0], t_eval=measured.time, rtol=1e-9, atol=1e-12, max_step=1e-3)
    ours = simulate(model() + BoucWen(120.0, loading, unloading), measured).position
    assert np.max(np.abs(ours - theirs.y[0])) <= 1e-5 * np.max(np.abs(theirs.y[0]))
