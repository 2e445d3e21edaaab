"""A poor experiment is checked by copies, another one only when asked."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
import setrigs
from copyrigs import DRAGS, RAMP, RUB, STEP, measured

from msd_ident.model.effects import by_name
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.selection import replication
from msd_ident.selection.hypothesis_fit import FAR
from msd_ident.workflow import pipeline


def test_one_step_tells_coulomb_friction_and_shows_that_it_does(asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "stribeck_friction", "quadratic_drag", "cubic_spring")
    found = pipeline.diagnose([measured(STEP, counts_per_metre=0.0, noise=5e-6)])
    assert [cause.name for cause in found.causes] == ["coulomb_friction"]
    assert found.calibration is not None
    rows = {row.causes: row for row in found.calibration.rows}
    assert rows[RUB].right >= rows[RUB].copies - 1
    assert rows[frozenset()].right == rows[frozenset()].copies
    assert rows[frozenset({"stribeck_friction"})].any_strength
    assert found.causes[0].probability == pytest.approx(found.calibration.corrected["coulomb_friction"])
    assert found.calibration.corrected["coulomb_friction"] <= found.calibration.stated["coulomb_friction"]


def test_a_ramp_cannot_tell_the_laws_of_dry_friction_and_says_so(asking_about: Callable[..., None]) -> None:
    """No motion is quick enough to show a friction that falls with the speed."""
    asking_about("coulomb_friction", "stribeck_friction", "quadratic_drag")
    found = pipeline.diagnose([measured(RAMP, counts_per_metre=0.0, noise=5e-6)])
    assert found.calibration is not None and found.calibration.stated["coulomb_friction"] > 0.9
    assert found.calibration.corrected["coulomb_friction"] < 0.9
    assert found.verdict == "ambiguous"
    assert "stribeck_friction" in found.causes[0].tied_with
    assert any(one.causes == ("stribeck_friction",) for one in found.contenders), "the next experiment may part them"


def test_steps_in_both_directions_are_checked_only_when_asked(asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "quadratic_drag", "cubic_spring")
    steps = {"name": "steps", "force": 4.0, "hold": 0.5}
    record = measured(steps, DRAGS, counts_per_metre=0.0, noise=5e-6)
    assert pipeline.diagnose([record]).calibration is None
    asked = pipeline.diagnose([record], pipeline.Options(calibrate=True))
    assert asked.calibration is not None and asked.verdict == "explained"
    assert "calibration" in asked.to_json_dict()


def test_steps_in_both_directions_let_a_further_cause_be_surer() -> None:
    experiment = setrigs.steps()
    base = setrigs.fitted(experiment, setrigs.BASE, 1e5)
    ranking = replace(setrigs.ranked({"nothing": base}), rich=not replication.is_poor(experiment, base))
    assert ranking.rich
    found, matrix = replication.checked(experiment, base, ranking, False, lambda stage, fraction, cause: None)
    assert matrix is None and found == ranking


def test_no_copies_are_made_of_what_left_out_data_chose(monkeypatch: pytest.MonkeyPatch) -> None:
    """They would say how certain it is, and it is not."""
    monkeypatch.setattr(replication, "is_poor", lambda experiment, base: True)
    experiment = setrigs.steps()
    base = setrigs.fitted(experiment, setrigs.BASE, 1e5)
    ranking = replace(setrigs.ranked({"nothing": base}), foretold=True)
    found, matrix = replication.checked(experiment, base, ranking, False, lambda stage, fraction, cause: None)
    assert matrix is None and found == ranking


def test_copies_that_cost_too_much_are_not_made_unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replication, "_CHEAP", 0.0)
    assert pipeline.diagnose([measured(STEP, counts_per_metre=0.0, noise=5e-6)]).calibration is None


@pytest.mark.parametrize(("left", "made"), [(0.9, True), (1.1, False)])
def test_no_copies_are_made_unasked_of_what_leaves_far_more_than_noise(
    left: float, made: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """None is like the record: they took 49 of 71 s of the diagnosis of a measured step, and changed 0.74 to 0.67."""

    class Made(Exception):
        pass

    def all_copies(*_: object) -> None:
        raise Made

    monkeypatch.setattr(replication, "_all", all_copies)
    monkeypatch.setattr(replication, "_CHEAP", math.inf)
    data = setrigs.steps()
    base = setrigs.fitted(data, setrigs.BASE, 1e9)
    rubs = setrigs.fitted(data, setrigs.BASE + CoulombFriction(0.1), left * FAR * data.evidence)
    ranking = setrigs.ranked({"base": base, "rubs": rubs})
    assert ranking.best is rubs and not ranking.rich

    def checked(asked: bool) -> bool:
        try:
            found, matrix = replication.checked(data, base, ranking, asked, lambda stage, fraction, cause: None)
        except Made:
            return True
        assert matrix is None and found.unchecked
        (said,) = replication.left_unchecked(found, matrix)
        assert "copies of what leaves far more than noise are not like this record" in said
        assert "odds are at most 9 to 1. --calibrate makes the copies" in said
        assert found.of_cause("coulomb_friction") <= 0.9 + 1e-9 < ranking.of_cause("coulomb_friction")
        return False

    assert checked(True) and checked(False) is made


@pytest.mark.parametrize(
    ("drawn", "counts"), [(0, [8, 18]), (1, [8, 9, 16]), (2, [8, 8, 8, 8]), (5, [8, 8, 8, 8, 8, 8, 8])]
)
def test_of_several_rivals_drawn_by_lot_as_many_copies_each_are_made_as_of_a_fitted_one(
    drawn: int, counts: list[int]
) -> None:
    """Their mean counts. Certainty needs 18 copies without the cause, whatever rows they are of."""
    lead = replication.Explanation(frozenset({"coulomb_friction"}), None)
    nothing = replication.Explanation(frozenset(), None)
    names = ("stribeck_friction", "load_dependent_friction", "hysteresis", "bouc_wen", "smooth_friction")[:drawn]
    rivals = [replication.Explanation(frozenset({name}), None, True) for name in names]
    assert replication._copies([lead, nothing, *rivals]) == counts


def test_of_a_single_rival_of_each_of_two_causes_twice_as_many_copies_are_made() -> None:
    lead = replication.Explanation(frozenset({"quadratic_drag", "cubic_spring"}), None)
    rivals = [
        replication.Explanation(frozenset(causes), None, True)
        for causes in (("hysteresis", "end_stop"), ("cogging", "quadratic_drag"), ("cubic_spring", "cogging"))
    ]
    assert replication._copies([lead, *rivals[1:]])[1:] == [18, 18]
    assert replication._copies([lead, *rivals])[1:] == [9, 9, 9], "two rivals of each cause"


def test_what_progress_raises_ends_it() -> None:
    class Enough(Exception):
        pass

    def tell(stage: str, fraction: float, cause: str) -> None:
        assert math.isfinite(fraction)
        if stage == "copies of this record":
            raise Enough

    with pytest.raises(Enough):
        pipeline.diagnose([measured(STEP, counts_per_metre=0.0, noise=5e-6)], progress=tell)


@pytest.mark.parametrize(
    ("named", "also"),
    [
        ("cubic_spring", set()),
        ("eccentricity_harmonic", {"sensor_eccentricity"}),
        ("gain_drift", {"stiffness_drift"}),
        (
            "sensor_nonlinearity",
            {"cubic_spring", "asymmetric_spring", "sensor_eccentricity", "force_gain_nonlinearity"},
        ),
    ],
)
def test_copies_are_asked_about_the_causes_from_which_a_search_comes_to_the_named_one(
    named: str, also: set[str]
) -> None:
    """Else no search of a copy would try it, and all copies would be called something else."""
    rows = [replication.Explanation(frozenset({named}), None, True), replication.Explanation(frozenset(), None, True)]
    asked = replication._asked(setrigs.steps(), rows)
    assert asked >= {named, *also} and all(by_name(one).alike(by_name(named)) for one in asked)
    assert also or asked == {named}, "what is tried by itself needs no other"


def test_a_copy_that_sticks_all_the_time_is_called_nothing() -> None:
    """Friction of any strength may hold the cart: without a motion no law has a scale."""
    data = setrigs.steps()
    base = setrigs.stood(data, setrigs.BASE)
    study = replication._study(data, base, setrigs.ranked({"nothing": base}), [])
    still = [replace(part.record, position=0.0 * part.record.position) for part in data.readings]
    assert study.said(still) == frozenset()


@pytest.mark.parametrize("left", [1.2, 2.0])
def test_copies_of_what_leaves_far_more_than_noise_begin_with_its_fits(left: float) -> None:
    """To look for the right minimum in each copy took 64 of 148 s of the diagnosis of a measured step."""
    data = setrigs.steps()
    base = setrigs.stood(data, setrigs.BASE)
    rubs = setrigs.fitted(data, setrigs.BASE + CoulombFriction(0.1), left * FAR / 1.5 * data.evidence)
    ranking = setrigs.ranked({"base": setrigs.fitted(data, setrigs.BASE, 1e9), "rubs": rubs})
    study = replication._study(data, base, ranking, [replication.Explanation(rubs.causes, rubs)])
    assert [causes for causes, *_ in study.remembered] == ([rubs.causes] if left > 1.5 else [])
