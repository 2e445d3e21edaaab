"""The options that say how measurements are read, given to a subcommand as one ``SourceOptions``."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from msd_ident.cli import options

if TYPE_CHECKING:
    from msd_ident.io import SourceOptions

    Source = SourceOptions
else:
    Source = Any  # evaluated at run time, when the readers are not to be loaded yet

#: Options that say how measurements are read: name of a ``SourceOptions`` field → annotation and default.
READING: dict[str, tuple[Any, Any]] = {
    "force": (options.ForceOption, ""),
    "position": (options.PositionOption, ""),
    "time": (options.TimeOption, ""),
    "rate": (options.RateOption, None),
    "run": (options.RunOption, ""),
    "force_scale": (options.ForceScaleOption, None),
    "position_scale": (options.PositionScaleOption, None),
    "time_scale": (options.TimeScaleOption, None),
    "force_unit": (options.ForceUnitOption, ""),
    "position_unit": (options.PositionUnitOption, ""),
    "hold": (options.HoldOption, "auto"),
    "start": (options.StartOption, None),
    "end": (options.EndOption, None),
}


def reading(command: Callable[..., int]) -> Callable[..., int]:
    """Give a subcommand all options of ``READING``, which it takes as one: its parameter ``source``.

    The command line refuses, as ``UsageError``, what ``SourceOptions`` refuses.
    """

    def called(**given: Any) -> int:
        from msd_ident.io import SourceOptions

        source = SourceOptions(**{name: given.pop(name) for name in READING})
        return command(source=source, **given)

    keyword = inspect.Parameter.KEYWORD_ONLY
    shared = [
        inspect.Parameter(name, keyword, default=default, annotation=annotation)
        for name, (annotation, default) in READING.items()
    ]
    own = inspect.signature(command, eval_str=True)
    parameters = [
        one
        for name, parameter in own.parameters.items()
        for one in (shared if name == "source" else [parameter.replace(kind=keyword)])
    ]
    called.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
    called.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    called.__name__, called.__doc__, called.__module__ = command.__name__, command.__doc__, command.__module__
    return called
