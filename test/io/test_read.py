"""Which signals a bag gives, and the one line that every unusable bag gets."""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bagmaker import (
    BATCH,
    FLOAT,
    JOINTS,
    START_NS,
    WRENCH,
    Message,
    batch,
    encoder_messages,
    force_messages,
    joints,
    make_bag,
    number,
    ringing,
    stamps,
    step_experiment,
    storage,
    wrench,
)
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from msd_ident.data.record import Origin
from msd_ident.errors import DataError, MsdError, UsageError
from msd_ident.io import BagWriter, SourceOptions, open_bag, read
from msd_ident.io.joints import Joint
from msd_ident.io.joints import joints as found_joints


def refusal(folder: Path, messages: list[Message], options: SourceOptions | None = None) -> str:
    """The one line that reading ends with."""
    with pytest.raises(MsdError) as refused:
        read(make_bag(folder, messages), options or SourceOptions())
    line = str(refused.value)
    assert "\n" not in line
    return line


def test_the_default_topics_give_force_and_position(tmp_path: Path) -> None:
    record = read(make_bag(tmp_path / "bag", step_experiment()))
    assert record.samples == 500
    assert record.start_ns == START_NS
    assert record.time[0] == 0.0
    np.testing.assert_array_equal(record.time, np.arange(500) * 1_000_000 / 1e9)
    np.testing.assert_array_equal(record.position, ringing(stamps()))
    np.testing.assert_array_equal(record.force_time, [0.0, 0.1])
    np.testing.assert_array_equal(record.force, [0.0, 10.0])
    assert (record.force_unit, record.position_unit, record.hold) == ("N", "m", "zero")
    assert record.name == "bag"
    assert record.notes == ()


def test_the_file_alone_reads_like_its_folder(tmp_path: Path) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment())
    for path in (storage(folder), folder / "metadata.yaml", str(folder)):
        np.testing.assert_array_equal(read(path).position, read(folder).position)


def test_batches_are_unpacked(tmp_path: Path) -> None:
    ns = stamps(1000, 100_000)
    x = ringing(ns)
    batches = [
        ("/encoder_batch", BATCH, batch(ns[i], 100_000, i, x[i : i + 100].tolist()), ns[i + 99])
        for i in range(0, 1000, 100)
    ]
    record = read(make_bag(tmp_path / "all", [*force_messages(topic="/force"), *batches]))
    np.testing.assert_array_equal(record.time, np.arange(1000) * 100_000 / 1e9)
    np.testing.assert_array_equal(record.position, x)
    assert record.notes == ()

    some = batches[:3] + batches[4:7] + batches[9:]
    record = read(make_bag(tmp_path / "some", [*force_messages(topic="/force"), *some]))
    assert record.samples == 700
    assert record.notes == ("/encoder_batch: 300 samples are missing in 2 gaps of the batches' sequence numbers.",)
    assert record.origins == (Origin("position", "/encoder_batch", 300), Origin("force", "/force"))


def robot(count: int = 300) -> list[Message]:
    """Two publishers on one topic, each with some of the joints; the order of the joints changes."""
    messages = []
    for i, t in enumerate(stamps(count)):
        names, values = ["shoulder", "elbow"], [float(i), 0.01 * i]
        if i % 2:
            names, values = names[::-1], values[::-1]
        effort = [100.0 + i if name == "elbow" else 0.0 for name in names]
        messages.append(("/joint_states", JOINTS, joints(t, values, names, effort), t))
        messages.append(("/joint_states", JOINTS, joints(t + 1000, [0.0], ["gripper"], [0.0]), t + 1000))
    return messages


def test_joints_are_found_by_name_in_every_message(tmp_path: Path) -> None:
    options = SourceOptions(
        force="/joint_states:effort[elbow]",
        position="joint_states:position[elbow]",
        force_unit="N·m",
        position_unit="rad",
    )
    record = read(make_bag(tmp_path / "bag", robot()), options)
    np.testing.assert_array_equal(record.position, [0.01 * i for i in range(300)])
    np.testing.assert_array_equal(record.force, [100.0 + i for i in range(300)])
    assert (record.force_unit, record.position_unit) == ("N·m", "rad")
    assert record.shared_clock
    assert record.notes[0] == "/joint_states: 300 of 600 messages hold no position[elbow]."


