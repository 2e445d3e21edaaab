"""Rigs with a hidden effect: the diagnosis gets a file path and nothing else, then the envelope is opened.

Every case is drawn from its seed by the rig itself: plant, encoder, effect and strength. The long study over many more
is ``make blind``.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from bench.blind.cases import Case, Outcome, run
from bench.blind.rigs import write
from msd_ident.io import SourceOptions, read
from msd_ident.model.effects import spoken
from msd_ident.workflow import pipeline
from msd_sim import lottery

#: Where the truth without the hidden effect leaves this many noise floors, the effect is there to be found.
VISIBLE = 3.0
DRY = ("coulomb_friction", "stribeck_friction", "position_dependent_friction")
#: With a linear spring it is a shift of the zero and nothing else: no record shows it.
INVISIBLE = "force_offset"

ALONE = [Case(1000 + i, name, False) for i, name in enumerate(lottery.NAMES)]
BESIDE = [Case(1100 + i, name, True) for i, name in enumerate(lottery.NAMES) if name not in DRY]
#: Of each kind of law one, alone: friction, a spring, a gap, a disturbance, what drifts, a delay; or beside friction: a
#: damper, a memory, the drive, a second mass.
SHORT = {
    ("stribeck_friction", False), ("cubic_spring", False), ("backlash", False), ("cogging", False),
    ("stiffness_drift", False), ("time_offset", False), ("quadratic_drag", True), ("hysteresis", True),
    ("force_gain_nonlinearity", True), ("second_mode", True),
}  # fmt: skip
CLEAN = [Case(1200 + i, None, False) for i in range(8)]
#: Coulomb friction left 1.2 noise floors and was certain: a start of Stribeck friction with a peak of 1.3 promised 3.
FAINT_PEAK = Case(452043, "stribeck_friction", False, "steps", 1000.0, other="end_stop", ranges="wide")
#: Friction that changes along the travel left 136 noise floors at first, later 14; the pairs begun from the first fit
#: were not begun again, and cogging was not found.
LATE_MINIMUM = Case(
    462145, "position_dependent_friction", False, "steps", 1000.0, other="cogging", ranges="wide", noise="white"
)
#: Coulomb friction was stated with 0.99, beside drag and a disturbance.
ONE_DECAY = Case(631613, "stribeck_friction", True, "release", 1000.0, ranges="wide")
#: Of many by lot; a search that nothing ends takes seconds, up to a minute. ``make blind`` has them all.
ODD = [
    Case(70181, "eccentric_friction", False),
    Case(70184, "loose_cable", False),
    Case(70601, "friction_change", False),
    Case(70182, "mass_drop", False),
]


def drawn(cases: list[Case]) -> list[Case]:
    """The cases; ``long`` are those of whose kind there is another."""
    extra = [case for case in cases if (case.hidden, case.beside) not in SHORT]
    return [pytest.param(case, marks=pytest.mark.long) if case in extra else case for case in cases]


def label(case: Case) -> str:
    return f"{case.seed}-{case.hidden or 'nothing'}{'-and-coulomb' if case.beside else ''}"


@cache
def outcome(case: Case) -> Outcome:
    return run(case)


@pytest.mark.parametrize("case", drawn([c for c in ALONE + BESIDE if c.hidden != INVISIBLE]), ids=label)
def test_hidden_cause_is_named_and_nothing_else(case: Case) -> None:
    found = outcome(case)
    if found.without_floors < VISIBLE:
        assert found.verdict != "unexplained"
        assert found.names <= set(found.truth)
        return
    assert found.exact, found
    assert found.verdict in ("explained", "ambiguous")
    assert found.extended_floors < 1.2
    assert found.heldout_floors < 1.5


def test_a_faint_stribeck_peak_beside_a_stop_is_not_taken_for_coulomb_friction(
    asking_about: Callable[..., None],
) -> None:
    asking_about("coulomb_friction", "stribeck_friction", "end_stop")
    assert run(FAINT_PEAK).exact


def test_sets_are_begun_again_when_a_smaller_one_is_found_to_leave_less(asking_about: Callable[..., None]) -> None:
    asking_about("position_dependent_friction", "cogging", "coulomb_friction", "stribeck_friction")
    assert run(LATE_MINIMUM).exact


@pytest.mark.usefixtures("without_copies")
def test_a_stribeck_curve_is_not_taken_for_coulomb_friction_and_drag_in_one_decay(
    asking_about: Callable[..., None],
) -> None:
    """From Coulomb friction alone its fit ends at 3.9 noise floors; both and a disturbance leave 1.03."""
    asking_about("coulomb_friction", "stribeck_friction", "quadratic_drag", "periodic_disturbance")
    assert run(ONE_DECAY).exact


@pytest.mark.parametrize("case", [c for c in ALONE + BESIDE if c.hidden == INVISIBLE], ids=label)
def test_what_no_record_shows_is_not_claimed(case: Case) -> None:
    found = outcome(case)
    assert found.without_floors < 1.1
    assert found.names == set(found.truth) - {INVISIBLE}


@pytest.mark.parametrize("case", CLEAN, ids=label)
def test_nothing_is_invented(case: Case) -> None:
    found = outcome(case)
    assert found.verdict == "adequate"
    assert not found.named


@pytest.mark.long
@pytest.mark.parametrize("case", ODD, ids=label)
def test_what_the_library_lacks_is_never_called_explained(case: Case) -> None:
    found = outcome(case)
    assert found.base_floors > VISIBLE
    assert found.verdict not in ("adequate", "explained")
    assert found.extended_floors > 2.0


@pytest.mark.parametrize(
    ("hidden", "strength", "seed"),
    [
        ("sensor_drift", {"sensor_drift_rate": 0.004}, 1),
        ("force_offset", {"offset_force": 0.05}, 2),
        ("force_offset", {"offset_force": -0.08}, 3),
    ],
)
def test_what_the_record_cannot_separate_stands_together(
    tmp_path: Path, hidden: str, strength: dict[str, float], seed: int
) -> None:
    """On a plain axis with viscous friction a constant force and a drifting sensor are one and the same motion."""
    spec = {
        "mass": 1.0, "damping": 4.0, "stiffness": 0.0, "friction_coefficient": 0.0, "effects": {hidden: strength},
        "encoder": {"counts_per_metre": 20000.0, "noise": 1e-5}, "rate": 250.0, "seed": seed,
        "experiment": {"name": "steps", "force": 3.0, "hold": 0.4},
    }  # fmt: skip
    write(lottery.Draw(seed, spec, hidden, False, "steps", 2e-5), tmp_path / "record.csv")
    plain = pipeline.Options(model="no_spring")
    found = pipeline.diagnose([read(tmp_path / "record.csv", SourceOptions())], plain)
    assert found.verdict == "ambiguous"
    (cause,) = found.causes
    assert {cause.name, *cause.tied_with} == {"sensor_drift", "force_offset"}
    assert 0.2 < cause.probability < 0.8
    names = f"{spoken(cause.name)} from {spoken(cause.tied_with[0])}"
    acts = "(one of them acts: probability > 99.9 %)"
    assert f"this data cannot tell {names} {acts}. With it, the residual is consistent with noise" in found.summary
