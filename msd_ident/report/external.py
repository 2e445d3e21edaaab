"""Terminal output of the comparison of a user's own simulation with a record."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msd_ident.report import numbers
from msd_ident.report.tables import new_table, say

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.external import Comparison


def print_comparison(found: Comparison, console: Console) -> None:
    """The outcome in words, each difference with what it does, and the warnings of the diagnosis."""
    names = ", ".join(record.name for record in found.records)
    console.print(f"{names} against {found.simulation}", style="bold", highlight=False)
    console.print(found.sentence, highlight=False)
    for number, difference in enumerate(found.differences, start=1):
        console.print(f"{number}. {difference.sentence}.", highlight=False)
    unit = found.records[0].position_unit
    table = new_table("Your simulation", "", f"in {unit}")
    table.add_row("error (SEE)", numbers.number(found.see))
    table.add_row("error when corrected", numbers.number(found.rig.see))
    table.add_row("noise floor", numbers.number(found.diagnosis.noise_floor))
    for difference in found.differences:
        table.add_row(f"{difference.name.replace('_', ' ')} moves it by", numbers.number(difference.does))
    console.print(table)
    size = f"{numbers.number(found.missing_size, 3)} {found.records[0].force_unit}"
    console.print(f"The simulation lacks a force of {size} (RMS){_goes_with(found)}.", highlight=False)
    for warning in found.warnings:
        say(console, "warning", "yellow", warning)
    console.print()


def _goes_with(found: Comparison) -> str:
    """The signals that explain most of the force that the simulation lacks."""
    shares = sorted(found.depends_on.items(), key=lambda item: -item[1])
    parts = [f"{signal} ({100.0 * share:.0f} %)" for signal, share in shares]
    return f", which depends on {', '.join(parts)}" if parts else ""
