"""diagnose_records: contract, progress, cancelling, identities, free decay, several records, oddities."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from msd_ident.data.quality.finding import warning
from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis, Task, diagnose_records
from msd_ident.diagnosis.pipeline import not_said
from msd_ident.errors import UsageError
from msd_ident.estimate import fit
from msd_ident.model import Plant
from msd_ident.model.base_model import DryFriction
from msd_ident.selection import naming, structure_search
from msd_ident.selection.cross_validation import HeldOut
from msd_sim import lottery
from msd_sim.api import simulate

RIG = {"mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0}
ENCODER = {"counts_per_metre": 100000.0, "noise": 0.0}
STEPS = {"name": "steps", "force": 8.0, "hold": 0.6}


def measured(effects: Mapping[str, Mapping[str, float]], **more: Any) -> Record:
    made = simulate({**RIG, "encoder": ENCODER, "experiment": STEPS, "effects": effects, **more})
    return Record(made.time, made.position, made.force_time, made.force)


@pytest.fixture(scope="module")
def rubbing() -> Diagnosis:
    return diagnose_records(Task((measured({"coulomb_friction": {"coulomb_force": 0.15}}),)))


def test_the_contract(rubbing: Diagnosis) -> None:
    found = json.loads(json.dumps(rubbing.to_json_dict()))
    assert found["schema"] == "msd.diagnosis/2"
    assert found["verdict"] == "explained"
    cause = found["causes"][0]
    assert cause["name"] == "coulomb_friction" and cause["tied_with"] == []
    assert cause["probability"] > 0.99
    assert cause["parameters"]["coulomb_force"]["value"] == pytest.approx(0.15, rel=0.01)
    assert cause["parameters"]["coulomb_force"]["unit"] == "N"
    assert set(found["base"]["parameters"]) == {"mass", "damping", "stiffness"}
    assert set(found["extended"]["parameters"]) == {"mass", "damping", "stiffness", "coulomb_force"}
    gain = found["gain"]
    assert gain["heldout_see_extended_m"] < gain["heldout_see_base_m"]
    low, high = gain["interval_percent"]
    assert low <= gain["heldout_reduction_percent"] <= high
    assert found["noise_floor_m"] == pytest.approx(1e-5 / np.sqrt(12.0), rel=0.2)
    assert found["next_experiment"] is None


def test_the_extended_model_has_the_rigs_numbers(rubbing: Diagnosis) -> None:
    for name in ("mass", "damping", "stiffness"):
        quantity = rubbing.extended.quantities[name]
        assert abs(quantity.value / RIG[name] - 1.0) < 0.005
    assert rubbing.adequacy.ratio < 1.2 < rubbing.base_adequacy.ratio
    assert rubbing.summary.startswith("The model lacks Coulomb friction")


def test_an_unknown_gain_is_told_once() -> None:
    """The sentence stood there twice, with two lists, where the extended model leaves all parameters open."""
    record = replace(measured({"coulomb_friction": {"coulomb_force": 0.15}}), force_unit="V")
    plain = fit(Plant(1.0, 2.0, 600.0), [record])
    rubbed = fit(plain.model + DryFriction(0.1), [record])
    assert len(plain.open_directions) == len(rubbed.open_directions) == 1
    assert plain.open_directions != rubbed.open_directions and "gain in newtons is unknown" in plain.open_directions[0]
    assert not_said((*plain.open_directions, "mass is open"), rubbed.open_directions) == ("mass is open",)
    assert not_said(plain.open_directions, ()) == plain.open_directions
    lever = replace(record, force_unit="N", position_unit="rad")
    plain, rubbed = fit(plain.model, [lever]), fit(rubbed.model, [lever])
    assert plain.open_directions != rubbed.open_directions
    assert not_said(plain.open_directions, rubbed.open_directions) == ()


def test_clean_data_is_adequate_and_nothing_is_searched() -> None:
    tried: list[str] = []
    found = diagnose_records(Task((measured({}),)), progress=lambda stage, fraction, cause: tried.append(cause))
    assert found.verdict == "adequate" and found.causes == ()
    assert not any(tried)
    assert "enough" in found.summary


def test_progress_rises_and_names_causes(asking_about: Callable[..., None]) -> None:
    asking_about("quadratic_drag", "backlash", "second_mode")
    seen: list[tuple[str, float, str]] = []
    diagnose_records(
        Task((measured({"quadratic_drag": {"drag_coefficient": 3.0}}),)), progress=lambda *told: seen.append(told)
    )
    fractions = [fraction for _, fraction, _ in seen]
    assert fractions == sorted(fractions) and 0.9 < fractions[-1] <= 1.0  # the pipeline says when all is done
    assert {"quadratic_drag", "backlash", "second_mode"} <= {cause for _, _, cause in seen}


def test_what_progress_raises_ends_it() -> None:
    class Cancelled(Exception):
        pass

    def cancel(stage: str, fraction: float, cause: str) -> None:
        if cause:
            raise Cancelled

    with pytest.raises(Cancelled):
        diagnose_records(Task((measured({"quadratic_drag": {"drag_coefficient": 3.0}}),)), progress=cancel)


def test_offset_beside_friction_is_said_to_be_asymmetric_friction(asking_about: Callable[..., None]) -> None:
    """Known zero or bent spring apart, an offset with a linear spring is only a zero; on a plain axis it is seen."""
    asking_about("coulomb_friction", "force_offset", "quadratic_drag", "stribeck_friction")
    record = measured(
        {"coulomb_friction": {"coulomb_force": 0.5}, "force_offset": {"offset_force": 0.2}},
        stiffness=0.0, experiment={"name": "random_steps", "force": 3.0, "duration": 4.0, "shortest": 0.1},
    )  # fmt: skip
    found = diagnose_records(Task((record,), sprung=False))
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "force_offset"}
    assert any("asymmetric friction" in sentence for sentence in found.warnings)


def test_two_records_share_one_model(asking_about: Callable[..., None]) -> None:
    asking_about("cubic_spring", "coulomb_friction", "quadratic_drag")
    records = [
        measured({"cubic_spring": {"cubic_stiffness": 2e5}}, seed=seed, experiment=experiment)
        for seed, experiment in ((1, STEPS), (2, {"name": "step", "force": 5.0, "hold": 1.5}))
    ]
    found = diagnose_records(Task(tuple(records)))
    assert [cause.name for cause in found.causes] == ["cubic_spring"]
    assert len(found.missing) == 2


def test_a_free_decay_knows_ratios_only(asking_about: Callable[..., None]) -> None:
    asking_about("quadratic_drag", "coulomb_friction", "cubic_spring")
    record = measured(
        {"quadratic_drag": {"drag_coefficient": 3.0}}, experiment={"name": "release", "position": 0.02, "duration": 3.0}
    )
    found = diagnose_records(Task((record,)))
    assert found.causes[0].name == "quadratic_drag"
    assert any("only as ratios" in sentence for sentence in found.warnings)
    fitted = found.extended.quantities
    assert fitted["drag_coefficient"].value / fitted["mass"].value == pytest.approx(3.0, rel=0.02)


@pytest.mark.parametrize(
    "asked",
    [
        ("position_dependent_damping", "quadratic_drag", "cubic_spring", "coulomb_friction"),
        pytest.param((), marks=pytest.mark.long),
    ],
    ids=["nearest", "whole library"],
)
def test_an_oddity_is_not_given_a_confident_name_and_its_curves_are_measured(
    asked: tuple[str, ...], asking_about: Callable[..., None]
) -> None:
    if asked:
        asking_about(*asked)
    record = measured({"loose_cable": {"cable_damping": 4.0, "cable_start": 0.002, "cable_end": 0.013}}, rate=250.0)
    found = diagnose_records(Task((record,)))
    assert found.verdict in ("ambiguous", "unexplained") and found.left.exceeds
    assert all(cause.probability < 0.9 for cause in found.causes)
    assert "more than the tolerance of 1 %" in found.summary
    assert found.characteristics is not None
    spring = found.characteristics.spring
    slope = np.polyfit(spring.over, spring.force, 1)[0]
    assert slope == pytest.approx(600.0, rel=0.1)


def test_a_long_search_far_from_the_noise_ends_and_says_so(
    asking_about: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A record of 48 809 samples in 800 swings took more than five minutes, to causes that are not certain."""
    asking_about("position_dependent_damping", "quadratic_drag", "cubic_spring", "coulomb_friction")
    cable = {"loose_cable": {"cable_damping": 4.0, "cable_start": 0.002, "cable_end": 0.013}}
    record = measured(cable, rate=250.0)
    monkeypatch.setattr(structure_search, "_MOST_WORK", 6 * record.samples)
    found = diagnose_records(Task((record,)))
    assert all(cause.probability <= 0.9 for cause in found.causes)
    (said,) = [one for one in found.warnings if one.startswith("The record is long, and all causes leave far more")]
    tried = int(said.split(" sets of causes")[0].split()[-1])
    assert 6 < tried < 12 and len(found.causes) <= 2
    for most in (200, 10_000):  # beyond what there is to try
        monkeypatch.setattr(structure_search, "_MOST_WORK", most * record.samples)
        whole = diagnose_records(Task((record,)))
        assert not [one for one in whole.warnings if one.startswith("The record is long")]


