"""Ranking: parameters pay, the likeliest set leads, other forms of a law are no cause, probabilities add up."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from setrigs import BASE, fitted, odds, ranked, steps

from msd_ident.model import Plant
from msd_ident.model.effects.asymmetric_spring import AsymmetricSpring
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.bilinear_spring import BilinearSpring
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.load_dependent_friction import LoadDependentFriction
from msd_ident.model.effects.power_drag import PowerDrag
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.residuals.noise_spectrum import NoiseSpectrum
from msd_ident.selection import evidence, naming
from msd_ident.selection.evidence import scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ordering import rank
from msd_ident.selection.ranking import CERTAIN, CERTAIN_ODDS, DECISIVE, FAINT, alternatives


@pytest.fixture
def experiment() -> Experiment:
    return steps()


def test_a_parameter_must_earn_its_place(experiment: Experiment) -> None:
    friction, drag = CoulombFriction(0.1), QuadraticDrag(1.0)
    for without, both, leads in ((1000.0, 990.0, 0), (5000.0, 840.0, 1)):
        found = ranked(
            {
                "friction": fitted(experiment, BASE + friction, without),
                "both": fitted(experiment, BASE + friction + drag, both),
            }
        )
        assert len(found.best.causes) == 1 + leads


def test_what_brings_no_fall_of_chi_has_no_evidence_of_its_own(experiment: Experiment) -> None:
    """However uncertain a further cause makes the others: the smaller set's determinant may be wrong at a knee."""
    found = ranked(
        {
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 1000.0, known=1e6),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 970.0, known=1.0),
        }
    )
    assert found.best.causes == {"coulomb_friction"}
    scale = evidence.NoiseScale(840.0)
    gain = scale.of(found.sets[1]) - scale.of(found.sets[0])
    assert 0.1 < gain < math.log(20.0)
    assert found.evidence[0] - found.evidence[1] == pytest.approx(math.log(20.0) - gain)


@pytest.mark.parametrize(
    ("without", "both", "called"),
    [
        (100.0, 1.0, True),  # a tenth of what friction explains, and its form is seen
        (20.0, 1.5, False),  # a fiftieth: another form of the friction would do
        (2.9, 1.2, False),  # fainter than its form can be seen, and less than a fifth
        (2.9, 2.8, False),
        (2.9, 1.0, True),  # nothing is left of which another form could be the cause
    ],
)
def test_what_another_form_of_the_law_would_explain_is_no_cause(
    experiment: Experiment, without: float, both: float, called: bool
) -> None:
    """``without`` and ``both`` are what friction alone and with drag leaves, in noise floors."""
    nothing = 1000.0 if without > FAINT else 20.0
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * nothing**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * without**2),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 840.0 * both**2),
        }
    )
    assert ("quadratic_drag" in found.best.causes) == called
    assert found.of_cause("coulomb_friction") == pytest.approx(1.0, abs=1e-3)
    sure = 0.9 if without < FAINT else 1.0
    assert found.of_cause("quadratic_drag") == pytest.approx(sure if called else 0.0)


def test_a_small_cause_that_leaves_nothing_but_noise_is_named_and_never_certain(experiment: Experiment) -> None:
    """A fiftieth of what friction explains: laws that are exact to the noise show no error that it could be."""
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 1000.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * 20.0**2),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 840.0),
        }
    )
    assert found.best.causes == {"coulomb_friction", "quadratic_drag"}
    assert found.of_cause("quadratic_drag") == pytest.approx(0.9)
    assert not found.of_cause("quadratic_drag") > CERTAIN


@pytest.mark.parametrize(
    ("without", "left", "sure"),
    [
        (2.5, 1.0, 0.9),  # faint, and less than a fifth of what Coulomb's friction explains
        (20.0, 1.5, 3.0 / 4.0),  # a fiftieth
        (100.0, 1.0, 1.0),
    ],
)
def test_another_law_of_friction_is_not_certain_within_the_error_of_coulombs(
    experiment: Experiment, without: float, left: float, sure: float
) -> None:
    """``without`` and ``left`` are what Coulomb's friction and Stribeck's leave, in noise floors."""
    nothing = 1000.0 if without > FAINT else 60.0
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * nothing**2),
            "coulomb": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * without**2),
            "stribeck": fitted(experiment, BASE + StribeckFriction(0.1, 0.2, 0.01), 840.0 * left**2),
        }
    )
    assert found.best.causes == {"stribeck_friction"}
    assert found.of_cause("stribeck_friction") == pytest.approx(sure, abs=1e-3)
    (said,) = naming.other_forms(found) or ("",)
    assert ("of what Coulomb friction explains: another form of that law" in said) is (sure < 1.0)


