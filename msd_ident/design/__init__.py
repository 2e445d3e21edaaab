"""The next experiment: force profiles within a rig's limits that decide between tied causes.

In: a ``Diagnosis`` and the rig's ``Limits``. Out: a ``Proposal`` with profile, duration and probability of a decision.
Begin with ``proposal``, then ``evaluation`` (what a profile would show) and ``profile_search``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from msd_ident.design.limits import Limits, read_limits
from msd_ident.design.profile import Profile, Segment
from msd_ident.design.profile_file import read_profile, write_profile

if TYPE_CHECKING:
    from msd_ident.design.proposal import (
        Proposal,
        check,
        check_predictable,
        default_limits,
        design,
        proposing,
        signs_doubt,
    )

__all__ = [
    "Limits",
    "Profile",
    "Proposal",
    "Segment",
    "check",
    "check_predictable",
    "default_limits",
    "design",
    "proposing",
    "read_limits",
    "read_profile",
    "signs_doubt",
    "write_profile",
]


def __getattr__(name: str) -> Any:
    """What a proposal is made with, when it is asked for: a node that plays a profile needs no diagnosis."""
    if name in __all__:
        return getattr(import_module("msd_ident.design.proposal"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
