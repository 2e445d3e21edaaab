"""Check that Bokeh is installed. Imports nothing of it."""

from __future__ import annotations

import importlib.util

from msd_ident.errors import SetupError


def require_page() -> None:
    """See that Bokeh can be imported.

    Raises:
        SetupError: it cannot.
    """
    if importlib.util.find_spec("bokeh") is None:
        raise SetupError(
            "bokeh is not installed, and the live view needs it: run `make setup`, or pip install 'msd_ident[live]'"
        )
