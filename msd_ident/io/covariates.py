"""Covariates of a record, such as temperature or load: their means."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from msd_ident.errors import DataError
from msd_ident.io.bag import Bag, is_bag, open_bag
from msd_ident.io.columns import open_columns
from msd_ident.io.message_fields import parse_field
from msd_ident.io.signal_choice import POSITION_FIELDS

#: Covariates that are looked for where nobody says where they are, and words in the names of their columns and topics.
KNOWN = {"temperature": ("temperature", "temp"), "load": ("load", "payload")}
#: Fields of messages that are one number.
_FIELDS = {**POSITION_FIELDS, "sensor_msgs/msg/Temperature": "temperature"}


def covariates(path: str | os.PathLike[str], wanted: Mapping[str, str]) -> dict[str, float]:
    """Mean of each covariate over a record; NaN where the record does not have it.

    Args:
        path: bag or table.
        wanted: name → ``TOPIC:FIELD``, a topic or a column; empty: the first that is called like it.

    Raises:
        DataError: the record cannot be read, or lacks one whose place was named.
    """
    return _of_bag(open_bag(path), wanted) if is_bag(path) else _of_table(Path(path), wanted)


def _of_table(path: Path, wanted: Mapping[str, str]) -> dict[str, float]:
    table = open_columns(path)
    found = {}
    for name, where in wanted.items():
        place = _place(table.header, name, where)
        if place is None and where:
            raise DataError(f"{path.name} has no column {where} for {name}; its columns are: {', '.join(table.header)}")
        found[name] = math.nan if place is None else _mean(table.columns([place])[0].tolist())
    return found


def _place(header: Sequence[str], name: str, where: str) -> int | None:
    if where:
        return header.index(where) if where in header else None
    return next((place for place, heading in enumerate(header) if _called(heading, name)), None)


def _called(heading: str, name: str) -> bool:
    words = heading.lower().replace("/", " ").replace("_", " ").replace("(", " ").replace("[", " ").split()
    return any(word in KNOWN.get(name, (name,)) for word in words)


def _of_bag(bag: Bag, wanted: Mapping[str, str]) -> dict[str, float]:
    return {name: _topic_mean(bag, name, where) for name, where in wanted.items()}


def _topic_mean(bag: Bag, name: str, where: str) -> float:
    from msd_ident.io.decode import Decoder  # imported here: a table needs no library for bags

    topic, _, field = where.partition(":")
    if not where:
        topic = next((one for one, made in bag.topics.items() if _called(one, name) and made.type in _FIELDS), "")
    if topic not in bag.topics:
        if where:
            raise DataError(f"{bag.path} has no topic {topic} for {name}; its topics are: {', '.join(bag.topics)}")
        return math.nan
    kind = bag.topics[topic].type
    reader, decoder = parse_field(field or _FIELDS.get(kind, "data")), Decoder(bag.topics[topic])
    decoded = (decoder.decode(raw.data) for raw in bag.messages([topic]))
    return _mean([value for one in decoded if one is not None and (value := reader.value(one)) is not None])


def _mean(values: Sequence[float]) -> float:
    finite = np.asarray(values, dtype=np.float64)
    finite = finite[np.isfinite(finite)]
    return float(finite.mean()) if finite.size else math.nan
