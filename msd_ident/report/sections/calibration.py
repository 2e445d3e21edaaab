"""How copies of the record were diagnosed: the confusion matrix of this experiment."""

from __future__ import annotations

from msd_ident.report.calibration import matrix
from msd_ident.report.sections.section import Section
from msd_ident.selection.calibration import Calibration


def calibration(found: Calibration) -> Section:
    """A table, and a sentence for each of its rows."""
    return Section("calibration", "Copies of this record", {"matrix": matrix(found), "copies": found.copies})
