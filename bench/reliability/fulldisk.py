"""A recording onto a small file system of its own that becomes full: what is kept, lost and reported."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from bench.reliability.kills import TOPIC, TYPE, message
from msd_ident.io import repair
from msd_ident.ros.recorder.recording import Numbered, QueueLimits, Recording

#: Mounts a disk where it is told to, in a name space of its own, and leaves with it.
_MOUNT = 'mount -t tmpfs -o size="$1" none "$2" && shift 2 && exec "$@"'


def can_mount() -> bool:
    """Whether this user may have a file system of his own."""
    tried = subprocess.run(
        ["unshare", "-rm", "sh", "-c", _MOUNT, "sh", "64k", "/mnt", "true"], capture_output=True, check=False
    )
    return tried.returncode == 0


def fill(folder: Path, kilobytes: int, seed: int) -> dict[str, Any]:
    """Record onto a disk of this size until it is full; what came of it.

    Raises:
        subprocess.CalledProcessError: the recording did not end as it should; its words are in ``stderr``.
    """
    own = [sys.executable, "-m", "bench.reliability.fulldisk", str(folder), str(seed)]
    command = ["unshare", "-rm", "sh", "-c", _MOUNT, "sh", f"{kilobytes}k", str(folder), *own]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=100)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def _fill(folder: Path, seed: int) -> dict[str, Any]:
    """In the name space of the disk: messages that no compression makes smaller, until the recording fails."""
    import random

    noise = random.Random(seed)
    recording = Recording(folder / "bag", "zstd", limits=QueueLimits(sync_seconds=0.02))
    recording.add_topic(TOPIC, TYPE, [])
    sent = 0
    while not recording.summary.error:
        recording.put(TOPIC, message(sent) + noise.randbytes(noise.randrange(200)), sent + 1, sent + 1, Numbered(sent))
        sent += 1
        time.sleep(0.0002)
    summary = recording.close()
    kept = _numbers(folder / "bag")
    names = sorted(path.name for path in (folder / "bag").iterdir())
    return {"sent": sent, "kept": kept, "error": summary.error, "lost": summary.lost, "files": names}


def _numbers(folder: Path) -> int:
    """How many messages each reader finds, all of them those that were sent first.

    Raises:
        AssertionError: they find something else.
    """
    from bench.reliability.readers import READERS

    for name, reader in READERS.items():
        found = [raw[:12] for raw in reader(folder)]
        if found != [message(number) for number in range(len(found))]:
            raise AssertionError(f"{name} found other messages than were written")
    if repair(folder).changed:
        raise AssertionError("the recording left something to repair")
    return len(found)


if __name__ == "__main__":
    print(json.dumps(_fill(Path(sys.argv[1]), int(sys.argv[2]))))
