"""Options that a subcommand takes as one object: how measurements are read, where results go, how batches run."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, get_type_hints

from msd_ident.cli import many_records, options, results

if TYPE_CHECKING:
    from msd_ident.io import SourceOptions

    Source = SourceOptions
else:
    Source = Any  # evaluated at run time, when the readers are not to be loaded yet


_KEYWORD = inspect.Parameter.KEYWORD_ONLY


class _SourceFields:
    """The fields of ``SourceOptions``."""

    force: options.ForceOption = ""
    position: options.PositionOption = ""
    time: options.TimeOption = ""
    rate: options.RateOption = None
    run: options.RunOption = ""
    force_scale: options.ForceScaleOption = None
    position_scale: options.PositionScaleOption = None
    time_scale: options.TimeScaleOption = None
    force_unit: options.ForceUnitOption = ""
    position_unit: options.PositionUnitOption = ""
    hold: options.HoldOption = "auto"
    start: options.StartOption = None
    end: options.EndOption = None


def _source(**fields: Any) -> Source:
    from msd_ident.io import SourceOptions

    return SourceOptions(**fields)


#: Name of a subcommand's parameter → the class that has an option for each field, and what makes the object.
GROUPS: dict[str, tuple[type, Callable[..., Any]]] = {
    "source": (_SourceFields, _source),
    "batching": (many_records.Batching, many_records.Batching),
    "output": (results.Output, results.Output),
}


def _options(declared: type) -> dict[str, inspect.Parameter]:
    """A keyword parameter for each field of a class, with its option and its default."""
    hints = get_type_hints(declared, include_extras=True)
    return {
        name: inspect.Parameter(name, _KEYWORD, default=getattr(declared, name), annotation=option)
        for name, option in hints.items()
    }


def grouped(*outputs: str) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """Give a subcommand the options of each group of ``GROUPS`` that it has a parameter for.

    Args:
        outputs: the options of the group ``output`` that the subcommand has, in that order.

    The command line refuses, as ``UsageError``, what ``SourceOptions`` refuses.
    """

    def decorate(command: Callable[..., int]) -> Callable[..., int]:
        """The command as typer sees it: each group's parameter replaced by the options that make its object."""
        own = inspect.signature(command, eval_str=True)
        taken = {
            group: {name: option for name, option in _options(declared).items() if group != "output" or name in outputs}
            for group, (declared, _) in GROUPS.items()
            if group in own.parameters
        }

        def called(**given: Any) -> int:
            for group, fields in taken.items():
                given[group] = GROUPS[group][1](**{name: given.pop(name) for name in fields})
            return command(**given)

        parameters: list[inspect.Parameter] = []
        for name, parameter in own.parameters.items():
            if name in taken:
                parameters += taken[name].values()
            else:
                parameters.append(parameter.replace(kind=_KEYWORD))
        called.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        called.__name__, called.__doc__, called.__module__ = command.__name__, command.__doc__, command.__module__
        return called

    return decorate
