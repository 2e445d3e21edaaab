"""Units that a column's heading ends with (``position_mm``, ``control_effort_v``, ``Angle (rad)``), or an option."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from msd_ident.errors import DataError, UsageError
from msd_ident.io.columns import TIME_NAMES

#: A pound as a force [N].
_POUND, _POUNDS = 4.4482216152605, ("lb", "lbs", "lbf")
#: Ending of a heading → unit of the record and factor to it.
_LENGTH = {
    "m": ("m", 1.0),
    "cm": ("m", 1e-2),
    "mm": ("m", 1e-3),
    "um": ("m", 1e-6),
    "km": ("m", 1e3),
    "dm": ("m", 0.1),
    "ft": ("m", 0.3048),
    "yd": ("m", 0.9144),
    "in": ("m", 0.0254),
    "inch": ("m", 0.0254),
    **dict.fromkeys(("mil", "mils", "thou"), ("m", 2.54e-5)),
    "rad": ("rad", 1.0),
    "radian": ("rad", 1.0),
    "radians": ("rad", 1.0),
    "mrad": ("rad", 1e-3),
    "deg": ("rad", math.pi / 180),
    "°": ("rad", math.pi / 180),
    "arcmin": ("rad", math.pi / 10800),
    "arcsec": ("rad", math.pi / 648000),
    **dict.fromkeys(("gon", "grad"), ("rad", math.pi / 200)),
    "degree": ("rad", math.pi / 180),
    "degrees": ("rad", math.pi / 180),
    "rev": ("rad", 2.0 * math.pi),
    "turns": ("rad", 2.0 * math.pi),
    "count": ("count", 1.0),
    "counts": ("count", 1.0),
    "ticks": ("count", 1.0),
}
_FORCE = {
    "n": ("N", 1.0),
    "mn": ("N", 1e-3),
    "kn": ("N", 1e3),
    "nm": ("N·m", 1.0),
    "v": ("V", 1.0),
    "mv": ("V", 1e-3),
    "a": ("A", 1.0),
    "ma": ("A", 1e-3),
    "dan": ("N", 10.0),
    "un": ("N", 1e-6),
    "dyn": ("N", 1e-5),
    "gf": ("N", 9.80665e-3),
    "kgf": ("N", 9.80665),
    "kp": ("N", 9.80665),
    "kip": ("N", 1e3 * _POUND),
    "ncm": ("N·m", 1e-2),
    "nmm": ("N·m", 1e-3),
    "mnm": ("N·m", 1e-3),
    "knm": ("N·m", 1e3),
    **{pound: ("N", _POUND) for pound in _POUNDS},
    **{name: ("N·m", 0.0254 * _POUND) for pound in _POUNDS for name in (f"{pound}in", f"in{pound}")},
    **{name: ("N·m", 0.3048 * _POUND) for pound in _POUNDS for name in (f"{pound}ft", f"ft{pound}")},
    "ozf": ("N", _POUND / 16),
    **{name: ("N·m", 0.0254 * _POUND / 16) for name in ("ozfin", "ozin", "inozf", "inoz")},
}
_TIME = {
    **dict.fromkeys(("s", "sec", "secs", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec"), 1e-3),
    **dict.fromkeys(("us", "usec"), 1e-6),
    **dict.fromkeys(("ns", "nsec"), 1e-9),
}
#: Units of time that are one only in brackets, or behind a name of time: elsewhere ``min`` is a least value.
_LONG_TIME = {
    **dict.fromkeys(("min", "mins", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hrs", "hours"), 3600.0),
    **dict.fromkeys(("d", "days"), 86400.0),
}
#: What may be milli or mega, where headings are in capitals.
_MILLI_OR_MEGA = re.compile(r"M(N|V|A|N[·*.\s-]?m|m|s)")
#: Units in brackets that are none of a position or force.
_OTHER = {"hz", "kg", "g", "w", "j", "%", "c", "°c", "k", "pa", "mps", "dps", "rpm", "rps"}
#: Those that no option takes; a position may be in volts or amperes, and either in per cent.
_NEVER = frozenset(_OTHER - {"%", "c", "k"} | {*_TIME})
_FORCES = frozenset(name for name, (unit, _) in _FORCE.items() if unit in ("N", "N·m"))
_SYMBOLS = {*_LENGTH, *_FORCE, *_TIME, *_OTHER}
#: Symbols that are one only in a product: as words alone they are names, such as a least value.
_IN_PRODUCTS = {"min", "h", "km"}
_RATES = ("/", "^", "**", "²", "³", "⁻")
_IN_BRACKETS = re.compile(r"\s*[\[(]\s*([^\[\]()]*[^\[\]()\s:,])\s*[\])]$")
_BEHIND_COMMA = re.compile(r"\s*,\s*([^,]*[^,\s])$")
_ENDING = re.compile(r"(?:_|\s*/\s*)([A-Za-z]+)$")
#: Signs of a product in a unit: N·m, N*m, N-m, N.m, N m.
_PRODUCT = re.compile(r"[·⋅*.\s-]")
_SYMBOL = re.compile(r"[^\W\d_]+|°")


@dataclass(frozen=True)
class Quantity:
    """A force or a position: the units that it may have.

    Attributes:
        option: name in the options, ``force`` or ``position``.
        known: unit in lower case, without signs of a product → unit of the record, and factor to it.
        default: unit where neither heading nor option says one.
        plain: units of a record in SI; the first is that of a scaled column whose heading says none of them.
        expected: what it is, in words.
        never: units of something else, which no option takes; others that are not known may be the user's own.
    """

    option: str
    known: Mapping[str, tuple[str, float]]
    default: str
    plain: tuple[str, str]
    expected: str
    never: frozenset[str]


FORCE = Quantity("force", _FORCE, "N", ("N", "N·m"), "a force, a torque, a voltage or a current", _NEVER)
POSITION = Quantity("position", _LENGTH, "m", ("m", "rad"), "a length, an angle or counts", _NEVER | _FORCES)


def of_option(quantity: Quantity, given: str, scale: float | None) -> tuple[str, float]:
    """Unit of the record for one that an option names, such as ``deg``, and factor from the source's numbers to it.

    The scale leads to the named unit; from there the unit's own factor leads to that of the record.

    Args:
        quantity: force or position.
        given: the option's unit; one that is not known stays as it is.
        scale: factor that the user gives, or ``None``.

    Raises:
        UsageError: the unit is that of something else, or the scale is the factor of the unit, which would be applied
            twice.
    """
    if _plain(given) in quantity.never:
        raise UsageError(
            f"--{quantity.option}-unit {given} is no unit of {quantity.expected}; expected one, or a name of your own, "
            "such as count"
        )
    unit, factor = quantity.known.get(_plain(given), (given, 1.0))
    if scale is not None and factor != 1.0 and math.isclose(abs(scale), factor, rel_tol=1e-3):
        option = f"--{quantity.option}"
        raise UsageError(
            f"{option}-scale {scale:g} and {option}-unit {given} both convert {given} to {unit}; expected one of them: "
            f"leave the scale away, or give the unit after scaling, {option}-unit {unit}"
        )
    return unit, factor if scale is None else scale * factor


def of_column(quantity: Quantity, column: str, given: str, scale: float | None) -> tuple[str, float, str]:
    """Unit of the record for a column, factor from its numbers to it, and a note on a factor that nobody gave.

    Args:
        quantity: force or position.
        column: its heading.
        given: unit that an option names, empty for none. It beats the heading, but for one in a scaled form of it: with
            ``m``, a column in mm is converted.
        scale: factor to the unit that the option names, else to the heading's unit of the record; ``None`` for none.

    Raises:
        DataError: the heading's unit, in brackets, is that of something else, or contradicts the options.
        UsageError: see ``of_option``.
    """
    name, written = unit(column)
    said = quantity.known.get(name)
    if said and _MILLI_OR_MEGA.fullmatch(_as_written(column)) and not given and scale is None:
        raise _milli_or_mega(column, f"--{quantity.option}-unit and --{quantity.option}-scale")
    if given:
        found = of_option(quantity, given, scale)
        own = of_option(quantity, given, None)
        if scale is None and said and said[0] == own[0] and said != own:
            if own[1] == 1.0:
                return *said, _note(f"column {column}", said[1], "its unit says")
            if written:
                raise _two_units(quantity, column, written, given)
        return *found, option_note(quantity, given, f"column {column}")
    if written and said is None and _is_other(name, written):
        raise DataError(
            f"column {column} is in {written}; expected {quantity.expected}: choose another --{quantity.option}, or "
            f"give --{quantity.option}-unit and --{quantity.option}-scale"
        )
    found = said or (quantity.default, 1.0)
    if scale is None:
        unknown = f"column {column} is read in {found[0]}: {written} is no unit that is known here. If it is one, give "
        unknown += f"--{quantity.option}-scale, the factor to {found[0]}."
        return *found, unknown if written and not said else _note(f"column {column}", found[1], "its unit says")
    if abs(scale) == 1.0 != found[1]:
        raise _no_scale(quantity, column, name, found, scale)
    # Nobody scales to counts or volts.
    return found[0] if found[0] in quantity.plain else quantity.plain[0], scale, ""


def option_note(quantity: Quantity, given: str, what: str) -> str:
    """What the unit of an option changes in the numbers of a column or a field, in a sentence; empty for nothing."""
    return _note(what, of_option(quantity, given, None)[1], f"--{quantity.option}-unit {given} says")


def _note(what: str, factor: float, reason: str) -> str:
    return f"{what} was multiplied by {factor:g}, as {reason}." if factor != 1.0 else ""


def _two_units(quantity: Quantity, column: str, written: str, given: str) -> DataError:
    option = f"--{quantity.option}"
    return DataError(
        f"column {column} is in {written}, and {option}-unit says {given}; expected one unit: leave {option}-unit "
        f"away, or give {option}-scale too if the heading is wrong"
    )


def _no_scale(quantity: Quantity, column: str, name: str, said: tuple[str, float], scale: float) -> DataError:
    option = f"--{quantity.option}"
    return DataError(
        f"{option}-scale {scale:g} would take column {column} for {said[0]}, whose heading says {name}; expected the "
        f"factor to {said[0]}, {option}-scale {scale * said[1]:g}, or its unit too: {option}-unit {name}"
    )


def of_no_force(position: str) -> str:
    """Unit of the forces of a free decay, whose position has this unit: a joint's are torques."""
    return "N·m" if position == "rad" else "N"


