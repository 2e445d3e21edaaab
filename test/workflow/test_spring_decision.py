"""A spring is not silently decided away or into a plain axis, and a closed loop is recognised."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from pendulums import turned

from msd_ident.data.quality import check
from msd_ident.data.record import Record, from_samples
from msd_ident.estimate import fit
from msd_ident.io import SourceOptions, read
from msd_ident.model import Effect, Plant, simulate
from msd_ident.model.base_model import DryFriction
from msd_ident.model.effects.gravity import Gravity
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.quantity import Quantity
from msd_ident.residuals.unexplained import Remainder, Remainders
from msd_ident.workflow import pipeline, spring_decision
from msd_ident.workflow.diagnose import _does_without
from msd_ident.workflow.identification import Identification
from msd_ident.workflow.preparation import prepare
from msd_ident.workflow.starting_plant import typical_plant
from msd_sim import api, lottery

STEP = 2e-5
#: Of a poor experiment; without copies it leaves no cause certain.
COPIED = pytest.mark.parametrize("copied", [False, pytest.param(True, marks=pytest.mark.long)])


def controlled(stiffness: float = 30.0, gain: float = 300.0) -> Record:
    """A cart under a proportional controller with setpoints, which reads a rounding encoder at 100 Hz."""
    mass, damping, fine, period = 0.06, 1.8, 20, 0.01
    x = v = 0.0
    rows = []
    for i in range(800):
        setpoint = 0.02 if i % 400 < 200 else 0.0
        reading = round(x / STEP) * STEP
        force = round(gain * (setpoint - reading), 4)
        rows.append((i * period, force, reading))
        for _ in range(fine):
            v += period / fine * (force - damping * v - stiffness * x) / mass
            x += period / fine * v
    return from_samples(*np.array(rows).T, name="closed")


def open_loop(force: np.ndarray, stiffness: float = 700.0) -> Record:
    asked = from_samples(np.arange(force.size) * 2e-3, force, np.zeros(force.size), name="open")
    position = simulate(Plant(1.0, 3.0, stiffness), asked).position
    return replace(asked, position=np.round(position / 1e-6) * 1e-6)


def sentences(found: Identification) -> str:
    return " ".join(found.warnings)


def closed(record: Record) -> list[str]:
    return [finding.sentence for finding in check(record) if finding.code == "closed_loop"]


def test_a_closed_loop_is_said_with_its_gain() -> None:
    (said,) = closed(controlled())
    assert said.startswith("the force follows the readings (-300 N/m): a controller computes it from them.")
    assert "push with a force that does not depend on the position" in said


def led_along_a_sine(frequency: float, seconds: float = 6.0) -> Record:
    """A disc with an encoder of 10 mrad a count, led along a sine of 20 counts by a PD controller at 200 Hz."""
    rate, fine, count = 200.0, 20, 0.01
    inertia, damping = 4e-4, 4e-3
    angle = speed = 0.0
    rows, past = [], [0.0, 0.0]
    for i in range(int(seconds * rate)):
        reading = count * round(angle / count)
        torque = 0.3 * (20.0 * count * math.sin(2.0 * math.pi * frequency * i / rate) - reading)
        torque -= 0.001 * (reading - past[0]) * rate / 2.0
        past = [past[1], reading]
        rows.append((i / rate, torque, reading))
        for _ in range(fine):
            speed += (torque - damping * speed) / inertia / rate / fine
            angle += speed / rate / fine
    led = from_samples(*np.array(rows).T, name="led")
    return led.window(1.0, led.time[-1])


@pytest.mark.parametrize("frequency", [1.0, 2.0, 4.0])
def test_a_controller_is_seen_in_the_noise_where_its_setpoint_moves_all_the_time(frequency: float) -> None:
    record = led_along_a_sine(frequency)
    (said,) = closed(record)
    gain = float(said.split("(")[1].split()[0])
    assert -0.45 < gain < -0.15, "0.3 N·m/rad; rounding is not quite noise"
    (tone,) = (one for one in check(record) if one.code == "single_tone")
    assert tone.sentence.startswith(f"force and motion are a single tone of {frequency:g} Hz: this record alone shows ")
    assert tone.sentence.endswith("add records at other frequencies, a sweep or steps")


T = np.arange(4000) * 2e-3


@pytest.mark.parametrize(
    "force",
    [
        5.0 * np.sin(10.0 * T),
        5.0 * np.sin(120.0 * T),
        5.0 * np.sin(2.0 * T + 4.0 * T**2),
        np.random.default_rng(0).normal(0.0, 5.0, T.size),
        np.where(T % 2.0 < 1.0, 5.0, 0.0),
        np.where(T % 2.0 < 1.0, 5.0 * np.sin(120.0 * T), 0.0),
        np.minimum(T, 8.0 - T),
    ],
    ids=["below resonance", "above resonance", "sweep", "noise", "steps", "bursts", "ramp"],
)
def test_an_open_loop_is_none(force: np.ndarray) -> None:
    assert closed(open_loop(force)) == []


@pytest.mark.parametrize("experiment", ["steps", "sweep", "ramp"])
def test_no_rig_that_is_pushed_is_taken_to_be_controlled(experiment: str) -> None:
    """Whatever acts on it, and however its encoder rounds; a sweep and a ramp share the causes between them."""
    for seed, name in enumerate((*lottery.NAMES, None)):
        if experiment == ("ramp", "sweep")[seed // 2 % 2]:
            continue
        draw = lottery.draw(seed, name, seed % 2 == 0, experiment, 250.0, noise=lottery.NOISES[seed % 3])
        made = api.simulate(draw.spec)
        force = made.force[np.maximum(np.searchsorted(made.force_time, made.time, side="right") - 1, 0)]
        for step in (0.0, 0.1 * float(np.ptp(made.position))):
            read = np.round(made.position / step) * step if step else made.position
            found = check(from_samples(made.time, force, read))
            assert not {"closed_loop", "single_tone"} & {one.code for one in found}, (name, seed, step)


def test_a_stiff_spring_that_follows_slow_pulses_is_no_controller() -> None:
    pulses = 500.0 * np.where(T % 2.0 < 1.0, np.sin(np.pi * T) ** 2, 0.0)
    assert closed(open_loop(pulses, stiffness=7e4)) == []


def test_the_spring_of_a_controlled_cart_is_kept() -> None:
    found = pipeline.identify([controlled()])
    assert found.refined.parameters["stiffness"].value == pytest.approx(30.0, rel=0.05)
    if found.standard_form is None:
        said = "No response shows whether a spring acts; a spring is assumed: fitted with dry friction alone, "
        assert said in sentences(found)
        assert "If there is none, use --model no_spring." in sentences(found)


@pytest.mark.parametrize(("omega", "says"), [(26.0, "; its force is "), (5.0, "; it carries 1")])
def test_a_spring_that_swings_carries_more_than_is_applied(omega: float, says: str) -> None:
    """At resonance, of a spring of 700 N/m under 1 kg: "it carries 540 % of the force"."""
    record = open_loop(3.0 * np.sin(omega * T) + 3.0 * np.sin(0.3 * omega * T))
    free = fit(Plant(1.0, 3.0, 0.0), record, fixed=("stiffness",))
    said = spring_decision._sentence(True, fit(Plant(1.0, 3.0, 700.0), record), free, (record,))
    assert says in said and ("times the applied one, and without" in said) is (omega > 10.0)


def test_a_fit_with_a_spring_that_did_not_end_makes_the_error_without_one_no_smaller() -> None:
    """Of a measured motor it was said that "without it the error is 0.72 times as large"."""
    record = open_loop(3.0 * np.sin(T) + np.sin(7.0 * T), stiffness=0.0)
    free = fit(Plant(1.0, 3.0, 0.0), record, fixed=("stiffness",))
    held = fit(Plant(1.0, 3.0, 40.0), record)
    unfinished = replace(held, see=1.4 * free.see)
    assert spring_decision._sentence(False, unfinished, free, (record,)).endswith(
        "and without it the error is as large. If there is one, use --model spring."
    )


def test_a_spring_that_the_force_shows_plainly_needs_no_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    record = open_loop(5.0 * np.sin(2.0 * T + 4.0 * T**2) * np.sin(0.7 * T))
    monkeypatch.setattr(spring_decision, "fit", None)
    decision = spring_decision.has_spring(prepare([record]), pipeline.Options())
    (said,) = decision.said
    assert decision.sprung and not decision.doubtful
    assert said.startswith("No response shows whether a spring acts; a spring is assumed: with one the motion ")
    assert " % of the force's variation, without one for " in said and said.endswith("use --model no_spring.")
    assert spring_decision.plain((open_loop(record.force, stiffness=0.0),)) == ""


def test_an_axis_without_a_spring_is_said_with_its_odds_and_the_option() -> None:
    rng = np.random.default_rng(2)
    force = np.repeat(rng.normal(0.0, 3.0, 200), 20)
    record = open_loop(force - force.mean(), stiffness=0.0)
    found = pipeline.identify([record])
    assert found.refined.model["stiffness"] == 0.0
    said = next(one for one in found.warnings if "spring" in one)
    assert said.startswith(
        "No response shows a spring, and none is assumed: fitted with dry friction alone, its stiffness is "
    )
    assert (
        "(95 %), as likely as none; it carries" in said
        and "% of the force, and without it the error is as large." in said
    )
    assert said.endswith("as large. If there is one, use --model spring.")
    told = pipeline.identify([record], pipeline.Options(model="no_spring"))
    assert not any("spring" in one for one in told.warnings), "who decides needs no odds"


@pytest.mark.parametrize(
    ("value", "std", "words"),
    [
        (1.0, 5.0, "as likely as none"),
        (2.0, 1.0, "7.4 times as likely as none"),
        (3.0, 1.0, "90 times as likely as none"),
        (-6.0, 1.0, "more than 1000 times as likely as none"),
        (150.0, 1.0, "beyond doubt not 0"),
        (1.0, 0.0, "beyond doubt not 0"),
    ],
)
def test_odds_are_said_in_words(value: float, std: float, words: str) -> None:
    """They were powers of e, and 1 times as likely."""
    record = open_loop(np.repeat(np.random.default_rng(2).normal(0.0, 3.0, 100), 20), stiffness=0.0)
    found = fit(Plant(1.0, 3.0, 100.0), [record], zero="known")
    held = replace(found, quantities={**found.quantities, "stiffness": Quantity(value, std, "N/m")})
    for sprung in (True, False):
        said = spring_decision._sentence(sprung, held, replace(found, see=2.5 * found.see), (record,))
        told = f", {words}" if sprung or value < 1.96 * std else ""  # beside the error of no spring they are no odds
        assert f" (95 %){told}; it carries " in said and ", and without it the error is 2.5 times as large. " in said
        assert "e^" not in said and " 1 times" not in said


@COPIED
def test_a_release_through_a_wide_play_shows_a_spring(
    copied: bool, asking_about: Callable[..., None], request: pytest.FixtureRequest
) -> None:
    """Without a force only ratios are known; the cart swings back all the same, though not as on a linear spring."""
    if not copied:
        request.getfixturevalue("without_copies")
    asking_about("backlash", "end_stop", "cubic_spring", "coulomb_friction")
    made = api.simulate(
        {"mass": 1.0, "damping": 9.25, "stiffness": 654.4, "friction_coefficient": 0.0, "seed": 3, "rate": 1000.0,
         "effects": {"backlash": {"backlash_half_width": 2.96e-3}}, "experiment": {"name": "release", "duration": 4.0},
         "initial_position": 18.3e-3, "encoder": {"counts_per_metre": 0.0, "noise": 1e-5}}
    )  # fmt: skip
    record = Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)
    sprung, said = spring_decision.decide((record,), typical_plant(record))
    assert sprung and "for one unit of mass" in said and "of the force" not in said
    found = pipeline.diagnose([record])
    assert [cause.name for cause in found.causes] == ["backlash"] and (found.verdict == "explained") is copied
    assert found.extended.model["backlash_half_width"] == pytest.approx(2.96e-3, rel=0.01)


def test_a_force_that_never_changes_is_not_told_from_a_constant_one() -> None:
    """A quarter of a second after a step in the first line had "7.08e+16 ± 2.1e+15 N/m for one unit of mass"."""
    time = 0.005 * np.arange(50)
    still = from_samples(time, np.full(time.size, 8.0), np.zeros(time.size))
    moved = simulate(Plant(2.3, 6.0, 420.0) + DryFriction(0.35), still).position
    record = replace(still, position=moved + np.random.default_rng(2).normal(0.0, 3e-6, time.size))
    sprung, said = spring_decision.decide((record,), typical_plant(record))
    assert sprung and "one unit of mass" not in said and "; it carries " in said
    stiffness = float(said.split("its stiffness is ")[1].split()[0])
    assert stiffness == pytest.approx(420.0, rel=0.02)
    (features,) = prepare([record]).features
    assert features.route.startswith("The force never changes and nothing swings")


def test_a_spring_that_carries_little_beside_a_preload_is_told_so_in_a_part_of_a_record() -> None:
    """The force before the part is not known; the preload of 200 N counted as a step of it."""
    time = 0.005 * np.arange(2000)
    force = 200.0 + 4.0 * np.sin(7.0 * time) + 3.0 * np.sin(17.0 * time)
    still = from_samples(time, force, np.zeros(time.size))
    plant = Plant(2.0, 3.0, 40.0)
    moved = simulate(plant, still, initial_position=5.0).position
    part = replace(still, position=moved + 1e-5 * np.random.default_rng(3).standard_normal(time.size)).window(4.0, 10.0)
    _, said = spring_decision.decide((part,), typical_plant(part))
    share = float(said.split("; it carries ")[1].split()[0])
    travel = float(np.ptp(part.position))
    assert share == pytest.approx(100.0 * 40.0 * travel / float(np.ptp(part.force)), rel=0.1)


def test_measured_records(shared_data: Path) -> None:
    path = shared_data / "real" / "ecp2023_closed_loop.csv"
    if not path.exists():
        pytest.skip(f"no {path}")
    record = read(path, SourceOptions("effort_v", "encoder", force_unit="V", position_scale=1.7857e-5))
    found = pipeline.identify([record])
    assert 28.5 < found.refined.parameters["stiffness"].value < 30.5
    assert found.refined.see < 0.55e-3
    assert any("the force follows the readings (-27." in warning for warning in found.warnings)
    axis = pipeline.identify([read(shared_data / "emps" / "emps_train.csv")])
    assert axis.refined.model["stiffness"] == 0.0


def test_no_odds_for_a_spring_are_stated_where_none_is_assumed_against_them() -> None:
    """A pendulum that goes round: beside its error, the odds of a spring are of a model that is wrong anyway."""

    def pushed(t: float, angle: float, speed: float) -> float:
        return 4.5 * float(t < 1.0) - 4.5 * float(1.5 < t < 2.5)

    record = turned(pushed, 5.0, (0.18, 0.3, 3.7))
    sprung, said = spring_decision.decide((record,), typical_plant(record))
    assert not sprung and "as likely as none" not in said
    assert ", and without it the error is 1.1 times as large. If there is one, use --model spring." in said


def test_a_spring_that_does_what_gravity_would_is_seen_behind_it_and_gravity_is_none() -> None:
    """Half a radian of a spring, and a pendulum that goes round."""

    def pushed(t: float, angle: float, speed: float) -> float:
        return 0.6 * float(t % 2.0 < 1.0) - 0.3

    true = (0.18, 0.4, 3.7)
    spring = turned(pushed, 5.0, (*true[:2], 0.0), rest=lambda angle: -1.5 * angle)
    weight = turned(lambda t, _, __: 4.5 * float(t < 1.0), 4.0, true)
    said = [
        spring_decision.hidden_spring(fit(Plant(*true[:2], 0.0) + Gravity(2.0), one, fixed={"stiffness": 0.0}), (one,))
        for one in (spring, weight)
    ]
    assert "does what gravity would do: a spring is assumed" in said[0] and said[1] == ""


@COPIED
def test_a_spring_that_only_curved_friction_calls_for_is_taken_back(
    copied: bool, asking_about: Callable[..., None], request: pytest.FixtureRequest
) -> None:
    """Beside dry friction alone, friction that falls with speed looks like a weak spring."""
    if not copied:
        request.getfixturevalue("without_copies")
    asking_about("coulomb_friction", "stribeck_friction", "hysteresis")
    times, forces = np.array([0.0, 0.5, 2.0, 3.5]), np.array([0.0, 60.0, -60.0, 0.0])
    made = api.simulate(
        {"mass": 25.0, "damping": 45.0, "stiffness": 0.0, "friction_coefficient": 0.0, "seed": 3, "rate": 200.0,
         "effects": {"stribeck_friction": {"coulomb_force": 12.0, "static_force": 24.0, "stribeck_velocity": 0.05}},
         "duration": 4.0, "encoder": {"counts_per_metre": 0.0, "noise": 1e-5},
         "force_time": list(times), "force": list(forces)}
    )  # fmt: skip
    record = Record(time=made.time, position=made.position, force_time=times, force=forces)
    first = spring_decision.has_spring(prepare([record]), pipeline.Options())
    assert first.sprung and first.doubtful and "beyond doubt" not in first.said[0]
    found = pipeline.diagnose([record])
    assert [cause.name for cause in found.causes] == ["stribeck_friction"] and (found.verdict == "explained") is copied
    assert found.extended.model["stiffness"] == 0.0
    (said,) = (one for one in found.warnings if "spring" in one)
    assert said.startswith(
        "No response shows a spring, and none is assumed: beside the causes that a diagnosis finds, "
    )
    assert said.endswith(" (95 %). If there is one, use --model spring.")


@pytest.mark.parametrize(("missing", "seen", "needless"), [
    ((0.09, 0.11), True, True), ((0.09, 0.11), False, False), ((0.05, 0.08), True, False),
])  # fmt: skip
def test_a_spring_that_may_be_the_missing_force_is_not_assumed(
    missing: tuple[float, float], seen: bool, needless: bool
) -> None:
    """A cart under a controller was given 4.9 ± 3.2 V/m, and a mass a third too large, beside a force of that size."""
    found = SimpleNamespace(quantities={"stiffness": Quantity(4.9, 1.6, "V/m")})
    remainder = Remainder(missing[0], (0.5 * missing[0], missing[1]), 11.0, 1.2, True)
    left = Remainders(remainder, remainder, "applied force", 0.85, "V", 0.02, 0.01)
    said = spring_decision.needless_spring(cast(Any, found), left if seen else None)
    assert (said != "") is needless
    if needless:
        assert said.endswith(
            "it would carry 0.098 V rms, and a force of 0.045 to 0.11 V rms was still missing. If there is one, use "
            "--model spring."
        )


@pytest.mark.parametrize(
    ("law", "see", "beside", "left", "without"),
    [
        (None, 0.9, False, 1.0, True),
        (None, 2.5, False, 1.0, False),
        (PeriodicDisturbance(1.0, 2.0, 0.1), 0.9, False, 1.0, False),
        (PeriodicDisturbance(1.0, 2.0, 0.1), 0.9, False, 50.0, True),
        (PeriodicDisturbance(1.0, 2.0, 0.1), 0.9, True, 1.0, True),
        (PeriodicDisturbance(1.0, 2.0, 0.1), 0.4, False, 1.0, True),
        (Gravity(2.0), 0.1, False, 1.0, False),
    ],
    ids=["nothing", "a large error", "a tone", "a tone, and half of the motion left with a spring",
         "a tone beside the spring too", "a tone that leaves far less", "gravity"],
)  # fmt: skip
def test_a_spring_is_not_given_up_for_a_law_that_moves_the_mass(
    law: Effect | None, see: float, beside: bool, left: float, without: bool
) -> None:
    """An arm whose servo is switched off falls by itself: without a spring nothing but a tone was left to move it.

    ``see`` is that without a spring over that with one, ``left`` what the spring leaves of the motion [%].
    """
    free, sprung = Plant(1.0, 2.0, 0.0), Plant(1.0, 2.0, 10.0)
    models = (free if law is None else free + law), (sprung + law if beside and law is not None else sprung)
    rest = SimpleNamespace(extended=SimpleNamespace(motion_percent=left))
    found = [
        SimpleNamespace(extended=SimpleNamespace(model=model, see=one), left=rest)
        for model, one in zip(models, (see, 1.0), strict=True)
    ]
    assert _does_without(cast(Any, found[0]), cast(Any, found[1])) is without


@pytest.mark.parametrize(
    ("plant", "sprung", "said"),
    [
        (Plant(2.0, 5.0, 200.0), True, "a spring is assumed. If there is none, use --model no_spring."),
        (
            Plant(2.0, 5.0, 0.0),
            False,
            "which needs no spring, and none is assumed. If there is one, use --model spring.",
        ),
        (Plant(2.0, 5.0, 40.0), False, "none is assumed"),
    ],
    ids=["a stiff spring", "none", "one that carries less than the inertia"],
)
def test_under_a_single_tone_the_phase_decides(plant: Plant, sprung: bool, said: str) -> None:
    """A drive under a sine (public record) had a spring of 116 % of its force, and six times its mass."""
    time = np.arange(0.0, 30.0, 0.01)
    asked = from_samples(time, 10.0 * np.sin(2.0 * math.pi * time), np.zeros(time.size), hold="linear")
    record = replace(asked, position=simulate(plant, asked).position)
    found = spring_decision.by_tone((record,))
    assert found is not None and found.sprung is sprung and not found.doubtful
    assert said in found.said[0] and "a single tone of 1 Hz with k - m·omega² = " in found.said[0]
    turned_angle = spring_decision.by_tone((replace(record, position_unit="rad"),))
    assert turned_angle is not None
    assert ("a weight over the axis of a joint would do what mass does" in turned_angle.said[0]) is not sprung
    steps = replace(asked, force=np.sign(asked.force))
    assert spring_decision.by_tone((replace(steps, position=simulate(plant, steps).position),)) is None


def test_a_shaft_that_turns_many_times_is_on_no_spring() -> None:
    """A motor's axis (public record) that turned 470 times one way had a spring that carried 53 % of the torque."""
    time = np.arange(0.0, 20.0, 0.01)
    asked = from_samples(time, np.where(time < 12.0, 1.0, 0.2), np.zeros(time.size))
    record = replace(asked, position=simulate(Plant(0.05, 0.05, 0.0), asked).position)
    assert np.ptp(record.position) > 40.0 * math.pi
    joint = prepare([replace(record, position_unit="rad", force_unit="N·m")])
    decision = spring_decision.has_spring(joint, pipeline.Options())
    assert not decision.sprung and not decision.doubtful
    turns = np.ptp(record.position) / (2.0 * math.pi)
    assert decision.said == (
        f"The joint turns {turns:.0f} times, as no spring does: none is assumed. If there is one, use --model spring.",
    )
    few = replace(record, position=0.1 * record.position, position_unit="rad", force_unit="N·m")
    assert "The joint turns" not in " ".join(spring_decision.has_spring(prepare([few]), pipeline.Options()).said)
