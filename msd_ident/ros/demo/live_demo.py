"""The graph of ``msd live --demo``: a rig with quadratic drag, a recorder and an identifier in a private domain."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from msd_ident.errors import SetupError
from msd_ident.io.message_definitions import share_folders
from msd_ident.ros.common.domain import in_domain, private_domain
from msd_ident.ros.common.processes import Processes
from msd_ident.ros.demo.demo import NAMESPACE, arguments

#: The paper's rig with drag that grows with the square of the speed, and some noise: a sail.
RIG = "drag.yaml"


def rig_file() -> Path:
    """Parameter file of the demo's rig, as it was installed or in a checkout.

    Raises:
        SetupError: it is not there.
    """
    folders = [folder / "msd_ident" / "config" for folder in share_folders()]
    folders.append(share_folders()[-1] / "config")
    found = [folder / RIG for folder in folders if (folder / RIG).is_file()]
    if not found:
        raise SetupError(
            f"{RIG} is in none of {', '.join(map(str, folders))}; expected it there: install msd_ident again"
        )
    return found[-1]


@contextmanager
def demo_graph(folder: Path, rate: float = 1000.0, latency: float = 0.05) -> Iterator[Processes]:
    """The three processes, and this process's environment in their domain, for the block.

    Args:
        folder: for logs and bags; exists.
        rate: of the rig's encoder [Hz].
        latency: of the rig behind the clock [s]; a force that takes longer to reach it acts after its stamp, which no
            model explains.
    """
    # The rig ends with the demo, so nobody need stand behind a force for it to stay.
    rig: dict[str, object] = {"rate": rate, "latency": latency, "hold_last_command": True}
    given = ["--params-file", str(rig_file()), *arguments(rig)]  # of two values of a parameter the last one holds
    with private_domain() as domain, in_domain(domain) as environment, Processes(folder, environment) as processes:
        processes.start("rig", "msd_sim.node", given)
        processes.start("recorder", "msd_ident.ros.recorder", arguments({"bag_folder": str(folder)}))
        processes.start("identifier", "msd_ident.ros.identifier", arguments({"bag_folder": str(folder)}))
        yield processes


__all__ = ["NAMESPACE", "demo_graph"]
