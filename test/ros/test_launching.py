"""Launch arguments are read in the spellings people use, and refused in words before anything starts."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from msd_ident.errors import UsageError
from msd_ident.ros.common.launch_arguments import LOG_LEVELS, Arguments


def given(**texts: str) -> Arguments:
    return Arguments(texts)


@pytest.mark.parametrize(
    ("text", "value"), [("True", True), ("true", True), ("1", True), ("False", False), ("0", False)]
)
def test_switch_takes_the_usual_spellings(text: str, value: bool) -> None:
    assert given(use_sim_time=text).switch("use_sim_time") is value


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        ("switch", "maybe", "it:=maybe; expected true or false, e.g. it:=true"),
        ("port", "abc", "it:=abc; expected a port, 0 to 65535, e.g. it:=8210"),
        ("port", "70000", "it:=70000; expected a port, 0 to 65535"),
        ("port", "-1", "it:=-1; expected a port"),
        ("namespace", "1msd", "it:=1msd; expected letters, digits and _ between slashes"),
        ("namespace", "a b", "it:=a b; expected letters"),
        ("parameters", "/nope.yaml", "it:=/nope.yaml (there is no such file); expected the path of a YAML file"),
        ("bag", "/nope", "it:=/nope (there is nothing there); expected a rosbag2 folder or an .mcap file"),
    ],
)
def test_nonsense_is_refused_in_words(kind: str, text: str, words: str) -> None:
    with pytest.raises(UsageError, match=f"^{re.escape(words)}"):
        getattr(given(it=text), kind)("it", *(["rig"] if kind == "parameters" else []))


@pytest.mark.parametrize("text", ["abc", "nan", "0", "-2", "inf"])
def test_rate_is_a_number_in_its_range(text: str) -> None:
    with pytest.raises(UsageError, match=rf"^rate:={text}; expected a number from 0.01 to 100, e.g. rate:=1.0$"):
        given(rate=text).number("rate", 0.01, 100.0)
    assert given(rate="2").number("rate", 0.01, 100.0) == 2.0


def test_log_level_is_one_of_ros() -> None:
    assert given(log_level="DEBUG").word("log_level", LOG_LEVELS) == "debug"
    with pytest.raises(UsageError, match="^log_level:=loud; expected one of debug, info, warn, error, fatal"):
        given(log_level="loud").word("log_level", LOG_LEVELS)


@pytest.mark.parametrize("text", ["mass: 1.0\n", "- 1\n", "", "a: [\n", "/**: {ros__parameters: {a: 1, a: 2}}\n"])
def test_parameter_file_must_be_one(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(text)
    with pytest.raises(UsageError, match=r"rig.yaml \(.*\); expected (YAML|a ROS 2 parameter file)"):
        given(rig_params=str(path)).parameters("rig_params", "msd/rig")


@pytest.mark.parametrize("name", ["ecp", "identifier", "recorder"])
def test_parameter_files_that_ship_are_taken(repository: Path, name: str) -> None:
    path = repository / "config" / f"{name}.yaml"
    assert given(params=str(path)).parameters("params", f"/msd/{name}") == str(path)


#: As rcl takes them: a name without a namespace is one of the root.
@pytest.mark.parametrize(
    ("keys", "fits"),
    [
        ("/**", True), ("**", True), ("/msd/rig", True), ("msd/rig", True), ("msd: rig", True), ("/**/rig", True),
        ("/*/rig", True), ("/msd: '*'", True), ("rig", False), ("/rig", False), ("/lab/rig", False),
        ("/msd/rig2", False), ("/*", False), ("/msd", False),
    ],
)  # fmt: skip
def test_parameter_file_is_for_the_node(tmp_path: Path, keys: str, fits: bool) -> None:
    """The rig would start with its defaults, and nobody would know."""
    path = tmp_path / "rig.yaml"
    words = keys.replace("'", "").split(": ")
    lines = [f"{'  ' * depth}'{word}':" for depth, word in enumerate([*words, "ros__parameters", "frame_id"])]
    path.write_text("\n".join(lines) + " bench\n")
    if fits:
        assert given(rig_params=str(path)).parameters("rig_params", "msd/rig") == str(path)
        return
    with pytest.raises(UsageError, match=r"it is for .*, and not for /msd/rig\); expected parameters below /\*\*"):
        given(rig_params=str(path)).parameters("rig_params", "msd/rig")
