"""``--on PATH``: the model that was just found, tried on further records."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

    from msd_ident.io import SourceOptions


@dataclass(frozen=True)
class Trials:
    """Records that every model found is tried on.

    Attributes:
        paths: of the records.
        source: how they are read: as those that the model is from.
    """

    paths: Sequence[Path]
    source: SourceOptions

    def __call__(self, result: Mapping[str, Any], console: Console | None) -> dict[str, Any]:
        """Try a result's model; the objects that go into its JSON. Shown on the console where there is one.

        Raises:
            DataError, UsageError: a path that cannot be read, or is in other units than the model.
        """
        if not self.paths:
            return {}
        from msd_ident.io import read_all
        from msd_ident.report.validation import print_validation
        from msd_ident.workflow import saved_model, validation

        model, told = saved_model.from_json_dict(result), []
        for path in self.paths:
            found = validation.validate(model, read_all(path, self.source))
            line = found.to_json_dict()
            told.append({"schema": line.pop("schema"), "path": str(path), **line})
            if console is not None:
                print_validation(found, console)
        return {"validations": told}


#: What is done with a result once it is shown; gives further keys for its JSON.
Further = Callable[[Mapping[str, Any], "Console | None"], dict[str, Any]]


def both(first: Further, second: Further) -> Further:
    """One after the other, the keys of both."""
    return lambda result, console: {**first(result, console), **second(result, console)}
