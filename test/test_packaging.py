"""One package for pip, colcon and ros2: metadata in one place, and everything that must ship does."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import zipfile
from importlib import import_module
from importlib.metadata import distribution, distributions
from pathlib import Path
from xml.etree import ElementTree

import pytest
from packaging.specifiers import SpecifierSet
from sources import parsed

REPOSITORY = Path(__file__).resolve().parent.parent
LOCK = REPOSITORY / "requirements" / "lock.txt"
MANIFESTS = [REPOSITORY / "package.xml", REPOSITORY / "msd_interfaces" / "package.xml"]
LAUNCH_FILES = sorted((REPOSITORY / "launch").glob("*.launch.py"))
#: Keys of rosdep for what is not called the same.
ROSDEP_KEYS = {
    "bokeh": "python3-bokeh-pip",
    "control": "python-control-pip",
    "h5py": "python3-h5py",
    "jinja2": "python3-jinja2",
    "llvmlite": "python3-numba",  # which depends on it
    "lz4": "mcap-ros2-support",
    "markupsafe": "python3-jinja2",
    "matplotlib": "python3-matplotlib",
    "mcap": "mcap-ros2-support",
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "rich": "python3-rich",
    "rosbags": "python3-rosbags-pip",
    "scipy": "python3-scipy",
    "tornado": "python3-bokeh-pip",
    "typer": "python3-typer",
    "yaml": "python3-yaml",
    "zstandard": "mcap-ros2-support",
}
#: Of the extra `batch`, which no node needs: rosdep does not bring it, pip does.
EXTRA_ONLY = {"distributed", "pyarrow"}
NODES = {"rig", "identifier", "recorder", "replayer", "experimenter", "live"}


def manifest(path: Path) -> ElementTree.Element:
    """A package.xml, parsed."""
    return ElementTree.parse(path).getroot()


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """The wheel that `pip install .` makes, from a copy of what git tracks and would track."""
    folder = tmp_path_factory.mktemp("wheel")
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=REPOSITORY, capture_output=True, check=True,
    )  # fmt: skip
    for name in listed.stdout.decode().split("\0"):
        source = REPOSITORY / name
        if name.startswith(("test/", "bench/", "docs/", "bags/")) or not source.is_file():
            continue
        target = folder / "source" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(source.read_bytes())
    built = subprocess.run(
        [sys.executable, "setup.py", "-q", "bdist_wheel", "--dist-dir", str(folder)],
        cwd=folder / "source", capture_output=True, text=True,
    )  # fmt: skip
    assert built.returncode == 0, built.stderr
    return zipfile.ZipFile(next(folder.glob("*.whl")))


def test_one_version() -> None:
    versions = {manifest(path).findtext("version") for path in MANIFESTS}
    assert versions == {distribution("msd_ident").version}
    first = re.search(r"^## \[?v?(\d+\.\d+\.\d+)", _text("CHANGELOG.md"), re.MULTILINE)
    assert first is None or first[1] in versions


def _text(name: str) -> str:
    path = REPOSITORY / name
    return path.read_text(encoding="utf-8") if path.exists() else ""


def test_one_licence() -> None:
    assert "Apache License" in _text("LICENSE") and "Version 2.0" in _text("LICENSE")
    assert {manifest(path).findtext("license") for path in MANIFESTS} == {"Apache-2.0"}
    meta = distribution("msd_ident").metadata
    assert "Apache-2.0" in [*(meta.get_all("License") or ()), *(meta.get_all("License-Expression") or ())]


def test_version_stands_in_no_other_file() -> None:
    version = re.escape(distribution("msd_ident").version)
    for name in ("setup.py", "setup.cfg", "pyproject.toml", "msd_ident/__init__.py", "msd_interfaces/CMakeLists.txt"):
        assert not re.search(rf"(?<![\d.>=]){version}(?![\d.])", _text(name)), f"{name} repeats the version"


@pytest.mark.parametrize("entry", distribution("msd_ident").entry_points, ids=lambda entry: entry.name)
def test_entry_point_is_there(entry: object) -> None:
    name = entry.value.split(":")  # type: ignore[attr-defined]
    if "ros" in name[0].split(".") or name[0].startswith("msd_sim.node"):
        pytest.importorskip("rclpy", reason="no ROS here")
    assert callable(getattr(import_module(name[0]), name[1]))


def test_nodes_are_executables() -> None:
    scripts = {entry.name for entry in distribution("msd_ident").entry_points if entry.group == "console_scripts"}
    assert scripts == NODES | {"msd"}


def test_wheel_holds_every_file_of_the_packages(wheel: zipfile.ZipFile) -> None:
    expected = {
        path.relative_to(REPOSITORY).as_posix()
        for package in ("msd_ident", "msd_sim")
        for path in (REPOSITORY / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in (".nbi", ".nbc")
    }
    assert expected <= set(wheel.namelist())


def test_wheel_holds_what_ros_looks_for(wheel: zipfile.ZipFile) -> None:
    shared = {name.partition(".data/data/")[2] for name in wheel.namelist()}
    launch = {f"share/msd_ident/launch/{path.name}" for path in LAUNCH_FILES}
    config = {f"share/msd_ident/config/{path.name}" for path in (REPOSITORY / "config").glob("*.yaml")}
    index = {"share/ament_index/resource_index/packages/msd_ident", "share/msd_ident/package.xml"}
    assert len(launch) >= 3 and config
    assert launch | config | index <= shared


def test_ros_finds_executables_where_colcon_puts_them() -> None:
    assert "script_dir = $base/lib/msd_ident" in _text("setup.cfg")
    assert "install_scripts = $base/lib/msd_ident" in _text("setup.cfg")


@pytest.mark.xdist_group("house")
def test_manifest_names_all_that_is_imported() -> None:
    used = set()
    for path in [*(REPOSITORY / "msd_ident").rglob("*.py"), *(REPOSITORY / "msd_sim").rglob("*.py")]:
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.ImportFrom) and node.module:
                used.add(node.module.split(".")[0])
            elif isinstance(node, ast.Import):
                used |= {alias.name.split(".")[0] for alias in node.names}
    used -= {"msd_ident", "msd_sim", "msd_interfaces", *EXTRA_ONLY, *sys.stdlib_module_names}
    used.discard("typing_extensions")  # for types only
    used -= {"mujoco", "fmpy"}  # optional, and rosdep has no key for them: `pip install msd_ident[export]`
    named = {element.text for tag in ("exec_depend", "depend") for element in manifest(MANIFESTS[0]).findall(tag)}
    assert {"rclpy", "numba", "rosbags"} <= used
    assert {ROSDEP_KEYS.get(module, module) for module in used} <= named


def test_manifest_names_what_the_interfaces_in_it_need() -> None:
    own = {(entry.tag, entry.text) for entry in manifest(MANIFESTS[0]) if entry.tag.endswith("depend")}
    assert "msd_interfaces" not in {text for _, text in own}, "rosdep would look for it and fail"
    for entry in manifest(MANIFESTS[1]):
        if entry.tag.endswith("depend"):
            assert (entry.tag.replace("buildtool_", "build_"), entry.text) in own


def test_requirements_are_those_of_setup() -> None:
    given = {line for line in _text("requirements/run.txt").splitlines() if not line.startswith("#")}
    asked = set()
    for line in distribution("msd_ident").requires or []:
        requirement, _, extra = line.partition(";")
        if not extra or "live" in extra:
            asked.add(requirement.strip())
    assert given == asked


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_launch_file_starts_nodes_that_exist(path: Path) -> None:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    words = [
        {key.arg: ast.unparse(key.value).strip("'") for key in call.keywords}
        for call in calls
        if ast.unparse(call.func) == "Node"
    ]
    assert words
    by_function = {ast.unparse(call.args[0]).strip("'") for call in calls if ast.unparse(call.func) == "node"}
    assert ({word["executable"] for word in words} - {"name"}) | by_function <= NODES  # "name" is what that is given
    assert all("namespace" in word for word in words)
    text = ast.unparse(tree)
    assert "'package': 'msd_ident'" in text or all(word["package"] == "msd_ident" for word in words)


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_launch_file_names_parameter_files_that_exist(path: Path) -> None:
    named = re.findall(r'"(\w+\.yaml)"', path.read_text(encoding="utf-8"))
    assert named
    assert [name for name in named if not (REPOSITORY / "config" / name).is_file()] == []


def test_what_is_locked_installs_on_every_python_that_the_lock_is_for() -> None:
    """pip of Debian 12, whose Python is 3.11.2, refused a lock with a package for 3.11.5 and later."""
    locked = [line.partition("==")[0] for line in LOCK.read_text(encoding="utf-8").splitlines() if "==" in line]
    here = [one for name in locked for one in distributions(name=name)]
    assert len(here) > 0.9 * len(locked), "some are for other versions of Python"
    needs = {one.name: one.metadata.get("Requires-Python") or "" for one in here}
    assert [name for name, versions in needs.items() if "3.11.0" not in SpecifierSet(versions)] == []
