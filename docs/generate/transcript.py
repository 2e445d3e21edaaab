"""Commands and their real output in a page: run, compared, and written anew.

    .venv/bin/python docs/generate/transcript.py docs/tutorial.md      # write the output of today's commands

A block ``console`` begins with ``$ command``; what follows is its output. The commands of a page run one after the
other in one empty folder, in this process, on a terminal 80 columns wide. A comment
``picture: FILE <- MADE <- command`` says which picture a further command makes in that folder.
"""

from __future__ import annotations

import io
import json
import os
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

_BLOCK = re.compile(r"^```console\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)
_PICTURE = re.compile(r"^<!-- picture: (?P<file>\S+) <- (?P<made>\S+) <- (?P<command>.+) -->$", re.MULTILINE)
_NUMBER = re.compile(r"(?<![\w.])[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)")

#: Part of a decimal number, and units of its last digit, by which machines and libraries may differ.
CLOSE, DIGITS = 0.02, 3


@dataclass(frozen=True)
class Step:
    """A command of a page and what the page says it prints."""

    command: str
    output: str


def steps(page: str) -> list[Step]:
    """All commands of a page, in order."""
    found = []
    for block in _BLOCK.finditer(page):
        first, _, rest = block["body"].partition("\n")
        while first.endswith("\\"):
            more, _, rest = rest.partition("\n")
            first = first[:-1].rstrip() + " " + more.strip()
        found.append(Step(first.removeprefix("$ "), rest.rstrip("\n")))
    return found


def run(command: str) -> str:
    """What a command prints to standard output; ``msd``, and ``python3 -m json.tool``, run in this process.

    Raises:
        RuntimeError: another exit code than 0, or a command that is neither.
    """
    words = shlex.split(command)
    if words[:3] == ["python3", "-m", "json.tool"]:
        return json.dumps(json.loads(Path(words[3]).read_text(encoding="utf-8")), indent=4)
    if words[0] != "msd":
        raise RuntimeError(f"{words[0]} is no command of a page; expected msd or python3 -m json.tool")
    from msd_ident.cli.main import main

    out = io.StringIO()
    terminal = {"COLUMNS": "80", "NO_COLOR": "1"}
    with redirect_stdout(out), mock.patch.object(sys, "argv", words), mock.patch.dict(os.environ, terminal):
        code = main()
    if code != 0:
        raise RuntimeError(f"{command} ended with exit code {code}; expected 0")
    return "\n".join(line.rstrip() for line in out.getvalue().rstrip().splitlines())


def differences(said: str, printed: str) -> Iterator[str]:
    """Lines in which a page's output is not what was printed, but for spaces and the last digits of numbers."""
    told, found = (list(_lines(text)) for text in (said, printed))
    if len(told) != len(found):
        yield f"{len(told)} lines in the page, {len(found)} printed: {found}"
        return
    for one, other in zip(told, found, strict=True):
        words_differ = _NUMBER.sub("#", one) != _NUMBER.sub("#", other)
        if words_differ or not all(map(_near, _NUMBER.findall(one), _NUMBER.findall(other))):
            yield f"page: {one}\nnow:  {other}"


def _lines(text: str) -> Iterator[str]:
    """Words in one row each, wrapped sentences joined to paragraphs: where a line breaks depends on its numbers."""
    for paragraph in re.split(r"\n\s*\n", text):
        yield re.sub("─+", "─", " ".join(paragraph.split()))


def _near(one: str, other: str) -> bool:
    if one == other:
        return True
    digits, _, exponent = one.lower().partition("e")
    if "." not in digits and "." not in other:
        return False  # counts are counts
    last = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
    a, b = (float(text.replace("−", "-")) for text in (one, other))
    return abs(a - b) <= CLOSE * max(abs(a), abs(b)) + DIGITS * last


@contextmanager
def inside(folder: str | Path) -> Iterator[None]:
    """Work in a folder, then go back (``contextlib.chdir`` of later Pythons)."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def rewritten(page: str, home: Path) -> str:
    """The page with the output that its commands print now; its pictures are put below ``home``."""
    with tempfile.TemporaryDirectory() as folder, inside(folder):
        outputs = iter([run(step.command) for step in steps(page)])
        for picture in _PICTURE.finditer(page):
            run(picture["command"])
            shutil.copyfile(picture["made"], home / picture["file"])

    def renewed(block: re.Match[str]) -> str:
        lines = block["body"].splitlines()
        end = next(i for i, line in enumerate(lines) if not line.endswith("\\")) + 1
        output = next(outputs)
        return "```console\n" + "\n".join([*lines[:end], *([output] if output else [])]) + "\n```"

    return _BLOCK.sub(renewed, page)


if __name__ == "__main__":
    for path in (Path(name).resolve() for name in sys.argv[1:]):
        path.write_text(rewritten(path.read_text(encoding="utf-8"), path.parent), encoding="utf-8")
