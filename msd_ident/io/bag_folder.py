"""Contents of a rosbag2 folder: its metadata, as far as they can be read, and its files in their order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from msd_ident.errors import DataError
from msd_ident.io import yaml_text
from msd_ident.io.compression import plain_name

#: Endings of files that hold messages.
STORAGE = (".mcap", ".db3")
#: First bytes of an MCAP file, and its last.
MAGIC = b"\x89MCAP0\r\n"


@dataclass(frozen=True)
class Folder:
    """A folder with a bag.

    Attributes:
        paths: of the files with messages, in the order of the recording.
        information: content of metadata.yaml, empty when it is missing or damaged.
        notes: what is missing, one sentence each.
    """

    paths: list[Path]
    information: Mapping[str, Any]
    notes: list[str]


def look_into(folder: Path) -> Folder:
    """Read metadata and file names of a folder.

    Raises:
        DataError: it cannot be read, or holds no file of a bag.
    """
    notes: list[str] = []
    information = _read_metadata(folder / "metadata.yaml", notes)
    return Folder(_storage_paths(folder, information, notes), information, notes)


def unreadable(path: Path, error: OSError) -> DataError:
    """The error to raise for a file that cannot be read.

    Args:
        path: of the file.
        error: what the system said.
    """
    return DataError(f"cannot read {path}: {error.strerror or error}; expected a file that may be read")


def _read_metadata(path: Path, notes: list[str]) -> Mapping[str, Any]:
    """Content of metadata.yaml; a missing or damaged one costs no data, the files describe themselves."""
    try:
        content = yaml_text.load(path.read_text(encoding="utf-8"))
        information = content["rosbag2_bagfile_information"]
        if isinstance(information, Mapping):
            return information
    except FileNotFoundError:
        notes.append("metadata.yaml is missing; the files of the folder were read in the order of their names.")
        return {}
    except (OSError, UnicodeDecodeError, yaml_text.YAMLError, KeyError, TypeError):
        pass
    notes.append("metadata.yaml cannot be read; the files of the folder were read in the order of their names.")
    return {}


def _storage_paths(folder: Path, information: Mapping[str, Any], notes: list[str]) -> list[Path]:
    try:
        present = sorted((path for path in folder.iterdir() if plain_name(path).endswith(STORAGE)), key=_natural)
    except OSError as error:
        raise unreadable(folder, error) from None
    listed = information.get("relative_file_paths")
    named = [folder / Path(str(entry)).name for entry in listed] if isinstance(listed, list) else []
    missing = [path.name for path in named if path not in present]
    if missing:
        notes.append(f"{len(missing)} of {len(named)} files of the bag are missing: {', '.join(missing)}.")
    extra = [path for path in present if path not in named]
    if named and extra:
        notes.append(f"files that metadata.yaml does not name were left out: {', '.join(p.name for p in extra)}.")
    paths = [path for path in named if path in present] if named else present
    if not paths:
        raise DataError(f"{folder} holds no .mcap or .db3 file; expected a rosbag2 folder: check the path")
    return paths


def _natural(path: Path) -> tuple[int, str]:
    """Sort key that puts ``bag_10`` behind ``bag_9``."""
    return len(path.name), path.name