def time_factor(column: str) -> float | None:
    """Factor from the numbers of a time column to seconds; None where its heading ends with no unit of time.

    Raises:
        DataError: the unit may be of milliseconds or of megaseconds.
    """
    name, written = unit(column)
    if name in _TIME and _MILLI_OR_MEGA.fullmatch(_as_written(column)):
        raise _milli_or_mega(column, "--time-scale")
    if name in _LONG_TIME and (written or stem(column) in TIME_NAMES):
        return _LONG_TIME[name]
    return _TIME.get(name)


def unknown_in_brackets(column: str) -> str:
    """What stands in brackets at the end of a heading and is no unit that is known here; empty for nothing."""
    name, written = unit(column)
    return "" if name in _SYMBOLS else written


def _as_written(column: str) -> str:
    """Unit of a heading as it is written there, in capitals or not."""
    found = _in_brackets(column.strip()) or _ENDING.search(column.strip())
    return found.group(1) if found else ""


def _milli_or_mega(column: str, options: str) -> DataError:
    return DataError(
        f"column {column} ends with {_as_written(column)}, which may be milli or mega; expected one that is clear: "
        f"correct the heading, or give {options}"
    )


def is_time(text: str) -> bool:
    """Whether a text, with brackets around it or without, is a unit of time."""
    return _plain(text.strip().strip("()[]")) in _TIME


