"""Writes the page, the Markdown summary and the figures of results."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.cli import progress, results

if TYPE_CHECKING:
    from msd_ident.data.provenance import Origin, Provenance
    from msd_ident.io import SourceOptions
    from msd_ident.report.page import Result

    #: A result with the paths that it is of.
    Kept = tuple[tuple[Path, ...], Result]


def write(kept: Sequence[Kept], source: SourceOptions, output: results.Output) -> None:
    """Write page, summary and figures of all results, and print where, unless the output is quiet.

    Args:
        kept: the results.
        source: how the paths were read.
        output: where everything goes.

    Raises:
        UsageError, SetupError: what could not be written.
    """
    if not kept or not any((output.report, output.markdown, output.figures)):
        return
    with progress.stages(output.quiet) as tell:
        tell("writing the report", 0.1)
        lines = _pages(kept, source, output)
        tell("drawing the figures", 0.5)
        lines += [] if output.figures is None else _figures(kept, output.figures, output.overwrite)
    if output.tables:
        print(*lines, sep="\n")


def _pages(kept: Sequence[Kept], source: SourceOptions, output: results.Output) -> list[str]:
    lines: list[str] = []
    if output.report is None and output.markdown is None:
        return lines
    results = [found for _, found in kept]
    origins = [provenance(paths, source) for paths, _ in kept]
    if output.report is not None:
        from msd_ident.report import page

        page.save(results, output.report, origins)
        lines.append(f"report: {output.report}")
    if output.markdown is not None:
        from msd_ident.export import Export
        from msd_ident.external import Comparison
        from msd_ident.report import markdown
        from msd_ident.workflow.validation import Validation

        plain = [found for found in results if not isinstance(found, Validation | Export | Comparison)]
        markdown.save(plain, output.markdown, origins)
        lines.append(f"summary: {output.markdown}")
    return lines


def _figures(kept: Sequence[Kept], folder: Path, overwrite: bool) -> list[str]:
    from msd_ident.report import figures, words

    lines = []
    for _, found in kept:
        name = words.folder([record.name for record in found.records])
        target = folder / f"{name}{getattr(found, 'label', '')}".replace("/", "_")
        if target.is_dir():
            results.check_targets(overwrite, *figures.paths(found, target))
        figures.save(found, target)
        lines.append(f"figures: {target}")
    return lines


def provenance(paths: Sequence[Path], source: SourceOptions) -> Provenance:
    """Files with their hashes, versions, and the command line that is running."""
    from msd_ident.data.provenance import Provenance, versions

    command = shlex.join(["msd", *sys.argv[1:]])
    now = datetime.now(timezone.utc).isoformat(timespec="seconds").replace("+00:00", "Z")
    return Provenance(command, now, tuple(_origin(path, source) for path in paths), versions())


def _origin(path: Path, source: SourceOptions) -> Origin:
    from msd_ident.data.provenance import Origin, fingerprint
    from msd_ident.io import describe

    size, digest = fingerprint(path)
    info = describe(path, source)
    return Origin(str(path), info.kind, size, digest, info.position, info.force)
