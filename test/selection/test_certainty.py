"""Odds and probabilities of certainty."""

from __future__ import annotations

import math

import pytest

from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.selection.certainty import CERTAIN, CERTAIN_ODDS, certain, probability_at, uncertain, usual


def test_certain_odds_are_those_of_the_certain_probability_and_not_certain_themselves() -> None:
    assert probability_at(CERTAIN_ODDS) == pytest.approx(CERTAIN)
    assert not certain(probability_at(CERTAIN_ODDS)) and certain(probability_at(1.01 * CERTAIN_ODDS))
    assert probability_at(math.inf) == 1.0 and probability_at(0.0) == 0.0 and probability_at(1.0) == 0.5


def test_what_acts_on_most_rigs_is_surer_without_copies_and_what_is_rare_no_less_sure_than_most() -> None:
    assert usual(CoulombFriction) > 1.0 and usual(Cogging) == 1.0
    assert probability_at(uncertain(Cogging)) == pytest.approx(0.75)
    assert uncertain(CoulombFriction) == pytest.approx(usual(CoulombFriction) * uncertain(Cogging))
