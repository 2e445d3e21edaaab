"""What all subcommands share: version, completion, and options that stand once, in panels of the help."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import defaultdict
from importlib.metadata import version
from typing import Any

import pytest
import typer

from msd_ident.cli import main, options

#: Options that mean something else in one command than in the others.
_OF_THEIR_OWN = {
    "--out": "each command makes another kind of file",
    "--rate": "of a table, of a simulation, of a playback, of frames",
    "--force": "in simulate an older name of --overwrite",
    "--json": "in simulate the true parameters",
    "--mass": "identify takes an uncertainty, export a number",
    "--joint": "of a robot, or a name to give",
    "--check": "of a design, or of an alarm",
    "--namespace": "record finds it by itself, live takes / too",
    "--duration": "of a recording, or of a simulation",
    "--effect": "of a rig that is simulated here, or on the way",
    "--seed": "in investigate it has a value always",
    "--position": "of the live view, which reads topics only",
    "--overwrite": "in simulate with an older name",
    "--rig": "simulate has one always, investigate none unless asked",
}


def _commands() -> dict[str, Any]:
    main._register()
    group: Any = typer.main.get_command(main.app)
    return dict(group.commands)


def test_version(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["msd", "--version"])
    assert main.main() == 0
    assert capsys.readouterr().out == f"msd_ident {version('msd_ident')}\n"


def test_an_option_of_several_commands_stands_once() -> None:
    said: dict[str, set[str]] = defaultdict(set)
    for command in _commands().values():
        for parameter in command.params:
            if parameter.param_type_name == "option" and parameter.name != "help":
                said[parameter.opts[0]].add(str(parameter.help))
                if parameter.opts[-1] == "--overwrite":
                    assert parameter.help == "replace files that already exist"
    assert {name for name, texts in said.items() if len(texts) > 1} <= set(_OF_THEIR_OWN)


@pytest.mark.parametrize("name", ["identify", "diagnose", "validate", "batch", "compare", "watch", "design"])
def test_help_groups_the_options(name: str) -> None:
    command = _commands()[name]
    panels = {p.rich_help_panel for p in command.params if p.param_type_name == "option" and p.name != "help"}
    assert {options.SOURCE, options.OUTPUT} <= panels and None not in panels


def test_no_word_of_a_help_is_taken_for_markup() -> None:
    """Rich takes ``[s]`` for a style and leaves it out."""
    for name, command in _commands().items():
        for parameter in command.params:
            assert "[" not in str(parameter.help).replace("([0-9]+)", ""), f"{name} {parameter.name}"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion(shell: str) -> None:
    code = "import sys; sys.argv[0] = 'msd'; from msd_ident.cli.main import main; sys.exit(main())"
    asked = {"COMP_WORDS": "msd dia", "COMP_CWORD": "1", "_TYPER_COMPLETE_ARGS": "msd dia"}
    asked |= {"_MSD_COMPLETE": f"complete_{shell}", "_TYPER_COMPLETE_FISH_ACTION": "get-args"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | asked, capture_output=True, text=True, check=False
    )
    assert "diagnose" in done.stdout and "design" not in done.stdout, done.stderr
