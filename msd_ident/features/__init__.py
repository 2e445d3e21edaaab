"""Step response and free decay: the paper's equations, numbered, and what they need from the data."""

from __future__ import annotations

from msd_ident.features.extract import Features, extract, pooled
from msd_ident.features.form import Physical, StandardForm
from msd_ident.features.response import Response

__all__ = ["Features", "Physical", "Response", "StandardForm", "extract", "pooled"]
