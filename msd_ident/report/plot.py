"""A plot as plain data, drawn by plotly on the page and by matplotlib in files, so both show the same."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from msd_ident.data.record import FloatArray

#: What a series stands for; the renderers give it its colour, light and dark.
Role = Literal["measured", "base", "extended", "law", "force", "noise", "paper"]
Kind = Literal["line", "steps", "points", "band", "bars"]


@dataclass(frozen=True)
class Series:
    """One curve, cloud or band.

    Attributes:
        name: for the legend; text from outside is shown as it stands, never as markup.
        role: what it stands for.
        x, y: (n,) each.
        kind: ``line``, ``steps`` (held until the next point), ``points``, ``band`` from ``low`` to ``y``, or
            ``bars`` of length ``x`` at the heights ``y`` (in files alone; the page has its own).
        low: (n,) lower edge of a band.
        error: (n,) half-length of error bars of points.
        dashed: a broken line.
        legend: whether it gets its own entry.
    """

    name: str
    role: Role
    x: FloatArray
    y: FloatArray
    kind: Kind = "line"
    low: FloatArray | None = None
    error: FloatArray | None = None
    dashed: bool = False
    legend: bool = True


@dataclass(frozen=True)
class Panel:
    """One pair of axes: what its vertical axis says, its series from back to front, its share of the height, and words
    in place of the vertical axis's numbers.
    """

    ylabel: str
    series: tuple[Series, ...]
    share: float = 1.0
    log: bool = False
    ticks: tuple[tuple[float, str], ...] = ()


@dataclass(frozen=True)
class Plot:
    """Panels above each other on one horizontal axis.

    Attributes:
        slug: short name for files and anchors.
        title: what is seen, in words.
        xlabel: of the common axis.
        panels: from top to bottom.
        height: in pixels on a page.
        log: logarithmic horizontal axis.
    """

    slug: str
    title: str
    xlabel: str
    panels: tuple[Panel, ...]
    height: int = 320
    log: bool = False
