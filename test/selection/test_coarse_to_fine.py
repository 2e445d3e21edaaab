"""The search on part of the data: when it may stop, and when the whole must go on."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.selection import coarse_to_fine, fitted_sets
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ranking import Ranking
from msd_ident.workflow import pipeline
from msd_sim import api

STOP = {"stop_position": 0.0114, "stop_stiffness": 6300.0}


def swept() -> Record:
    """A stiff stop in a sweep: far from the noise for all that does not know it, and a new force with each sample."""
    made = api.simulate(
        {"mass": 0.57, "damping": 5.0, "stiffness": 759.0, "friction_coefficient": 0.0, "effects": {"end_stop": STOP},
         "experiment": {"name": "sweep", "force": 2.6, "duration": 10.0, "rate": 500.0, "natural_frequency": 36.5},
         "encoder": {"counts_per_metre": 2e5, "noise": 2e-6}, "rate": 500.0, "seed": 3}
    )  # fmt: skip
    place = np.searchsorted(made.force_time, made.time + 1e-9, side="right") - 1
    return from_samples(made.time, made.force[np.maximum(place, 0)], made.position)


def test_mean_forces_are_left_once_they_hide_what_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """They keep the truth itself from the noise: searched for it, everything helps a little, for minutes."""
    fitted: set[frozenset[str]] = set()
    keep = fitted_sets.FittedSets._keep

    def noted(self: fitted_sets.FittedSets, one: Hypothesis) -> None:
        fitted.add(one.causes)
        keep(self, one)

    monkeypatch.setattr(fitted_sets.FittedSets, "_keep", noted)
    diagnosis = pipeline.diagnose([swept()])
    assert [cause.name for cause in diagnosis.causes] == ["end_stop"] and diagnosis.verdict == "explained"
    assert diagnosis.extended.model["stop_position"] == pytest.approx(EndStop(**STOP).stop_position, rel=1e-3)
    assert max(map(len, fitted)) <= 2


@pytest.mark.parametrize(
    "asked",
    [("coulomb_friction", "quadratic_drag", "cubic_spring", "hysteresis"), pytest.param((), marks=pytest.mark.long)],
    ids=["rivals", "whole library"],
)
def test_a_long_rest_hides_no_cause(asked: tuple[str, ...], asking_about: Callable[..., None]) -> None:
    """Nothing moves in nine tenths of the record: sizes of the motion must not be means over all of it."""
    if asked:
        asking_about(*asked)
    made = api.simulate(
        {"mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.02, "rate": 100.0, "seed": 4,
         "effects": {"quadratic_drag": {"drag_coefficient": 2.0}}, "encoder": {"counts_per_metre": 1e6, "noise": 1e-5},
         "experiment": {"name": "steps", "force": 10.0, "hold": 12.0}}
    )  # fmt: skip
    record = Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)
    diagnosis = pipeline.diagnose([record])
    assert {cause.name for cause in diagnosis.causes} == {"coulomb_friction", "quadratic_drag"}
    assert diagnosis.extended.model["drag_coefficient"] == pytest.approx(2.0, rel=0.02)


def test_sets_that_leave_far_less_than_the_leading_one_are_judged_on_all_samples() -> None:
    """However little evidence they have; those that leave only noise come first."""

    def asked(leader: float, exact: tuple[str, ...] = ()) -> list[str]:
        chi = {"coulomb_friction": leader, "cogging": 200.0, "backlash": 240.0, "hysteresis": 260.0}
        sets = tuple(SimpleNamespace(causes=frozenset({name}), chi=left) for name, left in chi.items())
        evidence = (0.0, -90.0, -80.0, -70.0)
        known = frozenset(exact)
        ranking = Ranking(cast(Any, sets), evidence, (1.0, 0.0, 0.0, 0.0))
        ranking = ranking.with_caveats(known, exact=True) if exact else ranking
        return [name for one in coarse_to_fine._leaving_less(ranking) for name in one.causes]

    assert asked(1000.0) == ["backlash", "cogging"]
    assert asked(900.0) == ["cogging"] and asked(700.0) == []
    assert asked(1000.0, ("cogging",)) == ["cogging"]
    assert asked(1000.0, ("coulomb_friction",)) == []


def test_sets_without_a_leading_cause_that_leave_hardly_more_are_judged_on_all_samples(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The likeliest of them, also if they are no explanation on the part; with all leading causes it is no rival."""
    rated = {
        ("stribeck_friction",): (100.0, 0.0),
        ("coulomb_friction",): (600.0, -5.0),
        ("coulomb_friction", "time_offset"): (104.0, -1.0),
        ("stribeck_friction", "time_offset"): (99.0, -2.0),
        ("coulomb_friction", "cogging", "time_offset"): (90.0, -9.0),
        ("actuator_lag", "coulomb_friction"): (109.0, -3.0),
        ("cogging", "force_dead_zone"): (101.0, -30.0),
        ("cogging", "coulomb_friction"): (102.0, -20.0),
        ("coulomb_friction", "second_mode"): (111.0, -1.0),
    }
    sets = {frozenset(one): SimpleNamespace(causes=frozenset(one), chi=left) for one, (left, _) in rated.items()}
    evidence = {frozenset(one): value for one, (_, value) in rated.items()}
    monkeypatch.setattr(coarse_to_fine, "log_evidence", lambda one, scale: evidence[one.causes])
    first = cast(Any, SimpleNamespace(sets=sets, scale=lambda: None))
    ahead = cast(Any, SimpleNamespace(best=sets[frozenset({"stribeck_friction"})]))
    asked = [sorted(one.causes) for one in coarse_to_fine._as_good(first, ahead)]
    assert asked == [
        ["coulomb_friction", "time_offset"], ["actuator_lag", "coulomb_friction"], ["cogging", "coulomb_friction"],
    ]  # fmt: skip


def test_such_sets_are_fitted_to_all_samples(
    monkeypatch: pytest.MonkeyPatch, asking_about: Callable[..., None]
) -> None:
    asking_about("end_stop", "coulomb_friction", "quadratic_drag")
    record, rival = swept(), frozenset({"quadratic_drag"})
    fitted: set[frozenset[str]] = set()
    refine = coarse_to_fine.refine

    def noted(experiment: Any, causes: frozenset[str], *start: Any) -> Any:
        if experiment.records[0].samples == record.samples:
            fitted.add(causes)
        return refine(experiment, causes, *start)

    monkeypatch.setattr(coarse_to_fine, "refine", noted)
    for asked in (False, True):
        fitted.clear()
        monkeypatch.setattr(coarse_to_fine, "_as_good", lambda first, ahead, asked=asked: [first.sets[rival]] * asked)
        pipeline.diagnose([record])
        assert (rival in fitted) == asked
