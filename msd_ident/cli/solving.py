"""The loop over paths that identify, diagnose and validate share: read, solve, print, write."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msd_ident.cli import pages, progress, results
from msd_ident.errors import MsdError

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.cli.further import Further
    from msd_ident.data.record import Record
    from msd_ident.io import SourceOptions

    Solve = Callable[[Sequence[Record], progress.Progress], Any]


@dataclass(frozen=True)
class Data:
    """The records of a command: their paths, how they are read, and whether all are one experiment."""

    paths: Sequence[Path]
    source: SourceOptions
    together: bool


def work(
    data: Data,
    output: results.Output,
    solve: Solve,
    show: Callable[[Any, Console], None],
    further: Further | None = None,
) -> tuple[int, list[Any]]:
    """Read, solve, show and write every path, or all together.

    A path that fails gets its one line on stderr and an object with ``error``; the others go on.

    Args:
        data: the records.
        output: where results go.
        solve: gives the result of the records of a path.
        show: prints a result.
        further: what else is done with each result.

    Returns:
        The exit code, 2 when any path failed, and the results.
    """
    if further is None:
        output.check(*data.paths)
    else:
        output.check(*data.paths, *further.on, written=further.files())
    groups = [tuple(data.paths)] if data.together else [(path,) for path in data.paths]
    parts = [part for group in groups for part in _parts(group, data)]
    if further is not None:
        further.check(len(parts), output.overwrite)
    console = results.console()
    lines: list[dict[str, Any]] = []
    kept: list[pages.Kept] = []
    failed = False
    for group, source in parts:
        name = " + ".join(str(path) for path in group) + _run(source)
        try:
            result = _solved(group, source, output, solve)
        except MsdError as error:
            failed = True
            print(f"msd: {error}" if len(parts) == 1 else f"msd: {name}: {error}", file=sys.stderr)
            lines.append({"path": name, "error": str(error)})
            continue
        kept.append((group, result))
        if output.tables:
            show(result, console)
        found = result.to_json_dict()
        schema = found.pop("schema")
        line = {"schema": schema, "path": name, **_reading(schema, source), **found}
        if further is not None:
            used, incomplete = further.use(line, group, kept, console if output.tables else None)
            line, failed = line | used, failed or incomplete
        lines.append(line)
    results.write(lines, output)
    pages.write(kept, data.source, output)
    return (2 if failed else 0), [result for _, result in kept]


def _reading(schema: str, source: SourceOptions) -> dict[str, Any]:
    """How the record of a saved model was read: a replay reads it so again."""
    from msd_ident.workflow.saved_model import SCHEMAS

    return {"read_with": source.chosen} if schema in SCHEMAS else {}


def _parts(group: tuple[Path, ...], data: Data) -> list[tuple[tuple[Path, ...], SourceOptions]]:
    """A group with the options of each of its results: one for each run of a path for ``--run all``."""
    from msd_ident.io import each_run

    if data.together or data.source.run != "all":
        return [(group, data.source)]
    try:
        return [(group, one) for one in each_run(group[0], data.source)]
    except MsdError:
        return [(group, data.source)]  # reading it will say what is wrong


def _run(source: SourceOptions) -> str:
    """Which run of a path a result is of, as words behind the path."""
    return f" run {source.run}" if source.run not in ("", "all") else ""


def _solved(group: Sequence[Path], source: SourceOptions, output: results.Output, solve: Solve) -> Any:
    from msd_ident.io import read_all

    with progress.stages(output.quiet) as report:
        report("reading", 0.0)
        return solve([record for path in group for record in read_all(path, source)], report)
