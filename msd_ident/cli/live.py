"""``msd live``: the rig, the model beside it and buttons, on a page in the browser."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Annotated, Optional

import typer


def live(
    namespace: Annotated[str, typer.Option(help="of the graph's topics; / for none")] = "msd",
    host: Annotated[str, typer.Option(help="address to serve on; others than this machine get a token")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="to serve on; 0: any that is free")] = 8210,
    token: Annotated[str, typer.Option(help="that a browser must bring; else made where one is needed")] = "",
    force: Annotated[str, typer.Option(help="TOPIC:FIELD; else force", metavar="TOPIC:FIELD")] = "",
    position: Annotated[str, typer.Option(help="TOPIC:FIELD; else encoder", metavar="TOPIC:FIELD")] = "",
    step_limit: Annotated[float, typer.Option(min=0.0, help="greatest force of the step button; 0: none")] = 20.0,
    demo: Annotated[bool, typer.Option("--demo", help="with a simulated rig, recorder and identifier")] = False,
    rate: Annotated[Optional[float], typer.Option(min=1.0, max=30.0, help="most frames a second")] = None,  # noqa: UP045
    show: Annotated[bool, typer.Option("--open", help="open the page in the browser")] = False,
) -> int:
    """Show force, displacement, the model beside the rig and its residual as they come, with buttons; until Ctrl-C."""
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