def test_a_nan_of_a_message_is_no_sample(tmp_path: Path) -> None:
    """A driver publishes NaN for what it does not have; a table has it for a missing number, too."""
    ns = stamps()
    x, effort = ringing(ns), np.where(np.arange(500) < 100, 0.0, 10.0)
    x[[0, 250, 499]] = effort[[0, 300]] = np.nan
    told = zip(ns, x.tolist(), effort.tolist(), strict=True)
    bag = make_bag(tmp_path / "bag", [("/joint_states", JOINTS, joints(t, [x], ("arm",), [f]), t) for t, x, f in told])
    options = SourceOptions("/joint_states:effort[arm]", "/joint_states:position[arm]")
    record = read(bag, options)
    np.testing.assert_array_equal(record.position, x[~np.isnan(x)])
    np.testing.assert_array_equal(record.force, effort[~np.isnan(effort)])
    assert record.notes[:2] == (
        "/joint_states:position[arm] is NaN in 3 of 500 samples, which are left out.",
        "/joint_states:effort[arm] is NaN in 2 of 500 samples: the force is held there. If it was not, the parameters "
        "are wrong: cut the record with --start and --end.",
    )
    table = tmp_path / "table.csv"
    rows = np.column_stack([np.arange(500) / 1e3, effort, x]).tolist()
    table.write_text("time_s,force_n,position_m\n" + "".join(f"{t!r},{f!r},{x!r}\n" for t, f, x in rows))
    np.testing.assert_array_equal(read(table).position, record.position)
    np.testing.assert_array_equal(read(table).force, record.force)


def test_a_nan_in_a_batch_is_no_sample(tmp_path: Path) -> None:
    x = ringing(stamps())
    x[::10] = np.nan
    parts = [
        ("/encoder_batch", BATCH, batch(START_NS + i * 10**6, 10**6, i, x[i : i + 50].tolist()), START_NS)
        for i in range(0, 500, 50)
    ]
    record = read(make_bag(tmp_path / "bag", [*force_messages(topic="/force"), *parts]))
    np.testing.assert_array_equal(record.position, x[~np.isnan(x)])
    assert "/encoder_batch:positions is NaN in 50 of 500 samples, which are left out." in record.notes
    assert record.origins[0].lost == 0


def test_an_effort_that_is_nan_throughout_is_none(tmp_path: Path) -> None:
    nan = float("nan")
    told = zip(stamps(), ringing(stamps()).tolist(), strict=True)
    messages = [("/j", JOINTS, joints(t, [x, nan], ("a", "b"), [nan, nan]), t) for t, x in told]
    assert found_joints(make_bag(tmp_path / "bag", messages)) == (Joint("/j", "a", False),)
    with pytest.raises(DataError, match=r"effort\[a\] is NaN in all 500 samples; .*--force none for a free decay"):
        read(tmp_path / "bag", SourceOptions("/j:effort[a]", "/j:position[a]"))


def test_an_effort_that_nobody_measures_is_named(tmp_path: Path) -> None:
    options = SourceOptions("/joint_states:effort[shoulder]", "/joint_states:position[elbow]", force_unit="N·m")
    (note,) = [one for one in read(make_bag(tmp_path / "bag", robot()), options).notes if "drives" in one]
    assert note.startswith("/joint_states:effort[shoulder] is 0 N·m in all 300 samples while the cart moves: check")


def test_a_free_decay_of_a_joint_is_in_newton_metres(tmp_path: Path) -> None:
    options = SourceOptions("none", "/joint_states:position[elbow]", position_unit="rad")
    assert read(make_bag(tmp_path / "bag", robot()), options).force_unit == "N·m"


