"""The verdict as one figure: its sentence, the motion with the residual of each model, and the law through the missing
force.
"""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.report import words
from msd_ident.report.matplotlib_figure import panel, plain, write
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.page import article

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from msd_ident.diagnosis import Diagnosis

_SLUG = "verdict"


def paths(directory: Path) -> list[Path]:
    """Where ``save`` writes."""
    return [directory / f"{_SLUG}.{suffix}" for suffix in ("png", "svg")]


def save(diagnosis: Diagnosis, directory: Path) -> list[Path]:
    """Write it as PNG and SVG.

    Raises:
        SetupError: the disk does not take it.
    """
    return write(draw(diagnosis), paths(directory))


def draw(diagnosis: Diagnosis) -> Figure:
    """The first record's motion on the left, its missing force over velocity on the right."""
    from matplotlib.figure import Figure

    plots = {plot.slug: plot for plot in reversed(article(diagnosis).plots)}
    fit, cloud = plots["fit"], plots["missing_velocity"]
    made = Figure(figsize=(12.0, 5.4), layout="constrained")
    left, right = made.subfigures(1, 2, squeeze=False, width_ratios=(1.45, 1.0))[0]
    axes = left.subplots(len(fit.panels), 1, sharex=True, height_ratios=[one.share for one in fit.panels])
    for place, one in zip(axes, fit.panels, strict=True):
        panel(place, one)
    axes[-1].set_xlabel(fit.xlabel)
    only = right.subplots()
    panel(only, cloud.panels[0], columns=1)
    only.set_xlabel(cloud.xlabel)
    made.suptitle(_title(diagnosis), fontsize=13, fontweight="bold", x=0.01, ha="left")
    made.supxlabel(_numbers(diagnosis), fontsize=10, x=0.01, ha="left", color="#52606d")
    return made


def _title(diagnosis: Diagnosis) -> str:
    name = words.records([record.name for record in diagnosis.records])
    return plain("\n".join(textwrap.wrap(f"{name}: {words.headline(diagnosis)}", 110)))


def _numbers(diagnosis: Diagnosis) -> str:
    scale = length_scale(max(diagnosis.noise_floor, 1e-3 * diagnosis.base.see), diagnosis.records[0].position_unit)
    before, after, floor = (
        f"{number(scale.factor * size, 3)} {scale.unit}"
        for size in (diagnosis.base.see, diagnosis.extended.see, diagnosis.noise_floor)
    )
    gain = words.gain(diagnosis)
    better = f", {gain} better on unseen data" if gain else ""
    return plain(f"error {before}, with the cause {after}, noise floor {floor}{better}")
