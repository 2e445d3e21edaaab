"""CrashSafeFile: a file that is complete at every instant, even if the process that writes it is killed.

An MCAP file ends with its index, so a file that is being appended to is not a readable bag. So there are two copies.
One is complete and stands under the file's name. The other is hidden; it is brought up to date and gets the new data
and an index of all data. Then it takes over the name in one step, and the copies change roles. While the file is
written, this costs its size on the disk a second time.
"""

from __future__ import annotations

import errno
import fcntl
import os
from contextlib import suppress
from pathlib import Path

#: Ending of hidden copies and drafts, which readers leave alone.
PART = ".part"
_BLOCK = 1 << 20
#: What file systems answer that know no second name for a file (FAT, exFAT, some network drives).
_NO_LINKS = (errno.EPERM, errno.EOPNOTSUPP, errno.ENOSYS, errno.EMLINK, errno.EXDEV)


class CrashSafeFile:
    """Bytes that only grow, and an end that is replaced each time.

    Where the file system has no hard links there is one copy, written in place: a reader that comes in the
    microseconds of a write then meets a file without its end.

    Args:
        path: name of the file; must not exist.

    Raises:
        OSError: the file exists, or the disk does not take it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._shown = False
        self._ends = [0, 0]
        self._back = 0
        self._waiting = b""
        self._names = [path.with_name(f".{path.name}.{letter}{PART}") for letter in "ab"]
        if os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, "the file exists", str(path))
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
        self._files = [os.open(self._names[0], flags, 0o644)]
        try:
            fcntl.flock(self._files[0], fcntl.LOCK_EX | fcntl.LOCK_NB)
            self._files.append(os.open(self._names[1], flags, 0o644))
            self._twins = _has_links(self._names[0])
        except BaseException:
            self.close()
            raise
        if not self._twins:
            os.replace(self._names[0], path)

    @property
    def size(self) -> int:
        """Bytes that were appended, the end left out."""
        return max(self._ends) + len(self._waiting)

    def append(self, piece: bytes | bytearray) -> None:
        """Append bytes; they become visible with the next ``show``."""
        if not self._twins:
            self._waiting += piece
            return
        self._catch_up()
        _write(self._files[self._back], piece, self._ends[self._back])
        self._ends[self._back] += len(piece)

    def show(self, end: bytes) -> None:
        """Make all appended bytes visible, followed by ``end``, once they are on the disk."""
        if self._twins:
            self._catch_up()
        back = self._files[self._back]
        _write(back, self._waiting + end, self._ends[self._back])
        self._ends[self._back] += len(self._waiting)
        self._waiting = b""
        os.ftruncate(back, self._ends[self._back] + len(end))
        os.fsync(back)
        if self._twins:
            self._take_name()
            self._back = 1 - self._back

    def close(self) -> None:
        """Keep what is visible and remove the hidden copies; a second call does nothing."""
        for file in self._files:
            with suppress(OSError):
                os.close(file)
        self._files = []
        for name in self._names:
            with suppress(OSError):
                name.unlink()

    def _take_name(self) -> None:
        """The name for the copy that is complete now; the first time only where nothing stands under it."""
        name = self._names[self._back]
        if not self._shown:
            os.link(name, self.path)
        else:
            link = self.path.with_name(f".{self.path.name}{PART}")
            link.unlink(missing_ok=True)
            os.link(name, link)
            os.replace(link, self.path)
        self._shown = True

    def _catch_up(self) -> None:
        """What the copy in front has and this one not."""
        front, back = 1 - self._back, self._back
        while self._ends[back] < self._ends[front]:
            wanted = min(_BLOCK, self._ends[front] - self._ends[back])
            block = os.pread(self._files[front], wanted, self._ends[back])
            if not block:
                raise OSError(errno.EIO, "the file was cut off by something else", str(self.path))
            _write(self._files[back], block, self._ends[back])
            self._ends[back] += len(block)


def sync_folder(folder: Path) -> None:
    """Names of a folder on the disk, not only its files' contents."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # some network drives have no such thing
            os.fsync(handle)
    finally:
        os.close(handle)


def replace_text(path: Path, text: str) -> None:
    """Replace a text file in one step, so that no reader ever meets half of it, and see it onto the disk."""
    draft = path.with_name(f".{path.name}{PART}")
    with draft.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    os.replace(draft, path)
    sync_folder(path.parent)


def is_being_written(path: Path) -> bool:
    """Whether a process holds this file, or the first of its copies, open for writing."""
    return any(_is_locked(name) for name in (path.with_name(f".{path.name}.a{PART}"), path))


def _is_locked(name: Path) -> bool:
    try:
        handle = os.open(name, os.O_RDWR)
    except OSError:  # not there, or not ours to write
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(handle)
    return False


def copies_of(path: Path) -> list[Path]:
    """Hidden copies that a writer of this file left behind."""
    return [name for letter in "ab" if (name := path.with_name(f".{path.name}.{letter}{PART}")).exists()]


def _has_links(name: Path) -> bool:
    other = name.with_name(f"{name.name}{PART}")
    try:
        os.link(name, other)
    except OSError as error:
        if error.errno in _NO_LINKS:
            return False
        raise
    other.unlink()
    return True


def _write(file: int, data: bytes | bytearray, offset: int) -> None:
    view = memoryview(data)
    while view:
        written = os.pwrite(file, view, offset)
        view, offset = view[written:], offset + written
