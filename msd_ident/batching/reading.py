"""Records, parameters and covariates from the rows of a table."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from msd_ident.batching import locations
from msd_ident.batching.row import CAUSES, PARAMETERS, Row, Table
from msd_ident.data.record import Record
from msd_ident.errors import DataError
from msd_ident.io import Joint, SourceOptions, joints, read_all, source_of


def diagnosed(table: Table) -> list[Row]:
    """The rows that have a result.

    Raises:
        DataError: there is none.
    """
    rows = table.to_pylist()
    found = [row for row in rows if row["verdict"]]
    if not found:
        errors = [row["error"] for row in rows if row["error"]]
        first = f" ({errors[0]})" if errors else ""
        others = f"; {len(errors) - 1} others have errors too" if len(errors) > 1 else ""
        raise DataError(f"no record of the table has a result{first}; expected diagnoses{others}")
    return found


def record_of(row: Row) -> Record:
    """The record of a row, read as it was read for the row.

    Raises:
        DataError, SetupError: it is no longer there.
    """
    options = json.loads(row["options"] or "{}")
    source = SourceOptions(**options.get("source", {}))
    with locations.local(row["path"]) as copy:
        if options.get("all_joints"):
            return read_all(copy, source_of(source, _joint(joints(copy), row["joint"], row["path"])))[0]
        records = read_all(copy, source)
    run = row["joint"].removeprefix("run ")
    return records[int(run) - 1 if run.isdecimal() else 0]


def _joint(found: tuple[Joint, ...], name: str, path: str) -> Joint:
    for joint in found:
        if joint.name == name:
            return joint
    raise DataError(f"{path} has no joint {name} any more; expected the record that the table was made of")


def parameters(row: Mapping[str, Any]) -> tuple[dict[str, float], dict[str, float]]:
    """Parameters of a row's model and their standard deviations; those that the data left open have none."""
    values = {name: float(row[name]) for name in PARAMETERS if row[name] is not None}
    return values, {name: float(row[f"{name}_std"]) for name in values if row[f"{name}_std"] is not None}


def causes(row: Mapping[str, Any]) -> dict[str, float]:
    """Probability of each cause of the library; 0 where a row's model needed none."""
    return {name: float(row[f"p_{name}"] or 0.0) for name in CAUSES}


def covariates(row: Mapping[str, Any]) -> dict[str, float]:
    """What else was measured. The amplitude is that of the force, which an experiment sets, else of the motion."""
    found = {name: float(row[name]) for name in ("temperature", "load") if row[name] is not None}
    size = row["peak_force"] or row["amplitude"]
    return {**found, "amplitude": float(size) if size else math.nan}
