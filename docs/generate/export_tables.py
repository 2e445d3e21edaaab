"""What each export target says of each effect, from the targets themselves."""

from __future__ import annotations

from docs_tables import table

from msd_ident.export import TARGETS, target
from msd_ident.export.support import rows
from msd_ident.model.effects import LIBRARY

_SIGNS = {"exact": "exact", "approximated": "≈", "cannot": "–"}


def written(name: str) -> str:
    """The table of all targets (``all``), or of one with the way each effect goes."""
    if name != "all":
        said = [(f"[{row.effect}](effects/{row.effect}.md)", _SIGNS[row.support.kind], row.support.how) for row in
                rows(target(name))]  # fmt: skip
        return table(("effect", "class", "how"), said)
    columns = [{row.effect: row.support.kind for row in rows(one)} for one in TARGETS]
    lines = [
        (f"[{effect.name}](effects/{effect.name}.md)", *(_SIGNS[column[effect.name]] for column in columns))
        for effect in LIBRARY
    ]
    return table(("effect", *(one.name for one in TARGETS)), lines)
