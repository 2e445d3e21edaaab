"""Rigs that play profiles, for the tests of designs."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
import once
import pytest

from msd_ident.data.record import Record
from msd_ident.design import Limits, Profile, Proposal, Segment, check
from msd_ident.design.prediction import Sensing
from msd_ident.diagnosis import Diagnosis
from msd_ident.estimate.problem import Initial
from msd_ident.model import Model
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.workflow import investigation, pipeline
from msd_ident.workflow.investigation import Ran
from msd_sim import api

ECP = {"mass": 0.94, "damping": 3.9, "stiffness": 694.0, "friction_coefficient": 0.0, "rate": 500.0}
NOISE = {"counts_per_metre": 226600.0, "noise": 1e-5}
LIMITS = Limits((-10.0, 10.0), (-0.03, 0.03), 20.0)
#: One segment of each kind.
ALL = Profile(
    (
        Segment("hold", 0.5),
        Segment("step", 1.0, force=2.0),
        Segment("ramp", 1.0, force=-1.0),
        Segment("hold", 0.5),
        Segment("sweep", 2.0, amplitude=1.5, offset=0.2, low_hz=0.5, high_hz=5.0),
        Segment("prbs", 1.0, amplitude=1.0, shortest=0.1, seed=3),
        Segment("release", 0.5),
    ),
    "all kinds",
)
STEP = Profile((Segment("hold", 0.3), Segment("step", 2.0, force=8.0)), "one step")


#: An encoder with noise and no steps that are seen.
SEEN = Sensing(1e-5, 0.0, 0.002)


def explanation(
    model: Model, *, probability: float = 0.5, evidence: float = 0.0, known: float = 0.01
) -> CandidateModel:
    """A model as an explanation that stands, every parameter known to ``known`` of itself."""
    scale = np.abs(model.values)
    return CandidateModel(
        tuple(model.effect_names), probability, evidence, 1000.0, model, model.names, scale,
        np.diag((known * scale) ** -2.0), (Initial(),),
    )  # fmt: skip


class Rig:
    """A simulated rig with effects."""

    def __init__(
        self, encoder: dict[str, float] = NOISE, plant: dict[str, float] = ECP, **effects: dict[str, float]
    ) -> None:
        self.encoder, self.plant, self.effects, self.runs = encoder, plant, effects, 0

    def play(self, profile: Profile, limits: Limits) -> Ran:
        """Play a profile from rest."""
        limits.check(profile)
        self.runs += 1
        at, force = profile.commands
        made = api.simulate(
            {**self.plant, "encoder": self.encoder, "effects": self.effects, "force_time": at, "force": force,
             "duration": profile.duration, "seed": self.runs}
        )  # fmt: skip
        name = f"run {self.runs}"
        return Ran(Record(time=made.time, position=made.position, force_time=at, force=force, name=name))


#: A rig whose actuator's gain bends, which one step does not show. Tests of it share the ``xdist_group`` "bent gain".
BENT = {"force_gain_nonlinearity": {"gain_slope": 0.006}}


@cache
def stepped(effect: str, parameter: str, size: float) -> Diagnosis:
    """What one step of such a rig tells."""
    rig = Rig(**{effect: {parameter: size}}) if effect else Rig()
    return once.diagnosed([rig.play(STEP, LIMITS).record])


@cache
def checked() -> Proposal:
    """What to do after one step of the rig with a bent gain."""
    diagnosis = stepped("force_gain_nonlinearity", "gain_slope", 0.006)
    assert diagnosis.verdict == "adequate"
    found = check(diagnosis, LIMITS)
    assert found is not None
    return found


def share(monkeypatch: pytest.MonkeyPatch) -> None:
    """Investigations of the rig with a bent gain take its first diagnosis, and what to do then, from the others."""
    first = stepped("force_gain_nonlinearity", "gain_slope", 0.006)
    diagnose = pipeline.diagnose

    def diagnosed(records: Sequence[Record], options: pipeline.Options, *, earlier: Diagnosis | None) -> Diagnosis:
        fresh = earlier is None and options == pipeline.Options()
        return once.diagnosed(records) if fresh else diagnose(records, options, earlier=earlier)

    def next_of(diagnosis: Diagnosis, limits: Limits) -> Proposal | None:
        return checked() if diagnosis is first and limits == LIMITS else check(diagnosis, limits)

    monkeypatch.setattr(pipeline, "diagnose", diagnosed)
    monkeypatch.setattr(investigation, "check", next_of)
