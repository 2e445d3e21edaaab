"""Where the compiled solver is kept between runs, and the word to the user when it must be made."""

from __future__ import annotations

import contextlib
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

#: Older builds of the solver that are kept beside the present one.
KEPT = 3

_ENTRY = '''"""Compiled entries of msd_ident's solver; written by it, safe to delete."""
from numba import njit
from msd_ident.model.kernel import run as kernel
from msd_ident.model.kernel.groups import Path

_plan, _row, _compare = kernel.plan, kernel.row, kernel.compare

@njit(cache=True, nogil=True, error_model="numpy")
def plan(time, force_time, force, straight):
    return _plan(time, force_time, force, straight)

@njit(cache=True, nogil=True, error_model="numpy")
def run(bits, rows, place, plan, measured, out_x, out_v):
    for i in range(rows.shape[0]):
        _row(bits, rows[i], place, plan, Path(out_x[i], out_v[i]))
        _compare(rows[i], measured, out_x[i])
'''
_APART = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from msd_ident.model.simulator import compile_here
compile_here()
"""


def fingerprint() -> str:
    """Hash of all that the compiled solver is made from: laws, kernel, numba, Python."""
    import numba

    model = Path(__file__).resolve().parents[1]
    digest = hashlib.sha256(f"{numba.__version__} {sys.version}".encode())
    for path in sorted((*model.glob("effects/*.py"), *model.glob("kernel/*.py"), model / "plant.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def _roots() -> list[Path]:
    """Folders to try for the cache, the best first."""
    roots = []
    if own := os.environ.get("NUMBA_CACHE_DIR"):
        roots.append(Path(own))
    if xdg := os.environ.get("XDG_CACHE_HOME"):
        roots.append(Path(xdg))
    if sys.platform == "win32" and (local := os.environ.get("LOCALAPPDATA")):
        roots.append(Path(local))
    with contextlib.suppress(RuntimeError):
        roots.append(Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache"))
    roots.append(Path(tempfile.gettempdir()) / f"msd_ident-{getattr(os, 'getuid', lambda: 'user')()}")
    return roots


def folder() -> Path:
    """The folder of this build, made if need be: the first root that can be written."""
    name = fingerprint()
    for root in _roots():
        path = root / "msd_ident" / f"solver-{name}"
        try:
            path.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=path):
                pass
        except OSError:
            continue
        return path
    return Path(tempfile.mkdtemp(prefix="msd_ident-solver-"))


def compiled(module: ModuleType) -> bool:
    """Whether numba's cache already holds code of the entry module, or none is wanted (NUMBA_DISABLE_JIT)."""
    if not hasattr(module.run, "_cache"):
        return True
    return any(Path(module.run._cache.cache_path).glob("msd_solver_entry.run*.nbc"))


def load(say: Callable[[str], None]) -> ModuleType:
    """The entry module whose functions numba caches in ``folder()``; ``say`` is told, in one line, if they are not yet.

    Its functions: ``plan(time, force_time, force, straight)``, see ``run.plan``, and ``run(bits, rows, place, plan,
    measured, out_x, out_v)``, which is ``run.row`` and ``run.compare`` for each of r rows of values: (r, n) readings or
    what these miss by, and (r, n) or (r, 0) velocities.
    """
    path = folder()
    source = path / "msd_solver_entry.py"
    if not source.exists() or source.read_text() != _ENTRY:
        handle, temporary = tempfile.mkstemp(dir=path, suffix=".tmp")
        with os.fdopen(handle, "w") as file:
            file.write(_ENTRY)
        os.replace(temporary, source)
    spec = importlib.util.spec_from_file_location("msd_solver_entry", source)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    if not compiled(module):
        say("msd: compiling the solver, once (about half a minute); later runs start at once")
        _prune(path)
    return module


def compile_apart() -> None:
    """Compile the solver in a process of its own.

    Where there can be none, as in a program that embeds Python, the cache stays as it is.
    """
    with contextlib.suppress(OSError):
        subprocess.run(
            [sys.executable or "", "-c", _APART, json.dumps(sys.path)],
            check=False, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip


def _prune(present: Path) -> None:
    """Drop all but the newest few builds of other versions."""
    others = [p for p in present.parent.glob("solver-*") if p != present]
    others.sort(key=lambda p: p.stat().st_mtime, reverse=True)
    for old in others[KEPT:]:
        shutil.rmtree(old, ignore_errors=True)
