"""YAML through libyaml where it is there: ten times as fast, the same result."""

from __future__ import annotations

from typing import Any

import yaml

YAMLError = yaml.YAMLError
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_DUMPER: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def load(text: str) -> Any:
    """Content of a document.

    Raises:
        YAMLError: it is not YAML.
    """
    return yaml.load(text, Loader=_LOADER)


def dump(data: Any) -> str:
    """Document with the entries in their own order."""
    return str(yaml.dump(data, Dumper=_DUMPER, sort_keys=False))
