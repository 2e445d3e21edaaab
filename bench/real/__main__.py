"""``python -m bench.real``: diagnose the measured rigs and compare with what is true about them.

python -m bench.real [--only NAME] [--json FILE] [--docs DIR]
python -m bench.real --score FILE [--docs DIR]
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from bench.real import page, score
from bench.real.rigs import RIGS, Rig, folder
from bench.real.score import Row
from msd_ident.errors import MsdError
from msd_ident.io import read
from msd_ident.model.simulator import warm_up
from msd_ident.report import verdict_figure
from msd_ident.workflow import pipeline

_HEAD = f"| rig | {score.HEADS} | processor |\n" + "|---" * 7 + "|"


def diagnosed(rig: Rig, path: Path, docs: Path | None = None) -> Row:
    """Read a rig's record as a user does, diagnose it and compare; drawn for the page where ``docs`` is given."""
    begun = _processor_time()
    found = pipeline.diagnose([read(path, rig.options)])
    row = score.score(rig, found, _processor_time() - begun)
    if docs is not None and rig.name in page.PICTURED:
        verdict_figure.draw(found).savefig(docs / "images" / f"real_{rig.name}.png")
    return row


def read_rows(path: Path) -> list[Row]:
    """Rows that were written with ``--json``."""
    tuples = ("causes", "missed", "false", "false_findings", "values")
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return [Row(**{**row, **{name: tuple(map(_hard, row[name])) for name in tuples}}) for row in rows]


def _hard(value: Any) -> Any:
    """Lists, which is what JSON has, as tuples."""
    return tuple(map(_hard, value)) if isinstance(value, list) else value


def _processor_time() -> float:
    """Of this process, its threads and the processes it started [s]."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table and the totals; exit code 0 whatever they say, also without the data."""
    parser = argparse.ArgumentParser(prog="python -m bench.real", description="Diagnoses of measured rigs.")
    parser.add_argument("--only", default="", help="rigs whose name holds this")
    parser.add_argument("--json", type=Path, help="file for all rows, one JSON object a line")
    parser.add_argument("--docs", type=Path, help="directory that gets the page, and its pictures where rigs are run")
    parser.add_argument("--score", type=Path, help="rows that were written with --json before, instead of a run")
    given = parser.parse_args(arguments)
    if given.score:
        return _told(read_rows(given.score), given.docs)
    chosen = [rig for rig in RIGS if given.only in rig.name and (folder() / rig.path).is_file()]
    if not chosen:
        print(f"no measured rigs {f'called {given.only} ' if given.only else ''}in {folder()}: nothing to compare")
        return 0
    warm_up()
    print(_HEAD)
    rows = []
    for rig in chosen:
        try:
            row = diagnosed(rig, folder() / rig.path, given.docs)
        except MsdError as error:
            row = score.refused(rig, str(error))
        rows.append(row)
        print(score.line(row), flush=True)
    if given.json:
        text = "".join(json.dumps(asdict(row), ensure_ascii=False) + "\n" for row in rows)
        given.json.write_text(text, encoding="utf-8")
    return _told(rows, None if given.only else given.docs)


def _told(rows: Sequence[Row], docs: Path | None) -> int:
    """Print the totals, and write the page of the whole table."""
    print("\n" + "\n".join(score.totals(rows)))
    if docs is not None:
        (docs / "real-rigs.md").write_text(page.text(rows), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
