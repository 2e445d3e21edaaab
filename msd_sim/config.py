"""Rigs from parameters: the same names in a YAML file for ROS, in a mapping, and on the node."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from msd_sim import effects as catalogue
from msd_sim.encoder import PARAMETERS as ENCODER_PARAMETERS
from msd_sim.encoder import Encoder
from msd_sim.errors import RigError
from msd_sim.parameter import RigParameter
from msd_sim.truth import GRAVITY, Truth

#: Dry friction of the rig itself, as in the paper; both give way to an effect with dry friction of its own.
FRICTION = (
    RigParameter("friction_coefficient", "", 0.0, 0.0, 1e3, "Coulomb friction coefficient mu; Fc = mu m g"),
    RigParameter("static_friction_coefficient", "", 0.0, 0.0, 1e3, "at rest; 0: the same as friction_coefficient"),
)
RATE = RigParameter("rate", "Hz", 1000.0, 1e-3, 1e6, "samples per second")

#: More than any parameter has levels: brackets in brackets, dashes behind dashes.
_DEEPEST, _BRACKETS = 5, 100
_INDENTED = re.compile(r"^[ ?:\t-]{200,}", re.MULTILINE)
#: Parameters of the node alone; files may hold them, simulations without ROS pass over them.
NODE_ONLY = (
    "command_timeout",
    "frame_id",
    "hold_last_command",
    "latency",
    "real_time_factor",
    "time_mode",
    "use_sim_time",
    "batch_size",
    "joint_name",
)


@dataclass(frozen=True)
class RigConfig:
    """A whole rig: its truth, its encoder, samples per second and the seed of its noise."""

    truth: Truth
    encoder: Encoder
    rate: float = RATE.default
    seed: int = 0


def parse(given: Mapping[str, Any]) -> RigConfig:
    """A rig from parameters by name, nested or dotted (``encoder.noise``).

    ``effects`` is a list of names, each with its parameters under its own name, or a mapping name -> parameters.

    Raises:
        RigError: a parameter that is missing, unknown or out of range.
    """
    tree = nested(given)
    known = [p.name for p in (*catalogue.PLANT, *FRICTION, RATE)] + ["gravity", "effects", "encoder", "seed"]
    for key in tree:
        if key not in (*known, *NODE_ONLY, *catalogue.ALL):
            raise RigError(f"a rig has no parameter {key!r}; expected one of {', '.join(known)}, or an effect's name")
    for parameter in catalogue.PLANT:
        if parameter.name not in tree:
            raise RigError(f"{parameter.name} is missing; expected a number [{parameter.unit}]: {parameter.meaning}")
    encoder = _mapping(tree.get("encoder", {}), "encoder")
    names = [parameter.name for parameter in ENCODER_PARAMETERS]
    for key in encoder:
        if key not in names:
            raise RigError(f"encoder has no parameter {key!r}; expected one of {', '.join(names)}")
    truth = Truth(tree["mass"], tree["damping"], tree["stiffness"], _effects(tree))
    rate = RATE.checked(tree.get("rate", RATE.default), "rig")
    return RigConfig(truth, Encoder(**encoder), rate, tree.get("seed", 0))


def _mapping(value: Any, what: str) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise RigError(f"{what} is {value!r}; expected its parameters by name")
    return value


def _effects(tree: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Effects by name, the rig's own friction among them."""
    chosen = tree.get("effects") or ()
    if isinstance(chosen, Mapping):
        effects = {name: _mapping(values or {}, name) for name, values in chosen.items()}
    elif isinstance(chosen, str) or not all(isinstance(name, str) for name in chosen):
        raise RigError(f"effects is {chosen!r}; expected a list of names")
    else:
        effects = {name: _mapping(tree.get(name) or {}, name) for name in chosen if name}
    for name in effects:
        catalogue.by_name(name)
    for name in catalogue.ALL:
        if name in tree and name not in effects:
            raise RigError(f"{name} has parameters but is not in effects; add it there or leave them out")
    if not any(catalogue.ALL[name].dry_friction for name in effects):
        effects |= _rig_friction(tree)
    return effects


