"""The other sets that a diagnosis lists: in order, none more probable than its least probable cause."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import pytest
from setrigs import BASE, fitted, pushed, steps

from msd_ident.diagnosis.pipeline import _floors_left, _heard
from msd_ident.diagnosis.rival_sets import listed
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.selection.evidence import scale_from
from msd_ident.selection.ranking import LEADERS, Ranking


def test_unchecked_sets_have_the_limits_of_their_causes_and_the_order_that_follows() -> None:
    """Drag has at most 3 to 1, whatever its set has by the evidence."""
    data = steps()
    laws = ((), (QuadraticDrag(1.0),), (CoulombFriction(0.1),), (CoulombFriction(0.1), Cogging(0.1, 0.01)))
    nothing, drag, rub, both = (fitted(data, sum(law, start=BASE), 6000.0) for law in laws)
    probability = (0.8, 0.1, 0.06, 0.04)
    evidence = tuple(map(math.log, probability))
    ranking = Ranking((drag, both, rub, nothing), evidence, probability, unchecked=True)
    found = listed(ranking, nothing, partial(_floors_left, data, None))
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
    found = listed(
        Ranking(sets, tuple(map(math.log, probability)), probability), sets[0], partial(_floors_left, data, None)
    )
    assert [one.probability for one in found] == [3e-9, 2e-9, 1e-9]


def test_rivals_are_measured_in_the_noise_that_the_models_are_measured_in() -> None:
    """Where a residual shows four times the noise of the readings at rest, that is the floor of the other sets too."""
    data = pushed()
    loud, friction = (fitted(data, law, 16.0 * data.evidence) for law in (BASE, BASE + CoulombFriction(0.1)))
    quiet = tuple(replace(part, noise=0.25 * part.noise) for part in data.readings)  # what these tell of it at rest
    heard = scale_from([fitted(replace(data, readings=quiet), BASE, 16.0 * data.evidence)], quiet).other_noise
    assert heard is not None and heard.growth == pytest.approx(4.0, rel=0.1)
    noise = replace(heard, left=16.0 * heard.freedom, level=16.0)
    assert _floors_left(data, None, loud) == pytest.approx(4.0)
    ranking = Ranking((friction, loud), (0.0, -1.0), (0.7, 0.3))
    (rival,) = listed(ranking, friction, partial(_floors_left, data, noise))
    assert rival.floors == _heard(data, noise, (loud,))[1][0].ratio
    # Its simulation is as true as the rig: one floor of the noise at rest.
    assert rival.floors == pytest.approx(0.25, rel=0.1)
