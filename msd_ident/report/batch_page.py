"""The page of many records: a table with sorting and filters in the browser, and small plots per robot."""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from msd_ident.batching.row import CAUSES, PARAMETERS, Table
from msd_ident.data.provenance import versions
from msd_ident.model.effects import spoken
from msd_ident.report.page import environment, shipped
from msd_ident.writing import write_text

#: Digits of a number on the page; the table has all.
_DIGITS = 6
#: Columns of the table that the page shows too, in this order: words first, then numbers.
_TEXTS = ("name", "robot", "joint", "day", "verdict", "error", "summary", "path", "sha256", "code", "page")
_NUMBERS = (
    *("left_percent", "see", "noise_floor", "temperature", "load", "amplitude", "peak_force", "samples", "duration_s"),
    *("rate_hz", "seconds"),
)


def save(table: Table, path: Path, source: str) -> None:
    """Write the page of a table.

    Args:
        table: of rows.
        path: of the page; links to records' pages are relative to it.
        source: where the table stands, for the page's head.

    Raises:
        SetupError: the disk does not take it.
    """
    write_text(render(table, source, path.absolute().parent), path)


def render(table: Table, source: str, folder: Path) -> str:
    """The page as text."""
    from markupsafe import Markup

    columns = _columns(table, folder)
    counts = Counter(verdict or "error" for verdict in table.column("verdict").to_pylist())
    data = json.dumps({"rows": table.num_rows, "columns": columns}, ensure_ascii=False, separators=(",", ":"))
    return environment().get_template("batch.html.j2").render(
        title=f"{table.num_rows} records – msd batch",
        source=source,
        rows=table.num_rows,
        counts=[(verdict, verdict.replace("_", " "), count) for verdict, count in counts.most_common()],
        parameters=[one["name"] for one in columns if one["name"] in PARAMETERS],
        version=versions()["msd_ident"],
        css=Markup(shipped("templates", "page.css") + shipped("templates", "batch.css")),
        script=Markup(shipped("templates", "batch.js")),
        data=Markup(data.replace("<", "\\u003c")),
    )  # fmt: skip


def _columns(table: Table, folder: Path) -> list[dict[str, Any]]:
    """Columns that hold anything, the ones that people look at first."""
    read = {name: table.column(name).to_pylist() for name in (*_TEXTS, *_NUMBERS)}
    read["page"] = [os.path.relpath(page, folder) if page else None for page in read["page"]]
    columns = [_text(name, read[name]) for name in ("name", "robot", "joint", "day", "verdict", "error")]
    columns.append(_text("causes", [_causes(found) for found in table.column("causes").to_pylist()]))
    for name in PARAMETERS:
        columns += _quantity(name, table)
    columns += [_number(name, read[name]) for name in _NUMBERS]
    columns += [_number(f"p_{name}", table.column(f"p_{name}").to_pylist()) for name in CAUSES]
    columns.append(_text("findings", [_sentences(found) for found in table.column("findings").to_pylist()]))
    columns.append(
        _text("warnings", ["\n".join(found or ()) or None for found in table.column("warnings").to_pylist()])
    )
    columns.append(_number("start", [_epoch(when) for when in table.column("start").to_pylist()]))
    columns += [_text(name, read[name]) for name in ("summary", "path", "sha256", "code", "page")]
    return [one for one in columns if one is not None]


def _quantity(name: str, table: Table) -> list[dict[str, Any] | None]:
    value = _number(name, table.column(name).to_pylist())
    return [value, _number(f"{name}_std", table.column(f"{name}_std").to_pylist())] if value else []


def _text(name: str, values: Sequence[str | None]) -> dict[str, Any] | None:
    """A column of words: each once, and for each row its place; −1 for none."""
    known = {word: place for place, word in enumerate(dict.fromkeys(value for value in values if value))}
    if not known:
        return None
    return {"name": name, "words": list(known), "of": [known.get(value or "", -1) for value in values]}


def _number(name: str, values: Sequence[float | None]) -> dict[str, Any] | None:
    numbers = [None if value is None or not math.isfinite(value) else _short(value) for value in values]
    return None if all(value is None for value in numbers) else {"name": name, "numbers": numbers}


def _short(value: float) -> float | int:
    rounded = float(f"{value:.{_DIGITS}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 1e15 else rounded


def _causes(found: Sequence[Mapping[str, Any]] | None) -> str | None:
    return ", ".join(f"{spoken(one['name'])} {_percent(one['probability'])}" for one in found or ()) or None


def _percent(probability: float) -> str:
    return ">99 %" if probability > 0.99 else f"{100.0 * probability:.0f} %"


def _sentences(found: Sequence[Mapping[str, Any]] | None) -> str | None:
    return "\n".join(f"{one['severity']}: {one['sentence']}" for one in found or ()) or None


def _epoch(when: Any) -> float | None:
    return None if when is None else round(when.timestamp(), 3)
