"""A page about diagnoses: what the terminal shows, with pictures of the missing force and of what is left (HTML)."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.report.diagnosis import print_diagnosis

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from msd_ident.diagnose import Diagnosis

_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>msd diagnose</title>
<style>body{{font-family:sans-serif;margin:2em;max-width:75em}} img{{max-width:100%}} pre{{line-height:1.25}}</style>
</head><body>
{body}
</body></html>
"""


def save(diagnoses: Sequence[Diagnosis], path: Path) -> None:
    """Write one page about all diagnoses."""
    path.write_text(_PAGE.format(body="\n<hr>\n".join(_section(found) for found in diagnoses)), encoding="utf-8")


def _section(diagnosis: Diagnosis) -> str:
    from rich.console import Console

    console = Console(record=True, width=110, file=io.StringIO(), highlight=False)
    print_diagnosis(diagnosis, console)
    text = console.export_html(inline_styles=True, code_format="<pre>{code}</pre>")
    handle = io.BytesIO()
    draw(diagnosis).savefig(handle, format="png", dpi=110)
    picture = base64.b64encode(handle.getvalue()).decode("ascii")
    return f'{text}\n<p><img alt="missing force and residual" src="data:image/png;base64,{picture}"></p>'


def draw(diagnosis: Diagnosis) -> Figure:
    """Missing force over velocity, position and time with its band, and the residual before and after."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    axes = figure.subplots(2, 2)
    unit, length = diagnosis.records[0].force_unit, diagnosis.records[0].position_unit
    for part in diagnosis.missing:
        axes[0][0].plot(part.velocity, part.force, ".", markersize=1)
        axes[0][1].plot(part.position, part.force, ".", markersize=1)
        axes[1][0].plot(part.time, part.force, linewidth=0.8)
        low, high = part.force - 2.0 * part.std, part.force + 2.0 * part.std
        axes[1][0].fill_between(part.time, low, high, alpha=0.3)
    for record, before, after in zip(
        diagnosis.records, diagnosis.base.residuals, diagnosis.extended.residuals, strict=True
    ):
        axes[1][1].plot(record.time, before, color="0.6", linewidth=0.8, label="base")
        axes[1][1].plot(record.time, after, color="C3", linewidth=0.8, label="extended")
    names = (f"velocity [{length}/s]", f"position [{length}]", "time [s]", "time [s]")
    for axis, name in zip(axes.flat, names, strict=True):
        axis.set_xlabel(name)
        axis.set_ylabel(f"missing force [{unit}]")
        axis.grid(alpha=0.3)
    axes[1][1].set_ylabel(f"model − data [{length}]")
    axes[1][1].legend(loc="upper right")
    return figure
