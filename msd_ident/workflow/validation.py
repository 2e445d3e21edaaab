"""Validate a saved model on another record: only the initial state of the record is fitted."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from msd_ident.data.datasheet import data_sheet
from msd_ident.data.quality import Finding
from msd_ident.data.record import FloatArray, Record
from msd_ident.data.resampling import centred, led
from msd_ident.errors import UsageError
from msd_ident.estimate import Initial, noise_floor, see
from msd_ident.estimate.least_squares import minimise
from msd_ident.estimate.multistart import limits
from msd_ident.estimate.objective import SquaredError
from msd_ident.estimate.posing import build
from msd_ident.estimate.problem import Nuisance, Problem
from msd_ident.estimate.regression_init import starting_state
from msd_ident.residuals import noise_model
from msd_ident.residuals.adequacy import Adequacy, judge
from msd_ident.residuals.dependence import dependences
from msd_ident.residuals.disturbance import DisturbanceEstimate, lacking_force
from msd_ident.workflow import force_hold
from msd_ident.workflow.explained_motion import explained_percent, percent_text
from msd_ident.workflow.identification import initial_dict, quantities_dict
from msd_ident.workflow.preparation import Prepared, prepare, pushes
from msd_ident.workflow.saved_model import ONLY_RATIOS, SavedModel

SCHEMA = "msd.validation/1"
#: A signal that explains less of a missing force's variance than this is not worth a word.
WORTH = 0.15
#: Where a refitted zero would take so much of the error away, it is said.
_ZERO_SHARE = 0.5


@dataclass(frozen=True)
class Options:
    """What the user may decide about a trial.

    Attributes:
        refit_zero: whether the encoder's zero is fitted too; it is kept from the saved result otherwise.
        require: least part of the motion that must be explained [%]; ``None`` for no demand.

    Raises:
        UsageError: a demand that is no percentage.
    """

    refit_zero: bool = False
    require: float | None = None

    def __post_init__(self) -> None:
        if self.require is not None and not 0.0 <= self.require <= 100.0:
            raise UsageError(f"the required part is {self.require:g} %; expected 0 to 100, e.g. --require 99")


@dataclass(frozen=True)
class Validation:
    """What a saved model makes of other records.

    Attributes:
        saved: the model.
        options: of the trial.
        records: as they were simulated, the force turned as the model has it.
        findings: of the data.
        initial: state and zero of each record, from which it was simulated.
        refitted: what was fitted to these records.
        residuals: model − data (n,) of each record, in the position unit.
        see: standard error of estimate over all records; nothing but the start was fitted.
        explained_percent: part of the motion's variance that the model explains, over all records.
        noise_floor: of the records, in the position unit.
        adequacy: tests of the residuals against the noise.
        missing: the force that the model lacks on each record; none where the residual is what noise would be.
        depends_on: share of that force's variance that each signal explains, alone.
        warnings: what a reader must know before using the numbers.
    """

    saved: SavedModel
    options: Options
    records: tuple[Record, ...]
    findings: tuple[Finding, ...]
    initial: tuple[Initial, ...]
    refitted: tuple[str, ...]
    residuals: tuple[FloatArray, ...]
    see: float
    explained_percent: float
    noise_floor: float
    adequacy: Adequacy
    missing: tuple[DisturbanceEstimate, ...]
    depends_on: Mapping[str, float]
    warnings: tuple[str, ...]

    @property
    def met(self) -> bool:
        """Whether the required part of the motion is explained; true without a demand."""
        return self.options.require is None or self.explained_percent >= self.options.require

    @property
    def missing_size(self) -> float:
        """Root mean square of the force that the model lacks, in the force unit; 0 where the residual is noise."""
        if not self.missing:
            return 0.0
        return math.sqrt(float(np.mean(np.concatenate([part.force for part in self.missing]) ** 2)))

    @property
    def predicted(self) -> tuple[FloatArray, ...]:
        """The simulated reading (n,) of each record, in the position unit."""
        return tuple(r.position + left for r, left in zip(self.records, self.residuals, strict=True))

    @property
    def states(self) -> dict[str, str]:
        """Signal → ``still there``, ``gone`` or ``new here``, against the base model on its own record.

        Only for models of a diagnosis, which tells what its base model lacked; signals that matter in neither are left
        out. Where the residual is hardly more than noise, nothing is there.
        """
        found = {}
        for signal, base_share in self.saved.base_depends_on.items():
            before = base_share >= WORTH
            now = self.adequacy.material and self.depends_on.get(signal, 0.0) >= WORTH
            if before or now:
                found[signal] = "still there" if before and now else "gone" if before else "new here"
        return found

    @property
    def sentence(self) -> str:
        """The outcome in words."""
        unit = self.records[0].position_unit
        said = (
            f"The model explains {percent_text(self.explained_percent)} % of the motion; "
            f"its error is {self.see:.3g} {unit} ({self.adequacy.ratio:.3g} noise floors)"
        )
        if self.options.require is not None:
            said += f"; {self.options.require:g} % are required, which is {'met' if self.met else 'not met'}"
        return f"{said}."

    def to_json_dict(self) -> dict[str, Any]:
        """The contract ``msd.validation/1`` without ``path``."""
        return {
            "schema": SCHEMA,
            "model": {
                "schema": self.saved.schema,
                "path": self.saved.path,
                "effects": list(self.saved.model.effect_names),
                "parameters": quantities_dict(self.saved.parameters),
                "see_m": self.saved.see,
            },
            "refitted": list(self.refitted),
            "see_m": self.see,
            "explained_percent": self.explained_percent,
            "required_percent": self.options.require,
            "met": self.met,
            "noise_floor_m": self.noise_floor,
            "residual_noise_floors": self.adequacy.ratio,
            "consistent_with_noise": self.adequacy.consistent,
            "tests": {
                "size": self.adequacy.size,
                "whiteness": self.adequacy.whiteness,
                "independence": self.adequacy.independence,
            },
            "missing_force_rms": self.missing_size,
            "missing_force_depends_on": dict(self.depends_on),
            "missing_force_state": self.states,
            "initial": [initial_dict(start) for start in self.initial],
            "findings": [vars(finding) for finding in self.findings],
            "data": [data_sheet(record).to_json_dict() for record in self.records],
            "warnings": list(self.warnings),
        }  # fmt: skip


def validate(saved: SavedModel, records: Sequence[Record], options: Options = Options()) -> Validation:  # noqa: B008
    """Simulate a saved model on other records of its rig.

    Args:
        saved: the model; its parameters, effects and force sign are kept.
        records: in the units of the model.
        options: of the trial.

    Raises:
        UsageError: no records, records in other units than the model, or a driven one and a model that knows only
            ratios.
        DataError: the data cannot carry any estimate.
    """
    prepared = as_saved(saved, records)
    _check_scale(saved, prepared.records)
    records, warnings = prepared.records, prepared.warnings
    refit = options.refit_zero or not saved.zeros
    initial, residuals = simulated(saved, records, refit)
    if not refit:
        warnings += _zero_moved(saved, records, residuals)
    elif not options.refit_zero:
        warnings += ("The saved result does not contain the encoder's zero, so it was fitted too.",)
    evidence = noise_model.prepare(records)
    tested = judge(residuals, evidence)
    pairs = () if tested.consistent else tuple(zip(evidence, residuals, strict=True))
    plant = (saved.model.mass, saved.model.damping, saved.model.stiffness)
    lacking = tuple(lacking_force(part.record, residual, plant, part.noise) for part, residual in pairs)
    return Validation(
        saved=saved,
        options=options,
        records=records,
        findings=prepared.findings,
        initial=initial,
        refitted=("initial position", "initial velocity", *(("zero",) if refit else ())),
        residuals=residuals,
        see=see(residuals),
        explained_percent=explained_percent(residuals, records),
        noise_floor=noise_floor(records),
        adequacy=tested,
        missing=lacking,
        depends_on={item.signal: item.share for item in dependences(lacking)} if lacking else {},
        warnings=warnings,
    )


def as_saved(saved: SavedModel, records: Sequence[Record]) -> Prepared:
    """Records as the saved model is simulated on them: cleaned, with its hold and its sign of the force.

    On another part of one of its own records, laws of time go on where they were.

    Args:
        saved: the model.
        records: records as they were read.

    Raises:
        UsageError: no records, or records in other units than the model.
        DataError: the data cannot carry any estimate.
    """
    _check_units(saved, records)
    prepared = _turned_as_saved(prepare([_forced_as_saved(record, saved) for record in records]), saved)
    return _on_its_clock(prepared, saved)


def _forced_as_saved(record: Record, saved: SavedModel) -> Record:
    """The record with the hold of the force and its lead that the saved model's records decided, where it leaves both
    open.
    """
    hold = saved.force_hold
    if hold == "centred":
        return centred(record) if force_hold.may_lead(record) else record
    held = force_hold.with_hold(record, hold) if hold and force_hold.is_open(record) else record
    return led(held, saved.force_lead) if saved.force_lead > 0.0 and force_hold.may_lead(record) else held


def _on_its_clock(prepared: Prepared, saved: SavedModel) -> Prepared:
    """Laws of time as in the saved model's records of the same names; a name is no proof, so it is said."""
    if all(effect.steady for effect in saved.model.effects):
        return prepared
    origins = [saved.origins.get(record.name, record.origin) for record in prepared.records]
    pairs = list(zip(prepared.records, origins, strict=True))
    said = tuple(
        f"{record.name} has the name of a record of the saved model: its drifts and disturbances count the time from "
        f"{origin:.4g} s there, not from {record.origin:.4g} s; rename it if it is another recording."
        for record, origin in pairs
        if origin != record.origin
    )
    records = tuple(replace(record, origin=origin) for record, origin in pairs)
    return replace(prepared, records=records, warnings=prepared.warnings + said)


