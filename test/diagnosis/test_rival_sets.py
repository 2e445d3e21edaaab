"""The other sets that a diagnosis lists: in order, none more probable than its least probable cause."""

from __future__ import annotations

import math

import pytest
from setrigs import BASE, fitted, steps

from msd_ident.diagnosis.rival_sets import listed
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.selection.ranking import LEADERS, Ranking


def test_unchecked_sets_have_the_limits_of_their_causes_and_the_order_that_follows() -> None:
    """Drag has at most 3 to 1, whatever its set has by the evidence."""
    data = steps()
    laws = ((), (QuadraticDrag(1.0),), (CoulombFriction(0.1),), (CoulombFriction(0.1), Cogging(0.1, 0.01)))
    nothing, drag, rub, both = (fitted(data, sum(law, start=BASE), 6000.0) for law in laws)
    probability = (0.8, 0.1, 0.06, 0.04)
    evidence = tuple(map(math.log, probability))
    ranking = Ranking((drag, both, rub, nothing), evidence, probability, unchecked=True)
    found = listed(ranking, nothing, data)
    assert [one.causes for one in found] == [
        ("quadratic_drag",), ("cogging", "coulomb_friction"), ("coulomb_friction",),
    ]  # fmt: skip
    assert [one.probability for one in found] == pytest.approx([0.75, 0.1, 0.06])
    assert found[0].floors == pytest.approx(math.sqrt(6000.0 / data.evidence))
    assert len(found) <= LEADERS


def test_where_all_rivals_are_negligible_the_best_three_are_listed() -> None:
    data = steps()
    laws = (
        (QuadraticDrag(1.0),),
        (),
        (CoulombFriction(0.1),),
        (Cogging(0.1, 0.01),),
        (QuadraticDrag(1.0), Cogging(1, 1)),
    )
    sets = tuple(fitted(data, sum(law, start=BASE), 6000.0) for law in laws)
    probability = (1.0, 1e-9, 3e-9, 2e-9, 1e-12)
    found = listed(Ranking(sets, tuple(map(math.log, probability)), probability), sets[0], data)
    assert [one.probability for one in found] == [3e-9, 2e-9, 1e-9]
