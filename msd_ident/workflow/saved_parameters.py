"""Parameters of a saved result against its model: names that are simulated, in the units that they are simulated in."""

from __future__ import annotations

from collections.abc import Mapping

from msd_ident.errors import UsageError
from msd_ident.estimate.parameter_units import HasUnits, exponents, unit_in
from msd_ident.model import Model
from msd_ident.quantity import Quantity

#: What results state beside the parameters of their model, because it follows from them: µ = Fc/(m g).
DERIVED = {"friction_coefficient": "1"}


def check(parameters: Mapping[str, Quantity], model: Model, rig: HasUnits) -> None:
    """Refuse what a simulation would silently take for something else, or leave out.

    Args:
        parameters: name → quantity, as the result has them.
        model: made of them.
        rig: the result, which has the units of its record.

    Raises:
        UsageError: a parameter that neither plant nor effects have, or one in another unit than its own.
    """
    own = {parameter.name: parameter.unit for parameter in model.parameters}
    for name, quantity in parameters.items():
        if name not in own and name not in DERIVED:
            raise UsageError(
                f"{name} is a parameter of no effect of the model; expected {', '.join(own)}: remove it, or name its "
                "effect in effects"
            )
        unit = own.get(name) or DERIVED[name]
        here = unit_in(unit, rig)
        # The library's unit is that of a linear axis in SI units; as the numbers are the same, it may stand on any rig.
        if not any(_same(quantity.unit, expected) for expected in (here, unit)):
            raise UsageError(
                f"{name} is in {quantity.unit or 'no unit'}; expected {here}, with forces in {rig.force_unit} and "
                f"positions in {rig.position_unit}: convert its value and std"
            )


def _same(unit: str, other: str) -> bool:
    """Whether two units are one, however they are written; units that nobody knows are compared as words."""
    return unit == other or exponents(unit) == exponents(other)
