"""What the simulation gets wrong, the name of the cause, the extended model and its gain."""

from __future__ import annotations

from msd_ident.diagnose.contenders import Contender
from msd_ident.diagnose.diagnosing import diagnose_records
from msd_ident.diagnose.diagnosis import Cause, Diagnosis, Rival, Verdict
from msd_ident.diagnose.search import Progress

__all__ = ["Cause", "Contender", "Diagnosis", "Progress", "Rival", "Verdict", "diagnose_records"]
