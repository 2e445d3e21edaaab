"""The command line's page, from the commands' own help."""

from __future__ import annotations

import inspect
import typing
from pathlib import Path
from typing import Any

import typer
from docs_tables import cell, code, plain, table

from msd_ident.cli import main

_HEAD = """# Command line

`.venv/bin/msd` is the command. This page is made from its own help; `msd COMMAND --help` says the same.

**Exit codes**: 0 when done, whatever the verdict; 2 with one clear line on standard error for what cannot be used. Of
several paths the good ones are done, and a bad one is said in its place.

**`--json -`** writes one JSON object a path to standard output and nothing else: see the [JSON contract](json.md).

"""


def page() -> str:
    """Markdown of the whole page."""
    main._register()
    group: Any = typer.main.get_command(main.app)
    commands = [(name, group.commands[name]) for name in main.COMMANDS if name in group.commands]
    overview = table(("command", "what it does"), [(f"[{name}](#msd-{name})", _first(c.help)) for name, c in commands])
    return _HEAD + overview + "\n" + "\n".join(_section(name, command) for name, command in commands)


def _first(text: str | None) -> str:
    return plain(text).split("\n\n")[0]


def _section(name: str, command: Any) -> str:
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option" and not p.hidden and p.name != "help"]
    words = " ".join(_metavar(p) for p in arguments)
    text = f"## msd {name}\n\n    msd {name} [OPTIONS] {words}".rstrip() + f"\n\n{plain(command.help)}\n\n"
    rows = [(code(_metavar(p)), p.help or "", "") for p in arguments]
    kinds = _kinds(command)
    rows += [(code(_flags(p, kinds)), p.help or "", _default(p)) for p in options]
    return text + table(("option", "meaning", "unless said"), rows)


def _metavar(parameter: Any) -> str:
    return str(parameter.metavar or parameter.name.upper())


def _kinds(command: Any) -> dict[str, str]:
    """What each option takes, from the types of the function behind the command."""
    function = inspect.unwrap(command.callback)
    hints = typing.get_type_hints(function)
    words: dict[Any, str] = {float: "NUMBER", int: "WHOLE NUMBER", str: "TEXT", Path: "PATH"}
    found = {}
    for name, hint in hints.items():
        inner = [kind for kind in typing.get_args(hint) if kind is not type(None)]
        found[name] = words.get(inner[0] if inner else hint, "VALUE")
    return found


def _flags(parameter: Any, kinds: dict[str, str]) -> str:
    flags = ", ".join(parameter.opts)
    return flags if parameter.is_flag else f"{flags} {parameter.metavar or kinds.get(parameter.name, 'VALUE')}"


def _default(parameter: Any) -> str:
    if parameter.required:
        return "needed"
    if parameter.default in (None, "", False) or callable(parameter.default):
        return ""
    return cell(str(parameter.default))
