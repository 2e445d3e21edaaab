"""Records of two rigs in one experiment, and of one rig whose frequency depends on the amplitude."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from msd_ident.data.record import Record
from msd_ident.diagnosis import same_plant
from msd_ident.errors import DataError
from msd_ident.workflow import pipeline
from msd_sim.api import simulate


def step(name: str, force: float, **rig: object) -> Record:
    made = simulate(
        {
            "mass": 1.0, "damping": 4.0, "stiffness": 700.0, "friction_coefficient": 0.0, "duration": 4.0,
            "force_time": [0.0, 0.2, 2.1], "force": [0.0, force, 0.0], "rate": 250.0,
            "encoder.counts_per_metre": 0.0, "encoder.noise": 1e-5, **rig,
        }
    )  # fmt: skip
    return Record(made.time, made.position, made.force_time, made.force, name=name)


@pytest.mark.parametrize(
    "asked", [("coulomb_friction", "cubic_spring", "stiffness_drift"), pytest.param((), marks=pytest.mark.long)]
)
def test_records_of_two_rigs_are_said_and_refused(asked: tuple[str, ...], asking_about: Callable[..., None]) -> None:
    """Whatever bends or changes a spring, or the whole library."""
    if asked:
        asking_about(*asked)
    found = pipeline.diagnose([step("first", 8.0), step("second", 8.0, stiffness=1500.0)])
    assert found.left.exceeds and found.left.extended.motion_percent > 20.0
    said = [line for line in found.warnings if "of one rig" in line]
    assert said and said[0].startswith("second swings at 38.7 rad/s, first at 26.5, and no explanation fits both")
    with pytest.raises(DataError, match="expected records of one rig: leave the other one out"):
        same_plant.check(found)


def test_a_rig_that_swings_faster_where_its_spring_is_stiffer_is_one_rig(asking_about: Callable[..., None]) -> None:
    asking_about("coulomb_friction", "cubic_spring", "stiffness_drift")
    stiffens = {"effects": ["cubic_spring"], "cubic_spring.cubic_stiffness": 5e6}
    records = [step("large", 10.0, **stiffens), step("small", 0.3, **stiffens)]
    assert same_plant.warning(records)
    found = pipeline.diagnose(records)
    assert [cause.name for cause in found.causes] == ["cubic_spring"]
    same_plant.check(found)


def test_a_record_in_which_nothing_happens_is_left_out_beside_others() -> None:
    alone = step("rest", 0.0)
    with pytest.raises(DataError, match="the force never changes and the position only by"):
        pipeline.diagnose([alone])
    found = pipeline.diagnose([step("step", 8.0), alone])
    assert found.verdict == "adequate"
    assert [record.name for record in found.records] == ["step"]
    assert any(line.startswith("rest is left out: its force never changes") for line in found.warnings)
