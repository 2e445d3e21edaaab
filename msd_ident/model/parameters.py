"""All parameters of the plant and of the library, by name: the same name means the same thing in every effect."""

from __future__ import annotations

from msd_ident.model.declarations import Parameter
from msd_ident.model.effects import LIBRARY
from msd_ident.model.plant import PLANT_PARAMETERS

#: Name → parameter, the plant's own first.
PARAMETERS: dict[str, Parameter] = {
    parameter.name: parameter
    for parameter in (*PLANT_PARAMETERS, *(own for effect in LIBRARY for own in effect.parameters))
}
