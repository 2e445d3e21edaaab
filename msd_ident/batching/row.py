"""One row for each record: what the record is, what was found, or why nothing was.

What a row holds is a column of the table only if ``table.schema`` has it too.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from datetime import datetime, timezone
from pathlib import PurePosixPath
from typing import Any

import numpy as np

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.model.effects import LIBRARY
from msd_ident.quantity import Quantity

SCHEMA = "msd.batch/1"
#: Row as plain values, by column.
Row = dict[str, Any]
#: Rows as ``table`` reads and writes them: a ``pyarrow.Table``, which has no types.
Table = Any

#: Parameters of the plant; those of the library follow.
PLANT = ("mass", "damping", "stiffness")
PARAMETERS = (*PLANT, *dict.fromkeys(p.name for effect in LIBRARY for p in effect.parameters))
CAUSES = tuple(effect.name for effect in LIBRARY)

_DAY = re.compile(r"(?<!\d)(20\d\d)[-_]?(0[1-9]|1[0-2])[-_]?(0[1-9]|[12]\d|3[01])(?!\d)")


def identity(path: str, labels: Mapping[str, str]) -> Row:
    """Columns that follow from the path of a record: its name, the robot (else its folder) and the day in its name.

    Args:
        path: of the record.
        labels: column → regular expression whose first group in the path fills it; None where it does not match.
    """
    place = PurePosixPath(path)
    day = _DAY.search(place.name) or _DAY.search(path)
    row: Row = {
        "path": path,
        "name": place.name,
        "joint": "",
        "robot": place.parent.name,
        "day": "-".join(day.groups()) if day else None,
    }
    for column, text in labels.items():
        found = re.search(text, path)
        row[column] = found.group(1) if found else None
    return row


def of_record(record: Record) -> Row:
    """What a record is, before any model."""
    when = datetime.fromtimestamp(record.start_ns / 1e9, timezone.utc) if record.start_ns else None
    row: Row = {
        "samples": record.samples,
        "duration_s": record.duration,
        "rate_hz": 1.0 / record.period,
        "force_unit": record.force_unit,
        "position_unit": record.position_unit,
        "peak_force": float(np.max(np.abs(record.force_at(record.time)))),
        "amplitude": 0.5 * float(np.ptp(record.position)),
    }
    if when is not None:
        row |= {"start": when, "day": when.date().isoformat()}
    return row


def of_diagnosis(found: Diagnosis) -> Row:
    """Columns of a diagnosis: one for every parameter and cause of the library."""
    row: Row = {
        "verdict": found.verdict,
        "summary": found.summary,
        "causes": [
            {"name": cause.name, "probability": cause.probability, "tied_with": list(cause.tied_with)}
            for cause in found.causes
        ],
        "see": found.extended.see,
        "base_see": found.base.see,
        "noise_floor": found.noise_floor,
        "left_percent": found.left.extended.motion_percent,
        "missing_force_rms": found.left.extended.force,
        "heldout_gain_percent": found.heldout.reduction_percent,
        "free": list(found.extended.free),
        "covariance": found.extended.covariance.ravel().tolist(),
        "findings": [vars(finding) for finding in found.findings],
        "warnings": list(found.warnings),
    }
    row |= {f"p_{one.name}": one.probability for one in found.tried}
    row |= _quantities(found.extended.quantities, "")
    row |= _quantities({name: found.base.quantities[name] for name in PLANT}, "base_")
    return finite(row)


def _quantities(quantities: Mapping[str, Quantity], prefix: str) -> Row:
    row: Row = {}
    for name, quantity in quantities.items():
        if name in PARAMETERS:
            row |= {f"{prefix}{name}": quantity.value, f"{prefix}{name}_std": quantity.std}
    return row


def finite(row: Mapping[str, Any]) -> Row:
    """A row with null in place of values that are not finite."""
    return {
        column: None if isinstance(value, float) and not math.isfinite(value) else value
        for column, value in row.items()
    }
