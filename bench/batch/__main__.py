"""``python -m bench.batch``: measures ``msd batch`` on many records.

python -m bench.batch                             # all, small
python -m bench.batch --only speed --records 1000 # on a quiet machine
python -m bench.batch --only kills --records 200 --kills 20 --restarts 5
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bench.batch import faults, speed, store


def main() -> None:
    """Measure what is asked for; one JSON object a figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="*", help="speed, scaling, memory, kills, resume, disk, store")
    parser.add_argument("--records", type=int, default=40)
    parser.add_argument("--rows", type=int, default=10_000)
    parser.add_argument("--tasks", type=int, default=160)
    parser.add_argument("--length", type=float, default=1.0, help="of a slept task [s]")
    parser.add_argument("--kills", type=int, default=4)
    parser.add_argument("--restarts", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--folder", type=Path, help="keeps the records and tables; else a temporary one")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="msd_bench_") as temporary:
        folder = (given.folder or Path(temporary)).absolute()
        folder.mkdir(parents=True, exist_ok=True)
        for name, measure in _figures(given, folder).items():
            if not given.only or name in given.only:
                print(json.dumps({"figure": name, **measure()}, ensure_ascii=False), flush=True)


def _figures(given: argparse.Namespace, folder: Path) -> dict[str, Callable[[], dict[str, Any]]]:
    return {
        "speed": lambda: speed.speed(folder, given.records),
        "scaling": lambda: speed.scaling(given.tasks, given.length),
        "memory": lambda: speed.memory(folder, given.rows),
        "kills": lambda: faults.killed(folder, given.records, given.kills, given.restarts, given.seed),
        "resume": lambda: faults.interrupted(folder, given.records, 3, given.seed),
        "disk": lambda: faults.full_disk(folder, min(given.records, 20)),
        "store": lambda: store.from_store(folder, min(given.records, 20)),
    }


if __name__ == "__main__":
    main()
