"""Where sets of causes start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from massrigs import swept
from setrigs import BASE, pushed, stood

from msd_ident.data.record import Record
from msd_ident.design import Profile, Segment
from msd_ident.estimate.broyden import State, Weighting, extended
from msd_ident.estimate.problem import Initial
from msd_ident.model import Plant, simulate
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.stribeck_friction import StribeckFriction
from msd_ident.residuals import noise_model
from msd_ident.selection import starting_points
from msd_ident.selection.experiment import Experiment
from msd_ident.selection.hypothesis_fit import refine
from msd_ident.selection.starting_points import proposals
from msd_ident.workflow import pipeline
from msd_sim import api

#: What a search takes longest to tell from the causes of these tests; asking about the rest costs most of the time.
RIVALS = ("coulomb_friction", "quadratic_drag", "cubic_spring", "end_stop", "backlash", "hysteresis")


def played(rig: dict[str, object], profile: Profile, seed: int, rate: float) -> Record:
    """What a rig at rest does under a profile."""
    at, force = profile.commands
    given = {"force_time": at, "force": force, "duration": profile.duration, "rate": rate, "seed": seed}
    made = api.simulate(rig | given)
    return Record(time=made.time, position=made.position, force_time=at, force=force, name=profile.name)


@pytest.mark.usefixtures("without_copies")
def test_friction_and_drag_of_one_step_at_few_samples_a_swing_are_not_taken_for_three_other_causes() -> None:
    """Where the cart comes to stick makes valleys: beside friction alone, the drag ends at none; a regression helps."""
    made = api.simulate(
        {"mass": 0.9407, "damping": 3.927, "stiffness": 694.1, "friction_coefficient": 0.0133,
         "effects": {"quadratic_drag": {"drag_coefficient": 4.0}}, "rate": 100.0, "duration": 3.0, "seed": 7,
         "encoder": {"counts_per_metre": 226600.0, "noise": 1e-5}, "force_time": [0.0], "force": [10.0]}
    )  # fmt: skip
    record = Record(time=made.time, position=made.position, force_time=made.time, force=np.full(made.time.size, 10.0))
    found = pipeline.diagnose([record])
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "quadratic_drag"}
    assert found.adequacy.ratio < 1.15


@pytest.mark.parametrize("asked", [RIVALS, pytest.param((), marks=pytest.mark.long)], ids=["rivals", "whole library"])
def test_a_start_that_the_base_model_moved_aside_is_moved_back(
    asked: tuple[str, ...], asking_about: Callable[..., None]
) -> None:
    """Without its friction the model begins a record aside, to make up for it; with friction the cart then sticks, and
    every set that starts there is lost but one that happens to get out.
    """
    if asked:
        asking_about(*asked)
    rig = {
        "mass": 1.7187070702549694, "damping": 15.73123380305705, "stiffness": 1999.4229808197626,
        "effects": {"cubic_spring": {"cubic_stiffness": 20454.807636276055},
                    "coulomb_friction": {"coulomb_force": 0.4172526471518924}},
        "friction_coefficient": 0.0, "encoder": {"counts_per_metre": 0.0, "noise": 1.6241630047030402e-05},
    }  # fmt: skip
    train = Segment("prbs", 9.95, amplitude=32.993749493070894, shortest=0.3631785129704697, seed=200)
    up, down = Segment("step", 0.5526635934038728, force=38.187144257754426), Segment("release", 0.5526635934038728)
    profiles = (
        Profile((Segment("hold", 0.3), Segment("step", 2.7, force=38.187144257754426)), "one step"),
        Profile((Segment("hold", 0.1), train), "train", rate=110.13867442992814),
        Profile((Segment("hold", 0.1), up, down), "step and back", rate=108.56513929288897),
    )
    found = pipeline.diagnose([played(rig, profile, 80848677 + i, 1000.0) for i, profile in enumerate(profiles)])
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "cubic_spring"}
    assert found.verdict == "explained"


def test_what_mean_forces_between_few_samples_made_look_necessary_is_left_out_again(
    asking_about: Callable[..., None],
) -> None:
    """A long record is searched on few samples, and the mean of a force is not what a saturating actuator makes of it:
    there a third cause seems to help.
    """
    asking_about(*RIVALS, "force_gain_nonlinearity")
    rig = {
        "mass": 0.6022981282647728, "damping": 0.5585627357592347, "stiffness": 175.17159426634015,
        "effects": {"force_gain_nonlinearity": {"gain_slope": 0.0, "force_limit": 0.6816832298845992},
                    "coulomb_friction": {"coulomb_force": 0.0354764035590457}},
        "friction_coefficient": 0.0, "encoder": {"counts_per_metre": 0.0, "noise": 1.6512721457957805e-06},
    }  # fmt: skip
    peak, swing = 0.9590007881431093, 1.1052910366477469
    shares = (0.6, 0.5, 0.6, 0.5, 0.6, 0.3, 0.6, 0.3, 0.6)
    reversals = [Segment("ramp", swing, force=share * peak) for share in shares]
    sweep = Segment("sweep", 19.9, amplitude=peak, low_hz=0.13571078885215895, high_hz=1.6285294662259073)
    profiles = (
        Profile((Segment("hold", 0.3), Segment("step", 2.7, force=peak)), "one step"),
        Profile((Segment("hold", 0.1), *reversals, Segment("release", swing)), "small reversals", rate=100.0),
        Profile((Segment("hold", 0.1), sweep), "slow sweep", rate=100.0),
    )
    found = pipeline.diagnose([played(rig, profile, 1258165156 + i, 250.0) for i, profile in enumerate(profiles)])
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "force_gain_nonlinearity"}


@pytest.mark.long
def test_a_saturation_starts_from_the_largest_force_of_all_records(asking_about: Callable[..., None]) -> None:
    """The liveliest record swings at resonance under a small force, and knows nothing of the actuator's limit."""
    asking_about(*RIVALS, "force_gain_nonlinearity")
    rig = {
        "mass": 1.3298888679615495, "damping": 3.691999743209331, "stiffness": 683.0152412812138,
        "effects": {"force_gain_nonlinearity": {"gain_slope": 0.0, "force_limit": 9.22200042907773},
                    "coulomb_friction": {"coulomb_force": 0.39712309135121243}},
        "friction_coefficient": 0.0, "encoder": {"counts_per_metre": 0.0, "noise": 3.215944291406006e-06},
    }  # fmt: skip
    sweep = Segment("sweep", 4.975, amplitude=2.9019515378582406, low_hz=0.5410288328793923, high_hz=9.01714721465654)
    profiles = (
        Profile((Segment("hold", 0.3), Segment("step", 2.7, force=11.362716018514561)), "one step"),
        Profile((Segment("hold", 0.1), sweep), "sweep", rate=360.68588858626157),
    )
    found = pipeline.diagnose([played(rig, profile, 1759094095 + i, 1000.0) for i, profile in enumerate(profiles)])
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "force_gain_nonlinearity"}
    assert found.extended.model["force_limit"] == pytest.approx(9.222, rel=1e-3)
    assert found.verdict in ("explained", "ambiguous")


