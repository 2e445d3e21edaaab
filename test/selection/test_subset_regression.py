"""Sets of causes that the equation of motion calls for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from setrigs import BASE

from msd_ident.data.record import Record
from msd_ident.estimate.problem import Initial
from msd_ident.model import Effect
from msd_ident.model.effects import by_name
from msd_ident.residuals.noise_model import prepare
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Causes, Hypothesis
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.structure_search import Search
from msd_ident.selection.subset_regression import likely, parted, strengths
from msd_ident.workflow import pipeline
from msd_sim.rig import Rig
from msd_sim.truth import Truth

#: Four faults of a rig at once; alone, none of them explains a tenth of what is missing.
FOUR = {
    "backlash": {"backlash_half_width": 3e-4},
    "cogging": {"cogging_amplitude": 0.15, "cogging_pitch": 0.004, "cogging_phase": 1.0},
    "quadratic_drag": {"drag_coefficient": 8.0},
    "stiffness_drift": {"stiffness_drift_rate": 0.006},
}


def measured(effects: dict[str, dict[str, float]], hold: str = "zero", rate: float = 250.0) -> Record:
    """Steps of many sizes on a rig of msd_sim with these effects, read with a noise of 2 µm."""
    time = np.arange(int(6.0 * rate)) / rate
    levels = 8.0 * np.random.default_rng(5).uniform(-1.0, 1.0, 13)
    levels[0] = 0.0
    force = levels[np.minimum((time / time[-1] * 13).astype(int), 12)]
    rig = Rig(Truth(1.0, 2.0, 400.0, effects), 0.0, 0.0, 0.0, hold)
    rig.drive(time, force)
    position = rig.sample(time).position
    return Record(time, position + np.random.default_rng(6).normal(0.0, 2e-6, time.size), time, force, hold=hold)


def posed(record: Record) -> tuple[Experiment, Hypothesis]:
    """The experiment, and its base model as it was fitted."""
    experiment = Experiment(prepare([record]), BASE, frozenset())
    return experiment, refine(experiment, frozenset(), BASE, (Initial(),))


def names(*found: str) -> Causes:
    """A set."""
    return frozenset(found)


@pytest.mark.parametrize("hold", ["zero", "linear"])
def test_all_causes_are_found_at_once(hold: str) -> None:
    found = likely(*posed(measured(FOUR, hold)))
    of_four = [one for one in found if len(one.causes) == 4]
    assert of_four[0].causes == set(FOUR)
    model = of_four[0].model
    assert model.mass == pytest.approx(1.0, rel=0.03) and model.stiffness == pytest.approx(400.0, rel=0.03)
    assert model["drag_coefficient"] == pytest.approx(8.0, rel=0.3)
    assert model["stiffness_drift_rate"] == pytest.approx(0.006, rel=0.3)


def test_a_search_finds_what_no_cause_shows_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the base model, by nothing but the regression: no neighbour of a set is fitted."""
    experiment, base = posed(measured(FOUR))
    monkeypatch.setattr(Search, "_fit_new", lambda search, new, start, end: None)
    search = Search(experiment, lambda one: one.chi < 1.1 * experiment.evidence, lambda stage, part, cause: None)
    found = search.run(base).best
    assert found.causes == set(FOUR) and found.chi < 1.1 * experiment.evidence


@pytest.mark.long
def test_a_diagnosis_names_what_no_cause_shows_alone() -> None:
    """Without the regression drag alone is named, with 0.84, and 233 of 577 noise floors are left."""
    found = pipeline.diagnose([measured(FOUR, rate=500.0)])
    assert {cause.name for cause in found.causes} == set(FOUR)
    assert all(cause.probability > 0.9 for cause in found.causes)
    assert found.adequacy.ratio < 1.1


#: A second mass, whose force is a filter of the motion, beside two laws of place and speed.
HUNG = {
    "second_mode": {"second_mass": 0.15, "second_stiffness": 0.15 * 50.0**2, "second_damping": 0.5},
    "quadratic_drag": {"drag_coefficient": 8.0},
    "cubic_spring": {"cubic_stiffness": 4e5},
}


def test_a_second_mass_is_a_column_whatever_its_frequency() -> None:
    """The columns are those of a grid of frequencies: a fit from the nearest of them ends at the truth."""
    experiment, base = posed(measured(HUNG))
    start = next(one for one in likely(experiment, base) if one.causes == set(HUNG))
    found = refine(experiment, start.causes, start.model, start.initial)
    assert found.chi < 1.1 * experiment.evidence
    assert found.model["second_mass"] == pytest.approx(0.15, rel=0.01)
    assert found.model.mass == pytest.approx(1.0, rel=0.01)


