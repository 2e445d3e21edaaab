"""Figures of a designed experiment: the force, the prediction of each rival, and the difference that remains after a
refit.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from msd_ident.report.matplotlib_figure import write

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from msd_ident.design import Proposal

_LEAST_BAND = 1e-12


def draw(proposal: Proposal) -> Figure:
    """Force, predictions and the refitted difference over time."""
    from matplotlib.figure import Figure

    factor, unit = (1000.0, "mm") if proposal.length == "m" else (1.0, proposal.length)
    figure = Figure(figsize=(9.0, 6.4), layout="constrained")
    force, motion, left = figure.subplots(3, 1, sharex=True, height_ratios=(1, 2, 1.3))
    force.plot(proposal.time, proposal.profile.force_at(proposal.time), color="#7a7a7a", drawstyle="steps-post")
    force.set_ylabel(f"force [{proposal.unit}]")
    force.set_title(f"{proposal.profile.name}: a decision with probability {proposal.probability:.2f}")
    for name, position in zip(proposal.names, proposal.predictions, strict=True):
        motion.plot(proposal.time, factor * position, linewidth=1.0, label=name)
    motion.set_ylabel(f"position [{unit}]")
    motion.legend(loc="upper right", fontsize=8)
    band = 2.0 * proposal.noise * factor
    left.axhspan(-band, band, color="#00000018", linewidth=0, label="twice the noise")
    left.plot(proposal.time, factor * proposal.difference, color="#d1495b", linewidth=1.0)
    largest = max(factor * float(np.max(np.abs(proposal.difference))), band, _LEAST_BAND)
    left.set_ylim(-1.2 * largest, 1.2 * largest)
    true, rival = (proposal.names[i] for i in proposal.pair)
    left.set_title(f"if {true} is true: what {rival}, refitted, gets wrong", loc="left", fontsize=9)
    left.set_ylabel(f"[{unit}]")
    left.set_xlabel("time [s]")
    left.legend(loc="upper right", fontsize=8)
    return figure


def save(proposal: Proposal, target: Path) -> None:
    """Write the picture as the file's ending says (PNG, SVG or PDF).

    Raises:
        SetupError: the disk does not take it.
    """
    write(draw(proposal), [target])
