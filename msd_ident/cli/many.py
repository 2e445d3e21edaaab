"""Tables that exist, and tables that are made on the way: what ``msd compare`` and ``msd watch`` begin with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from msd_ident.cli.batch import bar
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.batching.job import Job

TablesArgument = Annotated[
    list[str], typer.Argument(metavar="TABLE|PATHS…", help="table of msd batch, or records, folders and patterns")
]


def table_of(paths: Sequence[str], job: Job, where: tuple[str, int], quiet: bool, keep: str = "") -> Any:
    """The table that is named, or that of the records that are named.

    Args:
        paths: one table, or folders, patterns and records.
        job: how records are read and diagnosed.
        where: scheduler, empty for this machine, and worker processes here.
        quiet: no progress.
        keep: where the table of records is kept and gone on with; empty: nowhere.

    Raises:
        UsageError: tables beside other paths.
        DataError, SetupError: as ``msd batch``.
    """
    from msd_ident.batching import batch, table

    tables = [path for path in paths if table.is_table(path)]
    if tables and len(paths) > 1:
        raise UsageError(f"{tables[0]} beside other paths; expected one table, or records alone")
    if tables:
        return table.read(tables[0])
    with batch.linked(*where) as link, bar(link.client.dashboard_link, quiet) as tell:
        return batch.run(paths, job, link, batch.Plan(keep, resume=bool(keep), progress=tell))[0]
