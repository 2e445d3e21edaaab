"""What another simulation gets wrong about a record.

In: a simulation (MuJoCo, a Python function, a table of positions) and records. Out: a ``Comparison`` with differences.
Begin with ``comparing``, then ``simulations`` and ``difference``.
"""

from msd_ident.external.comparing import Comparison, compare
from msd_ident.external.difference import Difference
from msd_ident.external.simulations import (
    FunctionSimulation,
    MujocoSimulation,
    Simulation,
    TableSimulation,
)

__all__ = [
    "Comparison",
    "Difference",
    "FunctionSimulation",
    "MujocoSimulation",
    "Simulation",
    "TableSimulation",
    "compare",
]
