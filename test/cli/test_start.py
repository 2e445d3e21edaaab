"""How msd identify and msd diagnose start and end: what they do not import, and what they leave to the system."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from msd_ident.cli.main import COMMANDS
from msd_ident.model import warm_up
from test.cli.test_diagnose import written

#: Libraries that a command on a table has no use for. Each takes from 20 to 250 ms to import.
USELESS = {
    *("scipy.signal", "scipy.stats", "scipy.interpolate", "scipy.integrate", "scipy.io"),
    *("rosbags", "mcap", "rclpy", "h5py", "pandas", "pyarrow", "dask", "distributed", "fsspec", "ruamel"),
    *("matplotlib", "plotly", "jinja2", "bokeh", "tornado", "mujoco", "fmpy", "control", "msd_sim"),
    *(f"msd_ident.{room}" for room in ("batching", "comparison", "export", "external", "live", "monitoring", "ros")),
    *("msd_ident.io.decode", "msd_ident.io.database", "msd_ident.io.mcap_file", "msd_ident.io.writer"),
}
#: The same for the smaller command.
USELESS_FOR = {
    "diagnose": set[str](),
    "identify": {"scipy.ndimage", *(f"msd_ident.{room}" for room in ("design", "diagnosis", "selection"))},
}


def _printed(code: str, *arguments: object) -> str:
    given = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(given, capture_output=True, text=True, check=True).stdout


@pytest.mark.parametrize("command", USELESS_FOR)
def test_a_command_on_a_table_imports_nothing_that_it_has_no_use_for(tmp_path: Path, command: str) -> None:
    """A second mass and a ripple are tried on this record, and so are all laws of the library."""
    path = written(tmp_path / "rubbing.csv", effects={"coulomb_friction": {"coulomb_force": 0.2}})
    code = "import sys; from msd_ident.cli.main import main; assert main() == 0; print(*sys.modules)"
    shown = _printed(code, command, path)
    assert path.name in shown
    imported = set(shown.splitlines()[-1].split())
    assert "msd_ident.workflow.identify" in imported
    assert imported & (USELESS | USELESS_FOR[command]) == set()
    assert {name for name in COMMANDS if f"msd_ident.cli.{name}" in imported} == {command}


def test_the_help_lists_all_commands_in_their_order_after_one_of_them_ran(tmp_path: Path) -> None:
    path = written(tmp_path / "rubbing.csv")
    code = """
import sys
from msd_ident.cli import main
for words in (["info", sys.argv[1]], ["info", "--help"], ["--help"]):
    sys.argv = ["msd", *words]
    main.main()
print(*(command.name for command in main.app.registered_commands))
"""
    shown = _printed(code, path)
    assert path.name in shown
    assert shown.splitlines()[-1].split() == list(COMMANDS)


def test_the_collector_of_garbage_does_not_run_while_a_command_is_loaded(tmp_path: Path) -> None:
    """Each run looks through all that was imported: they took a twentieth of msd identify."""
    path = written(tmp_path / "rubbing.csv", effects={"coulomb_friction": {"coulomb_force": 0.2}})
    code = """
import gc
from msd_ident.cli import main
ran = []
gc.callbacks.append(lambda phase, about: ran.append(phase) if gc.get_threshold()[0] == main._COLLECTOR[0] else None)
main.main()
print(len(ran))
"""
    warm_up()  # compiles what is not compiled yet
    assert _printed(code, "identify", path).splitlines()[-1] == "0"


def test_the_end_of_a_command_takes_nothing_apart() -> None:
    """To look through half a million objects for cycles before the process ends takes a fifth of msd identify."""
    code = """
import atexit, gc
atexit.register(lambda: print(gc.get_freeze_count() > 0))  # runs after what main registers
from msd_ident.cli.main import main
main()
"""
    assert _printed(code, "--version").splitlines()[-1] == "True"
