"""What a simulation gets wrong about a record: the same laws are fitted to the measured and to the simulated positions.

A simulation that is a black box cannot be refitted, but its response can be explained. The diagnosis of the record
gives a model of the rig. The same structure, with further causes if needed, is fitted to the simulated positions and
gives a model of the simulation. Where the two differ by more than both intervals, the simulation is wrong, and the
difference has a name. Noise as that of the record is added to the simulated positions, so that both fits work under the
same conditions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from msd_ident import seeds
from msd_ident.data.record import FloatArray, Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.estimate import FitResult, fit, see
from msd_ident.estimate.formulation import Zero
from msd_ident.external.difference import Difference, differences
from msd_ident.external.simulations import Simulation
from msd_ident.model import Model
from msd_ident.model.effects import by_name
from msd_ident.residuals.dependence import dependences
from msd_ident.residuals.disturbance import DisturbanceEstimate, lacking_force
from msd_ident.workflow import pipeline
from msd_ident.workflow.explained_motion import explained_percent
from msd_ident.workflow.identification import quantities_dict

SCHEMA = "msd.external/1"
#: Noise floors that the rig's structure may leave of a simulation; more, and the simulation is diagnosed too.
_ALIKE = 1.3
#: Part of the largest reading by which positions differ from their copy, at most.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Comparison:
    """A simulation beside a rig.

    Attributes:
        simulation: its name.
        how: how it was run, a sentence.
        records: what was measured, as used.
        simulated: readings (n,) of the simulation, for each record.
        diagnosis: of what was measured.
        rig, theirs: the same structure, fitted to both.
        differences: what is wrong with the simulation, what matters most first.
        missing: the force that the simulation lacks on each record, smoothed from its error.
        named: the same, of the rig's model against the simulation: what the differences make of it.
    """

    simulation: str
    how: str
    records: tuple[Record, ...]
    simulated: tuple[FloatArray, ...]
    diagnosis: Diagnosis
    rig: FitResult
    theirs: FitResult
    differences: tuple[Difference, ...]
    missing: tuple[DisturbanceEstimate, ...]
    named: tuple[DisturbanceEstimate, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """Those of the diagnosis, one if the simulation is the measurement itself, and one if the fitted model does not
        explain the simulation.
        """
        found = (*self._copied(), *self.diagnosis.warnings)
        left = self.theirs.see / self.diagnosis.noise_floor if self.diagnosis.noise_floor > 0.0 else 0.0
        if left <= _ALIKE:
            return found
        return (
            *found,
            f"the model fitted to the simulated positions leaves {left:.3g} noise floors of them: the simulation has "
            "laws that it does not describe, and the corrections are only those of the nearest model.",
        )

    def _copied(self) -> tuple[str, ...]:
        return tuple(
            f"the simulation {self.simulation} equals the measured readings of {record.name} in every sample, with "
            "their noise: it is probably the same file. Give the positions that your simulation made."
            for record, left in zip(self.records, self.residuals, strict=True)
            if float(np.max(np.abs(left))) <= _ROUNDING * float(np.max(np.abs(record.position)))
        )

    @property
    def residuals(self) -> tuple[FloatArray, ...]:
        """Simulation − data (n,) of each record, in the position unit."""
        return tuple(found - record.position for found, record in zip(self.simulated, self.records, strict=True))

    @property
    def missing_size(self) -> float:
        """Root mean square of the force that the simulation lacks, in the force unit."""
        return math.sqrt(float(np.mean(np.concatenate([part.force for part in self.missing]) ** 2)))

    @property
    def depends_on(self) -> dict[str, float]:
        """Signal → share of that force's variance that it explains alone."""
        return {item.signal: item.share for item in dependences(self.missing)}

    @property
    def see(self) -> float:
        """Standard error of estimate of the simulation, in the position unit."""
        return see(self.residuals)

    @property
    def explained_percent(self) -> float:
        """Part of the motion's variance that the simulation explains."""
        return explained_percent(self.residuals, self.records)

    @property
    def sentence(self) -> str:
        """The outcome in words."""
        unit = self.records[0].position_unit
        explained = f"it explains {self.explained_percent:.5g} % of the motion"
        outcome = f"The error of the simulation is {self.see:.3g} {unit}; {explained}"
        if not self.differences:
            return f"{outcome}. This record shows no significant difference from the rig."
        return f"{outcome}. With the following corrections the error would be {self.rig.see:.3g} {unit}."

    def to_json_dict(self) -> dict[str, Any]:
        """The contract ``msd.external/1`` without ``path``."""
        return {
            "schema": SCHEMA,
            "simulation": self.simulation,
            "how": self.how,
            "see_m": self.see,
            "explained_percent": self.explained_percent,
            "corrected_see_m": self.rig.see,
            "noise_floor_m": self.diagnosis.noise_floor,
            "verdict": self.diagnosis.verdict,
            "differences": [
                {
                    "kind": one.kind, "name": one.name, "rig": vars(one.rig), "simulation": vars(one.simulation),
                    "motion_rms_m": one.does, "probability": one.probability, "sentence": one.sentence,
                }
                for one in self.differences
            ],
            "models": {"rig": _model_json(self.rig), "simulation": _model_json(self.theirs)},
            "missing_force_rms": self.missing_size,
            "missing_force_depends_on": self.depends_on,
            "warnings": list(self.warnings),
        }  # fmt: skip


