"""Evidence of one set: model error tempers, repetition does not count, parameters cost."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.signal
from setrigs import BASE, fitted, pushed, steps

from msd_ident.data.record import Record
from msd_ident.estimate.broyden import State
from msd_ident.estimate.levels import SHAPES
from msd_ident.model.effects import by_name
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.periodic_disturbance import PeriodicDisturbance
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.residuals import noise_model
from msd_ident.selection import evidence
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis


@pytest.fixture
def experiment() -> Experiment:
    return steps()


def test_what_repeats_in_one_octave_counts_once_and_in_three_octaves_three_times(experiment: Experiment) -> None:
    (readings,) = experiment.readings
    frequencies = np.array([np.flatnonzero(readings.octaves.band == band)[0] for band in (2, 3, 4)])
    time = np.arange(readings.record.samples) / readings.record.samples
    scale, whole = evidence.NoiseScale(0.0), fitted(experiment, BASE, 1.0)

    def left(size: float, bands: int) -> float:
        residual = size * sum(np.sin(2.0 * np.pi * frequency * time) for frequency in frequencies[:bands])
        return scale.of(replace(whole, state=replace(whole.state, residual=residual)))

    falls = [left(100.0, bands) - left(1.0, bands) for bands in (1, 3)]
    assert falls[0] == pytest.approx(-0.5 * evidence.OCTAVE_SHAPES * math.log(1e4), rel=1e-2)
    assert falls[1] == pytest.approx(3.0 * falls[0], rel=1e-2)


def test_what_a_set_moves_while_the_cart_stands_still_is_one_octave_more() -> None:
    time, step = np.arange(2400) / 400.0, 1e-5
    swing = 0.02 * np.cos(20.0 * time)
    read = np.where(time < 2.0, np.round(swing / step) * step, 0.0)
    rig = Record(time=time, position=read, force_time=time, force=np.zeros(time.size))
    readings = noise_model.of_record(rig, step / math.sqrt(12.0), step)
    whole = fitted(Experiment((readings,), BASE, frozenset()), BASE, 1.0)
    on = readings.root * np.where(time < 2.0, 0.0, 0.02 * swing)
    swings_on = replace(whole, state=replace(whole.state, residual=on))
    held = replace(swings_on, model=BASE + CoulombFriction(BASE.stiffness))
    assert swings_on.creeping > 100.0 and held.creeping == 0.0
    scale, features = evidence.NoiseScale(0.0), evidence.OCTAVE_SHAPES
    expected = 0.5 * features * math.log1p(swings_on.creeping / features)
    assert scale.of(held) - scale.of(swings_on) == pytest.approx(expected)


@pytest.mark.parametrize("samples", [1e3, 1e5, 1e7])
def test_far_from_the_noise_only_the_ratio_of_what_is_left_counts(samples: float) -> None:
    """A record of a hundred swings shows the same wrong law a hundred times: its length is no evidence."""
    scale = evidence.NoiseScale(samples)
    gain = scale.log_likelihood(100.0 * samples) - scale.log_likelihood(110.0 * samples)
    assert gain == pytest.approx(0.5 * SHAPES * math.log(109.0 / 99.0), rel=0.01)


def test_a_law_that_leaves_nothing_but_noise_gains_with_every_sample() -> None:
    gains = []
    for samples in (1e3, 1e5):
        scale = evidence.NoiseScale(samples)
        gains.append(scale.log_likelihood(samples) - scale.log_likelihood(1.1 * samples))
    assert 10.0 < gains[0] < gains[1]


def slow(set_: Hypothesis) -> Hypothesis:
    """The same set, all that it leaves at the frequency of the motion."""
    (readings,) = set_.readings
    spectrum = np.where(readings.octaves.band == 3, np.fft.rfft(set_.state.residual), 0.0)
    residual = np.fft.irfft(spectrum, readings.record.samples)
    residual *= math.sqrt(set_.chi / float(residual @ residual))
    return replace(set_, state=replace(set_.state, residual=residual))


def test_the_noise_is_what_was_estimated_or_the_least_that_a_set_leaves_near_it(experiment: Experiment) -> None:
    """Where a set leaves an error of a law, its residual says nothing of the noise."""
    pieces = sum(part.evidence for part in experiment.readings)
    for part, noise in ((0.9, 0.9), (1.05, 1.05), (1.5, 1.0), (0.2, 0.0)):
        found = evidence.scale_from([slow(fitted(experiment, BASE, part * pieces))], experiment.readings)
        assert found.spectrum is None
        assert found.noise == pytest.approx(noise * pieces)


@pytest.mark.parametrize("part", [0.2, 0.9, 1.5, 4.0])
def test_where_a_set_leaves_nothing_but_noise_this_is_the_noise(experiment: Experiment, part: float) -> None:
    """Noise that grows with speed is more in motion than at rest."""
    pieces = sum(part.evidence for part in experiment.readings)
    found = evidence.scale_from([fitted(experiment, BASE, part * pieces)], experiment.readings)
    assert found.noise == pytest.approx(part * pieces, rel=0.05)
    assert (found.other_noise is None) is (part == 0.9)
    assert found.spread(found.noise) == pytest.approx(part, rel=0.05)


def test_a_short_record_does_not_show_its_noise() -> None:
    """The variance of so few values is not known to ``NOISE_ERROR``."""
    (readings,) = pushed().readings
    short = noise_model.of_record(readings.record.window(0.0, 1.0), readings.noise)
    experiment = replace(pushed(), readings=(short,))
    assert evidence.scale_from([fitted(experiment, BASE, 4.0 * short.evidence)], (short,)).spectrum is None


def test_in_coloured_noise_a_slow_error_counts_for_less(experiment: Experiment) -> None:
    """As much at the frequency of the motion is a law's error in white noise, and nothing where the noise is slow."""
    (readings,) = experiment.readings
    keep = math.exp(-0.1)
    draws = np.random.default_rng(2).normal(size=readings.record.samples)
    slow_noise = scipy.signal.lfilter([math.sqrt(1.0 - keep**2)], [1.0, -keep], draws)
    wave = np.sin(2.0 * np.pi * np.flatnonzero(readings.octaves.band == 3)[1] * readings.record.time / 24.0)
    falls = []
    for noise in (draws, slow_noise):
        sets = [fitted(experiment, BASE, 1.0), fitted(experiment, BASE, 1.0)]
        left = (noise, noise + 0.2 * wave)
        sets = [replace(one, state=replace(one.state, residual=r)) for one, r in zip(sets, left, strict=True)]
        scale = evidence.scale_from(sets, experiment.readings)
        falls.append(scale.of(sets[0]) - scale.of(sets[1]))
    assert falls[0] > 3.0 and falls[1] == pytest.approx(0.0, abs=0.5)


