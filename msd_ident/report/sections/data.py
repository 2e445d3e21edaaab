"""How the data was measured, and how to get this result again."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from msd_ident.datasheet import DataSheet, data_sheet
from msd_ident.report.numbers import length_scale, number, with_band
from msd_ident.report.sections.section import Section

if TYPE_CHECKING:
    from msd_ident.provenance import Provenance
    from msd_ident.quality import Finding
    from msd_ident.quantity import Quantity
    from msd_ident.record import Record


class Data(Section):
    """One column a record; files, versions, command."""

    slug = "data"
    title = "The data"

    def __init__(
        self,
        records: Sequence[Record],
        findings: Sequence[Finding],
        provenance: Provenance | None,
        clock_offset: Quantity | None,
    ) -> None:
        self._records, self._findings = records, findings
        self._provenance, self._offset = provenance, clock_offset

    def context(self) -> Mapping[str, Any]:
        """Rows over records, findings, provenance."""
        sheets = [data_sheet(record) for record in self._records]
        told = [_column(sheet) for sheet in sheets]
        rows = [(label, [column[label] for column in told]) for label in told[0]]
        offset = (
            f"{with_band(self._offset)} {self._offset.unit}"
            if self._offset is not None
            else "none that the data asks for"
        )
        return {
            "names": [sheet.name for sheet in sheets],
            "rows": rows,
            "offset": offset,
            "notes": [note for record in self._records for note in record.notes],
            "findings": self._findings,
            "provenance": self._provenance,
        }


def _column(sheet: DataSheet) -> dict[str, str]:
    step = length_scale(sheet.encoder_step, sheet.position_unit)
    floor = length_scale(sheet.noise_floor, sheet.position_unit)
    return {
        "duration": f"{number(sheet.duration_s)} s",
        "rate": f"{number(sheet.rate_hz)} Hz",
        "samples of position": str(sheet.samples),
        "samples of force": str(sheet.force_samples),
        "missing samples": f"{sheet.missing_samples} in {sheet.gaps} gaps" if sheet.gaps else "none",
        "longest interval": _time(sheet.longest_gap_s),
        "jitter of the stamps": _time(sheet.jitter_s),
        "encoder step": f"{number(step.factor * sheet.encoder_step, 3)} {step.unit}"
        if sheet.encoder_step
        else "not seen",
        "noise": f"{number(floor.factor * sheet.noise_floor, 3)} {floor.unit}",
        "force step to first motion": _time(sheet.step_delay_s) if math.isfinite(sheet.step_delay_s) else "not seen",
    }


def _time(seconds: float) -> str:
    if abs(seconds) < 1e-8:
        return "none"
    factor, unit = (1e6, "µs") if abs(seconds) < 1e-3 else (1e3, "ms") if abs(seconds) < 1.0 else (1.0, "s")
    return f"{number(factor * seconds, 3)} {unit}"
