"""Working through paths one by one: progress, results, errors that stop one path and not the others."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from msd_ident.errors import MsdError, SetupError, UsageError

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.data.record import Record
    from msd_ident.io import SourceOptions

Progress = Callable[[str, float], None]


class Result(Protocol):
    """What identify and diagnose return: findings that can be written down."""

    def to_json_dict(self) -> dict[str, Any]:
        """The JSON contract's object, without ``path``."""


@dataclass(frozen=True)
class Output:
    """Where results go.

    Attributes:
        json: file for one JSON object a path, ``-`` for standard output (then nothing else is printed there),
            empty for none.
        quiet: no tables and no progress.
        overwrite: whether a file that exists may be replaced.
    """

    json: str
    quiet: bool
    overwrite: bool

    def check(self) -> None:
        """Refuse before any work what could not be written afterwards.

        Raises:
            UsageError: the file exists and may not be replaced, or its folder does not exist.
        """
        if self.json not in ("", "-"):
            check_target(Path(self.json), self.overwrite)

    @property
    def tables(self) -> bool:
        """Whether tables belong on standard output."""
        return not self.quiet and self.json != "-"


def check_target(path: Path, overwrite: bool) -> None:
    """Raise UsageError when ``path`` exists and may not be replaced, or cannot be created."""
    if path.exists() and not overwrite:
        raise UsageError(f"{path} exists; expected a new name: give another one, or --overwrite to replace it")
    if not path.absolute().parent.is_dir():
        raise UsageError(f"folder {path.absolute().parent} does not exist; expected one to write {path.name} into")


def make_folder(path: Path) -> None:
    """Make the folder, with its parents, where it is not there.

    Raises:
        UsageError: something else has this name.
        SetupError: the disk does not take it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise UsageError(f"{path} is no folder and cannot become one; expected a folder's name") from None
    except OSError as error:
        raise SetupError(f"cannot make {path}: {error.strerror}; expected a writable place") from None


def jsonable(value: Any) -> Any:
    """The same with NaN and infinity as null, which strict JSON has no words for."""
    if isinstance(value, Mapping):
        return {key: jsonable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [jsonable(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


@contextmanager
def progress(quiet: bool) -> Iterator[Progress]:
    """A progress bar on stderr that takes (stage, fraction); nothing where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
    from rich.table import Column

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda stage, fraction: None
        return
    wide = Column(width=38, no_wrap=True, overflow="ellipsis")
    stage = TextColumn("{task.description}", table_column=wide)
    columns = (stage, BarColumn(bar_width=28), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda stage, fraction: bar.update(task, description=stage, completed=fraction)


@dataclass(frozen=True)
class Data:
    """The records of a command: their paths, how they are read, and whether all are one experiment."""

    paths: Sequence[Path]
    source: SourceOptions
    together: bool


@dataclass(frozen=True)
class After:
    """What is done with each result.

    Attributes:
        show: prints it.
        keep: is given each result with its paths.
        tried: is given its JSON, and gives further keys for it.
    """

    show: Callable[[Any, Console], None]
    keep: Callable[[tuple[Path, ...], Any], None] = lambda group, result: None
    tried: Callable[[Mapping[str, Any], Console | None], dict[str, Any]] = lambda result, console: {}


def work(data: Data, output: Output, solve: Callable[[Sequence[Record], Progress], Result], after: After) -> int:
    """Read, solve and show every path, or all together; exit code 0, or 2 when any path failed.

    A path that fails gets its one line on stderr and an object with ``error``; the others go on.
    """
    from rich.console import Console

    output.check()
    groups = [tuple(data.paths)] if data.together else [(path,) for path in data.paths]
    parts = [part for group in groups for part in _parts(group, data.source, data.together)]
    console = Console(highlight=False)
    lines: list[dict[str, Any]] = []
    failed = False
    for group, one in parts:
        name = " + ".join(str(path) for path in group) + _run(one)
        try:
            result = _solved(group, one, output, solve)
        except MsdError as error:
            failed = True
            print(f"msd: {error}" if len(parts) == 1 else f"msd: {name}: {error}", file=sys.stderr)
            lines.append({"path": name, "error": str(error)})
            continue
        found = result.to_json_dict()
        after.keep(group, result)
        if output.tables:
            after.show(result, console)
        line = {"schema": found.pop("schema"), "path": name, **found}
        try:
            line |= after.tried(line, console if output.tables else None)
        except MsdError as error:
            failed = True
            print(f"msd: {error}", file=sys.stderr)
        lines.append(line)
    write(lines, output)
    return 2 if failed else 0


def _parts(
    group: tuple[Path, ...], source: SourceOptions, together: bool
) -> list[tuple[tuple[Path, ...], SourceOptions]]:
    """A group with the options of each of its results: one for each run of a path for ``--run all``."""
    from msd_ident.io import each_run

    if together or source.run != "all":
        return [(group, source)]
    try:
        return [(group, one) for one in each_run(group[0], source)]
    except MsdError:
        return [(group, source)]  # reading it will say what is wrong


def _run(source: SourceOptions) -> str:
    """Which run of a path a result is of, as words behind the path."""
    return f" run {source.run}" if source.run not in ("", "all") else ""


def _solved(
    group: Sequence[Path],
    source: SourceOptions,
    output: Output,
    solve: Callable[[Sequence[Record], Progress], Result],
) -> Result:
    from msd_ident.io import read_all

    with progress(output.quiet) as report:
        report("reading", 0.0)
        return solve([record for path in group for record in read_all(path, source)], report)


def write(lines: Sequence[Mapping[str, Any]], output: Output) -> None:
    """One JSON object a line, to the file or to standard output, as ``output`` says."""
    text = "".join(json.dumps(jsonable(line), ensure_ascii=False, allow_nan=False) + "\n" for line in lines)
    if output.json == "-":
        sys.stdout.write(text)
    elif output.json:
        from msd_ident.report.writing import write_text

        write_text(text, Path(output.json))
