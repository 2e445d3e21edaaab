"""``msd diagnose --all-joints``: every joint of a bag, and whether its effort can be the force."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msd_ident.cli import progress, results
from msd_ident.errors import DataError, MsdError, UsageError

if TYPE_CHECKING:
    from msd_ident.io import SourceOptions
    from msd_ident.workflow import pipeline

SCHEMA = "msd.joint/1"


def diagnose_joints(
    paths: Sequence[Path],
    source: SourceOptions,
    options: pipeline.Options,
    output: results.Output,
    others: Sequence[object],
) -> int:
    """Diagnose all joints of each bag, in parallel; one table a bag, one JSON object a joint.

    Args:
        paths: bags.
        source: how they are read; force and position are those of each joint.
        options: of the diagnosis.
        output: where the results go.
        others: options that make no sense here, empty when not given.

    Raises:
        UsageError: one of them is given.
        DataError: no bag holds a joint.
    """
    if any(others):
        raise UsageError(
            "--all-joints goes with one bag's joints; expected no --force, --position, --report, --markdown, "
            "--figures, --together, --on or --export beside it: take one joint with --force and --position for those"
        )
    output.check(*paths)
    lines: list[dict[str, Any]] = []
    failures: list[MsdError] = []
    for path in paths:
        try:
            lines += _one_bag(path, source, options, output)
        except MsdError as error:
            failures.append(error)
            lines.append({"schema": SCHEMA, "path": str(path), "error": str(error)})
    results.write(lines, output)
    if failures:
        raise DataError("; ".join(map(str, failures)))
    return 0


def _one_bag(
    path: Path, source: SourceOptions, options: pipeline.Options, output: results.Output
) -> list[dict[str, Any]]:
    from msd_ident.io import joints as in_bag
    from msd_ident.io import read, source_of
    from msd_ident.workflow import all_joints

    found = in_bag(path)
    with progress.stages(output.quiet) as tell:
        tell(f"{len(found)} joints", 0.1)
        known = all_joints.each_joint(found, lambda one: read(path, source_of(source, one)), options)
    if output.tables:
        _show(path, known, results.console())
    return [_line(path, one) for one in known]


def _line(path: Path, one: Any) -> dict[str, Any]:
    line: dict[str, Any] = {
        "schema": SCHEMA,
        "path": str(path),
        "joint": one.name,
        "effort_usable": one.usable,
        "sentence": one.sentence,
    }
    return {**line, "diagnosis": one.diagnosis.to_json_dict() if one.diagnosis else None}


def _show(path: Path, results: Sequence[Any], console: Any) -> None:
    """A table of the joints, and below it what was found of each: a sentence is too long for a column."""
    from rich.table import Table

    table = Table(title=f"{path}: {len(results)} joints", show_lines=True)
    for name in ("joint", "effort is the force", "verdict", "inertia"):
        table.add_column(name, overflow="fold")
    for one in results:
        verdict, inertia = ("–", "–")
        if one.diagnosis is not None:
            mass = one.diagnosis.extended.quantities.get("mass")
            verdict = one.diagnosis.verdict
            inertia = f"{mass.value:.4g} {mass.unit}" if mass is not None else "–"
        table.add_row(one.name, "yes" if one.usable else "no", verdict, inertia)
    console.print(table)
    for one in results:
        console.print(f"{one.name}: {one.sentence}", markup=False)
