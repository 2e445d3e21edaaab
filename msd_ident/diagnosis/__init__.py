"""What the base model lacks: causes with probabilities, the extended model and its gain.

In: records of one rig and the fits of ``estimate``. Out: a frozen ``Diagnosis`` with verdict, causes and missing force.
Begin with ``searching``, then ``pipeline``, ``result`` and ``verdict``.
"""

from __future__ import annotations

from msd_ident.diagnosis.pipeline import concluded, diagnose_records
from msd_ident.diagnosis.result import Cause, Diagnosis, Rival, Verdict
from msd_ident.diagnosis.searching import Searched, Task, search

__all__ = ["Cause", "Diagnosis", "Rival", "Searched", "Task", "Verdict", "concluded", "diagnose_records", "search"]
