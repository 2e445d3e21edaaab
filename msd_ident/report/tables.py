"""Terminal tables of an identification, after the paper's Tables 1 to 3; 80 columns are enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from msd_ident.quantity import Quantity
from msd_ident.report import numbers

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.identification import Identification, ModelFit

#: Parameter → (words, symbol), design names in the order in which tables list them.
WORDS = {
    "mass": ("mass", "m"),
    "damping": ("viscous damping", "b"),
    "stiffness": ("stiffness", "k"),
    "coulomb_force": ("dry friction", "Fc"),
    "friction_coefficient": ("friction coeff.", "µ"),
    "offset_force": ("constant force", "F0"),
    "natural_frequency": ("natural frequency", "ωn"),
    "damping_ratio": ("damping ratio", "ζ"),
    "static_gain": ("static gain", "K"),
}


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index == 0 else "right", no_wrap=True)
    return table


def _label(name: str) -> str:
    words, symbol = WORDS.get(name, (name.replace("_", " "), ""))
    return f"{words} {symbol}".strip()


def standard_form_table(identification: Identification) -> Table | None:
    """ωn, ζ, K with their intervals (the paper's Table 2); ``None`` where no response tells."""
    if identification.standard_form is None:
        return None
    table = _table("Standard form (Table 2)", "", "value", "95 % interval", "unit")
    for name, quantity in identification.standard_form.quantities.items():
        _row(table, name, quantity)
    return table


def _row(table: Table, name: str, quantity: Quantity) -> None:
    shown = numbers.shown(quantity)
    table.add_row(_label(name), numbers.value(shown), numbers.interval(shown), shown.unit)


def parameter_table(identification: Identification) -> Table:
    """Original model, friction raised, and joint refit side by side (the paper's Table 3)."""
    fits = [("original", identification.original)]
    if identification.paper_refined is not None:
        fits.append(("friction raised", identification.paper_refined))
    fits.append(("joint refit", identification.refined))
    table = _table("Physical parameters (Table 3)", "", *(name for name, _ in fits), "95 % interval", "unit")
    names = list(dict.fromkeys(name for _, found in fits for name in found.parameters))
    for name in names:
        last = identification.refined.parameters.get(name)
        cells = [_cell(found, name, last) for _, found in fits]
        unit = next(found.parameters[name].unit for _, found in fits if name in found.parameters)
        table.add_row(_label(name), *cells, numbers.interval(last) if last else "–", unit)
    _see_row(table, identification, [found for _, found in fits])
    return table


def _cell(found: ModelFit, name: str, digits_like: Quantity | None) -> str:
    quantity = found.parameters.get(name)
    if quantity is None:
        return "–"
    if not quantity.known and digits_like is not None:
        return numbers.value(Quantity(quantity.value, digits_like.std, quantity.unit))
    return numbers.value(quantity)


def _see_row(table: Table, identification: Identification, fits: list[ModelFit]) -> None:
    factor, unit = (100.0, "cm") if identification.records[0].position_unit == "m" else (1.0, _unit(identification))
    table.add_section()
    floor = f"noise floor {numbers.number(identification.noise_floor * factor, 2)}"
    table.add_row("SEE", *(numbers.number(found.see * factor, 3) for found in fits), floor, unit)
    reductions = ["–"]
    if identification.paper_refined is not None:
        reductions.append(f"{identification.paper_see_reduction_percent:.1f}")
    table.add_row("SEE reduction", *reductions, f"{identification.see_reduction_percent:.1f}", "", "%")


def _unit(identification: Identification) -> str:
    return identification.records[0].position_unit


def print_identification(identification: Identification, console: Console) -> None:
    """All tables, the route and what a reader must know, in that order."""
    records = identification.records
    samples = sum(record.samples for record in records)
    console.print(
        f"[bold]{identification.name}[/bold]: {samples} samples, {sum(r.duration for r in records):.2f} s, "
        f"{identification.missing_samples} missing"
    )
    for table in (features_table(identification), standard_form_table(identification), parameter_table(identification)):
        if table is not None:
            console.print(table)
    console.print(identification.route)
    for sentence in identification.warnings:
        console.print(f"[yellow]warning:[/yellow] {sentence}")
    for sentence in identification.open:
        console.print(f"[cyan]open:[/cyan] {sentence}")
