"""external: what somebody else's simulation gets wrong about a record."""

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
