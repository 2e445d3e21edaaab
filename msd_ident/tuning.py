"""Declared constants: numbers that experience sets, and numbers that something else gives.

A module of ``estimate``, ``residuals``, ``selection``, ``diagnosis`` or ``design`` states its constants with ``tuned``
and ``fixed``. Both return the value itself and keep nothing, so they cost nothing. The page ``docs/tuning.md``, the
test that counts the constants and ``make sensitivity`` read the declarations from the source, with ``declared``.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeVar

_Value = TypeVar("_Value")

#: Where a number comes from that nobody tunes. ``mathematics``: a law or a rule of counting. ``accuracy``: what double
#: precision, finite differences and the solver leave. ``resources``: how memory and cores are shared; no result depends
#: on it. ``interface``: a limit, default or definition that a user sees.
Kind = Literal["mathematics", "accuracy", "resources", "interface"]

#: Subpackages whose constants are declared.
ROOMS = ("estimate", "residuals", "selection", "diagnosis", "design")


def tuned(value: _Value, *, unit: str, why: str, chosen: str) -> _Value:
    """A constant that could be another one: a budget, a tolerance or a threshold.

    Args:
        value: a number, or a tuple of numbers.
        unit: of the value; ``1`` for a ratio, or what is counted.
        why: what it decides.
        chosen: the measurement that set it, or ``by hand``; the study of ``make sensitivity`` is made for all of them.
    """
    return value


def fixed(value: _Value, kind: Kind, why: str) -> _Value:
    """A constant that nobody tunes.

    Args:
        value: a number, or a tuple of numbers.
        kind: where it comes from.
        why: what it is.
    """
    return value


@dataclass(frozen=True)
class Declared:
    """One declaration, as the source has it.

    Attributes:
        module: dotted name.
        name: of the constant.
        text: its value, as written.
        about: ``unit``, ``why`` and ``chosen``, or ``kind`` and ``why``.
    """

    module: str
    name: str
    text: str
    about: dict[str, str]

    @property
    def is_tuned(self) -> bool:
        """Whether it was declared with ``tuned``."""
        return "chosen" in self.about

    @property
    def place(self) -> str:
        """``room.module.NAME``."""
        return f"{self.module.removeprefix('msd_ident.')}.{self.name}"


def declared() -> list[Declared]:
    """All declarations, in the order of subpackages, files and lines."""
    package = Path(__file__).resolve().parent
    found = []
    for room in ROOMS:
        for path in sorted((package / room).glob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"), str(path))
            found += [
                Declared(f"msd_ident.{room}.{path.stem}", name, ast.unparse(call.args[0]), _about(call))
                for name, call in declarations(tree)
            ]
    return found


def declarations(tree: ast.Module) -> Iterator[tuple[str, ast.Call]]:
    """Name and call of each ``NAME = tuned(...)`` and ``NAME = fixed(...)`` of a parsed module."""
    for node in tree.body:
        if not (isinstance(node, ast.Assign) and isinstance(call := node.value, ast.Call)):
            continue
        target, made = node.targets[0], call.func
        if isinstance(target, ast.Name) and isinstance(made, ast.Name) and made.id in ("tuned", "fixed"):
            yield target.id, call


def _about(call: ast.Call) -> dict[str, str]:
    """What a call says besides the value."""
    given = dict(zip(("kind", "why"), call.args[1:], strict=False))
    given |= {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
    return {name: str(ast.literal_eval(value)) for name, value in given.items()}
