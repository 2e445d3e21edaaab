"""Bags made for tests, message by message, with rosbags' serialiser."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from msd_ident.io import BagWriter
from msd_ident.io.message_definitions import Definitions

WRENCH = "geometry_msgs/msg/WrenchStamped"
JOINTS = "sensor_msgs/msg/JointState"
FLOAT = "std_msgs/msg/Float64"
BATCH = "msd_interfaces/msg/EncoderBatch"
START_NS = 1_700_000_000_123_456_789

STORE = get_typestore(Stores.ROS2_JAZZY)
STORE.register(get_types_from_msg(Definitions().text(BATCH), BATCH))

#: topic, type, serialised message, log time [ns]
Message = tuple[str, str, bytes, int]


def _header(ns: int, frame: str = "cart") -> object:
    time = STORE.types["builtin_interfaces/msg/Time"]
    return STORE.types["std_msgs/msg/Header"](time(ns // 10**9, ns % 10**9), frame)


def wrench(ns: int, force: float) -> bytes:
    vector = STORE.types["geometry_msgs/msg/Vector3"]
    content = STORE.types["geometry_msgs/msg/Wrench"](vector(force, 0.0, 0.0), vector(0.0, 0.0, force / 2))
    return bytes(STORE.serialize_cdr(STORE.types[WRENCH](_header(ns), content), WRENCH))


def joints(ns: int, position: Sequence[float], names: Sequence[str] = ("cart",), effort: Sequence[float] = ()) -> bytes:
    message = STORE.types[JOINTS](_header(ns), list(names), np.array(position), np.zeros(0), np.array(effort))
    return bytes(STORE.serialize_cdr(message, JOINTS))


def number(value: float) -> bytes:
    return bytes(STORE.serialize_cdr(STORE.types[FLOAT](value), FLOAT))


def batch(first_ns: int, period_ns: int, sequence: int, positions: Sequence[float]) -> bytes:
    message = STORE.types[BATCH](_header(first_ns), "cart", sequence, period_ns, np.array(positions))
    return bytes(STORE.serialize_cdr(message, BATCH))


def stamps(count: int = 500, period_ns: int = 1_000_000, start_ns: int = START_NS) -> list[int]:
    return [start_ns + i * period_ns for i in range(count)]


def ringing(ns: Sequence[int], start_ns: int = START_NS) -> np.ndarray:
    """Position [m] of a cart that a step of 10 N at 0.1 s sets ringing; its readings are all different."""
    t = (np.array(ns, dtype=np.int64) - start_ns) * 1e-9 - 0.1
    return np.where(t < 0, 1e-7 * t, 0.015 * (1 - np.exp(-2 * np.abs(t)) * np.cos(27 * t)))


def encoder_messages(ns: Sequence[int], topic: str = "/msd/encoder") -> list[Message]:
    return [(topic, JOINTS, joints(t, [x]), t) for t, x in zip(ns, ringing(ns, ns[0]).tolist(), strict=True)]


def force_messages(start_ns: int = START_NS, topic: str = "/msd/force") -> list[Message]:
    times = [start_ns, start_ns + 100_000_000]
    return [(topic, WRENCH, wrench(t, f), t) for t, f in zip(times, (0.0, 10.0), strict=True)]


def step_experiment(count: int = 500) -> list[Message]:
    """Force and encoder of one step experiment, by time."""
    return sorted([*force_messages(), *encoder_messages(stamps(count))], key=lambda message: message[3])


def make_bag(
    folder: Path,
    messages: Iterable[Message],
    *,
    flush_every: int = 100,
    definition: Callable[[str], str | None] = lambda type_name: None,
    **options: object,
) -> Path:
    """Write messages in the order given, a chunk for every ``flush_every`` of them."""
    with BagWriter(folder, **options) as bag:  # type: ignore[arg-type]
        for i, (topic, type_name, raw, log_time) in enumerate(messages):
            bag.add_topic(topic, type_name, definition=definition(type_name))
            bag.write(topic, raw, log_time)
            if i % flush_every == flush_every - 1:
                bag.flush()
    return folder


def storage(folder: Path) -> Path:
    """The one .mcap of a folder."""
    (path,) = folder.glob("*.mcap")
    return path
