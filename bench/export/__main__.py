"""``python -m bench.export``: exported models replayed in MuJoCo, wrong models, measured rigs.

python -m bench.export [--only exact|approximated|schemes|wrong|real] [--count N] [--seed N] [--jobs N]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import repeat
from typing import Any

from bench.export import measured, replays, schemes, wrong
from msd_ident.model.simulator import warm_up

PARTS = ("exact", "approximated", "schemes", "wrong", "real")
#: Rigs of each part.
COUNTS = {"exact": 100, "approximated": 70, "schemes": 20, "wrong": 40}


def _one(work: Callable[[int, int], Any], seed: int, number: int) -> Any:
    return work(seed + number, number)


def _all(work: Callable[[int, int], Any], seed: int, count: int, jobs: int) -> Iterator[Any]:
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_one, repeat(work), repeat(seed), range(count))


def _part(name: str, given: argparse.Namespace) -> Iterator[str]:
    if name == "real":
        yield from measured.lines()
        return
    count = given.count or COUNTS[name]
    work, told = {
        "exact": (replays.exact, lambda rows: replays.told(rows, True)),
        "approximated": (replays.approximated, lambda rows: replays.told(rows, False)),
        "schemes": (schemes.ratios, schemes.told), "wrong": (wrong.case, wrong.told),
    }[name]  # fmt: skip
    rows = list(_all(work, given.seed, count, given.jobs))
    yield f"seeds {given.seed} to {given.seed + count - 1}"
    yield from told(rows)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(prog="python -m bench.export", description="Exported models in their targets.")
    parser.add_argument("--only", choices=PARTS, help="run only this part")
    parser.add_argument("--count", type=int, help="number of rigs of a part")
    parser.add_argument("--seed", type=int, default=7000, help="seed of the first rig")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    given = parser.parse_args(arguments)
    warm_up()
    for name in [given.only] if given.only else PARTS:
        print(f"\n## {name}\n")
        for line in _part(name, given):
            print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
