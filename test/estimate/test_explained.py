"""A record that no mass-spring-damper model carries is refused in one line; a rig is not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.real.rigs import RIGS, folder
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import DataError
from msd_ident.estimate.explained import explained_variance
from msd_ident.io import read
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
        pytest.param(3, (), marks=pytest.mark.long),
        pytest.param(5, (), marks=pytest.mark.long),
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
    with pytest.raises(DataError, match=f"all causes of the library {end}"):
        pipeline.diagnose([moved_by_hand(seed)])


def test_a_refusal_names_a_doubtful_unit_too() -> None:
    """The whole numbers of a column called Timestamp are milliseconds."""
    record = moved_by_hand(3)
    with pytest.raises(
        DataError, match=r"expected more than 50 %.*; also, the samples lie 10 s apart.*--time-scale 0.0"
    ):
        pipeline.identify([replace(record, time=1000.0 * record.time, force_time=1000.0 * record.force_time)])


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2])
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