def _check_units(saved: SavedModel, records: Sequence[Record]) -> None:
    if not records:
        raise UsageError("no records to validate the model on; expected at least one")
    for record in records:
        here = (record.force_unit, record.position_unit)
        # Where no force acts, the record has no force unit of its own.
        forced = bool(np.any(record.force))
        if here[1] != saved.position_unit or (forced and here[0] != saved.force_unit):
            raise UsageError(
                f"{record.name} is in {here[0]} and {here[1]}; expected {saved.force_unit} and {saved.position_unit}, "
                "the units of the model: give --force-scale, --position-scale and their units"
            )


def _check_scale(saved: SavedModel, records: Sequence[Record]) -> None:
    """Refuse a measured force for a model whose forces are those of an assumed mass: the motion would be of any size.

    An export goes on: it replays the model against itself, where the size does not matter.
    """
    driven = next((record for record in records if pushes(record)), None)
    if saved.scale_assumed and driven is not None:
        raise UsageError(
            f"a force drives {driven.name}, and in the model's own record {ONLY_RATIOS}; expected a force scale: "
            "identify again with the moving mass, --mass, or validate on a free decay"
        )


def _turned_as_saved(prepared: Prepared, saved: SavedModel) -> Prepared:
    """Records with the force's sign that the model was fitted with."""
    own = -1 if prepared.turned else 1
    if own == saved.force_sign:
        return prepared
    said = (
        "A positive force moves the encoder in the other direction than on the model's own record: if the wiring was "
        "changed, "
        "use a negative --force-scale."
    )
    records = tuple(replace(record, force=-record.force) for record in prepared.records)
    return replace(prepared, records=records, warnings=(*prepared.warnings, said), turned=not prepared.turned)


