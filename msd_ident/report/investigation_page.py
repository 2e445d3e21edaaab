"""The page of an investigation: each experiment, its purpose and its result (HTML)."""

from __future__ import annotations

import base64
import io
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.report import design_figures
from msd_ident.report.writing import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from msd_ident.workflow.investigation import Investigation, Step

_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>msd investigate</title>
<style>body{{font-family:sans-serif;margin:2em auto;max-width:60em;line-height:1.45}} img{{max-width:100%}}
.verdict{{font-weight:bold}} .end{{border-left:4px solid #00798c;padding-left:1em}}</style>
</head><body><h1>Investigation</h1>
<p class="end">{end}</p>
{steps}
</body></html>
"""


def save(found: Investigation, path: Path) -> None:
    """Write the page.

    Raises:
        SetupError: the disk does not take it.
    """
    end = escape(found.sentence) + "".join(f"<br>{escape(one)}" for one in found.measurements)
    steps = "\n".join(_section(number, step) for number, step in enumerate(found.steps, start=1))
    write_text(_PAGE.format(end=end, steps=steps), path)


def _section(number: int, step: Step) -> str:
    parts = [f"<h2>{number}. {escape(step.profile.name)}</h2>", f"<p>Why: {escape(step.purpose)}.</p>"]
    if step.proposal is not None:
        parts.append(f"<p>{escape(step.proposal.sentence)}</p>")
        parts.append(_picture(design_figures.draw(step.proposal), "what the rivals predict"))
    parts.append(_picture(_measured(step), "force and reading"))
    if step.ran.stopped:
        parts.append(f"<p>Stopped early: {escape(step.ran.stopped)}.</p>")
    verdict = f'<span class="verdict">{escape(step.diagnosis.verdict)}</span>'
    parts.append(f"<p>All records so far: {verdict}. {escape(step.diagnosis.summary)}</p>")
    if step.ran.path:
        parts.append(f"<p>Bag: <code>{escape(step.ran.path)}</code></p>")
    return "\n".join(parts)


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


def _picture(figure: Figure, alt: str) -> str:
    handle = io.BytesIO()
    figure.savefig(handle, format="png", dpi=100)
    return f'<p><img alt="{alt}" src="data:image/png;base64,{base64.b64encode(handle.getvalue()).decode("ascii")}"></p>'
