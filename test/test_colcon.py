"""``colcon build`` from a workspace's root, with the repository in ``src``: both packages are built, found and tested.

The ROS wheels and colcon lie in a Python environment of their own without msd_ident and msd_interfaces, so that only
what colcon built can be found. It is made once, below ``build/``, and anew when what it holds changes.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parent.parent
REQUIREMENTS = [REPOSITORY / "requirements" / name for name in ("ros-jazzy.txt", "run.txt", "colcon.txt", "lock.txt")]

pytestmark = [pytest.mark.xdist_group("colcon"), pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def colcon() -> Path:
    """Environment with ROS and colcon; its folder."""
    key = hashlib.sha256(b"".join(path.read_bytes() for path in REQUIREMENTS) + sys.version.encode()).hexdigest()[:12]
    folder = REPOSITORY / "build" / f"colcon-{key}"
    if not (folder / "done").exists():
        for old in folder.parent.glob("colcon-*"):
            shutil.rmtree(old)
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        given = [word for path in REQUIREMENTS[:3] for word in ("-r", str(path))]
        constraint = ["-c", str(REQUIREMENTS[3])] if sys.version_info >= (3, 11) else []
        installed = subprocess.run(
            [folder / "bin" / "python", "-m", "pip", "install", "-qq", "--no-input", *constraint, *given],
            capture_output=True, text=True,
        )  # fmt: skip
        assert installed.returncode == 0, installed.stderr[-2000:]
        (folder / "done").touch()
    return folder


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with what git tracks, or would track, in ``src/msd_ident``."""
    folder = tmp_path_factory.mktemp("ws")
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=REPOSITORY, capture_output=True, check=True,
    )  # fmt: skip
    for name in filter(None, listed.stdout.decode().split("\0")):
        source, target = REPOSITORY / name, folder / "src" / "msd_ident" / name
        if source.is_file() and not name.startswith(("docs/", "test/", "bench/")):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target)
    return folder


def run(colcon: Path, workspace: Path, *command: str) -> str:
    """A shell command as a user types it in the workspace, with a ROS installation sourced; what it prints."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("COLCON", "PYTHON"))}
    environment |= {
        "AMENT_PREFIX_PATH": str(colcon),
        "CMAKE_PREFIX_PATH": str(colcon),
        "LD_LIBRARY_PATH": str(colcon / "lib"),
        "PATH": f"{colcon / 'bin'}:/usr/bin:/bin",
        "COLCON_HOME": str(workspace / "home"),
    }
    environment.pop("_ROS_WHEELS_BOOTSTRAP_COMPLETE", None)
    done = subprocess.run(
        ["bash", "-c", " ".join(command)], cwd=workspace, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout + done.stderr


@pytest.mark.parametrize("options", ["", "--merge-install --symlink-install"], ids=["plain", "merged symlinks"])
def test_colcon_builds_and_tests_both_packages(colcon: Path, workspace: Path, options: str) -> None:
    for name in ("build", "install", "log"):
        shutil.rmtree(workspace / name, ignore_errors=True)
    run(colcon, workspace, "colcon build", options)
    merged = "--merge-install" if "merge" in options else ""
    run(colcon, workspace, "colcon test", merged, "--event-handlers console_direct+")
    tests, errors, failures = map(
        int, re.findall(r"(\d+) (?:tests|errors|failures)", run(colcon, workspace, "colcon test-result"))
    )
    assert tests >= 12 and errors == failures == 0
    found = run(
        colcon, workspace, ". install/setup.bash &&",
        "python -c 'import msd_interfaces.srv, msd_ident; print(msd_interfaces.__file__, msd_ident.__file__)'",
    )  # fmt: skip
    assert found.count(str(workspace)) == 2


def test_colcon_finds_the_package_in_the_workspace(colcon: Path, workspace: Path) -> None:
    assert run(colcon, workspace, "colcon list --names-only").split() == ["msd_ident"]
