"""Kills, power cuts, full disks, cuts and damage of every kind: a few of each; ``make fuzz`` tries many more."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.reliability import cuts, fulldisk, kills, mutations
from bench.reliability.powercut import Disk
from msd_ident.io import BagWriter, read
from msd_ident.ros.recorder.recording import QueueLimits
from msd_sim import config
from msd_sim.errors import RigError

SYNC = 0.4


@pytest.mark.parametrize("recorders", [4, pytest.param(10, marks=pytest.mark.long)])
def test_a_recorder_may_be_killed_at_any_instant(tmp_path: Path, recorders: int) -> None:
    found = kills.kill_writers(tmp_path, range(recorders), 1.5, QueueLimits(sync_seconds=SYNC))
    assert sum(one.messages > 0 for one in found) >= recorders / 2
    assert max(one.lost_seconds for one in found) < 1.0


def test_files_that_are_split_survive_a_kill_too(tmp_path: Path) -> None:
    found = kills.kill_writers(tmp_path, range(20, 22), 1.5, QueueLimits(sync_seconds=SYNC, split_seconds=0.3))
    assert max(one.lost_seconds for one in found) < 1.0


def test_the_power_may_go_between_any_two_calls(tmp_path: Path) -> None:
    """What was synced is there, and all that is there is whole."""
    least = 0

    def look(image: Path) -> None:
        assert kills.check(image, 0, "after a power cut").messages >= least

    disk = Disk(tmp_path / "bag", tmp_path / "image", look)
    with disk.watched():
        writer = BagWriter(tmp_path / "bag", "none", split_bytes=10_000)
        writer.add_topic(kills.TOPIC, kills.TYPE)
        for number in range(300):
            writer.write(kills.TOPIC, kills.message(number), number + 1)
            if number % 150 == 99:
                writer.flush()
                least = number + 1
        writer.close()
    assert disk.cuts > 80
    assert len(list((tmp_path / "bag").glob("*.mcap"))) == 2


@pytest.mark.skipif(not fulldisk.can_mount(), reason="this user may not have a file system of his own")
@pytest.mark.parametrize("kilobytes", [64, 300])
def test_a_full_disk_ends_the_recording_and_keeps_what_is_there(tmp_path: Path, kilobytes: int) -> None:
    found = fulldisk.fill(tmp_path, kilobytes, seed=kilobytes)
    assert "No space left on device; the bag keeps" in found["error"]
    assert found["kept"] > 50
    assert found["sent"] == found["kept"] + found["lost"]
    assert found["files"] == ["bag_0.mcap", "metadata.yaml"]


@pytest.mark.parametrize(
    ("samples", "places"), [(150, 15), pytest.param(500, 60, marks=pytest.mark.long)], ids=["short", "whole"]
)
def test_a_bag_may_be_cut_off_at_any_byte(tmp_path: Path, samples: int, places: int) -> None:
    """Before, at and behind the end of each of its chunks, and at some other bytes."""
    whole = cuts.make(tmp_path, "zstd", samples=samples)
    found = dict(cuts.cuts(whole, places, 1, tmp_path))
    assert len(found) > 3 * len(whole.chunks) + places // 2 and len(whole.chunks) > samples // 60
    assert 0.6 * samples < max(found.values()) <= len(whole.messages)


@pytest.mark.parametrize("files", [20, pytest.param(60, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", mutations.KINDS, ids=lambda kind: kind.name)
def test_damaged_files_are_read_or_refused_in_one_line(kind: mutations.Kind, files: int, tmp_path: Path) -> None:
    found = mutations.attack(kind, tmp_path, files, seed=0)
    assert found.faults == []
    assert sum(found.counts.values()) == files
    assert found.counts["refused"] > 0 or kind.name == "metadata.yaml"


BOMBS = {
    "brackets": "a: " + "[" * 200_000,
    "dashes": "- " * 200_000,
    "a number of 20000 digits": "/**: {ros__parameters: {mass: " + "1" * 20_000 + "}}",
    "an alias within itself": "/**:\n  ros__parameters: &a\n    mass: 1.0\n    encoder: *a\n",
    "aliases of aliases": "/**:\n  ros__parameters:\n    a0: &a0 {x: 1}\n"
    + "".join(f"    a{i}: &a{i} {{{', '.join(f'{k}: *a{i - 1}' for k in 'pqrstu')}}}\n" for i in range(1, 12)),
}


@pytest.mark.parametrize("text", BOMBS.values(), ids=BOMBS)
def test_yaml_that_grows_without_end_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(text)
    with pytest.raises(RigError) as refused:
        config.parse(config.load(str(path)))
    assert 20 < len(str(refused.value)) < 1000 and "\n" not in str(refused.value)
    cuts.make(tmp_path, "zstd", samples=100)
    (tmp_path / "source" / "metadata.yaml").write_text(text)
    assert "metadata.yaml cannot be read" in read(tmp_path / "source").notes[0]
