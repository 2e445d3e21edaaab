"""Diagnoses that several tests ask for, each made once in a process: such tests share an ``xdist_group``."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from functools import cache, partial
from unittest import mock

import numpy as np

from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.diagnosis import pipeline as search
from msd_ident.paper import method
from msd_ident.selection import replication
from msd_ident.selection.experiment import Experiment
from msd_ident.workflow import pipeline


@cache
def paper_study() -> method.Paper:
    """The study of the paper's own numbers, which is always the same."""
    return method.study()


#: Laws of dry friction, and what they could be taken for in a measured step; the rest of the library takes most of the
#: time.
MEASURED = (
    "coulomb_friction", "stribeck_friction", "hysteresis", "position_dependent_friction", "quadratic_drag",
    "cubic_spring", "end_stop", "backlash",
)  # fmt: skip

_made: dict[object, Diagnosis] = {}
_diagnose, _prepare = pipeline.diagnose, search.prepare


def diagnosed(
    records: Sequence[Record],
    *,
    copied: bool = True,
    asked: Sequence[str] = (),
    earlier: Diagnosis | None = None,
) -> Diagnosis:
    """As ``pipeline.diagnose`` finds it.

    Args:
        records: of one plant.
        copied: whether copies are made of a poor experiment.
        asked: the causes that are asked about, where it is not the whole library.
        earlier: what was made of some of the records by this function.
    """
    key = copied, tuple(asked), id(earlier), *map(_content, records)
    if key not in _made:
        with (
            mock.patch.object(replication, "_CHEAP", replication._CHEAP if copied else 0.0),
            mock.patch.object(search, "prepare", partial(_asking, frozenset(asked)) if asked else search.prepare),
        ):
            _made[key] = _diagnose(records, earlier=earlier)
    return _made[key]


def _asking(causes: frozenset[str], task: search.Task) -> Experiment:
    """What a diagnosis prepares, asked about these causes alone."""
    return dataclasses.replace(_prepare(task), asked=causes)


def _content(record: Record) -> object:
    """What a record holds, to compare by."""
    values = (getattr(record, field.name) for field in dataclasses.fields(record))
    return tuple(value.tobytes() if isinstance(value, np.ndarray) else repr(value) for value in values)
