"""metadata.yaml of a rosbag2 folder, version 9, as ``ros2 bag record`` of Jazzy writes it.

It is rewritten with each flush, so that it is correct at every instant.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from msd_ident.io import yaml_text
from msd_ident.io.crash_safe_file import replace_text
from msd_ident.io.qos import qos_from_yaml

#: Entry of the custom data of a bag that is being written; its value is the time that an end may cost [s].
UNFINISHED = "msd_unfinished"
#: Entry for what a recording took and the disk did not.
LOST = "msd_lost"
#: What rosbag2 writes as the start of a bag without messages [ns].
_NO_START = 2**63 - 1


@dataclass
class TopicEntry:
    """A topic in metadata.yaml.

    Attributes:
        name: of the topic.
        type: of its messages.
        qos: offered QoS profiles as YAML.
        type_hash: RIHS01 hash of the type, or empty.
        messages: number of messages.
    """

    name: str
    type: str
    qos: str
    type_hash: str = ""
    messages: int = 0


@dataclass
class FileEntry:
    """One file of a bag in metadata.yaml.

    Attributes:
        name: of the file.
        first_ns, last_ns: log times of its first and last message [ns].
        messages: number of messages.
    """

    name: str
    first_ns: int = _NO_START
    last_ns: int = 0
    messages: int = 0

    @property
    def duration_ns(self) -> int:
        """From the first message to the last."""
        return max(self.last_ns - self.first_ns, 0) if self.messages else 0

    def count(self, log_time_ns: int) -> None:
        """Add a message to the number and the log times."""
        self.first_ns = min(self.first_ns, log_time_ns)
        self.last_ns = max(self.last_ns, log_time_ns)
        self.messages += 1


@dataclass
class BagEntry:
    """A bag in metadata.yaml.

    Attributes:
        files: in the order of the recording.
        topics: by name.
        custom: texts that the recorder added.
    """

    files: list[FileEntry] = field(default_factory=list)
    topics: dict[str, TopicEntry] = field(default_factory=dict)
    custom: dict[str, str] = field(default_factory=dict)

    @property
    def messages(self) -> int:
        """Number of messages in all files."""
        return sum(file.messages for file in self.files)

    def information(self) -> dict[str, Any]:
        """What stands under ``rosbag2_bagfile_information``."""
        first = min((file.first_ns for file in self.files), default=_NO_START)
        last = max((file.last_ns for file in self.files if file.messages), default=0)
        return {
            "version": 9,
            "storage_identifier": "mcap",
            "duration": {"nanoseconds": max(last - first, 0)},
            "starting_time": {"nanoseconds_since_epoch": first},
            "message_count": self.messages,
            "topics_with_message_count": [_topic(topic) for topic in self.topics.values()],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [file.name for file in self.files],
            "files": [_file(file) for file in self.files],
            "custom_data": self.custom or None,
            "ros_distro": os.environ.get("ROS_DISTRO", "jazzy"),
        }

    def write(self, folder: Path) -> None:
        """Put metadata.yaml into the folder, in one step."""
        replace_text(folder / "metadata.yaml", yaml_text.dump({"rosbag2_bagfile_information": self.information()}))


def read_entry(information: Mapping[str, Any]) -> BagEntry:
    """What the metadata say of files and topics, as far as it can be used."""
    custom = information.get("custom_data")
    entry = BagEntry(custom={str(k): str(v) for k, v in custom.items()} if isinstance(custom, Mapping) else {})
    for file in _mappings(information.get("files")):
        start = _integer(_inner(file, "starting_time", "nanoseconds_since_epoch"))
        name, count = Path(str(file.get("path"))).name, _integer(file.get("message_count"))
        duration = _integer(_inner(file, "duration", "nanoseconds"))
        entry.files.append(FileEntry(name, start, start + duration, count) if count else FileEntry(name))
    for topic in _mappings(information.get("topics_with_message_count")):
        about = topic.get("topic_metadata")
        if isinstance(about, Mapping) and isinstance(about.get("name"), str):
            hashed, count = str(about.get("type_description_hash") or ""), _integer(topic.get("message_count"))
            qos = about.get("offered_qos_profiles")
            text = qos if isinstance(qos, str) else yaml_text.dump(qos)
            entry.topics[about["name"]] = TopicEntry(about["name"], str(about.get("type")), text, hashed, count)
    return entry


def _topic(topic: TopicEntry) -> dict[str, Any]:
    return {
        "topic_metadata": {
            "name": topic.name,
            "type": topic.type,
            "serialization_format": "cdr",
            "offered_qos_profiles": [profile.to_dict() for profile in qos_from_yaml(topic.qos)],
            "type_description_hash": topic.type_hash,
        },
        "message_count": topic.messages,
    }


def _file(file: FileEntry) -> dict[str, Any]:
    return {
        "path": file.name,
        "starting_time": {"nanoseconds_since_epoch": file.first_ns},
        "duration": {"nanoseconds": file.duration_ns},
        "message_count": file.messages,
    }


def _mappings(entries: object) -> Iterable[Mapping[str, Any]]:
    return [entry for entry in entries if isinstance(entry, Mapping)] if isinstance(entries, list) else []


def _inner(entry: Mapping[str, Any], outer: str, inner: str) -> object:
    found = entry.get(outer)
    return found.get(inner) if isinstance(found, Mapping) else None


def _integer(value: object) -> int:
    return value if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**63 else 0