def _rig_friction(tree: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    kinetic, static = (p.checked(tree.get(p.name, p.default), "rig") for p in FRICTION)
    weight = catalogue.PLANT[0].checked(tree["mass"], "rig") * tree.get("gravity", GRAVITY)
    if 0.0 < static < kinetic:
        raise RigError(
            f"static_friction_coefficient is {static:g}, below friction_coefficient {kinetic:g}; expected at least that"
        )
    if max(kinetic, static) == 0.0:
        return {}
    forces = {"coulomb_force": kinetic * weight}
    return {"coulomb_friction": forces | ({"static_force": static * weight} if static > kinetic else {})}


def nested(given: Mapping[str, Any], depth: int = 0) -> dict[str, Any]:
    """Dotted names opened: {"a.b": 1} and {"a": {"b": 1}} become the latter.

    Raises:
        RigError: the same name for a value and for a group, or more levels than any rig has.
    """
    if depth > _DEEPEST:
        raise RigError(f"parameters in {depth} levels; expected 3: is there an alias within itself?")
    tree: dict[str, Any] = {}
    for key, value in given.items():
        head, _, rest = str(key).partition(".")
        if rest:
            branch = tree.setdefault(head, {})
            if not isinstance(branch, dict):
                raise RigError(f"{head} is {branch!r} and {key} is {value!r}; expected one or the other")
            branch |= nested({rest: value}, depth + 1)
        elif isinstance(value, Mapping) and isinstance(tree.get(head), dict):
            tree[head] |= nested(value, depth + 1)
        else:
            tree[head] = nested(value, depth + 1) if isinstance(value, Mapping) else value
    return tree


def folders() -> tuple[Path, ...]:
    """Where rigs by name are looked for: the working tree, then what was installed."""
    prefixes = [sys.prefix, *os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)]
    installed = (Path(prefix) / "share" / "msd_ident" / "config" for prefix in prefixes if prefix)
    return (Path(__file__).parents[1] / "config", *installed)


def load(name: str) -> dict[str, Any]:
    """Parameters of a rig by name (``ecp``) or from a YAML file in the form of ROS 2 parameter files.

    Raises:
        RigError: there is no such rig or file, or it does not read as one.
    """
    path = Path(name)
    if path.suffix not in (".yaml", ".yml"):
        found = [folder / f"{name}.yaml" for folder in folders() if (folder / f"{name}.yaml").is_file()]
        if not found:
            raise RigError(f"no rig {name!r}; expected one of {', '.join(names())}, or the path of a .yaml file")
        path = found[0]
    if path.exists() and not path.is_file():
        raise RigError(f"{name} is no file; expected a rig's .yaml file, or one of {', '.join(names())}")
    try:
        text = path.read_text(encoding="utf-8")
        if _INDENTED.search(text) or text.count("[") + text.count("{") > _BRACKETS:
            raise RigError(f"{name} is nested too deeply; expected '/**:', 'ros__parameters:', and parameters below")
        tree = yaml.safe_load(text)
    except FileNotFoundError:
        raise RigError(f"no file {name}; expected a rig's .yaml file, or one of {', '.join(names())}") from None
    except RigError:
        raise
    except (OSError, ValueError, RecursionError, yaml.YAMLError) as error:
        raise RigError(f"{name} cannot be read as YAML ({' '.join(str(error).split())})") from None
    return _parameters(tree, name)


def _parameters(tree: Any, name: str) -> dict[str, Any]:
    """The parameters in a ROS 2 parameter file: those of all nodes and of any node called ``rig``."""
    found: dict[str, Any] = {}
    for node, block in tree.items() if isinstance(tree, Mapping) else ():
        if str(node).split("/")[-1] in ("**", "rig") and isinstance(block, Mapping):
            found |= nested(_mapping(block.get("ros__parameters") or {}, f"ros__parameters of {node}"))
    if not found:
        raise RigError(f"{name} has no parameters of a rig; expected '/**:', 'ros__parameters:' and mass, damping, ...")
    return found


def names() -> list[str]:
    """Rigs that can be asked for by name."""
    found = set()
    for path in (path for folder in folders() if folder.is_dir() for path in folder.glob("*.yaml")):
        try:
            parse(load(str(path)))
        except RigError:
            continue  # a parameter file of another node
        found.add(path.stem)
    return sorted(found)
