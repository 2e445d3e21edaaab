"""Read results back from their JSON: the model of an identification or a diagnosis."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from pathlib import Path
from typing import Any

from msd_ident.errors import DataError, UsageError
from msd_ident.model import Model, Plant
from msd_ident.model.effects import LIBRARY, by_name
from msd_ident.quantity import Quantity
from msd_ident.workflow import saved_parameters, saved_shape
from msd_ident.workflow.known_parameters import LARGEST

#: Schema → key of the model that the result ends with.
SCHEMAS = {"msd.identification/1": "refined", "msd.diagnosis/1": "extended", "msd.diagnosis/2": "extended"}
#: Begin of the warning by which results told of a turned force before they had ``force_sign``.
_TURNED = "A positive force moves the encoder downwards"

#: What ``scale_assumed`` means, as every refusal says it.
ONLY_RATIOS = "no force moved the cart, so only ratios are known (its mass of 1 kg is assumed)"


@dataclass(frozen=True)
class SavedModel:
    """The model of a result, with what a simulation of another record needs.

    Attributes:
        schema: of the result.
        path: of the record that the model was fitted to, as the result has it.
        model: with the fitted values; of a diagnosis the extended one.
        parameters: name → quantity.
        see: standard error of estimate on its own record, in the position unit.
        force_unit, position_unit: that its values are in.
        force_sign: -1 where the force was turned because a positive one moves the encoder downwards, else 1.
        force_lead: time by which it acted before its stamps [s].
        force_hold: how the force of its record went on between samples; empty where the result does not tell.
        zeros: reading at which the spring is relaxed, of each of its records; none where the result does not tell.
        causes: what the model holds beyond mass, damping and stiffness.
        base_depends_on: of a diagnosis, share of the base model's missing force that each signal explains.
        base: mass, damping and stiffness alone; ``None`` where the result does not tell.
        rate: samples per second of its first record [Hz]; NaN if the result does not have it.
        noise_floor: of its record, in the position unit.
        rivals: other sets of causes that stand, with their probabilities.
        text: the result as JSON.
        scale_assumed: whether no force set anything in motion, so that its forces are those of an assumed mass.
        origins: name of each of its records → instant from which its laws of time count it [s].
        read_with: how its records were read: the options that were not the default (``io.SourceOptions``).
    """

    schema: str
    path: str
    model: Model
    parameters: Mapping[str, Quantity]
    see: float
    force_unit: str
    position_unit: str
    force_sign: int
    force_hold: str
    force_lead: float
    zeros: tuple[float, ...]
    causes: tuple[str, ...]
    base_depends_on: Mapping[str, float]
    base: Model | None = None
    rate: float = math.nan
    noise_floor: float = math.nan
    rivals: tuple[tuple[tuple[str, ...], float], ...] = ()
    text: str = ""
    scale_assumed: bool = False
    origins: Mapping[str, float] = field(default_factory=dict)
    read_with: Mapping[str, Any] = field(default_factory=dict)


def load(path: str | os.PathLike[str]) -> SavedModel:
    """The model of a file with one result, as ``msd identify`` and ``msd diagnose`` write it with ``--json``.

    Raises:
        DataError: it cannot be read, or is no such result.
        UsageError: it holds several results.
    """
    found = load_all(path)
    if len(found) > 1:
        raise UsageError(f"{path} holds {len(found)} results; expected one: say which with --line 1 to {len(found)}")
    return found[0]


def load_all(path: str | os.PathLike[str]) -> tuple[SavedModel, ...]:
    """The models of all results of a file, one a line.

    Raises:
        DataError: as ``load``.
    """
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is not text"
        raise DataError(f"cannot read {path}: {why}; expected a result that --json wrote") from None
    found = tuple(from_json_dict(one, str(path)) for one in _objects(text, str(path)))
    if not found:
        what = "holds an empty list" if text.strip() else "is empty"
        raise DataError(f"{path} {what}; expected a result that msd identify or msd diagnose wrote with --json")
    return found


def from_json_dict(result: Mapping[str, Any], name: str = "the result") -> SavedModel:
    """The model of a result that is already parsed.

    Args:
        result: an object of ``msd identify`` or ``msd diagnose``, as parsed from JSON.
        name: what an error message calls it.

    Raises:
        DataError: it is no result of an identification or a diagnosis, lacks what a simulation needs, or has parameters
            that would not be simulated as they stand there.
    """
    schema = str(result.get("schema", ""))
    if schema not in SCHEMAS:
        raise DataError(f"{name} {_what(result, schema)}; expected {' or '.join(SCHEMAS)}: {_next(schema)}")
    try:
        saved_shape.check(result, SCHEMAS[schema])
        told = result[SCHEMAS[schema]]
        parameters = {key: _quantity(key, value) for key, value in told["parameters"].items()}
        causes = tuple(str(cause["name"]) for cause in result.get("causes", ()))
        effects = tuple(result["effects"]) if "effects" in result else causes or _effects_of(parameters)
        sheets: Sequence[Mapping[str, Any]] = result["data"]
        found = SavedModel(
            schema=schema,
            path=str(result.get("path", "")),
            model=_model(parameters, effects),
            parameters=parameters,
            see=_number_or_nan("see_m", told["see_m"]),
            force_unit=str(sheets[0]["force_unit"]),
            position_unit=str(sheets[0]["position_unit"]),
            force_sign=_sign(result.get("force_sign", _old_sign(result))),
            force_hold=str(sheets[0].get("force_hold", "")),
            force_lead=_number("force_lead_s", sheets[0].get("force_lead_s", 0.0)),
            zeros=tuple(
                _finite("zero_m", _number_or_nan("zero_m", start["zero_m"])) for start in result.get("initial", ())
            ),
            causes=effects,
            base_depends_on={k: _number(k, share) for k, share in result.get("missing_force_depends_on", {}).items()},
            base=_base(result),
            rate=_number_or_nan("rate_hz", sheets[0].get("rate_hz")),
            noise_floor=_number_or_nan("noise_floor_m", result.get("noise_floor_m")),
            rivals=tuple(_rival(one) for one in result.get("rivals", ())),
            text=json.dumps(result, ensure_ascii=False) + "\n",
            scale_assumed=_assumed(parameters, result),
            read_with=dict(result.get("read_with", {})),
            origins={str(one["name"]): _number("origin_s", one["origin_s"]) for one in sheets if "origin_s" in one},
        )
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, UsageError) as error:
        raise DataError(
            f"{name} lacks what a simulation needs ({error}); expected all keys of {schema}: {_next(schema)}"
        ) from None
    try:
        saved_parameters.check(found.parameters, found.model, found)
    except UsageError as error:
        raise DataError(f"{name}: {error}, or {_next(schema)}") from None
    return found


def _objects(text: str, name: str) -> list[dict[str, Any]]:
    """The objects of a file: one a line, or one over several lines."""
    expected = "expected a result that msd identify or msd diagnose wrote with --json"
    try:
        whole = json.loads(text)
    except (ValueError, RecursionError):
        pass
    else:
        found = whole if isinstance(whole, list) else [whole]
        if not all(isinstance(one, dict) for one in found):
            raise DataError(f"{name} is no JSON object; {expected}")
        return found
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip():
            try:
                found.append(dict(json.loads(line)))
            except (TypeError, ValueError, RecursionError):
                raise DataError(f"{name} line {number} is no JSON object; {expected}") from None
    return found


def _what(result: Mapping[str, Any], schema: str) -> str:
    if "error" in result:
        return f"holds no model but an error ({str(result['error'])[:80]})"
    return f"is of schema {schema}" if schema else "names no schema"


def _next(schema: str) -> str:
    command = "diagnose" if "diagnosis" in schema else "identify"
    return f"renew it with msd {command} PATH --json FILE"


def _number(name: str, value: Any) -> float:
    """A number of the result as Python has it: JSON has whole numbers of any length."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ValueError(f"{name} is {json.dumps(value, default=str)[:40]}, which is no number")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} has {len(str(abs(value)))} digits, beyond {LARGEST:g}") from None


