"""Step response and free decay: the paper's numbered equations, and the peaks and levels that they need.

In: a ``Record``. Out: ``Features``, and from those of all records the ``StandardForm``: ωn, ζ and K with intervals.
Begin with ``extract``, then ``response`` and ``decay`` (what is read off) and ``equations``.
"""

from __future__ import annotations

from msd_ident.features.extract import Features, extract
from msd_ident.features.form import Physical, StandardForm, pool
from msd_ident.features.response import Response

__all__ = ["Features", "Physical", "Response", "StandardForm", "extract", "pool"]
