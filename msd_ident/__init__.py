"""Turn a force input and an encoder signal into a model a lab can trust."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from msd_ident.saved import SavedModel

# On matrices of ten by ten the threads of BLAS gain nothing, and spin beside those that fit: a diagnosis takes a fifth
# longer with them. A setting of the user's own stands, and so does numpy's where it was imported before.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def load(path: str | os.PathLike[str]) -> SavedModel:
    """The model of a result that ``msd identify`` or ``msd diagnose`` wrote with ``--json``: a ``saved.SavedModel``."""
    from msd_ident import saved

    return saved.load(path)
