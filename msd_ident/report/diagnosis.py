"""Terminal tables of a diagnosis: the verdict first, then causes, models, gain and open questions."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from rich.markup import escape

from msd_ident.diagnosis.verdict import one_acts
from msd_ident.model.effects import by_name
from msd_ident.quantity import probability
from msd_ident.report import calibration, numbers, words
from msd_ident.report.tables import new_table, say

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from msd_ident.diagnosis import Diagnosis
    from msd_ident.quantity import Quantity

_COLOURS = {
    "adequate": "green",
    "explained": "green",
    "mostly_explained": "yellow",
    "ambiguous": "yellow",
    "unexplained": "red",
}


def causes_table(diagnosis: Diagnosis) -> Table | None:
    """The causes by name, probability and parameters; ``None`` without any."""
    if not diagnosis.causes:
        return None
    table = new_table("Causes", "name", "probability", "", "value ± 95 %", "unit")
    for cause in diagnosis.causes:
        lead = (cause.name, probability(cause.probability))
        for name, quantity in cause.parameters.items():
            table.add_row(*lead, words.parameter(name)[1], numbers.with_band(quantity), _unit(quantity))
            lead = ("", "")
    return table


def _unit(quantity: Quantity) -> str:
    return quantity.unit if quantity.unit != "1" else ""


def ties(diagnosis: Diagnosis) -> Iterator[str]:
    """A sentence for each cause that the data cannot tell from others."""
    for cause in diagnosis.causes:
        if cause.tied_with:
            yield f"This data cannot tell {cause.name} from {', '.join(cause.tied_with)}; {one_acts(cause)}."


def models_table(diagnosis: Diagnosis) -> Table:
    """Base and extended model side by side, ± half of the 95 % interval.

    Where other explanations or laws fit equally well, the interval of one of them need not contain the truth: the range
    over all of them replaces it, unless the interval holds the whole range.
    """
    stated, quantities = diagnosis.spread, diagnosis.extended.quantities
    ranges = {
        name: f"{low:.4g} to {high:.4g}"
        for name, (low, high) in stated.items()
        if name in quantities and not quantities[name].low <= low <= high <= quantities[name].high
    }
    title = "Models, ± 95 %; ranges: over all equally good fits" if ranges else "Models, ± 95 %"
    table = new_table(title, "", "base", "extended", "unit")
    for name, quantity in diagnosis.base.quantities.items():
        other = numbers.with_band(diagnosis.extended.quantities[name])
        table.add_row(name, numbers.with_band(quantity), ranges.get(name, other), quantity.unit)
    for name, quantity in diagnosis.derived.items():
        table.add_row(words.parameter(name)[0], "", numbers.with_band(quantity), quantity.unit)
    table.add_section()
    unit = diagnosis.records[0].position_unit
    base, extended, held = diagnosis.base_adequacy, diagnosis.adequacy, diagnosis.heldout
    table.add_row("SEE", numbers.number(diagnosis.base.see), numbers.number(diagnosis.extended.see), unit)
    table.add_row("SEE on left-out data", numbers.number(held.see_base), numbers.number(held.see_extended), unit)
    table.add_row("left over", numbers.number(base.ratio, 3), numbers.number(extended.ratio, 3), "noise floors")
    left = diagnosis.left
    table.add_row(
        "  of the motion", *(numbers.number(one.motion_percent, 2) for one in (left.base, left.extended)), "%"
    )
    table.add_row(
        "  missing force",
        *(numbers.number(one.force, 2) for one in (left.base, left.extended)),
        f"{left.force_unit} rms",
    )
    return table


def rivals_table(diagnosis: Diagnosis) -> Table | None:
    """Other explanations that were fitted, and what they leave.

    A star marks those that hold all named causes too, whose probability counts them.
    """
    if not diagnosis.rivals or diagnosis.verdict == "adequate":
        return None
    named, starred = {by_name(cause.name).cause() for cause in diagnosis.causes}, False
    table = new_table("Other explanations", "causes", "probability", "noise floors left")
    for rival in diagnosis.rivals:
        counted = bool(named) and named <= {by_name(name).cause() for name in rival.causes}
        starred |= counted
        chance = f"{probability(rival.probability)}{' *' * counted}"
        table.add_row(" + ".join(rival.causes) or "none", chance, numbers.number(rival.floors, 3))
    if starred:
        table.caption = "* with the named causes, in this or another law: their probability counts it"
        table.caption_justify = "left"
    return table


def calibration_table(diagnosis: Diagnosis) -> Table | None:
    """How copies of the record were diagnosed; ``None`` where none were made."""
    if diagnosis.calibration is None:
        return None
    found = calibration.matrix(diagnosis.calibration)
    table = new_table("Copies of this record", "simulated", "correct", "diagnosed otherwise", "copies")
    for line in found.lines:
        right = [cell.text for cell in line.cells if cell.right and cell.percent]
        others = [
            f"{head} {cell.text}"
            for head, cell in zip(found.heads, line.cells, strict=True)
            if cell.percent and not cell.right
        ]
        table.add_row(line.name, *(right or ["–"]), ", ".join(others) or "–", str(line.copies))
    return table


def print_diagnosis(diagnosis: Diagnosis, console: Console) -> None:
    """Everything that a lab needs to act on a diagnosis."""
    name = escape(words.records([record.name for record in diagnosis.records]))
    colour = _COLOURS[diagnosis.verdict]
    console.print(f"[bold]{name}[/bold]: [bold {colour}]{diagnosis.verdict}[/bold {colour}]")
    console.print(diagnosis.summary, markup=False)
    console.print()
    tables = (causes_table, calibration_table, models_table, rivals_table)
    for table in (made(diagnosis) for made in tables):
        if table is not None:
            console.print(table)
    for sentence in ties(diagnosis):
        say(console, "tied", "yellow", sentence)
    if diagnosis.calibration is not None:
        say(console, "copies", "cyan", calibration.sentences(diagnosis.calibration)[0])
        for sentence in calibration.corrections(diagnosis.calibration):
            say(console, "copies", "cyan", sentence)
    unit = diagnosis.records[0].position_unit
    share = words.percent(diagnosis.left.noise_percent)
    floor = f"noise floor {numbers.number(diagnosis.noise_floor, 3)} {unit} ({share} of the motion)"
    console.print(f"{floor}; {_gain(diagnosis)}")
    if diagnosis.ring_down is not None:
        for sentence in diagnosis.ring_down.sentences:
            say(console, "ring-down", "cyan", sentence)
    for sentence in diagnosis.warnings:
        say(console, "note", "yellow", sentence)
    if diagnosis.next_experiment is not None:
        say(console, "next", "green", str(diagnosis.next_experiment.get("sentence", "")))


def _gain(diagnosis: Diagnosis) -> str:
    held = diagnosis.heldout
    low, high = held.interval_percent
    reduction = diagnosis.see_reduction_percent
    if not math.isfinite(held.reduction_percent):
        return f"SEE reduced by {reduction:.1f} % in sample"
    return (
        f"SEE reduced by {reduction:.1f} % in sample (eq. 15), by {held.reduction_percent:.1f} % "
        f"({low:.1f} to {high:.1f} %) on left-out data"
    )
