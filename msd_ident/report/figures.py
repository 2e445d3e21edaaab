"""Pictures for papers and notebooks: the model on the data (Figure 7) and what it leaves (Figure 8)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from msd_ident.identification import Identification, ModelFit
    from msd_ident.record import FloatArray, Record

INK = {"data": "#222222", "original": "#d1495b", "paper": "#edae49", "refined": "#00798c", "force": "#7a7a7a"}
#: Most points drawn per curve; beyond that the extremes of each bin are kept, so that no peak is lost.
MAXIMUM_POINTS = 4000


def thinned(time: FloatArray, values: FloatArray, points: int = MAXIMUM_POINTS) -> tuple[FloatArray, FloatArray]:
    """Least and greatest value of each of ``points / 2`` bins, in time order: (≤ points,) each."""
    if values.size <= points:
        return time, values
    edges = np.linspace(0, values.size, points // 2 + 1).astype(int)
    keep: list[int] = []
    for low, high in zip(edges[:-1], edges[1:], strict=True):
        part = values[low:high]
        keep += sorted({low + int(part.argmin()), low + int(part.argmax())})
    index = np.asarray(keep)
    return time[index], values[index]


def _scale(record: Record) -> tuple[float, str]:
    return (100.0, "cm") if record.position_unit == "m" else (1.0, record.position_unit)


def _force_axis(axis: Axes, record: Record) -> None:
    start, end = float(record.time[0]), float(record.time[-1])
    inside = (record.force_time > start) & (record.force_time < end)
    stamps = np.concatenate(([start], record.force_time[inside], [end]))
    force = record.force_at(stamps)
    style = "steps-post" if record.hold == "zero" else "default"
    axis.plot(*thinned(stamps, force), color=INK["force"], linewidth=1.2, drawstyle=style)
    axis.set_ylabel(f"force [{record.force_unit}]")


def _figure_model(identification: Identification, index: int, target: Path) -> None:
    from matplotlib.figure import Figure

    record = identification.records[index]
    factor, unit = _scale(record)
    figure = Figure(figsize=(9.0, 5.2), layout="constrained")
    force_axis, axis = figure.subplots(2, 1, sharex=True, height_ratios=(1, 4))
    _force_axis(force_axis, record)
    axis.plot(*thinned(record.time, record.position * factor), color=INK["data"], linewidth=2.6, label="measured")
    for key, label, model in _curves(identification):
        curve = thinned(record.time, model.predicted[index] * factor)
        axis.plot(*curve, color=INK[key], linewidth=1.2, label=label)
    axis.set_xlabel("time [s]")
    axis.set_ylabel(f"position [{unit}]")
    axis.legend(frameon=False, ncols=2)
    force_axis.set_title(f"Model on data: {record.name}")
    figure.savefig(target, dpi=130)


def _figure_residual(identification: Identification, index: int, target: Path) -> None:
    from matplotlib.figure import Figure

    record = identification.records[index]
    factor, unit = _scale(record)
    figure = Figure(figsize=(9.0, 5.2), layout="constrained")
    curves = _curves(identification)
    axes = figure.subplots(len(curves), 1, sharex=True, squeeze=False)[:, 0]
    band = 2.0 * identification.noise_floor * factor
    for axis, (key, label, model) in zip(axes, curves, strict=True):
        residual = (model.predicted[index] - record.position) * factor
        axis.axhspan(-band, band, color="#00000018", linewidth=0)
        axis.plot(*thinned(record.time, residual), color=INK[key], linewidth=1.0)
        axis.set_title(f"{label}: SEE {model.see * factor:.4g} {unit}", loc="left", fontsize=10)
        axis.set_ylabel(f"[{unit}]")
    axes[-1].set_xlabel("time [s]   (grey: twice the noise floor)")
    figure.suptitle(f"Model minus data: {record.name}")
    figure.savefig(target, dpi=130)


def _curves(identification: Identification) -> list[tuple[str, str, ModelFit]]:
    named = [("original", "original (m, b, k)", identification.original)]
    if identification.paper_refined is not None:
        named.append(("paper", "friction raised (paper)", identification.paper_refined))
    named.append(("refined", "joint refit", identification.refined))
    return named


def paths(identification: Identification, directory: Path, suffix: str = "png") -> list[Path]:
    """Where ``save`` writes: Figures 7 and 8 of every record in turn."""
    several = len(identification.records) > 1
    tails = [f"_{index + 1}" if several else "" for index in range(len(identification.records))]
    return [directory / f"{stem}{tail}.{suffix}" for tail in tails for stem in ("figure_7_model", "figure_8_residual")]


def save(identification: Identification, directory: Path, suffix: str = "png") -> list[Path]:
    """Write Figures 7 and 8 for every record; returns the paths in that order."""
    directory.mkdir(parents=True, exist_ok=True)
    targets = paths(identification, directory, suffix)
    for index in range(len(identification.records)):
        _figure_model(identification, index, targets[2 * index])
        _figure_residual(identification, index, targets[2 * index + 1])
    return targets
