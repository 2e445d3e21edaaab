"""One small rig with dry friction, diagnosed and identified once a process, for the tests of what a person sees."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from msd_ident.data.provenance import Origin, Provenance, versions
from msd_ident.data.record import Record
from msd_ident.design.profile import Profile, Segment
from msd_ident.design.profile_file import to_tree
from msd_ident.diagnosis import Diagnosis
from msd_ident.selection.calibration import Calibration, Row
from msd_ident.workflow import pipeline
from msd_ident.workflow.identification import Identification
from msd_sim.api import simulate

RIG = {
    "mass": 1.0, "damping": 2.0, "stiffness": 600.0, "friction_coefficient": 0.0, "seed": 1, "rate": 200,
    "encoder": {"counts_per_metre": 100000.0}, "experiment": {"name": "steps", "force": 8.0, "hold": 0.5},
    "effects": {"coulomb_friction": {"coulomb_force": 0.2}},
}  # fmt: skip

#: What the design of the next experiment puts into the JSON.
NEXT = {
    "sentence": "Push with 4 N and with 8 N, both ways, for 30 s.",
    "duration_s": 30.0,
    "probability_of_decision": 0.97,
    "decided": {"coulomb_friction": 0.99, "stribeck_friction + quadratic_drag": 0.95},
    "travel_m": [-0.012, 0.034],
    "profile": to_tree(Profile(tuple(Segment("step", 7.5, force=force) for force in (4.0, -4.0, 8.0, -8.0)))),
    "measurements": ["Weigh the cart."],
}

_RUB, _PEAK = frozenset({"coulomb_friction"}), frozenset({"stribeck_friction"})
#: What copies of a record were called.
COPIES = Calibration(
    (
        Row(_RUB, False, {_RUB: 7, frozenset(): 1}),
        Row(_PEAK, True, {_PEAK: 12, _RUB: 4}),
        Row(frozenset(), False, {frozenset(): 20}),
    ),
    {"coulomb_friction": 0.9996},
    {"coulomb_friction": 0.77},
)


@cache
def record() -> Record:
    """800 samples at 200 Hz."""
    made = simulate(RIG)
    return Record(made.time, made.position, made.force_time, made.force, hold=made.hold, name="rubbing")


@cache
def diagnosed() -> Diagnosis:
    """Explained by Coulomb friction."""
    return pipeline.diagnose([record()])


@cache
def with_everything() -> Diagnosis:
    """The same with every section that a page can have: a tie and a next experiment too."""
    found = diagnosed()
    tied = replace(found.causes[0], tied_with=("stribeck_friction", "hysteresis"))
    return replace(found, verdict="ambiguous", causes=(tied,), next_experiment=NEXT, calibration=COPIES)


@cache
def identified() -> Identification:
    """The same record."""
    return pipeline.identify([record()])


def provenance() -> Provenance:
    """As the command line would tell it."""
    origin = Origin("rubbing.csv", "CSV file", 12345, "ab" * 32, "position_m", "force_n")
    return Provenance("msd diagnose rubbing.csv --report page.html", "2026-01-31T12:00:00Z", (origin,), versions())
