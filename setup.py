"""Package description, in the form that ament_python, colcon and pip all read.

The version, description, licence and maintainer are those of package.xml.
"""

import sys
from pathlib import Path
from xml.etree import ElementTree

from setuptools import find_packages, setup

NAME = "msd_ident"
ROOT = Path(__file__).resolve().parent
MANIFEST = ElementTree.parse(ROOT / "package.xml").getroot()
MAINTAINER = MANIFEST.find("maintainer")


def shared(folder: str, *patterns: str) -> tuple[str, list[str]]:
    """Files of a folder here that go to the same folder under share/msd_ident."""
    found = sorted(path for pattern in patterns for path in (ROOT / folder).glob(pattern))
    return f"share/{NAME}/{folder}", [str(path.relative_to(ROOT)) for path in found]


def commands() -> dict[str, type]:
    """Under colcon those that build msd_interfaces too; pip has no use for them."""
    sys.path.append(str(ROOT / "tools"))
    import colcon_interfaces

    return colcon_interfaces.COMMANDS if colcon_interfaces.runs() else {}


setup(
    name=NAME,
    version=MANIFEST.findtext("version"),
    description=MANIFEST.findtext("description"),
    license=MANIFEST.findtext("license"),
    maintainer=MAINTAINER.text,
    maintainer_email=MAINTAINER.get("email"),
    long_description=(ROOT / "README.md").read_text(encoding="utf-8") if (ROOT / "README.md").exists() else "",
    long_description_content_type="text/markdown",
    packages=find_packages(include=["msd_ident", "msd_ident.*", "msd_sim", "msd_sim.*"]),
    package_data={
        "": ["py.typed", "*.html", "*.css", "*.js", "*.svg", "*.j2", "*.yaml"],
        "msd_ident.export": ["templates/*"],
        "msd_ident.report": ["templates/*", "vendor/*"],
    },
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        shared("launch", "*.launch.py"),
        shared("config", "*.yaml", "foxglove_layout.json", "plotjuggler_layout.xml"),
    ],
    cmdclass=commands(),
    zip_safe=False,
    python_requires=">=3.10",
    install_requires=[
        "control>=0.10.1",
        "jinja2>=3.1",
        "llvmlite>=0.43",  # numba's; links the compiled functions
        "lz4>=4.3",
        "matplotlib>=3.8",
        "mcap>=1.5",  # the first whose writer can close a chunk by time
        "numba>=0.60",
        "numpy>=1.26",
        "pyyaml>=6.0",
        "rich>=13.7",
        "rosbags>=0.11",
        "scipy>=1.13",
        "typer>=0.16",
        "zstandard>=0.22",
    ],
    extras_require={
        "mat": ["h5py>=3.11"],  # MAT files of version 7.3
        "export": ["mujoco>=4.0", "pythonfmu>=0.7", "fmpy>=0.3.32"],  # replays of `msd export`, and its FMU
        "live": ["bokeh>=3.7"],  # the page of `msd live`; `make setup` installs it
        # Many records: `msd batch`, `msd watch` of a folder; tables in parquet; records in object stores.
        "batch": ["dask>=2024.8", "distributed>=2024.8", "fsspec>=2024.6", "pyarrow>=17.0", "s3fs>=2024.6"],
        "docs": [
            "latex2mathml>=3.77",
            "mkdocs>=1.6,<2",
            "mkdocs-material>=9.6",
        ],
        "test": [
            "fmpy>=0.3.32",
            "h5py>=3.11",
            "hypothesis>=6.100",
            "flask>=3.0",  # with flask-cors: the server of moto, an object store on this machine
            "flask-cors>=5.0",
            "moto[s3]>=5.0",
            "mujoco>=4.0",
            "mypy>=1.11",
            "playwright>=1.45",  # drives the Chromium of the machine
            "plotly>=6.0",  # says whether the page's figures are valid
            "pythonfmu>=0.7",
            "pytest>=8.2,<9.2",  # 9.2 loses the groups of pytest-xdist up to 3.8 (its issue 1386)
            "pytest-timeout>=2.3",
            "pytest-xdist>=3.7",
            "ruff>=0.6",
            "scipy-stubs>=1.14",
            "setuptools>=70.1,<80",  # makes wheels by itself, and still has what colcon calls
            "types-PyYAML>=6.0",
        ],
    },
    entry_points={
        "console_scripts": [
            "msd = msd_ident.cli.main:main",
            # Nodes, for `ros2 run msd_ident NAME` and the launch files.
            "rig = msd_sim.node:main",
            "identifier = msd_ident.ros.identifier.__main__:main",
            "live = msd_ident.ros.live.__main__:main",
            "recorder = msd_ident.ros.recorder.__main__:main",
            "experimenter = msd_ident.ros.experimenter.__main__:main",
            "replayer = msd_ident.ros.replayer.__main__:main",
        ],
        # How `msd simulate` finds a rig without importing one: the first is used by default.
        "msd.rigs": ["default = msd_sim.api:simulate"],
        # What `msd warm` compiles beforehand.
        "msd.warm": ["solver = msd_ident.model:warm_up", "rig = msd_sim.node.preparing:warm_up"],
    },
)
