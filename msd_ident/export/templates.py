"""Texts of exported files, from the folder ``templates``: each ``@NAME@`` in a text is replaced by its value."""

from __future__ import annotations

import re
from functools import cache
from importlib import resources


def filled(template: str, **values: str) -> str:
    """A text with its values.

    Args:
        template: name of the file in ``templates``.
        values: for each ``@NAME@`` of the text, by the same name; capitals do not matter.
    """
    by_name = {name.upper(): value for name, value in values.items()}
    return re.sub("@([A-Z_]+)@", lambda found: by_name[found[1]], read(template))


@cache
def read(template: str) -> str:
    """A text without its values."""
    return resources.files("msd_ident.export").joinpath("templates").joinpath(template).read_text(encoding="utf-8")
