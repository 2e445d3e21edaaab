"""Build and install ``msd_interfaces`` with ``msd_ident``, when colcon runs ``setup.py``.

colcon looks for no package below a folder that is one, so it finds ``msd_ident`` in the root of a checkout and never
``msd_interfaces`` in it. Its commands ``install`` and ``develop`` (``--symlink-install``) therefore run CMake for the
interfaces too, into the same prefix: one package for colcon, two on the graph, in ``ros2 pkg list`` and for CMake.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools.command.develop import develop
from setuptools.command.install import install

ROOT = Path(__file__).resolve().parent.parent
#: Folders that colcon puts before all others while it runs setup.py: they say that the prefix is the workspace's.
_COLCON = ("prefix_override", "colcon_distutils_commands")


def runs() -> bool:
    """Whether colcon is building: it has put its prefix in the place of the interpreter's."""
    return hasattr(sys, "real_prefix") and any(Path(entry).name == _COLCON[0] for entry in sys.path)


def build(folder: Path, prefix: Path) -> None:
    """Configure, build and install the interfaces.

    Args:
        folder: for what CMake makes.
        prefix: to install into.

    Raises:
        SystemExit: no CMake is here, or it failed; its words stand above.
    """
    cmake = shutil.which("cmake")
    if cmake is None:
        raise SystemExit("msd_interfaces needs cmake, which is not here; install it: apt install cmake g++")
    configure = [
        *(cmake, "-S", ROOT / "msd_interfaces", "-B", folder, f"-DCMAKE_INSTALL_PREFIX={prefix}"),
        *("-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF", f"-DPython3_EXECUTABLE={sys.executable}"),
        f"-DCMAKE_PROJECT_INCLUDE={ROOT / 'cmake' / 'fix_wheels.cmake'}",
    ]
    for command in (configure, [cmake, "--build", folder, "--parallel"], [cmake, "--install", folder]):
        done = subprocess.run([str(word) for word in command], env=_environment(), check=False)
        if done.returncode:
            raise SystemExit(
                f"msd_interfaces did not build: {command[1]} ended with {done.returncode}; expected a sourced ROS 2 "
                "and `rosdep install --from-paths src --ignore-src` before"
            )


def _environment() -> dict[str, str]:
    """This one without what colcon puts before it: CMake asks Python for its real prefix."""
    paths = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    kept = [path for path in paths if path and Path(path).name not in _COLCON]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(kept)}


class InstallBoth(install):
    """``setup.py install`` of ``colcon build``."""

    def run(self) -> None:
        """Install the Python package, then the interfaces."""
        super().run()
        build(Path(self.get_finalized_command("build").build_base).parent / "msd_interfaces", Path(sys.prefix))


class DevelopBoth(develop):
    """``setup.py develop`` of ``colcon build --symlink-install``."""

    def run(self) -> None:
        """Link the Python package, then install the interfaces."""
        super().run()
        if not self.uninstall:
            build(Path.cwd() / "msd_interfaces", Path(sys.prefix))


COMMANDS = {"install": InstallBoth, "develop": DevelopBoth}
