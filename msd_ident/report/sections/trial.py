"""A saved model on another record: explained motion and errors, in one sentence and four numbers."""

from __future__ import annotations

from msd_ident.report import marked
from msd_ident.report.marked import Marked
from msd_ident.report.numbers import length_scale, number
from msd_ident.report.sections.section import Section
from msd_ident.report.sections.verdict import Card
from msd_ident.report.validation import sentences
from msd_ident.workflow.explained_motion import percent_text
from msd_ident.workflow.validation import Validation


def trial(found: Validation) -> Section:
    """The outcome of a validation: sentence, cards and warnings."""
    scale = length_scale(max(found.noise_floor, 1e-3 * found.see), found.records[0].position_unit)
    percent = Marked("explained_percent", found.explained_percent, f"{percent_text(found.explained_percent)} %")
    floors = f"{number(found.adequacy.ratio, 3)} noise floors"
    own = marked.length("model.see_m", found.saved.see, scale)
    floor = marked.length("noise_floor_m", found.noise_floor, scale)
    cards = [
        Card("motion explained", percent, "of its variance; only the initial state is refitted", "extended"),
        Card("error here", marked.length("see_m", found.see, scale), f"SEE: {floors}", "extended"),
        Card("error on its own record", own, found.saved.path, "base"),
        Card("noise floor", floor, "smallest error of any model", "noise"),
    ]
    good = found.adequacy.consistent or bool(found.options.require) and found.met
    context = {
        "verdict": "unexplained" if not found.met else "explained" if good else "ambiguous",
        "pill": "required part missed" if not found.met else "confirmed" if good else "error above the noise",
        "headline": found.sentence,
        "summary": " ".join(sentences(found)),
        "cards": cards,
        "warnings": found.warnings,
        "open": (),
    }
    return Section("verdict", "Outcome", context)