def test_laws_that_are_mistaken_for_others_are_columns_too() -> None:
    """A sensor that bends is tried by itself only where another law stands for it; beside a bent spring it may be."""
    record = measured({"cubic_spring": {"cubic_stiffness": 4e5}, "quadratic_drag": {"drag_coefficient": 8.0}})
    x = record.position
    bent = replace(record, position=x * (1.0 - 1.5 * x + 60.0 * x**2))
    found = next(one for one in likely(*posed(bent)) if len(one.causes) == 3)
    assert found.causes == {"cubic_spring", "quadratic_drag", "sensor_nonlinearity"}
    sensor = found.model.effect("sensor_nonlinearity")
    assert sensor.values == pytest.approx((-1.5, 60.0), rel=0.3)


def test_laws_are_begun_from_what_a_known_set_leaves() -> None:
    """Beside three stronger laws the base model's residual does not show the tone."""
    tone = {"disturbance_amplitude": 0.05, "disturbance_frequency": 31.0, "disturbance_phase": 0.4}
    strong = {name: FOUR[name] for name in ("backlash", "quadratic_drag", "stiffness_drift")}
    experiment, base = posed(measured({**strong, "periodic_disturbance": tone}))
    model = BASE
    for name, values in strong.items():
        model = model + by_name(name).from_values(values)
    known = refine(experiment, frozenset(strong), model, (Initial(),))
    found = [one for one in likely(experiment, base, [known]) if one.causes == {*strong, "periodic_disturbance"}]
    assert found and found[0].left == min(one.left for one in likely(experiment, base, [known]) if len(one.causes) == 4)
    assert found[0].model["disturbance_frequency"] == pytest.approx(31.0, rel=0.02)


def test_a_cart_that_rests_calls_for_nothing() -> None:
    time = np.arange(600) / 500.0
    still = Record(time, np.where(time > 1.19, 1e-4, 0.0), time, np.where(time > 1.19, 1.0, 0.0))
    assert likely(*posed(still)) == []


def test_columns_of_one_direction_and_of_none_are_borne() -> None:
    """Two laws may be one on this motion, and one of them may do nothing."""
    experiment, base = posed(measured(FOUR))
    twice = [BASE + by_name("cubic_spring")(1e5), BASE + by_name("end_stop")(1.0, 900.0)]
    known = [refine(experiment, frozenset(model.effect_names), model, (Initial(),)) for model in twice]
    assert likely(experiment, base, [*known, *known])


def test_each_set_comes_once_and_those_that_leave_least_come_first() -> None:
    found = likely(*posed(measured(FOUR)))
    assert len({one.causes for one in found}) == len(found) > 5
    assert [one.left for one in found] == sorted(one.left for one in found)
    assert all(0.0 <= one.left <= 1.0 and len(one.causes) > 1 for one in found)


def test_no_law_has_a_strength_beyond_its_bounds() -> None:
    """Friction that pushes the cart on, or a spring that grows softer the more it bends, is not what these laws say."""
    for one in likely(
        *posed(measured({"coulomb_friction": {"coulomb_force": 0.2}, "cubic_spring": {"cubic_stiffness": 4e5}}))
    ):
        for effect in one.model.effects:
            assert strengths(effect), f"{effect.name} does nothing"


def test_values_of_known_sets_are_tried_too() -> None:
    """A stop is found where a fitted set has it, and not where the search would begin it."""
    record = measured({"end_stop": {"stop_position": 0.011, "stop_stiffness": 900.0}, **FOUR})
    experiment, base = posed(record)
    stop = by_name("end_stop").from_values({"stop_position": 0.011, "stop_stiffness": 900.0})
    known = refine(experiment, names("end_stop"), BASE + stop, (Initial(),))
    with_it = [one for one in likely(experiment, base, [known]) if "end_stop" in one.causes]
    assert with_it[0].left < likely(experiment, base)[0].left


@pytest.mark.parametrize(
    ("effect", "parts"),
    [
        (by_name("cubic_spring")(1e5), 1),
        (by_name("sensor_nonlinearity")(2.0, -60.0), 2),
        (by_name("sensor_nonlinearity")(0.0, -60.0), 1),
        (by_name("position_dependent_gain")(2.0, -300.0), 2),
        (by_name("cogging")(0.3, 0.01, 0.4), 1),
    ],
)
def test_a_law_of_several_strengths_has_a_column_for_each(effect: Effect, parts: int) -> None:
    found = parted(effect)
    assert len(found) == parts and all(len(strengths(one)) == 1 for one in found)


def test_where_no_law_in_question_has_a_column_there_are_no_sets(asking_about: Callable[..., None]) -> None:
    """A diagnosis that was asked about hysteresis alone ended in an error of numpy."""
    record = measured({"quadratic_drag": {"drag_coefficient": 8.0}}, rate=100.0)
    experiment, base = posed(record)
    assert likely(replace(experiment, asked=frozenset({"hysteresis"})), base) == []
    asking_about("hysteresis")
    assert not {cause.name for cause in pipeline.diagnose([record]).causes} - {"hysteresis"}
