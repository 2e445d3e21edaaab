"""``python -m bench.real``: diagnose the measured rigs and compare with what is true about them.

python -m bench.real [--only NAME] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from bench.real import score
from bench.real.rigs import RIGS, Rig, folder
from msd_ident import pipeline
from msd_ident.bag import read
from msd_ident.errors import MsdError
from msd_ident.model.simulator import warm_up

_HEAD = "| rig | verdict | causes | judgement | values | SEE (of the expert's) | processor |\n" + "|---" * 7 + "|"


def diagnosed(rig: Rig, path: Path) -> score.Row:
    """Read a rig's record as a user does, diagnose it and compare."""
    begun = _processor_time()
    found = pipeline.diagnose([read(path, rig.options)])
    return score.score(rig, found, _processor_time() - begun)


def _processor_time() -> float:
    """Of this process, its threads and the processes it started [s]."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in used)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table and the totals; exit code 0 whatever they say, also without the data."""
    parser = argparse.ArgumentParser(prog="python -m bench.real", description="Measured rigs and the truth.")
    parser.add_argument("--only", default="", help="rigs whose name holds this")
    parser.add_argument("--json", type=Path, help="file for all rows, one JSON object a line")
    given = parser.parse_args(arguments)
    chosen = [rig for rig in RIGS if given.only in rig.name and (folder() / rig.path).is_file()]
    if not chosen:
        print(f"no measured rigs {f'called {given.only} ' if given.only else ''}in {folder()}: nothing to compare")
        return 0
    warm_up()
    print(_HEAD)
    rows = []
    for rig in chosen:
        try:
            row = diagnosed(rig, folder() / rig.path)
        except MsdError as error:
            row = score.refused(rig, str(error))
        rows.append(row)
        print(score.line(row), flush=True)
    print("\n" + "\n".join(score.totals(rows)))
    if given.json:
        text = "".join(json.dumps(asdict(row), ensure_ascii=False) + "\n" for row in rows)
        given.json.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
