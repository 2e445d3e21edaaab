"""What is compiled beforehand: all that an identification or a diagnosis calls."""

from __future__ import annotations

import importlib
import pkgutil
import subprocess
import sys

from numba.core.dispatcher import Dispatcher

import msd_ident

#: Prints the compiled functions that a process has at hand after it warmed up, with the forms that each has.
CODE = """
import sys
from msd_ident.workflow.warming import warm_up
warm_up()
for name in sorted(sys.modules):
    for what, value in vars(sys.modules[name]).items():
        if name.startswith("msd_ident.") and type(value).__name__ == "CPUDispatcher":
            print(value.__module__, what, *value.signatures, sep="\\t")
"""


def outermost() -> dict[str, Dispatcher]:
    """Compiled functions outside of the solver that Python calls, by module and name: they compile what they call."""
    found = {}
    for module in pkgutil.walk_packages(msd_ident.__path__, "msd_ident."):
        if module.name.startswith(("msd_ident.data.", "msd_ident.estimate.", "msd_ident.residuals.")):
            inside = vars(importlib.import_module(module.name)).values()
            own = [one for one in inside if isinstance(one, Dispatcher) and one.__module__ == module.name]
            called = {name for one in own for name in one.py_func.__code__.co_names}
            found |= {f"{module.name}\t{one.__name__}": one for one in own if one.__name__ not in called}
    return found


def test_nothing_is_left_to_compile() -> None:
    """A function in another form would be compiled when it is first called so: none of this process has been."""
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    lines = [line.split("\t") for line in done.stdout.splitlines()]
    ready = {"\t".join(words[:2]): set(words[2:]) for words in lines}
    wanted = outermost()
    assert len(wanted) >= 10
    for name, function in wanted.items():
        assert ready.get(name), f"{name} is compiled at its first use; expected warm_up to use it"
        assert set(map(str, function.signatures)) <= ready[name], name
