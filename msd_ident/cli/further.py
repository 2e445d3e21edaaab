"""What identify and diagnose do with the model just found: ``--on`` validates it, ``--export`` writes it to files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msd_ident.cli import results
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.cli.pages import Kept
    from msd_ident.io import SourceOptions


@dataclass(frozen=True)
class Further:
    """Further uses of each result.

    Attributes:
        on: records that the model is validated on.
        export: ``TARGET:FILE`` each.
        source: how all records are read.
    """

    on: Sequence[Path]
    export: Sequence[str]
    source: SourceOptions

    def check(self, count: int, overwrite: bool) -> None:
        """Refuse before any work what could not be written afterwards.

        Args:
            count: number of results of the command.
            overwrite: whether a file that exists may be replaced.

        Raises:
            UsageError: no such target, a name that it does not take, a file that exists, or several results.
        """
        if not self.export:
            return
        from msd_ident import export

        if count > 1:
            raise UsageError(
                f"--export with {count} results; expected one: give one path, with --run N where it has "
                "several runs, or --together"
            )
        for target, out in map(_parsed, self.export):
            export.target(target).check_name(out)
        results.check_targets(overwrite, *self.files())

    def files(self) -> list[Path]:
        """All files that the exports may write.

        Raises:
            UsageError: no such target.
        """
        if not self.export:
            return []
        from msd_ident import export

        return [path for target, out in map(_parsed, self.export) for path in (out, *export.target(target).beside(out))]

    def use(
        self, result: Mapping[str, Any], group: tuple[Path, ...], kept: list[Kept], console: Console | None
    ) -> tuple[dict[str, Any], bool]:
        """Validate and export a result's model; a use that fails stops no other, and is told as a failing path is.

        Args:
            result: its JSON.
            group: paths of the records that it is from.
            kept: the exports are added here.
            console: tables are printed here.

        Returns:
            The objects that go into its JSON, and whether a use failed.
        """
        lines: dict[str, Any] = {}
        on_failed = export_failed = False
        if self.on:
            lines["validations"], on_failed = results.handled(self.on, self._validation(result, console))
        if self.export:
            outs = [out for _, out in map(_parsed, self.export)]
            lines["exports"], export_failed = results.handled(outs, self._export(result, group, kept, console))
        return lines, on_failed or export_failed

    def _validation(self, result: Mapping[str, Any], console: Console | None) -> Callable[[Path], dict[str, Any]]:
        """What validates the model on a path."""

        def validated(path: Path) -> dict[str, Any]:
            """The object of one record."""
            from msd_ident.io import read_all
            from msd_ident.report.validation import print_validation
            from msd_ident.workflow import saved_model, validation

            found = validation.validate(saved_model.from_json_dict(result), read_all(path, self.source))
            if console is not None:
                print_validation(found, console)
            line = found.to_json_dict()
            return {"schema": line.pop("schema"), "path": str(path), **line}

        return validated

    def _export(
        self, result: Mapping[str, Any], group: tuple[Path, ...], kept: list[Kept], console: Console | None
    ) -> Callable[[Path], dict[str, Any]]:
        """What writes the model to a file."""
        from msd_ident.io import read_all

        target_of = {out: target for target, out in map(_parsed, self.export)}
        records = cache(lambda: [record for path in group for record in read_all(path, self.source)])  # once for all

        def exported(out: Path) -> dict[str, Any]:
            """The object of one file."""
            from msd_ident import export
            from msd_ident.report.export import print_export
            from msd_ident.workflow import saved_model

            model, target = saved_model.from_json_dict(results.jsonable(result)), export.target(target_of[out])
            found = export.export(model, target, out, export.Options(), records())
            kept.append((group, found))
            if console is not None:
                print_export(found, console)
            return found.to_json_dict()

        return exported


def _parsed(asked: str) -> tuple[str, Path]:
    target, colon, file = asked.partition(":")
    if not colon or not file:
        raise UsageError(f"--export {asked}; expected TARGET:FILE, e.g. --export mujoco:rig.xml")
    return target, Path(file)
