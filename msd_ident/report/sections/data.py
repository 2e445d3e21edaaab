"""How the data was measured, and how to get this result again."""

from __future__ import annotations

import math
from collections.abc import Sequence

from msd_ident.data.datasheet import DataSheet, data_sheet
from msd_ident.data.provenance import Provenance
from msd_ident.data.quality import Finding
from msd_ident.data.record import Record
from msd_ident.quantity import Quantity
from msd_ident.report.marked import Marked, length
from msd_ident.report.numbers import length_scale, number, with_band
from msd_ident.report.sections.section import Section


def data(
    records: Sequence[Record],
    findings: Sequence[Finding],
    provenance: Provenance | None,
    clock_offset: Quantity | None = None,
) -> Section:
    """One column a record; findings; files, versions, command."""
    sheets = [data_sheet(record) for record in records]
    columns = [_column(sheet, index) for index, sheet in enumerate(sheets)]
    context = {
        "names": [sheet.name for sheet in sheets],
        "rows": [(label, [column[label] for column in columns]) for label in columns[0]],
        "offset": f"{with_band(clock_offset)} {clock_offset.unit}" if clock_offset else "none that the data requires",
        "notes": [note for record in records for note in record.notes],
        "findings": findings,
        "provenance": provenance,
    }
    return Section("data", "The data", context)


def _column(sheet: DataSheet, index: int) -> dict[str, Marked | str]:
    """Label → cell."""

    def mark(name: str, text: str) -> Marked:
        return Marked(f"data.{index}.{name}", getattr(sheet, name), text)

    step, floor = (length_scale(size, sheet.position_unit) for size in (sheet.encoder_step, sheet.noise_floor))
    return {
        "duration": mark("duration_s", f"{number(sheet.duration_s)} s"),
        "rate": mark("rate_hz", f"{number(sheet.rate_hz)} Hz"),
        "samples of position": mark("samples", str(sheet.samples)),
        "samples of force": mark("force_samples", str(sheet.force_samples)),
        "missing samples": mark("missing_samples", str(sheet.missing_samples)),
        "gaps": mark("gaps", str(sheet.gaps)),
        "longest interval": mark("longest_gap_s", _time(sheet.longest_gap_s)),
        "jitter of the stamps": mark("jitter_s", _time(sheet.jitter_s)),
        "encoder step": length(f"data.{index}.encoder_step", sheet.encoder_step, step)
        if sheet.encoder_step
        else "not seen",
        "noise": length(f"data.{index}.noise_floor", sheet.noise_floor, floor),
        "force step to first motion": mark("step_delay_s", _time(sheet.step_delay_s))
        if math.isfinite(sheet.step_delay_s)
        else "not seen",
    }


def _time(seconds: float) -> str:
    if abs(seconds) < 1e-8:
        return "0 s"
    factor, unit = (1e6, "µs") if abs(seconds) < 1e-3 else (1e3, "ms") if abs(seconds) < 1.0 else (1.0, "s")
    return f"{number(factor * seconds, 3)} {unit}"
