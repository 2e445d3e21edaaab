"""Writes docs/reliability.md: each fault, how often it was tried, and the result; one block for each part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reliability.md"

#: Parts in the order of the page, and what stands above them.
HEADS = {
    "killed": "## Interrupted recordings\n",
    "recorders": "",
    "power": "",
    "full": "",
    "cut": "## Truncated and damaged files\n",
    "damaged": "",
    "data": (
        "## Estimates from bad data\n\nThe demo's rig with the paper's parameters, 1 kHz. *Right*: m and k are within "
        "1 %, µ is within 5 % of the result from clean data.\n*In doubt*: a number is wrong, but it is reported as "
        "open, or a warning doubts it, or the record is refused.\n*Wrong unnoticed*: a number is wrong without any of "
        "these.\n"
    ),
    "load_1000": "## Nodes under load\n",
    "load_10000": "",
}
#: The command that makes a part, where it is another one.
COMMANDS = {"load_1000": "make load", "load_10000": "make load"}


@dataclass(frozen=True)
class Row:
    """A fault, how often it was tried, and the result."""

    fault: str
    tried: int
    outcome: str

    @property
    def line(self) -> str:
        """As it stands in the table."""
        return f"| {self.fault} | {self.tried} | {self.outcome} |"


def put(part: str, rows: Sequence[Row], how: str, page: Path = PAGE) -> None:
    """Put the rows of a part where its last ones stood, or in their place among the others."""
    text = page.read_text(encoding="utf-8") if page.exists() else "# Reliability\n"
    for name in HEADS:
        if _begin(name) not in text:
            text = f"{text.rstrip()}\n\n{_begin(name)}\n{_end(name)}\n"
    head, _, rest = text.partition(_begin(part))
    tail = rest.partition(_end(part))[2]
    table = "\n".join(("| fault | cases | result |", "|---|---|---|", *(row.line for row in rows)))
    command = COMMANDS.get(part, f"make fuzz ARGS={part}")
    said = f"`{command}`, {how}:"
    above = f"{HEADS[part]}\n" if HEADS[part] else ""
    page.write_text(f"{head}{_begin(part)}\n\n{above}{said}\n\n{table}\n\n{_end(part)}{tail}", encoding="utf-8")


def _begin(part: str) -> str:
    return f"<!-- {part}: made by `{COMMANDS.get(part, 'make fuzz')}` -->"


def _end(part: str) -> str:
    return f"<!-- end of {part} -->"
