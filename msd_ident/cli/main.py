"""The ``msd`` command: one file a subcommand, errors in one line, exit code 0 or 2."""

from __future__ import annotations

import importlib
import sys

import typer

from msd_ident import parallel
from msd_ident.errors import MsdError, UsageError

#: Subcommands, each a module of this package with a function of the same name.
COMMANDS = (
    *("identify", "diagnose", "validate", "export", "batch", "compare", "watch", "design", "run", "investigate"),
    *("record", "replay", "live", "repair", "simulate", "demo", "paper", "info", "warm"),
)
#: Modules that are not called like their subcommand, and the function in them.
MODULES = {"run": "run_profile"}

app = typer.Typer(
    name="msd",
    help="Identify a mass-spring-damper from force and encoder data, and see what the model gets wrong.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _register() -> None:
    if app.registered_commands:
        return
    for name in COMMANDS:
        try:
            module = importlib.import_module(f"msd_ident.cli.{MODULES.get(name, name)}")
        except ModuleNotFoundError as missing:
            if missing.name != f"msd_ident.cli.{MODULES.get(name, name)}":
                raise
            continue
        app.command(name=name)(getattr(module, MODULES.get(name, name)))


def fail(error: MsdError) -> int:
    """Print the error's one line to stderr; return the exit code."""
    print(f"msd: {error}", file=sys.stderr)
    return 2


def main() -> int:
    """Run the command line; never ends in a traceback for anything that a user can mend."""
    parallel.one_blas_thread()
    _register()
    try:
        outcome = app(standalone_mode=False)
    except MsdError as error:
        return fail(error)
    except typer.Abort:
        return fail(UsageError("interrupted"))
    except Exception as error:
        # typer's own refusals, of a class that is click's or its own copy of click's, depending on its version.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        if not message():  # ``msd`` alone has printed its help already.
            return 2
        return fail(UsageError(_one_line(message())))
    return int(outcome or 0)


def _one_line(text: str) -> str:
    return " ".join(text.split()) + " (msd --help, msd COMMAND --help)"


if __name__ == "__main__":
    sys.exit(main())
