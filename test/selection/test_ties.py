"""Causes between which the data does not decide."""

from __future__ import annotations

import pytest
from setrigs import BASE, fitted, ranked, steps

from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.selection.ranking import DECISIVE
from msd_ident.selection.ties import alternatives, tied


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
