"""The one error of the world: a rig or an experiment that makes no sense, said in one line."""

from __future__ import annotations


class RigError(ValueError):
    """Change the rig's parameters or the experiment: what was found, what was expected."""
