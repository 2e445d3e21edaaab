"""The ``msd`` command: one file a subcommand, errors in one line, exit code 0 or 2, 130 after Ctrl-C."""

from __future__ import annotations

import atexit
import functools
import gc
import importlib
import io
import sys
from collections.abc import Callable, Sequence
from typing import Annotated, Any

import typer

from msd_ident import parallel
from msd_ident.cli.interruption import send_lost_signals_again
from msd_ident.errors import Interrupted, MsdError, UsageError, fail

#: Subcommands: each is a module of this package with a function of the same name.
COMMANDS = (
    *("identify", "diagnose", "validate", "export", "batch", "compare", "watch", "design", "run", "investigate"),
    *("record", "replay", "live", "repair", "simulate", "demo", "paper", "info", "warm"),
)

#: Allocations between two runs of the garbage collector, and runs between two deeper ones. Imported modules and the
#: loaded solver are a quarter of a million objects. With Python's default of 700 allocations, the collector walks
#: through them hundreds of times, an eighth of the time that ``msd identify`` takes; here it begins after them. At the
#: end of the process it would take all of them apart, a fifth of that time, before the system frees the memory anyway:
#: what is left then is frozen.
_COLLECTOR = (500_000, 20, 20)

app = typer.Typer(
    name="msd",
    help="Identify a mass-spring-damper from force and encoder data, and find what its model lacks.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"msd_ident {version('msd_ident')}")
        raise typer.Exit


@app.callback()
def _general(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    pass


def _register(names: Sequence[str] = COMMANDS) -> None:
    """Import these subcommands; the others are not needed by one of them, only by the help of all."""
    known = {command.name for command in app.registered_commands}
    for name in names:
        if name in known:
            continue
        try:
            module = importlib.import_module(f"msd_ident.cli.{name}")
        except ModuleNotFoundError as missing:
            if missing.name != f"msd_ident.cli.{name}":
                raise
            continue
        app.command(name=name)(_said(getattr(module, name)))
    app.registered_commands.sort(key=lambda command: COMMANDS.index(command.name or ""))


def _said(command: Callable[..., int]) -> Callable[..., int]:
    """The command whose Ctrl-C is said in a line; typer ends without a word."""

    @functools.wraps(command)
    def run(*args: Any, **kwargs: Any) -> int:
        try:
            return command(*args, **kwargs)
        except KeyboardInterrupt:
            raise Interrupted from None

    return run


def main() -> int:
    """Run the command line; the exit code. Errors that the user can correct are printed in one line."""
    parallel.one_blas_thread()
    gc.set_threshold(*_COLLECTOR)
    atexit.register(gc.freeze)  # see _COLLECTOR
    send_lost_signals_again()
    _print_every_name()
    try:
        _register(sys.argv[1:2] if sys.argv[1:2] and sys.argv[1] in COMMANDS else COMMANDS)
        outcome = app(standalone_mode=False)
    except MsdError as error:
        return fail(error)
    except KeyboardInterrupt:  # before typer runs, which handles it
        return fail(Interrupted())
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


def _print_every_name() -> None:
    """A file's name that is no text of the terminal's encoding is printed with escapes."""
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")


def _one_line(text: str) -> str:
    return " ".join(text.split()) + " (msd --help, msd COMMAND --help)"


if __name__ == "__main__":
    sys.exit(main())
