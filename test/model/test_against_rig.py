"""The solver against msd_sim's rig, which shares no code with it: positions agree to 1e-6 of the amplitude."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from effect_examples import DAMPING, EXAMPLES, MASS, STIFFNESS, model, record

from msd_ident.model import simulate
from msd_ident.model.effects import by_name
from msd_ident.record import Record
from msd_sim.rig import Rig
from msd_sim.truth import Truth

AGREE = 1e-6
#: Samples a second of the contract, with a force held and a force linear between samples.
SAMPLINGS = [(rate, hold) for rate in (250.0, 2000.0) for hold in ("zero", "linear")]


def rig_positions(measured: Record, effects: dict[str, dict[str, float]], x: float, v: float) -> np.ndarray:
    """Readings of a rig with these effects and no encoder error."""
    truth = Truth(MASS, DAMPING, STIFFNESS, effects)
    rig = Rig(truth, x, v, float(measured.time[0]), measured.hold)
    rig.drive(measured.force_time, measured.force)
    motion = rig.sample(measured.time)
    return truth.sensed(motion.time, motion.position)


def disagreement(measured: Record, names: tuple[str, ...], x: float = 0.0, v: float = 0.0) -> float:
    """Largest difference of both, in parts of the rig's amplitude."""
    theirs = rig_positions(measured, {name: EXAMPLES[name] for name in names}, x, v)
    ours = simulate(model(*names), measured, x, v).position
    return float(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))


def sensible_pairs() -> list[tuple[str, str]]:
    """All pairs that a model takes: not two dry frictions."""
    return [
        pair
        for pair in itertools.combinations(sorted(EXAMPLES), 2)
        if not (by_name(pair[0]).family and by_name(pair[0]).family == by_name(pair[1]).family)
    ]


def random_pairs(count: int) -> list[tuple[str, str]]:
    """Some of them, always the same."""
    pairs = sensible_pairs()
    return [pairs[i] for i in np.random.default_rng(20).choice(len(pairs), count, replace=False)]


@pytest.mark.parametrize(("rate", "hold"), SAMPLINGS)
@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_every_effect_agrees(name: str, rate: float, hold: str) -> None:
    assert disagreement(record(rate, hold), (name,)) <= AGREE


@pytest.mark.parametrize(("rate", "hold"), SAMPLINGS)
@pytest.mark.parametrize("names", random_pairs(20), ids="+".join)
def test_twenty_random_pairs_agree(names: tuple[str, ...], rate: float, hold: str) -> None:
    assert disagreement(record(rate, hold), names, 0.004, -0.03) <= AGREE


def test_all_that_goes_together_agrees() -> None:
    """Every effect at once, with each of the dry frictions."""
    frictions = [name for name in EXAMPLES if by_name(name).family == "dry friction"]
    rest = [name for name in EXAMPLES if name not in frictions]
    for friction in frictions:
        assert disagreement(record(1000.0), (friction, *rest), 0.004, -0.03) <= 1e-5


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_irregular_samples_agree(name: str) -> None:
    """Stamps that jitter by a third of a period, a gap of 0.1 s, and a force with stamps of its own."""
    random = np.random.default_rng(3)
    time = np.arange(600) / 250.0 + random.uniform(0.0, 0.0013, 600)
    time = np.delete(time, np.s_[200:225])
    force_time = np.sort(random.uniform(0.0, 2.4, 40))
    force = 8.0 * np.sin(9.0 * force_time)
    for hold in ("zero", "linear"):
        measured = Record(time=time, position=0.0 * time, force_time=force_time, force=force, hold=hold)
        assert disagreement(measured, (name,), 0.004, -0.03) <= AGREE
