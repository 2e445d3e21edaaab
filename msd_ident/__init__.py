"""Identify a mass-spring-damper from a force and an encoder signal, and find what its model lacks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable

    from msd_ident.workflow.saved_model import SavedModel


def load(path: str | os.PathLike[str]) -> SavedModel:
    """The model of a result that ``msd identify`` or ``msd diagnose`` wrote with ``--json``: a ``saved.SavedModel``."""
    from msd_ident.workflow import saved_model

    return saved_model.load(path)


def batch(paths: Iterable[str | os.PathLike[str]], client: Any = None, wait: bool = True, **given: Any) -> Any:
    """A ``pyarrow.Table`` with a row for each record, as ``msd batch`` makes it; needs the extra ``batch``.

    Args:
        paths: folders, patterns and records, here or in object stores.
        client: a ``distributed.Client`` of a cluster; without one the cores of this machine work.
        wait: False for a Dask future a record at once, path → its rows; they need a client.
        given: ``job`` and ``plan``, see ``msd_ident.batching.batch``.

    Raises:
        DataError, UsageError, SetupError: nothing to do, or a cluster that cannot be used.
    """
    from msd_ident.batching import batch as many
    from msd_ident.errors import UsageError

    if wait:
        return many.batch(paths, client=client, **given)
    if client is None:
        raise UsageError("futures without a client; expected one of a cluster that goes on: msd_ident.batch(…, client)")
    return many.futures(paths, client, **given)