@pytest.mark.parametrize(("further", "prior_odds"), [("quadratic_drag", 1.0 / 20.0), ("coulomb_friction", 1.0)])
@pytest.mark.parametrize(("left", "rich", "times"), [(1.0, False, 180.0), (1.0, True, 12600.0), (1.2, True, 60.0)])
def test_what_is_seen_roughly_may_be_another_form(
    experiment: Experiment, further: str, prior_odds: float, left: float, rich: bool, times: float
) -> None:
    """An eighth of what the first explains, seen at 8 floors; friction, which acts on nearly every rig, is surer.

    Where the set leaves only noise, the cause explains 630 times what a tenth of the noise's variance can hide.
    """
    first, second = CoulombFriction(0.1), QuadraticDrag(1.0)
    alone = first if further == "quadratic_drag" else second
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 64.0**2),
            "alone": fitted(experiment, BASE + alone, 840.0 * 8.0**2),
            "both": fitted(experiment, BASE + first + second, 840.0 * left**2),
        }
    )
    assert found.best.causes == {first.name, second.name}
    found = replace(found, rich=rich)
    assert found.of_cause(alone.name) == pytest.approx(1.0, abs=1e-3)
    assert found.of_cause(further) == pytest.approx(times * prior_odds / (1.0 + times * prior_odds))


@pytest.mark.parametrize(("without", "times"), [(1.5, 5.0), (1.9, 9.0), (7.3, 63.0)])
def test_a_further_cause_is_as_sure_as_it_stands_out_of_what_the_noise_can_hide(
    experiment: Experiment, without: float, times: float
) -> None:
    """``without`` is the variance without the drag; what explains five times a tenth of the noise's is not certain."""
    both = BASE + CoulombFriction(0.1) + QuadraticDrag(1.0)
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 64.0**2),
            "alone": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * without),
            "both": fitted(experiment, both, 840.0),
        }
    )
    assert found.best.causes == {"coulomb_friction", "quadratic_drag"}
    likely = replace(found, rich=True).of_cause("quadratic_drag") / found.of_set(found.best.causes)
    assert likely == pytest.approx(times / (1.0 + times))
    poor = found.of_cause("quadratic_drag") / found.of_set(found.best.causes)
    assert poor == pytest.approx(min(times / (1.0 + times), CERTAIN)), "a poor experiment makes none certain"


def test_a_rich_experiment_does_not_make_a_flexible_law_surer(experiment: Experiment) -> None:
    """A law with less than the usual prior odds bends to much that is another law's."""
    first, second = CoulombFriction(0.1), BilinearSpring(1e-3, 50.0)
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 64.0**2),
            "alone": fitted(experiment, BASE + first, 840.0 * 8.0**2),
            "both": fitted(experiment, BASE + first + second, 840.0),
        }
    )
    for rich in (False, True):
        assert replace(found, rich=rich).of_cause(second.name) == pytest.approx(4.5 / 5.5)


def test_what_is_hardly_likelier_than_a_set_that_leaves_only_noise_is_no_explanation(experiment: Experiment) -> None:
    """Friction too weak to be seen is possible on every rig; that is no probability that it acts."""

    def rubs(chi: float) -> Hypothesis:
        return fitted(experiment, BASE + CoulombFriction(0.1), chi)

    nothing = fitted(experiment, BASE, 840.0)
    for chi, named in ((839.0, False), (800.0, True)):
        found = ranked({"nothing": nothing, "friction": rubs(chi)})
        assert (found.of_cause("coulomb_friction") > 0.0) is named
    for chi, named in ((7199.9, False), (7100.0, True)):
        little = {one.causes: one for one in (fitted(experiment, BASE, 7200.0), rubs(chi))}
        found = rank(little, scale_from(list(little.values()), experiment.readings))
        assert (found.of_cause("coulomb_friction") > 0.0) is named, "the noise is less than the readings told"
    for chi, named in ((8399.0, False), (8200.0, True)):
        far = {"nothing": fitted(experiment, BASE, 8400.0), "drag": fitted(experiment, BASE + QuadraticDrag(1.0), chi)}
        assert (frozenset({"quadratic_drag"}) in odds(ranked(far))) is named, "far from the noise, little is enough"


@pytest.mark.parametrize(("left", "sure"), [(30.0, 3.0 / 4.0), (10.0, 1.0), (1.04, 1.0)])
def test_a_law_that_leaves_much_of_what_it_explains_is_not_certain(
    experiment: Experiment, left: float, sure: float
) -> None:
    """Of 100 noise floors, drag leaves ``left``: with another law in its place, nothing would be left."""
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
            "drag": fitted(experiment, BASE + QuadraticDrag(1.0), 840.0 * left**2),
        }
    )
    assert found.best.causes == {"quadratic_drag"}
    assert found.of_cause("quadratic_drag") == pytest.approx(sure, abs=0.03)
    (said,) = naming.other_forms(found) or ("",)
    assert ("What is left is 31 % of what quadratic drag explains: the rig follows another law" in said) is (sure < 1)


