"""A bag of 10 GB: read as it streams, in bounded memory, with progress, and given up in its middle."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

rclpy = pytest.importorskip("rclpy", reason="no ROS 2 here")

from action_msgs.msg import GoalStatus  # noqa: E402
from bagmaker import FLOAT, START_NS, encoder_messages, force_messages, stamps, storage  # noqa: E402
from graph import Graph, graph, until  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402

from msd_ident.errors import DataError  # noqa: E402
from msd_ident.io import BagWriter, read  # noqa: E402
from msd_ident.io import reader as bag_reader  # noqa: E402
from msd_ident.io.reader import OnProgress, RawMessage  # noqa: E402
from msd_ident.ros.identifier.node import Identifier  # noqa: E402
from msd_interfaces.action import Diagnose  # noqa: E402

#: Size of a message [bytes], and how many times its file is part of the bag.
SIZE, TIMES = 50_000_000, 200
#: Memory that reading may add [bytes].
MOST_MEMORY = 500_000_000


@pytest.fixture
def ros(ros_domain: int) -> Iterator[Graph]:
    with graph(ros_domain) as made:
        yield made


def huge(folder: Path) -> Path:
    """A bag of 10 GB of zeros, which are small on the disk, and an encoder at its end: one file, many names."""
    folder.mkdir()
    with BagWriter(folder / "zeros") as writer:
        writer.add_topic("/camera", FLOAT)
        writer.write("/camera", bytes(SIZE), START_NS)
    with BagWriter(folder / "signals") as writer:
        for topic, kind, raw, at in (*force_messages(), *encoder_messages(stamps(500))):
            writer.add_topic(topic, kind)
            writer.write(topic, raw, at)
    bag = folder / "bag"
    bag.mkdir()
    for number in range(TIMES):
        os.link(storage(folder / "zeros"), bag / f"bag_{number}.mcap")
    os.link(storage(folder / "signals"), bag / f"bag_{TIMES}.mcap")
    return bag


def memory() -> int:
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_ten_gigabytes_stream_and_are_given_up_in_their_middle(
    ros: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    huge(tmp_path / "made")
    given_messages: list[int] = []
    counted = bag_reader._counted

    def spied(messages: Iterable[RawMessage], on_progress: OnProgress | None) -> Iterable[RawMessage]:
        for message in counted(messages, on_progress):
            given_messages.append(1)
            yield message

    monkeypatch.setattr(bag_reader, "_counted", spied)
    given = [Parameter("bag_folder", value=str(tmp_path)), Parameter("auto_fit", value=False)]
    node = ros.add(Identifier(given, context=ros.context))
    before, most = memory(), 0
    told: list[str] = []
    asked = Diagnose.Goal(bag_paths=["made/bag"])
    handle, result = ros.goal(Diagnose, "identifier/diagnose", asked, lambda feedback: told.append(feedback.cause))
    deadline = time.monotonic() + 60.0
    while len(told) < 12 and time.monotonic() < deadline:
        most = max(most, memory())
        time.sleep(0.01)
    assert not result.done() and told[-1].endswith("messages"), told
    assert most - before < MOST_MEMORY, f"{(most - before) / 1e6:.0f} MB more"
    handle.cancel_goal_async()
    until(result.done, "the answer to the cancelled goal")
    assert result.result().status == GoalStatus.STATUS_CANCELED
    free: list[bool] = []
    node.worker.submit(lambda: free.append(True))
    until(lambda: free, "the worker to be free again", 5.0)
    # What is left of the 200 messages, which take a quarter of a minute, is not read.
    assert 12 <= len(given_messages) < TIMES // 2


def test_more_samples_than_a_small_machine_bears_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bag_reader, "MOST_SAMPLES", 400)
    with BagWriter(tmp_path / "bag") as writer:
        for topic, kind, raw, at in (*force_messages(), *encoder_messages(stamps(500))):
            writer.add_topic(topic, kind)
            writer.write(topic, raw, at)
    with pytest.raises(DataError, match="/msd/encoder holds more than 400 samples; expected fewer: cut the bag"):
        read(tmp_path / "bag")
