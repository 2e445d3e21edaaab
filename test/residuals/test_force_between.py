"""What a measured force leaves open between its samples: as large as the blows make it, and no cause."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from msd_ident.data.record import Record, from_samples
from msd_ident.model import Plant, simulate
from msd_ident.model.effects import by_name
from msd_ident.residuals import force_between
from msd_ident.residuals.noise_model import of_record
from msd_ident.workflow import pipeline

PLANT = Plant(0.5, 1.0, 1260.0)
NOISE = 2e-6
#: Samples of a record, fine steps in each, and its period [s].
SAMPLES, FINE, PERIOD = 1600, 32, 1e-3


def struck(width: float, begins: tuple[float, ...], sizes: tuple[float, ...]) -> Record:
    """A linear rig under half-sine blows, ``width`` samples long, of which the samples alone are told."""
    time = PERIOD / FINE * np.arange(SAMPLES * FINE)
    force = np.zeros(time.size)
    for begin, size in zip(begins, sizes, strict=True):
        part = (time / PERIOD - begin) / width
        force += np.where((part >= 0.0) & (part <= 1.0), size * np.sin(np.pi * part), 0.0)
    fine = from_samples(time, force, np.zeros(time.size), hold="linear")
    kept = slice(None, None, FINE)
    noise = np.random.default_rng(5).normal(0.0, NOISE, SAMPLES)
    moved = simulate(PLANT, fine).position[kept] + noise
    return replace(from_samples(time[kept], force[kept], moved, hold="zero"), hold_known=False)


def test_a_force_that_is_held_or_straight_leaves_nothing_open() -> None:
    record = struck(6.0, (100.2,), (40.0,))
    ramp = np.linspace(0.0, 1.0, SAMPLES)
    for known in (record, replace(record, force=ramp, hold="linear")):
        assert force_between.chi([of_record(known, NOISE)], PLANT) == pytest.approx(0.0, abs=1e-12)


def test_it_is_what_a_blow_of_this_size_does() -> None:
    """One bend at a sample: an eighth of the second difference for one interval, which rings until the end."""
    record = replace(struck(6.0, (100.2,), (40.0,)), hold="linear")
    force = np.zeros(SAMPLES)
    force[100] = 8.0
    bent = replace(record, force=force)
    found = force_between.chi([of_record(bent, NOISE)], PLANT)
    time = PERIOD * np.arange(SAMPLES)
    w, z = np.sqrt(PLANT.stiffness / PLANT.mass), PLANT.damping / 2.0 / PLANT.mass
    w = np.sqrt(w * w - z * z)
    rings = np.exp(-z * time) * np.sin(w * time) / (PLANT.mass * w)
    second = np.abs(np.diff(force, 2))
    expected = sum((d * PERIOD / 8.0) ** 2 * np.sum(rings[: SAMPLES - i - 1] ** 2) for i, d in enumerate(second) if d)
    assert found == pytest.approx(expected / NOISE**2, rel=1e-3)


def test_slopes_are_sums_over_the_blows() -> None:
    """Of two bends, each with a sign of its own, over two entries."""
    force = np.zeros(SAMPLES)
    force[[100, 900]] = 8.0, 4.0
    bent = replace(struck(6.0, (100.2,), (40.0,)), force=force, hold="linear")
    part, rng = of_record(bent, NOISE), np.random.default_rng(2)
    rows = rng.normal(size=(2, SAMPLES))
    rings = simulate(PLANT, replace(bent, force=np.zeros(SAMPLES)), 0.0, 1.0 / PLANT.mass).position
    expected = np.zeros((2, 2))
    for i, second in enumerate(np.abs(np.diff(force, 2))):
        moved = second * PERIOD / 8.0 * (rows * part.root)[:, i + 1 :] @ rings[: SAMPLES - i - 1]
        expected += np.outer(moved, moved)
    assert np.allclose(force_between.slopes([part], PLANT, rows), expected, rtol=1e-6, atol=1e-9 * expected.max())


def test_a_force_that_bends_all_the_time_or_out_of_the_record_leaves_nothing_open() -> None:
    """What a fit leaves shows such errors: a drag that was clearly seen under a measured noise was as likely as not."""
    record = replace(struck(6.0, (100.2,), (40.0,)), hold="linear")
    busy = replace(record, force=np.random.default_rng(1).normal(size=SAMPLES))
    assert force_between.chi([of_record(busy, NOISE)], PLANT) == 0.0
    before = np.linspace(-5.0, -1.0, 400)
    early = replace(
        record, force_time=np.concatenate((before, record.time)),
        force=np.concatenate((np.where(abs(before + 3.0) < 0.2, 5.0, 0.0), np.zeros(SAMPLES))),
    )  # fmt: skip
    assert force_between.chi([of_record(early, NOISE)], PLANT) == 0.0


def test_stamps_that_are_not_even_bend_no_ramp() -> None:
    record = replace(struck(6.0, (100.2,), (40.0,)), hold="linear")
    time = record.time + PERIOD * np.random.default_rng(3).uniform(-0.3, 0.3, SAMPLES)
    ramp = replace(record, time=time, force_time=time, force=7.0 * time)
    assert force_between.chi([of_record(ramp, NOISE)], PLANT) == pytest.approx(0.0, abs=1e-9)


def test_a_true_cause_under_a_force_of_straight_lines_is_likelier_than_its_samples_leave_open(
    asking_about: Callable[..., None],
) -> None:
    asking_about("coulomb_friction", "quadratic_drag", "time_offset", "force_dead_zone")
    rig = PLANT + by_name("coulomb_friction").from_values({"coulomb_force": 1.0})
    time = PERIOD * np.arange(4000)
    force = np.interp(time, [0.1, 0.4, 1.2, 1.5, 2.4, 2.6], [0.0, 20.0, 20.0, -15.0, -15.0, 0.0])
    told = from_samples(time, force, np.zeros(time.size), hold="linear")
    noise = np.random.default_rng(6).normal(0.0, 1e-5, time.size)
    found = pipeline.diagnose([replace(told, position=simulate(rig, told).position + noise, hold_known=False)])
    assert [(cause.name, cause.probability > 0.8) for cause in found.causes] == [("coulomb_friction", True)]


@pytest.mark.parametrize(
    ("width", "asked"),
    [
        (6.3, ("force_gain_nonlinearity", "force_dead_zone", "quadratic_drag", "coulomb_friction")),
        *(pytest.param(width, (), marks=pytest.mark.long) for width in (6.3, 8.2)),
    ],
    ids=["6.3, nearest", "6.3", "8.2"],
)
def test_blows_of_a_few_samples_on_a_linear_rig_have_no_certain_cause(
    width: float, asked: tuple[str, ...], asking_about: Callable[..., None]
) -> None:
    """Each blow has its own area between the samples: a gain or a dead zone of the force was stated with > 99.9 %."""
    if asked:
        asking_about(*asked)
    found = pipeline.diagnose([struck(width, (60.3, 440.7, 900.15), (40.0, 30.0, 36.0))])
    assert all(cause.probability <= 0.5 for cause in found.causes), found.causes
    q = found.extended.quantities["mass"]
    assert abs(q.value - PLANT.mass) < 3.0 * q.std
    assert found.records[0].hold == "linear"
