"""The rig's parameters in ROS: declared with meaning, unit and range, and checked in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node

from msd_sim import config, effects, names
from msd_sim.encoder import PARAMETERS as ENCODER_PARAMETERS
from msd_sim.errors import RigError
from msd_sim.parameter import RigParameter

#: Defaults of the paper's rig, where those of a simulation without ROS are "none".
_DEFAULTS = {"friction_coefficient": 0.0133, "encoder.counts_per_metre": 226600.0}
_TIMING = (
    RigParameter("latency", "s", 0.005, 0.0, 1.0, "delay of the rig behind the clock, so that no force arrives late"),
    RigParameter(
        "command_timeout",
        "s",
        1.0,
        0.0,
        1e6,
        "time without a command after which a force without liveliness is set to 0; 0: never",
    ),
    RigParameter("real_time_factor", "", 10.0, 1e-3, 1e3, "speed of the clock in the time mode fast"),
)
_WHOLE = {
    "seed": (0, 0, 2**62, "seed of the encoder's noise"),
    "batch_size": (100, 1, 100_000, f"samples in a batch, if more than {names.MOST_SINGLE:g} are sent per second"),
}
_WORDS: dict[str, tuple[Any, str]] = {
    "effects": (
        [],
        f"effects that the rig has, any of {', '.join(effects.ALL)}; each has its parameters under its name",
    ),
    "hold_last_command": (False, "keep the force when its publisher is gone or silent (no dead man's switch)"),
    "time_mode": ("real_time", "real_time, or fast: the rig makes the time and publishes /clock"),
    "frame_id": (names.NODE, "frame of the encoder's messages"),
    "joint_name": (names.JOINT, "name of the joint in encoder messages"),
}
_READ_ONLY = ("frame_id", "rate", "time_mode", "real_time_factor", "joint_name")


def _numbers() -> Iterator[tuple[str, RigParameter]]:
    """All parameters that are real numbers, by their ROS names."""
    for parameter in (*effects.PLANT, *config.FRICTION, config.RATE, *_TIMING):
        yield parameter.name, parameter
    for parameter in ENCODER_PARAMETERS:
        yield f"encoder.{parameter.name}", parameter
    for effect in effects.ALL.values():
        for parameter in effect.parameters:
            yield f"{effect.name}.{parameter.name}", parameter


def declare(node: Node) -> dict[str, Any]:
    """Declare all parameters; their values by name.

    Raises:
        rclpy.exceptions.ParameterException: a value out of range or of a wrong type.
    """
    for name, (default, low, high, meaning) in _WHOLE.items():
        descriptor = ParameterDescriptor(description=meaning, read_only=True)
        descriptor.integer_range = [IntegerRange(from_value=low, to_value=high, step=1)]
        node.declare_parameter(name, default, descriptor)
    for name, (default, meaning) in _WORDS.items():
        node.declare_parameter(name, default, _descriptor(name, meaning))
    for name, parameter in _numbers():
        meaning = f"{parameter.meaning} [{parameter.unit}]" if parameter.unit else parameter.meaning
        descriptor = _descriptor(name, meaning)
        descriptor.floating_point_range = [FloatingPointRange(from_value=parameter.lower, to_value=parameter.upper)]
        node.declare_parameter(name, _DEFAULTS.get(name, parameter.default), descriptor)
    declared = [*_WHOLE, *_WORDS, *(name for name, _ in _numbers())]
    unknown = set(getattr(node, "_parameter_overrides", ())) - {*declared, "use_sim_time"}
    if unknown:  # a file for all nodes may hold those of others, so this is no error
        node.get_logger().warning(f"parameters that a rig has not: {', '.join(sorted(unknown))}; check the spelling")
    return {name: node.get_parameter(name).value for name in declared}


def check_given(node: Node, arguments: Sequence[str]) -> None:
    """Refuse a number of the command line that ROS passes over: a parameter file has it as another type, which stays.

    Raises:
        RigError: such a number.
    """
    files = [i for i, flag in enumerate(arguments) if flag == "--params-file"]
    if not files:
        return
    units = {**{name: "" for name in _WHOLE}, **{name: f" [{one.unit}]" for name, one in _numbers()}}
    after = arguments[files[-1] :]  # a file that comes later wins
    given = dict(text.split(":=", 1) for flag, text in pairwise(after) if flag in ("-p", "--param") and ":=" in text)
    for name, text in given.items():
        if name not in units:
            continue
        kept = node.get_parameter(name).value
        if _number(text) != kept and text != str(kept):
            raise RigError(
                f"{name} is {text} on the command line, and stays {kept} of the parameter file, where it has another "
                f"type; expected a number{units[name]} written as there: change the file or the option"
            )


def _number(text: str) -> float | None:
    """The number that ROS reads from a text; None where it is none."""
    try:
        return float(int(text, 0) if text[:2].lower() == "0x" else float(text))
    except ValueError:
        return None


def _descriptor(name: str, meaning: str) -> ParameterDescriptor:
    # Dynamic typing: 1 is as good a mass as 1.0, and an empty list has no type in ROS.
    return ParameterDescriptor(description=meaning, read_only=name in _READ_ONLY, dynamic_typing=True)


def samples_per_second(values: Mapping[str, Any]) -> float:
    """Samples per second of the wall's time."""
    return float(values["rate"]) * (float(values["real_time_factor"]) if values["time_mode"] == "fast" else 1.0)


def checked(values: Mapping[str, Any]) -> config.RigConfig:
    """The rig that these parameter values describe.

    Raises:
        RigError: they make no sense.
    """
    for parameter in _TIMING:
        parameter.checked(values[parameter.name], names.NODE)
    if values["time_mode"] not in ("real_time", "fast"):
        raise RigError(f"time_mode is {values['time_mode']!r}; expected 'real_time' or 'fast'")
    if isinstance(values["effects"], str) and values["effects"]:
        name = values["effects"]
        raise RigError(f"effects is {name!r}, a text; expected a list of names: write ['{name}']")
    chosen = [str(name) for name in values["effects"] or () if name]
    passed_over = {*config.NODE_ONLY, *(set(effects.ALL) - set(chosen))}
    kept = {name: value for name, value in values.items() if name.split(".")[0] not in passed_over}
    rig = config.parse(kept | {"effects": chosen})
    often = samples_per_second(values)
    if often > names.MOST_SINGLE and rig.encoder.jitter > 0.0:
        raise RigError(
            f"encoder jitter at {often:g} samples a second; expected none above {names.MOST_SINGLE:g}, where one stamp "
            "stands for a batch"
        )
    return rig
