"""How a target carries an effect: exactly, approximately, or not at all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from msd_ident.model.effects import LIBRARY, spoken

if TYPE_CHECKING:
    from msd_ident.export.target import Target
    from msd_ident.model.effects import Effect

Kind = Literal["exact", "approximated", "cannot"]
#: Kind → words for tables.
WORDS: dict[Kind, str] = {"exact": "exact", "approximated": "approximated", "cannot": "not expressible"}


@dataclass(frozen=True)
class Support:
    """How a target carries one effect.

    Attributes:
        kind: ``exact``: the law itself; ``approximated``: the nearest law of the format is fitted in its place;
            ``cannot``: nothing in the format does what it does.
        how: by which element, or what is lost, in a few words.
    """

    kind: Kind
    how: str

    @property
    def text(self) -> str:
        """Kind and way, for a table."""
        return f"{WORDS[self.kind]}: {self.how}"


#: A force that acts before its stamp says.
BEFORE = Support("cannot", "a force that acts before it is commanded: shift the commands instead")


@dataclass(frozen=True)
class Row:
    """How a target carries one effect of a model.

    Attributes:
        effect: its name.
        support: how.
    """

    effect: str
    support: Support

    @property
    def sentence(self) -> str:
        """For a header or the terminal."""
        return f"{spoken(self.effect)}: {self.support.text}"


def rows(target: Target, effects: Iterable[type[Effect]] = LIBRARY) -> tuple[Row, ...]:
    """How a target carries each effect.

    Args:
        target: the format.
        effects: in the order of the result; the whole library by default.
    """
    return tuple(Row(effect.name, target.supports(effect)) for effect in effects)
