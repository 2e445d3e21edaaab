"""BagWriter: what rosbag2 expects in a bag, and what happens when something goes wrong."""

from __future__ import annotations

import resource
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import yaml
from bagmaker import BATCH, JOINTS, START_NS, WRENCH, joints, stamps, step_experiment, wrench
from mcap.reader import make_reader
from rosbags.interfaces import QosDurability
from rosbags.rosbag2 import Reader

from msd_ident.errors import SetupError, UsageError
from msd_ident.io import BagWriter, OfferedQos, SourceOptions, open_bag, qos_from_yaml, qos_to_yaml, read
from msd_ident.io.message_definitions import Definitions

LATCHED = OfferedQos(durability="transient_local", depth=1)


def metadata(folder: Path) -> dict:
    return yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]


def write_some(folder: Path, **options: object) -> BagWriter:
    writer = BagWriter(folder, **options)  # type: ignore[arg-type]
    writer.add_topic("/msd/force", WRENCH, qos_to_yaml([LATCHED]))
    writer.add_topic("/msd/encoder", JOINTS, qos_to_yaml([OfferedQos(depth=1000)]))
    for topic, _, raw, log_time in step_experiment():
        writer.write(topic, raw, log_time)
    return writer


def test_metadata_is_what_jazzy_writes(tmp_path: Path) -> None:
    write_some(tmp_path / "run").close()
    found = metadata(tmp_path / "run")
    assert list(found) == [
        "version",
        "storage_identifier",
        "duration",
        "starting_time",
        "message_count",
        "topics_with_message_count",
        "compression_format",
        "compression_mode",
        "relative_file_paths",
        "files",
        "custom_data",
        "ros_distro",
    ]
    assert (found["version"], found["storage_identifier"], found["message_count"]) == (9, "mcap", 502)
    assert found["starting_time"] == {"nanoseconds_since_epoch": START_NS}
    assert found["duration"] == {"nanoseconds": 499_000_000}
    assert found["relative_file_paths"] == ["run_0.mcap"]
    assert found["files"][0]["message_count"] == 502
    force, encoder = found["topics_with_message_count"]
    assert (force["message_count"], encoder["message_count"]) == (2, 500)
    assert force["topic_metadata"]["name"] == "/msd/force"
    assert force["topic_metadata"]["serialization_format"] == "cdr"
    forever = {"sec": 9223372036, "nsec": 854775807}
    assert force["topic_metadata"]["offered_qos_profiles"] == [
        {
            "history": "keep_last",
            "depth": 1,
            "reliability": "reliable",
            "durability": "transient_local",
            "deadline": forever,
            "lifespan": forever,
            "liveliness": "automatic",
            "liveliness_lease_duration": forever,
            "avoid_ros_namespace_conventions": False,
        }
    ]


def test_type_hashes_are_those_of_ros() -> None:
    """As in share/sensor_msgs/msg/JointState.json and geometry_msgs/msg/WrenchStamped.json of ROS 2 Jazzy."""
    known = Definitions()
    assert known.type_hash(JOINTS) == "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"
    assert known.type_hash(WRENCH) == "RIHS01_8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"


def test_definitions_come_with_their_dependencies(tmp_path: Path) -> None:
    text = Definitions().text(BATCH)
    assert "float64[] positions" in text
    assert "MSG: std_msgs/Header" in text
    assert "MSG: builtin_interfaces/Time" in text
    own = tmp_path / "my_msgs" / "msg"
    own.mkdir(parents=True)
    (own / "Outer.msg").write_text("Inner[] parts  # with a comment\nsensor_msgs/JointState[2] joints\n")
    (own / "Inner.msg").write_text("float64 x 1.0\nuint8 KIND=3\n")
    (own / "Lost.msg").write_text("my_msgs/Nowhere x\n")
    (own / "Bad.msg").write_text("this is = no definition [\n")
    known = Definitions([tmp_path])
    outer = known.text("my_msgs/msg/Outer")
    for part in ("MSG: my_msgs/Inner", "uint8 KIND=3", "MSG: sensor_msgs/JointState", "float64[] effort"):
        assert part in outer
    assert known.type_hash("my_msgs/msg/Outer").startswith("RIHS01_")
    for name in ("my_msgs/msg/Lost", "my_msgs/msg/Bad", "my_msgs/msg/None", "my_msgs/srv/Outer", "Outer"):
        assert known.text(name) == ""
        assert known.type_hash(name) == ""


