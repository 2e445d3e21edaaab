"""Figures for papers and notebooks, as PNG and SVG: the page's plots, and the paper's Figures 7 and 8."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.diagnosis import Diagnosis
from msd_ident.export import Export
from msd_ident.external import Comparison
from msd_ident.report import matplotlib_figure, verdict_figure
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.page import article
from msd_ident.report.plot import Panel, Plot
from msd_ident.report.plots import force_panel, identification_curves, line, noise_band
from msd_ident.workflow.validation import Validation

if TYPE_CHECKING:
    from msd_ident.report.page import Result
    from msd_ident.workflow.identification import Identification


def plots(found: Result) -> tuple[Plot, ...]:
    """All plots of a result, each with a name of its own."""
    papers = [plot for section in article(found).sections for plot in (*section.plots, *section.beside)]
    if isinstance(found, Diagnosis | Validation | Comparison | Export):
        return _named(papers)
    of_paper = [plot for index in range(len(found.records)) for plot in (_model(found, index), _residual(found, index))]
    return _named([*of_paper, *(plot for plot in papers if plot.slug != "fit")])


def paths(found: Result, directory: Path) -> list[Path]:
    """Where ``save`` writes."""
    first = verdict_figure.paths(directory) if isinstance(found, Diagnosis) else []
    return first + matplotlib_figure.paths(plots(found), directory)


def save(found: Result, directory: Path) -> list[Path]:
    """Write all plots as PNG and SVG; returns the paths.

    Args:
        found: a result.
        directory: folder for the files; made if it does not exist.

    Raises:
        SetupError: the disk does not take them.
    """
    first = verdict_figure.save(found, directory) if isinstance(found, Diagnosis) else []
    return first + matplotlib_figure.save(plots(found), directory)


def _named(found: list[Plot]) -> tuple[Plot, ...]:
    """Numbers behind names that several plots have."""
    count, number_of = Counter(plot.slug for plot in found), Counter[str]()
    named = []
    for plot in found:
        number_of[plot.slug] += 1
        several = count[plot.slug] > 1
        named.append(replace(plot, slug=f"{plot.slug}_{number_of[plot.slug]}") if several else plot)
    return tuple(named)


def _model(found: Identification, index: int) -> Plot:
    """Figure 7: the models on the data."""
    record = found.records[index]
    scale = length_scale(float(np.ptp(record.position)), record.position_unit)
    series = [line("measured", "measured", record.time, scale.factor * record.position)]
    for curve in identification_curves(found):
        series.append(line(curve.label, curve.role, record.time, scale.factor * curve.predicted[index]))
    position = Panel(f"position [{scale.unit}]", tuple(series), 4.0)
    title = f"Model on data: {record.name}"
    return Plot("figure_7_model", title, "time [s]", (force_panel(record), position), height=460)


def _residual(found: Identification, index: int) -> Plot:
    """Figure 8: what each model leaves, each on its own scale."""
    record, panels = found.records[index], []
    for curve, one in zip(identification_curves(found), found.fits.values(), strict=True):
        scale = length_scale(one.see, record.position_unit)
        label = f"{curve.label}: SEE {number(scale.factor * one.see, 3)} {scale.unit}"
        residual = line(label, curve.role, record.time, scale.factor * curve.residuals[index])
        band = noise_band(record, found.noise_floor, scale)
        panels.append(Panel(f"model − data [{scale.unit}]", (band, residual)))
    return Plot("figure_8_residual", f"Model minus data: {record.name}", "time [s]", tuple(panels), height=520)
