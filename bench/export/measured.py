"""Measured rigs: the diagnosed model in MuJoCo against mass, damping and stiffness alone."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from bench.real.rigs import RIGS, folder
from msd_ident.cli.results import jsonable
from msd_ident.errors import MsdError
from msd_ident.export import Options, export, target
from msd_ident.io import read
from msd_ident.workflow import pipeline, saved_model


def lines(only: str = "") -> Iterator[str]:
    """The table, a row a rig, where the data is there."""
    heads = "named causes | SEE in msd_ident | SEE in MuJoCo | there with m, b, k alone | ratio | steps per sample"
    yield f"| rig | {heads} |"
    yield "|---" * 7 + "|"
    better = named = 0
    for rig in RIGS:
        path = folder() / rig.path
        if only not in rig.name or not path.is_file():
            continue
        # A joint moves in metres or radians; counts and volts are taken for metres, which changes no ratio.
        known = rig.options.position_unit in ("", "m", "rad")
        options = rig.options if known else replace(rig.options, position_unit="m")
        try:
            record = read(path, options)
            result = saved_model.from_json_dict(jsonable(pipeline.diagnose([record]).to_json_dict()))
            with tempfile.TemporaryDirectory() as place:
                found = export(result, target("mujoco"), Path(place, "rig.xml"), Options(), (record,))
        except MsdError as error:
            yield f"| {rig.name} | refused: {error} | | | | | |"
            continue
        assert found.proof is not None, found.not_replayed
        ours, there, base = (found.proof.see(name) for name in ("ours", "target", "base"))
        named += bool(result.causes)
        better += bool(result.causes) and there < base
        causes = ", ".join(result.causes) or "–"
        yield (
            f"| {rig.name} | {causes} | {ours:.4g} | {there:.4g} | {base:.4g} | {base / there:.3g} × "
            f"| {found.plan.steps} |"
        )
    yield f"\nin MuJoCo a smaller SEE than with m, b, k alone: {better} of {named} rigs with a named cause"