def test_a_free_decay_without_a_spring_can_be_asked_for(asking_about: Callable[..., None]) -> None:
    """Neither a force nor a spring says how large a force may be: the inertia does."""
    asking_about("quadratic_drag", "coulomb_friction", "stribeck_friction")
    record = measured(
        {"quadratic_drag": {"drag_coefficient": 3.0}}, experiment={"name": "release", "position": 0.0, "duration": 1.0},
        stiffness=0.0, initial_velocity=0.3,
    )  # fmt: skip
    found = diagnose_records(Task((record,), sprung=False))
    assert found.base.quantities["stiffness"].value == 0.0
    assert [cause.name for cause in found.causes] == ["quadratic_drag"]


def test_no_records_is_refused() -> None:
    with pytest.raises(UsageError, match="no records to diagnose"):
        diagnose_records(Task(()))


@pytest.mark.usefixtures("without_copies")
def test_a_poor_experiment_without_copies_names_nothing_but_friction_with_certainty(
    asking_about: Callable[..., None],
) -> None:
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring")
    causes = {"coulomb_friction": {"coulomb_force": 0.2}, "quadratic_drag": {"drag_coefficient": 6.0}}
    decay = {"name": "release", "duration": 4.0}
    found = diagnose_records(
        Task((measured(causes, damping=0.5, experiment=decay, initial_position=0.02, duration=4.0),))
    )
    assert found.verdict == "ambiguous" and found.calibration is None
    assert {cause.name: cause.probability for cause in found.causes} == pytest.approx(
        {"coulomb_friction": 180.0 / 181.0, "quadratic_drag": 0.9}
    )
    assert any("--calibrate makes the copies; steps in both directions need none" in said for said in found.warnings)


