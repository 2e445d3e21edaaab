"""Python: a file of its own with numpy and scipy, and a file of three lines with msd_ident."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.export import header, laws, mujoco_replay, python_source
from msd_ident.export.plan import Plan
from msd_ident.export.support import Support
from msd_ident.export.target import InitialState, Target
from msd_ident.export.templates import filled
from msd_ident.model.effects import Effect
from msd_ident.model.effects.law import ABOVE, BOTH, OUTSIDE


class PythonTarget(Target):
    """One file without msd_ident."""

    name = "python"
    suffixes = (".py",)
    what = "Python simulation in one file (numpy, scipy)"
    library = ""
    imported = True

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        if effect.jumps and (effect.knee is None or effect.knee[2] in (BOTH, ABOVE, OUTSIDE)):
            return Support("cannot", "its force begins with a jump at a place that the file does not look for")
        if effect.laws() or effect.knee or effect.structure in python_source.STRUCTURES:
            return Support("exact", "its law, in the file")
        return Support("cannot", "no law that the file could hold")

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        comment = header.text(plan, self.what)
        return {out: python_source.text(plan, comment, out.stem).encode()}

    def replay(self, out: Path, plan: Plan, start: InitialState) -> FloatArray:
        """Readings (n,) of the written file, run in its target."""
        module = mujoco_replay.imported(out)
        record = start.record
        readings = module.simulate(
            record.time, record.force_time, plan.force_scale * plan.saved.force_sign * record.force,
            start.initial.position, start.initial.velocity, hold=record.hold,
        )  # fmt: skip
        return np.asarray(readings, dtype=np.float64)


class PythonMsdTarget(Target):
    """Three lines that load the result itself."""

    name = "python-msd"
    suffixes = (".py",)
    what = "Python with msd_ident"
    library = ""
    imported = True
    itself = True

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        return Support("exact", "msd_ident itself")

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        comment = header.text(plan, self.what)
        beside = out.with_suffix(".json")
        text = filled("load_result.py.txt", header=comment, file=beside.name, zero=laws.number(plan.zero))
        # Half a sign, as in the path of a file whose name is no UTF-8, is written as JSON escapes it.
        return {out: text.encode(), beside: plan.saved.text.encode(errors="backslashreplace")}

    def beside(self, out: Path) -> tuple[Path, ...]:
        """Files that may be written next to the main one."""
        return (out.with_suffix(".json"),)

    def replay(self, out: Path, plan: Plan, start: InitialState) -> FloatArray:
        """Readings (n,) of the written file, run in its target."""
        module = mujoco_replay.imported(out)
        raw = replace(start.record, force=plan.saved.force_sign * start.record.force)
        made = module.motion(raw, start.initial.position, start.initial.velocity)
        return np.asarray(made.position + plan.zero, dtype=np.float64)