def test_a_strength_may_be_of_any_order_of_magnitude(experiment: Experiment) -> None:
    """What a small cause pays for its parameter hangs on how well it is known, not on how small it is."""
    costs = []
    for force in (1e-3, 1e-1):
        one = fitted(experiment, BASE + CoulombFriction(force), 840.0)
        rows = one.state.jacobian.copy()
        place = one.problem.names.index("coulomb_force")
        rows[place] *= 1e3 / (rows[place, place] * force) * 1e-1
        known = replace(one, state=State.at(one.point, one.state.residual, rows, exact=True))
        costs.append(evidence.log_evidence(known, evidence.NoiseScale(840.0)))
    assert costs[0] == pytest.approx(costs[1], abs=0.1)


def test_a_strength_wanders_and_a_frequency_does_not(experiment: Experiment) -> None:
    """A parameter that is known a thousand times better costs no more, but for those that no law can be wrong about."""
    for model, costs in ((BASE + QuadraticDrag(1.0), 1), (BASE + PeriodicDisturbance(0.1, 20.0, 0.3), 3)):
        sharp, sharper = (evidence.occam(fitted(experiment, model, 900.0, known=known), 1.0) for known in (1e6, 1e9))
        sure = math.log(1e3) * len(by_name(model.effect_names[0]).exact)
        assert sharper - sharp == pytest.approx(sure, abs=0.01)
        assert sharp - sure * 2 <= costs * math.log(1.0 / evidence.LEAST_SPREAD) + 0.01


def test_what_moves_a_cart_at_rest_is_not_there(experiment: Experiment) -> None:
    scale = evidence.NoiseScale(840.0)
    assert scale.log_likelihood(900.0, 1e4) < scale.log_likelihood(2000.0)


@pytest.mark.parametrize(("noise", "shown"), [(0.0, False), (1.0, True)])
def test_rounding_at_rest_is_no_slow_noise(noise: float, shown: bool) -> None:
    """A cart that comes to rest between two counts stays beside one of them; noise in motion is more than that."""
    time, step = np.arange(6000) / 1000.0, 1e-5
    motion = 3e-3 * np.exp(-0.8 * time) * np.cos(20.0 * time) + 3.4e-6
    seen = motion + noise * step * (np.abs(np.gradient(motion, time)) > 1e-3) * np.random.default_rng(3).normal(
        size=6000
    )
    record = Record(time, step * np.round(seen / step), time[:1], np.ones(1))
    part = noise_model.of_record(record, step / math.sqrt(12.0), step)
    assert part.rounded
    one = fitted(Experiment((part,), BASE, frozenset()), BASE, 1.0)
    one = replace(one, state=replace(one.state, residual=(record.position - motion) * part.root))
    assert (evidence.scale_from([one], [part]).spectrum is not None) is shown


def test_parameters_that_rounding_makes_one_still_have_an_evidence() -> None:
    """So well known that the prior is lost beside them: the diagnosis of a ramp ended in an error."""
    same = np.full((2, 2), 1.0)
    assert evidence._solved(same, np.full((2, 1), 2.0)) == pytest.approx(np.ones((2, 1)))
    other = np.array([[2.0, 1.0], [1.0, 3.0]])
    assert np.array_equal(evidence._solved(other, np.eye(2)), np.linalg.solve(other, np.eye(2)))
