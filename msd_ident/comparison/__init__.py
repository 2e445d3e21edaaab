"""comparison: what somebody else's simulation gets wrong about a record."""

from msd_ident.comparison.comparing import Comparison, compare
from msd_ident.comparison.difference import Difference
from msd_ident.comparison.simulations import (
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
