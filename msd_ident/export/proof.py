"""Replay of an exported file in its target on the user's records, compared with m, b and k alone in the same target."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from msd_ident.data.record import FloatArray, Record
from msd_ident.estimate import Initial, see
from msd_ident.export.nearest import plain
from msd_ident.export.target import InitialState
from msd_ident.workflow.explained_motion import explained_percent
from msd_ident.workflow.validation import simulated

if TYPE_CHECKING:
    from msd_ident.export.result import Export


@dataclass(frozen=True)
class Part:
    """Replay of one record; all readings are (n,).

    Attributes:
        record: as replayed.
        ours: reading of the result's model, simulated here.
        target: of the exported file in its target.
        expected: of the written model, simulated here: the same as ``ours`` if the target carries the whole model.
        base: of m, b, k alone in the target.
    """

    record: Record
    ours: FloatArray
    target: FloatArray
    expected: FloatArray
    base: FloatArray

    @property
    def distance(self) -> float:
        """Rms difference between the target's reading and that of the written model, simulated here."""
        return float(np.sqrt(np.mean((self.target - self.expected) ** 2)))


@dataclass(frozen=True)
class Proof:
    """Replays of all records."""

    parts: tuple[Part, ...]

    def see(self, name: str) -> float:
        """Standard error of estimate of ``ours``, ``target``, ``expected`` or ``base``, in the position unit."""
        return see(self._residuals(name))

    def explained(self, name: str) -> float:
        """Part of the motion's variance that it explains [%]."""
        return explained_percent(self._residuals(name), [part.record for part in self.parts])

    @property
    def ratio(self) -> float:
        """SEE in the target over the SEE of the result's model here."""
        return self.see("target") / self.see("ours")

    @property
    def distance(self) -> float:
        """Rms difference between the target and the written model over all records, in the position unit."""
        return float(np.sqrt(np.mean(np.concatenate([part.target - part.expected for part in self.parts]) ** 2)))

    def to_json_dict(self) -> dict[str, Any]:
        """Figures of the proof."""
        figures: dict[str, Any] = {"records": [part.record.name for part in self.parts], "distance_m": self.distance}
        for key, name in (("ours", "ours"), ("target", "target"), ("predicted", "expected"), ("uncorrected", "base")):
            figures[f"see_{key}_m"] = self.see(name)
            figures[f"explained_{key}_percent"] = self.explained(name)
        return figures

    def _residuals(self, name: str) -> list[FloatArray]:
        return [getattr(part, name) - part.record.position for part in self.parts]


def replayed(made: Export, records: Sequence[Record], earlier: Proof | None = None) -> Proof:
    """Run an exported file on records.

    Args:
        made: the export, its files written.
        records: as the model is simulated on them.
        earlier: a replay of the same model with other steps, of which what was simulated here is kept.

    Raises:
        SetupError: the target is not installed.
    """
    if earlier is not None:
        parts = [replace(part, target=_run(made, part.record)) for part in earlier.parts]
        return Proof(tuple(parts))
    bases = _bases(made, records)
    parts = []
    for record, base in zip(records, bases, strict=True):
        ours = _simulated(made.saved_model(made.plan.saved.model), record)
        written = made.saved_model(made.model_in_record_units)
        expected = ours if made.nearest is None else _simulated(written, record)
        parts.append(Part(record, ours, _run(made, record), expected, base))
    return Proof(tuple(parts))


def _simulated(saved: Any, record: Record) -> FloatArray:
    _, residuals = simulated(saved, (record,), not saved.zeros)
    return np.asarray(record.position + residuals[0])


def _run(made: Export, record: Record) -> FloatArray:
    """The written model in its target, from where its own simulation of the record begins."""
    written = made.saved_model(made.model_in_record_units)
    initial, _ = simulated(written, (record,), not written.zeros)
    plan = made.plan
    shift = initial[0].zero - plan.zero
    start = InitialState(record.from_origin(), Initial(initial[0].position, initial[0].velocity, initial[0].zero))
    return np.asarray(made.target.replay(made.out, plan, start) + shift)


def _bases(made: Export, records: Sequence[Record]) -> list[FloatArray]:
    """m, b and k alone, fitted on these records, written for the same target and run there."""
    found = plain(made.saved_model(made.plan.saved.model), records)
    if made.target.itself:
        return [record.position + left for record, left in zip(records, found.residuals, strict=True)]
    runs = []
    for record, initial in zip(records, found.initial, strict=True):
        plan = replace(
            made.plan, model=found.model, zero=initial.zero, rows=(), steps=1, force_scale=1.0, draws=None,
        )  # fmt: skip
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder, f"base{made.out.suffix}")
            for path, content in made.target.files(plan, out).items():
                path.write_bytes(content)
            runs.append(made.target.replay(out, plan, InitialState(record.from_origin(), initial)))
    return runs
