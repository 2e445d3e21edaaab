"""An exported model: what it leaves in its target, and what each effect became there."""

from __future__ import annotations

from msd_ident.export import Export
from msd_ident.model.effects import spoken
from msd_ident.report import marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.sections.section import Section
from msd_ident.report.sections.verdict import Card


def exported(found: Export) -> Section:
    """The outcome of an export: sentence, figures, and what is lost."""
    lost = [row.sentence for row in found.rows if row.support.kind != "exact"]
    proven = found.proof is not None and found.nearest is None
    context = {
        "verdict": "explained" if proven else "ambiguous",
        "pill": "exact" if proven else "nearest" if found.nearest is not None else "not replayed",
        "headline": found.sentence,
        "summary": " ".join(f"Wrote {path.name}." for path in found.files),
        "cards": _cards(found),
        "warnings": [*lost, *([f"Written {found.nearest.sentence}."] if found.nearest is not None else [])],
        "open": (),
    }
    return Section("verdict", "Export", context)


def _cards(found: Export) -> list[Card]:
    if found.proof is None:
        return []
    proof, target = found.proof, found.target.name
    scale = length_scale(max(proof.see("ours"), 1e-3 * proof.see("base")), found.plan.saved.position_unit)
    there, ours, base = (marked.length(f"replay.see_{key}_m", proof.see(name), scale) for key, name in (
        ("target", "target"), ("ours", "ours"), ("uncorrected", "base")))  # fmt: skip
    cards = [
        Card(f"error in {target}", there, f"SEE: {number(proof.ratio, 3)} times that of msd_ident", "extended"),
        Card("error simulated here", ours, "SEE of the same model", "measured"),
        Card("m, b, k alone", base, f"SEE in {target}: without the correction", "base"),
    ]
    if found.nearest is not None:
        predicted = marked.length("replay.see_predicted_m", proof.see("expected"), scale)
        cards.append(Card("predicted", predicted, "of the nearest model in this format", "law"))
    return cards


def effects(found: Export) -> Section:
    """What each effect became, a row each."""
    rows = [(spoken(row.effect), row.support.kind, row.support.how) for row in found.rows]
    return Section("export", "Effects in the target", {"rows": rows, "step": f"{1e3 * found.plan.step:.4g} ms"})
