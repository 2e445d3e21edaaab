"""Budgets: they count work and never time, and a look is less than a descent."""

from __future__ import annotations

import ast
import importlib.util
import math
from pathlib import Path

import msd_ident
from msd_ident.estimate.effort import A_SWING, FEWEST_READINGS, KEPT, LONG, LOOK, SAMPLES, SHORT, THOROUGH

ROOMS = ("model", "features", "estimate", "residuals", "selection", "diagnosis", "design")
CLOCKS = {"time", "datetime", "timeit", "resource"}


def imported(path: Path) -> set[str]:
    """First names of what a module imports."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(str(node.module).split(".")[0])
    return found


def test_no_stage_of_a_search_can_look_at_a_clock() -> None:
    package = Path(str(msd_ident.__file__)).parent
    paths = [path for room in ROOMS for path in (package / room).rglob("*.py")]
    assert len(paths) > 100 and all(importlib.util.find_spec(name) for name in CLOCKS)
    assert {str(path): clocks for path in paths if (clocks := imported(path) & CLOCKS)} == {}


def test_a_look_is_less_than_a_descent() -> None:
    assert 0 < LOOK < SHORT < THOROUGH < LONG
    assert KEPT > 1, "with one start kept, the first look decides"
    assert FEWEST_READINGS < SAMPLES


def test_a_thinned_swing_keeps_its_shape() -> None:
    """A sine read so often and joined by straight lines is nowhere off by more than a fiftieth."""
    assert 1.0 - math.cos(math.pi / A_SWING) < 0.02
