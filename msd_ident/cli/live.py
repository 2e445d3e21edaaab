"""``msd live``: the rig, the model beside it and buttons, on a page in the browser."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Annotated

import typer

DemoOption = Annotated[bool, typer.Option("--demo", help="also start a simulated rig, a recorder and an identifier")]
RateOption = Annotated[float | None, typer.Option(min=1.0, max=30.0, help="greatest number of frames per second")]


def live(
    namespace: Annotated[str, typer.Option(help="ROS namespace of the rig's topics; /: none")] = "msd",
    host: Annotated[str, typer.Option(help="address to serve on; other machines need a token")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="port to serve on; 0: any free port")] = 8210,
    token: Annotated[str, typer.Option(help="token that a browser must send; default: generated if needed")] = "",
    force: Annotated[str, typer.Option(help="force signal; default: force", metavar="TOPIC:FIELD")] = "",
    position: Annotated[str, typer.Option(help="position signal; default: encoder", metavar="TOPIC:FIELD")] = "",
    step_limit: Annotated[float, typer.Option(min=0.0, help="greatest force of the step button; 0: disabled")] = 20.0,
    demo: DemoOption = False,
    rate: RateOption = None,
    show: Annotated[bool, typer.Option("--open", help="open the page in the browser")] = False,
) -> int:
    """Show force, displacement, model and residual live in the browser, with buttons, until Ctrl-C."""
    from msd_ident.cli.needs_ros import require_ros
    from msd_ident.live.needs import require_page

    require_ros("msd live")
    require_page()
    from msd_ident.ros.common.signals import noted_signals

    given = {"host": host, "port": port, "token": token, "force": force, "position": position}
    given |= {"step_limit": step_limit, **({"frame_rate": rate} if rate else {})}

    def say(url: str) -> None:
        typer.echo(f"live view at {url} (Ctrl-C ends it)")
        if show:
            typer.launch(url)

    with noted_signals() as signals, ExitStack() as stack:
        if demo:
            _start_demo(stack)
        from msd_ident.ros.common.node_runner import run
        from msd_ident.ros.common.parameters import overrides
        from msd_ident.ros.live.node import LiveView

        place = "msd" if demo else namespace.strip("/")
        arguments = ["--ros-args", "-r", f"__ns:=/{place}"]
        return run(lambda: LiveView(overrides(given), say), signals, args=arguments)


def _start_demo(stack: ExitStack) -> None:
    """Processes that end with the stack, and a folder for their bags and logs."""
    import tempfile
    from pathlib import Path

    from msd_ident.ros.demo.live_demo import demo_graph

    folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="msd_live_", ignore_cleanup_errors=True))
    stack.enter_context(demo_graph(Path(folder)))
