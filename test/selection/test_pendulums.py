"""Gravity on a joint that is turned far from where it hangs, where no spring is a start for it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from pendulums import dropped, led, pumped, turned
from setrigs import stood

from msd_ident.data.record import Record
from msd_ident.estimate import fit
from msd_ident.estimate.formulation import formulate, regressed
from msd_ident.estimate.problem import Initial, Nuisance
from msd_ident.model import Plant
from msd_ident.model.effects.cogging import Cogging
from msd_ident.model.effects.cubic_spring import CubicSpring
from msd_ident.model.effects.gravity import Gravity
from msd_ident.quantity import Z95, Quantity
from msd_ident.residuals import noise_model
from msd_ident.selection.evidence import occam
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.simpler_sets import reduced
from msd_ident.workflow import pipeline, spring_decision

#: J [kg·m²], b [N·m·s/rad] and G [N·m].
TRUE = (0.18, 0.05, 3.7)


def round_and_round(hangs: float) -> Record:
    """Swung up in five seconds, and then ten times round."""
    return turned(pumped(1.6), 8.0, TRUE, hangs)


def to_the_top(hangs: float) -> Record:
    """Brought to 180° within a second, and held there for another one."""
    return turned(led(lambda t: math.pi * min(t, 1.0), 20.0, 0.6), 2.2, TRUE, hangs)


def there_and_back(hangs: float) -> Record:
    """Led to 152° and back, twice: such a motion looks as if a spring held the joint."""
    return turned(led(lambda t: 2.7 * math.sin(0.9 * t) ** 2, 20.0, 0.6), 8.0, TRUE, hangs)


def holds(quantity: Quantity, value: float) -> bool:
    """Whether a quantity has the value within three quarters more than its interval, and is known to 5 %."""
    return bool(abs(quantity.value - value) < 1.75 * Z95 * quantity.std < 0.05 * value)


@pytest.mark.parametrize("hangs", [0.0, 0.7, -2.0])
def test_a_regression_finds_gravity_and_where_the_joint_hangs(hangs: float) -> None:
    problem = formulate(Plant(7.0, 2.0, 0.0) + Gravity(0.1), (there_and_back(hangs),), {"stiffness": 0.0})
    start = regressed(problem)[2]
    assert start.values["mass"] == pytest.approx(TRUE[0], rel=0.02)
    assert start.values["gravity_moment"] == pytest.approx(TRUE[2], rel=0.02)
    assert start.initial[0][2] == pytest.approx(hangs, abs=0.01)


def test_records_with_a_zero_each_share_the_moment() -> None:
    records = (there_and_back(0.4), to_the_top(-1.1))
    start = regressed(formulate(Plant(7.0, 2.0, 0.0) + Gravity(0.1), records, {"stiffness": 0.0}))[2]
    assert start.values["gravity_moment"] == pytest.approx(TRUE[2], rel=0.03)
    assert [initial[2] for initial in start.initial] == pytest.approx([0.4, -1.1], abs=0.02)


def test_gravity_is_fitted_from_a_wrong_start() -> None:
    """A tenth of the inertia, a thirtieth of the moment, and an angle that nobody knows."""
    found = fit(Plant(0.018, 0.2, 0.0) + Gravity(0.1), round_and_round(0.7), fixed={"stiffness": 0.0})
    assert holds(found.quantities["mass"], TRUE[0]) and holds(found.quantities["gravity_moment"], TRUE[2])


@pytest.mark.usefixtures("without_copies")
@pytest.mark.parametrize("hangs", [0.0, 0.7])
@pytest.mark.parametrize(
    ("made", "asked"),
    [
        (round_and_round, ()),
        (to_the_top, ()),
        (there_and_back, ("gravity", "cubic_spring", "force_offset", "coulomb_friction")),
        pytest.param(there_and_back, (), marks=pytest.mark.long),
    ],
    ids=["round_and_round", "to_the_top", "there_and_back", "there_and_back, whole library"],
)
def test_gravity_is_named_however_far_the_joint_turns(
    made: Callable[[float], Record], asked: tuple[str, ...], hangs: float, asking_about: Callable[..., None]
) -> None:
    if asked:
        asking_about(*asked)
    found = pipeline.diagnose([made(hangs)])
    assert [(cause.name, cause.probability > 0.9) for cause in found.causes] == [("gravity", True)]
    assert found.verdict == "explained"
    assert holds(found.extended.quantities["mass"], TRUE[0])
    assert holds(found.extended.quantities["gravity_moment"], TRUE[2])


@pytest.mark.usefixtures("without_copies")
@pytest.mark.parametrize("most", [0.4, 1.5])
def test_a_constant_moment_on_a_joint_is_not_called_gravity(most: float, asking_about: Callable[..., None]) -> None:
    """Over half a radian, and over two."""
    asking_about("gravity", "force_offset", "cubic_spring", "coulomb_friction")
    found = pipeline.diagnose([turned(to_and_fro(most), 6.0, (0.18, 0.7, 0.0), rest=lambda _: most / 7.5)])
    assert found.causes[0].name == "force_offset" and "gravity" not in {cause.name for cause in found.causes}


@pytest.mark.usefixtures("without_copies")
def test_friction_is_named_beside_gravity_however_far_the_joint_swings(asking_about: Callable[..., None]) -> None:
    """The friction of a bearing follows its load, so more than noise is left. It explains a hundredth of what gravity
    does, which was taken for an error of gravity's law.
    """
    asking_about("gravity", "coulomb_friction", "cubic_spring", "quadratic_drag")
    levels = [part * TRUE[2] for part in (0.65, 0.0, -0.65, 0.0, 0.455, 0.0, -0.325, 0.0)]
    bearing = turned(lambda t, _, __: levels[int(t / 2.0)], 16.0, TRUE, rubs=lambda q: 0.02 * (0.6 + 0.4 * math.cos(q)))
    found = pipeline.diagnose([bearing])
    assert {cause.name: cause.probability > 0.9 for cause in found.causes} == {
        "gravity": True, "coulomb_friction": True,
    }  # fmt: skip
    assert found.extended.model["damping"] == pytest.approx(TRUE[1], rel=0.03), "without friction 15 % more"


@pytest.mark.usefixtures("without_copies")
def test_a_weak_spring_is_not_called_gravity(asking_about: Callable[..., None]) -> None:
    """Relaxed elsewhere, and a little curved."""
    asking_about("gravity", "cubic_spring", "asymmetric_spring", "force_offset")
    record = turned(to_and_fro(1.2), 8.0, (0.18, 0.4, 0.0), rest=lambda q: 0.05 - 0.02 * (q + 0.8) - 0.01 * q**3)
    found = pipeline.diagnose([record])
    assert not any(cause.name == "gravity" and cause.probability > 0.5 for cause in found.causes)


def to_and_fro(most: float) -> Callable[[float, float, float], float]:
    """A torque [N·m] that changes its sign every 0.4 s."""
    return lambda t, _, __: math.copysign(most, math.sin(7.9 * t))


def posed(hangs: float = 0.7) -> Experiment:
    """A joint on which no spring was found."""
    return Experiment(noise_model.prepare((to_the_top(hangs),)), Plant(*TRUE[:2], 0.0), frozenset({"stiffness"}))


@pytest.mark.usefixtures("without_copies")
def test_no_spring_is_assumed_beside_gravity_that_does_all_that_one_could(asking_about: Callable[..., None]) -> None:
    """ "A spring is assumed" stood beside gravity > 99.9 % and a stiffness of 0.0000 ± 0.0040."""
    asking_about("gravity", "cubic_spring", "coulomb_friction")
    swept = turned(lambda t, _, __: 1.6 * math.sin(2.0 * t + 0.45 * t**2), 10.0, (0.18, 0.12, 3.7))
    assert spring_decision.plain((swept,)), "as a regression of the torque has it"
    found = pipeline.diagnose([swept])
    assert [cause.name for cause in found.causes] == ["gravity"]
    assert not any("a spring is assumed" in said for said in found.warnings)


def test_where_it_hangs_is_fitted_and_counts_as_a_parameter_of_gravity() -> None:
    experiment, model = posed(), Plant(*TRUE[:2], 0.0) + Gravity(TRUE[2])
    bare, hung = experiment.problem(experiment.base), experiment.problem(model)
    assert [n.kind for n in hung.nuisances] == [*(n.kind for n in bare.nuisances), "zero"]
    fitted = refine(experiment, frozenset({"gravity"}), model, (Initial(0.0, 0.0, 0.7),))
    assert fitted.initial[0].zero == pytest.approx(0.7, abs=0.01)
    alone = replace(fitted, problem=replace(fitted.problem, nuisances=(Nuisance(0, "initial position"),) * 3))
    assert occam(fitted, 1.0) > occam(alone, 1.0) + 1.0, "known to a part of a radian, which costs"


@pytest.mark.parametrize(("turn", "there"), [(2.0 * math.pi, True), (0.7 * 2.0 * math.pi, False)])
def test_a_ripple_of_one_turn_is_begun_again_as_gravity(turn: float, there: bool) -> None:
    """Beside friction gravity's own starts may fail where the ripple's do not: it was named, with 0.95."""
    hangs = -0.9
    record = round_and_round(hangs)
    data = Experiment(noise_model.prepare((record,)), Plant(*TRUE[:2], 0.0), frozenset({"stiffness"}))
    cogs = Plant(*TRUE[:2], 0.0) + Cogging(TRUE[2], turn, 2.0 * math.pi - hangs)
    found = {causes: rest for causes, *rest in reduced(stood(data, cogs), data.library)}
    assert (frozenset({"gravity"}) in found) is there
    if there:
        model, initial = found[frozenset({"gravity"})]
        assert initial[0].zero == pytest.approx(hangs)
        assert initial[0].position + initial[0].zero == pytest.approx(0.0), "the same reading"
        begun = refine(data, frozenset({"gravity"}), model, (Initial(0.0, 0.0, initial[0].zero),))
        assert begun.chi < 1.2 * data.evidence


def test_a_state_counted_from_a_zero_is_the_same_state_where_there_is_none() -> None:
    problem = posed().problem(Plant(*TRUE[:2], 0.0))
    values = dict(zip(problem.model.names, problem.model.values.tolist(), strict=True))
    (start,) = problem.initials(problem.vector(values, [Initial(-0.2, 1.0, 0.9)]))
    assert start.position == pytest.approx(0.7) and start.zero == 0.0


@pytest.mark.usefixtures("without_copies")
def test_gravity_is_found_behind_a_spring_that_softens(asking_about: Callable[..., None]) -> None:
    """Beside dry friction gravity's own start ended with twice the friction; a power spring had no rival: 0.95."""
    asking_about("gravity", "cubic_spring", "power_spring", "coulomb_friction")
    found = pipeline.diagnose([dropped(20.0, (0.2, 30.0, 0.003), 0.3, 1.48, 1.5)])
    assert {cause.name: cause.probability > 0.9 for cause in found.causes} == {
        "gravity": True, "coulomb_friction": True,
    }  # fmt: skip
    assert found.extended.model["gravity_moment"] == pytest.approx(30.0, rel=0.005)


@pytest.mark.parametrize(("cubic", "there"), [(-2.0, True), (2.0, False)])
def test_a_spring_that_softens_is_begun_again_as_gravity(cubic: float, there: bool) -> None:
    plant = Plant(1.0, 0.2, 27.0)
    readings = noise_model.prepare((dropped(4.0, (0.2, 30.0, 0.003), 0.3, 1.0, 0.0),))
    data = Experiment(readings, plant, frozenset({"mass"}))
    found = {causes: model for causes, model, _ in reduced(stood(data, plant + CubicSpring(cubic)), data.library)}
    assert (found.get(frozenset({"gravity"})) == Plant(1.0, 0.2, 0.0) + Gravity(27.0)) is there
