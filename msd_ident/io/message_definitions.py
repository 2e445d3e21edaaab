"""Definitions of message types: from the bag, from rosbags' Jazzy set, or from installed packages."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.base import TypesysError
from rosbags.typesys.store import Typestore


def share_folders() -> tuple[Path, ...]:
    """Folders that hold ``<package>/msg/<Name>.msg``: the sourced ROS installation, this environment, a checkout."""
    prefixes = [Path(entry) for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    checkout = Path(__file__).parents[2]
    return (*(prefix / "share" for prefix in (*prefixes, Path(sys.prefix))), checkout)


class Definitions:
    """Looks up the text and the hash of any message type, dependencies included.

    Args:
        folders: where ``<package>/msg/<Name>.msg`` is looked for, first hit wins.
    """

    def __init__(self, folders: Sequence[Path] | None = None) -> None:
        self._folders = tuple(share_folders() if folders is None else folders)
        self._store: Typestore = get_typestore(Stores.ROS2_JAZZY)

    def text(self, type_name: str) -> str:
        """Definition of the type and of all types in it (``ros2msg``); empty when it is not found."""
        if not self._known(type_name):
            return ""
        return str(self._store.generate_msgdef(type_name, ros_version=2)[0])

    def type_hash(self, type_name: str) -> str:
        """RIHS01 hash of the type; empty when the definition is not found."""
        return str(self._store.hash_rihs01(type_name)) if self._known(type_name) else ""

    def _known(self, type_name: str) -> bool:
        if type_name in self._store.fielddefs:
            return True
        found = self._installed(type_name, {})
        if found:
            self._store.register(found)
        return bool(found)

    def _installed(self, type_name: str, found: dict[str, Any]) -> dict[str, Any]:
        """Parsed definition of the type and of those in it that the store lacks; empty when one is missing."""
        text = self._read(type_name)
        if text is None:
            return {}
        try:
            found.update(get_types_from_msg(text, type_name))
        except TypesysError:
            return {}
        for dependency in dependencies(found[type_name][1]):
            unknown = dependency not in self._store.fielddefs and dependency not in found
            if unknown and not self._installed(dependency, found):
                return {}
        return found

    def _read(self, type_name: str) -> str | None:
        parts = type_name.split("/")
        if len(parts) != 3 or parts[1] != "msg":
            return None
        for folder in self._folders:
            path = folder / parts[0] / "msg" / f"{parts[2]}.msg"
            if path.is_file():
                return path.read_text(encoding="utf-8")
        return None


def dependencies(fields: Iterable[Any]) -> list[str]:
    """Names of the message types that a parsed definition refers to."""
    names = []
    for _, description in fields:
        kind, detail = description
        if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            kind, detail = detail[0]
        if kind == Nodetype.NAME:
            names.append(str(detail))
    return names
