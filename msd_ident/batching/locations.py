"""Where records lie: folders, patterns and lists, on this machine and in object stores, become single records."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory
from typing import Any

from msd_ident.batching.needs import library
from msd_ident.errors import DataError, SetupError, UsageError
from msd_ident.io.bag_folder import STORAGE
from msd_ident.io.columns import SUFFIXES as TABLES
from msd_ident.io.compression import plain_name

#: Names of files that hold a record.
SUFFIXES = (*STORAGE, *TABLES)
#: What makes a folder a bag.
_METADATA = "metadata.yaml"
_PATTERN = re.compile(r"[*?\[]")


def is_remote(path: str) -> bool:
    """Whether a path names an object store, e.g. ``s3://bucket/folder``."""
    return "://" in path


def records(paths: Iterable[str | os.PathLike[str]]) -> tuple[str, ...]:
    """All records of folders, patterns and single paths, in the order given, each once; local ones as absolute paths.

    A folder is searched with all below it. A bag's folder is one record.

    Raises:
        DataError: a folder or pattern without any record.
        UsageError: nothing was asked for.
        SetupError: an object store that cannot be reached, or whose library is missing.
    """
    asked = [os.fspath(path) for path in paths]
    if not asked:
        raise UsageError("no paths; expected folders, patterns or records, or --list with a file of them")
    found = [record for path in asked for record in _of(path)]
    return tuple(dict.fromkeys(found))


def listed(text: str) -> tuple[str, ...]:
    """Paths of a list, one a line; empty lines and those that begin with # count for nothing."""
    lines = (line.strip() for line in text.splitlines())
    return tuple(line for line in lines if line and not line.startswith("#"))


def _of(path: str) -> Sequence[str]:
    if not path:
        raise UsageError("an empty path; expected a file or folder: check the variable that it comes from, or write .")
    found = _remote(path) if is_remote(path) else _local(path)
    if not found:
        raise DataError(
            f"{path} holds no record; expected bags, or files that end in {', '.join(SUFFIXES)}: check the path"
        )
    return found


def _local(path: str) -> Sequence[str]:
    place = Path(path)
    if place.is_dir():
        return _grouped(os.path.join(base, name) for base, _, names in os.walk(place.absolute()) for name in names)
    if _PATTERN.search(path) and not place.exists():
        from glob import glob

        matches = [Path(found).absolute() for found in sorted(glob(path, recursive=True))]
        return [one for match in matches for one in (_local(str(match)) if match.is_dir() else [str(match)])]
    return [str(place.absolute())]  # one that is not there is a row that says so


def _remote(path: str) -> Sequence[str]:
    with one_line_errors(path):
        store, root = library("fsspec").core.url_to_fs(path)
        protocol = path.partition("://")[0]
        names = store.glob(root) if _PATTERN.search(root) else store.find(root)
        inside = [one for name in names for one in (store.find(name) if _PATTERN.search(root) else [name])]
    if inside == [root]:
        return [path]
    return [f"{protocol}://{name}" for name in _grouped(inside)]


def _grouped(files: Iterable[str]) -> list[str]:
    """Files as records: those of a bag's folder are one."""
    names = sorted(files)
    bags = {str(PurePosixPath(name).parent) for name in names if PurePosixPath(name).name == _METADATA}
    found: dict[str, None] = {}
    for name in names:
        path = PurePosixPath(name)
        if str(path.parent) in bags:
            found[str(path.parent)] = None
        elif _holds_record(path):
            found[name] = None
    return list(found)


def _holds_record(path: PurePosixPath) -> bool:
    """Whether a file is a record by its name; a bag's file may be compressed as a whole."""
    if path.name.startswith("."):
        return False
    plain = PurePosixPath(plain_name(Path(path)))
    return path.suffix.lower() in SUFFIXES or plain.suffix.lower() in STORAGE


@contextmanager
def local(path: str) -> Iterator[Path]:
    """A record as a path on this machine: itself, or a copy that is there for as long as it is used.

    Raises:
        DataError: it cannot be had.
        SetupError: the object store cannot be reached, or its library is missing.
    """
    if not is_remote(path):
        yield Path(path)
        return
    with TemporaryDirectory(prefix="msd_") as folder:
        copy = Path(folder) / PurePosixPath(path).name
        with one_line_errors(path):
            store, root = library("fsspec").core.url_to_fs(path)
            if store.isfile(root):
                store.get_file(root, str(copy))
            else:
                _fetch(store, root, copy)
        yield copy


def _fetch(store: Any, root: str, copy: Path) -> None:
    names = store.find(root)
    if not names:
        raise FileNotFoundError(root)
    for name in names:
        target = copy / PurePosixPath(name).relative_to(PurePosixPath(root))
        target.parent.mkdir(parents=True, exist_ok=True)
        store.get_file(name, str(target))


@contextmanager
def one_line_errors(path: str) -> Iterator[None]:
    """What an object store raises, in one line."""
    try:
        yield
    except FileNotFoundError:
        raise DataError(f"{path} is not there; expected a record or a folder of records: check the name") from None
    except PermissionError as error:
        raise DataError(f"{path} may not be read ({error}); expected credentials that may: check them") from None
    except ImportError as error:
        raise SetupError(f"{path}: {error}; expected the store's library: pip install it") from None
    except ValueError as error:
        raise UsageError(f"{path}: {error}; expected a store that fsspec knows, e.g. s3://bucket/folder") from None
    except Exception as error:
        if type(error).__module__.startswith("msd_ident"):
            raise
        raise SetupError(f"{path}: {error}; expected an object store that answers: check its address") from None
