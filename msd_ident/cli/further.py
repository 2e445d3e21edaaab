"""What identify and diagnose do with the model just found: ``--on`` validates it, ``--export`` writes it to files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
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
    ) -> dict[str, Any]:
        """Validate and export a result's model; the objects that go into its JSON.

        Args:
            result: its JSON.
            group: paths of the records that it is from.
            kept: the exports are added here.
            console: tables are printed here.

        Raises:
            DataError, UsageError: a path that cannot be read, or is in other units than the model.
            SetupError: as ``export`` does.
        """
        lines: dict[str, Any] = {}
        if self.on:
            lines["validations"] = self._validations(result, console)
        if self.export:
            lines["exports"] = self._exports(result, group, kept, console)
        return lines

    def _validations(self, result: Mapping[str, Any], console: Console | None) -> list[dict[str, Any]]:
        from msd_ident.io import read_all
        from msd_ident.report.validation import print_validation
        from msd_ident.workflow import saved_model, validation

        model, lines = saved_model.from_json_dict(result), []
        for path in self.on:
            found = validation.validate(model, read_all(path, self.source))
            line = found.to_json_dict()
            lines.append({"schema": line.pop("schema"), "path": str(path), **line})
            if console is not None:
                print_validation(found, console)
        return lines

    def _exports(
        self, result: Mapping[str, Any], group: tuple[Path, ...], kept: list[Kept], console: Console | None
    ) -> list[dict[str, Any]]:
        from msd_ident import export
        from msd_ident.io import read_all
        from msd_ident.report.export import print_export
        from msd_ident.workflow import saved_model

        model, lines = saved_model.from_json_dict(results.jsonable(result)), []
        records = [record for path in group for record in read_all(path, self.source)]
        for one in self.export:
            target, out = _parsed(one)
            found = export.export(model, export.target(target), out, export.Options(), records)
            lines.append(found.to_json_dict())
            kept.append((group, found))
            if console is not None:
                print_export(found, console)
        return lines


def _parsed(asked: str) -> tuple[str, Path]:
    target, colon, file = asked.partition(":")
    if not colon or not file:
        raise UsageError(f"--export {asked}; expected TARGET:FILE, e.g. --export mujoco:rig.xml")
    return target, Path(file)
