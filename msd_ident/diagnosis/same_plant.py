"""Check whether several records are of one rig, if no explanation fits all of them."""

from __future__ import annotations

from collections.abc import Sequence

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.errors import DataError
from msd_ident.estimate.levels import ALIKE
from msd_ident.features import extract


def warning(records: Sequence[Record]) -> str:
    """A sentence where natural frequencies are far apart, else an empty one, as for a single record."""
    found = []
    for record in records if len(records) > 1 else ():
        form = extract(record).standard_form
        if form is not None and form.natural_frequency.known:
            found.append((form.natural_frequency.value, record.name))
    if len(found) < 2:
        return ""
    low, high = min(found), max(found)
    if high[0] <= ALIKE * low[0]:
        return ""
    return (
        f"{high[1]} swings at {high[0]:.3g} rad/s, {low[1]} at {low[0]:.3g}, and no explanation fits both; expected "
        "records of one rig: leave the other one out"
    )


def check(diagnosis: Diagnosis) -> None:
    """Refuse to go on from a diagnosis of records that cannot be of one rig.

    Raises:
        DataError: their natural frequencies are far apart, and nothing explains it.
    """
    if diagnosis.left.exceeds and (said := warning(diagnosis.records)):
        raise DataError(said)
