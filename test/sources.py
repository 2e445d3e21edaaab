"""Source files, each parsed once in a process: tests of many of them share the ``xdist_group`` "house"."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path


@cache
def parsed(path: Path) -> ast.Module:
    """A module of this project."""
    return ast.parse(path.read_text(encoding="utf-8"), str(path))
