"""Kills a recorder at random instants, copies its folder during the recording, and compares what three readers find."""

from __future__ import annotations

import multiprocessing
import os
import random
import shutil
import signal
import struct
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml

from bench.reliability.readers import READERS
from msd_ident.io import repair
from msd_ident.ros.recorder.recording import Numbered, QueueLimits, Recording

TOPIC, TYPE = "/count", "std_msgs/msg/UInt64"
#: Messages a second that the recorder is given, and how long it may take until its first [s].
RATE, START_SECONDS = 1000, 20.0


@dataclass(frozen=True)
class Found:
    """What a reader found of a recording that ended at a random instant.

    Attributes:
        where: the instant, in words.
        messages: how many came back, all of them right.
        lost_seconds: time from the last of them to the end.
    """

    where: str
    messages: int
    lost_seconds: float


def record_forever(folder: str, limits: QueueLimits) -> None:
    """Messages that count up, each stamped with the machine's monotonic time, through the node's own recording."""
    recording = Recording(Path(folder), "zstd", limits=limits)
    recording.add_topic(TOPIC, TYPE, [])
    number = 0
    while True:
        for _ in range(RATE // 100):
            recording.put(TOPIC, message(number), now := time.monotonic_ns(), now, Numbered(number))
            number += 1
        time.sleep(0.01)


def message(number: int) -> bytes:
    """A serialised UInt64."""
    return struct.pack("<4sQ", b"\0\1\0\0", number)


def check(folder: Path, ended_ns: int, where: str) -> Found:
    """Open a folder with every reader: messages from 0 on without a gap, none after the end.

    Raises:
        AssertionError: a reader found something else.
    """
    counts = {}
    for name, reader in READERS.items():
        raw = reader(folder)
        if raw != [message(number) for number in range(len(raw))]:
            raise AssertionError(f"{name} found other messages than were written, {where}")
        counts[name] = len(raw)
    if len(set(counts.values())) > 1:
        raise AssertionError(f"the readers differ, {where}: {counts}")
    return Found(where, counts["msd"], (ended_ns - _last(folder)) / 1e9)


def kill_writers(root: Path, seeds: Sequence[int], longest: float, limits: QueueLimits) -> list[Found]:
    """Recordings killed after up to ``longest`` seconds from their first message, several at a time."""
    root.mkdir(exist_ok=True)
    fork = multiprocessing.get_context("fork")
    running = []
    for seed in seeds:
        folder = root / f"killed_{seed}"
        process = fork.Process(target=record_forever, args=(str(folder), limits))
        process.start()
        running.append((seed, folder, process))
    try:
        begins = {seed: _wait_for(folder / "metadata.yaml") for seed, folder, _ in running}
        plan = sorted((begins[seed] + random.Random(seed).uniform(0.0, longest), seed) for seed, *_ in running)
        by_seed = {seed: (folder, process) for seed, folder, process in running}
        ended = {}
        for instant, seed in plan:
            time.sleep(max(instant - time.monotonic(), 0.0))
            folder, process = by_seed[seed]
            _copy(folder, root / f"copy_{seed}")
            os.kill(process.pid or 0, signal.SIGKILL)
            ended[seed] = time.monotonic_ns()
            process.join()
    finally:
        for *_, process in running:
            process.kill()
            process.join()
    found = []
    for seed, folder, _ in running:
        check(root / f"copy_{seed}", ended[seed], "in a copy taken while it wrote")
        found.append(check(folder, ended[seed], "after kill -9"))
        check_repair(folder, found[-1])
    return found


def _copy(folder: Path, copy: Path) -> None:
    """The metadata first, then the files that they name: copied after a file, they may promise what it got since."""
    copy.mkdir()
    known = Path(shutil.copy(folder / "metadata.yaml", copy)).read_text()
    for name in yaml.safe_load(known)["rosbag2_bagfile_information"]["relative_file_paths"]:
        shutil.copy(folder / name, copy)


def check_repair(folder: Path, before: Found) -> None:
    """A repaired bag holds what it held and says nothing of an end that is missing."""
    done = repair(folder)
    if not (done.changed and done.messages >= before.messages and done.lost == 0):
        raise AssertionError(f"repaired: {done.sentence}")
    check(folder, time.monotonic_ns(), "after msd repair")
    if (again := repair(folder)).changed:
        raise AssertionError(f"repaired twice: {again.sentence}")


def kill_process(command: Sequence[str], folder: Path, feed: Callable[[], None], seconds: float) -> int:
    """Start a real recorder, feed it, kill it after so many seconds of recording; monotonic time of that [ns]."""
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            _wait_for(folder / "metadata.yaml", 60.0)
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                feed()
        finally:
            process.kill()
            ended = time.monotonic_ns()
    return ended


def _wait_for(path: Path, seconds: float = START_SECONDS) -> float:
    """Monotonic time [s] at which the file was there."""
    end = time.monotonic() + seconds
    while not path.exists():
        if time.monotonic() > end:
            raise TimeoutError(f"{path} did not appear within {seconds:g} s")
        time.sleep(0.002)
    return time.monotonic()


def _last(folder: Path) -> int:
    """Log time of the last message [ns]; of the folder's birth when there is none."""
    from msd_ident.io import iterate_messages

    last = max((one.log_time_ns for one in iterate_messages(folder)), default=0)
    return last or time.monotonic_ns() - time.time_ns() + int(folder.stat().st_ctime_ns)
