"""YAML that a person writes: a key that stands twice is refused, and what YAML 1.1 and 1.2 read as different numbers.

YAML 1.1 reads 1:30 as 90 (of base 60), 010 as 8 and 1_0 as 10, and 3e-2 as a text.
"""

from __future__ import annotations

import re
from typing import Any

import yaml

YAMLError = yaml.YAMLError
_INT, _FLOAT = "tag:yaml.org,2002:int", "tag:yaml.org,2002:float"
#: Whole numbers, without those that begin with a 0, which YAML 1.1 reads as octal and 1.2 as decimal.
_WHOLE = re.compile(r"(?:[-+]?(?:0|[1-9][0-9]*)|0x[0-9a-fA-F]+)\Z")
_REAL = re.compile(
    r"(?:[-+]?(?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+(?=[eE]))(?:[eE][-+]?[0-9]+)?"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))\Z"
)
_BEGINNINGS = list("-+.0123456789")
_MERGE = "tag:yaml.org,2002:merge"


class _Loader(yaml.SafeLoader):
    def compose_mapping_node(self, anchor: Any) -> Any:
        """A mapping each of whose keys stands there once."""
        node = super().compose_mapping_node(anchor)
        lines: dict[tuple[str, str], int] = {}
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode) or key.tag == _MERGE:
                continue
            line, name = key.start_mark.line + 1, (key.tag, key.value)
            if name in lines:
                raise YAMLError(f"it has the key {key.value!r} twice, in lines {lines[name]} and {line}")
            lines[name] = line
        return node


class _Dumper(yaml.SafeDumper):
    """Quotes a text that the loader would take for a number."""


# A class has a table of its own once something is added to it; of the loader's, what YAML 1.1 takes for numbers goes.
for _each in (_Loader, _Dumper):
    _each.add_implicit_resolver(_FLOAT, _REAL, _BEGINNINGS)
_Loader.yaml_implicit_resolvers = {
    sign: [(tag, pattern) for tag, pattern in known if tag not in (_INT, _FLOAT)]
    for sign, known in _Loader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(_FLOAT, _REAL, _BEGINNINGS)
_Loader.add_implicit_resolver(_INT, _WHOLE, _BEGINNINGS)


def load(text: str) -> Any:
    """Content of a document.

    Raises:
        YAMLError: it is not YAML, or a mapping has a key twice, of which the last one would count without a word; nor
            is a number of 5000 digits YAML, a date in month 13, or what is nested too deeply.
    """
    try:
        return yaml.load(text, Loader=_Loader)  # noqa: S506 - a safe loader
    except RecursionError:
        raise YAMLError("it is nested too deeply") from None
    except ValueError as error:
        raise YAMLError(str(error)) from None


def dump(data: Any) -> str:
    """Document with the entries in their own order, lists of numbers in one line."""
    return str(yaml.dump(data, Dumper=_Dumper, sort_keys=False, default_flow_style=None, allow_unicode=True, width=110))
