"""The force that a linear plant does not make, and the law drawn through it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from msd_ident.diagnosis import Diagnosis
from msd_ident.diagnosis.nonlinear_laws import Beyond, beyond
from msd_ident.report import words
from msd_ident.report.numbers import length_scale
from msd_ident.report.plot import Plot
from msd_ident.report.plots import Detail, MissingForceView, missing_force_plots, ring_down_plot
from msd_ident.report.sections.section import Found, ResultSection

if TYPE_CHECKING:
    from msd_ident.data.record import Record


class ForceSection(ResultSection[Found]):
    """A force that a model lacks, against time, velocity and position for each record.

    Args:
        found: the result.
        records: that it is of.
        detail: points per curve.
    """

    model: ClassVar[str] = "extended model"

    def __init__(self, found: Found, records: tuple[Record, ...], detail: Detail) -> None:
        super().__init__(found)
        self._records, self._detail = records, detail

    @cached_property
    @abstractmethod
    def force(self) -> Beyond:
        """The force, and what the model makes of it."""

    @cached_property
    def by_record(self) -> tuple[tuple[str, tuple[Plot, ...]], ...]:
        """For each record its name, and the plots against time, velocity and position."""
        return tuple(
            (record.name, missing_force_plots(MissingForceView(self.force, record, index, self._detail, self.model)))
            for index, record in enumerate(self._records)
        )

    @property
    def plots(self) -> tuple[Plot, ...]:
        """All of them."""
        return tuple(plot for _, plots in self.by_record for plot in plots)


class MissingForce(ForceSection[Diagnosis]):
    """That of the base model; the ring-down where there is one."""

    slug = "missing_force"
    title = "The missing force"

    @cached_property
    def force(self) -> Beyond:
        """The force, and what the extended model makes of it."""
        return beyond(self._found)

    @cached_property
    def ring_down(self) -> Plot | None:
        """ζ and ωn against amplitude."""
        found = self._found.ring_down
        if found is None:
            return None
        return ring_down_plot(found, length_scale(float(max(found.amplitude)), self._records[0].position_unit))

    @property
    def plots(self) -> tuple[Plot, ...]:
        """All of them."""
        return (*super().plots, *filter(None, [self.ring_down]))

    def context(self) -> Mapping[str, Any]:
        """Records with their plots, what the force goes with, the laws."""
        found = self._found
        laws = [(words.effect(cause.name), words.law(cause.name)) for cause in found.causes]
        goes = [(item.signal, item.share) for item in found.dependences]
        sentences = () if found.ring_down is None else found.ring_down.sentences
        return {
            "records": self.by_record,
            "ring_down": self.ring_down,
            "sentences": sentences,
            "laws": laws,
            "goes_with": goes,
        }