def _model_json(one: FitResult) -> dict[str, Any]:
    """A fitted model for the JSON."""
    return {
        "effects": list(one.model.effect_names), "parameters": quantities_dict(one.quantities), "see_m": one.see,
    }  # fmt: skip


def _silent(stage: str, fraction: float) -> None:
    """Report to nobody."""


def compare(
    simulation: Simulation, records: Sequence[Record], progress: Callable[[str, float], None] = _silent
) -> Comparison:
    """Name what a simulation gets wrong about records of one rig.

    Args:
        simulation: what to run on the records' force.
        records: of one rig.
        progress: called with the stage and the fraction done (0 to 1).

    Raises:
        UsageError, DataError: it cannot be run on the records, or the data cannot carry any estimate.
    """
    for record in records:
        simulation.check(record)
    progress("diagnosing the record", 0.1)
    found = pipeline.diagnose(records)
    sign = -1.0 if found.turned else 1.0
    progress("running the simulation", 0.5)
    given = [replace(record, force=sign * record.force) for record in found.records]
    simulated = tuple(
        simulation.positions(record, initial) for record, initial in zip(given, found.extended.initial, strict=True)
    )
    progress("explaining the simulation", 0.6)
    noisy = _noisy(found.records, simulated, found.noise_floor)
    rig, theirs = _explained(found, noisy)
    sure = {cause.name: cause.probability for cause in found.causes}
    unlike = differences(rig, theirs, found.records, found.noise_floor, sure)
    progress("smoothing the missing force", 0.9)
    missing, named = _missing(found, simulated, rig, theirs)
    progress("done", 1.0)
    how = simulation.how(found.records[0])
    return Comparison(simulation.name, how, found.records, simulated, found, rig, theirs, unlike, missing, named)


def _missing(
    found: Diagnosis, simulated: Sequence[FloatArray], rig: FitResult, theirs: FitResult
) -> tuple[tuple[DisturbanceEstimate, ...], tuple[DisturbanceEstimate, ...]]:
    """The force that the simulation lacks, as measured, and as the rig's model has it."""
    plant = (theirs.model.mass, theirs.model.damping, theirs.model.stiffness)
    parts = []
    for record, positions, left in zip(found.records, simulated, rig.residuals, strict=True):
        modelled = replace(record, position=record.position + left)
        parts.append(tuple(
            lacking_force(one, positions - one.position, plant, found.noise_floor) for one in (record, modelled)
        ))  # fmt: skip
    missing, named = zip(*parts, strict=True)
    return tuple(missing), tuple(named)


def _noisy(records: Sequence[Record], simulated: Sequence[FloatArray], floor: float) -> tuple[Record, ...]:
    """Simulated positions as if an encoder of this rig had read them."""
    rng = np.random.default_rng(seeds.ENCODER)
    return tuple(
        replace(record, position=positions + floor * rng.standard_normal(positions.size), name="the simulation")
        for record, positions in zip(records, simulated, strict=True)
    )


def _explained(found: Diagnosis, noisy: tuple[Record, ...]) -> tuple[FitResult, FitResult]:
    """The rig's model and the simulation's, of one structure."""
    rig = found.extended
    theirs = _fitted(rig.model, rig, noisy)
    if theirs.see <= _ALIKE * found.noise_floor:
        return rig, theirs
    other = pipeline.diagnose(noisy).extended.model
    both = _united(rig.model, other)
    if both.effect_names == rig.model.effect_names:
        return rig, _fitted(both, rig, noisy, other)
    return _fitted(both, rig, found.records, rig.model), _fitted(both, rig, noisy, other)


def _united(one: Model, other: Model) -> Model:
    """A model with the effects of both; of two in a family the first one's."""
    families = {effect.family for effect in one.effects if effect.family}
    for effect in other.effects:
        if not one.has(effect.name) and effect.family not in families:
            one = one + effect
    return one


def _fitted(model: Model, rig: FitResult, records: Sequence[Record], found: Model | None = None) -> FitResult:
    """A structure fitted near where the rig's parameters are, without each effect, and near what was found.

    From the parameters that a part of the structure was found to have, with all other effects vanishing, no fit ends
    worse than that part.
    """
    fixed = {name for name, quantity in rig.quantities.items() if quantity.std == 0.0}
    zero: Zero = "free" if model.stiffness > 0.0 else "known"
    values = dict(zip(model.names, model.values.tolist(), strict=True))
    starts = [model.with_values({**values, **_neutral(effect.name)}) for effect in model.effects]
    if found is not None:
        known = {n: v for n, v in zip(found.names, found.values.tolist(), strict=True) if n in values}
        absent = [effect.name for effect in model.effects if not found.has(effect.name)]
        nothing = {n: v for name in absent for n, v in _neutral(name).items()}
        starts += [model.with_values({**values, **nothing, **known}), model.with_values({**values, **known})]
    return fit(model, records, fixed=fixed, zero=zero, search="near", starts=starts)


def _neutral(name: str) -> dict[str, float]:
    """An effect's parameters nearly where it vanishes: from there a fit can still move."""
    return {parameter: value for parameter, value in by_name(name).neutral if np.isfinite(value)}
