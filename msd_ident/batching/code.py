"""Version of the code that makes a row: with the same version, two computers give the same digits."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

import msd_ident
from msd_ident.data.provenance import versions

#: Subpackages that change no digit of a row.
_OUTSIDE = ("cli", "comparison", "live", "monitoring", "report", "ros")


@cache
def code_version() -> str:
    """Version of the package, and a digest of its source files and of the versions of numpy, scipy and numba.

    A release and a checkout with a change in it differ, though both are called the same.
    """
    root, digest = Path(msd_ident.__file__).parent, hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        name = path.relative_to(root)
        if name.parts[0] not in _OUTSIDE:
            digest.update(f"{name}\0".encode() + path.read_bytes())
    known = versions()
    digest.update(repr(sorted(known.items())).encode())
    return f"{known['msd_ident']}+{digest.hexdigest()[:12]}"
