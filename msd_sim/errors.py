"""The one error of the world: a rig or an experiment that makes no sense, said in one line."""

from __future__ import annotations

#: Characters of the longest line; what is quoted in the middle of a longer one is left out.
LONGEST = 800


class RigError(ValueError):
    """Change the rig's parameters or the experiment: what was found, what was expected."""

    def __init__(self, text: str) -> None:
        line = "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in text)
        super().__init__(line if len(line) <= LONGEST else f"{line[: LONGEST - 300]} … {line[-290:]}")
