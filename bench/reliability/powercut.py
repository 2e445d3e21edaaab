"""A power cut after every system call of a recorder, on a disk that keeps only what was synced.

The worst disk that POSIX allows, or nearly: of a file's contents only what ``fsync`` was called for is there. Names are
tried both ways, as they are and as they were when their folder was last synced.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest import mock

from msd_ident.io import crash_safe_file

_CALLS = ("pwrite", "ftruncate", "fsync", "link", "replace", "unlink")


class Disk:
    """What would be left of a folder.

    Args:
        folder: that is watched.
        image: folder that gets the remains, made anew for each look.
        look: called with the image after every call.
    """

    def __init__(self, folder: Path, image: Path, look: Callable[[Path], None]) -> None:
        self._folder, self._image, self._look = folder, image, look
        self._synced: dict[int, bytes] = {}
        self._names: dict[str, int] = {}
        self._looking = False
        self._held: list[int] = []
        self.cuts = 0

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Look after each call of the writer."""
        patches = [mock.patch.object(crash_safe_file.os, name, self._watch(getattr(os, name))) for name in _CALLS]
        for patch in patches:
            patch.start()
        try:
            yield
        finally:
            for patch in patches:
                patch.stop()
            for handle in self._held:
                os.close(handle)

    def _watch(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def watched(*arguments: Any, **options: Any) -> Any:
            result = call(*arguments, **options)
            if not self._looking:
                self._looking = True
                if call.__name__ == "fsync":
                    self._sync(arguments[0])
                self._cut()
                self._looking = False
            return result

        return watched

    def _sync(self, handle: int) -> None:
        if os.path.isdir(f"/proc/self/fd/{handle}"):
            self._names = self._present()
        else:
            self._held.append(os.dup(handle))  # so that its number goes to no other file
            self._synced[os.fstat(handle).st_ino] = Path(f"/proc/self/fd/{handle}").read_bytes()

    def _present(self) -> dict[str, int]:
        return {path.name: path.stat().st_ino for path in self._folder.iterdir() if not path.name.startswith(".")}

    def _cut(self) -> None:
        for names in (self._present(), self._names):
            if "metadata.yaml" in names:
                shutil.rmtree(self._image, ignore_errors=True)
                self._image.mkdir()
                for name, inode in names.items():
                    (self._image / name).write_bytes(self._synced.get(inode, b""))
                self._look(self._image)
                self.cuts += 1
