"""The sections of the page: one class and one template each, in the order of a reader's questions."""

from __future__ import annotations
