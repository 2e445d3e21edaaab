"""The page of an investigation: each experiment, its purpose and its result (HTML)."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.report import design_figures
from msd_ident.report.page import environment
from msd_ident.writing import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from msd_ident.workflow.investigation import Investigation, Step


def save(found: Investigation, path: Path) -> None:
    """Write the page.

    Raises:
        SetupError: the disk does not take it.
    """
    template = environment().get_template("investigation.html.j2")
    write_text(template.render(found=found, png=_png, measured=_measured, predicted=design_figures.draw) + "\n", path)


def _measured(step: Step) -> Figure:
    from matplotlib.figure import Figure

    record = step.ran.record
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    force, motion = figure.subplots(2, 1, sharex=True, height_ratios=(1, 2))
    force.plot(record.time, record.force_at(record.time), color="#7a7a7a")
    force.set_ylabel(f"force [{record.force_unit}]")
    motion.plot(record.time, record.position, color="#222222", linewidth=0.9)
    motion.set_ylabel(f"reading [{record.position_unit}]")
    motion.set_xlabel("time [s]")
    return figure


def _png(figure: Figure) -> str:
    """A figure as an address that holds it."""
    handle = io.BytesIO()
    figure.savefig(handle, format="png", dpi=100)
    return f"data:image/png;base64,{base64.b64encode(handle.getvalue()).decode('ascii')}"
