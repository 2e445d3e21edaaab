"""The contract that every effect of the library keeps."""

from __future__ import annotations

import inspect
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from effect_examples import EXAMPLES, example, model, neutral, plant, record, silent

from msd_ident.errors import UsageError
from msd_ident.model import Effect, Simulator, simulate
from msd_ident.model.effects import ARGUMENTS, LIBRARY, by_name, spoken, structural
from msd_ident.model.effects.law import COMMAND_LOOP, DELAY, KINDS, LAG, PLAY, SECOND_MASS, STRUCTURAL
from msd_ident.model.parameters import FORCES
from msd_ident.model.plant import PLANT_PARAMETERS

NAMES = tuple(effect.name for effect in LIBRARY)
#: Other laws of a cause that do not hold its simple law, or only where a value of theirs is 0 or infinite and another
#: one means nothing.
NOT_AT_ONCE = {
    "cogging_harmonic", "drive_hysteresis", "eccentricity_harmonic", "fading_damping", "force_dead_zone",
    "force_gain_asymmetry", "modulated_disturbance", "one_sided_stop", "settling_sensor", "settling_stiffness",
    "smooth_friction", "smooth_friction_turn", "smooth_stribeck_friction", "two_tone_disturbance",
}  # fmt: skip


def spread(values: np.ndarray) -> float:
    """Range of a signal."""
    return float(np.ptp(values))


def test_library_is_complete_and_each_effect_is_a_file() -> None:
    differ = set(NAMES) ^ set(EXAMPLES)
    assert not differ, f"{differ} stands in the library or in EXAMPLES of effect_examples.py alone"
    assert list(NAMES) == sorted(NAMES)
    for effect in LIBRARY:
        assert effect.__module__.endswith(f".{effect.name}"), "an effect's name is that of its file"


@pytest.mark.parametrize("name", NAMES)
def test_says_what_it_is(name: str) -> None:
    effect = by_name(name)
    assert effect.acts_on in ("force", "input", "sensor")
    assert effect.law and effect.source and effect.__doc__
    own = {parameter.name for parameter in effect.parameters}
    assert own == set(EXAMPLES[name])
    assert {parameter for parameter, _ in effect.neutral} <= own
    for parameter in effect.parameters:
        assert parameter.symbol and parameter.meaning and parameter.lower < parameter.upper
    assert set(effect.laws()) <= {*KINDS, *(f"reversal_{name}" for name, _ in effect.memory)}


@pytest.mark.parametrize("name", NAMES)
def test_says_of_its_own_parameters_alone(name: str) -> None:
    effect = by_name(name)
    own = {parameter.name for parameter in effect.parameters}
    named = {effect.dry_limit, effect.limits_force, *(p.not_below for p in effect.parameters)}
    assert named | set(effect.harmonic.names if effect.harmonic else ()) <= own | {""}
    assert effect.laws() or effect.knee or effect.structure, "nothing of it would act"
    for parameter in effect.parameters:
        signals = {"direction", "v", "x", "driven"}
        assert parameter.regressor is None or set(inspect.signature(parameter.regressor).parameters) <= signals | own
        assert parameter.ceiling is None or parameter.ceiling(10.0, 0.01) > 0.0


@pytest.mark.parametrize("name", NAMES)
def test_laws_use_nothing_but_their_arguments_and_math(name: str) -> None:
    """Exports copy the source of a law, and of nothing beside it."""
    for kind, law in by_name(name).laws().items():
        others = set(inspect.getclosurevars(law).globals) - {"math"}
        assert not others, f"{kind} of {name} uses {others} of its module, which exported files do not have"


def test_memory_names_are_those_of_one_effect() -> None:
    taken = {*ARGUMENTS, *(p.name for p in PLANT_PARAMETERS)} | {p.name for e in LIBRARY for p in e.parameters}
    for effect in LIBRARY:
        for name, _ in effect.memory:
            assert name not in taken, f"{effect.name} remembers {name}, which is a name of something else too"
            taken.add(name)
            assert f"reversal_{name}" in effect.laws(), f"{effect.name} does not say what {name} becomes at a reversal"


@pytest.mark.parametrize("role", [PLAY, LAG, DELAY, SECOND_MASS, COMMAND_LOOP])
def test_each_part_of_the_structure_is_one_effect_and_its_forms(role: str) -> None:
    having = [effect for effect in LIBRARY if effect.structure == role]
    (first,) = (effect for effect in having if not effect.laws())
    assert structural(role) is first and len(first.parameters) == STRUCTURAL[role]
    for effect in having:
        assert effect.parameters[: STRUCTURAL[role]] == first.parameters
        assert model(effect.name).structure(role) == example(effect.name).values[: STRUCTURAL[role]]
    assert plant().structure(role) == ()


