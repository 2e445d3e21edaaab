"""Measured against simulated motion, residuals below, force above."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.data.record import Record
from msd_ident.report.plots import Detail, ModelCurve, fit_plot
from msd_ident.report.sections.section import Section


def fit(records: Sequence[Record], curves: Sequence[ModelCurve], noise_floor: float, detail: Detail) -> Section:
    """One plot a record."""
    plots = (fit_plot(record, curves, index, noise_floor, detail) for index, record in enumerate(records))
    return Section("fit", "Model on data", plots=tuple(plots))
