"""``repair``: what was cut off is finished, what was lost is said in numbers, nothing is thrown away."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from badinputs import run
from bagmaker import JOINTS, START_NS, encoder_messages, make_bag, stamps, step_experiment, storage
from rosbags.rosbag2 import Reader

from bench.reliability import cuts
from msd_ident.errors import DataError, UsageError
from msd_ident.io import BagWriter, open_bag, repair
from msd_ident.io.crash_safe_file import copies_of


def killed(folder: Path, messages: int = 500, flushed: int = 400) -> Path:
    """A bag as a kill leaves it: a copy of the folder of a recorder that still writes."""
    live = folder.with_name(f"{folder.name}_live")
    writer = BagWriter(live)
    writer.add_topic("/msd/encoder", JOINTS)
    for i, (topic, _, raw, log_time) in enumerate(encoder_messages(stamps(messages))):
        writer.write(topic, raw, log_time)
        if i == flushed - 1:
            writer.flush()
    shutil.copytree(live, folder)
    writer.close()
    return folder


def texts(folder: Path) -> list[bytes]:
    return [message.data for message in open_bag(folder).messages()]


def test_a_whole_bag_is_left_alone(tmp_path: Path) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment())
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    done = repair(folder)
    assert (done.changed, done.messages, done.lost, done.notes) == (False, 502, 0, ())
    assert done.sentence.endswith("502 messages, none lost; nothing to repair")
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_a_killed_recording_is_finished(tmp_path: Path) -> None:
    folder = killed(tmp_path / "bag")
    done = repair(folder)
    assert (done.changed, done.messages, done.lost, done.open_seconds) == (True, 400, 0, 1.0)
    assert done.sentence.endswith(
        "400 messages, none lost of what was on the disk; up to 1 s before the recording broke off never got there "
        "(at its rate 1003 messages)"
    )
    assert sorted(path.name for path in folder.iterdir()) == ["bag_live_0.mcap", "metadata.yaml"]
    cut_off = "the recording was cut off: up to 1 s before its end may be missing."
    assert open_bag(folder).notes == (cut_off,)
    with Reader(folder) as reader:
        assert reader.message_count == 400
    assert not repair(folder).changed


def test_a_copy_that_has_more_is_taken(tmp_path: Path) -> None:
    """Killed between the last write and the change of names."""
    folder = killed(tmp_path / "bag")
    newer = make_bag(tmp_path / "newer", encoder_messages(stamps(450)))
    copy = copies_of(storage(folder))[0]
    shutil.copy(storage(newer), copy)
    assert repair(folder).messages == 450
    assert texts(folder) == texts(newer)


def test_a_file_that_is_cut_off_gets_its_index_and_the_loss_is_said(tmp_path: Path) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment(), compression="none")
    path = storage(folder)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    found = texts(folder)
    done = repair(folder)
    assert done.messages == len(found)
    assert (done.exact, done.lost) == (True, 502 - len(found)), "metadata.yaml knew how many there were"
    whole = START_NS + 499_000_000
    assert done.seconds == pytest.approx((whole - done.entry.files[0].last_ns) / 1e9), "metadata.yaml knew its end"
    assert done.sentence.endswith(f"{done.lost} lost ({done.seconds:.3g} s)")
    assert any("is kept as bag_0.mcap.damaged" in note for note in done.notes)
    assert (folder / "bag_0.mcap.damaged").read_bytes() == content[: len(content) // 2]
    assert texts(folder) == found
    with Reader(folder) as reader:
        assert reader.message_count == len(found)
    assert open_bag(folder).notes == (f"the recording was cut off: {done.lost} messages are lost.",)


def test_without_metadata_the_loss_is_told_from_the_sizes(tmp_path: Path) -> None:
    whole = cuts.make(tmp_path, "none", flush_every=100)
    (_, before), (end, until) = whole.chunks[1:3]
    alone = tmp_path / "alone.mcap"
    alone.write_bytes(whole.content[: end - 4000])
    done = repair(alone)
    assert before + 50 < done.messages < until
    assert not done.exact
    assert abs(done.lost - (until - done.messages)) <= 2
    assert done.seconds == pytest.approx((until - done.messages) / 1000 / 2, rel=0.2)  # force and position at 1 kHz
    assert f"about {done.lost} lost" in done.sentence


def test_a_time_that_nothing_tells_is_not_said(tmp_path: Path) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment(), compression="none")
    done = replace(repair(folder), lost=12, seconds=0.0, exact=False, changed=True)
    assert done.sentence.endswith("502 messages, about 12 lost")


def test_a_file_of_nothing_is_set_aside(tmp_path: Path) -> None:
    folder = make_bag(tmp_path / "bag", step_experiment())
    storage(folder).write_bytes(b"")
    done = repair(folder)
    assert (done.messages, done.lost, done.exact) == (0, 502, True)
    assert done.seconds == pytest.approx(0.499)
    assert texts(folder) == []
    assert (folder / "bag_0.mcap.damaged").exists()


def test_a_bag_that_is_being_recorded_is_left_alone(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag") as writer:
        writer.add_topic("/msd/encoder", JOINTS)
        with pytest.raises(UsageError, match="is being recorded; .* stop the recorder first"):
            repair(tmp_path / "bag")
        with pytest.raises(UsageError, match="is being recorded"):
            BagWriter(tmp_path / "bag", overwrite=True)
    assert not repair(tmp_path / "bag").changed


@pytest.mark.parametrize(
    ("name", "kind", "words"),
    [("nothing", DataError, "does not exist"), ("bag.db3", UsageError, "is no .mcap file; expected one")],
)
def test_what_cannot_be_repaired_is_refused(tmp_path: Path, name: str, kind: type[Exception], words: str) -> None:
    (tmp_path / "bag.db3").write_bytes(b"SQLite format 3\0")
    with pytest.raises(kind, match=words):
        repair(tmp_path / name)


def test_the_command_says_what_it_did(tmp_path: Path) -> None:
    folder = killed(tmp_path / "bag")
    done = run("repair", folder, tmp_path / "nothing")
    assert done.code == 2
    assert "400 messages, none lost of what was on the disk; up to 1 s before" in done.out
    assert done.err.count("\n") == 1 and "nothing does not exist" in done.err
    again = run("repair", folder, "--json", "-")
    assert again.code == 0
    assert json.loads(again.out) == {
        "schema": "msd.repair/1",
        "path": str(folder),
        "changed": False,
        "messages": 400,
        "lost_messages": 0,
        "lost_exact": True,
        "lost_s": 0,
        "unknown_s": 0.0,
        "notes": [],
    }