@pytest.mark.parametrize("name", [effect.name for effect in LIBRARY if effect.dry_limit])
def test_starts_from_dry_friction_where_that_is_its_limit(name: str) -> None:
    begun = by_name(name).from_dry_friction(0.3, record(), plant())
    assert begun and all(getattr(start, by_name(name).dry_limit) <= 0.3 for start in begun)


def test_a_parameter_name_means_one_thing() -> None:
    meaning = {parameter.name: parameter for parameter in PLANT_PARAMETERS}
    for effect in LIBRARY:
        for parameter in effect.parameters:
            known = meaning.setdefault(parameter.name, parameter)
            assert known == parameter, f"{effect.name}: another effect or the plant says otherwise of {parameter.name}"


@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize("name", NAMES)
def test_zero_strength_is_the_plain_plant(name: str, hold: str) -> None:
    measured = record(hold=hold)
    plain = simulate(plant(), measured).position
    zero = simulate(plant() + neutral(name), measured).position
    assert np.max(np.abs(zero - plain)) <= 1e-12 * spread(plain), "neutral does not make the effect vanish"
    moved = np.max(np.abs(simulate(model(name), measured).position - plain))
    assert moved > 1e-4 * spread(plain), "the example hardly moves the plant: make it stronger"


@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize("name", NAMES)
def test_small_strength_is_near_the_plain_plant(name: str, hold: str) -> None:
    """An effect fades out; it does not jump when its strength reaches zero."""
    measured = record(hold=hold)
    full, none = EXAMPLES[name], dict(by_name(name).neutral)
    fading = {k: v if k not in none or math.isinf(none[k]) else 1e-6 * v for k, v in full.items()}
    if name == "force_gain_nonlinearity":
        fading["force_limit"] = math.inf
    plain = simulate(plant(), measured).position
    faded = simulate(plant() + by_name(name)(**fading), measured).position
    left = np.max(np.abs(faded - plain)) / spread(plain)
    assert left <= 1e-5, "a millionth of the example's strength still shows"


def length_power(unit: str) -> int:
    """How often a unit holds a length: N counts one, as kg·m/s² does."""
    power = 0
    for part, sign in ((unit.partition("/")[0], 1), (unit.partition("/")[2], -1)):
        for symbol, exponent in re.findall(r"(kg|rad|[mNs1])([²³]?)", part):
            if symbol in ("m", "N"):
                power += sign * {"": 1, "²": 2, "³": 3}[exponent]
    return power


@pytest.mark.parametrize("hold", ["zero", "linear"])
@pytest.mark.parametrize("name", [name for name in NAMES if not by_name(name).angular])
def test_millimetres_and_metres_give_the_same_motion(name: str, hold: str) -> None:
    whole, measured = model(name), record(hold=hold)
    factor = {p.name: 1000.0 ** length_power(p.unit) for p in whole.parameters}
    small = whole.with_values({n: whole[n] * factor[n] for n in whole.names})
    metres = simulate(whole, measured, 0.004, -0.03)
    millimetres = simulate(small, replace(measured, force=1000.0 * measured.force), 4.0, -30.0)
    apart = np.max(np.abs(1e-3 * millimetres.position - metres.position))
    assert apart <= 1e-7 * spread(metres.position), "a parameter's unit does not fit the law"


@pytest.mark.parametrize("name", [effect.name for effect in LIBRARY if effect.dissipative])
def test_dissipative_effects_never_add_energy(name: str) -> None:
    for whole in (model(name), model(name).with_values({"damping": 0.0})):
        free = simulate(whole, silent(), 0.03, 0.2)
        energy = 0.5 * whole["mass"] * free.velocity**2 + 0.5 * whole["stiffness"] * free.position**2
        assert np.max(np.diff(energy)) <= 1e-9 * energy[0]
        assert energy[-1] < 0.95 * energy[0]


