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

    Raises:
        DataError: no record has a result.
    """
    found = defaultdict(list)
    for row in reading.diagnosed(table):
        found[" ".join(filter(None, (row["robot"], row["joint"])))].append(_sample(row))
    return dict(sorted(found.items()))


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
