"""The page of measured rigs: what is known about each, what the diagnosis says, and every error."""

from __future__ import annotations

from collections.abc import Sequence

from bench.real import score
from bench.real.score import Row

#: Rigs whose diagnosis is drawn for the page.
PICTURED = ("spring_cart_1", "servo_pendulum_drop", "silverbox_multisine")

#: Where each record comes from (a public repository or benchmark), and what is true about the rig.
SOURCES = {
    "silverbox_multisine": ("forgi86/pytorch-ident; Silverbox benchmark", "hardening spring, a constant; no friction"),
    "polimi_decay_stiff": ("rssalessio/Control-Linear-Vibrations", "cart pulled by hand: dry friction with presliding"),
    "polimi_pulses_medium": ("rssalessio/Control-Linear-Vibrations", "the cart driven: dry friction; k 164.5, m 0.908"),
    "ecp2023_release_2": ("Parker-Knopf/MAE171A", "cart pulled by hand: dry friction"),
    "ecp2023_closed_loop": ("Parker-Knopf/MAE171A", "driven by a position controller; k 29 to 30 V/m"),
    "ecp2025_11_16_25": ("colin-szeto/mae171A", "dry friction, and an amplifier that brakes while it drives"),
    "disc_in_air_1": ("filo0509/smorzamento", "disc on a spring in air: drag, a spring that softens by 1e-3"),
    "hanging_spring_mesh": ("Mattia04/Smorzamento", "mass on a coil spring: viscous damping; k/m 173.6 /s²"),
    "hanging_spring_disc": ("Mattia04/Smorzamento", "the same with another mass; k/m 167.8 /s²"),
    "spring_cart_1": ("Sven-vandenBergh/M24-25-Lab-OSC-data", "cart between springs: Coulomb friction"),
    "servo_pendulum_drop": ("Rhoban/bam", "servo, torque off, with a pendulum: gravity and gear friction"),
    "boucwen_train": ("forgi86/dynonet; Bouc-Wen benchmark, simulated by its authors", "hysteresis; m 2 kg, k 5e4 N/m"),
    "emps_train": ("EMPS benchmark, an electromechanical axis", "dry friction and an offset; m 95.1 kg, Fc 20.4 N"),
}

_HEAD = """# Rigs that others measured

Made by `make real ARGS="--docs docs"`. The records come from public repositories, and from people who do not know
this project. All are measured except `boucwen_train`, which the authors of that benchmark simulated. They are not part
of this repository. The diagnosis gets only the names of the columns and the units.

- *Right*: every cause known to act is named, or tied with a named one; no cause that the rig cannot have is named with
  p > 0.9; every published value is met; no finding about the data is false. `bench/real/rigs.py` has the causes and
  values of each rig. Causes of which neither is known may be named.
- *SEE*: simulation error of the final model. In brackets: divided by that of a careful manual fit with the right law.
- *Further* records (`emps_train`, `step_1`, `step_2`, `release_1`) are counted apart from the twelve *main* ones.
"""


def text(rows: Sequence[Row]) -> str:
    """The page, in Markdown."""
    lines = [_HEAD]
    for row in rows:
        if row.rig in PICTURED:
            said = SOURCES[row.rig][1]
            lines.append(f"![Measured and simulated motion, and the missing force](images/real_{row.rig}.png)\n")
            lines.append(f"*{row.rig}*: {said}.\n")
    lines += [f"| rig | known about it | {score.HEADS} |", "|---" * 7 + "|"]
    lines += [_line(row) for row in rows]
    lines += ["", *(f"{one}." for one in score.totals(rows)), "", "## Errors", ""]
    wrong = [row for row in rows if not row.right or row.reached is False]
    lines += [f"- `{row.rig}`: {_wrong(row)}" for row in wrong] or ["None."]
    lines += ["", "## Sources of the records", "", "| rig | source |", "|---|---|"]
    lines += [f"| {row.rig} | {SOURCES[row.rig][0]} |" for row in rows if row.rig in SOURCES]
    return "\n".join(lines) + "\n"


def _line(row: Row) -> str:
    name, *cells, _ = score.line(row).strip("| ").split(" | ")
    return "| " + " | ".join([name, SOURCES.get(row.rig, ("", "–"))[1], *cells]) + " |"


def _wrong(row: Row) -> str:
    said = [] if row.right else [score.judgement(row)]
    if row.reached is False:
        said.append(f"SEE {row.see / row.expert:.2f} times that of the manual fit")
    return "; ".join(said)
