"""The page of a watch: each robot's parameters over time with their change points, and the statistic of the alarm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.monitoring.watching import Series as WatchedSeries
from msd_ident.monitoring.watching import Watch
from msd_ident.report.headline_page import HeadlineSection, save
from msd_ident.report.plot import Panel, Plot, Role, Series

_DAY = 86400.0


def save_watches(found: Sequence[Watch], path: Path, source: str) -> None:
    """Write the page.

    Args:
        found: one entry per robot.
        path: file to write.
        source: table or paths that they are of.

    Raises:
        SetupError: the disk does not take it.
    """
    save("msd watch", source, sections(found), path)


def sections(found: Sequence[Watch]) -> tuple[HeadlineSection, ...]:
    """What the page says: all robots in a table, then each."""
    alarmed = [one for one in found if one.alarms]
    title = f"{len(alarmed)} of {len(found)} robots changed" if alarmed else "No robot changed"
    rows = tuple((one.name or "–", "alarm" if one.alarms else "quiet", one.sentence) for one in found)
    pill = ("unexplained", "alarm") if alarmed else ("explained", "no alarm")
    head = HeadlineSection("verdict", title, pill=pill)
    table = HeadlineSection("robots", "Robots", head=("robot", "state", "what was found"), rows=rows)
    return (head, table, *(_robot(one, place) for place, one in enumerate(found)))


def _robot(one: Watch, place: int) -> HeadlineSection:
    moved = f"Removed beforehand: {', '.join(one.moved_by)}. " if one.moved_by else ""
    line = (
        f"{moved}The alarm is given where M passes {one.threshold:.4g}. Without any change the mean number of records "
        f"to an alarm is at least that: at most {one.rate:g} a year."
    )
    return HeadlineSection(
        f"robot{place}", one.name or "all records", lines=(one.sentence, line), plots=(_plot(one, place),)
    )


def _plot(one: Watch, place: int) -> Plot:
    times = np.array([sample.time for sample in one.samples])
    dated = bool(np.all(np.isfinite(times))) and float(np.ptp(times)) > 0.0
    at = (times - times[0]) / _DAY if dated else np.arange(times.size, dtype=float)
    panels = [_panel(series, at) for series in one.series]
    panels += [_causes(one, at)] if any(max(s.causes.values(), default=0.0) > 0.5 for s in one.samples) else []
    statistic = Series("M", "law", at, np.maximum(one.statistic, 1e-3), "steps", legend=False)
    edge = Series("threshold", "base", at[[0, -1]], np.full(2, one.threshold), dashed=True)
    panels.append(Panel("alarm M", (statistic, edge), 0.8, log=True))
    label = "days since the first record" if dated else "record"
    return Plot(f"watch{place}", f"{one.name}: parameters over time", label, tuple(panels), 150 * len(panels) + 80)


def _panel(series: WatchedSeries, at: FloatArray) -> Panel:
    x, unit = at[list(series.index)], series.name
    wide = 1.96 * np.where(np.isfinite(series.stds), series.stds, 0.0)
    drawn = [Series(series.name, "extended", x, series.values, "points", error=wide, legend=False)]
    edges = [0, *(change.index for change in series.changes), series.values.size]
    for first, last in zip(edges, edges[1:], strict=False):
        level = np.full(2, float(np.mean(series.values[first:last])))
        drawn.append(Series("level", "base", x[[first, last - 1]], level, legend=False))
    return Panel(unit, tuple(drawn))


def _causes(one: Watch, at: FloatArray) -> Panel:
    names = sorted({name for s in one.samples for name, p in s.causes.items() if p > 0.5})
    roles: tuple[Role, ...] = ("law", "paper", "force", "extended", "base")
    drawn = [
        Series(name.replace("_", " "), roles[i % len(roles)], at, np.array([_p(s.causes, name) for s in one.samples]))
        for i, name in enumerate(names)
    ]
    return Panel("cause's probability", tuple(drawn), 0.7)


def _p(causes: object, name: str) -> float:
    value = causes.get(name, math.nan) if isinstance(causes, dict) else math.nan
    return float(value)