def _number_or_nan(name: str, value: Any) -> float:
    """The same, where ``null`` says that there is none."""
    return math.nan if value is None else _number(name, value)


def _quantity(name: str, told: Mapping[str, Any]) -> Quantity:
    """A quantity; strict JSON has ``null`` for an infinite limit, which is none."""
    value = math.inf if told["value"] is None else _number(name, told["value"])
    std = _number_or_nan(f"the std of {name}", told["std"])
    if std < 0.0:
        raise ValueError(f"the std of {name} is {std:g}, below 0")
    return Quantity(value, std, str(told["unit"]))


def _rival(told: Mapping[str, Any]) -> tuple[tuple[str, ...], float]:
    return tuple(told["causes"]), _number("probability", told["probability"])


def _model(parameters: Mapping[str, Quantity], effects: Sequence[str]) -> Model:
    values = {name: quantity.value for name, quantity in parameters.items()}
    model = Plant(*(_finite(name, values[name]) for name in ("mass", "damping", "stiffness")))
    for name in effects:
        effect = by_name(name)
        given = {p.name: values.get(p.name, math.inf) for p in effect.parameters}
        limits = {key for key, none in effect.neutral if none == math.inf}
        for key, value in given.items():
            if key not in limits:
                _finite(key, value)
        model = model + effect.from_values(given)
    return model


def _finite(name: str, value: float) -> float:
    if not math.isfinite(value):
        raise ValueError(f"{name} has no finite value")
    if abs(value) > LARGEST:
        raise ValueError(f"{name} is {value:g}, beyond {LARGEST:g}")
    return value


def _base(result: Mapping[str, Any]) -> Model | None:
    """The linear model of a result: the base of a diagnosis, the original one of an identification."""
    told = result.get("base") or result.get("original")
    if told is None:
        return None
    values = {key: _quantity(key, value).value for key, value in told["parameters"].items()}
    return Plant(values["mass"], values["damping"], values["stiffness"])


def _assumed(parameters: Mapping[str, Quantity], result: Mapping[str, Any]) -> bool:
    """Whether the mass is a kilogram because no force tells it: neither fitted nor given."""
    given = {str(one["name"]) for one in result.get("known", ())}
    mass = parameters["mass"]
    return mass.value == 1.0 and mass.std == 0.0 and not given & {"mass", "stiffness", "damping"}


def _effects_of(parameters: Mapping[str, Quantity]) -> tuple[str, ...]:
    """Effects that a result names by their parameters only, those with most parameters first."""
    left, found = set(parameters), []
    for effect in sorted(LIBRARY, key=lambda effect: -len(effect.parameters)):
        own = {parameter.name for parameter in effect.parameters}
        if own and own <= left:
            found.append(effect.name)
            left -= own
    return tuple(sorted(found))


def _sign(told: Any) -> int:
    if told not in (1, -1):
        raise ValueError(f"force_sign is {told}, neither 1 nor -1")
    return int(told)


def _old_sign(result: Mapping[str, Any]) -> int:
    return -1 if any(str(warning).startswith(_TURNED) for warning in result.get("warnings", ())) else 1
