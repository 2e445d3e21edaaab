"""Pages of comparisons and monitoring: a headline, plots and a table, in the style of the other pages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from msd_ident.report.page import document, environment
from msd_ident.report.plot import Plot
from msd_ident.writing import write_text


@dataclass(frozen=True)
class HeadlineSection:
    """A section.

    Attributes:
        slug: for anchors.
        title: of it; that of the first section is the page's headline.
        lines: paragraphs.
        plots: below them.
        head, rows: of a table; empty for none.
        warnings: what a reader must know.
        pill: class and words of a coloured label; empty for none.
    """

    slug: str
    title: str
    lines: tuple[str, ...] = ()
    plots: tuple[Plot, ...] = ()
    head: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    warnings: tuple[str, ...] = ()
    pill: tuple[str, str] = ("", "")


def save(command: str, name: str, sections: Sequence[HeadlineSection], path: Path) -> None:
    """Write the page.

    Args:
        command: subcommand that the page is of.
        name: title of the page.
        sections: in their order.
        path: file to write.

    Raises:
        SetupError: the disk does not take it.
    """
    write_text(render(command, name, sections), path)


def render(command: str, name: str, sections: Sequence[HeadlineSection]) -> str:
    """The page as text."""
    from markupsafe import Markup

    template = environment().get_template("headline.html.j2")
    bodies: list[dict[str, Any]] = [
        {
            "anchor": one.slug,
            "slug": "verdict" if place == 0 else one.slug,
            "title": one.title,
            "body": Markup(template.render(one=one, here=one.slug, first=place == 0)),
        }
        for place, one in enumerate(sections)
    ]
    article = {"anchor": "r1", "command": command, "name": name, "verdict": "", "pill": "", "sections": bodies}
    return document([article], f"{name} – {command}")