def simulated(
    saved: SavedModel, records: tuple[Record, ...], refit_zero: bool
) -> tuple[tuple[Initial, ...], tuple[FloatArray, ...]]:
    """Initial state of each record by least squares, and the residuals of the model from there.

    Args:
        saved: the model; its parameters are kept.
        records: prepared as ``as_saved`` does.
        refit_zero: whether the zero of the encoder is fitted too.
    """
    zero = float(np.mean(saved.zeros)) if saved.zeros else 0.0
    initial: list[Initial] = []
    residuals = []
    for record in records:
        problem = _of_start(saved, record, zero, refit_zero)
        objective = SquaredError(problem)
        position, velocity = starting_state(record)
        first = float(record.position[0])
        starts = [Initial(position - zero, velocity, zero), Initial(first - zero, 0.0, zero), Initial(0.0, 0.0, first)]
        vectors = [problem.vector({}, [start]) for start in (starts if refit_zero else starts[:2])]
        found = min((minimise(objective, vector, limits(problem)) for vector in vectors), key=lambda one: one.cost)
        initial += problem.initials(found.point)
        residuals.append(problem.residual(found.point, 0))
    return tuple(initial), tuple(residuals)


def _of_start(saved: SavedModel, record: Record, zero: float, refit_zero: bool) -> Problem:
    """The problem whose only unknowns are the state at the first sample, and the zero where it is wanted."""
    unknown = [Nuisance(0, "initial position"), Nuisance(0, "initial velocity")]
    if refit_zero:
        unknown.append(Nuisance(0, "zero"))
    problem = build(saved.model, (record,), frozenset(saved.model.names), tuple(unknown))
    return replace(problem, initial=(Initial(0.0, 0.0, zero),))


def _zero_moved(saved: SavedModel, records: tuple[Record, ...], residuals: tuple[FloatArray, ...]) -> tuple[str, ...]:
    """A sentence where another zero would take most of the error away."""
    moved = []
    for record, residual in zip(records, residuals, strict=True):
        mean = float(np.median(residual))
        if mean**2 > _ZERO_SHARE * float(np.mean(residual**2)) and abs(mean) > 1e-3 * float(np.ptp(record.position)):
            moved.append(f"{record.name} by about {-mean:.2g} {record.position_unit}")
    if not moved:
        return ()
    return (f"The encoder's zero has moved since the model's own record ({', '.join(moved)}): use --refit-zero.",)
