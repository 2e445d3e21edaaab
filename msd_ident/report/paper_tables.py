"""Output of ``msd paper``: Tables 2 and 3 next to the printed ones, and what the paper's model cannot reproduce."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from msd_ident.report.numbers import number
from msd_ident.report.tables import new_table

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from msd_ident.paper.method import Paper
    from msd_ident.paper.models import Closest

#: Name → (label, factor to the printed unit, unit).
_ROWS = {
    "natural_frequency": ("natural frequency ωn", 1.0, "rad/s"),
    "damping_ratio": ("damping ratio ζ", 1.0, "1"),
    "static_gain": ("static gain K", 100.0, "cm/N"),
    "force": ("force F", 1.0, "N"),
    "mass": ("mass m", 1.0, "kg"),
    "damping": ("viscous damping b", 1.0, "N·s/m"),
    "stiffness": ("stiffness k", 1.0, "N/m"),
}
_RESPONSE = {
    "first_peak": ("first peak x1", 100.0, "cm"),
    "second_peak": ("second peak x2", 100.0, "cm"),
    "steady_state": ("steady state xss", 100.0, "cm"),
    "first_time": ("time of x1, t1", 1.0, "s"),
    "second_time": ("time of x2, t2", 1.0, "s"),
}


def comparison_table(paper: Paper) -> Table:
    """Tables 2 and 3: computed from Table 1 by eqs. 3 to 13, and as printed."""
    table = new_table("Tables 2 and 3, from Table 1 by eqs. 3 to 13", "", "computed", "printed", "difference", "unit")
    for name, (label, factor, unit) in _ROWS.items():
        computed, printed = getattr(paper.derived, name) * factor, getattr(paper.printed, name) * factor
        table.add_row(label, number(computed, 5), number(printed), number(computed - printed, 2), unit)
    return table


def inconsistency_table(paper: Paper) -> Table:
    """The table's numbers, the printed refined model, and the viscous + Coulomb models that come nearest."""
    title = "Can viscous and Coulomb friction do this? (m, b, k and Fc all free)"
    table = new_table(title, "", "Table 1", "printed", "nearest", "off by", "most even", "unit")
    for name, (label, factor, unit) in _RESPONSE.items():
        data = getattr(paper.table, name) * factor
        printed = getattr(paper.printed_response, name) * factor
        nearest = getattr(paper.coulomb.response, name) * factor
        even = getattr(paper.coulomb_even.response, name) * factor
        shown = [number(value) for value in (data, printed, nearest)]
        table.add_row(label, *shown, number(nearest - data, 2), number(even), unit)
    return table


def causes_table(causes: Sequence[Closest]) -> Table:
    """Which single causes reproduce peaks, rest value and times, and how far off the others stay."""
    table = new_table("One cause in addition to m, b and k", "", "parameters", "cm off", "ms off", "reproduces")
    for cause in causes:
        count = str(len(cause.model.names) - 3)
        off = (_off(100.0 * cause.distance, 3), _off(1e3 * cause.lateness, 1))
        table.add_row(cause.cause, count, *off, "yes" if cause.reproduces else "no")
    return table


def _off(distance: float, places: int) -> str:
    """A distance to the last digit printed; what is smaller is not worth its digits."""
    return f"{distance:.{places}f}" if distance >= 0.5 * 10.0**-places else "0"


def print_paper(paper: Paper, console: Console) -> None:
    """All of it, with the sentence that follows."""
    console.print(comparison_table(paper))
    console.print(inconsistency_table(paper))
    console.print(causes_table(paper.causes))
    for sentence in paper.sentences:
        console.print(sentence)
