"""Draws of the joint posterior as CSV or NPZ, for domain randomisation."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from msd_ident.export import header
from msd_ident.export.plan import Plan
from msd_ident.export.support import Support
from msd_ident.export.target import Target
from msd_ident.model.effects import Effect


class DrawsTarget(Target):
    """One parameter set a row."""

    name = "draws"
    suffixes = (".csv", ".npz")
    what = "draws of the joint posterior (CSV, or NPZ by the file's ending)"
    library = None
    why_not = "draws are parameter sets, not a simulation"

    def supports(self, effect: type[Effect]) -> Support:
        """How this target carries an effect."""
        return Support("exact", f"columns {', '.join(parameter.name for parameter in effect.parameters)}")

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write; the main file first."""
        draws = plan.draws
        assert draws is not None, "the draws are made before they are written"
        labels = ["+".join(causes) or "none" for causes, _ in draws.explanations]
        chosen = [labels[i] for i in draws.explanation]
        if out.suffix == ".npz":
            buffer = io.BytesIO()
            columns = {name: draws.values[:, i] for i, name in enumerate(draws.names)}
            np.savez(buffer, explanation=np.array(chosen), **columns)  # type: ignore[arg-type]
            return {out: buffer.getvalue()}
        comments = [f"# {line}".rstrip() for line in header.lines(plan, self.what)]
        labelled = zip(labels, draws.explanations, strict=True)
        comments += [f"# explanation {label}: probability {probability:.4f}" for label, (_, probability) in labelled]
        rows = [",".join([*map(repr, row), label]) for row, label in zip(draws.values.tolist(), chosen, strict=True)]
        return {out: "\n".join([*comments, ",".join([*draws.names, "explanation"]), *rows, ""]).encode()}
