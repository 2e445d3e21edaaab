"""Base class of the page's sections: title, template, plots and values."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, Generic, TypeVar

from msd_ident.report.plot import Plot

Found = TypeVar("Found")


class Section(ABC):
    """One section: it arranges a part of a result for its template of the same name."""

    slug: ClassVar[str]
    title: ClassVar[str]

    @property
    def template(self) -> str:
        """File name of the template."""
        return f"{self.slug}.html.j2"

    @property
    def plots(self) -> tuple[Plot, ...]:
        """All plots, in order: files get the same as the page."""
        return ()

    @property
    def papers(self) -> tuple[Plot, ...]:
        """What goes into files: the plots, and what a page shows by other means."""
        return self.plots

    @abstractmethod
    def context(self) -> Mapping[str, Any]:
        """What the template is given, beside ``section`` and ``plots``."""


class ResultSection(Section, Generic[Found]):
    """A section about one result.

    Args:
        found: the result.
    """

    def __init__(self, found: Found) -> None:
        self._found = found
