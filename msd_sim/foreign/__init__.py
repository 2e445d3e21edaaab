"""Rigs whose laws nobody expects an identifier to have: causes that it knows, in forms that it does not.

``LAWS`` are all of them by name, ``both`` puts two on one rig; ``simulate.draw`` and ``simulate.simulate`` make a rig
and its record.
"""

from __future__ import annotations

from msd_sim.foreign import drives, forces, friction, losses, sensors, springs
from msd_sim.foreign.law import ForeignLaw, both

__all__ = ["LAWS", "TABLES", "ForeignLaw", "both"]

#: Modules, one a family or two.
TABLES = (friction, springs, losses, drives, forces, sensors)
LAWS: dict[str, ForeignLaw] = {law.name: law for table in TABLES for law in table.LAWS}