def test_degrees_of_a_joint_become_radians(tmp_path: Path) -> None:
    options = SourceOptions("none", "/joint_states:position[elbow]", position_unit="deg")
    record = read(make_bag(tmp_path / "bag", robot()), options)
    np.testing.assert_allclose(record.position, [np.deg2rad(0.01 * i) for i in range(300)], rtol=1e-12)
    assert (record.force_unit, record.position_unit) == ("N·m", "rad")
    note = "/joint_states:position[elbow] was multiplied by 0.0174533, as --position-unit deg says."
    assert note in record.notes


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"position": "/joint_states:position[wrist]"}, ["wrist", "elbow, gripper, shoulder"]),
        ({"position": "/joint_states:velocity[0]"}, ["no message holds /joint_states:velocity[0]"]),
        ({"position": "/joint_states:position"}, ["position holds 2 values", "position[0]"]),
        ({"position": "/joint_states:angle[0]"}, ["no 'angle'", "header, name, position, velocity, effort"]),
        ({"position": "/joint_states:header.stamp"}, ["a group of fields (sec, nanosec)"]),
        ({"position": "/joint_states:header.frame_id"}, ["a str"]),
        ({"position": "/arm:position[0]"}, ["no topic /arm", "there are: /joint_states"]),
        ({"position": "/joint_states:position["}, ["cannot be read", "effort[elbow]"]),
        ({}, ["no topic called encoder", "--position TOPIC:FIELD"]),
        ({"position": "/joint_states:position[0]", "force": ""}, ["has no force", "--force none for a free decay"]),
    ],
)
def test_signals_that_are_not_there_are_refused_with_those_that_are(
    tmp_path: Path, options: dict[str, str], words: list[str]
) -> None:
    line = refusal(tmp_path / "bag", robot(), SourceOptions(**{"force": "none", **options}))
    for word in words:
        assert word in line


def test_fields_of_other_types(tmp_path: Path) -> None:
    ns = stamps(200)
    messages = [("/x", FLOAT, number(x), t) for t, x in zip(ns, ringing(ns).tolist(), strict=True)]
    messages += [("/ft", WRENCH, wrench(ns[0], 3.0), ns[0])]
    bag = make_bag(tmp_path / "bag", messages)
    record = read(bag, SourceOptions(position="/x:data", force="/ft:wrench.torque.z", force_scale=2.0))
    np.testing.assert_array_equal(record.position, ringing(ns))
    np.testing.assert_array_equal(record.force, [3.0])
    assert record.notes == ("/x: 200 of 200 messages have no stamp; the time at which they were logged is used.",)


def test_scales_and_window(tmp_path: Path) -> None:
    bag = make_bag(tmp_path / "bag", step_experiment())
    record = read(bag, SourceOptions(position_scale=-1000.0, force_scale=0.5, start=0.2, end=0.3, hold="linear"))
    np.testing.assert_array_equal(record.position, -1000.0 * ringing(stamps())[200:301])
    assert record.time[0] == 0.2
    assert record.force.tolist() == [5.0]
    assert record.hold == "linear"


def test_a_free_decay_needs_no_force(tmp_path: Path) -> None:
    record = read(make_bag(tmp_path / "bag", encoder_messages(stamps())), SourceOptions(force="none"))
    assert record.force.tolist() == [0.0]
    assert record.force_time.tolist() == [0.0]


def test_stamps_of_zero_are_replaced_by_the_log_time(tmp_path: Path) -> None:
    ns = stamps()
    messages = [("/encoder", JOINTS, joints(0, [x]), t) for t, x in zip(ns, ringing(ns).tolist(), strict=True)]
    record = read(make_bag(tmp_path / "bag", [*messages, *force_messages(topic="/force")]))
    assert record.start_ns == START_NS
    assert record.notes == ("/encoder: 500 of 500 messages have no stamp; the time at which they were logged is used.",)


