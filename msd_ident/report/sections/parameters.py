"""Parameters side by side with their intervals, what the data leaves open, and the frequency response."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from msd_ident.model import frequency_response
from msd_ident.report import marked, words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number, shown
from msd_ident.report.plot import Plot, Role
from msd_ident.report.plots import bode_plot
from msd_ident.report.sections.section import ResultSection, Section
from msd_ident.workflow.identification import Identification

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.diagnosis import Diagnosis
    from msd_ident.model import Model
    from msd_ident.quantity import Quantity


@dataclass(frozen=True)
class Column:
    """One model: its heading, where its numbers stand in the JSON, its quantities, SEE, and model."""

    label: str
    role: Role
    key: str
    quantities: Mapping[str, Quantity]
    see: float
    model: Model


class Parameters(Section):
    """Models side by side."""

    slug = "parameters"
    title = "Parameters"

    def __init__(
        self,
        records: tuple[Record, ...],
        columns: tuple[Column, ...],
        open_sentences: tuple[str, ...],
        ranges: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:
        self._records, self._columns, self._open, self._ranges = records, columns, open_sentences, ranges or {}

    @cached_property
    def bode(self) -> Plot:
        """The linear parts over frequency, with the measured response."""
        band = frequency_response.band(self._columns[-1].model)
        curves = [(c.label, c.role, frequency_response.modelled(c.model, band)) for c in self._columns]
        record = self._records[0]
        units = (record.position_unit, record.force_unit)
        return bode_plot(curves, frequency_response.measured(self._records, band), units)

    @property
    def plots(self) -> tuple[Plot, ...]:
        """The Bode plot."""
        return (self.bode,)

    def context(self) -> Mapping[str, Any]:
        """Rows of the table, and what is open."""
        names = dict.fromkeys(name for column in self._columns for name in column.quantities)
        rows = [(*words.parameter(name), self._cells(name), self._unit(name), self._range(name)) for name in names]
        scale = length_scale(min(column.see for column in self._columns), self._records[0].position_unit)
        errors = [marked.length(f"{column.key}.see_m", column.see, scale) for column in self._columns]
        return {
            "columns": self._columns,
            "rows": rows,
            "errors": errors,
            "open": self._open,
            "ranges": bool(self._ranges),
        }

    def _range(self, name: str) -> str:
        """Least and largest value over the explanations and laws that fit alike."""
        low, high = self._ranges.get(name, (math.nan, math.nan))
        return f"{number(low)} to {number(high)}" if low == low else ""

    def _cells(self, name: str) -> list[Marked | None]:
        return [
            marked.quantity(f"{column.key}.parameters.{name}", column.quantities[name])
            if name in column.quantities
            else None
            for column in self._columns
        ]

    def _unit(self, name: str) -> str:
        unit = next(column.quantities[name].unit for column in self._columns if name in column.quantities)
        return "" if unit == "1" else unit


class StandardForm(ResultSection[Identification]):
    """ωn, ζ and K as read off the response (the paper's Table 2)."""

    slug = "standard_form"
    title = "Standard form"

    def context(self) -> Mapping[str, Any]:
        """Rows: words, symbol, value ± 95 %, unit."""
        form = self._found.standard_form
        quantities = form.quantities if form is not None else {}
        rows = []
        for name, quantity in quantities.items():
            displayed = shown(quantity)
            text = marked.quantity("", displayed).text
            value = Marked(f"standard_form.{name}.value", quantity.value, text)
            rows.append((*words.parameter(name), value, "" if displayed.unit == "1" else displayed.unit))
        return {"rows": rows}


def diagnosis_columns(found: Diagnosis) -> tuple[Column, ...]:
    """Base and extended model."""
    base = Column("base model", "base", "base", found.base.quantities, found.base.see, found.base.model)
    if not found.causes:
        return (base,)
    extended = found.extended
    return base, Column("extended model", "extended", "extended", extended.quantities, extended.see, extended.model)


def identification_columns(found: Identification) -> tuple[Column, ...]:
    """Original model and joint refit, with the paper's way between them where it applies."""
    fits = [("original (m, b, k)", "base", "original", found.original)]
    if found.paper_refined is not None:
        fits.append(("friction raised", "paper", "paper_refined", found.paper_refined))
    fits.append(("joint refit", "extended", "refined", found.refined))
    return tuple(Column(label, role, key, m.parameters, m.see, m.model) for label, role, key, m in fits)  # type: ignore[arg-type]
