"""Equations: a fenced block ``math`` in LaTeX becomes MathML, which browsers set without any script."""

from __future__ import annotations

from typing import Any

from latex2mathml.converter import convert


def block(source: str, language: str, css_class: str, options: Any, md: Any, **_: Any) -> str:
    """Formatter for ``pymdownx.superfences``: each line of the block is one equation."""
    lines = [line.strip() for line in source.splitlines() if line.strip()]
    return "".join(f'<div class="{css_class}">{convert(line, display="block")}</div>' for line in lines)
