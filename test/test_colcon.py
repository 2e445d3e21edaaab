"""``colcon build`` from a workspace's root, with the repository in ``src``: both packages are built, found and tested.

The ROS wheels and colcon lie in a Python environment of their own without msd_ident and msd_interfaces, so that only
what colcon built can be found. It is made once, below ``build/``, and anew when what it holds changes: of hard links to
what ``make setup`` installed. So is what the generators and the compiler make of the messages, most of a build; what
they made of the same messages in ``make setup`` is taken, but for the headers of C++, by which a generator is seen to
run under colcon.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from contextlib import suppress
from importlib.metadata import Distribution, PackageNotFoundError, PackagePath
from itertools import chain
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

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
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
        for distribution in required({"pip", *chain.from_iterable(map(names, REQUIREMENTS[:3]))}):
            if whole(distribution):
                link(distribution, folder)
        given = [word for path in REQUIREMENTS[:3] for word in ("-r", str(path))]
        constraint = ["-c", str(REQUIREMENTS[3])] if sys.version_info >= (3, 11) else []
        installed = subprocess.run(
            [folder / "bin" / "python", "-m", "pip", "install", "-qq", "--no-input", *constraint, *given],
            capture_output=True, text=True,
        )  # fmt: skip
        assert installed.returncode == 0, installed.stderr[-2000:]
        (folder / "done").touch()
    return folder


def names(requirements: Path) -> list[str]:
    """Packages of a requirements file."""
    lines = (line.partition("#")[0].strip() for line in requirements.read_text(encoding="utf-8").splitlines())
    return [Requirement(line).name for line in lines if line]


def required(wanted: set[str]) -> list[Distribution]:
    """Those that are here, with all that they require in their turn."""
    found: dict[str, Distribution] = {}
    while wanted:
        name = canonicalize_name(wanted.pop())
        with suppress(PackageNotFoundError):
            if name not in found:
                found[name] = Distribution.from_name(name)
                needs = map(Requirement, found[name].requires or [])
                wanted |= {need.name for need in needs if not need.marker or need.marker.evaluate({"extra": ""})}
    return list(found.values())


def whole(distribution: Distribution) -> bool:
    """Whether all files are its own: another package may have put files of the same names into their place."""
    found = [(path, file.size) for path, file in files(distribution)]
    return all(path.is_file() and size in (None, path.stat().st_size) for path, size in found)


def files(distribution: Distribution) -> list[tuple[Path, PackagePath]]:
    """What it installed: where that lies, and what was noted of it; not what Python compiled."""
    listed = [file for file in distribution.files or [] if file.suffix != ".pyc"]
    return [(Path(os.path.normpath(str(distribution.locate_file(file)))), file) for file in listed]


def link(distribution: Distribution, folder: Path) -> None:
    """Put what ``make setup`` installed into another environment too; scripts start that one's interpreter."""
    for source, _ in files(distribution):
        target = folder / source.relative_to(sys.prefix)
        if not source.is_file() or target.exists():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.parent == folder / "bin":
            target.write_bytes(source.read_bytes().replace(sys.prefix.encode(), str(folder).encode()))
            target.chmod(0o755)
        else:
            os.link(source, target)


@pytest.fixture(scope="module")
def workspace(colcon: Path) -> Path:
    """A workspace with what git tracks, or would track, in ``src/msd_ident``; the messages of a run before stay."""
    folder, made_of = REPOSITORY / "build" / "colcon-workspace", _messages(colcon)
    note = folder / "messages"
    if not note.exists() or note.read_text() != made_of:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        for made in _compiled().glob("rosidl_*"):
            if made.is_dir() and made.name not in MADE_AGAIN:
                shutil.copytree(made, folder / "build" / "msd_ident" / "msd_interfaces" / made.name)
        note.write_text(made_of)
    for name in ("src", "home"):
        shutil.rmtree(folder / name, ignore_errors=True)
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=REPOSITORY, capture_output=True, check=True,
    )  # fmt: skip
    for name in filter(None, listed.stdout.decode().split("\0")):
        source, target = REPOSITORY / name, folder / "src" / "msd_ident" / name
        if source.is_file() and not name.startswith(("docs/", "test/", "bench/")):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target)
    (folder / "compiler").write_text(COMPILER.format(compiled=_compiled()))
    (folder / "compiler").chmod(0o755)
    return folder


#: Folders that are not taken from the setup's build.
MADE_AGAIN = ("rosidl_cmake", "rosidl_generator_cpp")

#: Takes an object of the setup's build, with what it depends on, where both generated the same source. Nobody runs the
#: other messages fast: what would be optimised is not, after all other options.
COMPILER = """\
#!/bin/sh
for word; do
    [ "$last" = -o ] && object=$word
    last=$word
done
made={compiled}
if cmp -s "$last" "$made/${{last##*/build/msd_ident/msd_interfaces/}}" && [ -s "$made/$object.d" ]; then
    exec cp "$made/$object" "$made/$object.d" "${{object%/*}}"
fi
exec "$@" -O0
"""


def _compiled() -> Path:
    """Where ``make setup`` built the messages; a place with nothing if they have changed since."""
    folder = REPOSITORY / "build" / "venv" / "msd_interfaces"
    library = folder / "libmsd_interfaces__rosidl_generator_c.so"
    made = library.stat().st_mtime if library.exists() else 0.0
    return folder if made > max(path.stat().st_mtime for path in _sources()) else Path(os.devnull)


def _sources() -> list[Path]:
    """Files that the messages are made of."""
    return [path for name in ("msd_interfaces", "cmake") for path in sorted((REPOSITORY / name).rglob("*.*"))]


def _messages(colcon: Path) -> str:
    """What compiled messages depend on."""
    inputs = [REPOSITORY / "tools" / "colcon_interfaces.py", *_sources()]
    content = b"".join(str(path).encode() + path.read_bytes() for path in inputs)
    return f"{colcon.name} {hashlib.sha256(content).hexdigest()}"


def run(colcon: Path, workspace: Path, *command: str) -> str:
    """A shell command as a user types it in the workspace, with a ROS installation sourced; what it prints."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("COLCON", "PYTHON"))}
    environment |= {
        "AMENT_PREFIX_PATH": str(colcon),
        "CMAKE_PREFIX_PATH": str(colcon),
        "LD_LIBRARY_PATH": str(colcon / "lib"),
        "PATH": f"{colcon / 'bin'}:/usr/bin:/bin",
        "COLCON_HOME": str(workspace / "home"),
        "CMAKE_C_COMPILER_LAUNCHER": str(workspace / "compiler"),
        "CMAKE_CXX_COMPILER_LAUNCHER": str(workspace / "compiler"),
    }
    environment.pop("_ROS_WHEELS_BOOTSTRAP_COMPLETE", None)
    done = subprocess.run(
        ["bash", "-c", " ".join(command)], cwd=workspace, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout + done.stderr


def clear(workspace: Path) -> None:
    """As before any build, but for what the compiler made of the messages: that is the same for all options."""
    for name in ("install", "log"):
        shutil.rmtree(workspace / name, ignore_errors=True)
    for path in (workspace / "build" / "msd_ident").glob("*"):
        if path.is_symlink() or path.is_file():
            path.unlink()
        elif path.name != "msd_interfaces":
            shutil.rmtree(path)


@pytest.mark.parametrize(
    "options",
    ["", pytest.param("--merge-install --symlink-install", marks=pytest.mark.long)],
    ids=["plain", "merged symlinks"],
)
def test_colcon_builds_and_tests_both_packages(colcon: Path, workspace: Path, options: str) -> None:
    clear(workspace)
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
