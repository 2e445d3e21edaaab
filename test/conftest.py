"""What all tests share: a ROS domain of their own, the measured data, and how hypothesis draws."""

from __future__ import annotations

import gc
import itertools
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers

from msd_ident import parallel
from msd_ident.ros.common.domain import private_domain

REPOSITORY = Path(__file__).resolve().parent.parent

# The same examples each time; `HYPOTHESIS_PROFILE=explore` draws new ones.
settings.register_profile("steady", deadline=None, derandomize=True)
settings.register_profile("explore", deadline=None, max_examples=500)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "steady"))
# Nor others with every number that changes in the source, or with what a process has imported before: hypothesis would
# parse all modules to draw from their constants, for seconds in each process.
providers._get_local_constants = lambda: providers._local_constants

#: Tests of many seconds, longest first; the soak mostly waits, so that others run beside it.
LONGEST = (
    "test_colcon", "ros/test_faults", "[step_1", "test_nobody_wakes", "test_new_effect",
    "test_starting_points", "test_never_worse", "test_investigation", "test_what_a_hand_moved", "blind/",
    "test_a_demo_finds_the_rig", "docs/test_tutorial", "docs/test_pages", "ros/test_huge_bag", "test_deterministic",
    "batching/", "live/", "report/", "ros/", "selection/", "residuals/", "diagnosis/", "design/", "export/test_ext",
    "test_fooled", "test_pipeline", "cli/", "estimate/", "test_laws", "test_lottery", "msd_sim/test_node",
)  # fmt: skip

#: What makes a fresh checkout compile, in two processes that take about as long; in two seconds where that is done. The
#: solver is most of it: the other compiles the rig and what the solver does not need.
COMPILING = (
    "from msd_ident.model import solver; solver.LIBRARY.load()",
    """
from msd_sim.rig import Rig
from msd_sim.truth import Truth
from msd_ident.compiled import Library, folders, loading
from msd_ident.workflow import warming
Rig(Truth(1.0, 1.0, 100.0, {})).sample([0.0])
missing = [one.declared_in for one in Library.known if not folders.object_file(one).exists()]
loading.build_here([name for name in missing if name != "msd_ident.model.solver"])
""",
)

_claim = pytest.StashKey[ExitStack]()
#: Each test begins to look for a domain behind the one before: what that one left there may take a while to go.
_next_domain = itertools.count(17 * os.getpid())


def pytest_configure(config: pytest.Config) -> None:
    """Give each test process its own ROS domain, before anything starts a node, and one thread of BLAS.

    Of several test processes, each works with one thread: they share the cores.
    """
    parallel.one_blas_thread()
    config.stash[_claim] = ExitStack()
    if hasattr(config, "workerinput"):
        config.stash[_claim].enter_context(parallel.limited_to(1))
    os.environ["ROS_DOMAIN_ID"] = str(config.stash[_claim].enter_context(private_domain(next(_next_domain))))
    # ROS's own range LOCALHOST would add shared memory to what the file says.
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "SYSTEM_DEFAULT"
    os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(REPOSITORY / "test" / "loopback.xml")
    # A run in the background begins with SIGINT ignored, and so would every process that a test interrupts.
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile solver, fits and rig once, where several test processes would begin by compiling each its own."""
    if getattr(session.config.option, "numprocesses", None) and not hasattr(session.config, "workerinput"):
        works = [subprocess.Popen([sys.executable, "-c", code], cwd=REPOSITORY) for code in COMPILING]
        for work in works:
            work.wait()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[object]:
    """Collecting leaves no garbage: to look for some took a fifth of its time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


def pytest_collection_finish(session: pytest.Session) -> None:
    """What collecting made lives until the end: the garbage collector need not walk through it at every turn."""
    gc.collect()
    gc.freeze()


def pytest_unconfigure(config: pytest.Config) -> None:
    """Free the domain."""
    config.stash[_claim].close()


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A domain id for this test alone; contexts and processes that it starts are in it."""
    with private_domain(next(_next_domain)) as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        yield domain


@pytest.fixture
def without_copies(monkeypatch: pytest.MonkeyPatch) -> None:
    """No diagnosis makes copies of its record unasked: for tests of what is found before them."""
    monkeypatch.setattr("msd_ident.selection.replication._CHEAP", 0.0)


@pytest.fixture
def asking_about(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """To call with names of causes, about which alone diagnoses ask: for tests of what follows a search."""

    def ask(*causes: str) -> None:
        real = searching.prepare
        monkeypatch.setattr(searching, "prepare", lambda task: replace(real(task), asked=frozenset(causes)))

    from msd_ident.diagnosis import searching

    return ask


@pytest.fixture
def looking_for(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """To call with names of causes: a design looks for no others behind what stands."""

    def look(*causes: str) -> None:
        monkeypatch.setattr("msd_ident.design.hidden_effects.LIBRARY", tuple(map(by_name, causes)))

    from msd_ident.model.effects import by_name

    return look


@pytest.fixture(scope="session")
def repository() -> Path:
    """The repository's root."""
    return REPOSITORY


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of the measured data, which lies beside the repository and never inside it."""
    folder = Path(os.environ.get("MSD_SHARED_DATA", REPOSITORY.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no measured data at {folder}; MSD_SHARED_DATA names the folder")
    return folder


#: Longest that a test in a browser may take [s]: more than its longest wait, which says what it waited for.
PATIENT = 600


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest begin first, so that no process has a long one left when the others are done.

    A test in a browser waits longer for one thing (``chromium.PATIENCE``) than other tests may take as a whole.
    """
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.timeout(PATIENT))

    def place(item: pytest.Item) -> int:
        return next((place for place, name in enumerate(LONGEST) if name in item.nodeid), len(LONGEST))

    items.sort(key=place)
