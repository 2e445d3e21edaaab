"""The force that a model lacks, for each record, and the law drawn through it."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.diagnosis.nonlinear_laws import Beyond, beyond
from msd_ident.report import words
from msd_ident.report.numbers import length_scale
from msd_ident.report.plot import Plot
from msd_ident.report.plots import Detail, MissingForceView, missing_force_plots, ring_down_plot
from msd_ident.report.sections.section import Section

#: For each record its name, and the plots of a force against time, velocity and position.
ByRecord = tuple[tuple[str, tuple[Plot, ...]], ...]


def by_record(force: Beyond, unit: str, records: Sequence[Record], detail: Detail, model: str) -> ByRecord:
    """The plots of a force [unit] that a model lacks, and of what ``model`` makes of it."""
    return tuple(
        (record.name, missing_force_plots(MissingForceView(force, unit, record, index, detail, model)))
        for index, record in enumerate(records)
    )


def flat(drawn: ByRecord) -> tuple[Plot, ...]:
    """All plots of all records."""
    return tuple(plot for _, plots in drawn for plot in plots)


def missing_force(found: Diagnosis, detail: Detail) -> Section:
    """The force that the base model lacks, what it goes with, the laws; the ring-down where there is one."""
    drawn, ring_down = by_record(beyond(found), found.left.force_unit, found.records, detail, "extended model"), None
    if found.ring_down is not None:
        scale = length_scale(float(max(found.ring_down.amplitude)), found.records[0].position_unit)
        ring_down = ring_down_plot(found.ring_down, scale)
    context = {
        "records": drawn,
        "ring_down": ring_down,
        "sentences": () if found.ring_down is None else found.ring_down.sentences,
        "laws": [(words.effect(cause.name), words.law(cause.name)) for cause in found.causes],
        "goes_with": [(item.signal, item.share) for item in found.dependences],
    }
    plots = (*flat(drawn), *filter(None, [ring_down]))
    return Section("missing_force", "The missing force", context, plots)
