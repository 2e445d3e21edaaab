"""From rows of a table to the samples of each robot."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping
from datetime import datetime, timezone
from typing import Any

from msd_ident.batching import reading
from msd_ident.batching.row import Table
from msd_ident.monitoring.watching import Sample


def by_robot(table: Table) -> dict[str, list[Sample]]:
    """The samples of each robot, or of each of its joints.

    Of several pairs of units, and of free decays beside records whose mass is known, each is a series of its own, with
    a name that says so: their numbers are no changes of each other.

    Raises:
        DataError: no record has a result.
    """
    found: dict[str, dict[str, list[Sample]]] = defaultdict(lambda: defaultdict(list))
    for row in reading.diagnosed(table):
        found[" ".join(filter(None, (row["robot"], row["joint"])))][_kind(row)].append(_sample(row))
    return {
        name if len(kinds) == 1 else f"{name} ({kind})".strip(): kinds[kind]
        for name, kinds in sorted(found.items())
        for kind in sorted(kinds)
    }


def _kind(row: Mapping[str, Any]) -> str:
    """What the numbers of a record are in."""
    if row["mass"] == 1.0 and row["mass_std"] == 0.0:  # assumed: there is no force that tells it
        return f"free decays in {row['position_unit']}"
    return f"{row['force_unit']}, {row['position_unit']}"


def _sample(row: Mapping[str, Any]) -> Sample:
    values, stds = reading.parameters(row)
    return Sample(_time(row), row["name"], values, stds, reading.causes(row), reading.covariates(row))


def _time(row: Mapping[str, Any]) -> float:
    """When a record was made [s since 1970]: its first stamp, else the day in its name; NaN where neither is known."""
    if row["start"] is not None:
        return float(row["start"].timestamp())
    try:
        return datetime.fromisoformat(row["day"] or "").replace(tzinfo=timezone.utc).timestamp()
    except ValueError:
        return math.nan
