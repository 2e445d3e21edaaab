"""Tables of rows in parquet files: their schema, and writing so that no row is lost or stored twice.

While a batch runs, rows go into parts beside the table, each written whole under another name and then moved to its
place. At the end the parts become the table, in the same way, and go.
"""

from __future__ import annotations

import errno
import os
import time
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from msd_ident.batching.needs import library
from msd_ident.batching.row import CAUSES, PARAMETERS, PLANT, SCHEMA, Row
from msd_ident.errors import DataError, SetupError, UsageError
from msd_ident.writing import readable, writing_to

if TYPE_CHECKING:
    import pyarrow as pa

#: Rows, and seconds, after which a part is written: what a power cut costs.
PART_ROWS, PART_SECONDS = 500, 5.0
_KEY = b"msd.schema"
#: Columns of words and of numbers; those of other types stand in ``schema``. A further one needs no new version of the
#: schema: it is null in tables from before.
_TEXTS = (
    *("path", "name", "joint", "robot", "day", "sha256", "code", "job", "options", "force_unit", "position_unit"),
    *("verdict", "summary", "page", "worker", "error"),
)
_NUMBERS = (
    *("duration_s", "rate_hz", "peak_force", "amplitude", "temperature", "load", "see", "base_see", "noise_floor"),
    *("left_percent", "missing_force_rms", "heldout_gain_percent", "seconds", "diagnosis_seconds"),
    *(f"base_{name}{end}" for name in PLANT for end in ("", "_std")),
    *(f"{name}{end}" for name in PARAMETERS for end in ("", "_std")),
    *(f"p_{name}" for name in CAUSES),
)


def schema() -> pa.Schema:
    """Columns of a table and their types."""
    pa = library("pyarrow")
    text, number = pa.string(), pa.float64()
    finding = pa.struct([("severity", text), ("code", text), ("sentence", text)])
    cause = pa.struct([("name", text), ("probability", number), ("tied_with", pa.list_(text))])
    fields = [(name, text) for name in _TEXTS] + [("start", pa.timestamp("us", tz="UTC"))]
    fields += [("bytes", pa.int64()), ("samples", pa.int64())] + [(name, number) for name in _NUMBERS]
    fields += [("causes", pa.list_(cause)), ("findings", pa.list_(finding)), ("warnings", pa.list_(text))]
    fields += [("free", pa.list_(text)), ("covariance", pa.list_(number))]
    return pa.schema(fields, metadata={_KEY: SCHEMA.encode()})


def made(rows: Sequence[Row]) -> pa.Table:
    """Rows as a table; a column that a row does not have is null in it, what is no column of ``schema`` is left out."""
    shown = [{name: readable(one) if isinstance(one, str) else one for name, one in row.items()} for row in rows]
    return library("pyarrow").Table.from_pylist(shown, schema=schema())


def is_table(path: str) -> bool:
    """Whether a path names a table of rows, by its ending."""
    return path.lower().rstrip("/").endswith((".parquet", ".parq"))


def read(path: str) -> pa.Table:
    """A table that ``msd batch`` wrote.

    Raises:
        DataError: it is not there, is no table, or has another schema.
    """
    pa, parquet = library("pyarrow"), library("pyarrow.parquet")
    store, place = _store(path)
    try:
        with store.open(place, "rb") as handle:
            found = parquet.read_table(handle)
    except FileNotFoundError:
        raise DataError(f"{path} is not there; expected a table: make it with msd batch --out {path}") from None
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as error:
        raise DataError(f"{path} is no parquet table ({_line(error)}); expected one of msd batch") from None
    except OSError as error:
        raise DataError(f"cannot read {path}: {_line(error)}; expected a table of msd batch") from None
    return _checked(found, path)


def _checked(found: pa.Table, path: str) -> pa.Table:
    stated = (found.schema.metadata or {}).get(_KEY, b"none").decode(errors="replace")
    if stated != SCHEMA:
        raise DataError(
            f"{path} has the schema {stated}; expected {SCHEMA}: make the table again with this version of msd batch"
        )
    wanted = schema()
    missing = [name for name in ("path", "joint", "sha256", "job", "error") if name not in found.schema.names]
    if missing:
        raise DataError(f"{path} lacks the column {missing[0]}; expected all of {SCHEMA}: make the table again")
    pa = library("pyarrow")
    columns = [
        found.column(name).cast(kind) if name in found.schema.names else pa.nulls(found.num_rows, kind)
        for name, kind in zip(wanted.names, wanted.types, strict=True)
    ]
    return pa.Table.from_arrays(columns, schema=wanted)


