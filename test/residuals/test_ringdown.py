"""ζ(A) and ωn(A) tell dry friction from drag and a bent spring at a glance."""

from __future__ import annotations

import numpy as np
import pytest

from msd_ident.data.record import Record
from msd_ident.features import extract
from msd_ident.residuals.ringdown import RingDown, ring_down
from msd_ident.workflow import pipeline
from msd_sim import api

MASS, STIFFNESS, AMPLITUDE = 1.0, 400.0, 0.02


def released(effects: dict[str, dict[str, float]], noise: float = 2e-6) -> Record:
    """A cart let go at 20 mm, seen by the rig's own encoder."""
    made = api.simulate(
        {
            "mass": MASS, "damping": 0.8, "stiffness": STIFFNESS, "friction_coefficient": 0.0, "effects": effects,
            "encoder": {"counts_per_metre": 0.0, "noise": noise}, "rate": 1000.0, "seed": 3,
            "experiment": {"name": "release", "position": AMPLITUDE, "duration": 4.0},
        }
    )  # fmt: skip
    return Record(time=made.time, position=made.position, force_time=made.force_time, force=made.force)


def found(effects: dict[str, dict[str, float]]) -> RingDown:
    """The ring-down of one release."""
    result = ring_down([extract(released(effects))])
    assert result is not None
    return result


def test_dry_friction_raises_the_ratio_of_small_swings_by_the_known_law() -> None:
    coulomb = 0.15
    result = found({"coulomb_friction": {"coulomb_force": coulomb}})
    assert "rises" in result.sentences[0] and result.observations[0].law == "dry friction"
    viscous = 0.8 / (2.0 * np.sqrt(MASS * STIFFNESS))
    expected = viscous + 2.0 * coulomb / (np.pi * STIFFNESS * result.amplitude)
    large = result.amplitude > 0.2 * AMPLITUDE
    assert large.sum() > 5
    assert result.damping_ratio[large] == pytest.approx(expected[large], rel=0.06)


def test_drag_lowers_it_by_the_known_law() -> None:
    drag = 4.0
    result = found({"quadratic_drag": {"drag_coefficient": drag}})
    assert "falls" in result.sentences[0] and "drag" in result.observations[0].law
    viscous = 0.8 / (2.0 * np.sqrt(MASS * STIFFNESS))
    expected = viscous + 4.0 * drag * result.amplitude / (3.0 * np.pi * MASS)
    assert result.damping_ratio == pytest.approx(expected, rel=0.06)


def test_a_hardening_spring_is_told_by_its_frequency_alone() -> None:
    result = found({"cubic_spring": {"cubic_stiffness": 1e5}})
    assert len(result.sentences) == 1
    assert "natural frequency falls" in result.sentences[0] and "hardening" in result.observations[0].law


CALLED, NOT = (
    "as expected from a hardening spring.",
    "a hardening spring would cause this, but the diagnosis does not name it.",
)


@pytest.mark.parametrize(
    ("named", "tied", "reading"),
    [
        ({"cubic_spring": 1e5}, (), CALLED),
        ({"coulomb_friction": 0.1, "backlash": 1e-3}, (), CALLED),
        ({"cubic_spring": -1e5}, (), NOT),
        ({"coulomb_friction": 0.1}, (), NOT),
        ({}, (), NOT),
        ({"coulomb_friction": 0.1}, ("end_stop",), "which is one of the causes that this data cannot tell apart."),
    ],
)
def test_what_is_read_in_it_never_contradicts_the_diagnosis(
    named: dict[str, float], tied: tuple[str, ...], reading: str
) -> None:
    plain = found({"cubic_spring": {"cubic_stiffness": 1e5}})
    told = plain.read_with(named, tied)
    assert told.sentences[0].endswith(reading)
    assert told.sentences[0].startswith(plain.sentences[0].rstrip("."))
    assert "hardening" not in plain.sentences[0]


@pytest.mark.usefixtures("without_copies")
def test_a_diagnosis_reads_it_with_its_own_causes() -> None:
    """The frequency of a rubbing cart on a linear spring, says nothing of a bent one."""
    result = pipeline.diagnose([released({"coulomb_friction": {"coulomb_force": 0.15}})])
    assert [one.name for one in result.causes] == ["coulomb_friction"] and result.ring_down is not None
    said = result.ring_down.sentences
    assert said[0].endswith("as expected from dry friction.")
    assert all("but the diagnosis does not name it" in sentence for sentence in said if "spring" in sentence)


def test_a_linear_plant_says_nothing() -> None:
    assert found({}).sentences == ()


def test_too_few_swings_are_none() -> None:
    time = np.linspace(0.0, 1.0, 500)
    still = Record(time=time, position=np.where(time < 0.5, 0.0, 1e-3), force_time=[0.0], force=[0.0])
    assert ring_down([extract(still)]) is None
