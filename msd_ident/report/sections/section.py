"""One section of a page: its template, the template's values, and its plots."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from msd_ident.report.plot import Plot


@dataclass(frozen=True)
class Section:
    """A part of a result, arranged for a template.

    Attributes:
        slug: file name of the template without its ending, and class of the section on the page.
        title: its heading.
        context: what the template is given, beside ``here`` and ``plots``.
        plots: all plots, in order: files get the same as the page.
        beside: plots for files alone, of what the page shows by other means.
    """

    slug: str
    title: str
    context: Mapping[str, Any] = field(default_factory=dict)
    plots: tuple[Plot, ...] = ()
    beside: tuple[Plot, ...] = ()