def test_simulated_time_begins_at_a_stamp_of_zero(tmp_path: Path) -> None:
    """Logged by the wall clock, stamped by a clock that starts at 0: the first stamp is no missing one."""
    ns = stamps(300, start_ns=0)
    messages = [
        ("/encoder", JOINTS, joints(t, [x]), START_NS + t) for t, x in zip(ns, ringing(ns, 0).tolist(), strict=True)
    ]
    force = [("/force", WRENCH, wrench(0, 0.0), START_NS), ("/force", WRENCH, wrench(10**8, 10.0), START_NS + 10**8)]
    record = read(make_bag(tmp_path / "bag", [*messages, *force]))
    assert (record.samples, record.start_ns, record.notes) == (300, 0, ())
    assert record.force_time.tolist() == [0.0, 0.1]


def test_one_force_without_stamp_among_others_acts_when_it_was_logged(tmp_path: Path) -> None:
    late = ("/msd/force", WRENCH, wrench(0, -3.0), START_NS + 250_000_000)
    record = read(make_bag(tmp_path / "bag", [*step_experiment(), late]))
    assert record.force_time.tolist() == [0.0, 0.1, 0.25]
    assert record.notes == ("/msd/force: 1 of 3 messages have no stamp; the time at which they were logged is used.",)


def test_late_and_repeated_samples_are_repaired_with_a_note(tmp_path: Path) -> None:
    messages = encoder_messages(stamps())
    messages[100], messages[101] = messages[101], messages[100]
    messages.insert(300, messages[299])
    record = read(make_bag(tmp_path / "bag", [*force_messages(), *messages]))
    np.testing.assert_array_equal(record.position, ringing(stamps()))
    assert record.notes == (
        "position: 1 of 501 samples came late and were sorted by their stamps.",
        "position: 1 samples with duplicate stamps were dropped.",
    )


def test_a_recording_that_was_looped_is_refused(tmp_path: Path) -> None:
    once = step_experiment()
    again = [(topic, type_name, raw, log + 500_000_000) for topic, type_name, raw, log in once]
    line = refusal(tmp_path / "loop", [*once, *again])
    assert "stamps run backwards: 0.499 s back at sample 501 of 1000" in line
    assert "looped" in line
    # With log times that jump back as well (a recording of simulated time), it is the same.
    assert "at sample 501 of 1000" in refusal(tmp_path / "simulated", [*once, *once])


def test_a_clock_that_was_reset_near_the_end_is_refused(tmp_path: Path) -> None:
    messages = step_experiment()
    early = [m[:3] + (messages[-1][3],) for m in encoder_messages(stamps(3, start_ns=START_NS - 10**10))]
    assert "run backwards: 10.499 s back at sample 501" in refusal(tmp_path / "bag", [*messages, *early])


def test_topics_in_several_namespaces(tmp_path: Path) -> None:
    left, right = encoder_messages(stamps(), "/left/encoder"), encoder_messages(stamps(), "/right/encoder")
    forces = force_messages(topic="/left/force") + force_messages(topic="/right/force")
    line = refusal(tmp_path / "two", [*left, *right, *forces])
    assert "2 topics that may be the position (/left/encoder, /right/encoder)" in line
    record = read(tmp_path / "two", SourceOptions(position="/right/encoder"))
    assert record.samples == 500
    only_left = make_bag(tmp_path / "one", [*left, *forces])
    assert read(only_left).force.size == 2
    assert "2 topics that may be the force" in refusal(
        tmp_path / "three", [*encoder_messages(stamps(), "/encoder"), *forces]
    )


@pytest.mark.parametrize(
    ("messages", "words"),
    [
        (encoder_messages(stamps(5)) + force_messages(), ["5 position samples", "at least 20"]),
        (encoder_messages(stamps()) + force_messages(START_NS + 10**10), ["force starts at 10.000 s", "overlap"]),
        (encoder_messages(stamps()), ["has no force", "there are: /msd/encoder", "--force none"]),
        (force_messages(), ["called encoder", "there are: /msd/force"]),
        (
            [("/encoder", JOINTS, joints(t, [0.25]), t) for t in stamps()] + force_messages(),
            ["never changes (0.25 m in all 500 samples)"],
        ),
        (
            encoder_messages(stamps())
            + force_messages()
            + [("/msd/encoder", JOINTS, joints(START_NS + 500_000_000, [float("inf")]), START_NS)],
            ["position holds 1 values that are not finite (first: inf at sample 500)"],
        ),
        (
            encoder_messages(stamps()) + [("/msd/force", WRENCH, wrench(START_NS, float("inf")), START_NS)],
            ["force holds 1 values", "inf"],
        ),
    ],
)
def test_unusable_bags_get_one_line(tmp_path: Path, messages: list[Message], words: list[str]) -> None:
    line = refusal(tmp_path / "bag", messages)
    for word in words:
        assert word in line


