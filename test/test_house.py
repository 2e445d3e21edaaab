"""The house's rules, read off the imports: one way only, and each library in its room."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from sources import parsed

from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.law import KINDS

REPOSITORY = Path(__file__).resolve().parent.parent

#: One process parses all modules.
pytestmark = pytest.mark.xdist_group("house")

#: Rooms of msd_ident, lowest first: a room knows itself and those before it.
STOREYS = (
    ("errors", "quantity", "seeds", "cancellation", "tuning"),
    ("paths", "writing", "strict_yaml", "parallel", "compiled"),
    ("data",),
    ("model",),
    ("features",),
    ("estimate",),
    ("paper",),
    ("residuals",),
    ("selection",),
    ("diagnosis",),
    ("design",),
    ("workflow",),
    ("batching",),
    ("comparison", "monitoring"),
    ("export",),
    ("external",),
    ("report",),
    ("live",),
    ("ros",),
    ("cli",),
)
FLOOR = {room: floor for floor, rooms in enumerate(STOREYS) for room in rooms}

#: Readers and writers stand beside the storeys.
IO_KNOWS = {"errors", "paths", "writing", "data"}
KNOW_IO = {"batching", "ros", "cli"}

ROS = (
    *("rclpy", "action_msgs", "builtin_interfaces", "diagnostic_msgs", "geometry_msgs", "msd_interfaces"),
    *("rcl_interfaces", "rosgraph_msgs", "rosidl_runtime_py", "sensor_msgs", "std_msgs", "std_srvs"),
)

#: Modules with functions for numba to compile, which nothing imports but what compiles them.
LOOPS = tuple(
    ".".join(path.relative_to(REPOSITORY).with_suffix("").parts) for path in REPOSITORY.glob("msd_ident/*/*_loops.py")
)

#: Library -> the only places that may import it.
AT_HOME = {
    **dict.fromkeys(ROS, ("msd_ident.ros", "msd_sim.node")),
    **dict.fromkeys(("rosbags", "mcap"), ("msd_ident.io",)),
    **dict.fromkeys(("matplotlib", "plotly"), ("msd_ident.report",)),
    **dict.fromkeys(("jinja2", "markupsafe"), ("msd_ident.report", "msd_ident.live")),
    **dict.fromkeys(("typer", "click"), ("msd_ident.cli",)),
    **dict.fromkeys(("bokeh", "tornado"), ("msd_ident.live",)),
    **dict.fromkeys(("dask", "distributed", "fsspec", "pyarrow"), ("msd_ident.batching",)),
    "rich": ("msd_ident.cli", "msd_ident.report"),
    "h5py": ("msd_ident.io",),
    "llvmlite": ("msd_ident.compiled",),
    "numba": ("msd_ident.compiled.build", "msd_ident.model.kernel", "msd_sim", *LOOPS),
    **dict.fromkeys(("mujoco", "fmpy"), ("msd_ident.export",)),
}

LONGEST_FUNCTION = 60
#: Parameters from which on a function has many, and how many of msd_ident may have: commands, one for each option;
#: the innermost functions of the solver; and a few that are called from outside. Laws of effects are not counted: the
#: names of their parameters say what they depend on.
MANY_PARAMETERS, MOST_WITH_MANY = 6, 21

#: The one module outside the library that names single effects and their parameters: the dry friction and the offset of
#: the paper's base model. All others ask an effect for what it is (a role, a sign, a sentence, a bound).
NAMES_EFFECTS = {"msd_ident.model.base_model"}


def name_of(path: Path) -> str:
    """Dotted name of a module."""
    parts = path.relative_to(REPOSITORY).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def modules() -> dict[str, ast.Module]:
    """All modules of both packages, parsed."""
    paths = [path for package in ("msd_ident", "msd_sim") for path in sorted((REPOSITORY / package).rglob("*.py"))]
    return {name_of(path): parsed(path) for path in paths}


def imported(tree: ast.AST, *, at_start: bool = False) -> Iterator[str]:
    """Dotted names that a module imports; ``from a import b`` counts as ``a.b``, which may be a module.

    ``at_start`` leaves out what is imported inside functions or for type checkers only.
    """
    for node in _at_start(tree) if at_start else ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide the direction"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _at_start(node: ast.AST) -> Iterator[ast.AST]:
    for child in ast.iter_child_nodes(node):
        lazy = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef)
        typing = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)
        if not lazy and not typing:
            yield child
            yield from _at_start(child)


@cache
def edges() -> tuple[tuple[str, str], ...]:
    """(module, what it imports) over both packages."""
    return tuple((name, target) for name, tree in modules().items() for target in imported(tree))


def room_of(name: str) -> str:
    """``fit`` of ``msd_ident.estimate.least_squares``; empty for the package itself."""
    return [*name.split("."), ""][1]


def within(name: str, places: tuple[str, ...]) -> bool:
    """Whether a module is one of the places or lies inside one."""
    return any(name == place or name.startswith(f"{place}.") for place in places)


def test_every_room_is_known() -> None:
    rooms = {room_of(name) for name in modules() if name.startswith("msd_ident.")}
    assert rooms <= {*FLOOR, "io"}, "say in STOREYS where the new room stands"


def test_imports_point_one_way() -> None:
    upward = []
    for name, target in edges():
        here, there = room_of(name), room_of(target)
        inside = name.startswith("msd_ident.") and target.startswith("msd_ident.") and here != there
        if not inside or there not in {*FLOOR, "io"}:
            continue
        if here == "io":
            allowed = there in IO_KNOWS
        elif there == "io":
            allowed = here in KNOW_IO
        else:
            allowed = FLOOR[there] < FLOOR[here]
        if not allowed:
            upward.append(f"{name} imports {target}")
    assert not upward, "\n".join(["a room knows itself and those before it in STOREYS:", *upward])


@pytest.mark.parametrize(("package", "other"), [("msd_ident", "msd_sim"), ("msd_sim", "msd_ident")])
def test_world_and_observer_do_not_know_each_other(package: str, other: str) -> None:
    assert [edge for edge in edges() if within(edge[0], (package,)) and within(edge[1], (other,))] == []


@pytest.mark.parametrize("library", AT_HOME)
def test_library_stays_in_its_room(library: str) -> None:
    strays = [f"{name} imports {target}" for name, target in edges() if target.split(".")[0] == library
              and not within(name, AT_HOME[library])]  # fmt: skip
    assert not strays, "\n".join([f"{library} is for {', '.join(AT_HOME[library])} only:", *strays])


def test_no_import_cycles() -> None:
    graph: dict[str, set[str]] = {}
    for name, tree in modules().items():
        targets = {t if t in modules() else t.rpartition(".")[0] for t in imported(tree, at_start=True)}
        graph[name] = {target for target in targets if target in modules() and target != name}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as cycle:
        pytest.fail(" <- ".join(cycle.args[1]))


def test_rooms_say_what_comes_in_what_goes_out_and_where_to_begin() -> None:
    """Each names modules that exist."""
    for path in sorted((REPOSITORY / "msd_ident").glob("*/__init__.py")):
        text = " ".join((ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").split())
        said = re.search(r"\bIn: .+ Out: .+ Begin with (.+)", text)
        assert said, f"{path.parent.name}: expected In:, Out: and Begin with"
        for name in re.findall(r"``([a-z_.]+)``", said[1].partition(". ")[0]):
            module = path.parent / name.replace(".", "/")
            assert module.is_dir() or module.with_suffix(".py").exists(), f"{path.parent.name} has no {name}"


def test_functions_are_short() -> None:
    too_long = []
    for name, tree in modules().items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                lines = (node.end_lineno or node.lineno) - node.lineno + 1
                if lines > LONGEST_FUNCTION:
                    too_long.append(f"{name}.{node.name} has {lines} lines; expected at most {LONGEST_FUNCTION}")
    assert not too_long, "\n".join(too_long)


#: Rooms each module of which has tests of its own: ``test/ROOM/test_MODULE.py``; compiled loops those of their caller.
TESTED_ONE_BY_ONE = ("estimate", "residuals", "selection", "diagnosis", "design")


@pytest.mark.parametrize("room", TESTED_ONE_BY_ONE)
def test_each_module_has_tests_of_its_own(room: str) -> None:
    bare = []
    for path in sorted((REPOSITORY / "msd_ident" / room).glob("*.py")):
        own = REPOSITORY / "test" / room / f"test_{path.stem.removesuffix('_loops')}.py"
        tree = ast.parse(own.read_text(encoding="utf-8") if own.exists() else "", str(own))
        tests = [node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")]
        if path.stem != "__init__" and not tests:
            bare.append(f"{own.relative_to(REPOSITORY)}: expected tests of {path.stem}")
    assert not bare, "\n".join(bare)


def test_few_functions_have_many_parameters() -> None:
    """Values that travel together are an object of the field."""
    many = []
    for name, tree in modules().items():
        for node in ast.walk(tree):
            if within(name, ("msd_ident",)) and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                given = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
                count = sum(one.arg not in ("self", "cls") for one in given)
                law = within(name, ("msd_ident.model.effects",)) and (node.name in KINDS or "reversal_" in node.name)
                if count >= MANY_PARAMETERS and not law:
                    many.append(f"{name}.{node.name} has {count} parameters")
    rule = f"{len(many)} functions have {MANY_PARAMETERS} parameters or more; expected at most {MOST_WITH_MANY} of them"
    assert len(many) <= MOST_WITH_MANY, "\n".join([rule, *many])


def test_only_the_library_names_single_effects() -> None:
    named: dict[str, list[str]] = {}
    for module, tree in modules().items():
        library = within(module, ("msd_ident.model.effects",)) or not within(module, ("msd_ident",))
        if found := [] if library else sorted(set(_effects_named(tree))):
            named[module] = found
    others = {module: found for module, found in named.items() if module not in NAMES_EFFECTS}
    asked = "ask the effect for its part in place of its name (CONTRIBUTING.md, Rules that tests check):"
    assert not others, "\n".join([asked, *(f"{module} names {', '.join(found)}" for module, found in others.items())])
    assert set(named) == NAMES_EFFECTS, "a module in NAMES_EFFECTS names no effect any more: take it out"


def _effects_named(tree: ast.Module) -> Iterator[str]:
    """Names of effects, of their parameters, classes and modules, as code has them (docstrings may)."""
    names = {effect.name for effect in LIBRARY} | {p.name for effect in LIBRARY for p in effect.parameters}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in names:
            yield node.value
        elif isinstance(node, ast.Name) and node.id in {effect.__name__ for effect in LIBRARY}:
            yield node.id
        elif isinstance(node, ast.ImportFrom) and node.module in {effect.__module__ for effect in LIBRARY}:
            yield node.module
        elif isinstance(node, ast.keyword) and node.arg in names:
            yield f"{node.arg}="
        elif isinstance(node, ast.Attribute) and node.attr in names:
            yield f".{node.attr}"


def test_command_starts_without_heavy_libraries() -> None:
    heavy = {"bokeh", "control", "dask", "distributed", "matplotlib", "mcap", "numba", "plotly", "pyarrow", "rclpy"}
    heavy |= {"rosbags", "scipy"}
    code = "import sys; from msd_ident.cli.main import main; sys.argv = ['msd', '--help']; main(); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "Usage" in done.stdout
    assert heavy & {name.split(".")[0] for name in done.stdout.splitlines()[-1].split()} == set()


#: Modules whose ``main`` starts a process, and what a test calls to see what that process has set.
ENTRIES = (
    "msd_ident.cli.main",
    *(f"msd_ident.ros.{node}.__main__" for node in ("experimenter", "identifier", "live", "recorder", "replayer")),
)


def _without_blas_setting() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize(("own", "found"), [(None, "1"), ("3", "3")])
def test_entry_points_limit_blas_before_numpy_is_loaded(entry: str, own: str | None, found: str) -> None:
    """OpenBLAS reads its variable when numpy is loaded; a user's own setting stays."""
    code = f"""
import importlib, os, sys
from unittest import mock
entry = importlib.import_module("{entry}")
early = "numpy" in sys.modules
sys.modules["msd_ident.ros.common.node_runner"] = mock.MagicMock(run=lambda *given: 0)
sys.argv = ["entry", "--help"]
sys.stdout = open(os.devnull, "w")
entry.main()
print(early, os.environ["OPENBLAS_NUM_THREADS"], file=sys.__stdout__)
"""
    environment = _without_blas_setting() | ({} if own is None else {"OPENBLAS_NUM_THREADS": own})
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.split() == ["False", found]


