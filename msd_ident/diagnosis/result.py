"""Result of a diagnosis, frozen, with the JSON contract."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from msd_ident.data.datasheet import data_sheet
from msd_ident.data.quality import Finding
from msd_ident.data.record import Record
from msd_ident.estimate import FitResult
from msd_ident.quantity import Quantity
from msd_ident.residuals.adequacy import Adequacy
from msd_ident.residuals.dependence import Dependence
from msd_ident.residuals.disturbance import DisturbanceEstimate
from msd_ident.residuals.nonparametric import Characteristics
from msd_ident.residuals.ringdown import RingDown
from msd_ident.residuals.unexplained import Remainders
from msd_ident.selection.calibration import Calibration
from msd_ident.selection.candidate_models import CandidateModel
from msd_ident.selection.cause_assessment import CauseAssessment
from msd_ident.selection.cross_validation import HeldOut

Verdict = Literal["adequate", "explained", "mostly_explained", "ambiguous", "unexplained"]
SCHEMA = "msd.diagnosis/2"


@dataclass(frozen=True)
class Cause:
    """One effect that the base model lacks.

    Attributes:
        name: canonical name of the effect.
        probability: that it acts, given the data and the library.
        parameters: its own parameters in the extended model.
        tied_with: causes that the data does not distinguish from it.
        tied_probability: that it or one of ``tied_with`` acts; ``probability`` where nothing is tied.
        in_any_law: whether another law of the same cause may well act in its place, which ``probability`` counts too.
    """

    name: str
    probability: float
    parameters: Mapping[str, Quantity]
    tied_with: tuple[str, ...]
    tied_probability: float
    in_any_law: bool = False


@dataclass(frozen=True)
class Rival:
    """Another set of causes that was fitted.

    Attributes:
        causes: names of the set.
        probability: of the set, lowered as its causes are (``Ranking.stated``).
        floors: residual that it leaves, in noise floors.
    """

    causes: tuple[str, ...]
    probability: float
    floors: float


@dataclass(frozen=True)
class Diagnosis:
    """What the base model (m, b, k) gets wrong, and the extended model.

    Attributes:
        records: the data, as used.
        findings: problems of the data.
        verdict: ``adequate``, ``explained``, ``mostly_explained``, ``ambiguous`` or ``unexplained``.
        summary: the verdict in words.
        causes: what the extended model has beyond the base model, strongest first.
        base, extended: both models, refitted; the same where the base is adequate.
        see_reduction_percent: on the fitted data, eq. 15.
        heldout: on data that the fit did not use.
        noise_floor: rms that noise and encoder step leave with the true model, in the position unit.
        base_adequacy, adequacy: whether the residual of the base and of the extended model is noise.
        left: how much both leave: as a force, and as a part of the motion.
        missing: the force that the base model lacks, for each record.
        dependences: signals that this force depends on.
        still_missing: the force that the extended model lacks.
        characteristics: measured spring and damping curves, where more than the tolerance is left and they leave less
            than the base model.
        spread: least and largest m, b, k and Fc over tied explanations.
        rivals: the best other sets.
        warnings: what a reader must know, a sentence each.
        ring_down: damping and frequency against amplitude, where anything rings down.
        next_experiment: what would distinguish tied causes; ``None`` when there is nothing to do.
        contenders: the remaining explanations as fitted models, the leading one first; for the design of a next
            experiment, not in the JSON.
        tried: every cause of the library with what it leaves and why it is in the model or not.
        turned: whether the force's sign was changed because a positive force moves the encoder downwards.
        calibration: diagnoses of copies of this experiment, and the probabilities corrected by them; ``None`` where no
            copies were made.
        derived: what follows from the parameters of the extended model, by name: ``stiffness_at_rest`` of a bent spring
            beside a constant force (``intervals.at_rest``).
    """

    records: tuple[Record, ...]
    findings: tuple[Finding, ...]
    verdict: Verdict
    summary: str
    causes: tuple[Cause, ...]
    base: FitResult
    extended: FitResult
    see_reduction_percent: float
    heldout: HeldOut
    noise_floor: float
    base_adequacy: Adequacy
    adequacy: Adequacy
    left: Remainders
    missing: tuple[DisturbanceEstimate, ...]
    dependences: tuple[Dependence, ...]
    still_missing: tuple[DisturbanceEstimate, ...]
    characteristics: Characteristics | None
    spread: Mapping[str, tuple[float, float]]
    rivals: tuple[Rival, ...]
    warnings: tuple[str, ...]
    ring_down: RingDown | None = None
    next_experiment: Mapping[str, Any] | None = None
    contenders: tuple[CandidateModel, ...] = ()
    tried: tuple[CauseAssessment, ...] = ()
    turned: bool = False
    calibration: Calibration | None = None
    derived: Mapping[str, Quantity] = field(default_factory=dict)

    def to_json_dict(self) -> dict[str, Any]:
        """The JSON contract's object, without ``path``."""
        found: dict[str, Any] = {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "summary": self.summary,
            "causes": [_cause_dict(cause) for cause in self.causes],
            "base": _model_dict(self.base),
            "extended": _model_dict(self.extended),
            "gain": {
                "see_reduction_percent": self.see_reduction_percent,
                "heldout_see_base_m": self.heldout.see_base,
                "heldout_see_extended_m": self.heldout.see_extended,
                "heldout_reduction_percent": self.heldout.reduction_percent,
                "interval_percent": list(self.heldout.interval_percent),
            },
            "noise_floor_m": self.noise_floor,
            "tolerance_percent": self.left.tolerance_percent,
            "remainder": self.left.to_json_dict(),
            "residual_noise_floors": {"base": self.base_adequacy.ratio, "extended": self.adequacy.ratio},
            "missing_force_depends_on": {item.signal: item.share for item in self.dependences},
            "spread": {name: list(ends) for name, ends in self.spread.items()},
            "rivals": [
                {"causes": list(r.causes), "probability": r.probability, "noise_floors": r.floors} for r in self.rivals
            ],
            "tried": [one.to_json_dict() for one in self.tried],
            "findings": [vars(finding) for finding in self.findings],
            "data": [data_sheet(record).to_json_dict() for record in self.records],
            "warnings": list(self.warnings),
            "effects": list(self.extended.model.effect_names),
            "force_sign": -1 if self.turned else 1,
            "initial": [
                {"position_m": start.position, "velocity_m_s": start.velocity, "zero_m": start.zero}
                for start in self.extended.initial
            ],
            "next_experiment": None if self.next_experiment is None else dict(self.next_experiment),
        }
        if self.derived:
            found["derived"] = quantities_dict(self.derived)
        if self.ring_down is not None:
            found["ring_down"] = self.ring_down.to_json_dict()
        if self.calibration is not None:
            found["calibration"] = self.calibration.to_json_dict()
        if self.characteristics is not None:
            found["characteristics"] = self.characteristics.to_json_dict()
        return found


def quantities_dict(quantities: Mapping[str, Quantity]) -> dict[str, Any]:
    """``{name: {"value": …, "std": …, "unit": …}}``."""
    return {name: {"value": q.value, "std": q.std, "unit": q.unit} for name, q in quantities.items()}


def _cause_dict(cause: Cause) -> dict[str, Any]:
    return {
        "name": cause.name,
        "probability": cause.probability,
        "parameters": quantities_dict(cause.parameters),
        "tied_with": list(cause.tied_with),
        "tied_probability": cause.tied_probability,
    }


def _model_dict(result: FitResult) -> dict[str, Any]:
    return {"parameters": quantities_dict(result.quantities), "see_m": result.see}