def test_why_a_topic_of_the_right_name_is_not_taken(tmp_path: Path) -> None:
    odd = [("/encoder", "odd_msgs/msg/Encoder", raw, t) for _, _, raw, t in encoder_messages(stamps())]
    line = refusal(tmp_path / "odd", [*odd, *force_messages()])
    assert (
        "to take the position from (/encoder is of type odd_msgs/msg/Encoder); there are: /encoder, /msd/force" in line
    )
    with BagWriter(tmp_path / "silent") as writer:
        writer.add_topic("/force", WRENCH)
        writer.add_topic("/encoder", JOINTS)
        for t, x in zip(stamps(), ringing(stamps()).tolist(), strict=True):
            writer.write("/encoder", joints(t, [x]), t)
    with pytest.raises(DataError, match=r"no topic called force to take it from \(/force holds no messages\)"):
        read(tmp_path / "silent")


def test_every_refusal_names_the_path(tmp_path: Path) -> None:
    assert refusal(tmp_path / "short", encoder_messages(stamps(5)) + force_messages()).startswith(
        f"{tmp_path / 'short'}: 5 position samples"
    )


def test_an_empty_bag_has_no_topics(tmp_path: Path) -> None:
    assert "called encoder or encoder_batch to take the position from; there are none" in refusal(tmp_path / "bag", [])


def test_a_dense_force_that_ends_before_the_position_is_refused(tmp_path: Path) -> None:
    early = [("/force", WRENCH, wrench(t, 1.0 * t), t) for t in stamps(100, start_ns=START_NS - 10**10)]
    line = refusal(tmp_path / "bag", [*early, *encoder_messages(stamps(), "/encoder")])
    assert "force ends at -9.901 s, before the first position" in line


def test_a_type_without_definition(tmp_path: Path) -> None:
    """Standard types are known without one, others are not."""
    bare = make_bag(tmp_path / "standard", step_experiment(), definition=lambda type_name: "")
    assert open_bag(bare).topics["/msd/encoder"].definition == ""
    np.testing.assert_array_equal(read(bare).position, ringing(stamps()))

    odd = [("/encoder", "odd_msgs/msg/Encoder", raw, t) for _, _, raw, t in encoder_messages(stamps())]
    line = refusal(tmp_path / "odd", odd, SourceOptions(position="/encoder:x", force="none"))
    assert "type odd_msgs/msg/Encoder of topic /encoder has no definition in the bag and is not installed" in line

    broken = make_bag(tmp_path / "broken", odd, definition=lambda type_name: "float64 x\nnonsense here and there\n")
    with pytest.raises(DataError, match="the definition of odd_msgs/msg/Encoder .* cannot be used") as refused:
        read(broken, SourceOptions(position="/encoder:x", force="none"))
    assert "\n" not in str(refused.value)


