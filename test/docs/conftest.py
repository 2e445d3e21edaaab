"""The pages' own tools: modules of docs/generate under their names, as the build imports them."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs" / "generate"))
