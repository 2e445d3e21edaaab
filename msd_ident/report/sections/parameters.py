"""Parameters side by side with their intervals, what the data leaves open, and the frequency response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.model import Model, frequency_response
from msd_ident.quantity import Quantity
from msd_ident.report import marked, words
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number, shown, with_band
from msd_ident.report.plot import Plot, Role
from msd_ident.report.plots import STAGES, bode_plot
from msd_ident.report.sections.section import Section
from msd_ident.workflow.identification import Identification


@dataclass(frozen=True)
class Column:
    """One model: its heading, where its numbers stand in the JSON, its quantities, SEE, model, and what follows."""

    label: str
    role: Role
    key: str
    quantities: Mapping[str, Quantity]
    see: float
    model: Model
    derived: Mapping[str, Quantity] = field(default_factory=dict)

    @property
    def shown(self) -> Mapping[str, tuple[str, Quantity]]:
        """All quantities by name, each with its place in the JSON."""
        return {
            **{name: (f"{self.key}.parameters.{name}", quantity) for name, quantity in self.quantities.items()},
            **{name: (f"derived.{name}", quantity) for name, quantity in self.derived.items()},
        }


def parameters(
    records: tuple[Record, ...],
    columns: tuple[Column, ...],
    open_sentences: tuple[str, ...],
    ranges: Mapping[str, tuple[float, float]] | None = None,
) -> Section:
    """Models side by side, what is open, and the frequency response; ``ranges`` over all that fits alike."""
    names = dict.fromkeys(name for column in columns for name in column.shown)
    scale = length_scale(min(column.see for column in columns), records[0].position_unit)
    context = {
        "columns": columns,
        "rows": [_row(name, columns, (ranges or {}).get(name)) for name in names],
        "errors": [marked.length(f"{column.key}.see_m", column.see, scale) for column in columns],
        "open": open_sentences,
        "ranges": bool(ranges),
    }
    return Section("parameters", "Parameters", context, (_bode(records, columns),))


def _row(name: str, columns: Sequence[Column], spread: tuple[float, float] | None) -> tuple[Any, ...]:
    """Words, symbol, a cell for each column, unit, and range of a parameter."""
    known = [column.shown.get(name) for column in columns]
    cells = [marked.quantity(*one) if one is not None else None for one in known]
    unit = next(quantity.unit for _, quantity in filter(None, known))
    said = f"{number(spread[0])} to {number(spread[1])}" if spread is not None else ""
    return (*words.parameter(name), cells, "" if unit == "1" else unit, said)


def _bode(records: tuple[Record, ...], columns: Sequence[Column]) -> Plot:
    """The linear parts over frequency, with the measured response."""
    band = frequency_response.band(columns[-1].model)
    curves = [(c.label, c.role, frequency_response.modelled(c.model, band)) for c in columns]
    units = (records[0].position_unit, records[0].force_unit)
    return bode_plot(curves, frequency_response.measured(records, band), units)


def standard_form(found: Identification) -> Section:
    """ωn, ζ and K as read off the response (the paper's Table 2): words, symbol, value ± 95 %, unit."""
    quantities = found.standard_form.quantities if found.standard_form is not None else {}
    rows = []
    for name, quantity in quantities.items():
        displayed = shown(quantity)
        value = Marked(f"standard_form.{name}.value", quantity.value, with_band(displayed))
        rows.append((*words.parameter(name), value, "" if displayed.unit == "1" else displayed.unit))
    return Section("standard_form", "Standard form", {"rows": rows})


def diagnosis_columns(found: Diagnosis) -> tuple[Column, ...]:
    """Base and extended model."""
    base = Column("base model", "base", "base", found.base.quantities, found.base.see, found.base.model)
    if not found.causes:
        return (base,)
    extended = found.extended
    return base, Column(
        "extended model", "extended", "extended", extended.quantities, extended.see, extended.model, found.derived
    )


def identification_columns(found: Identification) -> tuple[Column, ...]:
    """Original model and joint refit, with the paper's way between them where it applies."""
    return tuple(Column(*STAGES[key], key, m.parameters, m.see, m.model) for key, m in found.fits.items())
