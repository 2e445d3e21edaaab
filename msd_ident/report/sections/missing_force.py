"""The force that a linear plant does not make, and the law drawn through it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from msd_ident.diagnosis.nonlinear_laws import Beyond, beyond
from msd_ident.report import words
from msd_ident.report.numbers import length_scale
from msd_ident.report.plot import Plot
from msd_ident.report.plots import Detail, missing_clouds, missing_time_plot, ring_down_plot
from msd_ident.report.sections.section import Section

if TYPE_CHECKING:
    from msd_ident.diagnosis import Diagnosis


class MissingForce(Section):
    """Against time, velocity and position for each record; the ring-down where there is one."""

    slug = "missing_force"
    title = "The missing force"

    def __init__(self, diagnosis: Diagnosis, detail: Detail) -> None:
        self._found, self._detail = diagnosis, detail

    @cached_property
    def _beyond(self) -> Beyond:
        return beyond(self._found)

    @cached_property
    def by_record(self) -> tuple[tuple[Plot, ...], ...]:
        """For each record: time, velocity, position."""
        return tuple(
            (
                missing_time_plot(self._beyond, record, index, self._detail),
                *missing_clouds(self._beyond, record, index, self._detail),
            )
            for index, record in enumerate(self._found.records)
        )

    @cached_property
    def ring_down(self) -> Plot | None:
        """ζ and ωn against amplitude."""
        found = self._found.ring_down
        if found is None:
            return None
        record = self._found.records[0]
        return ring_down_plot(found, length_scale(float(max(found.amplitude)), record.position_unit))

    @property
    def plots(self) -> tuple[Plot, ...]:
        """All of them."""
        return (*(plot for plots in self.by_record for plot in plots), *filter(None, [self.ring_down]))

    def context(self) -> Mapping[str, Any]:
        """Records with their plots, what the force goes with, the laws."""
        found = self._found
        laws = [(words.effect(cause.name), words.law(cause.name)) for cause in found.causes]
        goes = [(item.signal, item.share) for item in found.dependences]
        records = list(zip((record.name for record in found.records), self.by_record, strict=True))
        sentences = () if found.ring_down is None else found.ring_down.sentences
        return {
            "records": records,
            "ring_down": self.ring_down,
            "sentences": sentences,
            "laws": laws,
            "goes_with": goes,
        }
