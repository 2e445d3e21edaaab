"""What ``msd batch``, ``msd compare`` and ``msd watch`` share: the work on many records, and the table of results."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from msd_ident.cli import options, progress
from msd_ident.errors import DataError, UsageError

if TYPE_CHECKING:
    from msd_ident.batching.job import Job
    from msd_ident.io import SourceOptions

TablesArgument = Annotated[
    list[str], typer.Argument(metavar="TABLE|PATHS…", help="table of msd batch, or records, folders and patterns")
]


@dataclass(frozen=True)
class Batching:
    """The options that say how many records are worked on.

    Attributes:
        scheduler: of a Dask cluster; empty for this machine.
        workers: processes on this machine.
        all_joints: whether every joint of a bag is a record.
        label, covariate: ``NAME=VALUE`` each, as given.
    """

    scheduler: options.SchedulerOption = ""
    workers: options.WorkersOption = 0
    all_joints: options.AllJointsOption = False
    label: options.LabelOption = None
    covariate: options.CovariateOption = None

    def job(self, source: SourceOptions, **given: Any) -> Job:
        """The job for each record.

        Raises:
            UsageError: a label or a covariate that is none.
        """
        from msd_ident.batching.job import Job

        labels = _pairs("--label", self.label)
        covariates = {"temperature": "", "load": "", **_pairs("--covariate", self.covariate)}
        return Job(source=source, labels=labels, covariates=covariates, all_joints=self.all_joints, **given)

    def table(self, paths: Sequence[str], source: SourceOptions, quiet: bool, keep: str = "") -> Any:
        """The table that is named, or that of the records that are named.

        Args:
            paths: one table, or folders, patterns and records.
            source: how records are read.
            quiet: no progress.
            keep: where the table of records is kept and gone on with; empty: nowhere.

        Raises:
            UsageError: tables beside other paths, or an option for records with a table.
            DataError, SetupError: as ``msd batch``.
        """
        from msd_ident.batching import batch, table

        job = self.job(source)
        tables = [path for path in paths if table.is_table(path)]
        if tables and len(paths) > 1:
            raise UsageError(f"{tables[0]} beside other paths; expected one table, or records alone")
        if tables:
            self._check_for_table(source, tables[0])
            return table.read(tables[0])
        with (
            batch.linked(self.scheduler, self.workers) as link,
            progress.records(link.client.dashboard_link, quiet) as tell,
        ):
            return batch.run(paths, job, link, batch.Plan(keep, resume=bool(keep), progress=tell))[0]

    def _check_for_table(self, source: SourceOptions, name: str) -> None:
        """Refuse what says how records are read: a table has their results already."""
        given = [one.name for one in fields(source) if getattr(source, one.name) != one.default]
        given += [option for option in ("all_joints", "label", "covariate") if getattr(self, option)]
        if given:
            raise UsageError(
                f"--{given[0].replace('_', '-')} with the table {name}; expected it for records: a table has their "
                "results already: give it to msd batch"
            )


def here(paths: Iterable[str]) -> list[Path]:
    """Those of the paths that are on this machine and not in an object store."""
    from msd_ident.batching import locations

    return [Path(path) for path in paths if not locations.is_remote(path)]


def read_from(paths: Sequence[str]) -> list[Path]:
    """What the work on a table, or on records, reads on this machine: no result may replace it.

    Raises:
        DataError: a path that leads nowhere, a folder or pattern without any record.
    """
    from msd_ident.batching import locations, table

    tables = [path for path in paths if table.is_table(path)]
    others = [path for path in paths if path not in tables and not locations.is_remote(path)]
    found = here([*tables, *(locations.records(others) if others else ())])
    for path in () if tables else found:
        if not path.exists():
            raise DataError(f"{path} is not there; expected a record, or a folder or pattern of them: check the path")
    return found


def _pairs(option: str, given: Sequence[str] | None) -> dict[str, str]:
    found = {}
    for text in given or ():
        name, sign, value = text.partition("=")
        if not (name and sign and value):
            raise UsageError(f"{option} {text!r}; expected NAME=VALUE")
        found[name] = value
    return found
