"""Faults of a batch: killed workers and schedulers, a removed record, a full disk. No row may be lost or duplicated."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from bench.batch.cluster import Cluster
from bench.batch.records import make
from msd_ident.batching import table

#: Mounts a disk of its own in a name space of its own, and leaves with it.
_MOUNT = 'mount -t tmpfs -o size="$1" none "$2" && shift 2 && exec "$@"'
_MSD = str(Path(sys.executable).parent / "msd")


def rows_of(out: Path, paths: Sequence[Path]) -> dict[str, Any]:
    """Rows of a table that are missing, double, or errors."""
    found = table.read(str(out)).to_pylist()
    count = Counter((row["path"], row["joint"]) for row in found)
    return {
        "rows": len(found),
        "lost": sum(str(path) not in {row["path"] for row in found} for path in paths),
        "doubled": sum(n - 1 for n in count.values()),
        "errors": sorted({row["error"] for row in found if row["error"]}),
    }


def killed(folder: Path, count: int, kills: int, restarts: int, seed: int) -> dict[str, Any]:
    """A batch at a scheduler of its own, whose workers and which itself are killed at random times."""
    lots, paths = random.Random(seed), make(folder / "records", count)
    out = folder / "killed.parquet"
    with Cluster(2, folder / "logs") as cluster:
        command = [
            _MSD,
            "batch",
            str(folder / "records"),
            "--scheduler",
            cluster.address,
            "--out",
            str(out),
            "--overwrite",
        ]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        faults: list[Callable[[], None]] = [lambda: cluster.kill_worker(lots)] * kills
        faults += [cluster.kill_scheduler] * restarts
        lots.shuffle(faults)
        began, done = time.monotonic(), 0
        for fault in faults:
            time.sleep(lots.uniform(2.0, 8.0))
            if process.poll() is not None:
                break
            fault()
            done += 1
        paths[-1].rename(paths[-1].with_suffix(".gone"))  # meanwhile somebody tidies up
        _, said = process.communicate(timeout=3600)
        paths[-1].with_suffix(".gone").rename(paths[-1])
    lines = said.splitlines()
    return {
        "exit": process.returncode, "faults": done, "seconds": time.monotonic() - began, **rows_of(out, paths),
        "unasked words": [line for line in lines if " records, " not in line and "dashboard" not in line],
    }  # fmt: skip


def interrupted(folder: Path, count: int, times: int, seed: int) -> dict[str, Any]:
    """A batch on this machine that is killed several times and gone on with; how many records were done twice."""
    lots, paths, out = random.Random(seed), make(folder / "records", count), folder / "interrupted.parquet"
    command = [_MSD, "batch", str(folder / "records"), "--out", str(out), "--resume"]
    began = time.monotonic()
    for _ in range(times):
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        time.sleep(lots.uniform(10.0, 25.0))
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    again = subprocess.run(command, capture_output=True, text=True, check=False)
    return {
        "exit": done.returncode, "seconds": time.monotonic() - began, **rows_of(out, paths),
        "words": done.stdout.strip(), "once more": again.stdout.strip(),
    }  # fmt: skip


def full_disk(folder: Path, count: int) -> dict[str, Any]:
    """A batch onto a disk that is full, and gone on with when there is room."""
    paths, place = make(folder / "records", count), folder / "disk"
    place.mkdir(exist_ok=True)
    own = [sys.executable, "-m", "bench.batch.faults", str(folder / "records"), str(place)]
    command = ["unshare", "-rm", "sh", "-c", _MOUNT, "sh", "8m", str(place), *own]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    kept = set(map(tuple, found.pop("keys")))
    lost = sum((str(path), "") not in kept for path in paths)
    return {**found, "lost": lost, "doubled": found["rows"] - len(kept)}


def _on_small_disk(records: Path, place: Path) -> dict[str, Any]:
    """In the name space of the disk: fill it, run, make room, go on."""
    filler = place / "filler"
    with filler.open("wb", buffering=0) as handle, suppress(OSError):
        while handle.write(b"\0" * 1024):
            pass
    command = [_MSD, "batch", str(records), "--out", str(place / "table.parquet"), "--resume"]
    first = subprocess.run(command, capture_output=True, text=True, check=False)
    filler.unlink()
    second = subprocess.run(command, capture_output=True, text=True, check=False)
    keys = table.keys(table.read(str(place / "table.parquet")))
    last = (first.stderr.splitlines() or [""])[-1]
    return {
        "full": [first.returncode, last],
        "then": [second.returncode, second.stdout.strip()],
        "rows": len(keys),
        "keys": keys,
    }


if __name__ == "__main__":
    print(json.dumps(_on_small_disk(Path(sys.argv[1]), Path(sys.argv[2]))))
