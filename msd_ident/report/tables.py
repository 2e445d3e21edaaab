"""Terminal tables of an identification, after the paper's Tables 1 to 3; 80 columns are enough."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from rich import box
from rich.markup import escape
from rich.table import Table

from msd_ident.estimate.result import scale_known
from msd_ident.model.base_model import FRICTION_FORCE, OFFSET_FORCE
from msd_ident.model.rest import AT_REST
from msd_ident.quantity import Quantity
from msd_ident.report import numbers

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.features import Response
    from msd_ident.features.oscillation import TwoPeaks
    from msd_ident.workflow.identification import Identification, ModelFit

#: Parameter → (words, symbol), design names in the order in which tables list them.
WORDS = {
    "mass": ("mass", "m"),
    "damping": ("viscous damping", "b"),
    "stiffness": ("stiffness", "k"),
    AT_REST: ("stiffness at rest", "k0"),
    FRICTION_FORCE: ("dry friction", "Fc"),
    "friction_coefficient": ("friction coeff.", "µ"),
    OFFSET_FORCE: ("constant force", "F0"),
    "natural_frequency": ("natural frequency", "ωn"),
    "damping_ratio": ("damping ratio", "ζ"),
    "static_gain": ("static gain", "K"),
}
#: What each verdict means, in two or three words.
VERDICTS = {
    "adequate": "the model is enough",
    "explained": "cause named",
    "mostly_explained": "cause named, more is missing",
    "ambiguous": "several causes possible",
    "unexplained": "no known cause",
}


def new_table(title: str, *columns: str) -> Table:
    """An empty table in the house style: first column left, the others right. What is too wide goes on in the next
    line, as half a number would be read as a whole one.
    """
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index == 0 else "right", overflow="fold")
    return table


def _label(name: str) -> str:
    words, symbol = WORDS.get(name, (name.replace("_", " "), ""))
    return f"{words} {symbol}".strip()


def features_table(identification: Identification) -> Table | None:
    """What was read off each response (the paper's Table 1); ``None`` where there are no responses."""
    responses = [response for features in identification.features for response in features.responses]
    if not responses:
        return None
    shown = responses[:4]
    heads = [f"at {response.onset:.3f} s" for response in shown]
    title = "Features (Table 1)" if len(responses) <= 4 else f"Features (Table 1), the first 4 of {len(responses)}"
    table = new_table(title, "", *heads, "unit")
    record = identification.records[0]
    factor, unit = _length(identification)
    for label, cells, cell_unit in _feature_rows(shown, factor, unit, record.force_unit):
        table.add_row(label, *cells, cell_unit)
    return table


def _feature_rows(
    responses: Sequence[Response], factor: float, unit: str, force_unit: str
) -> Iterator[tuple[str, list[str], str]]:
    peaks = [response.peaks for response in responses]

    def row(read: Callable[[TwoPeaks, float], float], digits: int = 4) -> list[str]:
        pairs = zip(peaks, responses, strict=True)
        return [numbers.number(read(pair, r.onset), digits) if pair else "–" for pair, r in pairs]

    yield "force step", [numbers.number(response.amplitude) for response in responses], force_unit
    yield "first peak x1", row(lambda pair, start: pair.first.value * factor), unit
    yield "second peak x2", row(lambda pair, start: pair.second.value * factor), unit
    yield "after the step t1", row(lambda pair, start: pair.first.time - start), "s"
    yield "after the step t2", row(lambda pair, start: pair.second.time - start), "s"
    yield "steady state xss", [numbers.number(r.steady_state.value * factor) for r in responses], unit
    yield "decrement δ", row(lambda pair, start: pair.logarithmic_decrement.value), "1"
    yield "ωn of two peaks", row(lambda pair, start: pair.natural_frequency.value), "rad/s"
    yield "ζ of two peaks", row(lambda pair, start: pair.damping_ratio.value, 3), "1"
    yield "turning points", [str(len(response.turns)) for response in responses], ""


def standard_form_table(identification: Identification) -> Table | None:
    """ωn, ζ, K with their intervals (the paper's Table 2); ``None`` where no response tells."""
    if identification.standard_form is None:
        return None
    two = identification.two_peak_form.quantities if identification.two_peak_form else {}
    table = new_table("Standard form (Table 2)", "", "two peaks", "all peaks", "95 % interval", "unit")
    for name, quantity in identification.standard_form.quantities.items():
        shown = numbers.shown(quantity)
        paper = numbers.number(numbers.shown(two[name]).value) if name in two else "–"
        table.add_row(_label(name), paper, numbers.value(shown), numbers.interval(shown), shown.unit)
    return table


def _row(table: Table, name: str, quantity: Quantity) -> None:
    shown = numbers.shown(quantity)
    table.add_row(_label(name), numbers.value(shown), numbers.interval(shown), shown.unit)


def parameter_table(identification: Identification) -> Table:
    """Original model, friction raised, and joint refit side by side, with their SEE (the paper's Table 3)."""
    fits, heads = identification.fits.values(), {"paper_refined": "friction raised", "refined": "joint refit"}
    columns = (heads.get(key, key) for key in identification.fits)
    table = new_table("Physical parameters (Table 3)", "", *columns, "unit")
    for name in dict.fromkeys(name for found in fits for name in found.parameters):
        unit = next(found.parameters[name].unit for found in fits if name in found.parameters)
        table.add_row(_label(name), *(_cell(found, name) for found in fits), unit)
    table.add_section()
    factor, unit = _length(identification)
    table.add_row("SEE", *(numbers.number(found.see * factor, 3) for found in fits), unit)
    reductions = [numbers.number(round(value, 6), 3) for value in _reductions(identification)]
    table.add_row("SEE reduction", *["–", *reductions][-len(fits) :], "%")
    return table


def _reductions(identification: Identification) -> list[float]:
    joint = [identification.see_reduction_percent]
    return joint if identification.paper_refined is None else [identification.paper_see_reduction_percent, *joint]


def _cell(found: ModelFit, name: str) -> str:
    if name not in found.parameters or not _told(found.parameters, name):
        return "–"
    return numbers.number(found.parameters[name].value, 5)


def _told(parameters: Mapping[str, Quantity], name: str) -> bool:
    """Whether a value says anything: not one of those that are open where the scale of all forces is."""
    return parameters[name].known or scale_known(parameters)


def _length(identification: Identification) -> tuple[float, str]:
    unit = identification.records[0].position_unit
    return (100.0, "cm") if unit == "m" else (1.0, unit)


def interval_table(identification: Identification) -> Table:
    """The joint refit with its intervals, and the noise floor that no model can beat."""
    table = new_table("Joint refit", "", "value", "95 % interval", "unit")
    parameters = identification.refined.parameters
    for name, quantity in parameters.items():
        _row(table, name, quantity if _told(parameters, name) else replace(quantity, value=math.nan))
    table.add_section()
    factor, unit = _length(identification)
    table.add_row("noise floor", numbers.number(identification.noise_floor * factor, 3), "", unit)
    return table


def print_identification(identification: Identification, console: Console) -> None:
    """All tables, the route and what a reader must know, in that order."""
    records = identification.records
    samples = sum(record.samples for record in records)
    console.print(
        f"[bold]{escape(identification.name)}[/bold]: {samples} samples, {sum(r.duration for r in records):.2f} s, "
        f"{identification.missing_samples} missing"
    )
    for make in (features_table, standard_form_table, parameter_table, interval_table):
        table = make(identification)
        if table is not None:
            console.print(table)
    console.print(identification.route, markup=False)
    for sentence in identification.warnings:
        say(console, "warning", "yellow", sentence)
    for sentence in identification.open:
        say(console, "open", "cyan", sentence)


def say(console: Console, lead: str, colour: str, sentence: str) -> None:
    """Print a sentence after a coloured word; brackets in it (``effort[elbow]``) are text, not markup.

    Args:
        console: to print on.
        lead: the coloured word.
        colour: of that word, as rich names it.
        sentence: text after it.
    """
    console.print(f"[{colour}]{lead}:[/{colour}] {escape(sentence)}")
