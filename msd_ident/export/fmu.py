"""FMU: the generated Python simulation as an FMI 2 co-simulation unit, built by PythonFMU and replayed by FMPy."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.errors import SetupError
from msd_ident.export import header, python_source, roles
from msd_ident.export.mujoco_replay import at_samples, averages, lagged
from msd_ident.export.plan import Plan
from msd_ident.export.python_target import PythonTarget
from msd_ident.export.support import Support
from msd_ident.export.target import InitialState
from msd_ident.export.templates import filled
from msd_ident.model.effects import Effect
from msd_ident.model.effects.law import LAG


class FmuTarget(PythonTarget):
    """FMI 2.0 co-simulation; it needs a Python with numpy, scipy and pythonfmu on the machine that runs it."""

    name = "fmu"
    suffixes = (".fmu",)
    what = "FMU for co-simulation (FMI 2.0)"
    library = "fmpy"
    imported = False
    commanded = True

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        if roles.role(effect) == roles.FORCED_READING:
            return Support("cannot", "at the end of a step an FMU does not know the force that begins there")
        return super().supports(effect)

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        comment = header.text(plan, self.what)
        name = f"Rig{hashlib.sha256(repr(plan.values).encode() + repr(plan.zero).encode()).hexdigest()[:8]}"
        text = python_source.text(plan, comment, name) + _slave(plan, name)
        return {out: built(text, name)}

    def replay(self, out: Path, plan: Plan, start: InitialState) -> FloatArray:
        """Readings (n,) of the written file, run in its target."""
        record, initial = start.record, start.initial
        force = plan.force_scale * plan.saved.force_sign * averages(record, 1)[:, 0]
        given = np.zeros(force.size + 1, dtype=[("time", np.float64), ("force", np.float64)])
        given["time"] = record.time[0] + record.period * np.arange(force.size + 1)
        given["force"] = np.append(force, force[-1])
        begin = {
            "initial_position": initial.position, "initial_velocity": initial.velocity,
            "initial_lagged_force": lagged(record, plan),
        }  # fmt: skip
        found = library().simulate_fmu(
            str(out), start_time=given["time"][0], stop_time=given["time"][-1], output_interval=record.period,
            step_size=record.period, start_values=begin, input=given, output=["position"], fmi_type="CoSimulation",
        )  # fmt: skip
        readings = np.asarray(found["position"], dtype=np.float64)[: force.size + 1]
        readings[0] = initial.position + plan.zero
        return at_samples(record, readings)


def _slave(plan: Plan, name: str) -> str:
    parts = {**python_source.structure(plan), **python_source.memory(plan), "CLASS": name}
    lag = ", lag" if plan.model.structure(LAG) else ""
    parts["FMU_START"] = lag + python_source.begun(plan.model)
    parts["HELD"] = python_source.held(plan.model, "level")
    return filled("fmu_slave.py.txt", **parts)


def library() -> Any:
    """FMPy.

    Raises:
        SetupError: it is not installed.
    """
    try:
        import fmpy
    except ImportError:
        raise SetupError("FMPy is not installed; expected it for the replay: pip install fmpy") from None
    return fmpy


def built(text: str, name: str) -> bytes:
    """The FMU (bytes of a zip file) of a PythonFMU slave.

    Args:
        text: source of the slave.
        name: of its class and of the FMU.

    Raises:
        SetupError: PythonFMU is not installed, or fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder, f"{name}.py")
        script.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "pythonfmu", "build", "-f", str(script), "-d", folder]
        done = subprocess.run(command, capture_output=True, text=True)
        made = Path(folder, f"{name}.fmu")
        if not made.exists():
            why = (done.stderr.strip().splitlines() or ["it wrote nothing"])[-1]
            raise SetupError(f"PythonFMU could not build the FMU ({why}); expected it: pip install pythonfmu")
        return made.read_bytes()
