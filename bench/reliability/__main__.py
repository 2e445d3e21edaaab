"""Bags and data under faults, ``python -m bench.reliability [PART…]``: each part writes its rows into
docs/reliability.md.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

from bench.reliability import cuts, datafaults, estimates, fulldisk, kills, mutations
from bench.reliability.page import Row, put
from bench.reliability.powercut import Disk
from msd_ident.io import BagWriter
from msd_ident.ros.recorder.recording import QueueLimits


def killed(root: Path, seed: int) -> Iterator[Row]:
    """Recorders killed at random instants."""
    found = []
    for batch in range(10):
        seeds = range(seed + 5 * batch, seed + 5 * batch + 5)
        found += kills.kill_writers(root / str(batch), seeds, 4.0, QueueLimits())
    yield Row("recording killed with `kill -9`, 0 to 4 s after it began", len(found), _readers(found))
    yield Row("folder copied during the recording", len(found), "every copy opened in msd, rosbags and mcap")


def recorders(root: Path, seed: int) -> Iterator[Row]:
    """Recorder nodes killed at random instants."""
    from bench.reliability.node_kills import kill_nodes

    found = list(kill_nodes(root, range(seed, seed + 8), 4.0))
    yield Row("recorder node (a process of its own) killed with `kill -9`", len(found), _readers(found))


def _readers(found: list[kills.Found]) -> str:
    worst = max(one.lost_seconds for one in found)
    return (
        "every bag opened in msd, rosbags and mcap with the same messages, before and after `msd repair`; at most "
        f"{worst:.2f} s missing at the end"
    )


def power(root: Path, seed: int) -> Iterator[Row]:
    """Power cuts after each system call of a recorder."""
    kept = 0

    def look(image: Path) -> None:
        if kills.check(image, 0, "after a power cut").messages < kept:
            raise AssertionError("what was synced is not there")

    disk = Disk(root / "bag", root / "image", look)
    with disk.watched():
        writer = BagWriter(root / "bag", "none", split_bytes=10_000)
        writer.add_topic(kills.TOPIC, kills.TYPE)
        for number in range(1000):
            writer.write(kills.TOPIC, kills.message(number), number + 1)
            if number % 150 == 99:
                writer.flush()
                kept = number + 1
        writer.close()
    yield Row(
        "power cut after each system call (simulated: a disk that keeps only what was synced)",
        disk.cuts,
        "every remaining folder opened in msd, rosbags and mcap, with all synced messages",
    )


def full(root: Path, seed: int) -> Iterator[Row]:
    """Disks that become full."""
    sizes = [64, 100, 150, 200, 300, 500, 700, 1000, 1500, 2000]
    for size in sizes:
        folder = root / str(size)
        folder.mkdir()
        found = fulldisk.fill(folder, size, seed + size)
        if found["sent"] != found["kept"] + found["lost"] or "No space left" not in found["error"]:
            raise AssertionError(f"{size} kB: {found}")
    yield Row(
        "disk full (a file system of 64 kB to 2 MB)",
        len(sizes),
        "recording stopped with a one-line error; bag closed, opened in msd, rosbags and mcap; kept + lost = sent "
        "messages",
    )


def cut(root: Path, seed: int) -> Iterator[Row]:
    """Bags cut off at random bytes and at the borders of chunks."""
    for compression in ("zstd", "lz4", "none"):
        folder = root / compression
        folder.mkdir()
        whole = cuts.make(folder, compression)  # type: ignore[arg-type]
        found = list(cuts.cuts(whole, 500, seed, folder))
        yield Row(
            f"file truncated at 500 random bytes, and at each of {len(whole.chunks)} ends of chunks and one byte "
            f"beside them ({compression})",
            len(found),
            "all messages of complete chunks recovered, no wrong message; repair lost none of them",
        )


def damaged(root: Path, seed: int) -> Iterator[Row]:
    """Files with damage of every kind."""
    for kind, count in zip(mutations.KINDS, (1000, 1000, 500, 1000, 500), strict=True):
        folder = root / kind.name.replace(" ", "_")
        folder.mkdir()
        found = mutations.attack(kind, folder, count, seed)
        if found.faults:
            raise AssertionError("\n".join(found.faults))
        said = ", ".join(f"{number} {word}" for word, number in sorted(found.counts.items()))
        right = "; no wrong message" if "with checksums" in kind.name else ""
        yield Row(
            f"{kind.name}: bits, lengths, opcodes, stamps, names and schemas changed, pieces removed and repeated",
            count,
            f"{said}, each error in one line{right}; longest {found.longest:.1f} s, memory below 1 GB",
        )


def data(root: Path, seed: int) -> Iterator[Row]:
    """Estimates from bad data."""
    for fault in datafaults.FAULTS:
        found = [estimates.judge(fault, number) for number in range(seed, seed + 12)]
        counts = Counter(one.outcome for one in found)
        if counts["fooled"]:
            raise AssertionError(f"{fault.name}: {[one for one in found if one.outcome == 'fooled']}")
        yield Row(fault.name, len(found), f"{counts['right']} right, {counts['doubted']} in doubt, 0 wrong unnoticed")


PARTS: dict[str, Callable[[Path, int], Iterator[Row]]] = {
    one.__name__: one for one in (killed, recorders, power, full, cut, damaged, data)
}


def main() -> int:
    """Run the parts; a fault that is not handled ends with a traceback that names it, and exit code 1."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}; none: all")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if unknown := set(given.parts) - set(PARTS):
        parser.error(f"no part {', '.join(sorted(unknown))}; expected some of {', '.join(PARTS)}")
    for name in given.parts or PARTS:
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            rows = []
            for row in PARTS[name](Path(folder), given.seed):
                print(row.line, flush=True)
                rows.append(row)
        put(name, rows, f"seed {given.seed}, {time.perf_counter() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