def test_installed_packages_are_searched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "share" / "lab_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Load.msg").write_text("float32 grams\n")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere:{tmp_path}")
    assert Definitions().text("lab_msgs/msg/Load") == "float32 grams\n"


def test_a_topic_whose_type_is_unknown_is_kept(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as writer:
        assert not writer.add_topic("/odd", "odd_msgs/msg/Odd")
        assert not writer.add_topic("/odd", "odd_msgs/msg/Odd")
        assert writer.add_topic("/encoder", JOINTS)
        writer.write("/odd", b"\0\1\0\0raw", 5)
    bag = open_bag(tmp_path / "bag")
    assert (bag.topics["/odd"].type, bag.topics["/odd"].definition) == ("odd_msgs/msg/Odd", "")
    assert [message.data for message in bag.messages(["/odd"])] == [b"\0\1\0\0raw"]


def test_other_readers_see_qos_definitions_and_times(tmp_path: Path) -> None:
    writer = write_some(tmp_path / "bag")
    writer.write("/msd/force", wrench(START_NS, 1.0), START_NS + 600_000_000, START_NS + 599_000_000)
    writer.close()
    with Reader(tmp_path / "bag") as reader:
        force = reader.topics["/msd/force"].connections[0]
        assert force.ext.offered_qos_profiles[0].durability == QosDurability.TRANSIENT_LOCAL  # type: ignore[union-attr]
        assert "geometry_msgs/Wrench wrench" in force.msgdef.data
        assert reader.duration == 600_000_001
        assert reader.ros_distro
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == 503
        assert {channel.topic: channel.metadata["topic_type_hash"][:7] for channel in summary.channels.values()} == {
            "/msd/force": "RIHS01_",
            "/msd/encoder": "RIHS01_",
        }
        last = list(make_reader(stream, validate_crcs=True).iter_messages())[-1][2]
        assert (last.log_time, last.publish_time) == (START_NS + 600_000_000, START_NS + 599_000_000)


def test_metadata_is_there_from_the_start_and_kept_up(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag", sync_seconds=0.0)
    assert metadata(tmp_path / "bag")["message_count"] == 0
    writer.add_topic("/msd/encoder", JOINTS)
    for i, t in enumerate(stamps(3)):
        writer.write("/msd/encoder", joints(t, [0.0]), t)
        assert metadata(tmp_path / "bag")["message_count"] == i + 1
        assert sum(1 for _ in open_bag(tmp_path / "bag").messages()) == i + 1
    writer.flush()
    writer.close()
    writer.close()
    writer.flush()
    assert writer.messages == 3
    assert not list((tmp_path / "bag").glob("*.part"))


RECORDER = """
import itertools, sys
from bagmaker import JOINTS, joints, stamps
from msd_ident.io import BagWriter

writer = BagWriter(sys.argv[1], sync_seconds=0.05)
writer.add_topic("/msd/encoder", JOINTS)
for i, t in enumerate(stamps(10**6)):
    writer.write("/msd/encoder", joints(t, [1e-3 * i]), t)
    if i == 2000:
        writer.flush()
        print("recording", flush=True)
"""


def test_a_recorder_that_is_killed_leaves_a_bag(tmp_path: Path) -> None:
    folder = tmp_path / "killed"
    command = [sys.executable, "-c", RECORDER, str(folder)]
    helpers = str(Path(__file__).parents[1])
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=helpers) as recorder:
        assert recorder.stdout is not None
        assert recorder.stdout.readline() == "recording\n"
        recorder.kill()
    expected = metadata(folder)["message_count"]
    record = read(folder, SourceOptions(force="none"))
    assert record.samples >= max(expected, 2000)
    np.testing.assert_array_equal(record.position, 1e-3 * np.arange(record.samples))
    assert record.notes == (
        "the recording was not finished: what came in its last 0.05 s may be missing; msd repair finishes the bag.",
    )


def test_empty_bags_are_bags(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "none"):
        pass
    with BagWriter(tmp_path / "silent") as writer:
        writer.add_topic("/msd/encoder", JOINTS)
    for name in ("none", "silent"):
        with Reader(tmp_path / name) as reader:
            assert reader.message_count == 0
        assert list(open_bag(tmp_path / name).messages()) == []
    assert list(open_bag(tmp_path / "silent").topics) == ["/msd/encoder"]


def test_threads_may_share_a_writer(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag", sync_seconds=0.001)

    def send(name: str) -> None:
        writer.add_topic(name, JOINTS)
        for t in stamps(300):
            writer.write(name, joints(t, [0.5]), t)

    threads = [threading.Thread(target=send, args=(f"/joint_{i}",)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    writer.close()
    bag = open_bag(tmp_path / "bag")
    assert sum(1 for _ in bag.messages()) == 1200
    assert bag.notes == ()


def test_misuse_is_refused(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "bag")
    with pytest.raises(UsageError, match="topic /x is not in the bag"):
        writer.write("/x", b"", 0)
    writer.close()
    with pytest.raises(UsageError, match="is closed"):
        writer.write("/x", b"", 0)
    with pytest.raises(UsageError, match="compression is 'rar'; expected one of zstd, lz4, none"):
        BagWriter(tmp_path / "other", "rar")  # type: ignore[arg-type]
    (tmp_path / "file").write_text("")
    with pytest.raises(SetupError, match="cannot make"):
        BagWriter(tmp_path / "file" / "bag")


def test_a_full_disk_is_said_in_one_line(tmp_path: Path) -> None:
    """A limit on the size of files acts like a disk that is full."""
    writer = BagWriter(tmp_path / "bag", "none")
    writer.add_topic("/msd/encoder", JOINTS)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, limits[1]))
    try:
        with pytest.raises(SetupError, match="File too large; the bag keeps .* messages: free some space"):
            for t in stamps(2000):
                writer.write("/msd/encoder", joints(t, [0.0]), t)
                writer.flush()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert sum(1 for _ in open_bag(tmp_path / "bag").messages()) > 100


NUMBERS = """
- history: 3
  depth: 0
  reliability: 1
  durability: 2
  deadline: {sec: 2147483647, nsec: 4294967295}
  lifespan: {sec: 10, nsec: 5}
  liveliness: 1
  liveliness_lease_duration: {sec: 2147483647, nsec: 4294967295}
  avoid_ros_namespace_conventions: false
"""


def test_qos_is_read_from_numbers_and_names() -> None:
    (old,) = qos_from_yaml(NUMBERS)
    assert (old.history, old.reliability, old.durability, old.liveliness) == (
        "unknown",
        "reliable",
        "volatile",
        "automatic",
    )
    assert old.lifespan_ns == 10_000_000_005
    assert old.deadline_ns == old.liveliness_lease_ns == OfferedQos().deadline_ns  # Foxy's "no limit" is today's
    profiles = (LATCHED, OfferedQos(reliability="best_effort", history="keep_all", deadline_ns=1_500_000_000))
    assert qos_from_yaml(qos_to_yaml(profiles)) == profiles
    assert qos_to_yaml(()) == ""


@pytest.mark.parametrize("text", ["", None, "a: [", "3", "text", "- 3", "{}"])
def test_qos_that_cannot_be_read_is_left_out(text: str | None) -> None:
    assert qos_from_yaml(text) == ()


def test_qos_with_strange_entries_is_unknown() -> None:
    (strange,) = qos_from_yaml("- {history: 77, reliability: perhaps, depth: many, deadline: soon, lifespan: {sec: a}}")
    assert (strange.history, strange.reliability, strange.durability, strange.depth) == (
        "unknown",
        "unknown",
        "unknown",
        10,
    )
