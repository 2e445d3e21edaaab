"""The map of the subpackages (rooms): a picture of their imports, and their docstrings. Imports are read by ast."""

from __future__ import annotations

import ast
import html
import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from docs_tables import cell, code, plain, table

from msd_ident.model.effects import LIBRARY

PACKAGE = Path(__file__).resolve().parents[2] / "msd_ident"

#: ``In: ... Out: ... Begin with ...`` of a room's docstring.
_SAID = re.compile(r"\bIn: (?P<takes>.+?)\s+Out: (?P<gives>.+?)\s+Begin with (?P<begin>.+?)(?:\n\n|$)", re.DOTALL)

#: Size of a box, and the distance between boxes, in units of the picture.
_BOX, _TALL, _GAP, _RISE = 92.0, 26.0, 16.0, 34.0


def written(name: str) -> str:
    """``picture``, ``rooms`` or ``parameters``: what replaces its comment in a page."""
    return {"picture": picture, "rooms": rooms, "parameters": parameters}[name]()


@cache
def imports() -> Mapping[str, frozenset[str]]:
    """Room -> the rooms that it imports, also inside functions; type checkers' imports count too."""
    names = sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py"))
    return {name: frozenset(_imported(name)) & frozenset(names) - {name} for name in names}


def _imported(room: str) -> Iterator[str]:
    for path in (PACKAGE / room).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                found = [node.module] if "." in node.module else [f"{node.module}.{one.name}" for one in node.names]
            elif isinstance(node, ast.Import):
                found = [one.name for one in node.names]
            else:
                continue
            yield from (name.split(".")[1] for name in found if name.startswith("msd_ident."))


@cache
def floors() -> Mapping[str, int]:
    """Room -> 0 for rooms that import no other one, else one more than the highest that it imports."""
    known: dict[str, int] = {}

    def floor(room: str) -> int:
        if room not in known:
            known[room] = max((floor(one) + 1 for one in imports()[room]), default=0)
        return known[room]

    for room in imports():
        floor(room)
    return known


def direct() -> list[tuple[str, str]]:
    """Imports that are not implied by others: a room's import of ``data`` is, where it imports a room that does."""

    @cache
    def below(room: str) -> frozenset[str]:
        return imports()[room].union(*(below(one) for one in imports()[room]))

    return [
        (room, one)
        for room, found in imports().items()
        for one in sorted(found)
        if not any(one in below(other) for other in found - {one})
    ]


def picture() -> str:
    """The rooms as boxes, a room above all that it imports, with an arrow for each import that is not implied."""
    level = floors()
    rows = [[room for room in imports() if level[room] == number] for number in range(max(level.values()) + 1)]
    widest = max(len(row) for row in rows)
    width = widest * (_BOX + _GAP) + 2 * _GAP
    height = len(rows) * (_TALL + _RISE) - _RISE + 4.0
    place: dict[str, tuple[float, float]] = {}
    for number, row in enumerate(rows):
        row.sort(key=lambda room: _pull(room, place, width))
        left = (width - len(row) * (_BOX + _GAP) + _GAP) / 2 + _aside(number, len(row))
        for at, room in enumerate(row):
            place[room] = left + at * (_BOX + _GAP), height - 2.0 - _TALL - number * (_TALL + _RISE)
    lines = [_arrow(place[room], place[one]) for room, one in direct()]
    boxes = [_box(room, *place[room]) for room in place]
    label = "Subpackages of msd_ident and their imports"
    head = f'<svg viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="{label}">'
    return '<div class="rooms">\n' + "\n".join([head, *lines, *boxes, "</svg>"]) + "\n</div>\n"


def _pull(room: str, place: Mapping[str, tuple[float, float]], width: float) -> float:
    """Where a room's imports lie on the average, so that arrows are short."""
    lies = [place[one][0] for one in imports()[room] if one in place]
    return sum(lies) / len(lies) if lies else width / 2


def _aside(number: int, rooms: int) -> float:
    """A floor with one room stands a little aside, so that arrows past it are seen."""
    return ((-1) ** number) * 0.75 * _BOX if rooms == 1 else 0.0


def _arrow(above: tuple[float, float], below: tuple[float, float]) -> str:
    (x0, y0), (x1, y1) = (above[0] + _BOX / 2, above[1] + _TALL), (below[0] + _BOX / 2, below[1])
    bend = (y1 - y0) / 2
    return f'<path d="M{x0:.0f} {y0:.0f} C{x0:.0f} {y0 + bend:.0f} {x1:.0f} {y1 - bend:.0f} {x1:.0f} {y1:.0f}"/>'


def _box(room: str, x: float, y: float) -> str:
    text = f'<text x="{x + _BOX / 2:.0f}" y="{y + _TALL / 2 + 4:.0f}">{html.escape(room)}</text>'
    return f'<a href="#{room}"><rect x="{x:.0f}" y="{y:.0f}" width="{_BOX:.0f}" height="{_TALL:.0f}" rx="4"/>{text}</a>'


def rooms() -> str:
    """A table for each room: what comes in, what goes out, where to begin reading; lowest rooms first.

    Raises:
        AttributeError: a room does not say it.
    """
    found = []
    for room in sorted(imports(), key=lambda name: (floors()[name], name)):
        text = ast.get_docstring(ast.parse((PACKAGE / room / "__init__.py").read_text(encoding="utf-8"))) or ""
        said = _SAID.search(text)
        if said is None:
            raise AttributeError(f"the docstring of msd_ident.{room} has no line In:, Out: and Begin with")
        rows = [("In", said["takes"]), ("Out", said["gives"]), ("Begin with", said["begin"])]
        uses = ", ".join(f"[{one}](#{one})" for one in sorted(imports()[room])) or "no other subpackage"
        lines = [(f"**{name}**", cell(plain(what.rstrip(".")))) for name, what in rows]
        found.append(
            f"### {room}\n\n{plain(text.split(chr(10) * 2)[0])}\n\n" + table(("", ""), [*lines, ("Imports", uses)])
        )
    return "\n".join(found)


def parameters() -> str:
    """All parameters of all effects: name, symbol, unit, meaning, and the effects that have it."""
    found = {(p.name, p.symbol, p.unit, p.meaning): [] for effect in LIBRARY for p in effect.parameters}
    for effect in LIBRARY:
        for p in effect.parameters:
            found[p.name, p.symbol, p.unit, p.meaning].append(f"[{effect.name}](effects/{effect.name}.md)")
    rows = [
        (code(name), symbol, unit, meaning, ", ".join(where)) for (name, symbol, unit, meaning), where in found.items()
    ]
    return table(("name", "symbol", "unit", "meaning", "effects"), sorted(rows))