def test_conservative_springs_keep_energy() -> None:
    """Springs of any shape give back what they take; the clock of the solver does not add or remove any."""
    potential = {
        "cubic_spring": lambda x: 0.25 * 2e5 * x**4,
        "asymmetric_spring": lambda x: 4e3 * x**3 / 3.0,
        "end_stop": lambda x: 0.5 * 5e3 * np.maximum(np.abs(x) - 0.018, 0.0) ** 2,
        "cogging": lambda x: -0.3 * 0.01 / (2 * np.pi) * np.cos(2 * np.pi * x / 0.01 + 0.4),
    }
    for name, extra in potential.items():
        whole = model(name).with_values({"damping": 0.0})
        free = simulate(whole, silent(), 0.03, 0.0)
        energy = 0.5 * whole["mass"] * free.velocity**2 + 0.5 * whole["stiffness"] * free.position**2
        energy = energy + extra(free.position)
        assert np.max(np.abs(energy - energy[0])) <= 2e-6 * energy[0], name


def turned(effect: Effect) -> float:
    measured = record()
    there = simulate(plant() + effect, measured, 0.004, -0.03).position
    back = simulate(plant() + effect, replace(measured, force=-measured.force), -0.004, 0.03).position
    return float(np.max(np.abs(there + back))) / spread(there)


@pytest.mark.parametrize("name", NAMES)
def test_mirror_symmetry_where_the_law_has_it(name: str) -> None:
    if by_name(name).mirror:
        assert turned(example(name)) <= 1e-8, "mirror is set, and the turned motion is another one"
    else:
        assert turned(example(name)) > 1e-4, "mirror is not set, and the turned motion is the same"


@pytest.mark.parametrize("name", NAMES)
def test_a_later_clock_moves_only_what_knows_the_time(name: str) -> None:
    now, later = record(), record(start=7.0)
    here = simulate(model(name), now, 0.004, -0.03).position
    there = simulate(model(name), later, 0.004, -0.03).position
    difference = float(np.max(np.abs(there - here))) / spread(here)
    if by_name(name).steady:
        assert difference <= 2e-7, "steady is set, and the motion depends on the time"
    else:
        assert difference > 1e-4, "steady is not set, and the motion does not depend on the time"


@pytest.mark.parametrize("name", NAMES)
def test_many_at_once_are_the_same_numbers(name: str) -> None:
    whole = model(name)
    simulator = Simulator(whole, record())
    rows = whole.values * np.array([[1.0], [1.01], [0.98]])
    many = simulator.positions_many(rows, [0.0, 0.001, 0.002], [0.0, 0.1, -0.1])
    for i, (x, v) in enumerate(((0.0, 0.0), (0.001, 0.1), (0.002, -0.1))):
        assert np.array_equal(many[i], simulator.positions(rows[i], x, v))


@pytest.mark.parametrize("name", NAMES)
def test_guesses_are_usable_starts(name: str) -> None:
    whole, measured = model(name), record(rate=500.0)
    seen = replace(measured, position=simulate(whole, measured).position)
    guesses = by_name(name).guess(seen, plant())
    assert guesses
    for guess in guesses:
        assert isinstance(guess, by_name(name))
        moved = simulate(plant() + guess, seen).position
        assert np.all(np.isfinite(moved))
        assert not np.array_equal(moved, simulate(plant(), seen).position)


@pytest.mark.parametrize("name", [effect.name for effect in LIBRARY if effect.form_of])
def test_a_law_that_holds_its_simple_one_is_begun_there_too(name: str) -> None:
    """So a fit of it never leaves more than that of the simple law."""
    simple = example(by_name(name).form_of)
    seen = replace(record(), position=simulate(plant() + simple, record()).position)
    known = seen.position
    starts = by_name(name).from_simple(simple, seen, plant())
    nearest = min(spread(simulate(plant() + start, seen).position - known) for start in starts)
    assert (nearest < 1e-4 * spread(known)) == (name not in NOT_AT_ONCE), "name every law that is not begun there"


@pytest.mark.parametrize("name", NAMES)
def test_neighbours_are_other_effects_of_the_kind(name: str) -> None:
    """A backlash has some, a friction with its peak none, nor has anything of zero strength."""
    effect = by_name(name)(**EXAMPLES[name])
    others = effect.neighbours([record()])
    assert all(type(other) is type(effect) and other != effect for other in others)
    assert bool(others) == (name == "backlash"), "name here every effect whose example has neighbours"
    assert not by_name(name).from_values(EXAMPLES[name] | dict(effect.neutral)).neighbours([record()])


def test_a_friction_without_its_peak_has_one_begun_anew() -> None:
    flat = by_name("stribeck_friction")(coulomb_force=0.4, static_force=0.1, stribeck_velocity=0.02)
    peaks = flat.neighbours([record()])
    assert peaks
    for peak in peaks:
        values = dict(zip((p.name for p in peak.parameters), peak.values, strict=True))
        assert values["coulomb_force"] == 0.4
        assert values["static_force"] > 0.4
        assert not peak.neighbours([record()])


