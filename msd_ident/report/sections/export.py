"""An exported model: what it leaves in its target, and what each effect became there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from msd_ident.export import Export
from msd_ident.model.effects import spoken
from msd_ident.report import marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.sections.section import ResultSection
from msd_ident.report.sections.verdict import Card


class Exported(ResultSection[Export]):
    """The outcome of an export: sentence, figures, and the class of each effect."""

    slug = "verdict"
    title = "Export"

    def context(self) -> Mapping[str, Any]:
        """Sentence, cards, and what is lost."""
        found = self._found
        lost = [row.sentence for row in found.rows if row.support.kind != "exact"]
        proven = found.proof is not None and found.nearest is None
        return {
            "verdict": "explained" if proven else "ambiguous",
            "pill": "exact" if proven else "nearest" if found.nearest is not None else "not replayed",
            "headline": found.sentence,
            "summary": " ".join(f"Wrote {path.name}." for path in found.files),
            "cards": self._cards(),
            "warnings": [*lost, *([f"Written {found.nearest.sentence}."] if found.nearest is not None else [])],
            "open": (),
        }

    def _cards(self) -> list[Card]:
        found = self._found
        if found.proof is None:
            return []
        proof, unit = found.proof, found.plan.saved.position_unit
        scale = length_scale(max(proof.see("ours"), 1e-3 * proof.see("base")), unit)
        there, ours, base = (marked.length(f"replay.see_{key}_m", proof.see(name), scale) for key, name in (
            ("target", "target"), ("ours", "ours"), ("uncorrected", "base")))  # fmt: skip
        cards = [
            Card(
                f"error in {found.target.name}",
                there,
                f"SEE: {number(proof.ratio, 3)} times that of msd_ident",
                "extended",
            ),
            Card("error simulated here", ours, "SEE of the same model", "measured"),
            Card("m, b, k alone", base, f"SEE in {found.target.name}: without the correction", "base"),
        ]
        if found.nearest is not None:
            predicted = marked.length("replay.see_predicted_m", proof.see("expected"), scale)
            cards.append(Card("predicted", predicted, "of the nearest model in this format", "law"))
        return cards


class Effects(ResultSection[Export]):
    """What each effect became."""

    slug = "export"
    title = "Effects in the target"

    def context(self) -> Mapping[str, Any]:
        """A row an effect."""
        rows = [(spoken(row.effect), row.support.kind, row.support.how) for row in self._found.rows]
        return {"rows": rows, "step": f"{1e3 * self._found.plan.step:.4g} ms"}
