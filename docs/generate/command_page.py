"""The command line's page, from the commands' own help."""

from __future__ import annotations

import inspect
import typing
from pathlib import Path
from typing import Any

import typer
from docs_tables import cell, code, plain, table

from msd_ident.cli import main, options

_HEAD = """# Command line

`.venv/bin/msd` is the command. This page is generated from its help; `msd COMMAND --help` shows the same text.
`msd --version` prints the version, `msd --install-completion` installs completion for bash, zsh, fish or PowerShell.

## Exit codes

| code | meaning |
|---|---|
| 0 | The command is done. The verdict and single rows of a batch do not change this. |
| 1 | A demand is not met: `msd validate --require`, `msd watch --check`. Also an internal error, with a traceback. |
| 2 | An option, a file or a rig cannot be used, or a limit stopped a run. Standard error says why, in one line. |
| 130 | Ctrl-C ended the command, also a run on a rig, which is left with force 0. Standard error says what is kept. |

With several paths, a path that cannot be used does not stop the others.

`--json -` writes one JSON object per line to standard output and nothing else: see the [JSON contract](json.md).

## Commands

"""
#: Panels of ``--help`` in the order of the page; options without a panel come first.
_PANELS = ("", options.SOURCE, options.MODEL, options.RIG, options.BATCH, options.OUTPUT)


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
    optional = [p for p in command.params if p.param_type_name == "option" and not p.hidden and p.name != "help"]
    words = " ".join(_metavar(p) for p in arguments)
    text = f"## msd {name}\n\n    msd {name} [OPTIONS] {words}".rstrip() + f"\n\n{plain(command.help)}\n\n"
    kinds = _kinds(command)
    rows = {"": [(code(_metavar(p)), p.help or "", "") for p in arguments]}
    for p in optional:
        panel = getattr(p, "rich_help_panel", None) or ""
        rows.setdefault(panel, []).append((code(_flags(p, kinds)), p.help or "", _default(p)))
    order = sorted(rows, key=lambda panel: _PANELS.index(panel) if panel in _PANELS else 1)
    return text + "\n".join(_panel(panel, rows[panel]) for panel in order if rows[panel])


def _panel(name: str, rows: list[tuple[str, str, str]]) -> str:
    return table((name.lower() or "argument or option", "meaning", "default"), rows)


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
        return "required"
    if parameter.default in (None, "", False) or callable(parameter.default):
        return ""
    return cell(str(parameter.default))