@pytest.mark.parametrize("name", NAMES)
def test_values_outside_their_bounds_are_refused_in_words(name: str) -> None:
    effect = by_name(name)
    for parameter in effect.parameters:
        wrong = {**EXAMPLES[name], parameter.name: math.nan}
        with pytest.raises(UsageError, match=rf"{name}: {parameter.name} is nan .*; expected "):
            effect(**wrong)
        if not math.isinf(parameter.lower):
            with pytest.raises(UsageError, match=f"{name}: {parameter.name} is "):
                effect(**{**EXAMPLES[name], parameter.name: parameter.lower - 1.0})


def test_what_depends_on_the_place_says_so() -> None:
    """Moved along a plant without a spring, with its start, the motion moves with it unless a force knows the place."""
    measured = record(duration=0.5)
    for name in NAMES:
        effect = by_name(name)
        if effect.needs_spring or effect.acts_on != "force":
            continue
        loose = model(name).with_values({"stiffness": 0.0})
        paths = np.stack([simulate(loose, measured, start, 0.0).position - start for start in (0.001, 0.0025)])
        here, there = paths[:, np.all(np.isfinite(paths), axis=0)]
        knows, says = np.max(np.abs(here - there)) > 1e-6 * spread(here), effect.placed() or name == "backlash"
        assert knows == says, f"{name}: placed() is {says}, and {knows} is what its motion says"


def test_what_is_a_curve_over_the_position_is_a_spring() -> None:
    """Held at rest anywhere, a spring pushes; what moves without one has no other place to go back to."""
    springs = {name for name in NAMES if by_name(name).is_spring()}
    assert springs >= {
        "asymmetric_spring",
        "backlash",
        "bilinear_spring",
        "cogging",
        "cubic_spring",
        "end_stop",
        "gravity",
    }
    assert {by_name(form).cause() for form in springs} <= springs, "every law of a spring's cause is one"
    for other in ("force_offset", "hysteresis", "stiffness_drift", "load_dependent_friction", "second_mode"):
        assert other not in springs, "it knows more than the position, or nothing of it"


def test_two_curves_bend_alike_only_both_in_the_spring_in_the_sensor_or_on_the_way_of_the_force() -> None:
    scales = {name for name in NAMES if by_name(name).is_scale()}
    assert scales >= {"sensor_eccentricity", "eccentricity_harmonic", "sensor_nonlinearity"}
    assert scales.isdisjoint({"sensor_drift", "scale_drift", "settling_sensor", "cubic_spring", "time_offset"})
    pairs = {
        ("cubic_spring", "end_stop"): True, ("sensor_eccentricity", "sensor_nonlinearity"): True,
        ("cubic_spring", "sensor_nonlinearity"): False, ("cubic_spring", "quadratic_drag"): False,
        ("time_offset", "frame_compliance"): True, ("actuator_lag", "time_offset"): True,
        ("actuator_lag", "drive_hysteresis"): False, ("time_offset", "sensor_nonlinearity"): False,
    }  # fmt: skip
    for (one, other), alike in pairs.items():
        assert by_name(one).bends_as(by_name(other)) is by_name(other).bends_as(by_name(one)) is alike


def test_forces_on_the_mass_are_known_up_to_the_gain_of_the_force_signal() -> None:
    assert {"mass", "damping", "stiffness", "coulomb_force", "bend_stiffness", "upper_sideband_amplitude"} <= FORCES
    assert FORCES.isdisjoint({"dead_zone", "force_limit", "lag_time", "disturbance_frequency", "eccentricity"})


@pytest.mark.parametrize("name", [effect.name for effect in LIBRARY if effect.acts_on == "input"])
def test_a_law_that_keeps_the_gain_passes_some_changes_of_the_command_on_as_they_are(name: str) -> None:
    effect = example(name)
    if "input_map" not in effect.laws():
        return
    commands = np.linspace(-20.0, 20.0, 4001)
    force = np.array([effect.pushes(float(u), 1.0) for u in commands])
    assert effect.keeps_gain() is bool(np.any(np.isclose(np.diff(force), np.diff(commands), rtol=1e-6, atol=0.0)))


@pytest.mark.parametrize("name", NAMES)
def test_its_name_is_spoken_with_all_its_letters(name: str) -> None:
    """A person's name takes the place of itself alone: "Stribecktribeck" stood in a verdict."""
    assert spoken(name).replace(" ", "").replace("-", "").lower() == name.replace("_", "")
