"""The page of a comparison: differences, every parameter of each record, and the joint fits."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from msd_ident.comparison.comparing import Comparison, Difference
from msd_ident.report.headline_page import HeadlineSection, save
from msd_ident.report.numbers import number
from msd_ident.report.plot import Panel, Plot, Role, Series

_PILLS = {
    "shared": "shared",
    "differs": "differs",
    "explained": "goes with another cause",
    "tied": "cannot be told apart",
    "open": "left open",
}


def save_comparison(found: Comparison, path: Path, source: str) -> None:
    """Write the page.

    Args:
        found: the comparison.
        path: file to write.
        source: table or paths that it is of.

    Raises:
        SetupError: the disk does not take it.
    """
    save("msd compare", source, sections(found), path)


def sections(found: Comparison) -> tuple[HeadlineSection, ...]:
    """What the page says, from top to bottom."""
    surely = any(one.kind == "differs" for one in found.differences)
    groups = ", ".join(f"{name} ({count} records)" for name, count in found.groups.items())
    head = HeadlineSection(
        "verdict",
        found.sentence,
        lines=(f"Compared by {found.by}: {groups}.",),
        warnings=found.warnings,
        pill=("unexplained", "something differs") if surely else ("explained", "nothing differs for certain"),
    )
    rows = tuple(_row(one, found) for one in found.differences)
    table = HeadlineSection("parameters", "Parameters", head=_head(found), rows=rows)
    plots = HeadlineSection("records", "Record by record", plots=tuple(_plot(one, found) for one in found.differences))
    return head, plots, table, _joint(found)


def _head(found: Comparison) -> tuple[str, ...]:
    return ("parameter", *found.groups, "difference", "probability", "other causes", "shown from", "what it is")


def _row(one: Difference, found: Comparison) -> tuple[str, ...]:
    sizes = "; ".join(f"{group} {size:+.2g} % ± {half:.1g}" for group, (size, half) in one.percent.items())
    rivals = ", ".join(f"{name} {p:.3f}" for name, p in one.rivals.items()) or "–"
    kind = _PILLS[one.kind] + (f" ({', '.join(one.tied_with)})" if one.tied_with else "")
    values = tuple(f"{number(one.values[group], 5)} {one.unit}" for group in found.groups)
    return (one.parameter, *values, sizes, f"{one.probability:.3f}", rivals, f"±{one.resolution:.2g} %", kind)


def _plot(one: Difference, found: Comparison) -> Plot:
    series, at = [], 0
    roles: tuple[Role, ...] = ("extended", "base", "law", "paper")
    for place, group in enumerate(found.groups):
        of = [made for made in found.estimates if made.source.group == group]
        index = of[0].fit.free.index(one.parameter)
        values = np.array([made.values[index] for made in of])
        wide = 1.96 * np.sqrt(np.array([made.covariance[index, index] for made in of]))
        wide = np.where(wide < 10.0 * np.abs(values) + 1e-300, wide, 0.0)
        x = np.arange(at + 1.0, at + 1.0 + values.size)
        series.append(Series(f"{found.by} {group}", roles[place % len(roles)], x, values, "points", error=wide))
        at += values.size
    label = f"{one.parameter} [{one.unit}]"
    return Plot(one.parameter, f"{one.parameter}: {_PILLS[one.kind]}", "record", (Panel(label, tuple(series)),), 260)


def _joint(found: Comparison) -> HeadlineSection:
    rows = tuple(
        (", ".join(one.differing) or "nothing: all shared", f"{one.chi2:.6g}", "yes" if one.converged else "no")
        for one in found.joint
    )
    lines = (
        "Each row is one fit of all groups together by simulation error. A parameter that differs has a value for each "
        "group, the others have one for all. If sharing one more parameter increases chi² by much, that parameter "
        "differs.",
    )
    return HeadlineSection(
        "joint", "Joint fits", lines=lines, head=("free in each group", "chi²", "converged"), rows=rows
    )
