"""The confusion matrix of an experiment as a table and sentences, for page, Markdown and terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from msd_ident.quantity import probability
from msd_ident.report import words
from msd_ident.selection.calibration import Calibration, Row
from msd_ident.selection.hypothesis import Causes

#: Columns of a table: the most frequent results; all others together are one more.
_MOST = 5
OTHER = "something else"


@dataclass(frozen=True)
class Cell:
    """Copies of one row that were called so: in per cent, and whether it is what they were."""

    text: str
    percent: float
    right: bool


@dataclass(frozen=True)
class Line:
    """One row: what was simulated, how many copies, and a cell for each column."""

    name: str
    copies: int
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Matrix:
    """Heads of the columns, rows, and what they mean."""

    heads: tuple[str, ...]
    lines: tuple[Line, ...]
    sentences: tuple[str, ...]


def spoken(causes: Causes) -> str:
    """A set of causes as people say it."""
    return words.listed([words.effect(name) for name in sorted(causes)]) or "the base model"


def matrix(found: Calibration) -> Matrix:
    """The whole table."""
    columns = found.columns[:_MOST]
    others = len(found.columns) > _MOST
    heads = (*map(spoken, columns), *([OTHER] if others else []))
    lines = tuple(_line(row, columns, others) for row in found.rows)
    return Matrix(heads, lines, (*sentences(found), *corrections(found)))


def sentences(found: Calibration) -> tuple[str, ...]:
    """For each row: per cent of its copies that were diagnosed correctly, and the most frequent other result."""
    return tuple(_sentence(row) for row in found.rows)


def _sentence(row: Row) -> str:
    """Of one row, with the most frequent wrong result."""
    said = Counter({causes: count for causes, count in row.said.items() if causes != row.causes})
    strength = " of any strength" if row.any_strength else ""
    right = _share(row.right, row)
    sentence = f"Of the copies with {spoken(row.causes)}{strength}, {right} were diagnosed correctly"
    if not said:
        return f"{sentence}."
    most = min(said, key=lambda causes: (-said[causes], sorted(causes)))
    return f"{sentence}, {_share(said[most], row)} as {spoken(most)}."


def _share(count: int, row: Row) -> str:
    return f"{100.0 * count / row.copies:.0f} %"


def corrections(found: Calibration) -> tuple[str, ...]:
    """Each probability before and after the correction, and why it is limited where no copy confirms it."""
    return tuple(_correction(found, name, before) for name, before in found.stated.items())


def _correction(found: Calibration, name: str, before: float) -> str:
    cause = words.effect(name)
    after = f"{probability(found.corrected[name])} after correction by {found.copies} copies of this record"
    said = f"{cause[0].upper()}{cause[1:]}: probability {probability(before)} by the evidence, {after}"
    if found.confirms(name):
        return f"{said}."
    return (
        f"{said}: none of the {found.rows[0].copies} copies of the leading explanation was diagnosed with it, so they "
        "do not check it, and its odds are limited as without copies."
    )


def _line(row: Row, columns: Sequence[Causes], others: bool) -> Line:
    counts = [(row.said.get(causes, 0), causes == row.causes) for causes in columns]
    if others:
        counts.append((row.copies - sum(count for count, _ in counts), False))
    cells = tuple(Cell(_share(n, row) if n else "–", 100.0 * n / row.copies, right) for n, right in counts)
    return Line(spoken(row.causes) + (", any strength" if row.any_strength else ""), row.copies, cells)
