"""``--export TARGET:FILE``: the model that was just found, written for another simulation and replayed there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msd_ident.cli import run
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.cli.pages import Pages
    from msd_ident.io import SourceOptions


@dataclass
class Exports:
    """Files that the one result of a command is exported to.

    Attributes:
        asked: ``TARGET:FILE`` each.
        source: how its records are read.
        pages: where the exports are shown too.
        group: paths of the result.
    """

    asked: Sequence[str]
    source: SourceOptions
    pages: Pages
    group: tuple[Path, ...] = field(default=())

    def check(self, results: int) -> None:
        """Refuse before any work what could not be written afterwards.

        Args:
            results: how many the command gives.

        Raises:
            UsageError: no such target, a name that it does not take, a file that exists, or several results.
        """
        from msd_ident import export

        if self.asked and results > 1:
            raise UsageError(f"--export with {results} results; expected one: give one path, or --together")
        for one in self.asked:
            target, out = self._parsed(one)
            chosen = export.target(target)
            chosen.check_name(out)
            for path in (out, *chosen.beside(out)):
                run.check_target(path, self.pages.output.overwrite)

    @staticmethod
    def _parsed(asked: str) -> tuple[str, Path]:
        target, colon, file = asked.partition(":")
        if not colon or not file:
            raise UsageError(f"--export {asked}; expected TARGET:FILE, e.g. --export mujoco:rig.xml")
        return target, Path(file)

    def keep(self, group: tuple[Path, ...], found: Any) -> None:
        """Remember the paths of the result, and the result for the page."""
        self.group = group
        self.pages.keep(group, found)

    def __call__(self, result: Mapping[str, Any], console: Console | None) -> dict[str, Any]:
        """Export a result's model; the objects that go into its JSON. Shown on the console where there is one.

        Raises:
            DataError, UsageError, SetupError: as ``export`` does.
        """
        if not self.asked:
            return {}
        from msd_ident import export
        from msd_ident.io import read_all
        from msd_ident.report.export import print_export
        from msd_ident.workflow import saved_model

        model = saved_model.from_json_dict(run.jsonable(result))
        records = [record for path in self.group for record in read_all(path, self.source)]
        made = []
        for one in self.asked:
            target, out = self._parsed(one)
            found = export.export(model, export.target(target), out, export.Options(), records)
            made.append(found.to_json_dict())
            self.pages.keep(self.group, found)
            if console is not None:
                print_export(found, console)
        return {"exports": made}
