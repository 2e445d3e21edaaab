"""Causes between which the data does not decide."""

from __future__ import annotations

import pytest
from setrigs import BASE, fitted, ranked, steps

from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.gravity import Gravity
from msd_ident.model.effects.smooth_friction import SmoothFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.selection.certainty import certain
from msd_ident.selection.ranking import DECISIVE
from msd_ident.selection.ties import alternatives, in_place, tied


def test_the_likelier_of_two_laws_leads_and_the_other_is_told() -> None:
    """Neither is a part of the other, so that the simpler one has no claim to the headline."""
    coulomb = fitted(steps(), BASE + CoulombFriction(0.1), 1000.0)
    for chi in (940.0, 900.0, 860.0):
        stribeck = fitted(steps(), BASE + StribeckFriction(0.1, 0.2, 0.01), chi, known=30.0)
        found = ranked({"coulomb": coulomb, "stribeck": stribeck})
        assert found.evidence[0] == max(found.evidence)
        assert sum(found.probability) == pytest.approx(1.0)
        (name,) = found.best.causes
        other = {"coulomb_friction", "stribeck_friction"} - {name}
        near = found.evidence[0] - found.evidence[1] <= DECISIVE
        assert set(alternatives(found, name)) == (other if near else set())
        assert set(tied(found, name)) == (other if near else set())


def test_what_a_cause_lacks_of_what_is_sure_together_is_its_rivals() -> None:
    """Gravity and a cubic spring move a joint nearly alike: one of them acts, and gravity with three quarters."""
    found = ranked(
        {
            "nothing": fitted(steps(), BASE, 9000.0),
            "gravity": fitted(steps(), BASE + Gravity(1.0), 840.0),
            "cubic": fitted(steps(), BASE + CubicSpring(1.0), 1200.0),
        }
    )
    (name,) = found.best.causes
    beside = {"gravity": {frozenset({"cubic_spring"}): 2.5}}
    found = found.with_caveats(found.best.causes, exact=False, clear={"gravity": 1e9}, instead=beside)
    own, rival = found.of_cause("gravity"), found.of_cause("cubic_spring")
    either = found.of_any(("gravity", "cubic_spring"))
    assert name == "gravity" and tied(found, name) == ("cubic_spring",)
    assert own == pytest.approx(0.75, abs=0.01) and rival < 0.01 and either > 0.99
    least = in_place(found, found.best.causes)
    assert least.keys() == {frozenset({"cubic_spring"})}
    (p,) = least.values()
    assert p == pytest.approx(either - own, abs=0.01)


def test_a_rival_stands_beside_the_other_named_causes_and_all_sets_exclude_each_other() -> None:
    """Friction is sure, and so it is beside the spring that may stand in the place of gravity."""
    rub = CoulombFriction(0.1)
    found = ranked(
        {
            "nothing": fitted(steps(), BASE, 90000.0),
            "gravity": fitted(steps(), BASE + Gravity(1.0) + rub, 840.0),
            "cubic": fitted(steps(), BASE + CubicSpring(1.0) + rub, 1000.0),
            "alone": fitted(steps(), BASE + CubicSpring(1.0), 1400.0),
        }
    )
    both = frozenset({"gravity", "coulomb_friction"})
    assert found.best.causes == both
    beside = {"gravity": {frozenset({"cubic_spring"}): 2.5}}
    found = found.with_caveats(both, exact=False, clear={"gravity": 1e9, "coulomb_friction": 1e9}, instead=beside)
    least = in_place(found, both)
    assert least.keys() == {frozenset({"cubic_spring", "coulomb_friction"})}
    assert found.stated(both) + sum(least.values()) <= 1.0 + 1e-9
    assert certain(found.of_cause("coulomb_friction"))


def test_what_adds_up_stays_as_it_is() -> None:
    coulomb = fitted(steps(), BASE + CoulombFriction(0.1), 860.0)
    stribeck = fitted(steps(), BASE + StribeckFriction(0.1, 0.2, 0.01), 850.0, known=30.0)
    found = ranked({"coulomb": coulomb, "stribeck": stribeck})
    assert in_place(found, found.best.causes) == {}


@pytest.mark.parametrize("law", [SmoothFriction(0.1, 0.01), StribeckFriction(0.1, 0.2, 0.01)])
@pytest.mark.parametrize(("coulomb", "tie"), [(20.0, True), (400.0, False)])
@pytest.mark.parametrize("left", [1.0, 1.5])
def test_that_dry_friction_acts_is_not_doubted_where_its_form_is(
    law: SmoothFriction | StribeckFriction, coulomb: float, tie: bool, left: float
) -> None:
    """``coulomb`` and ``left`` are what Coulomb friction and another law of friction leave, in noise floors."""
    found = ranked(
        {
            "nothing": fitted(steps(), BASE, 840.0 * 1000.0**2),
            "coulomb": fitted(steps(), BASE + CoulombFriction(0.1), 840.0 * coulomb**2),
            "law": fitted(steps(), BASE + law, 840.0 * left**2),
        }
    )
    assert found.best.causes == {law.name}
    assert certain(found.of_cause(law.name)) is not tie
    assert tied(found, law.name) == (("coulomb_friction",) if tie else ())
    assert certain(found.of_any((law.name, "coulomb_friction")))
    own = found.of_cause(law.name)
    assert found.of_any((law.name, "cubic_spring")) == pytest.approx(own), (
        "that a spring may act makes friction no surer"
    )
    assert found.of_any(("coulomb_friction", "cubic_spring")) == pytest.approx(found.of_cause("coulomb_friction"))
    if tie:
        least = in_place(found, found.best.causes)
        assert least.keys() == {frozenset({"coulomb_friction"})}
        assert found.stated(found.best.causes) + sum(least.values()) <= 1.0 + 1e-9
