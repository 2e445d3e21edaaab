"""Arguments of the launch files, checked before anything starts. Without ROS, also without launch.

A launch file that finds out in the middle that an argument makes no sense ends, and leaves running what it has started.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from msd_ident import strict_yaml
from msd_ident.errors import UsageError

_TRUE, _FALSE = ("true", "1", "yes", "on"), ("false", "0", "no", "off")
_NAMESPACE = re.compile(r"^/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*/?$|^/?$")
LOG_LEVELS = ("debug", "info", "warn", "error", "fatal")


def _blocks(tree: object, above: str = "") -> Iterator[str]:
    """Full names of the nodes, or patterns of them, that a parameter file is for; namespaces may be nested."""
    for key, below in tree.items() if isinstance(tree, Mapping) else ():
        if key == "ros__parameters" and above:
            yield above
        elif key != "ros__parameters":
            yield from _blocks(below, f"{above}/{str(key).strip('/')}")


def _is_for(pattern: str, node: str) -> bool:
    """Whether a node takes the parameters below a name: ``*`` is any one word of it, ``**`` any number of words."""
    words = [{"**": "(/[^/]+)*", "*": "/[^/]+"}.get(word, "/" + re.escape(word)) for word in pattern.split("/")[1:]]
    return re.fullmatch("".join(words), node) is not None


class Arguments:
    """Launch arguments by name, each read as what it is to be.

    Args:
        given: their texts.
    """

    def __init__(self, given: Mapping[str, str]) -> None:
        self._given = given

    def switch(self, name: str) -> bool:
        """True or false, in the spellings that people use: True, true, 1, yes, on.

        Raises:
            UsageError: any other word.
        """
        word = self._given[name].strip().lower()
        if word not in (*_TRUE, *_FALSE):
            raise self._refusal(name, "true or false", "true")
        return word in _TRUE

    def port(self, name: str) -> int:
        """A port of this machine; 0 for any that is free.

        Raises:
            UsageError: it is none.
        """
        text = self._given[name].strip()
        if not re.fullmatch(r"[0-9]{1,5}", text) or int(text) > 65_535:
            raise self._refusal(name, "a port, 0 to 65535", "8210")
        return int(text)

    def number(self, name: str, lower: float, upper: float) -> float:
        """A number in a range.

        Raises:
            UsageError: it is no number, or out of the range.
        """
        try:
            value = float(self._given[name])
        except ValueError:
            value = math.nan
        if not lower <= value <= upper:
            raise self._refusal(name, f"a number from {lower:g} to {upper:g}", f"{max(lower, 1.0)}")
        return value

    def namespace(self, name: str = "namespace") -> str:
        """A namespace as ROS takes it.

        Raises:
            UsageError: ROS would refuse it.
        """
        text = self._given[name].strip()
        if not _NAMESPACE.match(text):
            raise self._refusal(name, "letters, digits and _ between slashes, no digit first", "msd")
        return text

    def word(self, name: str, choices: Sequence[str]) -> str:
        """One of a few words.

        Raises:
            UsageError: another one.
        """
        text = self._given[name].strip().lower()
        if text not in choices:
            raise self._refusal(name, f"one of {', '.join(choices)}", choices[1])
        return text

    def parameters(self, name: str, node: str) -> str:
        """A parameter file that is there, is one, and has something for a node.

        Args:
            name: of the argument.
            node: its name with the namespace.

        Raises:
            UsageError: it has not; the node would start with its defaults instead.
        """
        path = Path(self._given[name]).expanduser()
        if not path.is_file():
            raise self._refusal(name, "the path of a YAML file", "/path/to/parameters.yaml", "there is no such file")
        try:
            tree = strict_yaml.load(path.read_text(encoding="utf-8"))
        except (OSError, ValueError, strict_yaml.YAMLError) as error:
            raise self._refusal(name, "YAML", "/path/to/parameters.yaml", " ".join(str(error).split())) from None
        blocks = list(_blocks(tree))
        if not blocks:
            what = "a ROS 2 parameter file: a node's name or /**, and ros__parameters: below it"
            raise self._refusal(name, what, "/path/to/parameters.yaml", "no ros__parameters in it")
        full = "/" + node.strip("/")
        if not any(_is_for(block, full) for block in blocks):
            found = f"it is for {', '.join(blocks)}, and not for {full}"
            raise self._refusal(name, f"parameters below /** or {full}", "/path/to/parameters.yaml", found)
        return str(path.resolve())

    def bag(self, name: str) -> str:
        """A bag that is there.

        Raises:
            UsageError: it is not.
        """
        path = Path(self._given[name]).expanduser()
        if not path.exists():
            raise self._refusal(name, "a rosbag2 folder or an .mcap file", "/path/to/bag", "there is nothing there")
        return str(path.resolve())

    def _refusal(self, name: str, expected: str, example: str, found: str = "") -> UsageError:
        why = f" ({found})" if found else ""
        return UsageError(f"{name}:={self._given[name]}{why}; expected {expected}, e.g. {name}:={example}")
