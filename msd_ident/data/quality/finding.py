"""What a finding is, and the names that all checks share."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Literal

from msd_ident.data.motion import Motion
from msd_ident.data.record import Record

Severity = Literal["info", "warning", "error"]


@dataclass(frozen=True)
class Finding:
    """One thing about the data that the user should know.

    Attributes:
        severity: ``info`` (good to know), ``warning`` (the result may suffer), ``error`` (no result makes sense).
        code: short name that stays the same, for programs and tests.
        sentence: the thing in words, with its numbers and the next step.
    """

    severity: Severity
    code: str
    sentence: str


#: Findings of each severity.
info, warning, error = partial(Finding, "info"), partial(Finding, "warning"), partial(Finding, "error")

#: A check of a record whose motion was looked at.
Check = Callable[[Record, Motion], Iterator[Finding]]