@pytest.mark.parametrize(("left", "odds"), [(30.0, 60.0), (60.0, 3.16), (40.0, 27.6), (75.0, 3.0)])
def test_of_a_law_that_leaves_much_even_friction_is_only_as_sure_as_it_stands_out_of_that(
    experiment: Experiment, left: float, odds: float
) -> None:
    """It acts on nearly every rig, 60 to 1; not where the rest, which may move like it, is more than it explains."""
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 100.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * left**2),
        }
    )
    assert found.of_cause("coulomb_friction") == pytest.approx(odds / (1.0 + odds), abs=0.03)


@pytest.mark.parametrize(("left", "odds"), [(1.02, 720.0), (10.0, 7.15), (14.0, 3.0)])
def test_a_cause_is_no_surer_than_it_stands_out_of_what_the_set_leaves(
    experiment: Experiment, left: float, odds: float
) -> None:
    """Friction leaves 28 of 400 noise floors, drag beside it ``left``, which may move like the drag."""
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 400.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * 28.5**2),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 840.0 * left**2),
        }
    )
    assert found.best.causes == {"coulomb_friction", "quadratic_drag"}
    assert found.of_cause("quadratic_drag") == pytest.approx(odds / (1.0 + odds), abs=0.01)
    said = any("of what is left without quadratic drag" in one for one in naming.other_forms(found))
    assert said is (odds < CERTAIN_ODDS)


@pytest.mark.parametrize("coloured", [False, True])
def test_two_causes_that_only_together_were_worth_a_fit_may_be_another_form(
    experiment: Experiment, coloured: bool
) -> None:
    """They explain a hundredth of what friction does. The noise that only their own residual tells of is no proof."""
    friction, three = BASE + CoulombFriction(0.1), BASE + CoulombFriction(0.1) + QuadraticDrag(1.0) + CubicSpring(1.0)
    sets = {
        one.causes: one
        for one in (
            fitted(experiment, BASE, 840.0 * 400.0**2),
            fitted(experiment, friction, 840.0 * 4.0**2),
            fitted(experiment, three, 840.0),
        )
    }
    bands = sets[frozenset(three.effect_names)].octaves
    spectrum = NoiseSpectrum(1.0, 0.3, 16.0, bands, np.full(bands.size, 105.0)) if coloured else None
    scale = replace(scale_from(list(sets.values()), experiment.readings), spectrum=spectrum)
    found = replace(rank(sets, scale), rich=True)
    assert found.best.causes == set(three.effect_names)
    for name in ("quadratic_drag", "cubic_spring"):
        assert (found.of_cause(name) > CERTAIN) is not coloured
        assert name in found.further[found.best.causes]


def test_a_faint_cause_that_explains_as_much_as_the_others_is_one(experiment: Experiment) -> None:
    found = ranked(
        {
            "nothing": fitted(experiment, BASE, 840.0 * 4.0**2),
            "friction": fitted(experiment, BASE + CoulombFriction(0.1), 840.0 * 2.9**2),
            "both": fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 840.0),
        }
    )
    assert found.of_cause("quadratic_drag") > 0.9


def test_the_likelier_of_two_laws_leads_and_the_other_is_told(experiment: Experiment) -> None:
    """Neither is a part of the other, so that the simpler one has no claim to the headline."""
    coulomb = fitted(experiment, BASE + CoulombFriction(0.1), 1000.0)
    for chi in (940.0, 900.0, 860.0):
        stribeck = fitted(experiment, BASE + StribeckFriction(0.1, 0.2, 0.01), chi, known=30.0)
        found = ranked({"coulomb": coulomb, "stribeck": stribeck})
        assert found.evidence[0] == max(found.evidence)
        assert sum(found.probability) == pytest.approx(1.0)
        (name,) = found.best.causes
        other = {"coulomb_friction", "stribeck_friction"} - {name}
        near = found.evidence[0] - found.evidence[1] <= DECISIVE
        assert set(alternatives(found, name)) == (other if near else set())


