"""What the base model lacks: causes with probabilities, the extended model and its gain.

In: records of one rig and the fits of ``estimate``. Out: a frozen ``Diagnosis`` with verdict, causes and missing force.
Begin with ``pipeline``, then ``result`` and ``verdict``.
"""

from __future__ import annotations

from msd_ident.diagnosis.pipeline import Task, diagnose_records
from msd_ident.diagnosis.result import Cause, Diagnosis, Rival, Verdict

__all__ = ["Cause", "Diagnosis", "Rival", "Task", "Verdict", "diagnose_records"]
