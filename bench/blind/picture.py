"""The blind study as a picture: confusion matrix of the effects, and calibration of the stated probabilities."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np

from bench.blind import score
from bench.blind.cases import Outcome

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402 - after the choice of the backend


def draw(outcomes: Sequence[Outcome], path: Path) -> None:
    """Confusion matrix of the main experiment and reliability of all stated probabilities, as one PNG."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 6.5), width_ratios=(1.75, 1), layout="constrained")
    _confusion(left, outcomes)
    _reliability(right, outcomes)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _confusion(axes: plt.Axes, outcomes: Sequence[Outcome]) -> None:
    table = score.confusion(score.main_experiment(outcomes))
    hidden = sorted(table)
    answers = hidden + sorted({answer for row in table.values() for answer in row} - set(hidden))
    share = np.array([[table[name][answer] / sum(table[name].values()) for answer in answers] for name in hidden])
    axes.imshow(share, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for row, name in enumerate(hidden):
        for column, answer in enumerate(answers):
            if table[name][answer]:
                colour = "white" if share[row, column] > 0.5 else "black"
                axes.text(column, row, table[name][answer], ha="center", va="center", color=colour, fontsize=8)
    axes.set_xticks(range(len(answers)), [_short(answer) for answer in answers], rotation=60, ha="right", fontsize=8)
    axes.set_yticks(range(len(hidden)), [_short(name) for name in hidden], fontsize=8)
    axes.set_xlabel("named, or tied with a named cause")
    axes.set_ylabel("visible hidden effect")
    what = "Hidden effect and named cause\n(steps of two amplitudes, both directions, 1 kHz)"
    axes.set_title(what, fontsize=10)


def _short(name: str) -> str:
    return name.replace("_", " ")


def _reliability(axes: plt.Axes, outcomes: Sequence[Outcome]) -> None:
    bins = score.reliability(outcomes)
    stated, observed = np.array([b.stated for b in bins]), np.array([b.observed for b in bins])
    spread = np.abs(np.transpose([b.range for b in bins]) - observed)
    axes.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    axes.fill_between([0, 1], [-0.1, 0.9], [0.1, 1.1], color="0.93", linewidth=0)
    axes.errorbar(stated, observed, yerr=spread, fmt="o", color="tab:blue", capsize=3)
    for x, y, n in zip(stated, observed, [b.count for b in bins], strict=True):
        axes.annotate(f"{n}", (x, y), textcoords="offset points", xytext=(7, -11), fontsize=8)
    axes.set(xlim=(-0.03, 1.03), ylim=(0.0, 1.05), xlabel="stated probability of a cause", ylabel="share that acts")
    axes.set_title(
        "Calibration of the probabilities\n(all experiments; number of causes beside each point;\n"
        "bars: 95 % interval of the share; band: ± 0.1)",
        fontsize=10,
    )