@pytest.mark.parametrize(("third", "called"), [(None, False), (60000.0, True), (90000.0, False)])
def test_a_cause_that_two_laws_say_alike_is_called_for_by_both(
    experiment: Experiment, third: float | None, called: bool
) -> None:
    """An offset and an asymmetric spring beside a cubic one are the same curve: each has a part of what it is worth."""
    offset, bent = ForceOffset(0.3), AsymmetricSpring(2e3)
    sets = {
        "base": fitted(experiment, BASE, 1e6),
        "cubic": fitted(experiment, BASE + CubicSpring(1e5), 1e5, known=30.0),
        "offset": fitted(experiment, BASE + CubicSpring(1e5) + offset, 60000.0, known=30.0),
    }
    if third is not None:
        sets["bent"] = fitted(experiment, BASE + CubicSpring(1e5) + bent, third, known=30.0)
    found = ranked(sets)
    assert found.best.causes == {"cubic_spring"} | ({"force_offset"} if called else set())
    assert found.of_cause("force_offset") > found.of_set(frozenset({"cubic_spring"}))


@pytest.mark.parametrize(("peak", "own"), [(1.005, False), (1.02, True)])
def test_a_breakaway_no_higher_than_the_sliding_force_is_no_law_of_its_own(
    experiment: Experiment, peak: float, own: bool
) -> None:
    found = ranked(
        {
            "coulomb": fitted(experiment, BASE + CoulombFriction(0.1), 1000.0),
            "stribeck": fitted(experiment, BASE + StribeckFriction(0.1, 0.1 * peak, 0.3), 940.0, known=1e6),
        }
    )
    assert found.best.causes == {"coulomb_friction"}
    assert (len(found.sets) == 2) is own


def test_another_set_can_lead_with_its_own_evidence(experiment: Experiment) -> None:
    """Where few independent samples let the base lead a tie, and the likelier set predicts better beyond doubt."""
    found = ranked(
        {
            "base": fitted(experiment, BASE, 1000.0),
            "coulomb": fitted(experiment, BASE + CoulombFriction(0.1), 980.0),
            "drag": fitted(experiment, BASE + QuadraticDrag(1.0), 999.0),
        }
    )
    assert not found.best.causes
    friction = next(one for one in found.sets if one.causes == {"coulomb_friction"})
    led = found.led_by(friction)
    assert led.best is friction
    assert odds(led) == odds(found)


def test_a_law_no_better_than_its_limit_is_its_limit(experiment: Experiment) -> None:
    """What the data does not see of a law costs nothing, so it would take a share of the simple law's probability."""
    coulomb = fitted(experiment, BASE + CoulombFriction(0.1), 900.0)
    for gain, own in ((1.0, False), (50.0, True)):
        load = fitted(experiment, BASE + LoadDependentFriction(0.1, 0.02), 900.0 - gain)
        assert (len(ranked({"coulomb": coulomb, "load": load}).sets) == 2) is own


def test_the_simple_law_leads_where_a_form_is_hardly_better(experiment: Experiment) -> None:
    drag = fitted(experiment, BASE + QuadraticDrag(1.0), 900.0)
    power = fitted(experiment, BASE + PowerDrag(1.0, 1.0, 1.7), 850.0)
    found = ranked({"drag": drag, "power": power})
    assert found.best.causes == {"quadratic_drag"}
    assert found.of_cause("quadratic_drag") == found.of_cause("power_drag") == pytest.approx(1.0)


def test_stops_beside_no_spring_are_no_rival_of_the_play_that_they_are(experiment: Experiment) -> None:
    sets = {
        "base": fitted(experiment, BASE, 1e6),
        "play": fitted(experiment, BASE + Backlash(1e-3), 850.0),
        "stops": fitted(experiment, Plant(1.0, 2.0, 0.0) + EndStop(1e-3, 400.0), 849.5),
    }
    assert ranked(sets).best.causes == {"backlash"}
    assert frozenset({"end_stop"}) not in odds(ranked(sets))
    sets["stops"] = fitted(experiment, Plant(1.0, 2.0, 100.0) + EndStop(1e-3, 400.0), 849.5)
    assert frozenset({"end_stop"}) in odds(ranked(sets)), "beside a spring they are something else"


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize(("left", "sure"), [(5000.0, False), (850.0, True)])
def test_the_second_of_two_springs_is_certain_only_where_nothing_is_left(left: float, sure: bool, known: bool) -> None:
    """Of 17 such springs that were stated with more than 0.9, 7 did not act; where only noise is left, 0 of 11."""
    data = steps()
    stop, bent = EndStop(2e-3, 500.0), CubicSpring(1e6)
    sets = {
        "base": fitted(data, BASE, 1e6),
        "bent": fitted(data, BASE + bent, 5e4),
        "stop": fitted(data, BASE + stop, 4e5),
        "both": fitted(data, BASE + bent + stop, left),
    }
    if not known:
        del sets["stop"]  # it was not worth a fit
    found = ranked(sets)
    assert found.best.causes == {"cubic_spring", "end_stop"}
    assert found.of_cause("cubic_spring") > 0.98
    assert found.of_cause("end_stop") == pytest.approx(1.0 if sure else 0.75, abs=0.02)
