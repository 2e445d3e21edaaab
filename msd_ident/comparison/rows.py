"""From rows of a table to records that can be compared."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from msd_ident.batching import reading
from msd_ident.batching.row import Table
from msd_ident.comparison.estimates import Measured
from msd_ident.errors import DataError, MsdError, UsageError

#: Columns that records can be compared by.
BY = ("robot", "joint", "day")
#: Records of a group that are read, at most: evenly taken of all.
MOST = 100
#: A cause is named from this probability on.
_NAMED = 0.5


def check(by: str) -> None:
    """Refuse a column that nothing can be compared by.

    Raises:
        UsageError: there is no such one.
    """
    if by not in BY:
        raise UsageError(f"no column {by} to compare by; expected one of {', '.join(BY)}")


def measured(table: Table, by: str) -> tuple[tuple[Measured, ...], tuple[str, ...]]:
    """Records of a table with their groups, and sentences on those that are left out.

    Raises:
        UsageError: no such column, nothing in it, or records in several units.
        DataError: no record has a result, or none can be read any more.
    """
    check(by)
    rows = reading.diagnosed(table)
    named = [row for row in rows if row[by]]
    if not named:
        raise UsageError(f"the column {by} is empty in all rows; expected what to compare by: fill it with --label")
    units = sorted({(row["force_unit"], row["position_unit"]) for row in named})
    if len(units) > 1:
        listed = " and ".join(", ".join(pair) for pair in units)
        raise UsageError(f"records in {listed}; expected one pair of units: compare them apart")
    remarks = [f"{len(rows) - len(named)} records have no {by} and are left out."] if len(named) < len(rows) else []
    chosen = _chosen(named, by)
    if len(chosen) < len(named):
        remarks.append(f"{len(chosen)} of {len(named)} records are compared: {MOST} of each {by} are enough.")
    return _read(chosen, by, remarks)


def _chosen(rows: Sequence[Mapping[str, Any]], by: str) -> list[Mapping[str, Any]]:
    groups = defaultdict(list)
    for row in rows:
        groups[row[by]].append(row)
    found = []
    for of in groups.values():
        places = np.unique(np.linspace(0, len(of) - 1, min(len(of), MOST)).astype(int))
        found += [of[place] for place in places]
    return found


def _read(
    rows: Sequence[Mapping[str, Any]], by: str, remarks: list[str]
) -> tuple[tuple[Measured, ...], tuple[str, ...]]:
    found, errors = [], []
    for row in rows:
        values, stds = reading.parameters(row)
        try:
            record = reading.record_of(dict(row))
        except MsdError as error:
            errors.append(str(error))
            continue
        found.append(
            Measured(
                name=row["name"],
                group=row[by],
                record=record,
                causes=tuple(cause["name"] for cause in row["causes"] or () if cause["probability"] > _NAMED),
                parameters=values,
                fixed=tuple(name for name, std in stds.items() if std == 0.0),
                covariates=reading.covariates(row),
            )
        )
    if not found:
        raise DataError(f"no record of the table can be read any more ({errors[0]}); expected them where they were")
    if errors:
        remarks.append(f"{len(errors)} records can no longer be read and are left out ({errors[0]}).")
    return tuple(found), tuple(remarks)
