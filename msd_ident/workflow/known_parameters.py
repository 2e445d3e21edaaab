"""Parameters that are known and not fitted: a weighed mass, a spring measured with weights.

One known force scale turns the ratios of a free decay into kilograms and newtons.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from msd_ident.data.record import Record
from msd_ident.errors import UsageError
from msd_ident.estimate.levels import TENTH
from msd_ident.estimate.parameter_units import exponents, unit_in
from msd_ident.model import Model
from msd_ident.model.effects import Parameter
from msd_ident.model.parameters import PARAMETERS
from msd_ident.quantity import Z95, Quantity

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_FORM = re.compile(rf"\s*(\w+)\s*=\s*({_NUMBER})\s*(?:(?:±|\+/?-)\s*({_NUMBER}))?\s*(\S.*)?$")
#: Sizes of a parameter in SI units beyond which no rig has one, and squares in a fit would leave all numbers.
LEAST, LARGEST = 1e-18, 1e18
#: Signs of a product in a unit, which is written with a dot here.
_PRODUCT = re.compile(r"[*·\s]+")


@dataclass(frozen=True)
class Known:
    """A parameter with its value, and how sure that is.

    Attributes:
        name: of a parameter of the plant or of an effect.
        value: in the parameter's SI unit, as it is on the rig (kg, or kg·m² for a joint).
        std: standard deviation of the value; 0 where it is exact.
        unit: as it was given; empty for the SI unit of the rig.

    Raises:
        UsageError: no such parameter, a value outside its bounds, or a standard deviation below 0.
    """

    name: str
    value: float
    std: float = 0.0
    unit: str = ""

    def __post_init__(self) -> None:
        parameter = _parameter(self.name)
        inside = parameter.lower <= self.value <= parameter.upper and math.isfinite(self.value)
        if not inside or (self.name == "mass" and self.value == 0.0):
            raise UsageError(
                f"{self.name} is {self.value:g} {parameter.unit}; expected a finite value {_bounds(parameter)}: "
                f"correct {_option(self.name)}"
            )
        if self.value != 0.0 and not LEAST <= abs(self.value) <= LARGEST:
            raise UsageError(
                f"{self.name} is {self.value:g} {parameter.unit}; expected a size from {LEAST:g} to {LARGEST:g}: "
                f"correct {_option(self.name)}"
            )
        if not 0.0 <= self.std < math.inf:
            raise UsageError(
                f"the standard deviation of {self.name} is {self.std:g}; expected 0 or more: "
                f"correct {_option(self.name)}"
            )

    @property
    def sets_scale(self) -> bool:
        """Whether it sets the scale of forces, so that a free decay gives more than ratios."""
        return self.value != 0.0 and exponents(_parameter(self.name).unit).get("N", 0) != 0


def parse(text: str) -> Known:
    """``stiffness=24.25``, ``stiffness=24.25±0.1``, ``mass=0.986+-0.002 kg``.

    Raises:
        UsageError: another form, or what ``Known`` refuses.
    """
    found = _FORM.match(text)
    if found is None or (found.group(4) or "").startswith((",", ".", "±", "+", "-")):
        comma = ", with a decimal point" if "," in text else ""
        if (mass := text.partition("="))[0] == "mass":
            raise UsageError(f"mass {mass[2]!r} is not valid; expected VALUE or VALUE±STD{comma}, e.g. 0.986±0.002")
        raise UsageError(
            f"--known {text!r} is not valid; expected NAME=VALUE or NAME=VALUE±STD{comma}, e.g. stiffness=24.25±0.1"
        )
    name, value, std, unit = found.groups()
    return Known(name, float(value), float(std or 0.0), _PRODUCT.sub("·", (unit or "").strip()))


def parse_all(texts: Sequence[str], mass: str = "") -> tuple[Known, ...]:
    """Known parameters from the words of the command line.

    Args:
        texts: such as ``stiffness=24.25±0.1``, see ``parse``.
        mass: value of the mass, short for ``mass=…``; empty for none.

    Raises:
        UsageError: as ``parse``, or one parameter given twice.
    """
    known = tuple(parse(text) for text in [*texts, *([f"mass={mass}"] if mass else [])])
    names = [one.name for one in known]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise UsageError(f"{twice} is given twice; expected one value: remove one of them")
    return known


def check(known: Sequence[Known], model: Model, record: Record) -> None:
    """Refuse what the model lacks, and values in another unit than the rig's.

    Args:
        known: to be kept in a fit.
        model: that is fitted.
        record: of the rig: its units are those of the values.

    Raises:
        UsageError: one of them cannot be used.
    """
    for one in known:
        if one.name not in model.names:
            raise UsageError(
                f"{one.name} is known, but the fitted model has none; expected one of {', '.join(model.names)}: remove "
                f"--known {one.name}"
            )
        unit = _parameter(one.name).unit
        here = unit_in(unit, record)
        absolute = (record.force_unit, record.position_unit) in (("N", "m"), ("N·m", "rad"))
        if one.unit and one.unit != here:
            raise UsageError(f"{one.name} is given in {one.unit}; expected {here}, its unit on this rig: convert it")
        if not one.unit and not absolute and here != unit:
            raise UsageError(
                f"{one.name} is known in {unit}, and is in {here} on this rig; expected a force in N and a position in "
                f"m: give --force-scale and --position-scale, or the value in {here}"
            )


def values(known: Sequence[Known]) -> dict[str, float]:
    """Name → value."""
    return {one.name: one.value for one in known}


def contradicted(known: Sequence[Known], fitted: Mapping[str, Quantity], factor: float) -> str:
    """A sentence on known values that the data contradicts; empty where there is none.

    Args:
        known: the parameters.
        fitted: values of a model that fits them too, and leaves only noise.
        factor: error with the known values over that of the fitted ones.
    """
    said, thousands = [], False
    for one in known:
        found = fitted.get(one.name)
        if found is None or not found.known:
            continue
        band = Quantity(found.value, math.hypot(found.std, one.std), found.unit)
        if not band.low <= one.value <= band.high:
            digits = max(1 - math.floor(math.log10(Z95 * found.std)), 0) if found.std > 0.0 else 6
            interval = f"{found.value:.{digits}f} ± {Z95 * found.std:.2g}"
            thousands |= any(math.isclose(found.value, times * one.value, rel_tol=TENTH) for times in (1e3, 1e-3))
            said.append(f"{one.name} is given as {one.value:g}, and is {interval} {found.unit} by the data")
    if not said:
        return ""
    return (
        f"With the known values the error is {factor:.3g} times that of the same model with all values fitted, which "
        f"leaves only noise: {'; '.join(said)}. Check the value, or leave it out."
        f"{' Or is a unit of the record wrong by a factor of 1000?' if thousands else ''}"
    )


def to_json_list(known: Sequence[Known], units: Mapping[str, str]) -> list[dict[str, object]]:
    """The known parameters in the JSON contract.

    Args:
        known: the parameters.
        units: unit on the rig by parameter name.
    """
    return [{"name": k.name, "value": k.value, "std": k.std, "unit": units.get(k.name, k.unit)} for k in known]


def _parameter(name: str) -> Parameter:
    if name not in PARAMETERS:
        raise UsageError(f"no parameter is called {name!r}; expected one of {', '.join(PARAMETERS)}")
    return PARAMETERS[name]


def _option(name: str) -> str:
    """The option that gives a parameter."""
    return "--mass or --known" if name == "mass" else "--known"


def _bounds(parameter: Parameter) -> str:
    if parameter.name == "mass":
        return "above 0"
    if math.isinf(parameter.upper):
        return f"from {parameter.lower:g}" if math.isfinite(parameter.lower) else "of any sign"
    return f"from {parameter.lower:g} to {parameter.upper:g}"
