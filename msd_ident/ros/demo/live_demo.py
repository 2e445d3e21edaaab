"""The graph of ``msd live --demo``: a rig with quadratic drag, a recorder and an identifier in a private domain."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from msd_ident.ros.common.domain import in_domain, private_domain
from msd_ident.ros.common.processes import Processes
from msd_ident.ros.demo.demo import NAMESPACE, RIG, arguments

#: The paper's rig with drag that grows with the square of the speed, and some noise: config/drag.yaml.
SAIL: dict[str, object] = {
    **RIG,
    "effects": ["quadratic_drag"],
    "quadratic_drag.drag_coefficient": 4.0,
    "encoder.noise": 1e-5,
}


@contextmanager
def demo_graph(folder: Path, rate: float = 1000.0) -> Iterator[Processes]:
    """The three processes, and this process's environment in their domain, for the block.

    Args:
        folder: for logs and bags; exists.
        rate: of the rig's encoder [Hz].
    """
    with private_domain() as domain, in_domain(domain) as environment, Processes(folder, environment) as processes:
        processes.start("rig", "msd_sim.node", arguments({**SAIL, "rate": rate}))
        processes.start("recorder", "msd_ident.ros.recorder", arguments({"bag_folder": str(folder)}))
        processes.start("identifier", "msd_ident.ros.identifier", arguments({"bag_folder": str(folder)}))
        yield processes


__all__ = ["NAMESPACE", "demo_graph"]
