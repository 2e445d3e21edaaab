"""Order of the sets: parameters pay, and a set counts if it is more than a simpler one."""

from __future__ import annotations

import math

import pytest
from setrigs import BASE, fitted, odds, ranked, steps

from msd_ident.model import Plant
from msd_ident.model.effects.asymmetric_spring import AsymmetricSpring
from msd_ident.model.effects.backlash import Backlash
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.end_stop import EndStop
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.effects.load_dependent_friction import LoadDependentFriction
from msd_ident.model.effects.power_drag import PowerDrag
from msd_ident.model.effects.quadratic_drag import QuadraticDrag
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.selection import evidence
from msd_ident.selection.evidence import scale_from
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis import Hypothesis
from msd_ident.selection.ordering import leading, rank


@pytest.fixture
def experiment() -> Experiment:
    return steps()


@pytest.mark.parametrize(("left", "causes"), [(1900.0, 1), (800.0, 2)])
def test_the_leading_set_is_the_first_of_the_ranking(experiment: Experiment, left: float, causes: int) -> None:
    """Also where a simpler one leads in place of the likeliest."""
    spring = BASE + CubicSpring(1e6)
    models = {BASE: 9e5, spring: 2000.0, spring + QuadraticDrag(1.0): left}
    sets = {one.causes: one for model, chi in models.items() if (one := fitted(experiment, model, chi))}
    scale = scale_from(list(sets.values()), experiment.readings)
    found = rank(sets, scale)
    assert leading(sets, scale) is found.best and len(found.best.causes) == causes
    assert len(found.sets[max(range(2), key=lambda i: found.evidence[i])].causes) == 2, "the likeliest"


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


def test_a_set_that_was_ranked_is_ranked_again_without_its_determinant(
    experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A search ranks after every few fits; what a set alone gives is computed once for each scale of the noise."""
    counted, occam = [], evidence.occam
    monkeypatch.setattr(evidence, "occam", lambda *given: counted.append(given) or occam(*given))
    sets = {
        one.causes: one
        for one in (
            fitted(experiment, BASE + CoulombFriction(0.1), 5000.0),
            fitted(experiment, BASE + CoulombFriction(0.1) + QuadraticDrag(1.0), 840.0),
        )
    }
    near, far = evidence.NoiseScale(840.0), evidence.NoiseScale(840.0, shapes=40.0)
    first = rank(sets, near)
    assert len(counted) == len(sets)
    assert rank(sets, near).evidence == first.evidence and len(counted) == len(sets)
    assert rank(sets, far).evidence != first.evidence and len(counted) > len(sets)
    assert rank(sets, near).evidence == first.evidence


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
