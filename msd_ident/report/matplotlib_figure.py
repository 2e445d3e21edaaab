"""Plots for papers: the page's plots, drawn by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.report.plot import Panel, Plot, Series
from msd_ident.writing import writing_to

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours of the roles: distinguishable for colour-blind readers, and dark enough for print.
INK = {
    "measured": "#1f2933",
    "base": "#d1495b",
    "extended": "#00798c",
    "law": "#7048b6",
    "force": "#6b7280",
    "noise": "#9aa5b1",
    "paper": "#b7791f",
}
SUFFIXES = ("png", "svg")
_WIDTH, _DOTS = 8.0, 160


def draw(plot: Plot) -> Figure:
    """The figure, its height in proportion to the page's."""
    from matplotlib.figure import Figure

    made = Figure(figsize=(_WIDTH, plot.height / 90.0), layout="constrained")
    grid = made.subplots(
        len(plot.panels), 1, sharex=True, squeeze=False, height_ratios=[one.share for one in plot.panels]
    )
    for axes, one in zip(grid[:, 0], plot.panels, strict=True):
        panel(axes, one)
    grid[-1, 0].set_xlabel(plot.xlabel)
    if plot.log:
        grid[-1, 0].set_xscale("log")
    made.suptitle(plain(plot.title), fontsize=11, x=0.02, ha="left")
    return made


def save(plots: Sequence[Plot], directory: Path) -> list[Path]:
    """Write every plot as PNG and SVG; the paths in that order.

    Raises:
        SetupError: the disk does not take them.
    """
    return [path for plot in plots for path in write(draw(plot), paths([plot], directory))]


def write(figure: Figure, targets: list[Path]) -> list[Path]:
    """Save one figure under several names; the same figure gives the same file.

    Raises:
        SetupError: the disk does not take it.
    """
    from matplotlib import rc_context

    figure.draw_without_rendering()  # lays it out: once is enough for all files
    figure.set_layout_engine(None)
    for target in targets:
        with writing_to(target), rc_context({"svg.hashsalt": ""}):  # names in the file are drawn by lot without it
            target.parent.mkdir(parents=True, exist_ok=True)
            figure.savefig(target, dpi=_DOTS, metadata={"Date": None} if target.suffix == ".svg" else None)
    return targets


def paths(plots: Sequence[Plot], directory: Path) -> list[Path]:
    """Where ``save`` writes."""
    return [directory / f"{plot.slug}.{suffix}" for plot in plots for suffix in SUFFIXES]


def panel(axes: Axes, shown: Panel, columns: int = 4) -> None:
    """Draw one pair of axes, its legend above in so many columns."""
    for series in shown.series:
        _series(axes, series)
    axes.set_ylabel(shown.ylabel)
    if shown.log:
        axes.set_yscale("log")
    if shown.ticks:
        axes.set_yticks([place for place, _ in shown.ticks], [plain(word) for _, word in shown.ticks])
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    if any(series.legend for series in shown.series):
        axes.legend(
            frameon=False,
            fontsize=8,
            ncols=columns,
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            borderaxespad=0.1,
            markerscale=3.0,
        )


def _series(axes: Axes, series: Series) -> None:
    colour, label = INK[series.role], plain(series.name) if series.legend else None
    if series.kind == "band":
        assert series.low is not None
        axes.fill_between(series.x, series.low, series.y, color=colour, alpha=0.25, linewidth=0, label=label)
    elif series.kind == "bars":
        axes.barh(series.y, series.x, color=colour, height=0.6, label=label)
    elif series.kind == "points" and series.error is not None:
        axes.errorbar(series.x, series.y, series.error, fmt="o", markersize=3, color=colour, linewidth=0.8, label=label)
    elif series.kind == "points":
        many = series.x.size >= 200
        size, alpha = (1.9, 0.5) if many else (3.5, 1.0)
        axes.plot(series.x, series.y, ".", markersize=2 * size, alpha=alpha, color=colour, mew=0, label=label)
    else:
        width = {"measured": 2.2, "law": 2.0}.get(series.role, 1.1)
        axes.plot(
            series.x,
            series.y,
            color=colour,
            linewidth=width,
            linestyle="--" if series.dashed else "-",
            drawstyle="steps-post" if series.kind == "steps" else "default",
            label=label,
        )


def plain(text: str) -> str:
    """Text from outside as it stands: a dollar sign would begin a formula."""
    return text.replace("$", r"\$")