@pytest.mark.long
def test_what_stood_on_fewer_records_is_tried_on_more_of_them() -> None:
    """Small steps within the play lead a fresh search to an end stop, which leaves as little; play is what stood."""
    rig = {
        "mass": 1.4345993608214602, "damping": 6.344912206420781, "stiffness": 1203.0158949650306,
        "effects": {"backlash": {"backlash_half_width": 0.0013837445025098331},
                    "coulomb_friction": {"coulomb_force": 0.756005273977567}},
        "friction_coefficient": 0.0, "encoder": {"counts_per_metre": 340771.7548995695, "noise": 2.217803512853204e-06},
    }  # fmt: skip
    wait, large, small = 0.65092, 20.985279806973903, 2.09852798069739
    release = Segment("release", wait)
    profiles = (
        Profile((Segment("hold", 0.3), Segment("step", 2.7, force=large)), "one step"),
        Profile((Segment("hold", 0.1), Segment("step", wait, force=large), release), "step and back"),
        Profile(
            (Segment("hold", 0.1), Segment("step", wait, force=small), release, Segment("step", wait, force=-small),
             release), "small steps",
        ),
    )  # fmt: skip
    records = [played(rig, profile, 1511774626 + i, 1000.0) for i, profile in enumerate(profiles)]
    earlier = pipeline.diagnose(records[:2])
    assert {cause.name for cause in earlier.causes} == {"backlash", "coulomb_friction"}
    found = pipeline.diagnose(records, earlier=earlier)
    assert {cause.name for cause in found.causes} == {"backlash", "coulomb_friction"}
    assert found.extended.model["backlash_half_width"] == pytest.approx(0.0013837, rel=1e-2)


def test_what_stood_on_fewer_records_needs_no_search_to_be_found_on_more_of_them(
    asking_about: Callable[..., None],
) -> None:
    """A search that asks about a stop in place of the play finds the stop, which leaves as little."""
    rig = {
        "mass": 1.4, "damping": 6.3, "stiffness": 1200.0, "friction_coefficient": 0.0,
        "effects": {"backlash": {"backlash_half_width": 1e-3}, "coulomb_friction": {"coulomb_force": 0.5}},
        "encoder": {"counts_per_metre": 0.0, "noise": 1e-5},
    }  # fmt: skip
    hold, release = Segment("hold", 0.1), Segment("release", 0.65)
    sizes = {force: [Segment("step", 0.65, force=sign * force) for sign in (1.0, -1.0)] for force in (20.0, 5.0)}
    profiles = [Profile((hold, up, release, down, release), f"{force} N") for force, (up, down) in sizes.items()]
    records = [played(rig, profile, 3 + i, 200.0) for i, profile in enumerate(profiles)]
    asking_about("backlash", "coulomb_friction")
    earlier = pipeline.diagnose(records[:1])
    asking_about("end_stop", "coulomb_friction")
    for before, spring in ((earlier, "backlash"), (None, "end_stop")):
        found = pipeline.diagnose(records, earlier=before)
        assert {cause.name for cause in found.causes} == {spring, "coulomb_friction"} and found.verdict == "explained"