def test_messages_that_cannot_be_decoded_are_counted(tmp_path: Path) -> None:
    messages = step_experiment()
    for i in (50, 60, 70):
        topic, type_name, raw, log_time = messages[i]
        messages[i] = (topic, type_name, raw[:30], log_time)
    record = read(make_bag(tmp_path / "bag", messages))
    assert record.samples == 497
    assert record.notes == ("/msd/encoder: 3 of 500 messages could not be decoded, left out.",)
    none = [(topic, type_name, b"", t) for topic, type_name, _, t in encoder_messages(stamps())]
    line = refusal(tmp_path / "none", none, SourceOptions(force="none"))
    assert "none of the 500 messages of /msd/encoder can be decoded; expected sensor_msgs/msg/JointState" in line


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("no.such", None, ["does not exist", "bag folder"]),
        ("old.bag", b"#ROSBAG V2.0\n" + bytes(100), ["bag of ROS 1", "rosbags-convert"]),
        ("picture.png", b"\x89PNG\r\n\x1a\n" + bytes(100), ["is not text", "CSV"]),
        ("broken.db3", b"SQLite format 3\0" + bytes(100), ["cannot be read", ".db3"]),
        ("broken.mcap.zstd", b"no zstd at all", ["damaged or not compressed with zstd"]),
    ],
)
def test_paths_that_are_no_bag(tmp_path: Path, name: str, content: bytes | None, words: list[str]) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(DataError) as refused:
        read(path)
    for word in [name, *words]:
        assert word in str(refused.value)


def test_who_reads_bags_alone_asks_for_no_table(tmp_path: Path) -> None:
    with pytest.raises(
        DataError, match=r"nope does not exist; expected a bag folder, an \.mcap or a \.db3 file: check"
    ):
        open_bag(tmp_path / "nope")


def test_the_command_that_converts_a_bag_of_ros_1_works(tmp_path: Path) -> None:
    path = tmp_path / "old rig.bag"
    store = get_typestore(Stores.ROS1_NOETIC)
    types = store.types
    with Writer(path) as bag:
        connection = bag.add_connection("/joint_states", JOINTS, typestore=store)
        for i in range(50):
            stamp = types["builtin_interfaces/msg/Time"](1_700_000_000, i * 10_000_000)
            header = types["std_msgs/msg/Header"](i, stamp, "")
            message = types[JOINTS](header, ["cart"], np.array([0.001 * i * i]), np.zeros(0), np.array([1.5]))
            bag.write(connection, 1_700_000_000 * 10**9 + i * 10**7, store.serialize_ros1(message, JOINTS))
    with pytest.raises(DataError) as refused:
        read(path)
    _, _, said = str(refused.value).partition("convert it with ")
    command, *words = shlex.split(said)
    assert words == ["--src", str(path), "--dst", str(tmp_path / "old rig")]
    subprocess.run([str(Path(sys.executable).parent / command), *words], check=True)
    record = read(tmp_path / "old rig", SourceOptions(position="/joint_states", force="/joint_states"))
    np.testing.assert_allclose(record.position, 0.001 * np.arange(50.0) ** 2)


def test_a_joint_that_stands_twice_in_a_message_is_refused(tmp_path: Path) -> None:
    """The first of the two was taken in silence."""
    messages = [("/joint_states", JOINTS, joints(ns, (0.1 * i, -i), ("arm", "arm"), (1.0, 2.0)), ns)
                for i, ns in enumerate(stamps())]  # fmt: skip
    options = SourceOptions(position="/joint_states:position[arm]", force="/joint_states:effort[arm]")
    line = refusal(tmp_path / "bag", messages, options)
    assert "joint arm stands 2 times in a message; expected once" in line
    assert "take one by its place, position[0] or position[1]" in line
    by_place = SourceOptions(position="/joint_states:position[1]", force="/joint_states:effort[1]")
    assert read(tmp_path / "bag", by_place).force[0] == 2.0


def test_a_folder_without_storage(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"holds no \.mcap or \.db3 file"):
        read(tmp_path)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"position_scale": 0.0}, "position scale is 0.0"),
        ({"force_scale": float("nan")}, "force scale is nan"),
        ({"hold": "cubic"}, "expected one of auto, zero, linear, band_limited"),
        ({"start": 2.0, "end": 1.0}, "from 2 s to 1 s is empty"),
    ],
)
def test_options_that_make_no_sense(options: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        SourceOptions(**options)  # type: ignore[arg-type]


def test_a_window_beside_the_record(tmp_path: Path) -> None:
    bag = make_bag(tmp_path / "bag", step_experiment())
    with pytest.raises(DataError, match=r"0 position samples between 5\.000 s and 6\.000 s"):
        read(bag, SourceOptions(start=5.0, end=6.0))
