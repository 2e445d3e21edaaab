"""Terminal output of a validation: errors on both records, and the tests of the residual in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msd_ident.report import numbers
from msd_ident.report.tables import new_table, say
from msd_ident.workflow.explained_motion import percent_text

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from msd_ident.workflow.validation import Validation


def trial_table(found: Validation) -> Table:
    """What the model leaves on its own record and here."""
    unit = found.records[0].position_unit
    table = new_table("Saved model on another record", "", "own record", "here", "unit")
    table.add_row("SEE", numbers.number(found.saved.see), numbers.number(found.see), unit)
    table.add_row("motion explained", "", percent_text(found.explained_percent), "%")
    table.add_row("noise floor", "", numbers.number(found.noise_floor), unit)
    table.add_row("left over", "", numbers.number(found.adequacy.ratio, 3), "noise floors")
    if found.missing:
        table.add_row("missing force", "", numbers.number(found.missing_size, 3), found.records[0].force_unit)
    return table


def print_validation(found: Validation, console: Console) -> None:
    """Everything, the outcome in words first."""
    names = ", ".join(record.name for record in found.records)
    console.print(found.sentence, style="" if found.met else "red", highlight=False)
    console.print(f"{names}: refitted {', '.join(found.refitted)}; all parameters kept", highlight=False)
    console.print(trial_table(found))
    for sentence in sentences(found):
        console.print(sentence, highlight=False)
    for warning in found.warnings:
        say(console, "warning", "yellow", warning)
    console.print()


def sentences(found: Validation) -> tuple[str, ...]:
    """The tests of the residual, and what became of the missing force, in words."""
    tests = found.adequacy
    if tests.consistent:
        lines = ["The residual is consistent with noise."]
    else:
        lines = [
            "The residual is not noise alone: the probability that noise is as large is "
            f"{tests.size:.2g}, as correlated {tests.whiteness:.2g}, as dependent on force and motion "
            f"{tests.independence:.2g}."
        ]
    if found.states:
        listed = "; ".join(f"{signal}: {state}" for signal, state in found.states.items())
        lines.append(
            f"Signals that the missing force of mass, damping and stiffness depended on, on their own record: {listed}."
        )
    return tuple(lines)
