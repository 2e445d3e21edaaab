"""``python -m bench``: the figures of solver, fit and diagnosis on this machine, as a table and as JSON.

python -m bench [--json FILE] [solver] [fit] [diagnosis]
"""

from __future__ import annotations

import os

# One core, and no thread pools of libraries: set before numpy is imported.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse  # noqa: E402
import json  # noqa: E402
import platform  # noqa: E402
import sys  # noqa: E402
from pathlib import Path  # noqa: E402

from rich.console import Console  # noqa: E402
from rich.table import Table  # noqa: E402

from bench.measure import Row  # noqa: E402

PARTS = ("solver", "fit", "diagnosis")


def collect(parts: list[str]) -> list[Row]:
    """Measure the parts asked for."""
    rows: list[Row] = []
    if "solver" in parts:
        from bench import solver

        rows += solver.rows()
    if "fit" in parts:
        from bench import fitting

        rows += fitting.rows()
    if "diagnosis" in parts:
        from bench import diagnosis

        rows += diagnosis.rows()
    return rows


def table(rows: list[Row]) -> Table:
    """The figures for a terminal."""
    colour = {"aim": "green", "must": "yellow", "missed": "bold red", "": ""}
    out = Table(title=f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}")
    for heading in ("quantity", "median", "required", "goal", "reached", "detail"):
        out.add_column(heading, justify="right" if heading in ("median", "required", "goal") else "left")
    for row in rows:
        sign = "≥ " if row.at_least else "≤ "
        bounds = ["" if bound != bound else f"{sign}{bound:g}" for bound in (row.must, row.aim)]
        reached = {"aim": "goal", "must": "required"}.get(row.grade, row.grade)
        out.add_row(row.figure, f"{row.value:.3g} {row.unit}", *bounds, reached, row.detail, style=colour[row.grade])
    return out


def main() -> int:
    """Run the benchmark; exit code 1 when a figure misses what it must reach."""
    parser = argparse.ArgumentParser(prog="python -m bench", description="Speed of solver, fit and diagnosis.")
    parser.add_argument("parts", nargs="*", metavar="part", help="solver, fit, diagnosis; all when none is named")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures there as well")
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"no part is called {', '.join(sorted(unknown))}; expected {', '.join(PARTS)}")
    rows = collect(options.parts or list(PARTS))
    Console(width=None if sys.stdout.isatty() else 180).print(table(rows))
    if options.json:
        figures = {
            "schema": "msd.bench/1",
            "machine": {"processor": platform.processor() or platform.machine(), "cores": os.cpu_count()},
            "rows": [row.to_dict() for row in rows],
        }
        options.json.write_text(json.dumps(figures, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    return 1 if any(row.grade == "missed" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
