"""Foreign laws against closed forms, energy and mirror images; and that every one is drawn and acts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from msd_sim import api, foreign, lottery
from msd_sim.encoder import Encoder
from msd_sim.errors import RigError
from msd_sim.foreign import simulate
from msd_sim.foreign.simulate import ForeignRig, draw
from msd_sim.strengths import Sizes

#: Laws whose force does not turn round with the motion, or depends on time.
LOPSIDED = {
    "padded_stop", "uneven_stops", "exponential_spring", "linkage_gravity", "film_damping", "trapezoid_cogging",
    "sawtooth_cogging", "three_tones", "modulated_tone", "random_force",
}  # fmt: skip
#: Laws that may give energy to the cart: forces of time, and those of a drive.
DRIVEN = {"three_tones", "modulated_tone", "random_force", "wandering_stiffness"}
FORCES = [law for law in foreign.LAWS.values() if law.force is not None and law.rates is None]
ALL = list(foreign.LAWS.values())


def rig_of(name: str, seed: int = 3, experiment: str | None = None) -> ForeignRig:
    law = foreign.LAWS[name]
    return draw(seed, law, experiment or law.experiments[0])


def exact(rig: ForeignRig) -> np.ndarray:
    return simulate.simulate(rig).position


def at(name: str, x: float = 0.0, v: float = 0.0, t: float = 0.0, u: float = 0.0, **values: float) -> float:
    law = foreign.LAWS[name]
    assert law.force is not None
    return law.force(values, t, x, v, (0.0,) * law.states, u)


def sizes() -> Sizes:
    return lottery.begun(np.random.default_rng([1, 31337]), "steps", 1000.0)[0]


@pytest.mark.parametrize(
    ("law", "experiment"),
    [
        pytest.param(law, experiment, marks=pytest.mark.long if turn else ())
        for law in ALL
        for turn, experiment in enumerate(law.experiments)
    ],
    ids=lambda given: getattr(given, "name", given),
)
def test_a_law_is_drawn_and_changes_the_record(law: foreign.ForeignLaw, experiment: str) -> None:
    """In the first of its experiments; the others are ``long``."""
    rig = draw(11, law, experiment)
    assert rig.values == draw(11, law, experiment).values
    made, plain = simulate.simulate(rig), simulate.simulate(replace(rig, law=None, encoder=Encoder()))
    assert np.isfinite(made.reading).all() and made.reading.shape == rig.time.shape == rig.commanded().shape
    if law.name != simulate.SMOOTH_FORCE:
        assert np.abs(made.reading - plain.position).max() > 2.0 * rig.noise
    if "tones" not in law.experiments:
        with pytest.raises(RigError, match="expected one of"):
            draw(11, law, "tones")


def test_a_rig_without_a_law_is_that_of_the_other_integrator() -> None:
    for experiment in ("steps", "release"):
        rig = draw(5, None, experiment)
        plant = {"mass": rig.mass, "damping": rig.damping, "stiffness": rig.stiffness}
        other = api.simulate(
            plant | {"time": rig.time, "force_time": rig.command_time, "force": rig.command}
            | {"initial_position": rig.start}
        )  # fmt: skip
        assert exact(rig) == pytest.approx(other.motion.position, abs=1e-7 * rig.reach)


@pytest.mark.parametrize("law", [law for law in FORCES if law.name not in LOPSIDED], ids=lambda law: law.name)
def test_a_force_turns_round_with_the_motion(law: foreign.ForeignLaw) -> None:
    rig = draw(7, law, law.experiments[0])
    speed = rig.reach * math.sqrt(rig.stiffness / rig.mass)
    for x, v in ((0.3, 0.2), (1.4, -0.6), (-0.9, 1.1)):
        one = law.force(rig.values, 0.4, x * rig.reach, v * speed, (), 1.0)  # type: ignore[misc]
        other = law.force(rig.values, 0.4, -x * rig.reach, -v * speed, (), -1.0)  # type: ignore[misc]
        assert one == pytest.approx(-other, abs=1e-12)


@pytest.mark.parametrize("law", [law for law in ALL if law.force and law.name not in DRIVEN], ids=lambda law: law.name)
def test_a_released_cart_gains_no_energy(law: foreign.ForeignLaw) -> None:
    """Springs give back what they took, so that the last swings are compared with the first ones."""
    if "release" not in law.experiments:
        pytest.skip("a law of the drive")
    moved = simulate.simulate(draw(4, law, "release"))
    size = np.abs(moved.position - moved.position[-1])
    assert size[-1000:].max() < 0.7 * size[:1000].max()


def test_springs_have_their_closed_forms() -> None:
    assert at("sinh_spring", 0.5, size=3.0, length=0.5) == pytest.approx(3.0 * (math.sinh(1.0) - 1.0))
    assert at("exponential_spring", 1.0, size=2.0, length=0.5) == pytest.approx(2.0 * (math.e**2 - 3.0))
    slopes = {"first": 10.0, "bend": 1.0, "second": 5.0, "further_bend": 2.0}
    assert at("three_slope_spring", -3.0, **slopes) == pytest.approx(-25.0)
    soft = {"stiffness": 8.0, "gap": 1.0, "corner": 1e-3, "inside": 0.25}
    assert 8.0 * 0.5 + at("soft_play", 0.5, **soft) == pytest.approx(8.0 * 0.25 * 0.5, abs=1e-6)
    assert 8.0 * 3.0 + at("soft_play", 3.0, **soft) == pytest.approx(8.0 * (0.25 * 3.0 + 0.75 * 2.0), abs=1e-6)
    assert 4.0 * 2.0 + at("saturating_spring", 2.0, stiffness=4.0, length=2.0) == pytest.approx(4.0)


def test_stops_push_and_never_pull() -> None:
    hertz = {"place": 1.0, "contact": 8.0, "loss": 0.5}
    assert at("hertz_stop", 5.0, **hertz) == pytest.approx(64.0) and at("hertz_stop", -0.9, **hertz) == 0.0
    assert at("hertz_stop", 1.5, -10.0, **hertz) == 0.0 and at("hertz_stop", -1.5, 10.0, **hertz) == 0.0
    assert at("padded_stop", 2.0, place=1.0, pad=3.0, length=0.5) == pytest.approx(3.0 * (math.e**2 - 1.0))
    uneven = {"above": 1.0, "below": 2.0, "stiff_above": 5.0, "stiff_below": 7.0, "loss": 1.0}
    assert at("uneven_stops", 1.2, 1.0, **uneven) == pytest.approx(2.0)
    assert at("uneven_stops", -2.5, 1.0, **uneven) == pytest.approx(-3.5)


def test_a_saturating_damper_goes_towards_a_constant_force() -> None:
    slow, fast = (at("saturating_damping", v=v, drag=2.0, corner=1.5) for v in (1e-3, 1e3))
    assert slow == pytest.approx(2e-3, rel=1e-5) and fast == pytest.approx(3.0, rel=1e-5)


@pytest.mark.parametrize("name", ["lugre", "maxwell_slip"])
def test_bristles_hold_at_rest_and_slip_at_their_force(name: str) -> None:
    """Under a constant speed the force settles at the kinetic one."""
    law, values = foreign.LAWS[name], {
        "kinetic": 1.0, "static": 1.5, "falling": 0.01, "bristle": 1e4, "loss": 1.0, "slow": 1e-3, "deflection": 1e-4,
    }  # fmt: skip
    z, step, speed = [0.0] * law.states, 1e-6, 0.5
    for _ in range(40_000):
        rates = law.rates(values, 0.0, 0.0, speed, z, 0.0)  # type: ignore[misc]
        z = [one + step * rate for one, rate in zip(z, rates, strict=True)]
    assert law.force(values, 0.0, 0.0, speed, z, 0.0) == pytest.approx(1.0, rel=0.02)  # type: ignore[misc]


def test_drives_have_their_closed_forms() -> None:
    commands = np.array([0.0, 5.0, 0.0, -5.0, 0.0])
    play = foreign.LAWS["remembering_drive"].commands
    assert play is not None and play({"play": 1.0}, commands).tolist() == [0.0, 4.0, 1.0, -4.0, -1.0]
    sharp = foreign.LAWS["sharp_saturation"].commands
    assert sharp is not None and sharp({"limit": 1.0}, np.array([100.0]))[0] == pytest.approx(1.0, abs=1e-6)
    slow = rig_of("rate_limited_drive")
    assert np.abs(exact(slow) - exact(replace(slow, values={"rate": 1e9}))).max() > 3.0 * slow.noise


def test_a_random_force_is_as_large_as_it_says() -> None:
    force = [at("random_force", t=0.01 * i, size=2.0, memory=0.1, seed=5.0) for i in range(20_000)]
    assert np.std(force) == pytest.approx(2.0, rel=0.05) and abs(np.mean(force)) < 0.1


def test_tones_lie_between_their_samples() -> None:
    rig = rig_of(simulate.SMOOTH_FORCE)
    assert rig.smooth is not None
    assert rig.commanded() == pytest.approx([rig.smooth(t) for t in rig.time])
    held = replace(rig, smooth=None)
    assert np.abs(exact(rig) - exact(held)).max() > 3.0 * rig.noise


@pytest.mark.parametrize("name", ["hertz_stop", "tanh_sum_friction", "lugre", "maxwell_slip", "soft_play"])
def test_the_integrator_is_exact_beside_the_noise(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    rig = rig_of(name)
    found = exact(rig)
    monkeypatch.setattr(simulate, "_LONGEST", 1e-4)
    monkeypatch.setattr(simulate, "_RELATIVE", 1e-11)
    assert np.abs(found - exact(rig)).max() < 0.05 * rig.noise


def test_foreign_laws_have_names_of_their_own() -> None:
    assert len(foreign.LAWS) == sum(len(table.LAWS) for table in foreign.TABLES) >= 24
    assert not set(foreign.LAWS) & {*lottery.NAMES, *lottery.ODDITIES, *lottery.VARIANTS}


def test_two_laws_on_one_rig_act_as_if_both_were_written_out() -> None:
    """The force is the sum of both, each with its own values and inner states; the sensor reads what moves."""
    slips, waves, wheel = (foreign.LAWS[name] for name in ("maxwell_slip", "sawtooth_cogging", "elliptic_wheel"))
    rig = draw(7, foreign.both(slips, waves))
    own = [{name: rig.values[f"{law.name}.{name}"] for name in law.strengths(sizes())} for law in (slips, waves)]
    assert rig.law is not None and rig.law.force is not None and rig.law.rates is not None
    assert slips.force is not None and slips.rates is not None and waves.force is not None
    z = np.linspace(-1e-3, 1e-3, slips.states).tolist()
    state = (0.3, 1e-3, -0.2, z, 2.0)
    assert rig.law.force(rig.values, *state) == pytest.approx(slips.force(own[0], *state) + waves.force(own[1], *state))
    assert rig.law.rates(rig.values, *state) == pytest.approx(slips.rates(own[0], *state))
    seen = draw(7, foreign.both(slips, wheel))
    alone = replace(seen, law=slips, values={k.split(".")[1]: v for k, v in seen.values.items() if "slip" in k})
    np.testing.assert_array_equal(simulate.simulate(seen).position, simulate.simulate(alone).position)
    assert np.abs(simulate.simulate(seen).reading - simulate.simulate(alone).reading).max() > 0.0


def test_the_place_of_a_second_mass_comes_first_and_commands_pass_both_drives() -> None:
    slips, hung = foreign.LAWS["maxwell_slip"], foreign.LAWS["sloshing_mass"]
    for pair in (foreign.both(slips, hung), foreign.both(hung, slips)):
        assert pair.hangs and pair.states == slips.states + hung.states
        rig = draw(3, pair, "release")
        begun = (0.0, rig.start, 0.0, [rig.start, *[0.0] * (pair.states - 1)], 0.0)
        assert pair.force is not None and rig.start > 0.0
        assert pair.force(rig.values, *begun) == 0.0, "the second mass begins where the cart does"
        assert np.isfinite(simulate.simulate(rig).reading).all()
    sharp, dead = foreign.LAWS["sharp_saturation"], foreign.LAWS["remembering_drive"]
    rig = draw(3, foreign.both(dead, sharp))
    assert rig.law is not None and rig.law.commands is not None and sharp.commands and dead.commands
    values = [{k.split(".")[1]: v for k, v in rig.values.items() if k.startswith(law.name)} for law in (dead, sharp)]
    wanted = sharp.commands(values[1], dead.commands(values[0], rig.command))
    np.testing.assert_array_equal(rig.law.commands(rig.values, rig.command), wanted)


@pytest.mark.parametrize(
    ("one", "two"),
    [("walking_zero", "missed_counts"), ("sloshing_mass", "rubbing_second_mass"), ("smooth_force", "lugre")],
    ids=["two sensors", "two second masses", "no common experiment"],
)
def test_laws_that_cannot_act_together_are_refused(one: str, two: str) -> None:
    with pytest.raises(RigError, match=f"{one} and {two} cannot act on one rig"):
        foreign.both(foreign.LAWS[one], foreign.LAWS[two])
