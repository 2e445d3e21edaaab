"""A record that no mass-spring-damper model carries is refused in one line; a rig is not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.real.rigs import RIGS, folder
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError
from msd_ident.estimate.explained import check, explained_variance
from msd_ident.io import read
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.gravity import Gravity
from msd_ident.workflow import pipeline
from msd_sim import api, lottery


def moved_by_hand(seed: int) -> Record:
    """A joint that a hand moves to and fro, and no force at all: what looks at the force has nothing to look at."""
    time = np.arange(0.0, 10.0, 0.01)
    noise = np.random.default_rng(seed).standard_normal(time.size + 200)
    position = np.convolve(noise, np.hanning(200), "valid")[: time.size]
    return from_samples(time, np.zeros(time.size), 0.02 * position)


@pytest.mark.parametrize(
    ("seed", "asked"),
    [
        (3, ("coulomb_friction", "quadratic_drag", "cubic_spring")),
        *(pytest.param(seed, (), marks=pytest.mark.long) for seed in (2, 3, 5, 8)),
    ],
)
def test_what_a_hand_moved_is_refused_in_one_line(
    seed: int, asked: tuple[str, ...], asking_about: Callable[..., None]
) -> None:
    """A diagnosis refuses it too: with a few causes, or with the whole library."""
    if asked:
        asking_about(*asked)
    end = r"explain \d+ % of the position's variance; expected more than 50 %.*a hand may have moved the cart"
    with pytest.raises(DataError, match=f"dry friction {end}"):
        pipeline.identify([moved_by_hand(seed)])
    with pytest.raises(DataError, match=f"(all causes of the library|the causes that are likelier than not) {end}"):
        pipeline.diagnose([moved_by_hand(seed)])


def test_a_refusal_names_a_doubtful_unit_too() -> None:
    """The whole numbers of a column called Timestamp are milliseconds."""
    record = moved_by_hand(3)
    with pytest.raises(
        DataError, match=r"expected more than 50 %.*; also, the samples lie 10 s apart.*--time-scale 0.0"
    ):
        pipeline.identify([replace(record, time=1000.0 * record.time, force_time=1000.0 * record.force_time)])


def test_a_pendulum_that_swings_far_is_sent_to_the_diagnosis(asking_about: Callable[..., None]) -> None:
    """It was said that a hand moved the cart or the force was another quantity, although it had none."""
    asking_about("gravity", "coulomb_friction", "cubic_spring")
    time = np.arange(0.0, 15.0, 0.01)
    still = replace(from_samples(time, np.zeros(time.size), np.full(time.size, 3.05)), position_unit="rad")
    still = replace(still, force_unit="N·m")
    swing = simulate(Plant(1.0, 0.05, 0.0) + Gravity(40.0), still, 3.05).position
    record = replace(still, position=np.round(swing / 1e-3) * 1e-3)
    with pytest.raises(DataError, match="as a pendulum does that swings far: msd diagnose looks for it") as refused:
        pipeline.identify([record])
    assert "--force" not in str(refused.value), "no force acts"
    assert [cause.name for cause in pipeline.diagnose([record]).causes] == ["gravity"]


def test_where_a_force_acts_it_may_be_another_quantity() -> None:
    time = np.arange(0.0, 5.0, 0.01)
    record = from_samples(time, np.sin(time), np.cos(7.0 * time))
    said = "expected more than 50 %.*: the force may be another quantity: check --force; or .*--start or --end$"
    with pytest.raises(DataError, match=said) as refused:
        check([record.position], [record], "mass and all", diagnosed=True)
    assert "msd diagnose" not in str(refused.value), "that has been done"


@pytest.mark.long
def test_what_a_hand_moved_and_dry_friction_half_follows_is_refused_by_the_diagnosis() -> None:
    """Seed 1: an identification takes it, as its plant explains half of the motion."""
    with pytest.raises(DataError, match=r"explain \d+ % of the position's variance.*a hand may have moved the cart"):
        pipeline.diagnose([moved_by_hand(1)])


@pytest.mark.long
@pytest.mark.parametrize("seed", [4, 6, 7])
def test_what_a_hand_moved_and_many_parameters_follow_is_not_explained(seed: int) -> None:
    """A smooth curve without a force may be near the decay of two masses."""
    found = pipeline.diagnose([moved_by_hand(seed)])
    assert found.verdict in ("unexplained", "ambiguous")
    assert all(cause.probability < 0.9 for cause in found.causes)


@pytest.mark.parametrize("name", ["end_stop", "backlash", "stribeck_friction", None])
def test_a_rig_is_carried_by_far(name: str | None) -> None:
    made = api.simulate(lottery.draw(7, name, True, "steps", 250.0, ranges="wide").spec)
    found = pipeline.identify([Record(made.time, made.position, made.force_time, made.force)])
    residuals = [curve - one.position for curve, one in zip(found.refined.predicted, found.records, strict=True)]
    assert explained_variance(residuals, found.records) > 0.6


def test_a_measured_rig_is_carried_by_far() -> None:
    rig = next(rig for rig in RIGS if rig.name == "spring_cart_1")
    if not (folder() / rig.path).is_file():
        pytest.skip(f"no {folder() / rig.path}")
    found = pipeline.identify([read(folder() / rig.path, rig.options)])
    residuals = [curve - one.position for curve, one in zip(found.refined.predicted, found.records, strict=True)]
    assert explained_variance(residuals, found.records) > 0.97
