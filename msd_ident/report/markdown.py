"""A summary for a lab notebook: the verdict, the numbers, the causes, the parameters, the data, in Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.data.datasheet import data_sheet
from msd_ident.diagnosis import Diagnosis
from msd_ident.diagnosis.verdict import one_acts
from msd_ident.quantity import probability
from msd_ident.report import words
from msd_ident.report.calibration import Matrix, matrix
from msd_ident.report.numbers import length_scale, number, with_band
from msd_ident.report.sections.parameters import Column, diagnosis_columns, identification_columns
from msd_ident.writing import write_text

if TYPE_CHECKING:
    from jinja2 import Environment

    from msd_ident.data.provenance import Provenance
    from msd_ident.data.record import Record
    from msd_ident.workflow.identification import Identification

_SPECIAL = str.maketrans({sign: f"\\{sign}" for sign in "\\`*_[]<>|#"})


def save(
    results: Sequence[Diagnosis | Identification], path: Path, provenance: Sequence[Provenance | None] = ()
) -> None:
    """Write one Markdown file about all results.

    Args:
        results: one chapter each.
        path: file to write.
        provenance: of each result: files, versions and command.

    Raises:
        SetupError: the disk does not take it.
    """
    write_text(render(results, provenance), path)


def render(results: Sequence[Diagnosis | Identification], provenance: Sequence[Provenance | None] = ()) -> str:
    """The summary as text."""
    template = _environment().get_template("summary.md.j2")
    parts = [
        template.render(found=found, is_diagnosis=isinstance(found, Diagnosis), origin=origin)
        for found, origin in zip_longest(results, provenance)
    ]
    return "\n\n---\n\n".join(parts) + "\n"


@cache
def _environment() -> Environment:
    """The template, with what makes its rows."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(loader=PackageLoader("msd_ident.report", "templates"), undefined=StrictUndefined)
    made.filters |= {"plain": plain, "code": _code, "diagnosed_as": lambda head: f"diagnosed as {head}"}
    made.globals |= {
        "words": words, "matrix": matrix, "error_rows": _error_rows, "cause_rows": _cause_rows,
        "copies_rows": _copies_rows, "parameter_rows": _parameter_rows, "data_rows": _data_rows,
        "noise_floor": _noise_floor, "diagnosis_columns": diagnosis_columns,
        "identification_columns": identification_columns,
    }  # fmt: skip
    return made


def plain(text: str) -> str:
    """Text from outside as it stands: nothing in it is markup."""
    return text.replace("\n", " ").translate(_SPECIAL)


def _code(text: str) -> str:
    """A code span; a backtick within would end it."""
    return f"`{text}`" if "`" not in text else plain(text)


def _error_rows(found: Diagnosis) -> list[tuple[str, str]]:
    scale = length_scale(max(found.noise_floor, 1e-3 * found.base.see), found.records[0].position_unit)
    sizes = (
        ("SEE of the base model", found.base.see),
        ("SEE of the extended model", found.extended.see),
        ("noise floor", found.noise_floor),
    )
    rows = [(label, f"{number(scale.factor * size, 3)} {scale.unit}") for label, size in sizes]
    motion, force = words.remainder(found)
    rows += [("unexplained motion", motion), ("missing force", force)]
    return [*rows, ("better on unseen data", gain)] if (gain := words.gain(found)) else rows


def _cause_rows(found: Diagnosis) -> Iterator[tuple[str, ...]]:
    for cause in found.causes:
        values = (f"{words.parameter(name)[1]} = {with_band(q)} {q.unit}" for name, q in cause.parameters.items())
        tied = ", ".join(words.effect(name) for name in cause.tied_with)
        tied = f"{tied} ({one_acts(cause)})" if tied else "–"
        yield words.effect(cause.name), probability(cause.probability), "; ".join(values), tied


def _copies_rows(table: Matrix) -> Iterator[tuple[str, ...]]:
    for line in table.lines:
        yield line.name, *(cell.text for cell in line.cells), str(line.copies)


def _noise_floor(found: Identification) -> str:
    scale = length_scale(found.original.see, found.records[0].position_unit)
    return f"Noise floor {number(scale.factor * found.noise_floor, 3)} {scale.unit}."


def _parameter_rows(columns: Sequence[Column]) -> Iterator[tuple[str, ...]]:
    for name in dict.fromkeys(name for column in columns for name in column.shown):
        known = [column.shown.get(name) for column in columns]
        unit = next(quantity.unit for _, quantity in filter(None, known))
        cells = [with_band(one[1]) if one is not None else "–" for one in known]
        yield " ".join(words.parameter(name)).strip(), *cells, "" if unit == "1" else unit


def _data_rows(records: Sequence[Record]) -> Iterator[tuple[str, ...]]:
    for record in records:
        sheet = data_sheet(record)
        size, rate = f"{sheet.samples} in {number(sheet.duration_s)} s", f"{number(sheet.rate_hz)} Hz"
        step = length_scale(sheet.encoder_step, sheet.position_unit)
        resolution = f"{number(step.factor * sheet.encoder_step, 3)} {step.unit}" if sheet.encoder_step else "not seen"
        yield sheet.name, size, rate, str(sheet.missing_samples), resolution
