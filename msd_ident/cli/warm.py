"""``msd warm``: compiles beforehand what would be compiled at the first use."""

from __future__ import annotations

import time
from importlib.metadata import entry_points

GROUP = "msd.warm"


def warm() -> int:
    """Compile solver, fits and simulated rig for this user, so that the first start takes no minute."""
    from msd_ident.workflow import warming

    works = [(entry.name, entry.load()) for entry in entry_points(group=GROUP)]
    for name, work in (*works, ("fits", warming.warm_up)):
        begin = time.monotonic()
        work()
        print(f"{name}: ready after {time.monotonic() - begin:.1f} s")
    return 0
