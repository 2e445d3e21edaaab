"""Where results go, and the work on several paths: an error stops one path and not the others."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, cast

from msd_ident.cli import options
from msd_ident.errors import MsdError, UsageError
from msd_ident.writing import readable, write_text, writing_to

if TYPE_CHECKING:
    from rich.console import Console

#: Keys of an object that says why a path has no result.
_REFUSAL = {"schema", "path", "error"}


@dataclass(frozen=True)
class Output:
    """Where results go.

    Attributes:
        json: file for one JSON object a path, ``-`` for standard output (then nothing else is printed there),
            empty for none.
        report, markdown, figures: page, summary, and folder of figures; ``None`` for none.
        quiet: no tables and no progress.
        overwrite: whether a file that exists may be replaced.
    """

    json: options.JsonOption = ""
    report: options.ReportOption = None
    markdown: options.MarkdownOption = None
    figures: options.FiguresOption = None
    quiet: options.QuietOption = False
    overwrite: options.OverwriteOption = False

    def check(self, *read: Path, written: Sequence[Path] = ()) -> None:
        """Refuse before any work what could not be written afterwards; make the folder of the figures.

        Args:
            read: files and folders that the work reads, which nothing may replace.
            written: further files that the command writes; who gives them checks whether they exist.

        Raises:
            UsageError: a file exists and may not be replaced, or its folder does not exist; it is one of those that are
                read, or two results go to one file.
            SetupError: the disk does not take the folder.
        """
        json = None if self.json in ("", "-") else Path(self.json)
        check_apart([path for path in (json, self.report, self.markdown, *written) if path is not None], read)
        check_targets(self.overwrite, self.report, self.markdown)
        if json is not None:
            check_targets(self.overwrite or _holds_refusals_alone(json), json)
        if self.figures is not None:
            make_folder(self.figures)

    @property
    def tables(self) -> bool:
        """Whether tables belong on standard output."""
        return not self.quiet and self.json != "-"


class _Lasting:
    """Standard output whose reader may leave, as ``| head`` does: the rest goes nowhere, and the work goes on."""

    def write(self, text: str) -> int:
        try:
            return sys.stdout.write(text)
        except BrokenPipeError:
            return self._left()

    def flush(self) -> None:
        try:
            sys.stdout.flush()
        except BrokenPipeError:
            self._left()

    def _left(self) -> int:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())  # also for what is still in the buffer at the end of the process
        os.close(nowhere)
        return 0

    def __getattr__(self, name: str) -> Any:
        return getattr(sys.stdout, name)


def console() -> Console:
    """A console on standard output, for commands that write files too: they are written although nobody reads on."""
    from rich.console import Console

    return Console(highlight=False, file=cast("IO[str]", _Lasting()))


def check_targets(overwrite: bool, *paths: Path | None) -> None:
    """Raise UsageError when a path exists and may not be replaced, or cannot be created; ``None`` is not written."""
    for path in filter(None, paths):
        if path.exists() and not overwrite:
            raise UsageError(f"{path} exists; expected a new name: give another one, or --overwrite to replace it")
        if path.is_dir():
            raise UsageError(f"{path} is a folder; expected a file to write: give a name in it")
        if not path.absolute().parent.is_dir():
            raise UsageError(
                f"folder {path.absolute().parent} does not exist; expected one to write {path.name} into: make it"
            )


def check_apart(written: Sequence[Path], read: Sequence[Path] = ()) -> None:
    """Raise UsageError where two results go to one file, or one goes where a measurement or a model is read."""
    places = [path.resolve() for path in written]
    sources = {path.resolve() for path in read} if written else set()  # a batch may read very many
    for path, place in zip(written, places, strict=True):
        if places.count(place) > 1:
            raise UsageError(f"two results go to {path}; expected a file for each: give one of them another name")
        if place in sources or (place.parent in sources and place.exists() and _is_of_a_bag(place)):
            raise UsageError(
                f"{path} is read, and a result would replace it; expected another file: give the result a new name"
            )


def _is_of_a_bag(path: Path) -> bool:
    """Whether a file in a bag's folder belongs to the bag; a result may stand beside these."""
    from msd_ident.io.bag_folder import STORAGE
    from msd_ident.io.compression import plain_name

    return path.name == "metadata.yaml" or plain_name(path).endswith(STORAGE)


def _holds_refusals_alone(path: Path) -> bool:
    """Whether a file is what a run wrote that gave no result: its objects say why, and nothing is lost with them."""
    if not path.is_file():
        return False  # a device may never end
    try:
        found = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    except (OSError, ValueError):
        return False
    return bool(found) and all(isinstance(one, dict) and "error" in one and set(one) <= _REFUSAL for one in found)


def make_folder(path: Path) -> None:
    """Make the folder, with its parents, where it is not there.

    Raises:
        UsageError: something else has this name.
        SetupError: the disk does not take it.
    """
    with writing_to(path, doing="make"):
        try:
            path.mkdir(parents=True, exist_ok=True)
        except (FileExistsError, NotADirectoryError):
            raise UsageError(f"{path} is no folder and cannot become one; expected a folder's name") from None


def jsonable(value: Any) -> Any:
    """The same with NaN and infinity as null, which strict JSON has no words for."""
    if isinstance(value, Mapping):
        return {key: jsonable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [jsonable(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def write(lines: Sequence[Mapping[str, Any]], output: Output) -> None:
    """One JSON object a line, to the file or to standard output, as ``output`` says."""
    # Escapes of a terminal that is not of Unicode are none of JSON.
    plain = output.json == "-" and "utf" not in (sys.stdout.encoding or "utf-8").lower()
    text = "".join(readable(json.dumps(jsonable(line), ensure_ascii=plain, allow_nan=False)) + "\n" for line in lines)
    if output.json == "-":
        lasting = _Lasting()
        lasting.write(text)
        lasting.flush()
    elif output.json:
        write_text(text, Path(output.json))


def each_path(paths: Sequence[Path], output: Output, handle: Callable[[Path], Mapping[str, Any]]) -> int:
    """Write the JSON object of every path; exit code 0, or 2 when any path failed.

    A path that fails gets its one line on stderr and an object with ``error``; the others go on.
    """
    output.check(*paths)
    lines, failed = handled(paths, handle)
    write(lines, output)
    return 2 if failed else 0


def handled(paths: Iterable[Path], handle: Callable[[Path], Mapping[str, Any]]) -> tuple[list[Mapping[str, Any]], bool]:
    """The JSON object of every path, and whether any failed: such a path gets its one line on stderr, and ``error``."""
    lines: list[Mapping[str, Any]] = []
    failed = False
    for path in paths:
        try:
            lines.append(handle(path))
        except MsdError as error:
            failed = True
            print(f"msd: {error}", file=sys.stderr)
            lines.append({"path": str(path), "error": str(error)})
    return lines, failed
