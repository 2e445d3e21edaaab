"""How copies of the record were diagnosed: the confusion matrix of this experiment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from msd_ident.report.calibration import matrix
from msd_ident.report.sections.section import ResultSection
from msd_ident.selection.calibration import Calibration as Found


class Calibration(ResultSection[Found]):
    """A table, and a sentence for each of its rows."""

    slug = "calibration"
    title = "Copies of this record"

    def context(self) -> Mapping[str, Any]:
        """The matrix in words, and the number of copies."""
        return {"matrix": matrix(self._found), "copies": self._found.copies}
