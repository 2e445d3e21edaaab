"""What is compiled beforehand: all that an identification or a diagnosis calls."""

from __future__ import annotations

import subprocess
import sys

#: Prints the compiled functions that a process has at hand after it warmed up, and those that it lacks.
CODE = """
import importlib
import pkgutil
import msd_ident
from msd_ident.compiled import Library
from msd_ident.workflow.warming import warm_up
warm_up()
print(sum(function.loaded for library in Library.known for function in library.functions.values()))
names = {module.name for module in pkgutil.walk_packages(msd_ident.__path__, "msd_ident.")}
for name in names:
    if f"{name}_loops" in names:
        importlib.import_module(name)
print([one.name for library in Library.known for one in library.functions.values() if not one.loaded])
"""


def test_nothing_is_left_to_compile() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    loaded, missing = done.stdout.splitlines()
    assert int(loaded) >= 10 and missing == "[]"
