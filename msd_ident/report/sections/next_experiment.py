"""What to measure next, where something is still to be decided."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from msd_ident.report.sections.section import Section


class NextExperiment(Section):
    """The proposed experiment."""

    slug = "next_experiment"
    title = "Next experiment"

    def __init__(self, proposal: Mapping[str, Any]) -> None:
        self._proposal = proposal

    def context(self) -> Mapping[str, Any]:
        """Its sentence, and the rest of it as rows."""
        rest = [(key, value) for key, value in self._proposal.items() if key not in ("sentence", "profile")]
        profile = self._proposal.get("profile")
        return {
            "sentence": self._proposal.get("sentence", ""),
            "rows": [(key.replace("_", " "), _cell(value)) for key, value in rest],
            "profile": "" if profile is None else str(profile),
        }


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
