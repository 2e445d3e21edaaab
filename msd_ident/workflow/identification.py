"""Result of an identification: the paper's models and the joint refit, frozen, with the JSON contract."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from msd_ident.data.datasheet import data_sheet
from msd_ident.data.quality import Finding
from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import Initial, see_reduction
from msd_ident.features import Features, StandardForm
from msd_ident.model import Model
from msd_ident.quantity import Quantity
from msd_ident.workflow.known_parameters import Known, to_json_list


@dataclass(frozen=True)
class ModelFit:
    """A model with its parameters' intervals and its SEE.

    Attributes:
        model: the model with the values below.
        parameters: name → quantity; dry friction as a coefficient too.
        see: standard error of estimate over all records, eq. 14, in the position unit.
        initial: state and zero that each record's simulation starts from.
        predicted: for every record the (n,) simulated reading.
        method: how it was found, a sentence.
    """

    model: Model
    parameters: Mapping[str, Quantity]
    see: float
    initial: tuple[Initial, ...]
    predicted: tuple[FloatArray, ...]
    method: str

    def to_json_dict(self) -> dict[str, Any]:
        """``{"parameters": {name: {value, std, unit}}, "see_m": …}``; NaN where the data leaves a value open."""
        return {"parameters": quantities_dict(self.parameters), "see_m": self.see, "method": self.method}


@dataclass(frozen=True)
class Identification:
    """Everything that an identification found about the records.

    Attributes:
        records: what was used, with the force's sign changed where a positive force moves the encoder downwards.
        findings: problems of the data.
        features: of each record.
        standard_form: ωn, ζ, K of all turning points of all records; ``None`` without a usable response.
        two_peak_form: the paper's, from two peaks a step (eqs. 3 to 9); ``None`` where no response has two.
        original: the linear model, from the two-peak form (or else the standard form) by eqs. 11–13, or fitted where
            there are no features.
        paper_refined: the same with friction raised to the least SEE; ``None`` for several records, no features, or an
            original model whose SEE is not finite.
        refined: the joint refit.
        noise_floor: rms that noise and encoder step leave with the true model, in the position unit.
        missing_samples: position samples that the stamps say are missing.
        warnings: what a reader must know before using the numbers, a sentence each.
        open: what the data leaves open and what to measure instead, a sentence each.
        known: parameters that were known beforehand and kept.
        turned: whether the force's sign was changed because a positive force moves the encoder downwards.
    """

    records: tuple[Record, ...]
    findings: tuple[Finding, ...]
    features: tuple[Features, ...]
    standard_form: StandardForm | None
    two_peak_form: StandardForm | None
    original: ModelFit
    paper_refined: ModelFit | None
    refined: ModelFit
    noise_floor: float
    missing_samples: int
    warnings: tuple[str, ...]
    open: tuple[str, ...]
    known: tuple[Known, ...] = ()
    turned: bool = False

    @property
    def name(self) -> str:
        """Short name of the records."""
        return "+".join(record.name for record in self.records)

    @property
    def route(self) -> str:
        """Which way led to the standard form, a sentence a record."""
        return " ".join(dict.fromkeys(features.route for features in self.features))

    @property
    def fits(self) -> dict[str, ModelFit]:
        """The models by their key in the JSON, in the order in which they were made."""
        made = {"original": self.original, "paper_refined": self.paper_refined, "refined": self.refined}
        return {key: one for key, one in made.items() if one is not None}

    @property
    def see_reduction_percent(self) -> float:
        """Reduction of the SEE by the joint refit in per cent, eq. 15; NaN where the original model's is not finite."""
        return self._reduction(self.refined)

    @property
    def paper_see_reduction_percent(self) -> float:
        """Reduction of the SEE by the paper's own path in per cent, eq. 15; NaN where it does not apply."""
        return self._reduction(self.paper_refined) if self.paper_refined else math.nan

    def _reduction(self, made: ModelFit) -> float:
        return see_reduction(self.original.see, made.see) if math.isfinite(self.original.see) else math.nan

    def to_json_dict(self) -> dict[str, Any]:
        """The contract ``msd.identification/1`` without ``path``."""
        form = self.standard_form
        return {
            "schema": "msd.identification/1",
            "samples": sum(record.samples for record in self.records),
            "missing_samples": self.missing_samples,
            "force_unit": self.records[0].force_unit,
            "position_unit": self.records[0].position_unit,
            "route": self.route,
            "standard_form": quantities_dict(form.quantities) if form else None,
            "standard_form_two_peaks": quantities_dict(self.two_peak_form.quantities) if self.two_peak_form else None,
            "original": self.original.to_json_dict(),
            "paper_refined": self._paper_dict(),
            "refined": self.refined.to_json_dict(),
            "see_reduction_percent": self.see_reduction_percent,
            "noise_floor_m": self.noise_floor,
            "warnings": list(self.warnings),
            "effects": list(self.refined.model.effect_names),
            "force_sign": -1 if self.turned else 1,
            "initial": [initial_dict(start) for start in self.refined.initial],
            "open": list(self.open),
            "known": to_json_list(self.known, {name: q.unit for name, q in self.refined.parameters.items()}),
            "findings": [vars(finding) for finding in self.findings],
            "data": [data_sheet(record).to_json_dict() for record in self.records],
        }  # fmt: skip

    def _paper_dict(self) -> dict[str, Any] | None:
        if self.paper_refined is None:
            return None
        return {**self.paper_refined.to_json_dict(), "see_reduction_percent": self.paper_see_reduction_percent}


def initial_dict(start: Initial) -> dict[str, float]:
    """Where the simulation of a record starts, and the reading at which its spring is relaxed."""
    return {"position_m": start.position, "velocity_m_s": start.velocity, "zero_m": start.zero}


def quantities_dict(quantities: Mapping[str, Quantity]) -> dict[str, dict[str, Any]]:
    """``{name: {"value", "std", "unit"}}`` as the JSON contract writes quantities."""
    return {name: {"value": q.value, "std": q.std, "unit": q.unit} for name, q in quantities.items()}
