"""Random records: rigs with mixed causes, 6 s at 1 kHz, each from its seed."""

from __future__ import annotations

from pathlib import Path

from bench.blind.rigs import write
from msd_sim import lottery

#: Every third record is a rig without a hidden cause, the others have one in turn.
_HIDDEN = (None, *lottery.NAMES)


def make(folder: Path, count: int, seed: int = 0) -> list[Path]:
    """CSV files in a folder, one robot's in a folder each; those that exist are kept."""
    found = []
    for number in range(count):
        path = folder / f"robot_{number % 10}" / f"record_{number:05d}.csv"
        found.append(path)
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            write(lottery.draw(seed + number, _HIDDEN[number % len(_HIDDEN)], bool(number % 2), "steps", 1000.0), path)
    return found
