"""The sections of the page: one class and one template each, in the order in which people ask."""

from __future__ import annotations
