"""What this project never does: run what it reads. Read off the source of everything that is shipped or run."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from sources import parsed

REPOSITORY = Path(__file__).resolve().parent.parent
PLACES = ("msd_ident", "msd_sim", "bench", "tools", "docs", "launch", "examples", "setup.py")

#: Modules that make objects or code out of data, or talk to a shell.
MODULES = {"pickle", "cPickle", "dill", "cloudpickle", "joblib", "shelve", "marshal", "jsonpickle", "pty", "telnetlib"}
#: Functions that do so.
CALLS = {"eval", "exec", "compile", "__import__", "os.system", "os.popen", "yaml.load", "yaml.load_all"}
CALLS |= {"yaml.unsafe_load", "yaml.full_load", "tempfile.mktemp", "numpy.load", "np.load", "pandas.read_pickle"}
CALLS |= {"ast.literal_eval"}
#: Arguments that make a harmless function a dangerous one.
ARGUMENTS = {("shell", True), ("allow_pickle", True), ("verify", False)}
#: Where one is right, with the reason.
RIGHT = {
    "msd_ident/io/yaml_text.py: yaml.load()": "by the safe loader, the one in C where there is one",
    "msd_ident/strict_yaml.py: yaml.load()": "by a loader that is derived from the safe one",
    "msd_ident/model/kernel/laws.py: exec()": "joins the laws of the effect library, which is source of this package",
    "msd_ident/model/kernel/laws.py: compile()": "the same",
    "msd_ident/compiled/build.py: exec()": "entries of the functions that the package declares, from their kinds",
    "msd_ident/compiled/build.py: compile()": "the same",
    "msd_ident/tuning.py: ast.literal_eval()": "reads the constants off the source of this package",
    "docs/generate/tuning_tables.py: ast.literal_eval()": "the same",
    "bench/sensitivity.py: ast.literal_eval()": "the same",
    "bench/sensitivity.py: compile()": "a module of this package with another value of one constant",
}


def sources() -> list[Path]:
    """All Python files that are not tests."""
    files = [REPOSITORY / place for place in PLACES]
    return [path for file in files for path in ([file] if file.is_file() else sorted(file.rglob("*.py")))]


def dangers(tree: ast.AST) -> Iterator[str]:
    """What a module does that it must not."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] in MODULES)
        elif isinstance(node, ast.ImportFrom):
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            yield from sorted(names & CALLS)
            if (node.module or "").split(".")[0] in MODULES:
                yield str(node.module)
        elif isinstance(node, ast.Call):
            name = ast.unparse(node.func)
            if name in CALLS:
                yield f"{name}()"
            for keyword in node.keywords:
                if isinstance(keyword.value, ast.Constant) and (keyword.arg, keyword.value.value) in ARGUMENTS:
                    yield f"{name}({keyword.arg}={keyword.value.value})"


@pytest.mark.xdist_group("house")
def test_nothing_that_is_read_is_run() -> None:
    found = {f"{path.relative_to(REPOSITORY)}: {danger}" for path in sources() for danger in dangers(parsed(path))}
    assert found == set(RIGHT)
    assert len(sources()) > 150, "the places are right"


@pytest.mark.parametrize(
    "text",
    [
        "import pickle",
        "from pickle import loads",
        "import multiprocessing, dill.source",
        "eval('1')",
        "yaml.load(text, Loader=yaml.Loader)",
        "from yaml import load",
        "subprocess.run('ls', shell=True)",
        "numpy.load('x.npy')",
        "os.system('ls')",
    ],
)
def test_the_search_finds_each_of_them(text: str) -> None:
    assert list(dangers(ast.parse(text)))


@pytest.mark.xdist_group("house")
def test_yaml_is_read_by_loaders_that_make_plain_values() -> None:
    """A loader of one's own is derived from a safe one."""
    loaders = [
        f"{path.relative_to(REPOSITORY)}: {ast.unparse(base)}"
        for path in sources()
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.ClassDef)
        for base in node.bases
        if "Loader" in ast.unparse(base) and "Safe" not in ast.unparse(base) and ast.unparse(base) != "SourceFileLoader"
    ]
    assert loaders == []