def stem(column: str) -> str:
    """Heading without its unit, in lower case."""
    name = column.strip()
    found = _in_brackets(name)
    return _ENDING.sub("", name[: found.start()] if found else name).strip().lower()


def unit(column: str) -> tuple[str, str]:
    """Unit of a heading in lower case without signs of a product, and as it is written; empty where there is none.

    The second one is empty for what merely ends the name, which need not be a unit.
    """
    found = _in_brackets(column.strip())
    if found:
        return _plain(found.group(1)), found.group(1)
    found = _ENDING.search(column.strip().replace("µ", "u").replace("μ", "u"))
    return (found.group(1).lower(), "") if found else ("", "")


def is_unit(text: str) -> bool:
    """Whether a text, with brackets around it or without, is a unit that a heading may have; so is an empty one."""
    name = _plain(text.strip().strip("()[]"))
    return name in {"", "-", *_SYMBOLS} or any(sign in name for sign in _RATES)


def _plain(written: str) -> str:
    """A unit in lower case without signs of a product, as the tables have it."""
    return _PRODUCT.sub("", written.lower().replace("µ", "u").replace("μ", "u"))


def _in_brackets(column: str) -> re.Match[str] | None:
    """What stands in brackets at the end of a heading; with a digit at its end, only a power: it may be a channel.

    A known unit behind a comma stands for one in brackets: ``Position, mm``.
    """
    found = _IN_BRACKETS.search(column)
    if found is None:
        found = _BEHIND_COMMA.search(column)
        if found is None or not (_is_other(_plain(found.group(1)), found.group(1)) or _is_power(found.group(1))):
            return None
    return found if not found.group(1)[-1].isdecimal() or _is_power(found.group(1)) else None


def _is_power(text: str) -> bool:
    """Whether a text that ends with a digit is a unit, such as m/s^2, rad/s2, m s-2 or ms-2.

    A symbol and a digit alone are the name of a channel: A1, M2.
    """
    symbols = _SYMBOL.findall(text.lower().replace("µ", "u").replace("μ", "u"))
    joined = [symbol for symbol in symbols if symbol[-1] == "s" and symbol[:-1] in _LENGTH]  # ms-2 is m s-2
    if not symbols or not all(symbol in {*_SYMBOLS, *_IN_PRODUCTS, *joined} for symbol in symbols):
        return False
    signed = any(sign in text for sign in _RATES) or len(symbols) > 1
    return signed or bool(joined and "-" in text)


def _is_other(name: str, written: str) -> bool:
    """Whether what stands in brackets is a unit: one of the tables, a rate or a power."""
    return name in _SYMBOLS or name[-1:].isdecimal() or any(sign in written for sign in _RATES)