def test_what_predicts_no_better_is_not_copied_and_gives_way_to_no_rival_of_the_copies(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A rival that was never fitted replaced it."""
    drawn = lottery.draw(165179, "force_gain_nonlinearity", True, "step", 1000.0, ranges="wide")
    made = simulate(drawn.spec)
    record = Record(made.time, made.position, made.force_time, made.force)
    monkeypatch.setattr(naming, "predict", lambda *sets: HeldOut(1.0, 1.0, 0.0, (-1.0, 1.0)))
    found = diagnose_records(Task((record,)))
    assert found.causes == () and found.verdict == "unexplained" and found.calibration is None
    assert found.base.quantities == found.extended.quantities, "one model, one interval"


@pytest.mark.usefixtures("without_copies")
@pytest.mark.parametrize("predicts", [True, False])
def test_no_set_is_more_probable_than_one_of_its_causes(
    predicts: bool, monkeypatch: pytest.MonkeyPatch, asking_about: Callable[..., None]
) -> None:
    """A step without copies: the causes' odds are limited, and those of the sets in the table of rivals were not."""
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring", "bilinear_spring")
    if not predicts:
        monkeypatch.setattr(naming, "predict", lambda *sets: HeldOut(1.0, 1.0, 0.0, (-1.0, 1.0)))
    record = measured(
        {"quadratic_drag": {"drag_coefficient": 6.0}}, experiment={"name": "step", "force": 6.0, "hold": 2}
    )
    found = diagnose_records(Task((record,)))
    assert found.verdict == ("ambiguous" if predicts else "unexplained")
    stated = {one.name: one.probability for one in found.tried}
    rivals = [(rival.causes, rival.probability) for rival in found.rivals]
    for causes, probability in (*rivals, *((one.causes, one.probability) for one in found.contenders)):
        assert all(probability <= stated[cause] + 1e-12 for cause in causes), causes
    assert [p for _, p in rivals] == sorted((p for _, p in rivals), reverse=True)
    assert max(stated.values()) == pytest.approx(0.9)
    assert ("The leading explanation, quadratic drag, is not named" in found.summary) != predicts


@pytest.mark.parametrize(
    "asked",
    [
        ("coulomb_friction", "force_gain_nonlinearity", "quadratic_drag", "backlash"),
        pytest.param((), marks=pytest.mark.long),
    ],
    ids=["rivals", "whole library"],
)
def test_friction_that_a_short_push_shows_is_named_although_the_cart_rests_for_most_of_the_record(
    asked: tuple[str, ...], asking_about: Callable[..., None]
) -> None:
    """Cut into equal times, the first part held all of the motion: nothing predicted it."""
    if asked:
        asking_about(*asked)
    drawn = lottery.draw(165179, "force_gain_nonlinearity", True, "step", 1000.0, ranges="wide")
    made = simulate(drawn.spec)
    found = diagnose_records(Task((Record(made.time, made.position, made.force_time, made.force),)))
    assert [cause.name for cause in found.causes] == ["coulomb_friction"]
    assert found.heldout.better and found.calibration is not None


def test_no_cause_is_certain_where_the_cart_moves_before_the_force_is_known(asking_about: Callable[..., None]) -> None:
    asking_about("end_stop", "cubic_spring", "coulomb_friction")
    record = measured({"end_stop": {"stop_position": 0.006, "stop_stiffness": 5e3}})
    late = warning("force_unknown", "the cart moves before the first sample of the force")
    (sure,), (unsure,) = (diagnose_records(Task((record,), findings=found)).causes for found in ((), (late,)))
    assert sure.probability > 0.99 and unsure.probability == pytest.approx(0.9)


def test_what_a_controller_does_is_not_taken_for_a_stop(asking_about: Callable[..., None]) -> None:
    asking_about("end_stop", "cubic_spring", "coulomb_friction")
    record = measured({"end_stop": {"stop_position": 0.006, "stop_stiffness": 5e3}})
    loop = warning("closed_loop", "the force follows the readings")
    (sure,), (unsure,) = (diagnose_records(Task((record,), findings=found)).causes for found in ((), (loop,)))
    assert sure.name == unsure.name == "end_stop"
    assert sure.probability > 0.99 and unsure.probability == pytest.approx(0.9)


@pytest.mark.parametrize("digit", [1e-12, 4e-12])
def test_which_form_of_a_stop_is_named_does_not_hang_on_the_last_digits(
    digit: float, asking_about: Callable[..., None]
) -> None:
    """Stops without damping are the simple law, whichever of both laws the search found first."""
    asking_about("end_stop", "damped_stop", "coulomb_friction", "cubic_spring")
    record = measured({"end_stop": {"stop_position": 0.006, "stop_stiffness": 5e3}})
    moved = replace(record, force=record.force * (1.0 + digit))
    assert [cause.name for cause in diagnose_records(Task((moved,))).causes] == ["end_stop"]
