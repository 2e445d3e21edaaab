"""``msd warm``: compiles beforehand what would be compiled at the first use."""

from __future__ import annotations

import time
from importlib.metadata import entry_points

GROUP = "msd.warm"


def warm() -> int:
    """Compile solver and simulated rig for this user, so that the first start takes no minute."""
    for entry in entry_points(group=GROUP):
        begin = time.monotonic()
        entry.load()()
        print(f"{entry.name}: ready after {time.monotonic() - begin:.1f} s")
    return 0
