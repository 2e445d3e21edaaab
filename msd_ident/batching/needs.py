"""Import of the libraries of the extra ``batch``, with an error that names it."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from msd_ident.errors import SetupError

#: Distribution and module names of what runs many records.
LIBRARIES = {"dask": "dask[distributed]", "distributed": "dask[distributed]", "pyarrow": "pyarrow", "fsspec": "fsspec"}


def library(name: str) -> Any:
    """A module of the extra.

    Raises:
        SetupError: it is not installed.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError as missing:
        package = LIBRARIES.get(name.split(".")[0], missing.name or name)
        raise SetupError(
            f"{package} is not installed; expected the extra batch for many records: pip install 'msd_ident[batch]'"
        ) from None
