"""Diagnoses that several tests ask for, each made once in a process: such tests share an ``xdist_group``."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import cache
from unittest import mock

import numpy as np

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.paper import method
from msd_ident.selection import replication
from msd_ident.workflow import pipeline


@cache
def paper_study() -> method.Paper:
    """The study of the paper's own numbers, which is always the same."""
    return method.study()


_made: dict[object, Diagnosis] = {}
_diagnose = pipeline.diagnose


def diagnosed(records: Sequence[Record], *, copied: bool = True) -> Diagnosis:
    """As ``pipeline.diagnose`` finds it; unless ``copied``, without the copies of a poor experiment."""
    key = copied, *map(_content, records)
    if key not in _made:
        with mock.patch.object(replication, "_CHEAP", replication._CHEAP if copied else 0.0):
            _made[key] = _diagnose(records)
    return _made[key]


def _content(record: Record) -> object:
    """What a record holds, to compare by."""
    values = (getattr(record, field.name) for field in dataclasses.fields(record))
    return tuple(value.tobytes() if isinstance(value, np.ndarray) else repr(value) for value in values)
