"""The sections of the page: one function or two, and a template each, in the order of a reader's questions."""

from __future__ import annotations
