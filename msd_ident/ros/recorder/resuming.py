"""A note of the recording in progress, so that a restarted recorder continues in a new bag. Without ROS."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path


@dataclass(frozen=True)
class Interrupted:
    """A recording in progress: its topics, whether all of them, and how it is compressed."""

    topics: tuple[str, ...]
    every: bool
    compression: str


class Notebook:
    """A file beside the bags that is there while its recorder records.

    Args:
        folder: the bags' folder.
        owner: the recorder's full name, so that two recorders share a folder.
    """

    def __init__(self, folder: Path, owner: str) -> None:
        self._path = folder / f".recording{owner.replace('/', '.')}.json"

    def begin(self, recording: Interrupted) -> None:
        """Note what is being recorded; a disk that does not take the note keeps nobody from recording."""
        with suppress(OSError):
            self._path.write_text(json.dumps(asdict(recording)), encoding="utf-8")

    def end(self) -> None:
        """The recording was stopped as it should be."""
        with suppress(OSError):
            self._path.unlink(missing_ok=True)

    def left(self) -> Interrupted | None:
        """What was being recorded when the recorder died; ``None`` when nothing was."""
        try:
            found = json.loads(self._path.read_text(encoding="utf-8"))
            return Interrupted(tuple(map(str, found["topics"])), bool(found["every"]), str(found["compression"]))
        except (OSError, ValueError, KeyError, TypeError):
            return None
