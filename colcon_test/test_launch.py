"""Launch files refuse what makes no sense before anything starts. On a ROS installation, which has launch."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("launch_ros", reason="launch is not here: it comes with a ROS installation")

from ament_index_python.packages import get_package_share_directory  # noqa: E402

#: `ros2 launch` without ros2cli's daemon.
LAUNCH = (
    "import sys; from launch import LaunchDescription, LaunchService;"
    "from launch.actions import IncludeLaunchDescription;"
    "from launch.launch_description_sources import PythonLaunchDescriptionSource as S;"
    "s = LaunchService(noninteractive=True); s.include_launch_description(LaunchDescription([IncludeLaunchDescription("
    "S(sys.argv[1]), launch_arguments=[tuple(a.split(':=')) for a in sys.argv[2:]])])); sys.exit(s.run())"
)


def children(mark: str) -> list[int]:
    """Processes that carry a mark in their environment."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if mark.encode() in (folder / "environ").read_bytes():
                found.append(int(folder.name))
        except OSError:
            continue
    return found


@pytest.mark.parametrize(
    ("file", "argument", "words"),
    [
        ("pipeline", "live_port:=abc", "live_port:=abc; expected a port"),
        ("pipeline", "rig_params:=/nope.yaml", "rig_params:=/nope.yaml (there is no such file)"),
        ("pipeline", "use_sim_time:=maybe", "use_sim_time:=maybe; expected true or false"),
        ("identifier", "params:=/nope.yaml", "params:=/nope.yaml (there is no such file)"),
        ("identifier", "log_level:=loud", "log_level:=loud; expected one of"),
        ("replay", "rate:=abc", "rate:=abc; expected a number from 0.01 to 100"),
        ("replay", "respawn:=maybe", "respawn:=maybe; expected true or false"),
    ],
)
def test_bad_argument_starts_nothing(file: str, argument: str, words: str, tmp_path: Path) -> None:
    """A launch file checks its arguments before it starts any node, and says in one line what is expected."""
    path = Path(get_package_share_directory("msd_ident")) / "launch" / f"{file}.launch.py"
    mark = f"MSD_LAUNCH_MARK={tmp_path}"
    name, value = mark.split("=")
    more = [f"bag:={tmp_path}"] if file == "replay" else []
    done = subprocess.run(
        [sys.executable, "-c", LAUNCH, str(path), *more, argument],
        env={**os.environ, name: value, "ROS_LOG_DIR": str(tmp_path)}, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 1 and words in done.stdout + done.stderr
    assert "process started" not in done.stdout + done.stderr
    assert children(mark) == []
