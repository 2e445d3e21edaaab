"""``msd info``: what it shows of bags and tables, and the one line that others get."""

from __future__ import annotations

import json
import math
import shlex
from pathlib import Path

import pytest
from bagmaker import (
    JOINTS,
    START_NS,
    Message,
    encoder_messages,
    force_messages,
    joints,
    make_bag,
    stamps,
    step_experiment,
    storage,
)

from msd_ident.cli import main


def run(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *words: str | Path
) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of ``msd info WORDS``."""
    monkeypatch.setattr("sys.argv", ["msd", "info", *map(str, words)])
    monkeypatch.setenv("COLUMNS", "80")
    code = main.main()
    out, err = capsys.readouterr()
    return code, out, err


@pytest.fixture
def info(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    return lambda *words: run(capsys, monkeypatch, *words)


def test_a_bag_is_shown_in_80_columns(tmp_path: Path, info) -> None:
    bag = make_bag(tmp_path / "a_bag", step_experiment())
    code, out, err = info(bag)
    assert (code, err) == (0, "")
    for part in (
        "rosbag2 folder, 502 messages in 0.499 s, from 2023-11-14 22:13:20 UTC",
        "/msd/encoder sensor_msgs/msg/JointState 500 1000 0.001",
        "/msd/force geometry_msgs/msg/WrenchStamped 2 10 0.1",
        "position: /msd/encoder:position[0]",
        "500 samples in 0.499 s, 1000 Hz, 0 missing",
        "no encoder step to be seen, noise floor",
        "force: /msd/force:wrench.force.x",
        "2 samples, 0 to 10 N",
    ):
        assert part in " ".join(out.split())
    assert max(map(len, out.splitlines()[1:])) <= 80


def test_a_topic_of_a_bag_is_shown_in_one_line(repository: Path, info) -> None:
    """ "/msd/identifier/estima" and "te" below it cannot be given to an option."""
    _, out, _ = info(repository / "bags" / "paper_step")
    rows = [line.split() for line in out.splitlines() if line.startswith("/msd/")]
    assert [row[0] for row in rows] == ["/msd/encoder", "/msd/force", "/msd/identifier/estimate"]
    assert [row[2:] for row in rows] == [["6933", "999.4", "0.03986"], ["3", "0.5547", "3.016"], ["1", "–", "–"]]
    assert max(map(len, out.splitlines()[1:])) <= 80


def test_findings_and_notes_are_shown(tmp_path: Path, info) -> None:
    messages = step_experiment()
    path = storage(make_bag(tmp_path / "bag", messages[:150] + messages[250:]))
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:-50])
    code, out, _ = info(cut)
    words = " ".join(out.split())
    assert code == 0
    assert "warning: 100 of 500 samples (20 %) are missing (1 gap, the longest 0.101 s at 0.147 s)" in words
    assert "note: cut.mcap: the file ends without its index; 402 messages could be read." in words


def test_a_bag_without_the_signals_is_described_with_the_reason(tmp_path: Path, info) -> None:
    code, out, err = info(make_bag(tmp_path / "bag", encoder_messages(stamps())))
    words = " ".join(out.split())
    assert (code, err) == (0, "")
    assert "not usable as it is:" in words
    assert "has no force: no topic called force to take it from; there are: /msd/encoder" in words
    code, out, _ = info(tmp_path / "bag", "--force", "none")
    assert code == 0
    assert "force:    none, a free decay" in out


def arm(folder: Path, names: tuple[str, ...] = ("upper arm", "tool", "rail")) -> Path:
    """A bag of joint states: one that swings, one that rests, one that swings and has no effort."""
    swing = [0.4 * math.sin(0.05 * i) for i in range(400)]
    messages = [
        ("/joint_states", JOINTS, joints(ns, (x, 0.3, -x), names, (2.0 * x, 0.0)), ns)
        for ns, x in zip(stamps(400), swing, strict=True)
    ]
    return make_bag(folder, messages)


def test_options_to_paste_for_each_joint_that_moves(tmp_path: Path, info) -> None:
    bag = arm(tmp_path / "arm")
    code, out, _ = info(bag)
    assert code == 0 and "not usable as it is" in out
    pasted = [line.strip() for line in out.splitlines() if line.strip().startswith("--force")]
    assert pasted == [
        "--force '/joint_states:effort[upper arm]' --force-unit N·m --position '/joint_states:position[upper arm]' "
        "--position-unit rad",
        "--force none --position '/joint_states:position[rail]' --position-unit rad",
    ]
    assert "at rest: tool" in out
    for line in pasted:
        code, out, err = info(bag, *shlex.split(line))
        assert (code, err) == (0, "") and "400 samples in 0.399 s" in out and "at rest" not in out
    found = json.loads(info(bag, "--json", "-")[1])
    assert [(one["name"], one["moves"]) for one in found["joints"]] == [
        ("upper arm", True), ("tool", False), ("rail", True)
    ]  # fmt: skip
    assert found["joints"][0]["options"] == pasted[0]
    assert json.loads(info(make_bag(tmp_path / "rig", step_experiment()), "--json", "-")[1])["joints"] == []


def test_joints_of_one_name_are_named_by_their_place(tmp_path: Path, info) -> None:
    _, out, _ = info(arm(tmp_path / "arm", ("arm", "tool", "arm")))
    assert "--force '/joint_states:effort[0]' --force-unit N·m --position '/joint_states:position[0]'" in out
    assert "--force none --position '/joint_states:position[2]'" in out


def test_the_force_beside_a_position_is_proposed(tmp_path: Path, info) -> None:
    """Of two rigs in a bag a free decay was proposed."""
    messages = [
        message
        for rig in ("a", "b")
        for message in (*encoder_messages(stamps(), f"/{rig}/encoder"), *force_messages(topic=f"/{rig}/force"))
    ]
    bag = make_bag(tmp_path / "bag", messages)
    code, out, _ = info(bag)
    pasted = [line.strip() for line in out.splitlines() if line.strip().startswith("--force")]
    assert code == 0 and pasted == [
        f"--force /{rig}/force --force-unit N·m --position '/{rig}/encoder:position[cart]' --position-unit rad"
        for rig in ("a", "b")
    ]
    code, out, err = info(bag, *shlex.split(pasted[1]))
    assert (code, err) == (0, "") and "force:    /b/force:wrench.force.x" in out


def test_json_holds_everything(tmp_path: Path, info) -> None:
    bag = make_bag(tmp_path / "bag", step_experiment())
    code, out, err = info(bag, "--json", "-")
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert found["schema"] == "msd.info/1"
    assert found["start_ns"] == START_NS
    assert found["messages"] == 502
    assert found["position"] == "/msd/encoder:position[0]"
    assert found["force"] == "/msd/force:wrench.force.x"
    assert found["record"]["samples"] == 500
    assert found["record"]["encoder_step"] == 0
    assert found["topics"][1] == {
        "name": "/msd/encoder",
        "type": "sensor_msgs/msg/JointState",
        "messages": 500,
        "rate_hz": 1000.0,
        "longest_gap_s": 0.001,
        "reliability": "",
        "durability": "",
    }
    assert (found["findings"], found["notes"], found["problem"]) == ([], [], "")


def test_several_paths_and_one_that_fails(tmp_path: Path, info) -> None:
    good = make_bag(tmp_path / "good", step_experiment())
    target = tmp_path / "info.json"
    code, out, err = info(tmp_path / "none", good, "--json", target)
    assert code == 2
    assert "502 messages" in out
    assert err == (
        f"msd: {tmp_path / 'none'} does not exist; expected a bag folder, an .mcap or a .csv file: check the path\n"
    )
    first, second = map(json.loads, target.read_text().splitlines())
    assert "does not exist" in first["error"]
    assert second["messages"] == 502
    code, _, err = info(good, "--json", target)
    assert code == 2
    assert "exists" in err
    assert info(good, "--json", target, "--overwrite")[0] == 0


def test_a_file_of_refusals_alone_is_no_result_to_keep(tmp_path: Path, info) -> None:
    target = tmp_path / "info.json"
    assert info(tmp_path / "bag", "--json", target)[0] == 2
    assert list(json.loads(target.read_text())) == ["path", "error"]
    good = make_bag(tmp_path / "bag", step_experiment())
    assert info(good, "--json", target)[0] == 0
    assert json.loads(target.read_text())["messages"] == 502
    code, _, err = info(good, "--json", target)
    assert code == 2 and "exists" in err


@pytest.mark.parametrize("kept", ["", "kept", "[]", '{"error": "mine", "notes": 1}\n', '{"path": "a"}\n'])
def test_any_other_file_is_kept(tmp_path: Path, info, kept: str) -> None:
    target = tmp_path / "info.json"
    target.write_text(kept)
    assert info(tmp_path / "none", "--json", target)[0] == 2
    assert target.read_text() == kept


def test_a_bag_of_other_things(tmp_path: Path, info) -> None:
    messages: list[Message] = [("/chatter", "std_msgs/msg/String", b"\0\1\0\0\1\0\0\0\0", 5)]
    code, out, _ = info(make_bag(tmp_path / "bag", messages))
    assert code == 0
    assert "rosbag2 folder, 1 messages in 0.000 s" in out
    assert "/chatter  std_msgs/msg/String       1         –               –" in out


def test_a_table_is_shown(shared_data: Path, info) -> None:
    path = shared_data / "ecp210" / "step_1.csv"
    code, out, _ = info(path)
    assert code == 0
    assert "CSV file, 677 lines in 5.985 s" in out
    assert "no column called position" in " ".join(out.split())
    code, out, _ = info(path, "--force", "control_effort_v", "--position", "encoder_counts")
    assert code == 0
    assert "encoder step 1 count, noise floor 0.289 count" in out
    assert "677 samples, 0 to 0.5 V" in out


def test_every_real_file_opens_or_is_refused_in_its_one_line(shared_data: Path, info) -> None:
    folder = shared_data / "mcap"
    for path in [*sorted(folder.rglob("*.mcap")), folder / "rosbag2_tests" / "wbag"]:
        code, out, err = info(path)
        if path.name == "wrong_rmw_test_0.mcap":
            assert code == 2
            assert out == ""
            assert err == (
                f"msd: {path}: messages are encoded as 'wrong_format'; expected 'cdr', the encoding of ROS 2: "
                "record or convert the bag with ROS 2\n"
            )
            continue
        assert (code, err) == (0, ""), path
        assert "messages in" in out
        assert "not usable as it is" in out
        assert ("14 messages could be read" in " ".join(out.split())) == ("truncated" in path.name)
