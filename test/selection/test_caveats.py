"""What keeps the causes of one set from being certain: each caveat only lowers what a law can have."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from likelihoods import ranking

from msd_ident.model.effects import LIBRARY
from msd_ident.selection import doubts
from msd_ident.selection.caveats import Caveats
from msd_ident.selection.certainty import CERTAIN

PAIR = frozenset({"coulomb_friction", "quadratic_drag"})
LAWS = st.sampled_from(sorted(effect.name for effect in LIBRARY))
ODDS = st.floats(0.0, 1e6)
#: Further caveats about the drag.
MORE: dict[str, Any] = {
    "leaves": 0.2, "slow": frozenset({"quadratic_drag"}), "seldom": frozenset({"quadratic_drag"}),
    "held": frozenset({"quadratic_drag"}), "sampled": frozenset({"quadratic_drag"}),
    "open": frozenset({"quadratic_drag"}),
    "alike": {"quadratic_drag": "cogging"}, "clear": {"quadratic_drag": 4.0}, "further": {"quadratic_drag": 0.1},
    "instead": {"quadratic_drag": {frozenset({"cogging"}): 4.0}},
}  # fmt: skip


def test_without_a_caveat_every_law_can_be_certain() -> None:
    clean = Caveats(PAIR, exact=True)
    assert {clean.greatest(law, rich=True, steered=False) for law in PAIR} == {1.0}


def test_of_three_linear_filters_of_the_force_none_is_certain() -> None:
    """A load cell that lags by 60 ms was a lag, a delay and, with 0.95, a frame that gives way."""
    three = frozenset({"actuator_lag", "frame_compliance", "time_offset"})
    for causes, sure in ((three, False), (three - {"actuator_lag"}, True), (three - {"time_offset"} | PAIR, True)):
        found = Caveats(causes, exact=True).greatest("frame_compliance", rich=True, steered=False)
        assert (found > CERTAIN + 1e-12) is sure
        told = doubts.sentences(replace(ranking({tuple(causes): 1.0}), rich=True).with_caveats(causes, exact=True))
        assert any("frame compliance, time offset are linear filters of the force" in one for one in told) is not sure
    assert Caveats(three | PAIR, exact=True).greatest("quadratic_drag", rich=True, steered=False) == 1.0


def test_of_two_curves_over_the_speed_that_bend_freely_none_is_certain() -> None:
    """Friction that is the difference of two tanh (Makkar) was a drag with a free exponent, with 0.94."""
    two = frozenset({"power_drag", "smooth_friction"})
    for causes, sure in (
        (two, False),
        (two - {"power_drag"} | {"quadratic_drag"}, True),
        (frozenset({"power_drag"}), True),
    ):
        laws = sorted(causes - {"quadratic_drag"})
        assert all((Caveats(causes, exact=True).greatest(law, rich=True, steered=False) == 1.0) is sure for law in laws)
        told = doubts.sentences(replace(ranking({tuple(causes): 1.0}), rich=True).with_caveats(causes, exact=True))
        assert any("ower drag and smooth friction are curves over the speed" in one for one in told) is not sure


@pytest.mark.parametrize("name", sorted(MORE))
def test_no_caveat_about_a_cause_leaves_it_certain_nor_touches_the_other(name: str) -> None:
    doubted = replace(Caveats(PAIR), **{name: MORE[name]})
    assert doubted.greatest("quadratic_drag", rich=True, steered=False) <= CERTAIN + 1e-12
    assert (doubted.greatest("coulomb_friction", rich=True, steered=False) == 1.0) is (name != "leaves")


@given(laws=st.frozensets(LAWS, min_size=1, max_size=3), clear=ODDS, beside=ODDS, part=st.floats(0.0, 1.0))
def test_a_poor_experiment_a_controller_and_much_left_make_no_law_surer(
    laws: frozenset[str], clear: float, beside: float, part: float
) -> None:
    for law in laws:
        found = Caveats(laws, clear={law: clear}, further={law: part}, instead={law: {frozenset(): beside}})
        rich = found.greatest(law, rich=True, steered=False)
        assert replace(found, leaves=0.2).greatest(law, rich=True, steered=False) <= rich
        assert found.greatest(law, rich=False, steered=False) <= rich
        assert found.greatest(law, rich=True, steered=True) <= rich


def test_that_one_of_two_acts_is_not_doubted_by_what_the_other_could_do() -> None:
    rival = frozenset({"cogging"})
    twin = Caveats(PAIR, exact=True, alike={"quadratic_drag": "cogging"})
    beside = Caveats(PAIR, instead={"quadratic_drag": {rival: 0.0}})
    for doubted, alone in ((twin, 0.5), (beside, 0.5)):
        assert doubted.greatest("quadratic_drag", rich=True, steered=False) == pytest.approx(alone)
        assert doubted.greatest("quadratic_drag", rival, rich=True, steered=False) == 1.0


def test_a_law_in_the_place_of_another_has_its_caveats() -> None:
    told = Caveats(PAIR, exact=True, **MORE).renamed({"quadratic_drag": "fading_damping"})
    assert told.causes == {"coulomb_friction", "fading_damping"} and told.exact and told.leaves == 0.2
    for name in set(MORE) - {"leaves"}:
        assert set(getattr(told, name)) == {"fading_damping"}, name