class Store:
    """A table that is being made.

    Args:
        target: where it is to be; a path, or one in an object store.

    Raises:
        SetupError: the place cannot be reached.
    """

    def __init__(self, target: str) -> None:
        self.target = target
        self._store, self._place = _store(target)
        self._parts = f"{self._place}.parts"
        self._rows: list[Row] = []
        self._written = time.monotonic()

    def stands(self) -> str:
        """What is there already: the table, the parts of a run that was cut off, or nothing."""
        if self._names():
            return f"{self.target}.parts"
        return self.target if self._store.exists(self._place) else ""

    def check_place(self) -> None:
        """Refuse a place on this machine that cannot have the table or its parts, before any work.

        Raises:
            UsageError: its folder is none, or it is a folder itself.
            SetupError: the disk does not take the parts.
        """
        if "://" in self.target:
            return
        place, parts = Path(self._place), Path(self._parts)
        if place.parent.exists() and not place.parent.is_dir():
            raise UsageError(f"{place.parent} is no folder; expected one to write the table {place.name} into")
        if not place.parent.is_dir():
            raise _no_folder(self.target)
        if place.is_dir():
            raise UsageError(f"{self.target} is a folder; expected the name of a table to write")
        with writing_to(Path(f"{self.target}.parts"), "a writable folder beside the table"):
            made_now = not parts.exists()
            parts.mkdir(exist_ok=True)
            trial = parts / f"{uuid.uuid4().hex[:8]}.tmp"
            try:
                trial.touch()
                trial.unlink()
            finally:
                if made_now:
                    parts.rmdir()

    def clear(self) -> None:
        """Forget a run that was cut off."""
        for name in self._names():
            self._store.rm_file(name)

    def earlier(self) -> pa.Table:
        """All rows that are there: of the table, and of the parts of a run that was cut off.

        Raises:
            DataError: one of them is of another schema.
        """
        names = ([self._place] if self._store.exists(self._place) else []) + self._names()
        tables = [read(self._url(name)) for name in names]
        return joined(tables)

    def add(self, rows: Sequence[Row]) -> None:
        """Keep rows; now and then they are written.

        Raises:
            SetupError: the disk does not take them. They are not lost: ``finish`` tries again.
        """
        self._rows += rows
        late = time.monotonic() - self._written > PART_SECONDS
        if self._rows and (late or len(self._rows) >= PART_ROWS):
            self.flush()

    def flush(self) -> None:
        """Write the rows that are kept as a part."""
        if self._rows:
            with _disk(self.target):
                self._store.makedirs(self._parts, exist_ok=True)
            self._write(made(self._rows), f"{self._parts}/{time.time_ns()}-{uuid.uuid4().hex[:8]}.parquet")
            self._rows = []
        self._written = time.monotonic()

    def finish(self, table: pa.Table) -> None:
        """Put the table in its place, and remove the parts that are in it."""
        self._write(table, self._place)
        self._rows = []
        if self._names():
            self._store.rm(self._parts, recursive=True)

    def _names(self) -> list[str]:
        if not self._store.exists(self._parts):
            return []
        return sorted(name for name in self._store.find(self._parts) if name.endswith(".parquet"))

    def _url(self, name: str) -> str:
        return f"{self.target.partition('://')[0]}://{name}" if "://" in self.target else name

    def _write(self, table: pa.Table, place: str) -> None:
        parquet = library("pyarrow.parquet")
        local = "://" not in self.target
        there = f"{place}.{uuid.uuid4().hex[:8]}.tmp" if local else place  # an object appears whole or not at all
        with _disk(self.target):
            try:
                with self._store.open(there, "wb") as handle:
                    parquet.write_table(table, handle, compression="zstd")
                if local:
                    os.replace(there, place)
            except BaseException:
                if local and os.path.exists(there):
                    os.unlink(there)
                raise


def keys(table: pa.Table) -> list[tuple[str, str]]:
    """Path and joint of each row, which identify it."""
    return list(zip(table.column("path").to_pylist(), table.column("joint").to_pylist(), strict=True))


def joined(tables: Sequence[pa.Table]) -> pa.Table:
    """One table of all rows."""
    found: pa.Table = library("pyarrow").concat_tables([*tables, made([])])
    return found


def merged(table: pa.Table, order: Mapping[str, int]) -> pa.Table:
    """One row for each path and joint, the last one of several.

    Args:
        table: rows.
        order: place of each path in the result; rows of other paths come first.
    """
    last = {key: place for place, key in enumerate(keys(table))}
    paths = table.column("path").to_pylist()
    places = sorted(last.values(), key=lambda place: (order.get(paths[place], -1), place))
    return rows_at(table, places)


def rows_at(table: pa.Table, places: Sequence[int]) -> pa.Table:
    """Rows of a table at given places, in the order given."""
    pa = library("pyarrow")
    return table.take(pa.array(places, type=pa.int64()))


def _store(path: str) -> tuple[Any, str]:
    from msd_ident.batching.locations import one_line_errors

    with one_line_errors(path):
        store, place = library("fsspec").core.url_to_fs(path)
    return store, str(place)


@contextmanager
def _disk(target: str) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise _no_folder(target) from None
    except OSError as error:
        full = error.errno == errno.ENOSPC or "No space left" in str(error)
        cure = "free some space" if full else "make it writable"
        raise SetupError(
            f"cannot write {target}: {_line(error)}; finished records are in {target}.parts: {cure}, and go on "
            "with --resume"
        ) from None


def _no_folder(target: str) -> UsageError:
    folder = PurePosixPath(target).parent
    return UsageError(f"folder {folder} does not exist; expected one to write the table into: make it")


def _line(error: Exception) -> str:
    return " ".join((getattr(error, "strerror", "") or str(error)).split())[:200]
