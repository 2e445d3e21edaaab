"""The same samples give the same numbers live, from the bag and from the pipeline, to the last digit."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from bagmaker import BATCH, START_NS, WRENCH, batch, wrench  # noqa: E402
from graph import graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402

import msd_sim.api  # noqa: E402
from msd_ident import io  # noqa: E402
from msd_ident.data.record import Record  # noqa: E402
from msd_ident.ros.common.result_messages import to_estimate  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_ident.workflow import pipeline  # noqa: E402
from msd_interfaces.msg import Estimate  # noqa: E402
from msd_interfaces.srv import Identify  # noqa: E402


def measured() -> Record:
    """The paper's experiment on the paper's rig."""
    made = msd_sim.api.simulate({"rig": "ecp", "experiment": "paper"})
    return Record(made.time, made.position, made.force_time, made.force, start_ns=START_NS)


def write_batches(record: Record, folder: Path, size: int = 100) -> None:
    """The record as a bag whose position comes in batches."""
    ns = record.start_ns + np.rint(record.time * 1e9).astype(np.int64)
    period = int(ns[1] - ns[0])
    with io.BagWriter(folder) as writer:
        writer.add_topic("/msd/force", WRENCH)
        writer.add_topic("/msd/encoder_batch", BATCH)
        for at, value in zip(record.force_time, record.force, strict=True):
            stamp = record.start_ns + round(at * 1e9)
            writer.write("/msd/force", wrench(stamp, float(value)), stamp)
        for first in range(0, record.samples, size):
            part = record.position[first : first + size]
            writer.write("/msd/encoder_batch", batch(int(ns[first]), period, first, part), int(ns[first]))


def numbers(estimate: Estimate) -> dict[str, object]:
    """All fields but those that say when and where from."""
    fields = estimate.get_fields_and_field_types()
    return {name: str(getattr(estimate, name)) for name in fields if name not in ("header", "source")}


@contextmanager
def replayed(folder: Path) -> Iterator[subprocess.Popen[bytes]]:
    """The bag played by a process of its own, twice as fast as it was recorded."""
    parameters = ["-p", f"bag:={folder}", "-p", "rate:=2.0", "-p", "wait:=60.0"]
    command = [sys.executable, "-m", "msd_ident.ros.replayer", "--ros-args", *parameters]
    with subprocess.Popen(command) as process:
        try:
            yield process
            assert process.wait(60.0) == 0
        finally:
            process.kill()


@pytest.mark.parametrize("write", [io.write_bag, write_batches], ids=["single", "batches"])
def test_live_and_bag_and_pipeline_agree_to_the_last_digit(
    ros_domain: int, tmp_path: Path, write: Callable[[Record, Path], None]
) -> None:
    record = measured()
    folder = tmp_path / "bag"
    write(record, folder)
    with graph(ros_domain) as ros:
        given = [Parameter("auto_fit", value=False), Parameter("bag_folder", value=str(tmp_path))]
        identifier = ros.add(Identifier(given, namespace="msd", context=ros.context))
        with replayed(folder) as process:
            until(lambda: identifier.buffer.counts.positions == record.samples or process.poll(), "samples", 60.0)
        live = ros.call(Identify, "msd/identifier/identify", Identify.Request())
        from_bag = ros.call(Identify, "msd/identifier/identify", Identify.Request(bag_path=str(folder)))
        early = Identify.Request(end=4.5)
        part = ros.call(Identify, "msd/identifier/identify", early)
        early.bag_path = str(folder)
        part_of_bag = ros.call(Identify, "msd/identifier/identify", early)
    assert live.success, live.message
    assert from_bag.success, from_bag.message
    assert live.estimate.source == "live" and from_bag.estimate.source == str(folder)
    assert live.estimate.samples == record.samples
    assert numbers(live.estimate) == numbers(from_bag.estimate)
    found = to_estimate(pipeline.identify([io.read(folder)]), "msd identify", 0)
    assert numbers(found) == numbers(live.estimate)
    assert part.success and numbers(part.estimate) == numbers(part_of_bag.estimate) != numbers(live.estimate)
