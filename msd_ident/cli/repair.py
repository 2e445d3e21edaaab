"""``msd repair``: finish bags that a kill, a power cut or a full disk cut off."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from msd_ident.cli import groups, options, results

if TYPE_CHECKING:
    from msd_ident.io import Repair


@groups.grouped("json", "overwrite")
def repair(
    paths: Annotated[
        list[Path], options.path_argument(metavar="PATHS…", help="bag folders or .mcap files", show_default=False)
    ],
    output: results.Output,
) -> int:
    """Rebuild index and metadata of bags whose recording was interrupted, and report what was lost."""
    from msd_ident import io

    def handle(path: Path) -> dict[str, Any]:
        done = io.repair(path)
        if output.tables:
            print("\n".join((done.sentence, *(f"note: {note}" for note in done.notes))))
        return _to_json(done)

    return results.each_path(paths, output, handle)


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
