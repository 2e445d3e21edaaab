"""The explanations that remain, and what the data says about their parameters."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from setrigs import BASE, pushed

from msd_ident.estimate import fit
from msd_ident.estimate.problem import Initial
from msd_ident.model import Effect
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.selection.candidate_models import marginal, of_ranking
from msd_ident.selection.evidence import NoiseScale, scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.ordering import rank
from msd_ident.selection.ranking import NEAR, Ranking

RUB, DRAG = CoulombFriction(0.3), QuadraticDrag(0.5)


@cache
def experiment() -> Experiment:
    return pushed(RUB)


@cache
def ranked(*sets: tuple[Effect, ...]) -> tuple[Ranking, NoiseScale]:
    found = {}
    for effects in sets:
        model = BASE
        for effect in effects:
            model = model + effect
        causes = frozenset(model.effect_names)
        found[causes] = refine(experiment(), causes, model, (Initial(),))
    scale = scale_from(list(found.values()), experiment().readings)
    return rank(found, scale), scale


@given(st.integers(1, 4), st.integers(0, 4), st.integers(0, 2**31))
def test_what_is_known_of_some_with_all_others_unknown_is_their_part_of_the_covariance(
    kept: int, others: int, seed: int
) -> None:
    rows = np.random.default_rng(seed).normal(size=(kept + others, 40))
    information = rows @ rows.T
    known = marginal(information, kept)
    np.testing.assert_allclose(np.linalg.inv(known), np.linalg.inv(information)[:kept, :kept], rtol=1e-6, atol=1e-9)
    assert np.linalg.eigvalsh(information[:kept, :kept] - known)[0] > -1e-9, "others that are unknown cost"


def test_what_is_left_are_the_leading_set_and_those_near_it() -> None:
    ranking, scale = ranked((), (RUB,), (RUB, DRAG))
    found = of_ranking(ranking, scale, experiment().readings)
    assert found[0].causes == ("coulomb_friction",) == tuple(ranking.best.causes)
    assert min(ranking.evidence) < max(ranking.evidence) - NEAR, "the base model is far from the noise"
    assert () not in {one.causes for one in found}
    for one in found:
        place = next(i for i, other in enumerate(ranking.sets) if other.causes == frozenset(one.causes))
        assert one.probability == ranking.probability[place] and one.evidence == ranking.evidence[place]
        assert one.evidence > max(ranking.evidence) - 0.5 * NEAR


def test_a_leading_set_far_from_the_best_is_left_too() -> None:
    ranking, scale = ranked((), (RUB,))
    base = next(one for one in ranking.sets if not one.causes)
    found = of_ranking(ranking.led_by(base), scale, experiment().readings)
    assert [one.causes for one in found] == [(), ("coulomb_friction",)]


def test_the_information_is_that_of_the_intervals_of_a_fit() -> None:
    ranking, scale = ranked((), (RUB,))
    one = of_ranking(ranking, scale, experiment().readings)[0]
    fitted = fit(one.model, experiment().records, search="near")
    expected = [fitted.quantities[name].std for name in one.free]
    assert one.free == fitted.free
    np.testing.assert_allclose(np.sqrt(np.diag(np.linalg.inv(one.information))), expected, rtol=0.3)
    assert one.model["coulomb_force"] == pytest.approx(0.3, rel=0.01)


def test_less_than_nothing_is_known_of_no_direction() -> None:
    """The readings of an unstable plant grow with its initial state beyond all that rounding keeps of the rest."""
    rows = np.random.default_rng(0).normal(size=(5, 40)) + 1e13 * np.exp(np.linspace(-9.0, 0.0, 40))
    known = marginal(rows @ rows.T, 3)
    size = np.sqrt(np.maximum(np.diag(known), 1e-300))
    assert np.linalg.eigvalsh(known / np.outer(size, size))[0] > -1e-12
