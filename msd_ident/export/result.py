"""What an export made: files, what they say of each effect, and the proof."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from msd_ident.data.record import Record
from msd_ident.export.nearest import Nearest
from msd_ident.export.plan import Plan
from msd_ident.export.proof import Proof
from msd_ident.export.support import Row
from msd_ident.export.target import Target
from msd_ident.model import Model
from msd_ident.workflow.explained_motion import percent_text
from msd_ident.workflow.saved_model import SavedModel
from msd_ident.writing import write_files

SCHEMA = "msd.export/1"


@dataclass(frozen=True)
class Export:
    """An exported model.

    Attributes:
        target: the format.
        out: main file.
        plan: what was written.
        rows: how the target carries each effect of the model.
        nearest: model written in place of one that the target cannot express; ``None`` if it can.
        files: all that was written.
        proof: replay on the records; ``None`` without.
        not_replayed: why not, a sentence.
    """

    target: Target
    out: Path
    plan: Plan
    rows: tuple[Row, ...]
    nearest: Nearest | None
    files: tuple[Path, ...] = ()
    proof: Proof | None = None
    not_replayed: str = ""

    @property
    def label(self) -> str:
        """What tells its figures from those of other results of the same records."""
        return f"_in_{self.target.name}"

    @property
    def records(self) -> tuple[Record, ...]:
        """Records that it was replayed on."""
        return tuple(part.record for part in self.proof.parts) if self.proof is not None else ()

    @property
    def model_in_record_units(self) -> Model:
        """What was written, before a mass gave it newtons."""
        if self.nearest is not None:
            return self.nearest.model
        return self.plan.saved.model

    def saved_model(self, model: Model) -> SavedModel:
        """The result with another model in its place, and the zero that goes with it."""
        same = self.nearest is None or model is not self.nearest.model
        zeros = self.plan.saved.zeros if same else (self.nearest.zero,) if self.nearest else ()
        return replace(self.plan.saved, model=model, zeros=zeros)

    def written(self) -> Export:
        """The same export after its files were written.

        Raises:
            SetupError: a file cannot be written.
        """
        made = self.target.files(self.plan, self.out)
        write_files(made)
        return replace(self, files=tuple(made))

    def unproven(self, why: str) -> Export:
        """The same with another reason for no replay."""
        return replace(self, not_replayed=why)

    @property
    def sentence(self) -> str:
        """The outcome in words."""
        unit = self.plan.saved.position_unit
        if self.proof is None:
            return f"Not replayed: {self.not_replayed}."
        proof = self.proof
        if not math.isfinite(proof.see("target")):
            return f"In {self.target.name} the model blows up at steps of {self.plan.step:.3g} s: give more --steps."
        sentence = (
            f"In {self.target.name} the model leaves {proof.see('target'):.3g} {unit}, {proof.ratio:.3f} times what it "
            f"leaves here; mass, damping and stiffness alone leave {proof.see('base'):.3g} {unit} there"
        )
        if self.nearest is not None:
            sentence += f"; {proof.see('expected'):.3g} {unit} were predicted"
        return (
            f"{sentence}. It explains {percent_text(proof.explained('target'))} % of the motion, uncorrected "
            f"{percent_text(proof.explained('base'))} %."
        )

    def to_json_dict(self) -> dict[str, Any]:
        """The contract ``msd.export/1``."""
        replay: Mapping[str, Any] | None = None if self.proof is None else self.proof.to_json_dict()
        return {
            "schema": SCHEMA,
            "target": self.target.name,
            "files": [str(path) for path in self.files],
            "effects": [
                {"name": row.effect, "kind": row.support.kind, "how": row.support.how} for row in self.rows
            ],
            "parameters": dict(self.plan.values),
            "nearest": None if self.nearest is None else {
                "dropped": list(self.nearest.dropped), "predicted_see_m": self.nearest.see,
            },
            "time_step_s": self.plan.step,
            "replay": replay,
            "not_replayed": self.not_replayed,
        }  # fmt: skip
