"""Rigs whose laws nobody expects an identifier to have: causes that it knows, in forms that it does not.

``LAWS`` are all of them by name; ``simulate.draw`` and ``simulate.simulate`` make a rig and its record.
"""

from __future__ import annotations

from msd_sim.foreign import drives, forces, friction, losses, sensors, springs
from msd_sim.foreign.law import ForeignLaw

__all__ = ["LAWS", "TABLES", "ForeignLaw"]

#: Modules, one a family or two.
TABLES = (friction, springs, losses, drives, forces, sensors)
LAWS: dict[str, ForeignLaw] = {law.name: law for table in TABLES for law in table.LAWS}
