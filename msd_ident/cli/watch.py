"""``msd watch``: parameters and causes over days, change points, and an alarm whose false-alarm rate is stated."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any

from msd_ident.cli import groups, many_records, options, results
from msd_ident.errors import DataError, UsageError

if TYPE_CHECKING:
    from msd_ident.monitoring.watching import Options, Watch


#: Where the results of records are kept if nothing else is said.
KEPT = "msd_watch.parquet"

KeepOption = Annotated[
    str | None,
    options.batch_option(
        "--table",
        metavar="TABLE.parquet",
        help=f"table that keeps the results of records in folders; default: {KEPT}",
    ),
]
FalseAlarmsOption = Annotated[
    float, options.model_option("--false-alarms", metavar="RATE", help="accepted false alarms per robot and year")
]
PerYearOption = Annotated[
    float,
    options.model_option(
        "--records-per-year", help="records per robot and year; 0: from their time stamps, else daily"
    ),
]
CheckOption = Annotated[bool, options.output_option("--check", help="exit with code 1 after an alarm")]
FollowOption = Annotated[
    float, options.batch_option("--follow", metavar="SECONDS", help="repeat with this period until Ctrl-C")
]


@groups.grouped("json", "report", "quiet", "overwrite")
def watch(
    paths: many_records.TablesArgument,
    source: groups.Source,
    keep: KeepOption = None,
    false_alarms: FalseAlarmsOption = 1.0,
    per_year: PerYearOption = 0.0,
    check: CheckOption = False,
    follow: FollowOption = 0.0,
    *,
    batching: many_records.Batching,
    output: results.Output,
) -> int:
    """Find changes of parameters over days, and raise an alarm with a known false-alarm rate."""
    from msd_ident.batching.table import is_table
    from msd_ident.monitoring.watching import YEAR, Options

    settings = Options(false_alarms, per_year)
    if not 0.0 <= follow <= YEAR:
        raise UsageError(f"--follow takes seconds above 0, not {follow:g}; expected a period of at most a year")
    if follow and output.json == "-":
        raise UsageError("--follow with --json -; expected a file: each look replaces the results of the last one")
    tables = [path for path in paths if is_table(path)]
    if tables and keep is not None:
        raise UsageError(f"--table beside {tables[0]}, which is one already; expected records: leave --table away")
    kept = KEPT if keep is None else keep
    output.check(*many_records.read_from(paths), written=many_records.here(() if tables else (kept,)))

    def look() -> list[Watch]:
        table = batching.table(paths, source, output.quiet, kept)
        return _watch(table, settings, output, ", ".join(paths))

    found = _repeat(look, follow) if follow else look()
    return 1 if check and any(one.alarms for one in found) else 0


def _watch(table: Any, settings: Options, output: results.Output, source: str) -> list[Watch]:
    """Watch all robots of a table, and print and write what was found."""
    from msd_ident.monitoring import rows, watching

    found, few = [], []
    for name, samples in rows.by_robot(table).items():
        try:
            found.append(watching.watch(name, samples, settings))
        except DataError as error:
            few.append(error)
    if not found:
        raise few[0]
    results.write([one.to_json_dict() for one in found], output)
    if output.tables:
        for one in found:
            print(f"{one.name}: {one.sentence}")
        for missing in few:
            print(f"  left out: {missing}")
    if output.report is not None:
        from msd_ident.report import watch_page

        watch_page.save_watches(found, output.report, source)
    return found


def _repeat(look: Callable[[], list[Watch]], period: float) -> list[Watch]:
    """Look until an interrupt; the last result."""
    found: list[Watch] = []
    try:
        while True:
            found = look()
            time.sleep(period)
    except KeyboardInterrupt:
        return found