def test_starts_at_one_point_are_simulated_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Close to doing nothing, a stop is the same wherever it stands: several of its guesses become one start."""
    points = []

    def counted(weighting: Weighting, *given: Any) -> list[State]:
        points.extend((id(weighting), point.tobytes()) for point in given[-1])
        return extended(weighting, *given)

    experiment = pushed(CoulombFriction(0.3))
    parent = refine(experiment, frozenset(), BASE, (Initial(0.0, 0.0, 0.0),))
    monkeypatch.setattr(starting_points, "extended", counted)
    assert proposals(experiment, frozenset({"one_sided_stop"}), [parent])
    assert len(points) > 4 and len(points) == len(set(points))


def test_a_guess_that_is_too_strong_is_tried_weakly() -> None:
    """A damper of the drive ten times too strong makes the fit worse; next to nothing of it shows the way down."""
    made = api.simulate(
        {"mass": 1.0, "damping": 2.0, "stiffness": 400.0, "friction_coefficient": 0.0, "seed": 2,
         "effects": {"drive_brake": {"driven_damping": 0.3}}, "encoder": {"counts_per_metre": 0.0, "noise": 1e-6},
         "force_time": [0.0, 1.0], "force": [5.0, 0.0], "duration": 2.0, "rate": 500.0}
    )  # fmt: skip
    record = Record(made.time, made.position, made.force_time, made.force)
    experiment = Experiment(noise_model.prepare([record]), Plant(1.0, 2.0, 400.0), frozenset())
    base = refine(experiment, frozenset(), experiment.base, experiment.problem(experiment.base).initial)
    best = starting_points.proposals(experiment, frozenset({"drive_damping"}), [base])[0]
    assert best.fitted.model["drive_damping"] < 0.5, "the library's guess is 2 and more"
    assert best.promise < 0.1 * base.chi


def test_a_heavy_second_mass_beside_friction_is_found(asking_about: Callable[..., None]) -> None:
    asking_about(*RIVALS, "second_mode")
    second = {"second_mass": 0.36, "second_stiffness": 3017.0, "second_damping": 1.7}
    record = swept({"second_mode": second, "coulomb_friction": {"coulomb_force": 0.2}})
    found = pipeline.diagnose([record], pipeline.Options(model="spring"))
    assert {cause.name for cause in found.causes} == {"coulomb_friction", "second_mode"}
    assert found.extended.model["second_mass"] == pytest.approx(0.36, rel=0.02)


def test_an_offset_that_shows_by_the_drift_of_the_spring_alone_is_found(asking_about: Callable[..., None]) -> None:
    """With a spring of one stiffness it is a shifted zero: along that direction a damped step hardly moves."""
    asking_about("stiffness_drift", "force_offset", "cubic_spring", "asymmetric_spring", "coulomb_friction")
    made = api.simulate(
        {"mass": 2.218, "damping": 18.14, "stiffness": 1128.8, "friction_coefficient": 0.0, "rate": 1000.0, "seed": 5,
         "experiment": {"name": "steps", "force": 21.54, "hold": 0.75}, "encoder.counts_per_metre": 0.0,
         "effects": {"stiffness_drift": {"stiffness_drift_rate": 0.0104}, "force_offset": {"offset_force": -2.367}},
         "encoder.noise": 8.84e-6}
    )  # fmt: skip
    found = pipeline.diagnose([Record(made.time, made.position, made.force_time, made.force)])
    assert {cause.name for cause in found.causes} == {"stiffness_drift", "force_offset"}
    assert found.adequacy.ratio < 1.05


@pytest.mark.parametrize("scale", [0.1, 0.2, 0.3, 0.5])
def test_friction_that_falls_over_all_speeds_is_found_from_coulomb_friction(scale: float) -> None:
    """Coulomb friction as strong as at rest leaves 10 to 100 noise floors, and a narrow peak beside it no less."""
    data = pushed(StribeckFriction(0.1, 0.4, scale))
    coulomb = refine(data, frozenset({"coulomb_friction"}), BASE + CoulombFriction(0.2), (Initial(),))
    found = proposals(data, frozenset({"stribeck_friction"}), [coulomb])
    best = min(refine(data, start.fitted.causes, start.fitted.model, coulomb.initial).chi for start in found)
    assert best < 1.1 * data.evidence < coulomb.chi


def test_a_guess_of_a_record_knows_the_largest_force_of_all_records() -> None:
    """The liveliest one swings at resonance under a small force: a limit of the force lies near the other's."""
    time = np.arange(500) / 250.0
    forces = np.full(500, 8.0), 2.0 * np.sin(20.0 * time)
    still = [Record(time, np.zeros(500), time, force) for force in forces]
    records = [replace(one, position=simulate(BASE, one).position) for one in still]
    experiment = Experiment(noise_model.prepare(records), BASE, frozenset())
    found = starting_points.fitted_record(experiment, stood(experiment, BASE), BASE)
    assert found.measured is experiment.records[1] and found.largest == 8.0
