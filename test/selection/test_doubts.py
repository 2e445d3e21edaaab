"""Why a named cause is not certain: told in a sentence each, and only then."""

from __future__ import annotations

from dataclasses import replace

import pytest
from likelihoods import ranking

from msd_ident.selection import doubts
from msd_ident.selection.certainty import CERTAIN


def test_what_may_be_another_form_is_told_with_its_part() -> None:
    one = ranking({("backlash", "cogging"): 1.0, ("backlash",): 1e-9})
    told = doubts.sentences(one.with_caveats(one.best.causes, further={"cogging": 0.084}))
    assert told == (
        "Cogging explains 8 % of what backlash explains: another form of that law could do the same, so it is not "
        "certain that it is a cause of its own.",
    )
    assert doubts.sentences(one) == ()
    three = frozenset({"bouc_wen", "cogging", "quadratic_drag"})
    (told,) = doubts.sentences(ranking({tuple(three): 1.0}).with_caveats(three, further={"cogging": 0.084}))
    assert told.startswith("Cogging explains 8 % of what Bouc-Wen and quadratic drag explain: ")


@pytest.mark.parametrize(("clear", "said"), [(5.0, 1), (60.0, 0)])
def test_what_is_certain_is_not_told_to_be_uncertain(clear: float, said: int) -> None:
    """Drag that stands out of the noise sixty times is named with 98 %, however little of the friction it is."""
    pair = frozenset({"coulomb_friction", "quadratic_drag"})
    found = replace(ranking({tuple(pair): 1.0}), rich=True)
    found = found.with_caveats(pair, exact=True, further={"quadratic_drag": 0.03}, clear={"quadratic_drag": clear})
    assert (found.of_cause("quadratic_drag") > CERTAIN) is (said == 0)
    assert len(doubts.sentences(found)) == said


@pytest.mark.parametrize(("pair", "words"), [
    (("frame_compliance", "time_offset"), "Frame compliance and time offset are linear filters of the force"),
    (("cubic_spring", "end_stop"), "Cubic spring and end stop are curves over the position"),
])  # fmt: skip
def test_of_two_curves_or_two_filters_that_explain_much_none_is_certain(pair: tuple[str, str], words: str) -> None:
    """A drive of second order had frame compliance with 0.92 beside a delay."""
    found = replace(ranking({pair: 1.0}), rich=True).with_caveats(frozenset(pair), further={pair[0]: 0.3})
    assert not any(found.of_cause(name) > CERTAIN + 1e-9 for name in pair)
    assert any(said.startswith(words) for said in doubts.sentences(found))
    assert replace(ranking({pair: 1.0}), rich=True).of_cause(pair[1]) == 1.0


@pytest.mark.parametrize(("name", "rich", "sure"), [
    ("stiffness_drift", False, CERTAIN), ("settling_stiffness", False, CERTAIN), ("stiffness_drift", True, 1.0),
    ("friction_drift", False, CERTAIN), ("settling_friction", False, CERTAIN), ("settling_friction", True, 1.0),
    ("cubic_spring", False, 1.0), ("sensor_drift", False, 1.0), ("stribeck_friction", False, 1.0),
])  # fmt: skip
def test_over_one_decay_nothing_that_changes_with_time_is_certain(name: str, rich: bool, sure: float) -> None:
    """A spring that bends, or friction that falls with the speed, does the same: the amplitude falls with time.

    A pendulum on ball bearings had friction "that settles" with 0.97; over the second half of its decay it settled in
    81 s in place of 16 s.
    """
    found = replace(ranking({(name,): 1.0}), rich=rich).with_caveats(frozenset({name}), exact=True)
    assert found.of_cause(name) == pytest.approx(sure)
    said = any("may be one that changes with the amplitude" in one for one in doubts.sentences(found))
    assert said is (sure < 1.0)


@pytest.mark.parametrize(("beside", "rich", "sure"), [
    ((), False, CERTAIN), ((), True, 1.0), (("sensor_drift",), False, 0.5), (("sensor_drift",), True, 1.0),
])  # fmt: skip
def test_over_one_decay_a_law_that_creeps_may_be_a_sensor_that_settles(
    beside: tuple[str, ...], rich: bool, sure: float
) -> None:
    """Of 23 such springs that releases were given with up to 0.9 none was there: a sensor settled, or missed counts.
    Beside a drift of the sensor it may be nothing but another shape of that.
    """
    found = replace(ranking({("relaxing_spring", *beside): 1.0}), rich=rich)
    assert found.of_cause("relaxing_spring") == pytest.approx(sure)
    assert found.of_cause("sensor_drift") == (1.0 if beside else 0.0)
    said = " ".join(doubts.sentences(found))
    assert ("Over one decay relaxing spring moves like a sensor that settles" in said) is not rich
    assert "stiffness" not in said and "mass" not in said


@pytest.mark.parametrize(("name", "steered", "sure"), [
    ("end_stop", True, CERTAIN), ("cubic_spring", True, CERTAIN), ("end_stop", False, 1.0),
    ("coulomb_friction", True, 1.0), ("force_gain_nonlinearity", True, 1.0),
])  # fmt: skip
def test_under_a_controller_no_law_that_pushes_back_at_a_place_is_certain(
    name: str, steered: bool, sure: float
) -> None:
    """A torsion disc under a position controller, held by friction near its setpoint, had "an end stop" with 0.95."""
    found = replace(ranking({(name,): 1.0}), steered=steered).with_caveats(frozenset({name}), exact=True)
    assert found.of_cause(name) == pytest.approx(sure)
    said = any("A controller brings the cart to the same places" in one for one in doubts.sentences(found))
    assert said is (sure < 1.0)


@pytest.mark.parametrize(("exact", "sure"), [(False, CERTAIN), (True, 1.0)])
def test_where_more_than_noise_is_left_it_may_be_the_mass_that_changes(exact: bool, sure: float) -> None:
    found = replace(ranking({("stiffness_drift",): 1.0}), rich=True)
    found = found.with_caveats(found.best.causes, exact=exact)
    assert found.of_cause("stiffness_drift") == pytest.approx(sure)
    said = any("a mass that changes with time could do" in one for one in doubts.sentences(found))
    assert said is not exact
