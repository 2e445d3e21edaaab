"""The few errors that a user can meet, named by what must be changed.

Every message is one line that says what is wrong, what was found, what was expected
and what to do next. Command line and nodes print it as it is; anything else that
escapes is a defect of this project.
"""

from __future__ import annotations

import sys

#: Characters of the longest line; what is quoted in the middle of a longer one is left out.
LONGEST = 800


class MsdError(Exception):
    """Base of all errors that a user can mend: one line that can be printed, whatever the data that it quotes."""

    def __init__(self, text: str) -> None:
        line = "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in text)
        super().__init__(line if len(line) <= LONGEST else f"{line[: LONGEST - 300]} … {line[-290:]}")


class DataError(MsdError):
    """Change the data: a file, bag, topic or signal cannot be used as it is."""


class UsageError(MsdError):
    """Change the call: an option, parameter or combination makes no sense."""


class SetupError(MsdError):
    """Change the installation: something that this needs is not there."""


class Interrupted(MsdError):
    """Nothing to change: Ctrl-C ended the work; what is kept of it, and how to go on."""

    def __init__(self, kept: str = "") -> None:
        super().__init__(f"interrupted; {kept}" if kept else "interrupted")


def fail(error: MsdError) -> int:
    """Print the error's one line to stderr; return the exit code: 2, and 130 after Ctrl-C."""
    print(f"msd: {error}", file=sys.stderr)
    return 130 if isinstance(error, Interrupted) else 2
