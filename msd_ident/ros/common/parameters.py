"""Parameters of the nodes, declared with description and range, and checked when they are set."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import yaml
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from msd_ident.errors import UsageError

_KINDS = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "a text",
    list: "a list of texts",
}


@dataclass(frozen=True)
class Setting:
    """One parameter.

    Attributes:
        name: of the parameter.
        default: its value, which gives its type too.
        meaning: what it does, with its unit.
        lower: least number that is taken.
        upper: greatest number that is taken.
        choices: words that are taken; empty for any.
        fixed: it can be set at the start only.
    """

    name: str
    default: Any
    meaning: str
    lower: float | None = None
    upper: float | None = None
    choices: tuple[str, ...] = ()
    fixed: bool = True


def declared(node: str) -> tuple[Setting, ...]:
    """The parameters in ``parameters.yaml`` of a node's folder, which has the keys of generate_parameter_library."""
    file = resources.files(f"msd_ident.ros.{node}").joinpath("parameters.yaml")
    found = []
    for name, entry in yaml.safe_load(file.read_text(encoding="utf-8")).items():
        checks = entry.get("validation", {})
        lower, upper = checks.get("bounds<>", (None, None))
        (choices,) = checks.get("one_of<>", ((),))
        fixed = entry.get("read_only", False)
        found.append(Setting(name, entry["default_value"], entry["description"], lower, upper, tuple(choices), fixed))
    return tuple(found)


def overrides(values: Mapping[str, Any]) -> list[Parameter]:
    """Parameters for a node, which go before those of the command line."""
    return [Parameter(name, value=value) for name, value in values.items()]


class Settings:
    """The parameters of a node: declared at once, read by name, every later change checked.

    Raises:
        UsageError: a value given at the start is nonsense.
    """

    def __init__(self, node: Node, settings: Sequence[Setting]) -> None:
        self._node = node
        self._settings = {setting.name: setting for setting in settings}
        for setting in settings:
            _declare(node, setting)
        _warn_of_unknown(node, self._settings)
        reasons = [self._reason(name, node.get_parameter(name).value) for name in self._settings]
        for reason in filter(None, reasons):
            raise UsageError(reason)
        node.add_on_set_parameters_callback(self._checked)

    def __getitem__(self, name: str) -> Any:
        value, setting = self._node.get_parameter(name).value, self._settings[name]
        return float(value) if isinstance(setting.default, float) else value

    def _checked(self, parameters: list[Parameter]) -> SetParametersResult:
        reasons = [self._reason(parameter.name, parameter.value) for parameter in parameters]
        found = next(filter(None, reasons), "")
        return SetParametersResult(successful=not found, reason=found)

    def _reason(self, name: str, value: Any) -> str:
        """Why a value is refused; empty when it is not."""
        setting = self._settings.get(name)
        if setting is None:
            return ""
        if setting.choices and value not in setting.choices:
            return f"{name} is {value!r}; expected one of {', '.join(setting.choices)}"
        if isinstance(setting.default, float):
            return _odd_number(setting, value)
        return ""


def _warn_of_unknown(node: Node, known: Mapping[str, Setting]) -> None:
    """Name the parameters given at the start that the node has not: one is misspelt, or a file is for several nodes."""
    for name in sorted(set(getattr(node, "_parameter_overrides", {})) - set(known)):
        if node.has_parameter(name) or name.startswith("qos_overrides."):  # rclpy's own, such as use_sim_time
            continue
        near = difflib.get_close_matches(name, known, n=1)
        node.get_logger().warning(
            f"there is no parameter {name}; expected one of this node's{f', such as {near[0]}' if near else ''}: "
            f"check the spelling, or list them with: ros2 param list {node.get_fully_qualified_name()}"
        )


def topic_name(node: Node, topic: str, setting: str, expected: str) -> str:
    """The whole name of a topic that a parameter names.

    Args:
        node: whose namespace and remappings count.
        topic: its name.
        setting: the parameter and its value, for the words of the refusal.
        expected: what its value should be, for the same.

    Raises:
        UsageError: no topic can have this name.
    """
    try:
        return str(node.resolve_topic_name(topic))
    except Exception as error:  # rclpy has several kinds for bad names
        reason = str(error).strip().splitlines()[0].removeprefix("failed to resolve name: ").partition(", at ")[0]
        raise UsageError(f"{setting}: {reason.rstrip('.:')}; expected {expected}") from None


def _odd_number(setting: Setting, value: Any) -> str:
    """Why a value is no number for a setting; empty when it is one. A whole number is as good as one with a point."""
    if isinstance(value, bool) or not isinstance(value, float | int):
        return f"{setting.name} is {value!r}; expected {_KINDS[float]}"
    low = -math.inf if setting.lower is None else setting.lower
    high = math.inf if setting.upper is None else setting.upper
    if not math.isfinite(value) or not low <= value <= high:
        return f"{setting.name} is {value}; expected {_range(setting)}"
    return ""


def _declare(node: Node, setting: Setting) -> None:
    try:
        node.declare_parameter(setting.name, setting.default, _descriptor(setting))
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        given = getattr(node, "_parameter_overrides", {}).get(setting.name)
        found = "not right" if given is None else repr(given.value)
        wanted = _KINDS[type(setting.default)]
        if isinstance(error, InvalidParameterValueException):
            wanted = _range(setting)
        raise UsageError(f"{setting.name} is {found}; expected {wanted}") from None


def _range(setting: Setting) -> str:
    return f"{setting.lower:g} to {setting.upper:g}" if setting.upper is not None else setting.meaning


def _descriptor(setting: Setting) -> ParameterDescriptor:
    described = ParameterDescriptor(description=setting.meaning, read_only=setting.fixed)
    described.dynamic_typing = isinstance(setting.default, float)  # 2 is as good as 2.0
    if setting.choices:
        described.additional_constraints = f"one of {', '.join(setting.choices)}"
    if setting.lower is None or setting.upper is None:
        return described
    if isinstance(setting.default, int):
        described.integer_range = [IntegerRange(from_value=int(setting.lower), to_value=int(setting.upper))]
    else:
        described.floating_point_range = [FloatingPointRange(from_value=setting.lower, to_value=setting.upper)]
    return described
