"""A Record as a rosbag2 bag with the topics of the ROS graph."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from msd_ident.data.record import FloatArray, Record
from msd_ident.errors import DataError
from msd_ident.io.qos import OfferedQos, qos_to_yaml
from msd_ident.io.reader import FORCE_UNIT, POSITION_UNIT
from msd_ident.io.writer import BagWriter, Compression

FORCE_TOPIC, FORCE_TYPE = "/msd/force", "geometry_msgs/msg/WrenchStamped"
ENCODER_TOPIC, ENCODER_TYPE = "/msd/encoder", "sensor_msgs/msg/JointState"
#: Latest stamp that a message's header can hold [ns].
_LATEST_NS = 2**31 * 10**9


def write_bag(
    record: Record, folder: str | os.PathLike[str], overwrite: bool = False, compression: Compression = "zstd"
) -> None:
    """Write a record as a bag that ``read`` turns into the same samples, with stamps rounded to nanoseconds.

    A record without absolute time gets stamps from 1 s on, because a stamp of 0 means "no stamp" in ROS.

    Args:
        record: the record.
        folder: of the bag; made, with its parents.
        overwrite: replace the folder if it is a bag.
        compression: of the MCAP chunks.

    Raises:
        UsageError: the folder exists and ``overwrite`` is not set, or it is no bag.
        SetupError: the bag cannot be written.
        DataError: stamps beyond what a message can hold.
    """
    base = record.start_ns
    earliest = min(record.time[0], record.force_time[0])
    if base + round(earliest * 1e9) < 1:
        base = 10**9 * (1 - int(np.floor(earliest)))
    ns_x, ns_f = _stamps(base, record.time), _stamps(base, record.force_time)
    latest = int(max(ns_x[-1], ns_f[-1]))
    if latest >= _LATEST_NS:
        raise DataError(f"{record.name} ends at {latest} ns; expected a time before 2038, which is what ROS can stamp")
    store = get_typestore(Stores.ROS2_JAZZY)
    units = {FORCE_UNIT: record.force_unit, POSITION_UNIT: record.position_unit}
    with BagWriter(folder, compression, overwrite=overwrite, custom_data=units) as bag:
        bag.add_topic(FORCE_TOPIC, FORCE_TYPE, qos_to_yaml([OfferedQos(durability="transient_local", depth=1)]))
        bag.add_topic(ENCODER_TOPIC, ENCODER_TYPE, qos_to_yaml([OfferedQos(depth=1000)]))
        force, encoder = _force_message(store), _encoder_message(store)
        order = np.argsort(np.concatenate([ns_f, ns_x]), kind="stable")  # of the same instant, the force first
        for i in order.tolist():
            if i < ns_f.size:
                stamp = int(ns_f[i])
                bag.write(FORCE_TOPIC, force(stamp, float(record.force[i])), stamp)
            else:
                stamp = int(ns_x[i - ns_f.size])
                bag.write(ENCODER_TOPIC, encoder(stamp, float(record.position[i - ns_f.size])), stamp)


def _stamps(base: int, time: FloatArray) -> npt.NDArray[np.int64]:
    return np.asarray(base + np.rint(time * 1e9).astype(np.int64), dtype=np.int64)


def _force_message(store: Typestore) -> Callable[[int, float], bytes]:
    """Function that gives the serialised message for a stamp [ns] and a force."""
    types = store.types
    vector: Any = types["geometry_msgs/msg/Vector3"]
    wrench: Any = types["geometry_msgs/msg/Wrench"]
    stamped: Any = types[FORCE_TYPE]
    nothing = vector(0.0, 0.0, 0.0)

    def message(ns: int, force: float) -> bytes:
        content = stamped(_header(types, ns), wrench(vector(force, 0.0, 0.0), nothing))
        return bytes(store.serialize_cdr(content, FORCE_TYPE))

    return message


def _encoder_message(store: Typestore) -> Callable[[int, float], bytes]:
    """Function that gives the serialised message for a stamp [ns] and a position."""
    types = store.types
    joint: Any = types[ENCODER_TYPE]
    nothing = np.zeros(0)

    def message(ns: int, position: float) -> bytes:
        content = joint(_header(types, ns), ["cart"], np.array([position]), nothing, nothing)
        return bytes(store.serialize_cdr(content, ENCODER_TYPE))

    return message


def _header(types: dict[str, Any], ns: int) -> object:
    stamp = types["builtin_interfaces/msg/Time"](ns // 10**9, ns % 10**9)
    header: object = types["std_msgs/msg/Header"](stamp, "cart")
    return header
