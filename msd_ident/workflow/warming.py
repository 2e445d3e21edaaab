"""Compiling beforehand what the first identification and the first diagnosis would compile."""

from __future__ import annotations

from msd_ident.data import compiled
from msd_ident.estimate import damped_step, jacobian
from msd_ident.model import solver
from msd_ident.residuals import force_smoother, nonparametric

_MODULES = (solver, compiled, damped_step, jacobian, force_smoother, nonparametric)


def warm_up() -> None:
    """Load all compiled functions, or compile them."""
    for module in _MODULES:
        module.LIBRARY.load()
