"""A summary for a lab notebook: the verdict, the numbers, the causes, the parameters, the data, in Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.data.datasheet import data_sheet
from msd_ident.diagnosis import Cause, Diagnosis
from msd_ident.report import words
from msd_ident.report.calibration import matrix
from msd_ident.report.numbers import length_scale, number, with_band
from msd_ident.report.sections.parameters import Column, diagnosis_columns, identification_columns
from msd_ident.report.writing import write_text

if TYPE_CHECKING:
    from msd_ident.data.provenance import Provenance
    from msd_ident.data.record import Record
    from msd_ident.selection.calibration import Calibration
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
    parts = []
    for found, origin in zip_longest(results, provenance):
        lines = _diagnosis(found) if isinstance(found, Diagnosis) else _identification(found)
        parts.append("\n".join((*lines, *_data(found.records), *_origin(origin))))
    return "\n\n---\n\n".join(parts) + "\n"


def plain(text: str) -> str:
    """Text from outside as it stands: nothing in it is markup."""
    return text.replace("\n", " ").translate(_SPECIAL)


def _diagnosis(found: Diagnosis) -> Iterator[str]:
    yield f"# {plain(' + '.join(record.name for record in found.records))}: {found.verdict}"
    yield ""
    yield f"**{words.headline(found)}**"
    yield ""
    yield plain(found.summary)
    yield ""
    scale = length_scale(max(found.noise_floor, 1e-3 * found.base.see), found.records[0].position_unit)
    rows = [
        ("SEE of the base model", f"{number(scale.factor * found.base.see, 3)} {scale.unit}"),
        ("SEE of the extended model", f"{number(scale.factor * found.extended.see, 3)} {scale.unit}"),
        ("noise floor", f"{number(scale.factor * found.noise_floor, 3)} {scale.unit}"),
    ]
    motion, force = words.remainder(found)
    rows += [("unexplained motion", motion), ("missing force", force)]
    if gain := words.gain(found):
        rows.append(("better on unseen data", gain))
    yield from _table(("", ""), rows)
    if found.causes:
        yield from ("", "## Causes", "")
        yield from _table(("cause", "probability", "parameters", "tied with"), [_cause(c) for c in found.causes])
    if found.calibration is not None:
        yield from _calibration(found.calibration)
    yield from _parameters(diagnosis_columns(found))
    yield from _sentences("Notes", found.warnings)
    if found.next_experiment is not None:
        yield from ("", "## Next experiment", "", plain(str(found.next_experiment.get("sentence", ""))))


def _calibration(found: Calibration) -> Iterator[str]:
    """How copies of the record were diagnosed, and what follows for the probabilities."""
    table = matrix(found)
    yield from ("", "## Copies of this record", "")
    rows = [(line.name, *(cell.text for cell in line.cells), str(line.copies)) for line in table.lines]
    yield from _table(("simulated", *(f"diagnosed as {head}" for head in table.heads), "copies"), rows)
    yield ""
    yield from (f"- {plain(sentence)}" for sentence in table.sentences)


def _cause(cause: Cause) -> tuple[str, ...]:
    values = (f"{words.parameter(name)[1]} = {with_band(q)} {q.unit}" for name, q in cause.parameters.items())
    tied = ", ".join(words.effect(name) for name in cause.tied_with) or "–"
    return words.effect(cause.name), words.probability(cause.probability), "; ".join(values), tied


def _identification(found: Identification) -> Iterator[str]:
    yield f"# {plain(found.name)}: identified"
    yield ""
    yield plain(found.route)
    yield from _parameters(identification_columns(found))
    scale = length_scale(found.original.see, found.records[0].position_unit)
    yield ""
    yield plain(f"Noise floor {number(scale.factor * found.noise_floor, 3)} {scale.unit}.")
    yield from _sentences("Notes", found.warnings)
    yield from _sentences("Open", found.open)


def _parameters(columns: Sequence[Column]) -> Iterator[str]:
    yield from ("", "## Parameters", "", "± half of the 95 % interval.", "")
    names = dict.fromkeys(name for column in columns for name in column.quantities)
    rows = []
    for name in names:
        known = [column.quantities.get(name) for column in columns]
        unit = next(quantity.unit for quantity in known if quantity is not None)
        cells = [with_band(quantity) if quantity is not None else "–" for quantity in known]
        rows.append((" ".join(words.parameter(name)).strip(), *cells, "" if unit == "1" else unit))
    yield from _table(("", *(column.label for column in columns), "unit"), rows)


def _sentences(title: str, sentences: Sequence[str]) -> Iterator[str]:
    if sentences:
        yield from ("", f"## {title}", "")
        yield from (f"- {plain(sentence)}" for sentence in sentences)


def _data(records: Sequence[Record]) -> Iterator[str]:
    yield from ("", "## Data", "")
    rows = []
    for record in records:
        sheet = data_sheet(record)
        size = f"{sheet.samples} in {number(sheet.duration_s)} s"
        rate = f"{number(sheet.rate_hz)} Hz"
        step = length_scale(sheet.encoder_step, sheet.position_unit)
        resolution = f"{number(step.factor * sheet.encoder_step, 3)} {step.unit}" if sheet.encoder_step else "not seen"
        rows.append((sheet.name, size, rate, str(sheet.missing_samples), resolution))
    yield from _table(("record", "samples", "rate", "missing", "encoder step"), rows)


def _origin(provenance: Provenance | None) -> Iterator[str]:
    if provenance is None:
        return
    yield ""
    for origin in provenance.origins:
        signals = f"position {_code(origin.position)}, force {_code(origin.force)}"
        yield f"- {_code(origin.path)} ({origin.kind}, {origin.size} bytes, sha256 {_code(origin.sha256)}): {signals}"
    versions = ", ".join(f"{name} {version}" for name, version in provenance.versions.items())
    yield f"- {versions}; {provenance.drawn}; {provenance.made}"
    yield f"- command: {_code(provenance.command)}"


def _code(text: str) -> str:
    """A code span; a backtick within would end it."""
    return f"`{text}`" if "`" not in text else plain(text)


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    yield f"| {' | '.join(heads)} |"
    yield f"|{'|'.join(['---'] * len(heads))}|"
    for row in rows:
        yield f"| {' | '.join(plain(cell) for cell in row)} |"
