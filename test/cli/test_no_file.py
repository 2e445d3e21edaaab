"""A path that is no file is refused at once by every command; reading it would never end."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import commands
import pytest

pytestmark = pytest.mark.xdist_group("no_file")

LIMITS = "force: 10\ntravel: 0.03\nduration: 20\n"


@pytest.fixture
def places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with all kinds of what is no file."""
    monkeypatch.chdir(tmp_path)
    for ending in ("csv", "mcap", "yaml"):
        (tmp_path / f"device.{ending}").symlink_to("/dev/zero")
        os.mkfifo(tmp_path / f"pipe.{ending}")
    for name in ("bag_pipe", "bag_device"):
        (tmp_path / name).mkdir()
    os.mkfifo(tmp_path / "bag_pipe" / "metadata.yaml")
    (tmp_path / "bag_device" / "x.mcap").symlink_to("/dev/zero")
    with socket.socket(socket.AF_UNIX) as made:
        made.bind("socket")
    (tmp_path / "limits.yaml").write_text(LIMITS)
    return tmp_path


@pytest.mark.parametrize(
    ("path", "kind"),
    [
        ("/dev/zero", "/dev/zero is a device"),
        ("device.csv", "device.csv is a device"),
        ("device.mcap", "device.mcap is a device"),
        ("pipe.csv", "pipe.csv is a pipe"),
        ("pipe.mcap", "pipe.mcap is a pipe"),
        ("socket", "socket is a socket"),
        ("bag_pipe", "bag_pipe/metadata.yaml is a pipe"),
        ("bag_device", "bag_device/x.mcap is a device"),
    ],
)
@pytest.mark.parametrize("command", ["identify", "diagnose", "info", "repair", "design", "replay"])
def test_refused_at_once(places: Path, command: str, path: str, kind: str) -> None:
    if command == "replay":
        pytest.importorskip("rclpy", reason="no ROS 2 here")
    more = ["--limits", "limits.yaml"] if command == "design" else []
    refused([command, path, *more], f"{kind}; expected ", places)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["design", "/dev/zero", "--limits", "device.yaml"], "is a device; expected"),
        (
            ["run", "device.yaml", "--limits", "limits.yaml"],
            "device.yaml is a device; expected a profile in YAML or CSV",
        ),
        (["run", "pipe.csv", "--limits", "limits.yaml"], "pipe.csv is a pipe; expected a profile in YAML or CSV"),
        (["simulate", "--rig", "device.yaml", "--out", "x.csv"], "device.yaml is no file; expected a rig's .yaml file"),
        (["simulate", "--rig", "pipe.yaml", "--out", "x.csv"], "pipe.yaml is no file; expected a rig's .yaml file"),
    ],
)
def test_other_files_are_refused_too(places: Path, arguments: list[str], words: str) -> None:
    refused(arguments, words, places)


@pytest.mark.parametrize(
    "arguments",
    [
        ["identify", ""],
        ["diagnose", "record.csv", ""],
        ["info", ""],
        ["repair", ""],
        ["validate", "result.json", ""],
        ["export", "", "--to", "urdf", "--out", "x.urdf"],
        ["run", "", "--limits", "limits.yaml"],
        ["design", "", "--limits", "limits.yaml"],
        ["batch", "", "--out", "x.parquet"],
    ],
    ids=lambda words: words[0],
)
def test_an_empty_path_is_not_the_current_folder(places: Path, arguments: list[str]) -> None:
    refused(arguments, "an empty path; expected a file or folder: check the variable that it comes from, or", places)


def refused(arguments: list[str], words: str, folder: Path) -> None:
    """In one line and exit code 2; where it reads on it is killed, and has none."""
    done = commands.run(arguments, folder, 30.0)
    assert done.code == 2, done.err
    assert words in done.err and done.err.count("\n") == 1
