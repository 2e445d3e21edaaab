"""The library: every physical effect that can join a plant, one file each."""

from __future__ import annotations

import importlib
import pkgutil

from msd_ident.errors import UsageError
from msd_ident.model.declarations import Parameter
from msd_ident.model.effects.base import Effect
from msd_ident.model.effects.law import ARGUMENTS

__all__ = ["ARGUMENTS", "LIBRARY", "Effect", "Parameter", "by_name", "saturation", "spoken", "structural"]

_HELPERS = ("base", "law", "typical")


def _discover() -> tuple[type[Effect], ...]:
    found: dict[str, type[Effect]] = {}
    for info in pkgutil.iter_modules(__path__):
        if info.name in _HELPERS:
            continue
        module = importlib.import_module(f"{__name__}.{info.name}")
        for item in vars(module).values():
            if isinstance(item, type) and issubclass(item, Effect) and item.__module__ == module.__name__:
                found[item.name] = item
    return tuple(found[name] for name in sorted(found))


#: All effects, sorted by name. A file in this folder is all that a new one needs.
LIBRARY: tuple[type[Effect], ...] = _discover()
_NAMED = {effect.name: effect for effect in LIBRARY}


def by_name(name: str) -> type[Effect]:
    """The effect called ``name``.

    Raises:
        UsageError: when there is none; the message lists those there are.
    """
    if name in _NAMED:
        return _NAMED[name]
    raise UsageError(f"no effect is called {name!r}; expected one of {', '.join(e.name for e in LIBRARY)}")


def structural(role: str) -> type[Effect] | None:
    """The effect with nothing but this part in the structure, see ``Effect.structure``; ``None`` without one."""
    return next((effect for effect in LIBRARY if effect.structure == role and not effect.laws()), None)


def saturation() -> type[Effect] | None:
    """The effect that limits the force, see ``Effect.limits_force``; ``None`` in a library without one."""
    return next((effect for effect in LIBRARY if effect.limits_force), None)


def spoken(name: str) -> str:
    """The name as people say it: ``quadratic drag`` for ``quadratic_drag``, ``Coulomb friction``, ``Bouc-Wen``."""
    person = next((effect.eponym for effect in LIBRARY if effect.name == name), "")
    return name.replace(person.lower().replace("-", "_"), person, 1).replace("_", " ")
