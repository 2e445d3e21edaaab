"""The next experiment: profiles, limits, and the design that parts what the data cannot tell apart."""

from __future__ import annotations

from msd_ident.design.limits import Limits, read_limits
from msd_ident.design.profile import Profile, Segment
from msd_ident.design.profile_file import read_profile, write_profile
from msd_ident.design.proposal import Proposal, check, default_limits, design, proposing

__all__ = [
    "Limits",
    "Profile",
    "Proposal",
    "Segment",
    "check",
    "default_limits",
    "design",
    "proposing",
    "read_limits",
    "read_profile",
    "write_profile",
]
