"""Terminal tables of a designed experiment: what it detects, and the profiles that were considered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msd_ident.design import Proposal
from msd_ident.report.tables import new_table

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.design.parameter_design import Sharpened
    from msd_ident.diagnosis import Diagnosis

_SHOWN = 6


def print_design(found: Proposal | Sharpened | None, diagnosis: Diagnosis, console: Console) -> None:
    """What to do next and why; or that there is nothing to decide."""
    if found is None:
        console.print(nothing(diagnosis))
    elif isinstance(found, Proposal):
        _print_proposal(found, console)
    else:
        _print_sharpened(found, console)


def nothing(diagnosis: Diagnosis) -> str:
    """Why no experiment is proposed."""
    causes = ", ".join(cause.name for cause in diagnosis.causes) or "mass, damping and stiffness alone"
    return (
        f"No causes are tied: the verdict is {diagnosis.verdict} ({causes}). "
        "Use --check for an experiment that shows what this data could not, or --for to sharpen parameters."
    )


def _print_proposal(found: Proposal, console: Console) -> None:
    console.print(found.sentence)
    console.print()
    table = new_table("If it is true", "explanation", "detected with probability")
    for name, decided in zip(found.names, found.decided, strict=True):
        table.add_row(name, f"{decided:.2f}")
    console.print(table)
    table = new_table("Experiments considered (screening)", "profile", "s", "probability")
    for name, duration, probability in found.considered[:_SHOWN]:
        table.add_row(name, f"{duration:.1f}", f"{probability:.2f}")
    console.print(table)
    for sentence in found.measurements:
        console.print(f"[yellow]measure:[/yellow] {sentence}")


def _print_sharpened(found: Sharpened, console: Console) -> None:
    console.print(found.sentence)
    console.print()
    table = new_table("Expected half of the 95 % interval", "", "value", "now", "designed", "single step", "random")
    for name, value in found.values.items():
        widths = (found.now[name], found.after[name], found.step[name], found.random[name])
        table.add_row(name, f"{value:.5g}", *(f"{width:.2g}" for width in widths))
    console.print(table)