def test_all_entry_points_of_this_package_are_tested() -> None:
    named = re.findall(r'"\w+ = (msd_ident[\w.]+):main"', (REPOSITORY / "setup.py").read_text(encoding="utf-8"))
    assert sorted(named) == sorted(ENTRIES)


def test_importing_the_library_changes_no_setting_of_the_process() -> None:
    """Environment, switch interval, garbage collector and signal handlers stay as the importing program has them."""
    code = """
import gc, importlib, os, pkgutil, signal, sys
import matplotlib, numba, numpy, scipy.optimize
def settings():
    handlers = [str(signal.getsignal(number)) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    return dict(os.environ), sys.getswitchinterval(), gc.isenabled(), gc.get_threshold(), handlers, numpy.geterr()
before = settings()
import msd_ident
for module in pkgutil.walk_packages(msd_ident.__path__, "msd_ident."):
    if not module.name.startswith(("msd_ident.ros", "msd_ident.live", "msd_ident.batching", "msd_ident.report")):
        importlib.import_module(module.name)
for one, other in zip(before, settings()):
    assert one == other, (one, other)
"""
    subprocess.run([sys.executable, "-c", code], check=True, env=_without_blas_setting())


def test_tests_that_share_a_fixture_stay_in_one_process(request: pytest.FixtureRequest) -> None:
    """Some versions of pytest and its xdist do not understand each other, and nothing but the time taken tells."""
    if request.config.getoption("dist", "no") != "loadgroup" and not getattr(request.config.option, "loadgroup", False):
        pytest.skip("not run by make test")
    assert request.node.nodeid.endswith("@house")
