"""Markdown tables, and small pieces of text that go into them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(cell(text) for text in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def cell(text: str) -> str:
    """Text that stays within one cell."""
    return " ".join(text.split()).replace("|", "\\|") or " "


def code(text: str) -> str:
    """As code; nothing for nothing."""
    return f"`{text}`" if text else ""


def number(value: float) -> str:
    """A bound."""
    if math.isinf(value):
        return "−∞" if value < 0 else "∞"
    return f"{value:g}".replace("-", "−")


def plain(docstring: str | None) -> str:
    """A docstring as Markdown: joined lines, ``code`` as `code`, characters of emphasis kept as they are."""
    text = "\n\n".join(" ".join(part.split()) for part in (docstring or "").strip().split("\n\n"))
    return text.replace("``", "`").replace("*", "\\*")
