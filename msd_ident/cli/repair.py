"""``msd repair``: finish bags that a kill, a power cut or a full disk cut off."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from msd_ident.cli import options
from msd_ident.errors import MsdError

if TYPE_CHECKING:
    from msd_ident.io import Repair


def repair(
    paths: Annotated[list[Path], typer.Argument(help="bag folders or .mcap files", show_default=False)],
    json: options.JsonOption = "",
    overwrite: options.OverwriteOption = False,
) -> int:
    """Rebuild index and metadata of bags whose recording was interrupted, and report what was lost."""
    from msd_ident import io
    from msd_ident.cli import run

    output = run.Output(json, quiet=False, overwrite=overwrite)
    output.check()
    lines: list[dict[str, Any]] = []
    failed = False
    for path in paths:
        try:
            done = io.repair(path)
        except MsdError as error:
            failed = True
            print(f"msd: {error}", file=sys.stderr)
            lines.append({"path": str(path), "error": str(error)})
            continue
        lines.append(_to_json(done))
        if output.tables:
            print("\n".join((done.sentence, *(f"note: {note}" for note in done.notes))))
    run.write(lines, output)
    return 2 if failed else 0


def _to_json(done: Repair) -> dict[str, Any]:
    return {
        "schema": "msd.repair/1",
        "path": str(done.path),
        "changed": done.changed,
        "messages": done.messages,
        "lost_messages": done.lost,
        "lost_exact": done.exact,
        "lost_s": done.seconds,
        "unknown_s": done.open_seconds,
        "notes": list(done.notes),
    }
