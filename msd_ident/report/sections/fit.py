"""Measured against simulated motion, residuals below, force above."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

from msd_ident.report.plot import Plot
from msd_ident.report.plots import Detail, ModelCurve, fit_plot
from msd_ident.report.sections.section import Section

if TYPE_CHECKING:
    from msd_ident.data.record import Record


class Fit(Section):
    """One plot a record."""

    slug = "fit"
    title = "Model on data"

    def __init__(
        self, records: Sequence[Record], curves: Sequence[ModelCurve], noise_floor: float, detail: Detail
    ) -> None:
        self._records, self._curves, self._floor, self._detail = records, curves, noise_floor, detail

    @cached_property
    def plots(self) -> tuple[Plot, ...]:
        """The plot of each record."""
        return tuple(
            fit_plot(record, self._curves, index, self._floor, self._detail)
            for index, record in enumerate(self._records)
        )

    def context(self) -> Mapping[str, Any]:
        """Nothing beside the plots."""
        return {}
