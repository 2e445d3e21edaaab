"""What a result is written to beside the terminal: page, Markdown summary, figures."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from msd_ident.cli import run

if TYPE_CHECKING:
    from msd_ident.data.provenance import Origin, Provenance
    from msd_ident.io import SourceOptions
    from msd_ident.report.page import Result


@dataclass
class Pages:
    """Where pages go, and the results that are to stand in them.

    Attributes:
        report, markdown, figures: targets; ``None`` for none.
        source: how the paths were read.
        output: whether files may be replaced, and whether anything is printed.
        kept: results with the paths that they are of.
    """

    report: Path | None
    markdown: Path | None
    figures: Path | None
    source: SourceOptions
    output: run.Output
    kept: list[tuple[tuple[Path, ...], Result]] = field(default_factory=list)

    def check(self) -> None:
        """Refuse before any work what could not be written afterwards; make the folder of the figures.

        Raises:
            UsageError: a file exists and may not be replaced, or its folder does not exist.
            SetupError: the disk does not take the folder.
        """
        for target in (self.report, self.markdown):
            if target is not None:
                run.check_target(target, self.output.overwrite)
        if self.figures is not None:
            run.make_folder(self.figures)

    def keep(self, paths: tuple[Path, ...], found: Result) -> None:
        """Remember a result."""
        self.kept.append((paths, found))

    def finish(self) -> None:
        """Write everything, and say where, unless told to be quiet.

        Raises:
            UsageError, SetupError: what could not be written.
        """
        if not self.kept or not any((self.report, self.markdown, self.figures)):
            return
        with run.progress(self.output.quiet) as tell:
            tell("writing the report", 0.1)
            lines = self._pages()
            tell("drawing the figures", 0.5)
            lines += self._figures()
        if self.output.tables:
            print(*lines, sep="\n")

    def _pages(self) -> list[str]:
        lines: list[str] = []
        if self.report is None and self.markdown is None:
            return lines
        results = [found for _, found in self.kept]
        told = [provenance(paths, self.source) for paths, _ in self.kept]
        if self.report is not None:
            from msd_ident.report import page

            page.save(results, self.report, told)
            lines.append(f"report: {self.report}")
        if self.markdown is not None:
            from msd_ident.export import Export
            from msd_ident.external import Comparison
            from msd_ident.report import markdown
            from msd_ident.workflow.validation import Validation

            plain = [found for found in results if not isinstance(found, Validation | Export | Comparison)]
            markdown.save(plain, self.markdown, told)
            lines.append(f"summary: {self.markdown}")
        return lines

    def _figures(self) -> list[str]:
        if self.figures is None:
            return []
        from msd_ident.report import figures

        lines = []
        for _, found in self.kept:
            name = "+".join(record.name for record in found.records)
            target = self.figures / f"{name}{getattr(found, 'label', '')}".replace("/", "_")
            if target.is_dir():
                for path in figures.paths(found, target):
                    run.check_target(path, self.output.overwrite)
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
    told = describe(path, source)
    return Origin(str(path), told.kind, size, digest, told.position, told.force)
