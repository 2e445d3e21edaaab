"""Write requirements/lock.txt: the versions that are in the Python that runs this.

To renew the lock: `make clean`, `make test LOCK=`, then `.venv/bin/python tools/lock.py`.
A test names packages that ask for more than Python 3.11.0: put an older version of them in.
"""

from __future__ import annotations

from importlib.metadata import distributions
from pathlib import Path

LOCK = Path(__file__).resolve().parent.parent / "requirements" / "lock.txt"
NOT_LOCKED = {"msd-ident", "pip"}
HEADER = "# Versions that the tests passed with, for Python 3.11 to 3.14. Made by tools/lock.py.\n"


def locked() -> list[str]:
    """One ``name==version`` for each package that pip put here; the ROS wheels hold others inside them."""
    rows = set()
    for package in distributions():
        name = package.metadata["Name"].replace("_", "-").lower()
        by_pip = (package.read_text("INSTALLER") or "").strip() == "pip"
        if by_pip and name not in NOT_LOCKED:
            rows.add(f"{name}=={package.version}")
    return sorted(rows)


if __name__ == "__main__":
    LOCK.write_text(HEADER + "\n".join(locked()) + "\n", encoding="utf-8")
