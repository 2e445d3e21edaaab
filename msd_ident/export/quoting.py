"""Words of others in a written file: the path of a record and the name of a joint are text there, never code."""

from __future__ import annotations

import json
import re
from xml.sax.saxutils import escape


def plain(text: str) -> str:
    """One line that a Python docstring and a comment of YAML and CSV hold as it is.

    Args:
        text: as it came, from a result or a file name. Signs that are not printable, new lines too, are shown as Python
            escapes them; backslashes are doubled, and double quotes become single ones, which end no docstring.
    """
    shown = "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in text)
    return shown.replace("\\", "\\\\").replace('"', "'")


def in_xml_comment(text: str) -> str:
    """The same text for an XML comment, which may not hold two hyphens in a row.

    Args:
        text: of plain lines.
    """
    return re.sub("-(?=-)", "- ", text)


def in_xml(text: str) -> str:
    """The same text for the value of an XML attribute between double quotes, or of an element.

    Args:
        text: printable.
    """
    return escape(text, {'"': "&quot;"})


def in_python(text: str) -> str:
    """A Python literal of the text.

    Args:
        text: printable.
    """
    return json.dumps(text, ensure_ascii=False)
