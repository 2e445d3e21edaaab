"""Terminal output of an export: how each effect is written, and the proof."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msd_ident.export.header import DOWNWARDS
from msd_ident.export.target import Target
from msd_ident.report import numbers
from msd_ident.report.tables import new_table, say
from msd_ident.workflow.explained_motion import percent_text

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from msd_ident.export import Export


def print_export(found: Export, console: Console) -> None:
    """Files, the table of effects, the proof; the outcome in words first."""
    console.print(found.sentence, highlight=False)
    for path in found.files:
        console.print(f"wrote {path}", highlight=False)
    for row in found.rows:
        console.print(f"  {row.sentence}", highlight=False)
    if found.plan.saved.force_sign < 0 and found.target.turned != Target.turned:
        say(console, "note", "yellow", f"In this record {DOWNWARDS}; {found.target.turned}.")
    if found.nearest is not None:
        say(console, "note", "yellow", f"Written {found.nearest.sentence}.")
    if found.proof is not None:
        console.print(proof_table(found))
    console.print()


def proof_table(found: Export) -> Table:
    """What the simulations leave, in the target and here."""
    assert found.proof is not None
    unit = found.plan.saved.position_unit
    table = new_table("Replay", "", f"SEE in {unit}", "motion explained in %")
    lines = [("this model, simulated by msd_ident", "ours")]
    if found.nearest is not None:
        lines.append(("nearest model in this format, predicted", "expected"))
    lines += [(f"exported, run in {found.target.name}", "target"), ("m, b, k alone, run there", "base")]
    for label, name in lines:
        table.add_row(label, numbers.number(found.proof.see(name)), percent_text(found.proof.explained(name)))
    return table
